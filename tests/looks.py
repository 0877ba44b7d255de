#!/usr/bin/python3
"""What options make of pictures: files, sizes, fonts, names, colours.

    looks.py STANCE SCENARIOS

In the current folder; needs poppler-utils. Speaks TAP.
"""
import os
import pty
import re
import select
import shutil
import subprocess
import sys
import xml.etree.ElementTree

import h5py
import numpy as np

from drawn import Picture, gif
from tap import PATIENCE, tap

SVG = "{http://www.w3.org/2000/svg}"
STANCE, SCENARIOS = sys.argv[1:]
MAP = ["sweep.grid[0].values=[0.1, 0.8]", "sweep.grid[1].count=9", "sweep.grid[2].count=7", "record.cases=none"]


def call(*arguments, code=0, **environment):
    """Lines of what is printed, and of what is said."""
    ran = subprocess.run([STANCE, *arguments], capture_output=True, text=True, check=False, env=dict(os.environ, **environment))
    assert ran.returncode == code, (arguments, ran.returncode, ran.stderr)
    return ran.stdout.splitlines(), ran.stderr.splitlines()


def run(name, scenario, *settings):
    call("run", f"{SCENARIOS}/{scenario}", *[word for s in settings for word in ("--set", s)], "--quiet", "-o", f"{name}.h5")


def text_of(command, *arguments):
    return subprocess.run([command, *arguments], capture_output=True, text=True, check=True).stdout


def is_whole(file, width, height=None):
    """A page of a width (and height) in mm with all its fonts, all of whose words are on it and apart; those words."""
    page = [float(x) for x in re.search(r"Page size: +([\d.]+) x ([\d.]+)", text_of("pdfinfo", file)).groups()]
    assert abs(page[0] - width * 72 / 25.4) < 1 and (not height or abs(page[1] - height * 72 / 25.4) < 1), page
    fonts = text_of("pdffonts", file).splitlines()[2:]
    assert fonts and all(f.split()[-5] == "yes" for f in fonts), fonts # embedded
    words = re.findall(r'<word xMin="(.*?)" yMin="(.*?)" xMax="(.*?)" yMax="(.*?)">(.*?)</word>', text_of("pdftotext", "-bbox", file, "-"))
    for left, top, right, bottom, word in words:
        assert 0 <= float(left) and float(right) <= page[0] and 0 <= float(top) and float(bottom) <= page[1], (word, left, right, page)
    boxes = [[float(x) for x in w[:4]] for w in words]
    for k, a in enumerate(boxes):
        for m, b in enumerate(boxes[:k]):
            apart = max(max(a[0], b[0]) - min(a[2], b[2]), max(a[1], b[1]) - min(a[3], b[3]))
            assert apart > -2.5, (words[k], words[m]) # pt: letters do not fill their boxes
    return [w[-1] for w in words]


# ---- files, sizes, names -----------------------------------------------------------------------

def one_file():
    run("map", "friction_sweep.yaml", *MAP)
    printed, said = call("plot", "map.h5", "--for", "column", "-o", "fig.pdf")
    assert printed == ["fig.pdf"] and said == ["fig.pdf: the picture map; others by --picture: settle_time, curve"], (printed, said)
    words = is_whole("fig.pdf", 88)
    assert "stabilised" in words and "One-foot" not in words, words # the caption has the title
    for picture in ("settle_time", "curve"):
        for size, width in (("column", 88), ("page", 180)):
            printed, said = call("plot", "map.h5", "--for", size, "--picture", picture, "-o", "new/fig.pdf")
            assert (printed, said) == (["new/fig.pdf"], []), (printed, said)
            is_whole("new/fig.pdf", width)
    assert os.listdir("new") == ["fig.pdf"]
    os.mkdir("directory.pdf")
    assert call("plot", "map.h5", "--picture", "map", "--format", "pdf", "-o", "directory.pdf")[0] == ["directory.pdf/map-map.pdf"]


def sizes():
    call("plot", "map.h5", "--size", "120x90", "--font", "DejaVu Serif,7", "--format", "svg,pdf", "-o", "sized")
    assert sorted(os.listdir("sized")) == sorted(f"map-{p}.{f}" for p in ("map", "settle_time", "curve") for f in ("svg", "pdf"))
    with open("sized/map-map.svg", encoding="utf-8") as file:
        assert re.search(r'width="120.00mm" height="(89|90)\.\d\dmm"', file.read(2000))
    assert "One-foot" in is_whole("sized/map-map.pdf", 120, 90)
    assert all("Serif" in f for f in text_of("pdffonts", "sized/map-map.pdf").splitlines()[2:])
    is_whole("sized/map-curve.pdf", 120, 90)
    printed, said = call("plot", "map.h5", "--size", "60x40", "--picture", "map", "-o", "small.pdf", code=3)
    assert not printed and len(said) == 1 and re.match(r"the picture needs \d+ x \d+ mm with text of this size: a larger --size, or shorter --labels$", said[0]), said
    width, height = re.findall(r"\d+", said[0])
    call("plot", "map.h5", "--size", f"{width}x{height}", "--picture", "map", "-o", "small.pdf")
    is_whole("small.pdf", float(width), float(height))


