#!/usr/bin/env python3
"""What is known of gaits without stance, against `stance gait` and the shipped studies.

Digits are those of an event-driven program of its own (order 8, footfalls to 1e-15 m, one foot pinned), the
compass's those of compass_oracle.py, too; closed forms are named where they stand. Robots of which one knows what
becomes of them without their feet's mass are taken with two masses, and the line through both to none.

    gait_truths.py STANCE SCENARIOS      speaks TAP"""
import json
import math
import os
import subprocess
import sys

import h5py
import numpy as np

import compass_oracle
import zero_dynamics
from tap import PATIENCE, tap

STANCE, SHIPPED = sys.argv[1:]
COMPASS = "gaits/compass_cascade"


def call(command, scenario, settings, *options):
    arguments = [STANCE, command, os.path.join(SHIPPED, scenario + ".yaml"), *options]
    for key, value in settings.items():
        arguments += ["--set", f"{key}={value if isinstance(value, str) else json.dumps(value)}"]
    done = subprocess.run(arguments, capture_output=True, text=True, timeout=PATIENCE, check=False,
                          env=dict(os.environ, CC="false")) # by the kernels that are built in
    assert done.returncode == 0, done.stderr
    return done.stdout


def gait(scenario, settings, *options, exact=True, fine=False):
    """What `stance gait --json` says of it."""
    how = {"method.name": "event-driven"} if exact and not fine else {"method.tolerance": 1e-12} if fine else {}
    return json.loads(call("gait", scenario, {"sweep": {}, **how, **settings}, "--json", *options))


def study(scenario, settings, *names):
    call("run", scenario, settings, "--force", "--quiet", "-o", "study.h5")
    with h5py.File("study.h5") as file:
        return [file[name][...] for name in names]


def near(found, known, by, what=""):
    off = np.abs(np.asarray(found) - np.asarray(known)).max()
    assert off <= by, f"{what} {found} is not {known}: off by {off:.1e}, more than {by:.0e}"


def multipliers(found):
    return [complex(m["re"], m["im"]) for m in found["multipliers"]]


def compass(slope, point):
    """Settings of a start just after a footfall, by angle and rates against the slope's normal."""
    angle, stance, swing = point
    return {"ground.slope": slope, "initial.state": {"leg1": angle - slope, "leg2": -2 * angle, "vleg1": stance,
                                                     "vleg2": swing - stance}}


def section(found, slope):
    state = found["state"]
    return state["leg1"] + slope, state["vleg1"], state["vleg1"] + state["vleg2"]


# ---- the compass -------------------------------------------------------------------------------------------
def points_of_goswami_at_three_degrees():
    slope, point = math.radians(3), (0.271028680499, -1.092383589884, -0.377373948907)
    for exact, close, of_multipliers in (True, 1e-9, 1e-7), (False, 2e-6, 5e-6):
        found = gait(COMPASS, compass(slope, point), exact=exact)
        near(section(found, slope), point, close)
        near(found["period"], 0.734346391159, close)
        near(found["step_length"], 0.535445415430, close)
        near(multipliers(found)[0], -0.199726127 + 0.544476062j, of_multipliers)
        near(multipliers(found)[1], 0.131572624, of_multipliers)


def on_the_moon_all_is_slower_and_else_the_same():
    """Rates and times by the root of gravity, angles and multipliers as they are."""
    slower = math.sqrt(1.62 / 9.81)
    here = gait("mechanisms/compass_gait", {}, "--settle", "1")
    start = {k: v * (slower if k[0] == "v" else 1) for k, v in here["state"].items()}
    there = gait("mechanisms/compass_gait", {"ground.gravity": 1.62, "initial.state": start}, "--settle", "1")
    near(there["period"] * slower, here["period"], 1e-9)
    near(list(there["state"].values()), list(start.values()), 1e-9)
    near(multipliers(there), multipliers(here), 1e-7)


def largest_multipliers_by_the_slope():
    start = compass(math.radians(4.4), (0.308633, -1.15315, -0.15041))
    known = {4.4: -1.009, 5: -1.541, 6: -2.349, 4.2: -0.777, 4: -0.521 + 0.208j, 3: -0.200 + 0.544j,
             2: 0.098 + 0.584j, 1: 0.363 + 0.460j}
    for end, count in (6, 9), (1, 18):
        rows = gait(COMPASS, start, "--settle", "1", "--count", str(count), "--along",
                    f"ground.slope={math.radians(4.4)!r}..{math.radians(end)!r}", exact=False)["rows"]
        for slope, value in known.items():
            for row in rows:
                if abs(math.degrees(row["value"]) - slope) < 1e-6:
                    near(complex(row["re"], row["im"]), value, 6e-4, f"{slope} degrees:")
                    known[slope] = complex(row["re"], row["im"])
    assert all(isinstance(v, complex) for v in known.values()), known


