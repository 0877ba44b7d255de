#!/usr/bin/python3
"""What `stance` says and draws of the file of a search, against the file.

    searches.py STANCE

In the current folder. Speaks TAP.
"""
import json
import math
import os
import re
import shutil
import signal
import subprocess
import sys

import h5py
import numpy as np

from drawn import Picture
from tap import PATIENCE, tap

STANCE = sys.argv[1]
STABILISED = 2 # place in `kind`

with open("box.yaml", "w", encoding="utf-8") as scenario:
    scenario.write("""\
stance: 1
title: Gains on one foot
scene: biped
robot: {leg_length: 0.535, trunk_length: 0.535, foot_mass: 1.8, trunk_mass: 1.8, hip_mass: 5.4}
ground: {friction: 0.8, restitution: 0, contacts: [foot1]}
initial: {equilibrium: {theta: -0.41, q2: 0.82}, support_foot: 1}
controller:
  kind: state-feedback
  design: place
  poles: [-3, -3.3, -3.6, -3.9, -4.2, -4.6]
  sample_time: 0.002
  torque_limit: 10
method: {name: midpoint, step: 0.002}
stop: {time: 5}
sweep:
  sample:
    method: sobol
    count: 64
    vary:
      - {path: initial.offset.theta, from: -0.1, to: 0.1}
      - {path: initial.offset.vtheta, from: -0.5, to: 0.5}
optimise:
  vary: gains
  candidates: 40
  grow: [64, 128]
  confirm: 512
seed: 1
""")


def call(*arguments, code=0, **environment):
    """Lines of what is printed, and of what is said."""
    ran = subprocess.run([STANCE, *arguments], capture_output=True, text=True, check=False, timeout=PATIENCE, env=dict(os.environ, **environment))
    assert ran.returncode == code, (arguments, ran.returncode, ran.stdout, ran.stderr)
    return ran.stdout.splitlines(), ran.stderr.splitlines()


def search(name, *settings, code=0, options=()):
    call("optimise", "box.yaml", *[word for s in settings for word in ("--set", s)], "--quiet", "--force", *options, "-o", f"{name}-search.h5", code=code)
    return f"{name}-search.h5"


def summary(*files):
    return json.loads("\n".join(call("summary", *files, "--json")[0]))


def wilson(k, n, z=1.959963984540054):
    p = k / n
    half = z * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n)) / (1 + z * z / n)
    middle = (p + z * z / (2 * n)) / (1 + z * z / n)
    return middle - half, middle + half


FOUR = "sweep.grid=[{path: ground.friction, values: [0.8, 0.3]}, {path: controller.delay, values: [0, 4]}]"


# ---- summary -----------------------------------------------------------------------------------

def shares():
    search("one")
    said = summary("one-search.h5")
    with h5py.File("one-search.h5") as f:
        outcome, chosen = f["confirmed_outcome"][...], int(f.attrs["chosen"][0])
        recovered = outcome[:, 0] == STABILISED
        assert said["finished"] and said["fresh_starts"] == 512 and said["generations"] == len(f["generation"])
        assert len(said["confirmed"]) == len(outcome) and said["confirmed"][chosen]["chosen"]
        for k, row in enumerate(said["confirmed"]):
            count = recovered[k].sum()
            assert row["share"] == count / 512 == row["objective"], (k, row)
            assert np.allclose((row["low"], row["high"]), wilson(count, 512)), (k, row)
            training = f["confirmed_training"][k]
            assert row["training"] is None if np.isnan(training) else row["gap"] == training - row["objective"], (k, row)
        won, lost = (recovered[chosen] & ~recovered[0]).sum(), (recovered[0] & ~recovered[chosen]).sum()
        only, best = said["circumstances"][0], said["chosen"]
        for row in (only, best):
            assert (row["won"], row["lost"]) == (won, lost) and math.isclose(row["gain"], (won - lost) / 512, abs_tol=1e-15)
            d, n = won - lost, 514
            half = 1.959963984540054 * math.sqrt(won + lost + 1 - d * d / n) / n
            assert np.allclose((row["gain_low"], row["gain_high"]), (d / n - half, d / n + half)), row
        assert only["allowed"] == said["linear_limit"] == f.attrs["linear_limit"][0]
        assert sum(best["starts"].values()) == 512 and best["starts"]["stabilised"] == recovered[chosen].sum()
        assert [e["where"] for e in said["elsewhere"]] == [w.decode() for w in f["elsewhere"][...]]
        gains = np.array(best["gains"])
        assert np.array_equal(gains.ravel(), f["confirmed_value"][chosen]) and gains.shape == (2, 6)