def names():
    printed, said = call("plot", "map.h5", "--picture", "map", "--title", "A's title", "--labels", "initial.offset.theta=tilt, rad",
                         "--labels", "fell=lost it", "--labels", "ground.friction=µ", "--labels", "0.1=a tenth", "--labels", "nothing=x",
                         "--colours", "fell=#C0FFEE", "-o", "named")
    assert said == ["stance plot: --labels: nothing is called 'nothing' there"], said
    p = Picture(printed[0])
    for text in ("A's title", "tilt, rad", "µ = a tenth", "µ = 0.8"):
        assert text in p.said(), (text, p.said())
    assert "initial offset: pitch of the trunk" not in p.said()
    legend = p.legend()
    assert [legend[t] for t in legend if t.startswith("lost it  ")] == ["c0ffee"], legend
    call("plot", "map.h5", "--picture", "map", "--title", "", "--colours", "grey", "-o", "named")
    p = Picture("named/map-map.svg")
    assert "What became of each of 126 cases" not in " ".join(p.said())
    assert all(c[:2] == c[2:4] == c[4:] for c in p.legend().values()), p.legend()


def refusals():
    for arguments in (["--format", "jpg"], ["--format", "pdf,"], ["--size", "5"], ["--size", "88x"], ["--size", "nan"], ["--size", "88x1e9"],
                      ["--font", "Times,2"], ["--font", "a'b"], ["--for", "poster"], ["--labels", "fell"], ["--labels", "=x"],
                      ["--colours", "fell=red"], ["--colours", "blue"], ["-o", ""], ["-o", "a.pdf", "--format", "pdf"],
                      ["--picture", "nonsense"]):
        printed, said = call("plot", "map.h5", *arguments, code=2)
        assert not printed and len(said) == 1, (arguments, said)


def letters():
    """Letters that no font has are drawn as boxes, but in SVG, and named once."""
    run("letters", "basin_one_foot.yaml", "sweep.grid[0].count=3", "sweep.grid[1].count=3", "title=双足 Läufer 双", "record.cases=none")
    os.mkdir("tools")
    for ranges, warns in (("20-7e e4 25a1", True), ("20-7e a0-ff 4e00-9fff", False)):
        with open("tools/fc-list", "w", encoding="utf-8") as file:
            file.write(f"#!/bin/sh\necho 'DejaVu Sans,Other:charset={ranges}'\n")
        os.chmod("tools/fc-list", 0o755)
        os.makedirs("kept", exist_ok=True)
        _, said = call("plot", "letters.h5", PATH=f"{os.getcwd()}/tools:{os.environ['PATH']}", STANCE_SCRIPTS="kept")
        said = [line for line in said if "settle_time" not in line]
        assert len(said) == warns and (not warns or "双足" in said[0] and "ä" not in said[0]), said
        assert "双足 Läufer 双" in Picture("letters-map.svg").said()
        drawn = "kept/letters-map/drawn.gp"
        assert os.path.exists(drawn) == warns
        if warns:
            with open(drawn, encoding="utf-8") as file:
                assert "title = '□□ Läufer □'" in file.read().replace("\u200b", "")
    call("plot", "letters.h5", "--picture", "map", "--title", "双足步行机器人的稳定域" * 12, "--size", "90", "-o", "wide.svg")
    lines = [text for text in Picture("wide.svg").said() if set(text) <= set("双足步行机器人的稳定域")]
    assert "".join(lines) == "双足步行机器人的稳定域" * 12 and len(lines) > 3 and max(map(len, lines)) < 30, lines
    _, said = call("plot", "letters.h5", "--font", "No Such Font", "--picture", "map")
    assert len(said) <= 2 and any("no font is called No Such Font" in line for line in said), said


