#!/usr/bin/python3
"""Opens results files with other people's readers, and finds in them what store.h promises.

    open_results.py square FILE       a 5 x 5 grid over initial.offset.theta and .vtheta
    open_results.py words FILE        method.name x ground.friction and restitution together
    open_results.py trajectory FILE   no sweep, with a trajectory
    open_results.py one FILE N        one case of a sweep, traced

    open_results.py answers FILE      any

Each with h5py, xarray (netCDF-4 engine), netCDF4 and ncdump, of which all must find in every case
the answers that `stance table` tells, true zeros and missing ones included; says what it expected
where it fails.
"""
import csv
import json
import os
import re
import subprocess
import sys

import h5py
import netCDF4
import numpy
import xarray

COUNTS = ["steps", "iterations", "ambiguous_steps", "unranked_steps", "subdivided_steps", "degraded_samples", "footfalls", "walked_steps", "gait_period", "limited_impacts",
          "events", "evaluations"]
MEASURES = {"end_time": "s", "settle_time": "s", "fall_time": "s", "max_penetration": "m",
            "through_ground": "m", "slip_distance": "m", "step_time": "s", "step_length": "m",
            "walking_speed": "m/s", "cost_of_transport": "1", "gait_change": "1", "excursion": "rad", "peak_torque": "N m",
            "friction_used": "1", "impact_friction": "1", "least_normal_force": "N",
            "impact_energy": "J", "projection_energy": "J", "energy_gain": "J", "energy_drift": "J",
            "signorini_residual": "m/s", "coulomb_residual": "1", "dissipation_residual": "m/s"}
FLAGS = {"status": "pending done failed",
         "outcome": "none stabilised fell rested undecided walks",
         "evidence": "none simulated inferred"}
NO_COUNT = -2**63
STATE = ["x", "z", "theta", "q1", "q2", "vx", "vz", "vtheta", "vq1", "vq2"]


def equal(found, expected, what):
    assert found == expected, f"{what}: found {found}, expected {expected}"


def answers(data, dims):
    """Every answer over the dimensions of the sweep, in their order, with its attributes."""
    for name in [*COUNTS, *MEASURES, *FLAGS, "failure", "checksum"]:
        equal(data[name].dims, dims, f"dimensions of {name}")
        assert data[name].attrs["long_name"], name
    equal(data["final_state"].dims, (*dims, "state"), "dimensions of final_state")
    equal([str(s) for s in data["state"].values], STATE, "names of the state")
    for name, unit in MEASURES.items():
        equal(data[name].attrs["units"], unit, f"units of {name}")
        assert numpy.isnan(data[name].attrs["_FillValue"]), name
    for name in COUNTS:
        equal(int(data[name].attrs["_FillValue"]), NO_COUNT, f"what {name} is missing as")
    for name, words in FLAGS.items():
        equal(data[name].attrs["flag_meanings"], words, f"flags of {name}")
        assert "_FillValue" not in data[name].attrs, f"a word of {name} is missing"
        equal(list(data[name].attrs["flag_values"]), list(range(len(words.split()))), name)
    assert set(numpy.unique(data["status"])) <= {1, 2}, "pending cases in a finished file"


def told(stance, name, asked):
    """What `stance table` says of each case that is not pending, NAN where it says nothing; words
    as their numbers in the file."""
    text = subprocess.run([stance, "table", name, *(a for n in asked for a in ("--answer", n))], check=True, capture_output=True, text=True)
    rows = list(csv.DictReader(text.stdout.splitlines()))
    with h5py.File(name, "r") as file:
        words = {n: file[n].attrs["flag_meanings"].decode().split() for n in asked if "flag_meanings" in file[n].attrs}
    return {n: numpy.array([numpy.nan if r[n] == "" else words[n].index(r[n]) if n in words else float(r[n]) for r in rows])
            for n in asked}


