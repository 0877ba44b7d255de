"""Checks as the lines of TAP that tests/run.sh reads, and how long they wait."""
import os
import traceback

with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "patience"), encoding="ascii") as text:
    PATIENCE = int(text.read().split()[0])  # s


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