def every_kind():
    """Pictures of all kinds fit a column and a page, with nothing cut."""
    sample = "sweep={grid: [{path: initial.offset.scale, from: 0.05, to: 1, count: 4}], sample: {method: sphere, " \
        "count: 8, vary: [{path: initial.offset.theta, from: -0.1, to: 0.1}, {path: initial.offset.vtheta, from: -0.5, to: 0.5}]}}"
    run("rays", "basin_one_foot.yaml", sample, "record.cases=none")
    run("sampled", "sampled.yaml", "sweep.sample.count=16", "record.cases=none")
    run("bounce", "ball_bounce.yaml", "stop.time=1", "record.cases=none")
    run("case", "balance_recovers.yaml", "stop.time=1")
    for name, pictures in (("rays", 2), ("sampled", 3), ("bounce", 1), ("case", 5)):
        for journal, width in (("column", 88), ("page", 180)):
            printed, _ = call("plot", f"{name}.h5", "--for", journal, "-o", journal)
            assert len(printed) == pictures, printed
            for file in printed:
                assert is_whole(file, width), file
    words = is_whole("page/sampled-sensitivity.pdf", 180)
    assert "0.002" in words and "0.08" in words, words # of tables


# ---- outlines ----------------------------------------------------------------------------------

def shares_of(name):
    """Of each value of the first axis the stabilised share, as legends have it."""
    with h5py.File(f"{name}.h5") as data:
        meanings = data["outcome"].attrs["flag_meanings"].decode().split()
        code = data["outcome"].attrs["flag_values"][meanings.index("stabilised")]
        outcome = data["outcome"][...] == code
    return [f"{100 * part.mean():.1f} %" for part in (outcome if outcome.ndim > 2 else [outcome])], outcome


def outlines():
    """Every case is on its side of the outline; one outline for each value and file."""
    printed, said = call("plot", "map.h5", "--outline", "--format", "svg", "-o", "outlined")
    assert printed == ["outlined/map-outline.svg"] and not said, (printed, said)
    p, (shares, outcome) = Picture(printed[0]), shares_of("map")
    for text in ("ground.friction", f"0.1  {shares[0]}", f"0.8  {shares[1]}", "equilibrium", "initial.offset.theta (rad)"):
        assert text in p.said(), (text, p.said())
    panel = p.panels[0]
    with h5py.File("map.h5") as data:
        theta, rate = data["initial.offset.theta"][...], data["initial.offset.vtheta"][...]
    assert abs(panel.range(0)[0] - theta[0]) < 1e-3 and abs(panel.range(1)[1] - rate[-1]) < 5e-3
    dashes = set()
    for hue, inside in zip(("0072b2", "d55e00"), outcome):
        lines = [(dashed, np.array(line)) for colour, dashed, line in panel.lines if colour == hue and len(line) > 2]
        dashes |= {dashed for dashed, _ in lines}
        crossings = np.vstack([line for _, line in lines])
        at = np.stack([np.interp(panel.x(crossings[:, 0]), theta, range(len(theta))),
                       np.interp(panel.y(crossings[:, 1]), rate, range(len(rate)))], 1)
        for i, j in at: # between two neighbours that differ
            across = abs(j - round(j)) < abs(i - round(i))
            ends = (int(i), round(j)), (int(i) + across, round(j) + (0 if across else 1))
            if not across:
                ends = (round(i), int(j)), (round(i), int(j) + 1)
            assert inside[ends[0]] != inside[ends[1]], (i, j)
    assert dashes == {False, True} # told apart without colours
    run("finer", "friction_sweep.yaml", "sweep.grid[0].values=[0.1]", "sweep.grid[1].count=21", "sweep.grid[2].count=17",
        "record.cases=none")
    call("plot", "map.h5", "finer.h5", "--outline", "--for", "column", "--labels", "finer=a finer grid", "-o", "two.pdf")
    words = " ".join(is_whole("two.pdf", 88))
    for text in (f"map, 0.1 {shares[0]}", f"map, 0.8 {shares[1]}", f"a finer grid {shares_of('finer')[0][0]}"):
        assert text in words, (text, words)
    call("plot", "map.h5", "--outline", "--of", "fell", "-o", "fell.svg")
    assert any("outcome is: fell" in t for t in Picture("fell.svg").said())
    run("line", "ball_bounce.yaml", "stop.time=0.1")
    run("other", "friction_sweep.yaml", "sweep.grid[1].count=2", "sweep.grid[2]={path: initial.offset.q1, values: [0, 0.01]}",
        "sweep.grid[0].values=[0.1]", "stop.time=0.1", "record.cases=none")
    for arguments, code in ((["line.h5", "--outline"], 3), (["map.h5", "other.h5", "--outline"], 3), (["map.h5", "finer.h5"], 2),
                            (["map.h5", "--outline", "--answer", "steps"], 2), (["map.h5", "missing.h5", "--outline"], 3)):
        printed, said = call("plot", *arguments, code=code)
        assert not printed and len(said) == 1, (arguments, said)