def dumped(name, variable):
    """The numbers that ncdump prints of a variable, NAN where it prints that there is none."""
    text = subprocess.run(["ncdump", "-v", variable, "-p", "9,17", name], check=True, capture_output=True, text=True).stdout
    data = re.search(rf"\n {re.escape(variable)} =(.*?);", text[text.index("\ndata:"):], re.S).group(1)
    return numpy.array([numpy.nan if word in ("_", "NaN") else float(word) for word in re.split(r"[,\s]+", data.strip())])


def every(name):
    """All readers find in all cases what the program tells of them, and as many zeros."""
    stance = os.environ.get("STANCE", "bin/stance")
    with h5py.File(name, "r") as file:
        asked = [n for n in [*COUNTS, *MEASURES, *FLAGS, "failure", "fall_cause"] if n in file]
        there = file["status"][...].ravel() > 0
        raw = {n: (file[n][...].ravel(), file[n].attrs.get("_FillValue", [None])[0]) for n in asked}
    assert len(asked) > 20 and there.any()
    expected = told(stance, name, asked)
    with xarray.open_dataset(name, engine="netcdf4") as data, netCDF4.Dataset(name) as net:
        for n in asked:
            values, fill = raw[n]
            seen = {"h5py": numpy.where(values == fill, numpy.nan, values) if fill is not None else values,
                    "xarray": data[n].values.ravel(),
                    "netCDF4": numpy.ma.filled(numpy.ma.asarray(net[n][...]).astype(float), numpy.nan).ravel(),
                    "ncdump": dumped(name, n)}
            for reader, found in seen.items():
                found, wanted = found.astype(float)[there], expected[n][there]
                assert numpy.array_equal(found, wanted, equal_nan=True), (reader, n, found[found != wanted], wanted[found != wanted])
                equal(int((found == 0).sum()), int((wanted == 0).sum()), f"zeros of {n} in {reader}")
        summary = json.loads(subprocess.run([stance, "summary", "--json", name], check=True, capture_output=True, text=True).stdout)
        for n in COUNTS:
            total = summary["cost"].get(n)
            assert total is None or total == data[n].where(data["status"] == 1).sum(), f"sum of {n}"


def provenance(data):
    for key in ["title", "program_version", "git_revision", "compiler", "library_versions",
                "instruction_set", "hosts", "date", "scenario", "scenario_sha256", "axes"]:
        assert data.attrs[key], key
    equal(data.attrs["Conventions"], "CF-1.8", "Conventions")
    equal(int(data.attrs["format_version"]), 1, "format_version")


def scales(name):
    """With h5py: every dimension of every dataset has one scale, with a netCDF number of its own."""
    numbers = {}

    def visit(path, node):
        if not isinstance(node, h5py.Dataset):
            return
        if "_Netcdf4Dimid" in node.attrs:
            number = int(numpy.ravel(node.attrs["_Netcdf4Dimid"])[0])
            assert number not in numbers, f"{path} and {numbers[number]} share a dimension number"
            numbers[number] = path
        else:
            for d in range(node.ndim):
                equal(len(node.dims[d]), 1, f"scales of {path}, dimension {d}")
                equal(node.dims[d][0].shape, (node.shape[d],), f"scale of {path}")

    with h5py.File(name, "r") as file:
        file.visititems(visit)
        assert file["timing/cases"][...].sum() == file["status"].size
    equal(sorted(numbers), list(range(len(numbers))), "dimension numbers")


def header(name):
    return subprocess.run(["ncdump", "-h", name], check=True, capture_output=True, text=True).stdout