def two_steps_at_4_6_degrees():
    slope = math.radians(4.6)
    one = 0.299926747589, -1.150401209931, -0.159505161081
    other = 0.325572307589, -1.173401383216, -0.091591948376
    for exact, close in (True, 1e-9), (False, 2e-6):
        for point in one, other:
            found = gait(COMPASS, compass(slope, point), "--steps", "2", "--settle", "2", exact=exact)
            near(section(found, slope), point, close)
            assert found["stable"]


def four_steps_at_five_degrees():
    """Of which the independent program says that they come back, and two do not."""
    slope = math.radians(5)
    found = gait(COMPASS, compass(slope, (0.29509, -1.16035, -0.15975)), "--steps", "4", "--settle", "1")
    point = np.array(section(found, slope))
    walker = compass_oracle.Walker(1, 0.5, 5, 10, 0, slope)
    steps = [point]
    for _ in range(4):
        steps.append(walker.step(steps[-1])[0])
    near(steps[4], point, 1e-9)
    assert np.abs(steps[2] - point).max() > 1e-3 and found["stable"]


def where_the_compass_doubles_its_period():
    """The first to 1e-11 rad by event-driven steps: whole_gaits.sh."""
    one, two = (0.3086618, -1.153107, -0.150473), (0.29856823714, -1.1579829043, -0.14507785128)
    for steps, begin, end, point, known in ((1, 0.0767, 0.0766, one, 4.390898249584),
                                            (2, 0.0857, 0.0858, two, 4.914056762)):
        rows = gait(COMPASS, compass(begin, point), "--steps", str(steps), "--settle", "1", "--count", "2", "--along",
                    f"ground.slope={begin}..{end}", fine=True)["rows"]
        near([math.degrees(row["value"]) for row in rows if row["place"] == "flip"], [known], 3e-8)


def the_study_of_the_cascade_has_it():
    slope, outcome, period = study(COMPASS, {}, "ground.slope", "outcome", "gait_period")
    slope, walks = np.degrees(slope), outcome == 5
    for count, begin, end in (1, 2.9, 4.39), (2, 4.40, 4.91), (4, 4.935, 5.012):
        here = (slope > begin) & (slope < end + 1e-6)
        assert here.any() and (period[here] == count).all(), (count, slope[here], period[here])
    assert not walks[slope > 5.0125].any()


# ---- what weighs nothing -----------------------------------------------------------------------------------
def without_mass(read, *masses):
    """What is read of two masses, along the line through both."""
    (one, first), (other, second) = ((m, np.array(read(m))) for m in masses)
    return (other * first - one * second) / (other - one)


def the_simplest_walker():
    """Garcia's, slope 0.009: its long gait, and the short one that does not hold."""
    def read(mass, angle, rate):
        start = {"leg1": angle - 0.009, "leg2": -2 * angle, "vleg1": rate, "vleg2": (math.cos(2 * angle) - 1) * rate}
        found = gait("truth/simplest_walker", {"robot.bodies.leg1.mass": mass, "initial.state": start},
                     "--settle", "1", fine=True)
        return found["state"]["leg1"] + 0.009, found["state"]["vleg1"], found["period"]
    for known in (0.200310900544, -0.199832473005, 3.882463752851), (0.193937369810, -0.203866927442, 3.096105868078):
        near(without_mass(lambda mass: read(mass, *known[:2]), 1e-4, 1e-5), known, 1e-9)


