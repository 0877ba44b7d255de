#!/usr/bin/env python3
"""How many of the faults of mutations.txt the tests find: each is put into a copy of the checkout, which is built
and tested as after any change, up to the first test that fails.

Usage: mutations.py COPY [ROW]...   (COPY: a folder; a checkout that passes `make test`, copied here once)
Prints a line for each fault and, last, how many were found. STANCE_TEST_SCRIPTS, STANCE_TEST_LONG: by more tests."""
import os
import subprocess
import sys
import time

HERE = os.path.dirname(os.path.abspath(__file__))


def rows():
    """The faults: file, what stands there, what is put there."""
    with open(os.path.join(HERE, "mutations.txt"), encoding="utf-8") as text:
        lines = [row.rstrip("\n") for row in text if not row.startswith("#")]
    assert len(lines) % 3 == 0
    for file, old, new in zip(*[iter(lines)] * 3):
        assert old.startswith("- ") and new.startswith("+ ")
        yield file, old[2:], new[2:]


def tested(copy):
    """Whether it builds, and the tests that fail."""
    def make(*what):
        return subprocess.run(["make", "-s", *what], cwd=copy, text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, check=False, env={**os.environ, "STANCE_TEST_FIRST": "1"})
    built = make(f"-j{os.cpu_count()}", "check-programs")
    if built.returncode != 0:
        return False, built.stdout.splitlines()[-3:]
    said = make("check").stdout.splitlines()
    return True, [row.split()[0] for row in said if " passed " in row and " 0 failed" not in row]


def main():
    copy, wanted = sys.argv[1], {int(n) for n in sys.argv[2:]}
    if not os.path.exists(copy):
        subprocess.run(["cp", "-a", os.path.dirname(HERE), copy], check=True)
        built, failing = tested(copy)
        assert built and not failing, f"the checkout itself fails: {failing}"
    found = tried = 0
    for number, (file, old, new) in enumerate(rows(), 1):
        if wanted and number not in wanted:
            continue
        path, begin = os.path.join(copy, file), time.monotonic()
        with open(path, encoding="utf-8") as text:
            whole = text.read()
        if whole.count(old + "\n") != 1:
            print(f"{number:2} {file}: stands there {whole.count(old)} times", flush=True)
            continue
        try:
            with open(path, "w", encoding="utf-8") as text:
                text.write(whole.replace(old + "\n", new + "\n"))
            built, failing = tested(copy)
        finally:
            with open(path, "w", encoding="utf-8") as text:
                text.write(whole)
        tried += built
        found += built and bool(failing)
        said = "does not build: " + " | ".join(failing) if not built else \
            "found by " + " ".join(failing) if failing else "not found"
        print(f"{number:2} {file}: {said}, {time.monotonic() - begin:.0f} s", flush=True)
    print(f"{found} of {tried} found")


main()