def square(name):
    theta, vtheta = "initial.offset.theta", "initial.offset.vtheta"
    with xarray.open_dataset(name, engine="netcdf4", mask_and_scale=False) as data:
        answers(data, (theta, vtheta))
        provenance(data)
        equal(data.attrs["axes"], f"{theta},{vtheta}", "axes")
        equal(data[theta].attrs["units"], "rad", "units of the first axis")
        equal(data[vtheta].attrs["units"], "rad/s", "units of the second axis")
        assert numpy.allclose(data[theta], numpy.linspace(-0.12, 0.06, 5), rtol=0, atol=1e-15)
        assert numpy.allclose(data[vtheta], numpy.linspace(-0.6, 0.6, 5), rtol=0, atol=1e-15)
    with xarray.open_dataset(name, group="design", mask_and_scale=False) as data:
        equal(data["gain"].dims, ("actuator", "posture_state"), "dimensions of gain")
        equal(data["gain"].shape, (2, 6), "shape of gain")
        equal(data["equilibrium_position"].dims, ("coordinate",), "equilibrium_position")
    text = header(name)
    assert f"double end_time({theta}, {vtheta})" in text, text


def words(name):
    with xarray.open_dataset(name, engine="netcdf4", mask_and_scale=False) as data:
        answers(data, ("method.name", "ground.friction"))
        equal([str(m) for m in data["method.name"].values], ["implicit", "midpoint"], "methods")
        equal(list(data["ground.friction"].values), [0.5, 0.8], "friction")
        equal(data["ground.restitution"].dims, ("ground.friction",), "the axis's other path")
        equal(list(data["ground.restitution"].values), [0.0, 0.1], "restitution")
    assert "string method.name(method.name)" in header(name)


def trajectory_group(name, case, case_count=1):
    with xarray.open_dataset(name, group="trajectory", mask_and_scale=False) as data:
        for variable in ["position", "velocity"]:
            equal(data[variable].dims, ("case", "time", "coordinate"), variable)
        equal(data["torque"].dims, ("case", "time", "actuator"), "torque")
        equal(data["force"].dims, ("case", "time", "contact", "component"), "force")
        equal(data["gap"].dims, ("case", "time", "contact"), "gap")
        equal(data["case"].values.tolist(), [case], "recorded cases")
        equal([str(c) for c in data["component"].values], ["normal", "tangential"], "components")
        equal([str(c) for c in data["contact"].values], ["foot1", "foot2"], "contacts")
        time, position = data["time"].values, data["position"].values
        assert numpy.allclose(numpy.diff(time), time[1] - time[0], rtol=1e-9, atol=0) and time[0] == 0
    with xarray.open_dataset(name, mask_and_scale=False) as data:
        end = float(data["end_time"].values.ravel()[0])
        final = data["final_state"].values.reshape(-1, 10)[0, :5]
    there = numpy.isfinite(position[0]).all(axis=1)
    assert there[0] and there[time < end - 1e-9].all() and not there[time > end + 1e-2].any(), end
    last = numpy.flatnonzero(there)[-1]
    if abs(time[last] - end) < 1e-9:
        equal(position[0, last].tolist(), final.tolist(), "last instant and final state")


def trajectory(name):
    with xarray.open_dataset(name, engine="netcdf4", mask_and_scale=False) as data:
        answers(data, ("case",))
        equal(data["case"].values.tolist(), [0], "the only case")
    trajectory_group(name, 0)
    assert "group: trajectory" in header(name)


def one(name, number):
    with xarray.open_dataset(name, engine="netcdf4", mask_and_scale=False) as data:
        answers(data, ("case",))
        equal(data["case"].values.tolist(), [number], "the only case")
        equal(data["initial.offset.theta"].dims, ("case",), "the axis's value")
        step = [numpy.linspace(-0.12, 0.06, 5)[number // 5], numpy.linspace(-0.6, 0.6, 5)[number % 5]]
        for axis, value in zip(["initial.offset.theta", "initial.offset.vtheta"], step):
            assert abs(data[axis].values[0] - value) < 1e-15, axis
    trajectory_group(name, number)


if __name__ == "__main__":
    kind, file = sys.argv[1:3]
    every(file)
    if kind != "answers":
        scales(file)
    {"square": square, "words": words, "trajectory": trajectory, "answers": lambda name: None}.get(
        kind, lambda name: one(name, int(sys.argv[3])))(file)
