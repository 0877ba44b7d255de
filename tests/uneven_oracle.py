#!/usr/bin/env python3
"""Ground in plates: what stance makes of it against independent programs (uneven_truths.py).

    uneven_oracle.py STANCE SCENARIOS      speaks TAP; with STANCE_TEST_LONG at length"""
import copy
import json
import os
import subprocess
import sys
from math import cos, pi, radians, sin, sqrt

import h5py
import numpy as np
import yaml

import uneven_truths as truth
from tap import PATIENCE, tap
from uneven_truths import Ground

STANCE, SHIPPED = sys.argv[1:]
LONG = bool(os.environ.get("STANCE_TEST_LONG"))
CONTROLLED = "event-driven", "capturing", "lagrange"  # methods that find events, or hunt for them
STEPPED = "implicit", "midpoint"


def run(scenario, name="uneven", codes=(0,), **environment):
    """What the results file has of all cases. Without a compiler: by kernels that read their structure at run time."""
    with open(name + ".yaml", "w", encoding="utf-8") as file:
        yaml.safe_dump({"stance": 1, **scenario}, file, sort_keys=False)
    done = subprocess.run([STANCE, "run", name + ".yaml", "--force", "--quiet", "-o", name + ".h5"], capture_output=True, text=True,
                          timeout=PATIENCE, check=False, env={**os.environ, "CC": "false", **environment})
    assert done.returncode in codes, done.stderr
    with h5py.File(name + ".h5") as file:
        found = {key: item[...] for key, item in file.items() if isinstance(item, h5py.Dataset)}
        found["fields"] = [word.decode() for word in file["state"][...]]
        if "trajectory" in file:
            found["trace"] = {key: item[...] for key, item in file["trajectory"].items()}
    return found


def grid(*axes):
    """Axes of (paths, rows of values)."""
    return {"grid": [{"paths": list(paths), "values": [list(map(float, row)) for row in rows]} for paths, rows in axes]}


def states(found, *fields):
    """A row for each case."""
    columns = [found["fields"].index(f) for f in fields]
    return found["final_state"].reshape(-1, len(found["fields"]))[:, columns]


def near(found, known, by, what=""):
    off = np.abs(np.asarray(found) - np.asarray(known)).max()
    assert off <= by, f"{what}: off by {off:.1e}, more than {by:.0e}\n{found}\n{known}"


# ---- heights ---------------------------------------------------------------------------------------------------------
def philox_gives_its_published_numbers():
    assert truth.philox((0,) * 4, (0, 0)) == [0x16554D9ECA36314C, 0xDB20FE9D672D0FDC, 0xD7E772CEE186176B, 0x7E68B68AEC7BA23B]
    assert truth.philox((5, 0, 0, 0), (7, 9)) == np.random.Philox(counter=4, key=[7, 9]).random_raw(4).tolist()


FIELDS = {
    "low": {"from": -1.0, "height": -0.1},
    "stairs": {"kind": "stairs", "from": 0.5, "width": 0.3, "height": 0.05, "count": 4},
    "rough": {"kind": "rough", "from": 2.0, "width": 0.1, "height": 0.02, "seed": 7},
    "own": {"kind": "rough", "from": 4.0, "width": 0.25, "height": 0.03, "count": 6},
    "down": {"kind": "stairs", "from": 6.0, "width": 0.2, "height": -0.02},
}


def ball(plates, **more):
    """A point that bounces."""
    return {"scene": "mechanism", "robot": {"bodies": {"ball": {"joint": "free", "mass": 1, "inertia": 1}},
                                            "contacts": {"foot": {"body": "ball", "at": [0, 0]}}},
            "ground": {"friction": 0, "plates": plates}, "initial": {"state": {"z": 0.5}},
            "method": {"name": "midpoint", "step": 0.005}, "stop": {"time": 1, "settle": "off"}, **more}


def heights_are_the_documented_function():
    """Balls that have come to rest, one at each place; their cases of a grid, and of a sample."""
    places = np.arange(-2, 8, 0.037 if LONG else 0.13) + 1e-3
    found = run(ball(FIELDS, seed=5, sweep=grid((["initial.state.x"], [[x] for x in places]))))
    near(states(found, "z")[:, 0], [Ground(FIELDS, 5).height(x) for x in places], 1e-12, "grid")
    sample = {"method": "random", "count": 9, "vary": [{"path": "initial.state.vz", "from": -0.1, "to": 0.1}]}
    found = run(ball(FIELDS, seed=6, sweep={**grid((["initial.state.x"], [[x] for x in (4.1, 2.05, 5.4)])), "sample": sample}))
    near(states(found, "z").reshape(3, 9),
         [[Ground(FIELDS, 6, s).height(x) for s in range(9)] for x in (4.1, 2.05, 5.4)], 1e-12, "sample")