def allowed():
    """What linear theory allows has a line and a name of its own; where there is none, a line says why."""
    for size, width in ("page", 180), ("column", 88):
        for picture in ["--picture", "map"], ["--picture", "settle_time"], ["--outline"], ["--answer", "friction_used", "--of", "fell"]:
            printed, said = call("plot", "map.h5", "--allowed", *picture, "--for", size, "-o", "allowed.pdf")
            assert printed == ["allowed.pdf"] and not said, said
            words = " ".join(is_whole("allowed.pdf", width))
            assert "linear theory allows " in words and "while the contacts stand" in words, words
    call("plot", "map.h5", "--allowed", "--picture", "map", "--labels", "linear theory allows=bound", "--colours",
         "linear theory allows=#ff0080", "-o", "red.svg")
    p = Picture("red.svg")
    bound = [(dashed, len(line)) for panel in [p.page, *p.panels] for c, dashed, line in panel.lines if c == "ff0080"]
    assert any(t.startswith("bound  ") for t in p.said()) and len(bound) >= 3 and all(dashed for dashed, _ in bound), (p.said(), bound)
    none = "no outline of what linear theory allows"
    few = ["sweep.grid[0].values=[0.1]", "sweep.grid[1].count=5", "sweep.grid[2].count=5", "stop.time=0.1", "record.cases=none"]
    for name, setting, why in (
            ("limitless", ["controller.torque_limit=none"], f"{none}: a torque has no limit"),
            ("weak", ["sweep.grid[0]={path: controller.torque_limit, values: [5, 10]}"],
             f"{none} in 1 of 2 panels: the equilibrium takes more torque than there is"),
            ("uneven", ["sweep.grid[2]={path: initial.offset.vtheta, values: [0, 0.1, 0.3]}"],
             f"{none}: the values of initial.offset.vtheta are not even"),
            ("floors", ["sweep.grid[0]={path: initial.offset.vtheta, values: [0]}", "sweep.grid[2]={path: ground.friction, values: [0.1, 0.2]}"],
             f"{none}: ground.friction is no coordinate of a start"),
            ("curved", ["sweep.grid[2]={paths: [initial.offset.vtheta, initial.offset.q1], values: [[0, 0], [0.1, 0.1], [0.2, 0]]}"],
             f"{none}: the starts of the map are no plane"),
            ("near", ["sweep.grid[1].from=-0.01", "sweep.grid[1].to=0.01", "sweep.grid[2].from=-0.01", "sweep.grid[2].to=0.01"],
             f"{none}: all of these starts are allowed"),
            ("far", ["sweep.grid[1].from=0.9", "sweep.grid[1].to=1"], f"{none}: none of these starts is allowed")):
        run(name, "friction_sweep.yaml", *few, *setting)
        printed, said = call("plot", f"{name}.h5", "--allowed", "--picture", "map", "-o", f"{name}.svg")
        said = [line for line in said if "settle_time" not in line]
        assert printed == [f"{name}.svg"] and said == [f"stance: warning: {name}.h5: {why}"], said
    assert any("linear theory allows  100.0 %" == t for t in Picture("near.svg").said())
    assert not any("glued" in t for t in Picture("near.svg").said())
    with open(f"{SCENARIOS}/../README.md", encoding="utf-8") as page: # on a sole, which may tip
        sole = re.search(r"^    # own.yaml\n((?:    .*\n)+)", page.read(), re.M).group(1)
    with open("sole.yaml", "w", encoding="utf-8") as file:
        file.write(re.sub("^    ", "", sole, flags=re.M))
    call("run", "sole.yaml", "--quiet", "-o", "sole.h5", "--set", "stop.time=0.02", "--set", "sweep.grid=[{path: initial.offset.body, from: -0.3, to: 0.3, count: 5}, "
         "{path: initial.offset.vbody, from: -1, to: 1, count: 5}]")
    call("plot", "sole.h5", "--allowed", "--picture", "map", "-o", "sole.svg")
    assert "contacts as if glued: the bound does not know where their centre of pressure may be" in " ".join(Picture("sole.svg").said())
    for arguments in ["bounce.h5"], ["sampled.h5"], ["map.h5", "--case", "1"], ["--model", f"{SCENARIOS}/drop.yaml"]:
        printed, said = call("plot", *arguments, "--allowed", "-o", "refused", code=2)
        assert not printed and len(said) == 1 and "--allowed" in said[0], (arguments, said)
    assert not os.path.exists("refused")