def gains_to_paste():
    """The printed lines are a scenario's, and what theory says of it is what was printed."""
    text = "\n".join(call("summary", "one-search.h5")[0])
    lines = re.search(r"gains:\n((?: +- \[.*\]\n)+)", text).group(1)
    rows = [line.strip()[2:] for line in lines.splitlines()]
    design = "\n".join(call("design", "one-best.yaml", "--set", f"controller.gains=[{', '.join(rows)}]")[0])
    critical = float(re.search(r"critical sample time ([\d.]+) s, of", text).group(1))
    assert re.search(r"[Cc]ritical", design), design
    poles = summary("one-search.h5")["chosen"]["poles"]
    theirs = json.loads("\n".join(call("design", "one-best.yaml", "--json")[0]))
    assert critical > 0 and len(poles) == 6 and all(real < 0 for real, _ in poles)
    numbers = np.array([float(n) for n in re.findall(r"-?\d+\.\d+(?:e[-+]?\d+)?", json.dumps(theirs))])
    assert all(np.isclose(numbers, real, rtol=1e-9).any() for real, _ in poles), (poles, theirs)


def circumstances():
    for over in ("mean", "worst"):
        search(over, FOUR, f"optimise.over={over}", "optimise.confirm=256")
        said = summary(f"{over}-search.h5")
        with h5py.File(f"{over}-search.h5") as f:
            recovered, chosen = f["confirmed_outcome"][...] == STABILISED, int(f.attrs["chosen"][0])
            whole = (np.mean if over == "mean" else np.min)(recovered.mean(axis=2), axis=1)
            assert np.allclose([row["share"] for row in said["confirmed"]], whole)
            assert all(row["low"] < row["share"] < row["high"] for row in said["confirmed"])
            assert len(said["circumstances"]) == 4
            for c, row in enumerate(said["circumstances"]):
                assert math.isclose(row["chosen"], recovered[chosen, c].mean()) and math.isclose(row["first"], recovered[0, c].mean())
            gain = (recovered[chosen] ^ recovered[0]).sum()
            assert said["chosen"]["won"] + said["chosen"]["lost"] == gain
        text = "\n".join(call("summary", f"{over}-search.h5")[0])
        assert ("in the worst of 4 circumstances" if over == "worst" else "mean of 4 circumstances") in text
        assert "linear theory allows any" in text and "possible" not in text, text


def limits():
    """Beside a share stands the limit of the circumstances in which it was counted, with the name of the worst."""
    grid = "sweep.grid=[{path: controller.torque_limit, values: [10, 8]}]"
    for over, whole in (("mean", np.mean), ("worst", np.min)):
        printed = call("optimise", "box.yaml", "--set", grid, "--set", f"optimise.over={over}", "--set", "optimise.confirm=256", "--set", "optimise.candidates=11",
                       "--set", "optimise.grow=[32]", "--force", "-o", "limits-search.h5")[0][0]
        said = summary("limits-search.h5")
        allowed = [row["allowed"] for row in said["circumstances"]]
        limit, place = whole(allowed), "controller.torque_limit = 8"
        assert allowed[1] < allowed[0] - 0.05 and math.isclose(said["linear_limit"], limit), said["circumstances"]
        assert said["linear_limit_in"] == (place if over == "worst" else None), said["linear_limit_in"]
        wanted = f"linear theory allows any {100 * limit:.2f} %" + (f" in its worst circumstance ({place});" if over == "worst" else ";")
        assert wanted in printed, printed
        with h5py.File("limits-search.h5", "a") as f: # files of earlier versions have that of the first
            f.attrs["linear_limit"] = [allowed[0]]
        assert math.isclose(summary("limits-search.h5")["linear_limit"], limit)
        text = " ".join("\n".join(call("summary", "limits-search.h5")[0]).split())
        assert f"{100 * limit:.2f} % is what linear theory allows any controller " + (f"in its worst circumstance, {place}:" if over == "worst" else "there:") in text, text