# ---- a ball over stairs ------------------------------------------------------------------------------------------------
def stairs(width, height, begin=0.5, **more):
    return {"stairs": {"kind": "stairs", "from": begin, "width": width, "height": height, **more}}


def bounce(plates, e, vx, z, seconds, slope=0.0):
    """The state after so long of a ball that is thrown at x = 0, and how it came there."""
    point = truth.Point(Ground(plates), e=e, slope=slope)
    turn = turned(slope)
    return turn @ point.go(turn.T @ [0, z, vx, 0], seconds), point


def turned(slope):
    """From the ground's axes to level ones."""
    s, c = sin(slope), cos(slope)
    return np.array([[c, s, 0, 0], [-s, c, 0, 0], [0, 0, c, s], [0, 0, -s, c]])


def bouncing(plates, method, step, seconds, cases, slope=0.0, more=None, **parts):
    """The same by stance. Where bounces accumulate event-driven and lagrange give up."""
    axes = [(["ground.restitution", "initial.state.vx", "initial.state.z"] + (more[0] if more else []),
             [list(c) + (more[1][i] if more else []) for i, c in enumerate(cases)])]
    scenario = ball(plates, method={"name": method, "step": step}, stop={"time": seconds, "settle": "off"}, sweep=grid(*axes), **parts)
    scenario["ground"]["slope"] = slope
    return run(scenario, codes=(0, 1))


def plain(ground):
    return {name: {key: value if isinstance(value, str) else float(value) for key, value in piece.items()} for name, piece in ground.items()}


def any_ground(draw):
    """A plate, stairs and rough ground, somewhere."""
    a, b, c = np.sort(draw.uniform(-0.6, 1.5, 3))
    return plain({"a": {"from": a, "height": draw.uniform(-0.1, 0.1)},
                  "b": {"kind": "stairs", "from": b, "width": draw.uniform(0.03, 0.3), "height": draw.uniform(-0.04, 0.03), "count": draw.integers(1, 9)},
                  "c": {"kind": "rough", "from": c, "width": draw.uniform(0.03, 0.3), "height": draw.uniform(0, 0.05), "seed": draw.integers(0, 1000)}})


def numbers_of(grounds):
    """Paths of what differs between grounds of the same pieces, and their values."""
    paths = [f"ground.plates.{name}.{key}" for name, piece in grounds[0].items() for key in piece if key != "kind"]
    return paths, [[float(g[p.split(".")[2]][p.split(".")[3]]) for p in paths] for g in grounds]


def balls_bounce_on_any_ground():
    """Where bounces accumulate, which event-driven and lagrange do not pass, the rest of them is their limit."""
    draw = np.random.default_rng(1)
    for slope in 0.0, 0.1:
        cases, grounds, known = [], [], []
        while len(cases) < (1000 if LONG else 24):
            ground, case = any_ground(draw), (draw.uniform(0.3, 0.95), draw.uniform(-2.5, 3), draw.uniform(0.12, 0.6))
            if (turned(slope).T @ [0, case[2], 0, 0])[1] > Ground(ground).height(case[2] * -sin(slope)):
                cases, grounds, known = cases + [case], grounds + [ground], known + [bounce(ground, *case, 0.9, slope)]
        state, lay = np.array([k[0] for k in known]), np.array([k[1].lay for k in known])
        clear = np.array([not k[1].inside for k in known])  # what bounces on inside a riser is not followed here
        assert 0.1 < lay.mean() < 0.6 and max(k[1].inside for k in known) > 0.05
        for method, close in ("event-driven", 1e-10), ("capturing", 2e-6), ("lagrange", 1e-8):
            found = bouncing(grounds[0], method, 0.005, 0.9, cases, slope, numbers_of(grounds))
            gives_up, counts = found["failure"] == 6, ~lay | (method == "capturing") & clear
            assert (gives_up & counts).sum() <= (0 if method == "capturing" else len(cases) / 100)
            whole = counts & ~gives_up
            near(states(found, "x", "z", "vx", "vz")[whole], state[whole], close, f"{method}, slope {slope}")
            assert found["energy_gain"].max() < 1e-9 and found["max_penetration"].max() < 1e-9


def impacts_are_as_many():
    """Counted as what turns upwards between the rows of a trajectory."""
    plates, cases = stairs(0.3, -0.05), [(e, vx, z) for e in (0.7, 0.9) for vx in (0.4, 1.5, 4.0, -1.0) for z in (0.2, 0.63)]
    for method in CONTROLLED + STEPPED:
        found = bouncing(plates, method, 0.001, 0.9, cases, record={"every": 0.002, "cases": "all"})
        for case, row in zip(cases, found["trace"]["velocity"][:, :, 1]):
            _, point = bounce(plates, *case, 0.9)
            if min(np.diff([0] + [t for t, _, _ in point.landings])) < 0.01:
                continue
            turns = ((row[:-1] < 0) & (row[1:] > 0)).sum()
            assert turns == len(point.landings), f"{method}, {case}: {turns}, not {len(point.landings)}"


