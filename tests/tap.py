"""Checks as the lines of TAP that tests/run.sh reads."""
import traceback


def tap(checks):
    """Calls each; what an assertion or anything else has to say of it becomes a comment."""
    for count, check in enumerate(checks, 1):
        try:
            check()
            print(f"ok {count} - {check.__name__}", flush=True)
        except Exception: # pylint: disable=broad-except
            print(f"not ok {count} - {check.__name__}")
            print("# " + traceback.format_exc().replace("\n", "\n# "), flush=True)
    print(f"1..{len(checks)}")
