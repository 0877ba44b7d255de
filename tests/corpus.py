#!/usr/bin/env python3
"""Every shipped scenario, with few points along each axis: what becomes of the cases and the means of their
answers, against tests/corpus.txt. A number that changes in a scenario, or in what computes it, shows here.

Usage: corpus.py STANCE [--update]   (writes corpus.txt anew: the difference is what a change has changed)
Means are compared to four digits: gains come from LAPACK, whose last ones differ between machines."""
import glob
import json
import os
import subprocess
import sys
import tempfile

import h5py
import numpy as np
import yaml

from tap import PATIENCE, tap

HERE = os.path.dirname(os.path.abspath(__file__))
SCENARIOS = os.path.join(HERE, os.pardir, "scenarios")
LIST = os.path.join(HERE, "corpus.txt")
POINTS = {0: 1, 1: 24, 2: 6, 3: 3}  # along each axis, by how many there are
LEFT_OUT = ("_residual", "_gain", "_penetration", "_energy", "_drift", "_ground")  # answers that are naught but for rounding
NOT_RUN = {"truth/truths": "a list of truths"}


def fewer(scenario):
    """Options that leave few of its cases."""
    sweep = scenario.get("sweep") or {}
    grid = sweep.get("grid") or []
    most = 9 if "refine" in sweep else POINTS.get(len(grid), 2)
    for i, axis in enumerate(grid):
        if axis.get("count", 0) > most:
            yield from ("--set", f"sweep.grid[{i}].count={most}")
        values = axis.get("values", [])
        words = [row[0] if isinstance(row, list) else row for row in values]
        if words and isinstance(words[0], str): # the coarsest of each method
            some = [v for k, v in enumerate(values) if words[k] not in words[:k]]
        else:
            some = values[::-(-len(values) // most)] if len(values) > most else values
        if len(some) < len(values):
            yield from ("--set", f"sweep.grid[{i}].values={json.dumps(some)}")
    if "sample" in sweep:
        yield from ("--set", f"sweep.sample.count={min(sweep['sample']['count'], 24)}")
    if "refine" in sweep:
        yield from ("--set", "sweep.refine.start=5")
    if "cases" in (scenario.get("record") or {}):
        yield from ("--set", "record.cases=[0]")


def line(stance, name, folder):
    """What is said of a scenario: its cases, their outcomes, the means of their answers."""
    path = os.path.join(SCENARIOS, name + ".yaml")
    with open(path, encoding="utf-8") as text:
        options = list(fewer(yaml.safe_load(text)))
    out = os.path.join(folder, "corpus.h5")
    done = subprocess.run([stance, "run", path, "-o", out, "--force", "--quiet", "--trust", *options], text=True,
                          capture_output=True, timeout=PATIENCE, check=False)
    if done.returncode == 2: # a start within the ground
        return f"{name} refused: {done.stderr.strip().rpartition('yaml:')[2]}"
    assert done.returncode <= 1, f"{name}: exit code {done.returncode}: {done.stderr}"
    with h5py.File(out) as f:
        outcome = f["outcome"][...]
        words = f["outcome"].attrs["flag_meanings"].decode().split()
        values = [int(v) for v in f["outcome"].attrs["flag_values"]]
        said = [f"{name} {outcome.size}"]
        said += [f"{word}={(outcome == v).sum()}" for v, word in zip(values, words) if (outcome == v).any()]
        for key in sorted(f):
            data = f[key]
            if isinstance(data, h5py.Dataset) and data.shape == outcome.shape and data.dtype.kind == "f" \
                    and not key.endswith(LEFT_OUT):
                known = data[...][np.isfinite(data[...])]
                if known.size and abs(known.mean()) > 1e-9:
                    said.append(f"{key}={known.mean():.5g}")
    return " ".join(said)


def near(one, other):
    """The same words, the same counts, means that agree."""
    def agree(a, b):
        (key, _, x), (other_key, _, y) = a.partition("="), b.partition("=")
        if key != other_key or not x or x == y:
            return a == b
        return "." in x + y and abs(float(x) - float(y)) <= 1e-4 * max(abs(float(x)), abs(float(y)))
    a, b = one.split(), other.split()
    return len(a) == len(b) and all(agree(*pair) for pair in zip(a, b))


def main():
    stance, update = sys.argv[1], "--update" in sys.argv
    names = sorted(os.path.relpath(p, SCENARIOS)[:-len(".yaml")]
                   for p in glob.glob(os.path.join(SCENARIOS, "**", "*.yaml"), recursive=True))
    names = [name for name in names if name not in NOT_RUN]
    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_CONFIG_HOME"] = folder  # whose laws are trusted
        if update:
            with open(LIST, "w", encoding="utf-8") as text:
                for name in names:
                    print(line(stance, name, folder), file=text, flush=True)
            return
        with open(LIST, encoding="utf-8") as text:
            known = {row.split()[0]: row.strip() for row in text}

        def check(name):
            def one():
                said = line(stance, name, folder)
                assert near(said, known.get(name, "-")), f"\n{known.get(name)}\nis now\n{said}"
            one.__name__ = name
            return one
        tap([check(name) for name in names])


main()