def a_ball_comes_down_beside_an_edge():
    """So near it that a step crosses it: on one plate or the other, as it is above."""
    cases, grounds = [], []
    for height in -0.05, 0.04:
        first = sqrt(2 * (0.3 - max(height, 0)) / truth.G)
        for beside in (-1e-3, -1e-5, -1e-7, 1e-7, 1e-5, 1e-3):
            cases += [(0.6, 2.0, 0.3), (0.6, -2.0, 0.3)]
            grounds += [{"far": {"from": -9.0, "height": 0}, "step": {"from": 2 * first - beside, "height": height}},
                        {"far": {"from": -9.0, "height": height}, "step": {"from": -2 * first + beside, "height": 0}}]
    known = [bounce(g, *c, 0.6)[0] for g, c in zip(grounds, cases)]
    for method, close in ("event-driven", 1e-8), ("capturing", 1e-5), ("lagrange", 1e-8):
        found = bouncing(grounds[0], method, 0.005, 0.6, cases, more=numbers_of(grounds))
        near(states(found, "x", "z", "vx", "vz"), known, close, method)


def errors_are_of_the_methods_order():
    """Mean over many heights: of order 1 where events are at the ends of steps; to the tolerance where they are located."""
    plates, cases = stairs(0.23, -0.03), [(0.8, 1.3, z) for z in np.linspace(0.2, 0.45, 65)]
    known = [bounce(plates, *case, 0.75)[0] for case in cases]
    for method in STEPPED:
        off = []
        for step in 0.001, 0.0005, 0.00025:
            found = states(bouncing(plates, method, step, 0.75, cases), "x", "z")
            off.append(np.median(np.abs(found - np.array(known)[:, :2]).max(axis=1)))
        order = np.log2(off[0] / off[2]) / 2
        assert 0.75 < order < 1.5, f"{method}: {off}, order {order:.2f}"
    for method, close in ("capturing", 1e-7), ("lagrange", 1e-10):
        for step in 0.005, 0.0025: # whatever the step
            near(states(bouncing(plates, method, step, 0.75, cases), "x", "z", "vx", "vz"), known, close, method)


def a_riser_has_no_ground_until_a_ball_is_above_it():
    """It comes into a riser in the air: deeper and deeper below it, till it comes to a plate that it is above."""
    plates = {"high": {"from": 0.3, "height": 0.3}, "low": {"from": 0.7, "height": -1.0}}
    known, point = bounce(plates, 0.5, 2.0, 0.25, 0.8)
    assert point.inside > 0.3 and point.landings[-1][2] == -1.0
    for method, close in ("event-driven", 1e-9), ("capturing", 1e-6), ("lagrange", 1e-9), ("midpoint", 0.02), ("implicit", 0.02):
        found = bouncing(plates, method, 0.001, 0.8, [(0.5, 2.0, 0.25)])
        near(states(found, "x", "z", "vx", "vz")[0], known, close, method)
        near(found["through_ground"], point.inside, 2e-2, f"{method}: through_ground")  # at the ends of steps
        assert found["energy_gain"].max() < 1e-2 and found["max_penetration"].max() < 1e-9


# ---- a point that slides ------------------------------------------------------------------------------------------------
def on(a, b=(50, 0, 1), c=(60, 0.1, 0, 1)):
    """Two plates (where, height, friction) and stairs (where, width, height, friction)."""
    return plain({"a": dict(zip(("from", "height", "friction_factor"), a)), "b": dict(zip(("from", "height", "friction_factor"), b)),
                  "c": {"kind": "stairs", **dict(zip(("from", "width", "height", "friction_factor"), c))}})


SLIDES = {  # ground, friction, speed
    "over an edge, and on below it": (on((0.5, -0.05, 1), (0.8, -0.05, 2)), 0.3, 2.5),
    "... to rest there": (on((0.5, -0.05, 3)), 0.2, 2.5),
    "over several, of which it flies over some": (on((0, 0, 1), (0.2, 0, 1), (0.5, 0.1, -0.03, 1)), 0.1, 2.0),
    "onto another floor, and to rest": (on((0.3, 0, 0.25), (0.7, 0, 2)), 0.4, 2.0),
    "to rest just before an edge": (on((1.2232, -0.05, 1)), 0.3, 2.682),
    "just over it": (on((1.2, -0.05, 1)), 0.3, 2.6821),
    "into a riser, at its height": (on((0.3, 0.05, 1)), 0.2, 2.0),
    "... and out of it again": (on((0.3, 0.05, 1), (0.6, -0.04, 1)), 0.2, 2.0),
    "... to where it is as high as before": (on((0.3, 0.05, 1), (0.6, 0, 1)), 0.2, 2.0),
    "backwards, over an edge": (on((-9, -0.05, 1), (-0.4, 0, 1)), 0.2, -2.0),
    "backwards, to where it is rougher": (on((-9, 0, 2), (-0.4, 0, 1)), 0.2, -2.0),
}


