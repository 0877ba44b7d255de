#!/usr/bin/python3
"""How robust are three gaits, and which cheap number tells it?

    robustness.py [--quick] [FOLDER]

writes into FOLDER (results) robustness.csv: of the gait of walks.yaml (P1), that of walks_without_model.yaml (P3) and
RABBIT's the largest push by phase and direction, the highest step down and up, the steepest slope, the least friction,
noise and delay, each with the bracket that it lies in, and the share of rough grounds that are walked for a hundred
steps, with its interval; robust_gaits.csv: of gaits like these, their numbers drawn at random, what is cheap to compute (the
largest multiplier, the gait sensitivity norm) and how robust they are; and robustness.png. --quick: fewer of all.
"""
import csv
import json
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pandas as pd
import stance

HERE = Path(__file__).resolve().parent
QUICK = "--quick" in sys.argv
RESULTS = Path(next((word for word in sys.argv[1:] if word[:2] != "--"), "results"))
DRAWN, GROUNDS, COUNT, STEPS = (6, 4, 33, 20) if QUICK else (40, 100, 1025, 100)
FOLDER = Path(tempfile.mkdtemp())
random = np.random.default_rng(38)
Y = "controller.outputs."


def outputs(lean, bump, frequency, damping, torques=({}, {})):
    return {f"{Y}y{i}.{key}": value for i in (1, 2) for key, value in {
        "along": ([lean], [0, bump, 0])[i - 1], "proportional": frequency**2, "derivative": 2 * damping * frequency,
        **({"torques": torques[i - 1]} if torques[i - 1] else {})}.items()}


def of(file, state=None, **change):
    """A scenario whose robot can be pushed at its hip, on its cycle."""
    s = stance.scenario(HERE / file).set({
        "sweep": {}, "method.tolerance": 1e-8, "record.answers": ["outcome", "evidence", "end_time"],
        "stop.walks": {"steps": 10, "enough": STEPS}, "stop.time": 3 * STEPS, **change})
    if state:
        s.set({"initial.state": state})
    return s.set({"initial.state": s.gait()["state"]})


P3 = outputs(-0.2, 0.35, 12, 1, ({"leg1": -0.721, "leg2": 0.409}, {"leg1": -0.516, "leg2": 0.516}))
P3_STATE = {"trunk": -0.277281118, "leg1": 0.574930591, "leg2": -0.020368356, "vtrunk": -0.197339838,
            "vleg1": -1.177998913, "vleg2": -0.941414377}
PUSHED = {"robot.points.hip.force": [0, 0], "robot.points.hip.from": 0, "robot.points.hip.to": 0.1}
ROBOTS = {"P1": (of("walk_pushes.yaml"), "waist", 10.8)}  # where it is pushed, kg
if not QUICK:
    ROBOTS.update({"P3": (of("walk_pushes.yaml", P3_STATE, **P3), "waist", 10.8),
                   "RABBIT": (of("rabbit_walks.yaml", **PUSHED), "hip", 40)})


def critical(name, s, of, grid=(), count=COUNT, start=8 if QUICK else 32):
    """The largest value, from 0 or its first one on, at which it walks, at each point of the grid."""
    path = FOLDER / f"{name}.yaml"
    s.copy().set({"sweep.grid": list(grid)} if grid else {}).save(path)
    words = "--of", of, "--count", str(count), "--start", str(start), "--json", "--quiet", "--force"
    return json.loads(subprocess.run([stance.program(), "critical", path, *words, "-o", FOLDER / f"{name}.h5"], check=True,
                                     capture_output=True, text=True).stdout)["rows"]


def wilson(k, n, z=1.96):
    middle, half = (k + z * z / 2) / (n + z * z), z * np.sqrt(k * (n - k) / n + z * z / 4) / (n + z * z)
    return max(0, middle - half), min(1, middle + half)


def rough(s, length, heights, grounds, grid=(), steps=STEPS):
    """Which of the grounds, in plates a third of a step wide, are walked: by member of the grid, height and ground."""
    s = s.copy().set({"ground.plates": {"field": {"kind": "rough", "from": length / 2, "width": length / 3, "height": 0}},
                      "stop.walks": {"steps": 1000, "enough": steps}, "record.answers": ["outcome"], "sweep.grid": [
                          *grid, {"path": "ground.plates.field.height", "values": list(heights)},
                          stance.axis("ground.plates.field.seed", 0, grounds - 1, grounds)]})
    return s.run(output=FOLDER / f"rough{id(s)}.h5", force=True).outcome.values == "walks"


def steps_of(length):
    return {"ground.plates": {"step": {"footfall": 3, "from": length / 2, "height": 0}}}


def in_step(s, period):
    """The same, begun after a third of a step, so that no foot is in a ground that slopes."""
    state = s.copy().set({"record.answers": ["final_state"], "stop.time": round(period / 3, 3)}).run(
        output=FOLDER / f"in{id(s)}.h5", force=True).final_state[0]
    return s.copy().set({"initial.state": {name: float(state.sel(state=name)) for name in s["initial.state"]}})