def honest():
    """The chosen one is chosen by starts of its own: few of them promise too much, the fresh ones do not."""
    choice, fresh, best = [], [], []
    for seed in range(1, 17):
        search("honest", f"seed={seed}", "optimise.confirm=16", "optimise.candidates=33", "optimise.grow=[8]", "optimise.restarts=1", "optimise.first_step=0.02")
        rows = summary("honest-search.h5")["confirmed"]
        place, = (k for k, row in enumerate(rows) if row["chosen"])
        assert place == np.argmax([row["choice"] for row in rows])
        choice.append(rows[place]["choice"] - rows[0]["choice"])
        fresh.append(rows[place]["objective"] - rows[0]["objective"])
        best.append(max(row["objective"] for row in rows) - rows[0]["objective"])
    print(f"# gain over the first, mean of 16 searches: {np.mean(choice):.3f} by the starts of the choice, {np.mean(fresh):.3f} of fresh ones; the largest of these {np.mean(best):.3f}")
    assert np.mean(fresh) < np.mean(choice) and np.mean(fresh) < np.mean(best)


def older():
    """A file of a version that chose by the fresh starts is read, and told as such."""
    shutil.copy("one-search.h5", "older-search.h5")
    with h5py.File("older-search.h5", "a") as f:
        del f["choice_score"], f["choice_objective"]
    said, new = summary("older-search.h5"), summary("one-search.h5")
    assert all(row.pop("choice") is None for row in said["confirmed"]) and all(row.pop("choice") is not None for row in new["confirmed"])
    assert said["confirmed"] == new["confirmed"]
    text, now = ("\n".join(call("summary", f"{name}-search.h5")[0]) for name in ("older", "one"))
    assert "chosen, by these very starts, as in files of earlier versions: too high" in text and " choice" not in text, text
    assert "chosen, for the largest choice: the objective of as many other starts" in now, now


def other_aims():
    """What is no share is printed as a number beside the share."""
    search("priced", "optimise.price.friction_used=0.3", "optimise.confirm=64")
    rows = summary("priced-search.h5")["confirmed"]
    assert all(row["objective"] < row["share"] for row in rows if row["share"] > 0)
    text = "\n".join(call("summary", "priced-search.h5")[0])
    assert "less 0.3 of each friction_used" in text and "recovered %" in text, text
    head, *lines = call("summary", "priced-search.h5", "--csv")[0]
    assert head.startswith("which,candidate,share,low,high,objective") and len(lines) == len(rows)


def numbers_beside_gains():
    search("posture", "optimise.vary=[gains, {path: initial.equilibrium.q2, from: 0.6, to: 1}]", "optimise.confirm=64")
    text = "\n".join(call("summary", "posture-search.h5")[0])
    assert re.search(r"initial.equilibrium.q2  0.6 ... 1 rad", text) and re.search(r"  initial.equilibrium.q2 = \d", text), text
    assert "controller.gains  12 of them" in text and "controller.gains[" not in text, text