def many_values():
    """Axes of several coordinates, many values: every line is its own, every text whole, every axis has a scale."""
    run("carts", "mechanisms/cart_pole.yaml", "record.cases=none", "stop.time=1", "controller.sample_time=0.01", "sweep.grid=["
        "{path: robot.actuators.push.limit, from: 30, to: 8, count: 12}, "
        "{paths: [initial.offset.pole, initial.offset.vpole], from: [-0.3, -1], to: [0.2, 0.6], count: 6}, "
        "{paths: [initial.offset.cart, robot.bodies.pole.damping], from: [-0.3, 0.1], to: [0.2, 0], count: 5}]")
    call("plot", "carts.h5", "--outline", "--for", "column", "-o", "carts.pdf", STANCE_SCRIPTS="kept")
    words = " ".join(is_whole("carts.pdf", 88))
    assert "pole against cart, counter-clockwise" in words and "initial.offset.pole (rad), with vpole" in words, words
    assert "(m), with robot.bodies.pole.damping" in words, words
    with open("kept/carts-outline/data.gp", encoding="utf-8") as file:
        marks = re.findall(r"legend_dash\[legends\] = (\d+); legend_point\[legends\] = (\d+)", file.read())
    assert len(marks) == len(set(marks)) == 13, marks # 12 lines and the cross
    run("slow", "mechanisms/cart_pole.yaml", "record.cases=none", "stop.time=1", "controller.sample_time=0.02", "sweep.grid=["
        "{path: robot.actuators.push.limit, from: 30, to: 20, count: 2}, "
        "{paths: [initial.offset.pole, initial.offset.vpole], from: [-0.3, -1], to: [0.2, 0.6], count: 6}, "
        "{paths: [initial.offset.cart, robot.bodies.pole.damping], from: [-0.3, 0.1], to: [0.2, 0], count: 5}]")
    call("plot", "carts.h5", "slow.h5", "--outline", "-o", "carts.svg")
    assert "file, robot.actuators.push.limit" in Picture("carts.svg").said(), Picture("carts.svg").said()
    for size, width in ("page", 180), ("column", 88):
        for form in "svg", "pdf":
            call("plot", "carts.h5", "--for", size, "--picture", "map", "-o", f"carts.{form}")
        assert "vpole" in is_whole("carts.pdf", width)
        p = Picture("carts.svg")
        for axis in 0, 1:
            for edge in {round(t[2]) for t in p.tics if t[0] == axis and t[3]}:
                for panel in p.panels:
                    if abs((panel.bottom, panel.left)[axis] - edge) < 1:
                        low, high = ((panel.left, panel.right), (panel.top, panel.bottom))[axis]
                        at = [t for t in p.tics if t[0] == axis and t[3] and abs(t[2] - edge) < 1 and low - 1 < t[1] < high + 1]
                        assert len(at) >= 2, (size, axis, at)
    run("tabled", "mechanisms/cart_pole.yaml", "record.cases=none", "stop.time=0.1", "controller.sample_time=0.01", "sweep.grid=["
        "{path: controller.lag, from: 0, to: 0.06, count: 3}, {path: robot.bodies.pole.damping, values: [0, 0.1, 0.2, 0.3]}, "
        "{path: initial.offset.pole, from: -0.3, to: 0.2, count: 5}, {path: initial.offset.vpole, from: -1, to: 0.6, count: 5}]")
    call("plot", "tabled.h5", "--picture", "map", "--for", "column", "-o", "tabled.pdf")
    words = " ".join(is_whole("tabled.pdf", 88))
    assert "bodies.pole.damping (N m s/rad)" in words and "lag (s)" in words and "0.1 N m" not in words, words
    run("varied", "mechanisms/cart_pole.yaml", "record.cases=none", "stop.time=0.1", "sweep={sample: {method: sobol, count: 8, vary: ["
        "{path: robot.bodies.pole.inertia, from: 0.004, to: 0.01}, {path: robot.actuators.push.limit, from: 10, to: 30}]}}")
    call("plot", "varied.h5", "--picture", "sample", "--for", "column", "-o", "varied.pdf")
    words = " ".join(is_whole("varied.pdf", 88))
    assert words.count("inertia (kg m^2)") == 2 and words.count("limit (N)") == 2, words # of the scatter and of the panels
    call("run", f"{SCENARIOS}/mechanisms/cart_pole.yaml", *[w for s in ("record.cases=none", "stop.time=0.1", "controller.sample_time=0.01",
         "sweep.grid=[{path: controller.lag, from: 0, to: 0.1, count: 3}, {path: initial.offset.pole, from: -0.1, to: 0.1, count: 3}]")
         for w in ("--set", s)], "--quiet", "-o", "lag.h5")
    run("edge", "mechanisms/cart_pole.yaml", "record.cases=none", "stop.time=0.1", "controller.sample_time=0.01",
        "sweep.grid=[{path: controller.lag, values: [0, 0.01]}, {path: initial.offset.pole, values: [0, 0.1]}]")
    call("plot", "edge.h5", "--picture", "map", "--for", "column", "-o", "edge.pdf")
    assert "0.015" in is_whole("edge.pdf", 88) # at the end of the axis
    call("plot", "lag.h5", "--picture", "curve", "-o", "lag.svg")
    assert abs(Picture("lag.svg").panels[-1].range(0)[0]) < 1e-3 # no time is negative