def table(name):
    s, hip, mass = ROBOTS[name]
    gait = s.gait()
    period, length, rows = gait["period"], gait["step_length"], []

    def row(what, unit, found, factor=1):
        low, high = sorted(abs(factor * found[end]) if found[end] is not None else np.nan for end in ("kept", "lost"))
        rows.append([name, what, unit, abs(factor * found["kept"]) if found["kept"] is not None else np.nan, low, high])

    phases = [{"paths": [f"robot.points.{hip}.{end}" for end in ("from", "to")],
               "values": [[k / 4 * period, k / 4 * period + 0.1] for k in range(4)]}]
    for way, sign in (("forwards", 1), ("backwards", -1)):
        found = critical(name, s, f"robot.points.{hip}.force[0]=0..{sign * 20 * mass}", phases)
        for k, one in enumerate(found):
            row(f"push {way} at {k}/4", "N s", one, 0.1)
    for way, sign in (("down", -1), ("up", 1)):
        one, = critical(name, s.copy().set(steps_of(length)), f"ground.plates.step.height=0..{0.1 * sign}")
        row(f"step {way}", "mm", one, 1000)
    for way, sign in (("down", 1), ("up", -1)):
        row(f"slope {way}", "rad", critical(name, in_step(s, period), f"ground.slope=0..{0.12 * sign}")[0])
    row("least friction", "", critical(name, s, f"ground.friction={s['ground.friction']}..0")[0])
    rate = next(key for key in gait["state"] if key[0] == "v")
    draws = {"method": "random", "count": 8 if QUICK else 40, "vary": [
        {"path": f"initial.state.{rate}", "from": gait["state"][rate] - 1e-9, "to": gait["state"][rate] + 1e-9}]}
    row("noise, 90 % walk", "N m", critical(name, s.copy().set({"sweep.sample": draws, "stop.walks.steps": 1000}),
                                            f"controller.noise=0..{2 * mass}", count=33, start=8)[0])
    row("delay", "ms", critical(name, s, "controller.delay=0..16", count=17, start=16)[0])
    heights = (0.001, 0.002, 0.005)
    for height, walked in zip(heights, rough(s, length, heights, GROUNDS)):
        rows.append([name, f"share of grounds of {1000 * height:g} mm", "", walked.mean(), *wilson(walked.sum(), GROUNDS)])
    spread = norms(s, length)
    rows += [[name, "largest multiplier", "", gait["multipliers"][0]["modulus"], np.nan, np.nan],
             [name, "step time by 1 mm of ground", "ms", spread["norm_period"], np.nan, np.nan]]
    return rows


def norms(s, length):
    """What is cheap: of one gait, without a push or a step that it falls over."""
    s = s.copy().set({"ground.plates": {"step": {"footfall": 1, "from": length / 2, "height": 0}}})
    g = s.gait(sensitivity={"ground.plates.step.height": (-1e-3, 1e-3)}, settle=60)
    by, = g["sensitivity"]
    deviation = 2 / 12**0.5  # mm
    return {"multiplier": g["multipliers"][0]["modulus"], "norm_period": 1e3 * by["period"] / deviation,
            "norm_length": 1e3 * by["step_length"] / deviation, "norm_speed": 1e3 * by["speed"] / deviation,
            "relative": by["period"] / g["period"] / deviation, "clearance": 1e3 * g["clearance"], "speed": g["speed"],
            "length": g["step_length"], "state": g["state"]}


def drawn(name):
    """Numbers of a law like that of a robot."""
    u = random.uniform
    if name == "P3":
        return outputs(u(-0.28, -0.05), u(0.2, 0.5), u(9, 15), u(0.6, 1.3))
    if name == "P1":
        return outputs(u(-0.22, -0.08), u(0.2, 0.35), u(6, 11), u(0.4, 1.1))
    s = ROBOTS[name][0]
    change = {f"{Y}y{i}.{key}": value for i in range(1, 5) for key, value in (("proportional", 0), ("derivative", 0))}
    frequency, damping, lean = u(8, 16), u(0.6, 1.3), u(-0.06, 0.03)
    for i in range(1, 5):
        along = np.array(s[f"{Y}y{i}.along"])
        inner = along[1:-1] + u(-0.04, 0.04, size=4)
        along = np.concatenate([along[:1], inner, along[-1:]]) + (lean if i == 1 else 0)
        change[f"{Y}y{i}.along"] = along.tolist()
        change[f"{Y}y{i}.proportional"], change[f"{Y}y{i}.derivative"] = frequency**2, 2 * damping * frequency
    return change


def numbers(change):
    """Paths of single numbers, as an axis has them."""
    flat = {}
    for path, value in change.items():
        flat.update({f"{path}[{k}]": v for k, v in enumerate(value)} if isinstance(value, list) else {path: value})
    return flat