def unfinished():
    call("optimise", "box.yaml", "--quiet", "--time-limit", "1s", "--set", "optimise.candidates=100000", "-o", "cut-search.h5", code=4)
    said = summary("cut-search.h5")
    assert not said["finished"] and said["confirmed"] == [] and said["chosen"] is None and said["circumstances"] == []
    assert 0 < said["generations"] < said["most_generations"]
    text = "\n".join(call("summary", "cut-search.h5")[0])
    assert "Not finished" in text and "stance optimise SCENARIO --resume goes on" in text and "nan" not in text, text


def damaged():
    """One line, and none of the numbers."""
    with open("one-search.h5", "rb") as file:
        data = bytearray(file.read())
    for name, bad in (("short", data[: len(data) // 2]), ("empty", b""), ("flipped", None)):
        if bad is None:
            with h5py.File("one-search.h5") as f:
                place = f["confirmed_outcome"].id.get_offset() + 100
            bad = bytearray(data)
            bad[place] ^= 1
        with open(f"{name}.h5", "wb") as file:
            file.write(bad)
        for command in ("summary", "plot", "status"):
            printed, told = call(command, f"{name}.h5", code=3)
            assert not printed and len(told) == 1 and f"{name}.h5" in told[0], (command, name, printed, told)
    shutil.copy("one-search.h5", "hostile.h5")
    with h5py.File("hostile.h5", "a") as f: # a place that is not there
        f.attrs["chosen"] = np.array([99])
    assert len(call("summary", "hostile.h5", code=3)[1]) == 1


def status():
    said = json.loads("\n".join(call("status", "cut-search.h5", "--json")[0]))
    other = summary("cut-search.h5")
    assert not said["finished"] and not said["running"] and said["seconds_left"] is None and said["chosen_objective"] is None
    assert all(said[key] == other[key] for key in ("generations", "most_generations", "candidates", "best", "best_objective")), (said, other)
    line, = call("status", "cut-search.h5")[0]
    assert line.startswith(f"cut-search.h5: generation {said['generations']} of at most ") and "not running (stance optimise --resume goes on)" in line, line
    line, = call("status", "one-search.h5")[0]
    chosen, = (row["objective"] for row in summary("one-search.h5")["confirmed"] if row["chosen"])
    assert f"best {chosen:.4g} of 512 fresh starts; finished: " in line, line


def running():
    """While it is at work it tells of itself, with the ranks and an end in sight."""
    with subprocess.Popen([STANCE, "optimise", "box.yaml", "--quiet", "--set", "optimise.candidates=1000000", "-o", "long-search.h5"]) as process:
        line = ""
        while " left" not in line and process.poll() is None:
            ran = subprocess.run([STANCE, "status", "long-search.h5"], capture_output=True, text=True, check=False)
            line = ran.stdout
        said = json.loads("\n".join(call("status", "long-search.h5", "--json")[0]))
        process.send_signal(signal.SIGTERM)
        assert process.wait(PATIENCE) == 4
    assert re.search(r"generation \d+ of at most \d+, \d+ candidates, best .* starts; running on 1 rank.* left$", line.strip()), line
    assert said["running"] and said["ranks"] == 1 and said["seconds_left"] > 0, said


def other_commands():
    """Each in a line says what the file is and what reads it; the file stays."""
    with open("one-search.h5", "rb") as file:
        before = file.read()
    search("two", "seed=2")
    told = r"one-search.h5: of a search \(stance optimise\), not a results file: stance summary, plot and status read it"
    call("run", "box.yaml", "--quiet", "-o", "run.h5")
    for command in (["table", "one-search.h5"], ["basin", "one-search.h5"], ["sensitivity", "one-search.h5"], ["replay", "one-search.h5", "--case", "1"],
                    ["compare", "one-search.h5", "two-search.h5"], ["compare", "run.h5", "one-search.h5"], ["merge", "out.h5", "one-search.h5", "two-search.h5"],
                    ["run", "box.yaml", "--resume", "-o", "one-search.h5"], ["plot", "run.h5", "one-search.h5", "--outline"]):
        printed, said = call(*command, code=3)
        assert not printed and len(said) == 1 and re.search(told, said[0]), (command, said)
    assert "not the file of a search" in call("optimise", "box.yaml", "--resume", "-o", "run.h5", code=3)[1][0]
    with open("one-search.h5", "rb") as file:
        assert file.read() == before


# ---- pictures ----------------------------------------------------------------------------------

def convergence():
    """Dots are candidates, lines what fresh starts said; names stand at the ends of the means, none over another."""
    printed, said = call("plot", "one-search.h5", "-o", "drawn")
    assert [os.path.basename(p) for p in printed] == [f"one-search-{p}.{f}" for p in ("convergence", "starts") for f in ("svg", "png")] and not said
    p = Picture("drawn/one-search-convergence.svg")
    with h5py.File("one-search.h5") as f:
        worth, mean, width, means = p.panels[0], p.panels[1], p.panels[2], f["mean"][...] - f["coordinate"][0]
        dots = worth.marks("8a8a8a")
        # The dots that are seen, beside the legend's.
        assert len(dots) == len(f["candidate"])
        assert np.allclose(worth.y(dots[:, 1]), 100 * f["objective"][...], atol=0.3)
        chosen = int(f.attrs["chosen"][0])
        level = {hue: [line for stroke, _, line in worth.lines if stroke == hue and abs(line[0][1] - line[-1][1]) < 0.1 and len(line) > 1]
                 for hue in ("d55e00", "0072b2", "009e73")}
        for hue, value in (("d55e00", f["confirmed_objective"][0]), ("0072b2", f["confirmed_objective"][chosen]), ("009e73", f.attrs["linear_limit"][0])):
            assert any(abs(worth.y(line[0][1]) - 100 * value) < 0.3 for line in level[hue]), (hue, value)
        assert {"64 starts", "128 starts"} <= set(p.said())
        names = [(t, y) for _, y, t, turned in p.texts if re.match(r"hip[12] v?(theta|q1|q2)$", t) and not turned]
        assert len(names) == 12 and len({t for t, _ in names}) == 12
        heights = sorted(y for _, y in names)
        assert min(np.diff(heights)) > 9, heights
        order = [t for t, _ in sorted(names, key=lambda n: -n[1])]
        columns = [f"hip{i} {c}" for i in (1, 2) for c in ("theta", "q1", "q2", "vtheta", "vq1", "vq2")]
        assert order == [columns[k] for k in np.argsort(means[-1], kind="stable")], order
        black = [line for stroke, _, line in width.lines if stroke == "000000"]
        assert np.allclose(width.y(np.array(black[-1])[:, 1], True), f["step"][...], rtol=0.02)
        first = [line for stroke, dashed, line in mean.lines if stroke == "0072b2" and not dashed and len(line) == len(means)]
        assert np.allclose(mean.y(np.array(first[0])[:, 1]), means[:, 0], atol=0.02 * np.ptp(means)), first


def marginal_shares():
    """Each panel's parts have equally many starts, and their mean is the share of all."""
    p = Picture("drawn/one-search-starts.svg")
    assert {"theta (rad)", "vtheta (rad/s)", "share of the starts (%)"} <= set(p.said())
    with h5py.File("one-search.h5") as f:
        recovered, chosen = f["confirmed_outcome"][:, 0] == STABILISED, int(f.attrs["chosen"][0])
        for column, panel in enumerate(p.panels):
            order = np.argsort(f["start_value"][:, column], kind="stable")
            for hue, k in (("d55e00", 0), ("0072b2", chosen)):
                marks = panel.marks(hue)
                parts = len(marks)
                ends = [i * 512 // parts for i in range(parts + 1)]
                mine = [100 * recovered[k][order[a:b]].mean() for a, b in zip(ends, ends[1:])]
                assert parts == 12 and np.allclose(panel.y(marks[:, 1]), mine, atol=0.4), (panel.y(marks[:, 1]), mine)
            allowed = panel.y(panel.marks("009e73")[:, 1])
            assert abs(np.mean(allowed) - 100 * f.attrs["linear_limit"][0]) < 0.5
    assert len(p.panels) == 2


def sizes_of_pictures():
    for name in ("one", "worst", "priced", "posture"):
        for size in ("column", "page"):
            printed, _ = call("plot", f"{name}-search.h5", "--for", size, "-o", "sized")
            assert [os.path.basename(p) for p in printed] == [f"{name}-search-{p}.pdf" for p in ("convergence", "starts")]
    printed, _ = call("plot", "cut-search.h5", "--format", "svg")
    assert printed == ["cut-search-convergence.svg"]
    assert any("not finished" in t for t in Picture(printed[0]).said())
    printed, said = call("plot", "one-search.h5", "--picture", "starts", "-o", "alone.png")
    assert printed == ["alone.png"] and not said
    for option in (["--case", "3"], ["--answer", "friction_used"], ["--outline"]):
        printed, said = call("plot", "one-search.h5", *option, code=2)
        assert not printed and len(said) == 1 and "a search has no cases" in said[0], said


def fronts():
    """Of several searches: what differs, rising, one row each; the picture shows the same."""
    limits = (14, 8, 10)
    for k, limit in enumerate(limits):
        search(f"limit{limit}", f"controller.torque_limit={limit}", f"seed={k}", "optimise.confirm=128")
    files = [f"limit{limit}-search.h5" for limit in limits]
    front = summary(*files)
    assert front["against"] == "controller.torque_limit" and front["unit"] == "N m" and front["also"] == "seed", front
    assert [row["controller.torque_limit"] for row in front["searches"]] == [8, 10, 14]
    for row in front["searches"]:
        one = summary(row["file"])
        first, chosen = one["confirmed"][0], next(c for c in one["confirmed"] if c["chosen"])
        assert row["file"] == f"limit{row['controller.torque_limit']:g}-search.h5"
        assert (row["first"], row["chosen"], row["chosen_low"], row["chosen_high"], row["allowed"]) == \
            (first["share"], chosen["share"], chosen["low"], chosen["high"], one["linear_limit"]), (row, one)
    head, *lines = call("summary", *files, "--csv")[0]
    assert head.startswith("controller.torque_limit,first,first_low,first_high,chosen,") and len(lines) == 3
    printed, said = call("plot", *files, "--format", "svg", "-o", "front")
    assert printed == ["front/limit14-search-front.svg"] or printed == ["front/limit8-search-front.svg"], (printed, said)
    panel = Picture(printed[0]).panels[0]
    for hue, key in (("d55e00", "first"), ("0072b2", "chosen")):
        drawn = np.sort(panel.y(panel.marks(hue)[:, 1]))
        assert np.allclose(drawn, sorted(100 * row[key] for row in front["searches"]), atol=0.3), (key, drawn)
    # What is no front is said.
    for wrong, word in ((["one-search.h5", "one-search.h5"], "no number of their scenarios differs"), (["one-search.h5", "two-search.h5"], "no number"),
                        (["one-search.h5", "cut-search.h5"], "not finished"), (["one-search.h5", "run.h5"], "not the file of a search")):
        for command in ("summary", "plot"):
            printed, said = call(command, *wrong, code=3)
            assert not printed and len(said) == 1 and word in said[0], (command, wrong, said)
    assert "one results file" in call("summary", "run.h5", "one-search.h5", code=2)[1][0]
    assert "--outline" in call("plot", "run.h5", "one-search.h5", code=2)[1][0]


if __name__ == "__main__":
    tap([shares, gains_to_paste, circumstances, limits, honest, older, other_aims, numbers_beside_gains, unfinished, damaged, status, running, other_commands, convergence, marginal_shares,
         sizes_of_pictures, fronts])