# ---- replay ------------------------------------------------------------------------------------

def replay():
    """The case that a run of it draws, by its number or by what it is near to."""
    call("run", f"{SCENARIOS}/friction_sweep.yaml", *[w for s in MAP for w in ("--set", s)], "--only", "85", "--trace", "--quiet",
         "-o", "direct.h5")
    call("plot", "direct.h5", "--format", "svg")
    os.mkdir("scratch")
    printed, said = call("replay", "map.h5", "--case", "85", "--format", "svg", "-o", "again", TMPDIR="scratch")
    assert not said and printed == [f"again/map-case85-{p}.svg" for p in ("coordinates", "forces", "torques", "gaps", "strip")], printed
    for picture in ("coordinates", "forces", "torques", "gaps", "strip"):
        with open(f"direct-{picture}.svg", encoding="utf-8") as one, open(f"again/map-case85-{picture}.svg", encoding="utf-8") as other:
            assert one.read() == other.read(), picture
    assert not os.listdir("scratch"), "nothing is left behind"
    with h5py.File("map.h5") as data:
        near = [np.argmin(abs(data[n][...] - v)) for n, v in
                (("ground.friction", 0.7), ("initial.offset.theta", 0.02), ("initial.offset.vtheta", -0.1))]
        shape = data["outcome"].shape
    case = np.ravel_multi_index(near, shape)
    printed, said = call("replay", "map.h5", "--near", "friction=0.7,theta=0.02,initial.offset.vtheta=-0.1", "--picture", "strip",
                         "--format", "svg", "-o", "again")
    assert printed == [f"again/map-case{case}-strip.svg"] and len(said) == 1 and said[0].startswith(f"case {case}, "), (printed, said)
    with h5py.File("map.h5") as data: # what is not named: the first value, the equilibrium
        near = [0, np.argmin(abs(data["initial.offset.theta"][...])), np.argmin(abs(data["initial.offset.vtheta"][...] - 0.3))]
    case = np.ravel_multi_index(near, shape)
    assert call("replay", "map.h5", "--near", "vtheta=0.3", "--picture", "strip", "-o", "again/a.svg")[1][0].startswith(f"case {case}, ")
    call("replay", "map.h5", "--case", "85", "--set", "initial.offset.theta=0", "--picture", "strip", "-o", "x.svg", code=2)
    call("replay", "map.h5", "--case", "85", "--set", "robot.trunk_mass=2", "--picture", "coordinates", "-o", "heavy.svg")
    with open("heavy.svg", encoding="utf-8") as one, open("again/map-case85-coordinates.svg", encoding="utf-8") as other:
        assert one.read() != other.read()
    with h5py.File("sampled.h5") as data:
        point = np.argmin(abs(data["ground.friction"][...] - 0.5))
        outcome = data["outcome"]
        axis = outcome.shape.index(16)
        stride = int(np.prod(outcome.shape[axis + 1:]))
    _, said = call("replay", "sampled.h5", "--near", "friction=0.5", "--picture", "strip", "-o", "x.svg")
    assert int(re.match(r"case (\d+),", said[0])[1]) // stride % 16 == point, said


