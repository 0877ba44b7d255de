"""facts.py [CODE|- [ARGUMENT...]]: what a test asserts in Python of the files in the current folder.

The code, or that of the standard input, runs with what it names of the modules below, numpy as np, too, and with
the functions here. Of what it asserts in vain the line is told with the values in it.
"""
import csv
import importlib
import json
import linecache
import re
import sys

MODULES = ("csv h5py hashlib json math np numpy os re shutil subprocess sys xarray yaml "
           "make_sample_results null_set results_tools").split()


def said(name="log"):
    """What a command has said as JSON."""
    with open(name, encoding="utf-8") as text:
        return json.load(text)


def table(name="log"):
    """What it has said as CSV: the rows, each by the names of its columns."""
    with open(name, encoding="utf-8", newline="") as text:
        return list(csv.DictReader(text))


def main():
    code = sys.argv.pop(1) if len(sys.argv) > 1 else "-"
    code = sys.stdin.read() if code == "-" else code
    assert code.strip(), "nothing is asserted"
    linecache.cache["facts"] = len(code), None, code.splitlines(True), "facts" # for a traceback
    names = {"said": said, "table": table}
    for name in MODULES:
        if re.search(rf"\b{name}\b", code):
            names[name] = importlib.import_module("numpy" if name == "np" else name)
    exec(compile(code, "facts", "exec"), names) # pylint: disable=exec-used


if __name__ == "__main__":
    main()