def points_slide():
    """Level and down a slope: where it leaves an edge, lands, stops; the places of both methods of fixed steps are near."""
    names, grounds, rows, known, seconds = [], [], [], [], 1.2
    for slope in 0.0, 0.15:
        for name, (ground, mu, vx) in SLIDES.items():
            known.append(turned(slope) @ truth.Point(Ground(ground), mu=mu, slope=slope).go([0, 0, vx, 0], seconds))
            rows.append([mu, slope, *(turned(slope) @ [0, 0, vx, 0])])
            names, grounds = names + [f"{name}, slope {slope}"], grounds + [ground]
    draw = np.random.default_rng(2)
    while len(rows) < (1000 if LONG else 40):  # dropped onto it
        a, b, c = np.sort(draw.uniform(-0.8, 1.5, 3))
        ground = on((a, draw.uniform(-0.1, 0.05), draw.uniform(0.2, 3)), (b, draw.uniform(-0.1, 0.05), draw.uniform(0.2, 3)),
                    (c, draw.uniform(0.03, 0.3), draw.uniform(-0.04, 0.01), draw.uniform(0.2, 3)))
        mu, slope, x, vx = draw.uniform(0.02, 0.5), draw.uniform(-0.1, 0.1), draw.uniform(-1, 1), draw.uniform(-3, 3)
        start = [x, max(Ground(ground).height(x), 0.1) + 0.01, vx, 0]
        known.append(turned(slope) @ truth.Point(Ground(ground), mu=mu, slope=slope).go(start, seconds))
        rows.append([mu, slope, *(turned(slope) @ start)])
        names, grounds = names + ["dropped"], grounds + [ground]
    paths, values = numbers_of(grounds)
    paths = ["ground.friction", "ground.slope", *(f"initial.state.{f}" for f in ("x", "z", "vx", "vz")), *paths]
    for method, close in ("event-driven", 1e-8), ("capturing", 1e-7), ("lagrange", 1e-8), ("midpoint", 0.05), ("implicit", 0.05):
        found = run({"scene": "mechanism", "robot": {"bodies": {"mass": {"joint": "free", "mass": 1, "inertia": 1}},
                                                     "contacts": {"foot": {"body": "mass", "at": [0, 0]}}},
                     "ground": {"plates": grounds[0]}, "initial": {"state": {"x": 0.0}},
                     "method": {"name": method, "step": 0.002}, "stop": {"time": seconds, "settle": "off"},
                     "sweep": grid((paths, [list(row) + v for row, v in zip(rows, values)]))})
        off = np.abs(states(found, "x", "z", "vx", "vz") - known).max(axis=1)
        if method in STEPPED:  # one may come into a riser in another step than the truth does
            off = np.sort(off)[:-len(off) // 20]
        assert off.max() < close, f"{method}, {names[off.argmax()]}: off by {off.max():.1e}"
        assert found["energy_gain"].max() < 1e-9 and found["max_penetration"].max() < 1e-9


# ---- blocks ---------------------------------------------------------------------------------------------------------------
HALF, LOW, MASS, INERTIA = 0.1, 0.08, 2.0, 0.011  # half-width, half-height, m; kg, kg m^2
SOLES = {"base": {"body": "block", "from": [-HALF, -LOW], "to": [HALF, -LOW]}, "top": {"body": "block", "from": [-HALF, LOW], "to": [HALF, LOW]}}
POINTS = {name: {"body": "block", "at": [x * HALF, z * LOW]} for name, x, z in (("p", -1, -1), ("q", 1, -1), ("r", -1, 1), ("s", 1, 1))}


def block(plates, contacts, method, step, seconds, mu=0.0, state=None, restitution=0.0, **more):
    return {"scene": "mechanism", "robot": {"bodies": {"block": {"joint": "free", "mass": MASS, "inertia": INERTIA}}, "contacts": contacts},
            "ground": {"friction": mu, "restitution": restitution, "plates": plates}, "initial": {"state": state or {"z": 1.0}},
            "method": {"name": method, "step": step}, "stop": {"time": seconds, "settle": "off"}, **more}


def a_block_tips_over_an_edge():
    """The end ahead comes over it first, then the other: with and without friction, in the air and landed."""
    plates = {"low": {"from": 0.4, "height": -0.03}}
    for mu, vx, seconds in (0.0, 2.0, 0.5), (0.1, 2.5, 0.19), (0.1, 2.5, 0.4), (0.3, 3.5, 0.14):
        known, log = truth.Block(Ground(plates), HALF, LOW, MASS, INERTIA, mu).go([0, LOW, 0, vx, 0, 0], seconds)
        assert log[0][:2] == ("edge", 1)
        for method, close in ("event-driven", 1e-8), ("capturing", 1e-6), ("lagrange", 1e-6), ("midpoint", 0.1), ("implicit", 0.1):
            found = run(block(plates, {"base": SOLES["base"]}, method, 0.001, seconds, mu, {"z": LOW, "vx": vx}))
            near(states(found, "x", "z", "block", "vx", "vz", "vblock")[0], known, close, f"{mu}, {method}: {log}")


def thrown(count, seed=0):
    """Grounds and numbers of blocks that are thrown onto them."""
    draw, grounds, rows = np.random.default_rng(seed), [], []
    for k in range(count):
        a, b, c = np.sort(draw.uniform(-0.8, 1.5, 3))
        grounds.append(plain({
            "a": {"from": a, "height": draw.uniform(-0.1, 0.05)},
            "b": {"kind": "stairs", "from": b, "width": draw.uniform(0.03, 0.3), "height": draw.uniform(-0.04, 0.01), "count": draw.integers(1, 9)},
            "c": {"kind": "rough", "from": c, "width": draw.uniform(0.03, 0.3), "height": draw.uniform(0, 0.03), "seed": draw.integers(0, 1000)}}))
        rows.append([draw.uniform(0, 0.8), draw.uniform(-1, 1), draw.uniform(0.2, 0.4), draw.uniform(-2.5, 2.5), draw.uniform(-0.5, 0.5),
                     draw.uniform(-0.5, 0.5) * (k % 2), draw.uniform(-3, 3) * (k % 2)])
    paths, values = numbers_of(grounds)
    paths = ["ground.friction", *(f"initial.state.{f}" for f in ("x", "z", "vx", "vz", "block", "vblock")), *paths]
    return grounds[0], grid((paths, [row + v for row, v in zip(rows, values)]))


def a_sole_is_its_two_ends():
    """Also where they stand on plates of different height: as two points of one body."""
    ground, sweep = thrown(1000 if LONG else 200)
    known = run(block(ground, POINTS, "capturing", 0.004, 0.7, sweep=sweep))
    for method in "capturing", "lagrange":
        found = run(block(ground, SOLES, method, 0.004, 0.7, sweep=sweep), codes=(0, 1))
        whole = found["failure"] != 6  # what rocks to rest, which lagrange does not pass
        assert whole.mean() > 0.85 and set(found["failure"]) <= {0, 6}
        off = np.abs(states(found, *found["fields"]) - states(known, *found["fields"]))[whole].max(axis=1)
        assert np.sort(off)[-max(1, len(off) // 200)] < 1e-5, f"{method}: {(off > 1e-5).sum()} of {len(off)} differ, by {np.sort(off)[-3:]}"
        assert found["dissipation_residual"].max() < 1e-9 and found["energy_gain"].max() < 1e-9 and found["max_penetration"].max() < 1e-9


def an_edge_is_crossed_and_crossed_back():
    """Within a step, with an impact between, from which friction throws it back: the plate is that of the impact."""
    plates = {"a": {"from": -0.17401, "height": -0.04386}, "b": {"kind": "stairs", "from": -0.00648, "width": 0.18601, "height": -0.00899,
                                                                 "count": 5, "friction_factor": 1.52226},
              "c": {"from": 0.7987373, "height": -0.0891802}}
    state = {"x": 0.3984499, "z": 0.2031827, "vx": 1.1670982, "vz": 0.2540298, "block": 0.3060444, "vblock": 0.8498586}
    found = [states(run(block(plates, POINTS, method, step, 0.3, 0.0755, state, restitution=0.5)), "x", "z", "block", "vx", "vz", "vblock")[0]
             for method, step in (("event-driven", 0.004), ("event-driven", 0.0005), ("capturing", 0.004))]
    near(found[1], found[2], 1e-5)
    near(found[0], found[1], 1e-9)


# ---- the rimless wheel --------------------------------------------------------------------------------------------------------
def wheel(plates, rate, method, **more):
    with open(os.path.join(SHIPPED, "truth", "rimless_wheel.yaml"), encoding="utf-8") as file:
        scenario = yaml.safe_load(file)
    scenario["ground"]["plates"] = plates
    scenario["initial"] = {"state": {"wheel": 0.0, "vwheel": -rate}, "support": ["spoke1"]}
    scenario["method"] = {"name": method, "step": 0.002, "tolerance": 1e-11}
    scenario["stop"] = {"time": 8, "settle": "off", "footfalls": 4}
    return {**scenario, **more}


def a_wheel_rolls_over_a_step():
    """State after each of four footfalls: angles by the chord between two feet, energy, angular momentum."""
    heights = [-0.09, -0.02, 0.01, 0.03]
    axes = grid((["ground.plates.step.height"], [[h] for h in heights]), (["stop.footfalls"], [[k] for k in (1, 4)]))
    for rate, edge in (0.8, 0.9), (1.0, 1.7):
        known = []
        for height in heights:
            # The spoke upright at 0: its angle against the ground's normal is minus the slope.
            rows = truth.Wheel(Ground({"step": {"from": edge, "height": height}}), 0.1, 6, 0.2).roll(rate, 4, angle=-0.2)
            known += [(t, -turned, -rate) for t, _, _, turned, rate, _ in (rows[0], rows[3])]
        for method, close in ("event-driven", 1e-9), ("capturing", 1e-7):
            found = run(wheel({"step": {"from": edge, "height": 0.0}}, rate, method, sweep=axes))
            near(np.column_stack([found["end_time"].ravel(), states(found, "wheel", "vwheel")]), known, close, f"{method}, {edge}")


def largest_step_up(rate, edge, footfalls):
    """Up which the wheel still comes over the spoke that lands on it: by energy, bisected."""
    def comes(height):
        return None not in truth.Wheel(Ground({"step": {"from": edge, "height": height}}), 0.1, 6, 0.2).roll(rate, footfalls, angle=-0.2, timed=False)
    low, high = 0.0, 0.5
    while high - low > 1e-13:
        low, high = ((low + high) / 2, high) if comes((low + high) / 2) else (low, (low + high) / 2)
    return low


def a_wheel_comes_up_a_step_or_does_not():
    for rate, edge, footfall in ((0.8, 0.9, 1), (1.0, 1.7, 2)) if LONG else ((1.0, 1.7, 2),):
        most = largest_step_up(rate, edge, footfall + 1)
        assert 0.02 < most < 0.2, most
        for method, off in ("event-driven", 1e-8), ("capturing", 1e-6):
            found = run(wheel({"step": {"from": edge, "height": 0.0}}, rate, method, stop={"time": 9, "settle": "off", "footfalls": footfall + 1},
                              sweep=grid((["ground.plates.step.height"], [[most - off], [most + off]]))))
            came = states(found, "wheel")[:, 0] < -footfall * pi / 3 # over that spoke
            assert came.tolist() == [True, False], f"{method}, {rate}: {most}, {states(found, 'wheel').ravel()}"


# ---- walkers down and up a step ------------------------------------------------------------------------------------------------
SLOPE = radians(3)
COMPASS = truth.Compass(1, 0.5, 5, 10, SLOPE), (0.271028680499, -1.092383589884, -0.377373948907), 0.734346391159
LONG_CYCLE = 0.200310900544, -0.199832473005
SIMPLEST = (truth.Compass(1, 1, 1e-6, 1, 0.009, 1.0), (*LONG_CYCLE, cos(2 * LONG_CYCLE[0]) * LONG_CYCLE[1]), 3.882463752851)
STEP = {"step": {"footfall": 3, "from": 0.1, "height": 0}}
MOST = -0.0143660200, 0.0059773290 # m, down and up, of which all smaller ones are survived as far as one looks


def before(height, footfall=3, ahead=0.1):
    """The ground as it is after so many footfalls, the foot that stands at x."""
    begins = []

    def ground(footfalls, x):
        if footfalls == footfall - 1:
            begins.append(x + ahead)
        return Ground({"step": {"footfall": footfall, "from": ahead, "height": height}}, begins=begins)
    return ground


def walks(walker, height, steps):
    robot, (angle, stands, swings), _ = walker
    return robot.walk([angle, -angle, stands, swings], before(height), steps)


def walking(walker, heights, steps, method, **more):
    robot, (angle, stands, swings), period = walker
    light = robot is SIMPLEST[0]
    with open(os.path.join(SHIPPED, "truth", "simplest_walker.yaml" if light else "goswami_walker.yaml"), encoding="utf-8") as file:
        scenario = yaml.safe_load(file)
    scenario["ground"]["plates"] = copy.deepcopy(STEP)
    scenario["robot"]["points"] = {"waist": {"body": "leg1", "lowest": 0.6}}
    scenario["initial"]["state"] = {"leg1": angle - robot.slope, "leg2": -2 * angle, "vleg1": stands, "vleg2": swings - stands}
    scenario["method"] = {"name": method, "step": 0.005 if not light else 0.02, "tolerance": 1e-10}
    scenario["stop"] = {"time": 1.5 * period * (steps + 2), "settle": "off", "walks": {"steps": 1000, "enough": steps, "length": 0.05, "time": 0.05 * period}}
    return {**scenario, "sweep": grid((["ground.plates.step.height"], [[h] for h in heights])), **more}


def agree(walker, name, heights, steps, method):
    """Who walks, and how many steps the others make, where that is as many 1e-6 m to both sides; how many are left out."""
    known, left = [], 0
    for height in heights:
        rows, why = walks(walker, height, steps)
        beside = [len(walks(walker, height + by, steps)[0]) for by in (-1e-6, 1e-6)] if name == "simplest" else []
        left += beside != [len(rows)] * len(beside)
        known.append((len(rows), why, beside == [len(rows)] * len(beside)))
    found = run(walking(walker, heights, steps, method), codes=(0, 1))  # event-driven gives up some that fall
    for height, (made, why, sure), took, outcome in zip(heights, known, found["walked_steps"].ravel(), found["outcome"].ravel()):
        # A leg that falls on may land once more, where nothing carries it.
        assert not sure or outcome == 0 and why or (took == made if why is None else made <= took <= made + 1), \
            f"{name}, {method}, step of {height!r}: {took} steps and outcome {outcome}, not {made}, {why}"
    assert found["energy_gain"].max() < 1e-6 and found["max_penetration"].max() < 1e-9
    return left


def the_compass_survives_steps_as_large():
    """Down and up a step, bracketed by 2e-6 m; and what becomes of it in steps of other heights."""
    for side, most in zip((-1, 1), MOST):
        assert walks(COMPASS, most - side * 1e-6, 40)[1] is None and walks(COMPASS, most + side * 1e-6, 40)[1] is not None
        heights = [most - side * 1e-6, most + side * 1e-6] + [most * k / 4 for k in (range(1, 13) if LONG else (2, 6))]
        for method in ("event-driven", "capturing") if LONG else ("capturing",):
            agree(COMPASS, "compass", heights, 60 if LONG else 16, method)


def critical_brackets_them():
    """stance critical, which looks for the largest step by halves."""
    scenario = walking(COMPASS, [0], 25, "capturing")
    del scenario["sweep"]
    with open("critical.yaml", "w", encoding="utf-8") as file:
        yaml.safe_dump({"stance": 1, **scenario}, file, sort_keys=False)
    for most, end in list(zip(MOST, (-0.02, 0.02)))[not LONG:]:
        done = subprocess.run([STANCE, "critical", "critical.yaml", "--of", f"ground.plates.step.height=0..{end}", "--outcome", "walks", "--count",
                               "129", "-o", "critical.h5", "--force", "--quiet", "--json"], capture_output=True, text=True, timeout=PATIENCE,
                              check=False, env={**os.environ, "CC": "false"})
        assert done.returncode == 0, done.stderr
        line = json.loads(done.stdout)["rows"][0]
        assert abs(line["kept"]) < abs(most) < abs(line["lost"]) <= abs(line["kept"]) + 2e-4, (line, most)


def the_simplest_walker_survives_others():
    """Nearly all of its steps end it: of which smallness is seen by fractions of a millimetre."""
    heights = np.linspace(-0.0031, 0.0031, 101 if LONG else 5).tolist()
    for method in ("event-driven", "capturing") if LONG else ("capturing",):
        left = agree(SIMPLEST, "simplest", heights, 20 if LONG else 10, method)
        assert left < len(heights) / 4, left


# ---- rough ground -------------------------------------------------------------------------------------------------------
def rough(height, width=0.25, **more):
    return {"field": {"kind": "rough", "from": 0.3, "width": width, "height": height, **more}}


def shipped(name):
    with open(os.path.join(SHIPPED, name), encoding="utf-8") as file:
        scenario = yaml.safe_load(file)
    return {key: value for key, value in scenario.items() if key not in ("sweep", "record", "stance")}


def compass_on_rough_ground(height, count, steps, **more):
    scenario = walking(COMPASS, [0], steps, "capturing")
    scenario["ground"]["plates"] = rough(height, **more)
    angle = scenario["initial"]["state"]["leg1"]
    draw = {"method": "random", "count": count, "vary": [{"path": "initial.state.leg1", "from": angle, "to": angle + 1e-12}]}
    return {**scenario, "seed": 11, "sweep": {"sample": draw}}


def a_compass_walks_on_rough_ground():
    """As many steps as by the independent program on the same grounds: each case's own, and one that has a seed."""
    robot, (angle, stands, swings), _ = COMPASS
    steps = 20 if LONG else 12
    for count, height, more in (1000 if LONG else 10, 0.005, {}), (1, 0.003, {"seed": 3}):
        scenario = compass_on_rough_ground(height, count, steps, **more)
        scenario["method"]["step"] = 0.001 if LONG else 0.005
        found = run(scenario)
        known = [len(robot.walk([angle, -angle, stands, swings], Ground(rough(height, **more), 11, k), steps)[0]) for k in range(count)]
        differ = (found["footfalls"].ravel() != known).sum()  # feet in the ground that come over a lower plate have that at a step's end
        assert differ <= count / 50 and (count == 1 or len(set(known)) > 3), f"{differ} of {count} differ: {found['footfalls'].ravel()}, {known}"


ROBOTS = {
    "compass": lambda: {**compass_on_rough_ground(0.004, 1, 20)},
    "biped": lambda: shipped("gaits/walks_without_model.yaml"),
    "rabbit": lambda: shipped("gaits/rabbit_walks.yaml"),
}


def wandering(robot, count, height, seconds, **ground):
    """On many grounds, begun a little off the gait."""
    scenario = ROBOTS[robot]()
    scenario["ground"]["plates"] = rough(height, **ground)
    state = scenario["initial"]["state"]
    path = {"compass": "vleg1", "biped": "vtheta", "rabbit": "vtrunk"}[robot]
    scenario["sweep"] = {"sample": {"method": "random", "count": count, "vary": [
        {"path": f"initial.state.{path}", "from": state[path] - 0.02, "to": state[path] + 0.02}]}}
    scenario["stop"] = {"time": seconds, "settle": "off", "walks": {"steps": 1000, "enough": 1000}}
    return scenario


def down(angle):
    """Ends of rods that hang by 1 from a joint, turned so."""
    return np.array([np.sin(angle), -np.cos(angle)])


FEET = {  # by coordinates, over the rows of a trajectory
    "compass": lambda x, z, leg1, leg2: [np.array([x, z]) + down(a) for a in (leg1, leg1 + leg2)],
    "biped": lambda x, z, theta, q1, q2: [np.array([x, z]) + 0.535 * (down(theta) + down(theta + q)) for q in (q1, q2)],
    "rabbit": lambda x, z, trunk, *legs: [np.array([x, z]) + 0.4 * (down(trunk + t) + down(trunk + t + s)) for t, s in (legs[:2], legs[2:])],
}


def stand_on_plates(robot, found, plates, seed, slope):
    """Feet that touch are at the height of the plate below them, or deeper, in a riser; and none of RABBIT's is below it."""
    for case, position in enumerate(found["trace"]["position"]):
        rows = ~np.isnan(position[:, 0])
        ground, clean = Ground(plates, seed, case), robot == "rabbit" and found["through_ground"][case] == 0
        for foot, place in enumerate(FEET[robot](*position[rows].T)):
            x, z = turned(slope)[:2, :2].T @ place
            above = z - [ground.height(at) for at in x]
            touches = np.abs(found["trace"]["gap"][case][rows, foot]) < 1e-11
            assert (above[touches] < 1e-9).all(), f"{robot}, case {case}: foot {foot + 1} stands {above[touches].max()} m high"
            assert not clean or above.min() > -1e-9, f"{robot}, case {case}: foot {foot + 1} is {above.min()} m high"


def laws_hold_on_rough_ground():
    """No contact below the plate that it is over, no energy of edges, no residuals, and no case fails."""
    for robot, seconds in ("compass", 6), ("biped", 3), ("rabbit", 2):
        for height, width in (0.002, 0.25), (0.02, 0.07):
            scenario = wandering(robot, 16000 if LONG else 8, height, seconds, width=width)
            scenario["record"] = {"every": 0.005, "cases": [0, 1, 2, 3]}
            scenario["seed"] = 7
            found = run(scenario, robot)
            worst = {key: np.nanmax(found[key]) for key in ("max_penetration", "energy_gain", "impact_energy", "signorini_residual",
                                                            "coulomb_residual", "dissipation_residual")}
            assert (found["failure"] == 0).all(), f"{robot}: {np.unique(found['failure'], return_counts=True)}"
            assert max(worst.values()) < 1e-7 and worst["max_penetration"] < 1e-9, f"{robot}, {height}, {width}: {worst}"
            stand_on_plates(robot, found, scenario["ground"]["plates"], 7, scenario["ground"].get("slope", 0.0))


def plates_of_no_height_change_nothing():
    """Many edges between plates as high as each other, or nearly, are the plane."""
    for robot in ROBOTS:
        scenario = wandering(robot, 4, 0.0, 2)
        plane = copy.deepcopy(scenario)
        del plane["ground"]["plates"]
        known = run(plane, "plane")
        for plates in rough(1e-14, 0.01), {"a": {"from": -5.0, "height": 0.0}, "b": {"kind": "stairs", "from": 0.2, "width": 0.05, "height": 1e-13}}:
            scenario["ground"]["plates"] = plates
            found = run(scenario)
            assert (found["footfalls"] == known["footfalls"]).all()
            near(states(found, *found["fields"]), states(known, *found["fields"]), 1e-4, f"{robot}, {plates}")


tap([philox_gives_its_published_numbers, heights_are_the_documented_function, 
     balls_bounce_on_any_ground, impacts_are_as_many, a_ball_comes_down_beside_an_edge, errors_are_of_the_methods_order,
     a_riser_has_no_ground_until_a_ball_is_above_it, points_slide, a_block_tips_over_an_edge, a_sole_is_its_two_ends,
     an_edge_is_crossed_and_crossed_back, a_wheel_rolls_over_a_step,
     a_wheel_comes_up_a_step_or_does_not, the_compass_survives_steps_as_large,
     critical_brackets_them,
     the_simplest_walker_survives_others, a_compass_walks_on_rough_ground, laws_hold_on_rough_ground,
     plates_of_no_height_change_nothing])