def two_cases():
    """Two cases in the same frames, and moving."""
    printed, _ = call("replay", "map.h5", "--case", "31", "--case", "85", "--format", "svg", "-o", "both")
    p = Picture("both/map-case31-case85-coordinates.svg")
    assert "dashed: the second case" in p.said() and re.search(r"case 31,.*second case 85,", " ".join(p.said())), p.said()
    for panel in p.panels:
        assert {q[1] for q in panel.lines if q[0] == "0072b2"} == {False, True}
    for size, width in ("page", 180), ("column", 88):
        call("replay", "map.h5", "--case", "31", "--case", "85", "--for", size, "-o", "fitted")
        for picture in "strip", "torques", "forces":
            is_whole(f"fitted/map-case31-case85-{picture}.pdf", width)
    strip = Picture("both/map-case31-case85-strip.svg")
    assert strip.legend()["the second case"] == "b8b8b8" and len(printed) == 5
    printed, said = call("replay", "map.h5", "--case", "31", "--case", "85", "-o", "both/walk.gif")
    assert printed == ["both/walk.gif"] and not said, (printed, said)
    with open("both/walk.gif", "rb") as file:
        data = file.read()
    frames = data.count(b"\x21\xf9\x04")
    with open("both/map-case31-case85-coordinates.svg", encoding="utf-8"):
        seconds = p.panels[-1].range(0)[1]
    assert (gif(data)[:, -12:] == 255).all(), "texts end within the frame"
    assert data[:6] == b"GIF89a" and data[-1:] == b";" and abs(frames - seconds / 0.04) < 2.5, (frames, seconds)
    printed, said = call("replay", "map.h5", "--case", "31", "--case", "85", "--picture", "animation", "-o", "both/walk.svg")
    assert printed == ["both/walk.svg"] and not said, (printed, said)
    shown = [g for g in xml.etree.ElementTree.parse("both/walk.svg").iter(SVG + "g") if g.find(SVG + "animate") is not None]
    assert len(shown) in (frames, frames + 1, frames - 1), (len(shown), frames)
    assert [g.get("visibility") for g in shown] == ["visible"] + ["hidden"] * (len(shown) - 1)
    for k, g in enumerate(shown): # one after the other, each with its time and the two figures
        begin, end = [float(t) for t in g.find(SVG + "animate").get("keyTimes").split(";")[1:]]
        assert abs(begin * len(shown) - k) < 1e-3 and abs(end * len(shown) - k - 1) < 1e-3, (k, begin, end)
        assert f"{0.04 * k:.2f} s" in "".join(g.itertext()), k
    for arguments, what in ((["map.h5"], "says which"), (["map.h5", "--case", "1", "--picture", "animation", "-o", "a.pdf"], "svg or gif"), (["map.h5", "--case", "x"], "number of a case"), (["map.h5", "--case", "99999"], "no case"),
                            (["map.h5", "--near", "theta"], "NAME=VALUE"), (["map.h5", "--near", "nothing=1"], "nothing is varied"),
                            (["map.h5", "--near", "offset=1"], "nothing is varied"), (["map.h5", "--near", "theta=a"], "NAME=NUMBER"),
                            (["map.h5", "--case", "1", "--near", "theta=0", "--near", "theta=1"], "two cases")):
        printed, said = call("replay", *arguments, code=2)
        assert not printed and len(said) == 1 and what in said[0], (arguments, said)
    assert call("replay", "missing.h5", "--case", "1", code=3)[1]


def other_commands():
    """What is drawn of samples, models and benchmarks takes the same options."""
    run("many", "basin_one_foot.yaml", "record.cases=none", "sweep={grid: [{path: initial.offset.theta, from: -0.05, to: 0.02, count: 8}], "
        "sample: {method: saltelli, count: 32, vary: [{path: ground.friction, from: 0.1, to: 0.8}, "
        "{path: controller.torque_limit, from: 8, to: 12}]}}")
    printed, said = call("sensitivity", "many.h5", "--for", "column", "-o", "many.pdf", "--labels", "ground.friction=floor")
    assert printed[-1] == "many.pdf" and not any("called" in line for line in said) and "floor" in is_whole("many.pdf", 88), (printed, said)
    assert "pictures" in call("sensitivity", "many.h5", "--size", "100", "--json", code=2)[1][0]
    assert "nothing is called 'x'" in call("sensitivity", "many.h5", "--labels", "x=y")[1][-1]
    for size, width in ("page", 180), ("column", 88):
        for robot in "basin_one_foot", "mechanisms/flat_feet", "mechanisms/cart_pole":
            call("plot", "--model", f"{SCENARIOS}/{robot}.yaml", "--for", size, "-o", "model.pdf")
            is_whole("model.pdf", width)
    with open("own.yaml", "w", encoding="utf-8") as file:
        file.write("{stance: 1, scene: mechanism, robot: {bodies: {foot: {joint: free, mass: 2, inertia: 0.01, centre: [0.04, 0.03]}, body: "
                   "{joint: hinge, parent: foot, at: [0, 0.08], mass: 70, inertia: 10, centre: [0, 0.9]}}, contacts: {sole: {body: foot, "
                   "from: [-0.06, 0], to: [0.18, 0]}}, points: {head: {body: body, at: [0, 1.6], lowest: 1}}, actuators: {ankle: {body: "
                   "body, limit: 120}}}, initial: {equilibrium: {body: -0.05}, support: [sole], offset: {body: -1.2}}, controller: "
                   "{kind: state-feedback, design: lqr}, stop: {time: 6}}")
    for robot, labels, arrows in (("own.yaml", 6, 7), (f"{SCENARIOS}/mechanisms/cart_pole.yaml", 3, 3),
                                  (f"{SCENARIOS}/mechanisms/hopper.yaml", 5, 6)):
        for size in ["--for", "column"], ["--for", "page"], []:
            call("plot", "--model", robot, *size, "-o", "model.svg")
            with open("model.svg", encoding="utf-8") as file:
                svg = file.read()
            heads = [np.fromstring(head.replace(",", " "), sep=" ").reshape(-1, 2) for head in re.findall(r"points = '((?:[\d.]+,[\d.]+ ){5})'", svg)]
            named = {(float(x), float(y), text) for x, y, text in re.findall(
                r'translate\(([\d.]+),([\d.]+)\)"[^>]*font-size="17.33"[^>]*middle"[^>]*>\s*<text>(.*?)</text>', svg)}
            assert len(named) == labels and len(heads) == arrows, (robot, named, len(heads))
            for x, y, text in named: # no label covers the head of an arrow
                for head in heads:
                    assert not (np.hypot(*(head - (x, y - 4)).T / [[4 * len(text)], [9]]) < 1).any(), (robot, size, text, head)
            assert not re.search(r"= -?[\d.]+e-", svg), "dust is 0"
    with open("speed.csv", "w", encoding="utf-8") as file:
        file.write("\n".join(call("bench", "--csv", "--repeats", "1", "--cases", "1", "--method", "implicit")[0]) + "\n")
    call("bench", "plot", "speed.csv", "--for", "page", "-o", "speed.pdf")
    assert "nanoseconds" in is_whole("speed.pdf", 180)
    call("bench", "plot", "speed.csv", "--title", "Steps", "--format", "svg", "-o", "new")
    assert "Steps" in Picture("new/speed.svg").said()
    run("reach", "basin_one_foot.yaml", "record.cases=none", "sweep={grid: [{path: controller.torque_limit, values: [9, 10, 12]}, "
        "{path: initial.offset.scale, from: 0.05, to: 1, count: 20}], sample: {method: sphere, count: 16, vary: "
        "[{path: initial.offset.theta, from: -0.1, to: 0.1}, {path: initial.offset.vtheta, from: -0.5, to: 0.5}]}}")
    call("plot", "reach.h5", "--picture", "rays", "--for", "column", "-o", "reach.pdf", STANCE_SCRIPTS="kept")
    is_whole("reach.pdf", 88)
    with open("kept/reach-rays/data.gp", encoding="utf-8") as file:
        marks = re.findall(r"legend_point\[legends\] = (\d+)", file.read())
    assert len(set(marks)) == 3 and "0" not in marks, marks # not by colour alone


