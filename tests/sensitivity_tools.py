#!/usr/bin/python3
"""Known functions in the place of a simulation's answer, and what their indices are.

    sensitivity_tools.py scenario FUNCTION METHOD COUNT [KEY]...  prints a scenario with the factors
                                        of a function; KEYs go into sweep.sample
    sensitivity_tools.py answer FILE FUNCTION   end_time of every case becomes the function of the
                                        sampled factors, each on its own unit interval, plus an
                                        offset that the other grid axes take to a mean of zero
    sensitivity_tools.py mark FILE STATUS INDEX...   these cases become failed (2) or pending (0)
    sensitivity_tools.py check FUNCTION JSON    intervals of `stance sensitivity --json` hold the
                                        true indices, all those at 99.9 %, else three in five:
                                        those of one sample miss together
    sensitivity_tools.py table JSON CSV         both say the same

Per-case checksums are made anew, so that the file is as whole as the program would have left it.
"""
import csv
import json
import sys

import h5py
import numpy

from results_tools import ANSWERS, crc32c

# Fields of a flying biped and where they may go: as many of them as a function has factors.
FACTORS = """initial.state.x 0 1
    initial.state.theta 0 0.1
    initial.state.q1 0.5 0.6
    initial.state.q2 -0.6 -0.5
    initial.state.vx 0 1
    initial.state.vz 0 1
    initial.state.vtheta -1 1
    initial.state.vq1 0 1
    initial.state.vq2 0 1
    robot.leg_length 0.5 0.6
    robot.trunk_length 0.5 0.6
    robot.foot_mass 1 2
    robot.trunk_mass 1 2
    robot.hip_mass 5 6
    ground.friction 0 1
    ground.restitution 0 0.5
    stop.settle.angle 0.05 0.1
    stop.settle.rate 0.5 1
    stop.settle.hold 0.5 1
    stop.fall_height 0 0.2""".split("\n")
FACTORS = [(path, float(low), float(high)) for path, low, high in map(str.split, FACTORS)]


def ishigami(u):
    x = numpy.pi * (2 * u - 1)
    return (numpy.sin(x[:, 0]) + 7 * numpy.sin(x[:, 1])**2
            + 0.1 * x[:, 2]**4 * numpy.sin(x[:, 0]))


WEIGHTS = numpy.array([0, 1, 4.5, 9, 99, 99, 99, 99])


def sobol_g(u):
    return numpy.prod((abs(4 * u - 2) + WEIGHTS) / (1 + WEIGHTS), axis=1)


def morris(u):
    """Morris (1991), section 5. The coefficients that he drew from N(0, 1) are (-1)^i and
    (-1)^(i + j), i and j from 1, as in the test function of SALib (J. Herman, W. Usher, J. Open
    Source Softw. 2(9), 2017)."""
    w = 2 * (u - 0.5)
    bent = [2, 4, 6]
    w[:, bent] = 2 * (1.1 * u[:, bent] / (u[:, bent] + 0.1) - 0.5)
    sign = (-1.0)**numpy.arange(1, 21)
    single = numpy.where(numpy.arange(20) < 10, 20, sign)
    pair = numpy.triu(numpy.outer(sign, sign), 1)
    pair[:6, :6] = numpy.triu(numpy.full((6, 6), -15.0), 1)
    y = w @ single + numpy.einsum("ni,ij,nj->n", w, pair, w)
    for i in range(5):
        for j in range(i + 1, 5):
            for k in range(j + 1, 5):
                y -= 10 * w[:, i] * w[:, j] * w[:, k]
    return y + 5 * w[:, 0] * w[:, 1] * w[:, 2] * w[:, 3]


FUNCTIONS = {"ishigami": (ishigami, 3), "sobol_g": (sobol_g, 8), "morris": (morris, 20)}


