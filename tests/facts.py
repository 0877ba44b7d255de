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


# What the numbers of answers "outcome" mean.
OUTCOMES = ["none", "stabilised", "fell", "rested", "undecided"]


def cells(count):
    """Of so many points on an axis the share of a cell that each stands for: half a one at its ends."""
    return [.5] + [1] * (count - 2) + [.5]


def wilson(share, count):
    """Wilson's interval of 95 % for a share of so many."""
    z = 1.959963984540054
    centre, half = share + z * z / 2 / count, z * (share * (1 - share) / count + z * z / 4 / count / count) ** 0.5
    return (centre - half) / (1 + z * z / count), (centre + half) / (1 + z * z / count)


def main():
    code = sys.argv.pop(1) if len(sys.argv) > 1 else "-"
    code = sys.stdin.read() if code == "-" else code
    assert code.strip(), "nothing is asserted"
    linecache.cache["facts"] = len(code), None, code.splitlines(True), "facts" # for a traceback
    names = {"said": said, "table": table, "OUTCOMES": OUTCOMES, "cells": cells, "wilson": wilson}
    for name in MODULES:
        if re.search(rf"\b{name}\b", code):
            names[name] = importlib.import_module("numpy" if name == "np" else name)
    exec(compile(code, "facts", "exec"), names) # pylint: disable=exec-used


if __name__ == "__main__":
    main()