def under_mpirun():
    """What is not for several ranks is done and said once."""
    if not shutil.which("mpirun"):
        return
    for arguments, lines in ((["plot", "map.h5", "--picture", "map", "-o", "ranks"], ["ranks/map-map.svg", "ranks/map-map.png"]),
                             (["replay", "map.h5", "--case", "85", "--picture", "gaps", "-o", "ranks.svg"], ["ranks.svg"])):
        ran = subprocess.run(["mpirun", "-n", "2", STANCE, *arguments], capture_output=True, text=True, check=False, timeout=PATIENCE)
        assert ran.returncode == 0 and ran.stdout.splitlines() == lines, (ran.stdout, ran.stderr)
    ran = subprocess.run(["mpirun", "-n", "2", STANCE, "plot", "map.h5", "--nonsense"], capture_output=True, text=True, check=False, timeout=PATIENCE)
    assert ran.returncode == 2 and ran.stderr.count("unknown option") == 1, ran.stderr


def progress():
    """Who waits at a terminal sees that something goes on; nobody else does."""
    os.makedirs("slow", exist_ok=True)
    with open("slow/gnuplot", "w", encoding="utf-8") as file:
        file.write("#!/bin/sh\nuntil [ -e '%s/slow/go' ]; do sleep 0.1; done\nexit 1\n" % os.getcwd())
    os.chmod("slow/gnuplot", 0o755)
    environment = dict(os.environ, PATH=f"{os.getcwd()}/slow:{os.environ['PATH']}")
    ours, theirs = pty.openpty()
    with subprocess.Popen([STANCE, "plot", "map.h5", "-o", "slow"], stderr=subprocess.PIPE, env=environment) as heard, \
            subprocess.Popen([STANCE, "plot", "map.h5", "-o", "slow"], stderr=theirs, stdout=subprocess.DEVNULL, env=environment) as ran:
        said = ""
        while "4 s" not in said:
            assert select.select([ours], [], [], PATIENCE)[0], said
            said += os.read(ours, 4000).decode()
        with open("slow/go", "w", encoding="ascii"):
            pass
        assert ran.wait(PATIENCE) == 3 and heard.wait(PATIENCE) == 3
        said += os.read(ours, 4000).decode()
        assert re.fullmatch(r"(\r\d+ s\x1b\[K)+\r\x1b\[K.*gnuplot failed.*\r\n", said), said
        assert heard.stderr.read().decode().startswith("gnuplot failed")


tap([one_file, sizes, names, refusals, letters, every_kind, outlines, allowed, many_values, replay, two_cases, other_commands,
     under_mpirun, progress])