WHEEL = """stance: 1
scene: mechanism
robot:
  bodies:
    leg1: {{joint: free, mass: {mass!r}, inertia: 0, centre: [0, -0.5]}}
    hip: {{joint: fixed, parent: leg1, mass: 1, inertia: 0}}
    leg2: {{joint: hinge, parent: leg1, like: leg1}}
  contacts: {{foot1: {{body: leg1, at: [0, -1]}}, foot2: {{body: leg2, at: [0, -1]}}}}
  actuators: {{hips: {{body: leg2}}}}
ground: {{slope: {slope!r}, friction: 10, lands: ahead}}
initial: {{support: [foot1], state: {{leg1: {begin!r}, leg2: {behind!r}, vleg1: {rate!r}, vleg2: 0}}}}
controller:
  kind: outputs
  phase: {{of: {{leg1: -1}}, from: {start!r}, to: {end!r}}}
  outputs:
    y1:
      of: {{leg2: 1}}
      along: [{behind!r}, {behind!r}, {ahead!r}, {ahead!r}, {ahead!r}]
      proportional: 400
      derivative: 40
method: {{name: capturing, step: 0.005}}
stop: {{time: 20, settle: "off"}}
"""


def the_rimless_wheel():
    """Two legs that weigh nothing, the one in the air brought to where the next spoke is: closed form."""
    half, slope = math.pi / 8, 0.08
    kept = math.cos(2 * half)**2
    rate = -math.sqrt(kept / (1 - kept) * 4 * 9.81 * math.sin(half) * math.sin(slope))

    def read(mass):
        with open("wheel.yaml", "w", encoding="utf-8") as file:
            file.write(WHEEL.format(mass=mass, slope=slope, rate=rate, begin=half - slope, behind=-2 * half,
                                    ahead=2 * half, start=slope - half, end=slope + half))
        found = gait(os.path.abspath("wheel"), {}, "--settle", "5", fine=True)
        return found["state"]["vleg1"], found["period"], multipliers(found)[0].real
    near(without_mass(read, 1e-3, 1e-4), (rate, 1.034549811423, kept), 2e-6)
    near(rate, -1.095462839648, 1e-12)


# ---- walks that are driven ---------------------------------------------------------------------------------
def the_multiplier_of_zero_dynamics():
    known, settings = zero_dynamics.gait()
    near(known, 0.649552458326, 1e-12)
    found = gait("gaits/walks", settings)
    near(multipliers(found)[0], known, 1e-9)
    near(multipliers(found)[1:], 0, 2e-5)


def three_links_are_the_published_gait_where_the_bump_goes_to_nothing():
    """Which exchanges legs by an angle: 400 1/s^2, 40 1/s have 0.82572770 s, 0.926900 m/s, 0.558924, 249.8 N m."""
    settings = {"robot.actuators.hip1.limit": 500, "robot.actuators.hip2.limit": 500}
    for row in "y1", "y2":
        settings |= {f"controller.outputs.{row}.proportional": 400, f"controller.outputs.{row}.derivative": 40}
    found = gait("gaits/three_links", {**settings, "controller.outputs.y2.along": [0, 0.001, 0]}, "--settle", "10",
                 fine=True)
    near(found["period"], 0.82572770, 5e-5)
    near(found["step_length"] / found["period"], 0.9269, 5e-5)
    near(multipliers(found)[0], 0.558924, 1e-3)
    near(found["peak_torque"], 249.8, 0.5)
    footfalls, outcome = study("gaits/three_links", {**settings, "sweep": {}, "controller.outputs.y2.along": [0, 0, 0]},
                               "footfalls", "outcome")
    assert footfalls == 0 and outcome == 2


def walks_lock_to_the_clock():
    outcome, seconds, period = study("gaits/locks", {"sweep.grid[0].count": 41}, "outcome", "step_time", "gait_period")
    walks = outcome == 5
    assert walks.mean() > 0.8
    samples = seconds[walks] / 0.02 * period[walks]
    near(samples, np.round(samples), 1e-3)
    assert {1, 2, 4} <= set(period[walks])


def floors_on_which_feet_stick():
    friction, outcome, slip = study("gaits/walk_floor", {
        "sweep.grid": [{"path": "ground.friction", "from": 0.1, "to": 0.4, "count": 31}]}, "ground.friction", "outcome",
        "slip_distance")
    near(friction[outcome == 5].min(), 0.14, 0.011)
    near(friction[slip < 1e-6].min(), 0.36, 1e-6)


tap([points_of_goswami_at_three_degrees, on_the_moon_all_is_slower_and_else_the_same, largest_multipliers_by_the_slope,
     two_steps_at_4_6_degrees, four_steps_at_five_degrees, where_the_compass_doubles_its_period,
     the_study_of_the_cascade_has_it, the_simplest_walker, the_rimless_wheel, the_multiplier_of_zero_dynamics,
     three_links_are_the_published_gait_where_the_bump_goes_to_nothing, walks_lock_to_the_clock,
     floors_on_which_feet_stick])
