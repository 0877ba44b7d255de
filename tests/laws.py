"""Laws in C that say what the program's own say, operation by operation, give the same files, to the bit: state
feedback, hold and the bimodal law, by every method, late, with noise, lag and limited rates, on the robots that ship
and on random ones."""
import json
import os
import random
import shutil
import subprocess
import sys

import h5py
import numpy as np
import yaml

from tap import tap

STANCE = os.environ["STANCE"]
HERE = os.path.dirname(os.path.abspath(__file__))
SHIPPED = os.path.join(HERE, "..", "scenarios")
METHODS = ["capturing", "implicit", "midpoint", "lagrange", "event-driven"]


def run(command, *arguments, **more):
    done = subprocess.run([STANCE, command, *arguments], capture_output=True, text=True, check=False, **more)
    assert done.returncode in (0, 1), done.stdout + done.stderr
    return done.stdout


def answers(file):
    """Everything a file holds but its designs, as bytes."""
    out = {}
    with h5py.File(file) as f:
        def take(name, item):
            if isinstance(item, h5py.Dataset) and not name.startswith(("design", "timing")) and name != "checksum":
                out[name] = item[()].tobytes() if item.dtype.kind != "O" else str(item[()])
        f.visititems(take)
    return out


def same(name, built, law, data):
    """Runs a scenario with its own law, and with the one in C that is told `data`."""
    for key in ("design", "design_time", "poles", "weights", "gains", "kp", "kd", "target", "normal", "normal_rate", "push"):
        law["controller"].pop(key, None)
    law["controller"].update(kind="program", file="linear.c", data=[float(x) for x in data])
    out = []
    for kind, scenario in ("built", built), ("law", law):
        with open(f"{name}-{kind}.yaml", "w", encoding="utf-8") as file:
            yaml.safe_dump(scenario, file, sort_keys=False)
        run("run", f"{name}-{kind}.yaml", "-o", f"{name}-{kind}.h5", "--force", "--quiet", "--trust")
        out.append(answers(f"{name}-{kind}.h5"))
    differ = [key for key in out[0] if out[0][key] != out[1][key]]
    assert out[0].keys() == out[1].keys() and not differ, (name, differ)
    return out[0]


def shipped(path, **changes):
    with open(os.path.join(SHIPPED, path), encoding="utf-8") as file:
        scenario = yaml.safe_load(file)
    scenario["sweep"]["grid"] = [a for a in scenario["sweep"]["grid"] if "offset" in str(a.get("path", ""))]
    for axis in scenario["sweep"]["grid"]:
        axis["count"] = 5
    scenario["sweep"]["grid"].insert(0, {"path": "method.name", "values": METHODS})
    scenario["stop"]["time"] = min(scenario["stop"]["time"], 2)
    scenario["controller"].update(changes)
    return scenario


def designed(name, scenario):
    """Feedforward, targets and gains as `design` prints them; columns of what the contacts hold are 0."""
    with open(f"{name}.yaml", "w", encoding="utf-8") as file:
        yaml.safe_dump(scenario, file, sort_keys=False)
    told = json.loads(run("design", f"{name}.yaml", "--json"))
    place, torque = told["equilibrium"]["position"], told["equilibrium"]["torque"]
    posture = [q for q in place if q not in ("x", "z")] if "x" in place and "z" in place else list(place)
    names = posture + ["v" + q for q in posture]
    gains = np.zeros((len(told["inputs"]), len(names)))
    for row, given in zip(gains, told["controller"]["gain"]):
        for state, value in zip(told["states"], given):
            row[names.index(state)] = value
    return [torque[i] for i in told["inputs"]], [place[q] for q in posture], gains


def feedback(name, path, **changes):
    scenario = shipped(path, **changes)
    torque, target, gains = designed(name, scenario)
    none = [0] * (2 * len(target) + len(torque))
    return same(name, scenario, json.loads(json.dumps(scenario)), [*torque, *target, *gains.ravel(), *none])


def biped_under_state_feedback():
    outcome = feedback("biped", "basin_one_foot.yaml")["outcome"]
    assert 1 in outcome and 2 in outcome  # some stand, some fall


def late_noisy_and_slow():
    feedback("late", "basin_one_foot.yaml", delay=2, lag=0.003, torque_rate=400, noise=0.2, angle_noise=1e-3,
             rate_noise=1e-2, torque_limit=8, sample_time=0.002)


def rabbit_under_lqr():
    feedback("rabbit", "mechanisms/rabbit.yaml", sample_time=0.003)


def cart_and_pole():
    feedback("cart", "mechanisms/cart_pole.yaml")


def acrobot():
    feedback("acrobot", "mechanisms/acrobot.yaml", sample_time=0.004)


def biped_beyond_a_plane():
    scenario = shipped("controllers/bimodal.yaml")
    control = scenario["controller"]
    torque, target, _ = designed("plane", scenario)
    normal = [*control["normal"].values(), *control["normal_rate"].values()]
    same("plane", scenario, json.loads(json.dumps(scenario)),
         [*torque, *target, *np.ravel(control["gains"]), *normal, *control["push"].values()])