def family(name, changes):
    """Of those that walk and come to a gait of one step: what is cheap, and how robust they are."""
    s = ROBOTS[name][0]
    own = s.gait()["step_length"]
    axis = {"paths": list(numbers(changes[0])), "values": [list(numbers(c).values()) for c in changes]}
    walks = s.copy().set({"sweep.grid": [axis]}).run(output=FOLDER / f"{name}-walks.h5").outcome.values == "walks"

    def cheap(change):
        one = s.copy().set(change)
        try:
            return norms(one, own)
        except stance.Error:
            return None  # it limps, or wanders

    gaits = [(c, cheap(c)) for c, walk in zip(changes, walks) if walk]
    gaits = [(c, g) for c, g in gaits if g and g["multiplier"] < 1]
    if not gaits:
        return []
    print(f"{name}: {len(gaits)} of {len(changes)} laws walk", file=sys.stderr, flush=True)
    members = [{**numbers(c), **{f"initial.state.{key}": v for key, v in g["state"].items()}} for c, g in gaits]
    axis = {"paths": list(members[0]), "values": [list(m.values()) for m in members]}
    length = float(np.median([g["length"] for _, g in gaits]))
    score = rough(s, length, [0.001, 0.002, 0.004, 0.008], 2 if QUICK else 12, [axis], 30).mean(axis=(1, 2))
    steps = [critical(f"{name}-{sign}", s.copy().set(steps_of(length)), f"ground.plates.step.height=0..{0.1 * sign}", [axis],
                      min(COUNT, 257)) for sign in (-1, 1)]
    return [{"family": name, **{key: v for key, v in g.items() if key != "state"}, "down": -1e3 * (down["kept"] or 0),
             "up": 1e3 * (up["kept"] or 0), "both": 1e3 * min(-(down["kept"] or 0), up["kept"] or 0), "rough": rough_share}
            for (_, g), rough_share, down, up in zip(gaits, score, *steps)]


def correlation(x, y, draws=2000):
    """Spearman's, with its bootstrap interval."""
    def rho(pick):
        a, b = (pd.Series(v[pick]).rank().to_numpy() for v in (x, y))
        return np.corrcoef(a, b)[0, 1] if a.std() > 0 and b.std() > 0 else np.nan
    n = len(x)
    found = [rho(random.integers(0, n, n)) for _ in range(draws)]
    return [rho(np.arange(n)), *np.nanquantile(found, [0.025, 0.975])]


PREDICTORS = {"multiplier": "largest multiplier", "norm_period": "norm of the step's time", "norm_length": "... of its length",
              "norm_speed": "... of speed", "relative": "... of time by time", "clearance": "foot's clearance", "speed": "speed"}
MEASURES = {"down": "step down", "up": "step up", "both": "the lesser", "rough": "rough grounds"}


def main():
    RESULTS.mkdir(exist_ok=True)
    names = list(ROBOTS)
    laws = [[drawn(name) for _ in range(DRAWN)] for name in names]
    with ThreadPoolExecutor(2) as two:
        rows = two.map(table, names)
        gaits = pd.DataFrame([member for members in two.map(family, names, laws) for member in members])
        rows = [row for of_robot in rows for row in of_robot]
    gaits.to_csv(RESULTS / "robust_gaits.csv", index=False)
    with open(RESULTS / "robustness.csv", "w", newline="", encoding="utf-8") as out:
        csv.writer(out).writerows([["robot", "what", "unit", "value", "low", "high"], *rows])
    print(pd.DataFrame(rows, columns=["robot", "what", "unit", "value", "low", "high"]).pivot(
        index="what", columns="robot", values="value").reindex(dict.fromkeys(r[1] for r in rows)).to_string())
    found = [[name, predictor, measure, len(of_name), *correlation(of_name[predictor].to_numpy(), of_name[measure].to_numpy())]
             for name, of_name in gaits.groupby("family", sort=False) for predictor in PREDICTORS for measure in MEASURES]
    found = pd.DataFrame(found, columns=["family", "predictor", "measure", "gaits", "rho", "low", "high"])
    found.to_csv(RESULTS / "robust_correlations.csv", index=False)
    for (name, n), of_name in found.groupby(["family", "gaits"], sort=False):
        print(f"\n{name}: {n} gaits; Spearman's rank correlation with how robust they are, 95 %\n{'':27}"
              + "".join(f"{says:25}" for says in MEASURES.values()))
        for predictor, says in PREDICTORS.items():
            cells = of_name[of_name["predictor"] == predictor].itertuples()
            print(f"  {says:25}" + "".join(f"{c.rho:+.2f} ({c.low:+.2f} ... {c.high:+.2f})  " for c in cells))
    draw(found)


def draw(found):
    lines = [f"folder = '{RESULTS}'; style = '{HERE.parents[1] / 'analysis/draw/style.gp'}'", "array said[2]"]
    for k, predictor in enumerate(("norm_period", "multiplier")):
        of_it = found[(found["predictor"] == predictor) & (found["measure"] == "rough")].itertuples()
        says = [f"{c.family}: {c.rho:+.2f} ({c.low:+.2f} ... {c.high:+.2f})".replace(" ", "\u00a0") for c in of_it]
        lines.append(f"said[{k + 1}] = '{' '.join(says)}'")
    subprocess.run(["gnuplot", "-", HERE / "robustness.gp"], input="\n".join(lines), check=True, text=True)


if __name__ == "__main__":
    main()