def truth(name):
    """{measure: [factor]}: from closed forms; Morris's by brute force on random lattice points."""
    if name == "ishigami":
        v1, v2 = (1 + 0.1 * numpy.pi**4 / 5)**2 / 2, 49 / 8
        v13 = 8 * 0.1**2 * numpy.pi**8 / 225
        v = v1 + v2 + v13
        return {"first": [v1 / v, v2 / v, 0], "total": [(v1 + v13) / v, v2 / v, v13 / v]}
    if name == "sobol_g":
        part = 1 / (3 * (1 + WEIGHTS)**2)
        v = numpy.prod(1 + part) - 1
        return {"first": part / v, "total": part * (v + 1) / (1 + part) / v}
    random, n = numpy.random.default_rng(1), 40000
    found = {"mu": [], "mu_star": [], "sigma": []}
    for j in range(20):
        u = random.integers(0, 4, (n, 20)) / 3
        u[:, j] = random.integers(0, 2, n) / 3
        moved = u.copy()
        moved[:, j] += 2 / 3
        effect = (morris(moved) - morris(u)) / (2 / 3)
        found["mu"].append(effect.mean())
        found["mu_star"].append(abs(effect).mean())
        found["sigma"].append(effect.std(ddof=1))
    return found


def scenario(name, method, count, *keys):
    print("""stance: 1
title: A known function of %d factors
scene: biped
ground: {friction: 0.8, contacts: [foot1, foot2]}
initial: {state: {x: 0, z: 3, theta: 0, q1: 0.5, q2: -0.5}}
method: {name: implicit, step: 0.01}
stop: {time: 0.01}
sweep:
  grid:
    - {path: method.name, values: [implicit, midpoint]}
    - {path: initial.state.z, values: [3, 3.5, 4]}
  sample:
    method: %s
    count: %s""" % (FUNCTIONS[name][1], method, count))
    for key in keys:
        print("    " + key)
    print("    vary:")
    for path, low, high in FACTORS[:FUNCTIONS[name][1]]:
        print(f"      - {{path: {path}, from: {low:g}, to: {high:g}}}")


def rewrite_checksums(file):
    cases = file["status"].size
    parts = [numpy.frombuffer(file[v][...].tobytes(), numpy.uint8).reshape(cases, -1)
             for v in ANSWERS if v in file]
    file["checksum"][...] = crc32c(numpy.hstack(parts)).reshape(file["checksum"].shape)


def answer(name, function):
    value, k = FUNCTIONS[function]
    with h5py.File(name, "r+") as file:
        u = numpy.stack([(file[path][...] - low) / (high - low)
                         for path, low, high in FACTORS[:k]], axis=1)
        starts = numpy.arange(3) - 1  # of the axis before the last
        file["end_time"][...] = numpy.broadcast_to(value(u) + 10 * starts[:, None],
                                                   file["end_time"].shape)
        rewrite_checksums(file)


def mark(name, status, *cases):
    with h5py.File(name, "r+") as file:
        data = file["status"][...]
        data.flat[[int(i) for i in cases]] = int(status)
        file["status"][...] = data
        rewrite_checksums(file)


def check(function, name):
    with open(name) as file:
        found = json.load(file)
    right = truth(function)
    paths = [path for path, _, _ in FACTORS]
    held = total = 0
    for table in found["tables"]:
        for factor in table["factors"]:
            j = paths.index(factor["path"])
            for measure, values in right.items():
                own = factor[measure]
                inside = own["low"] <= values[j] <= own["high"]
                held += inside
                total += 1
                print(f"{factor['path']:22} {measure:8} {own['estimate']:9.4f} in "
                      f"{own['low']:9.4f} ... {own['high']:9.4f}  truth {values[j]:9.4f}"
                      f"{'' if inside else '  OUTSIDE'}")
    assert len(found["tables"][0]["factors"]) == FUNCTIONS[function][1]
    print(f"{held} of {total} intervals hold the truth")
    assert held >= (total if found["level"] > 0.99 else 0.6 * total)


def table(name, rows):
    with open(name) as file:
        tables = json.load(file)["tables"]
    with open(rows, newline="") as file:
        rows = list(csv.DictReader(file))
    expected = [(t, f) for t in tables for f in t["factors"]]
    assert len(rows) == len(expected)
    for row, (t, factor) in zip(rows, expected):
        assert row["factor"] == factor["path"] and float(row["mean"]) == t["mean"]
        assert all(row[path] == str(value) for path, value in t["at"].items())
        for measure in ("first", "total", "mu", "mu_star", "sigma"):
            assert (measure in row) == (measure in factor)
            for key, end in (("estimate", ""), ("low", "_low"), ("high", "_high")):
                assert measure not in row or float(row[measure + end]) == factor[measure][key]


if __name__ == "__main__":
    {"scenario": scenario, "answer": answer, "mark": mark, "check": check,
     "table": table}[sys.argv[1]](*sys.argv[2:])