def random_robot(rng):
    """A tree of up to six bodies, dropped: joints turn or slide, with springs, stops, soles and discs."""
    bodies = {"b0": {"joint": "free", "mass": rng.uniform(1, 5), "inertia": rng.uniform(0.05, 1)}}
    contacts, actuators = {}, {}
    for k in range(1, rng.randint(2, 6)):
        joint = rng.choice(["hinge", "hinge", "slide"])
        one = {"joint": joint, "parent": f"b{rng.randrange(k)}", "mass": rng.uniform(0.2, 3),
               "inertia": rng.uniform(0.01, 0.5), "centre": [rng.uniform(-0.2, 0.2), rng.uniform(-0.4, 0)],
               "at": [rng.uniform(-0.3, 0.3), rng.uniform(-0.4, 0)]}
        if joint == "slide":
            one["axis"] = [rng.uniform(-1, 1), -1]
        if rng.random() < 0.4:
            one["limits"] = [-0.6, 0.6]
        if rng.random() < 0.4:
            one.update(stiffness=rng.uniform(0, 30), damping=rng.uniform(0, 2), armature=rng.uniform(0, 0.1))
        if rng.random() < 0.3:
            one["angle"] = rng.uniform(-1, 1)
        bodies[f"b{k}"] = one
        if len(actuators) < 4:
            actuators[f"m{k}"] = {"body": f"b{k}", "limit": rng.choice([20, 200])}
        if len(contacts) < 4 and rng.random() < 0.7:
            contacts[f"c{k}"] = rng.choice([
                {"body": f"b{k}", "at": [0, -0.4]}, {"body": f"b{k}", "at": [0, -0.4], "radius": 0.1},
                {"body": f"b{k}", "from": [-0.1, -0.4], "to": [0.2, -0.4]}])
    contacts["c0"] = {"body": "b0", "at": [0, -0.3], "radius": 0.2}
    return bodies, contacts, actuators


def held(number):
    """Random robots whose joints are held by servos, from above the ground."""
    rng = random.Random(number)
    bodies, contacts, actuators = random_robot(rng)
    joints = [b for b in bodies if b != "b0"]
    kp, kd = rng.uniform(5, 60), rng.uniform(0.5, 4)
    target = {j: round(rng.uniform(-0.4, 0.4), 3) for j in joints}
    driven = [a["body"] for a in actuators.values()]
    scenario = {
        "stance": 1, "scene": "mechanism", "robot": {"bodies": bodies, "contacts": contacts, "actuators": actuators},
        "ground": {"friction": rng.uniform(0.2, 1), "restitution": rng.choice([0, 0.3])},
        "initial": {"state": {"z": 2}},
        "controller": {"kind": "hold", "kp": kp, "kd": kd, "target": {j: target[j] for j in driven}, "sample_time": 0.002,
                       "delay": rng.choice([0, 1])},
        "method": {"step": 0.002}, "stop": {"time": 1.2, "settle": "off"},
        "sweep": {"grid": [{"path": "method.name", "values": METHODS},
                           {"path": "initial.state.b0", "from": -0.5, "to": 0.7, "count": 3}]}}
    posture = ["b0", *joints]
    gains = np.zeros((len(driven), 2 * len(posture)))
    for row, joint in zip(gains, driven):
        row[posture.index(joint)], row[len(posture) + posture.index(joint)] = kp, kd
    aims = [target[q] if q in driven else 0 for q in posture]
    law = json.loads(json.dumps(scenario))
    same(f"held{number}", scenario, law,
         [*[0] * len(driven), *aims, *gains.ravel(), *[0] * (2 * len(posture) + len(driven))])


def random_robots_held():
    for number in range(int(os.environ.get("ROBOTS", "6"))):
        held(number)


def random_robots_held_by_kernels_of_their_own():
    for number in 100, 101:
        rng = random.Random(number)
        bodies, contacts, actuators = random_robot(rng)
        with open("build.yaml", "w", encoding="utf-8") as file:
            yaml.safe_dump({"stance": 1, "scene": "mechanism", "robot": {"bodies": bodies, "contacts": contacts, "actuators": actuators},
                            "initial": {"state": {"z": 2}}, "method": {"name": "capturing", "step": 0.01}, "stop": {"time": 1}}, file, sort_keys=False)
        run("build", "build.yaml")
        METHODS[:] = ["capturing", "implicit"]
        held(number)


if __name__ == "__main__":
    shutil.copy(os.path.join(HERE, "laws", "linear.c"), ".")
    sys.exit(tap([biped_under_state_feedback, late_noisy_and_slow, rabbit_under_lqr, cart_and_pole, acrobot,
                  biped_beyond_a_plane, random_robots_held, random_robots_held_by_kernels_of_their_own]))
