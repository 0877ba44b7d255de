#!/usr/bin/python3
"""Draws one picture of each kind from small runs and compares what it shows with the results file.

    pictures.py STANCE SCENARIOS

In the current folder. Marks, cells, axes, labels and legends are read from the SVGs (drawn.py), numbers
from the HDF5 files or the printed JSON and CSV. Speaks TAP.
"""
import csv
import io
import json
import math
import re
import subprocess
import sys

import h5py
import numpy as np

import null_set
from drawn import Picture
from tap import tap

STANCE, SCENARIOS = sys.argv[1:]
# By what people are told: blue hues stand, orange falls.
COLOURS = {"stabilised": "005a92", "rested": "56b4e9", "fell": "f3bb4c", "undecided": "a45288"}
HUES = ["0072b2", "d55e00", "009e73"]
CIVIDIS = np.array([[0x00, 0x22, 0x4e], [0x43, 0x4e, 0x6c], [0x7d, 0x7c, 0x78], [0xbc, 0xae, 0x6c], [0xfe, 0xe8, 0x38]])
EQUILIBRIUM = ["initial.offset.theta", "initial.offset.vtheta"]


def stance(*arguments):
    ran = subprocess.run([STANCE, *arguments], capture_output=True, text=True, check=False)
    assert ran.returncode == 0, (arguments, ran.stderr)
    return ran.stdout


def run(name, scenario, *settings):
    sets = [word for s in settings for word in ("--set", s)]
    stance("run", scenario if "/" not in scenario and scenario.endswith(".local.yaml") else f"{SCENARIOS}/{scenario}",
           *sets, "--quiet", "-o", f"{name}.h5")
    return h5py.File(f"{name}.h5")


def close(drawn, wanted, tolerance):
    drawn, wanted = np.asarray(drawn, float), np.asarray(wanted, float)
    assert drawn.shape == wanted.shape, (drawn.shape, wanted.shape)
    worst = np.nanmax(np.abs(drawn - wanted)) if drawn.size else 0
    assert worst <= tolerance and (np.isnan(drawn) == np.isnan(wanted)).all(), (worst, drawn[:5], wanted[:5])


def says(picture, *texts):
    """Each text is one of the picture's, or (of a caption) stands in several of its lines."""
    for text in texts:
        assert text in picture.said() or len(text) > 90 and text in " ".join(picture.said()), (text, picture.said())


def cut(data, of="stabilised"):
    """What a caption says of the faces of the box on which starts have an outcome."""
    inside, faces = names(data) == of, []
    for axis, path in enumerate(data.attrs["axes"].decode().split(",")):
        if path.startswith("initial.offset."):
            ends = [inside.take(end, axis).any() for end in (0, -1)]
            at = [f"{data[path][e]:.6g} {data[path].attrs['units'].decode()}" for e, any in zip((0, -1), ends) if any]
            word = "both ends" if all(ends) else "lower end" if ends[0] else "upper end"
            faces += [f"{path} = {' and '.join(at)} ({word})"] if at else []
    return f"; what is {of} is cut by the box at {', '.join(faces)}: its share is the box's" if faces else ""


def names(data):
    """Words for the outcomes of all cases."""
    meanings = dict(zip(data["outcome"].attrs["flag_values"].tolist(), data["outcome"].attrs["flag_meanings"].decode().split()))
    return np.vectorize(lambda code: meanings[code])(data["outcome"][...])


def shares(data):
    """The legend that a file's outcomes have."""
    words, number = np.unique(names(data), return_counts=True)
    return {f"{w}  {100 * n / number.sum():.1f} %": COLOURS[w] for w, n in zip(words, number)}


def hexes(pixels):
    return np.vectorize(lambda r, g, b: f"{r:02x}{g:02x}{b:02x}")(*np.moveaxis(pixels[..., :3], -1, 0))


def title_of(data):
    return re.sub(r"\s+", " ", data.attrs["title"].decode() if isinstance(data.attrs["title"], bytes) else data.attrs["title"])


def image_of(panel):
    """Cells [row from below][column] of a panel's one image, which fills the frame."""
    assert len(panel.images) == 1
    x, y, w, h, pixels = panel.images[0]
    close([x, y, x + w, y + h], [panel.left, panel.top, panel.right, panel.bottom], 1)
    return pixels[::-1]


def spans(panel, axis, values, log=False):
    """The range of an axis of cells: the outer edges of the first and the last."""
    v = np.log10(values) if log else np.asarray(values)
    half = (v[-1] - v[0]) / (len(v) - 1) / 2
    low, high = panel.range(axis, log)
    got = np.log10([low, high]) if log else np.array([low, high])
    close(got, [v[0] - half, v[-1] + half], 0.03 * abs(half) + 0.002 * abs(v[-1] - v[0]))


def cividis(values, low, high):
    t = np.clip((np.asarray(values, float) - low) / (high - low), 0, 1) * 4
    k = np.minimum(np.nan_to_num(t).astype(int), 3)
    return CIVIDIS[k] + (np.nan_to_num(t) - k)[..., None] * (CIVIDIS[k + 1] - CIVIDIS[k])


def numbers_shown(panel, values, low, high):
    """Cells have the palette's colours of values; NAN: nothing is drawn over the ground."""
    pixels = image_of(panel)
    here = np.isfinite(values)
    assert (pixels[..., 3][~here] == 0).all() and (pixels[..., 3][here] == 255).all()
    assert np.abs(pixels[..., :3] - cividis(values, low, high))[here].max() < 6


# ---- the pictures ------------------------------------------------------------------------------

def maps():
    data = run("map", "friction_sweep.yaml", "sweep.grid[0].values=[0.1, 0.8]", "sweep.grid[1].count=9",
               "sweep.grid[2].count=7", "record.cases=none")
    stance("plot", "map.h5")
    p, outcome = Picture("map-map.svg"), names(data)
    says(p, title_of(data), f"What became of each of 126 cases{cut(data)}; one panel per ground.friction (Coulomb coefficient of friction)",
         "initial.offset.theta (rad)", "initial.offset.vtheta (rad/s)", "friction = 0.1", "friction = 0.8", "equilibrium")
    assert p.legend() == shares(data), (p.legend(), shares(data))
    assert len(p.panels) == 2 and p.panels[0].left < p.panels[1].left
    for k, panel in enumerate(p.panels):
        wanted = np.vectorize(COLOURS.get)(outcome[k].T)
        assert (hexes(image_of(panel)) == wanted).all(), k
        spans(panel, 0, data["initial.offset.theta"][...])
        spans(panel, 1, data["initial.offset.vtheta"][...])
        cross = [q for q in panel.points if q[2] == "000000"]
        close([panel.x(cross[0][0]), panel.y(cross[0][1])], [0, 0], 0.005)
    p, time = Picture("map-settle_time.svg"), data["settle_time"][...]
    says(p, "settle_time (s)", "Time from which each case stayed settled; one panel per ground.friction "
         "(Coulomb coefficient of friction)")
    time = np.where(np.isin(outcome, ["stabilised", "rested"]), time, np.nan)
    close(p.bar(), [np.nanmin(time), np.nanmax(time)], 0.03)
    for k in range(2):
        numbers_shown(p.panels[k], time[k].T, np.nanmin(time), np.nanmax(time))


def tables():
    """Two further axes are rows and columns of panels, each with its share; values left out are told."""
    grid = "sweep.grid=[{path: ground.friction, values: [0.1, 0.8]}, {path: controller.torque_limit, values: [5, 10, 20]}, " \
        "{path: initial.offset.theta, from: -0.1, to: 0.05, count: 5}, {path: initial.offset.vtheta, from: -0.5, to: 0.5, count: 4}]"
    data = run("table", "basin_one_foot.yaml", grid, "record.cases=none")
    stance("plot", "table.h5")
    p, outcome = Picture("table-map.svg"), names(data)
    says(p, "friction = 0.1", "friction = 0.8", "torque_limit = 5 N m", "torque_limit = 20 N m", "%: stabilised")
    assert sum("friction = 0.1" in t for t in p.said()) == 1
    assert len(p.panels) == 6
    for k, panel in enumerate(p.panels):
        here = outcome[k // 3, k % 3]
        assert (hexes(image_of(panel)) == np.vectorize(COLOURS.get)(here.T)).all(), k
        share = [t for x, y, t, _ in p.texts if x is not None and abs(x - panel.right) < 1 and 0 < panel.top - y < 20]
        assert share == [f"{100 * (here == 'stabilised').mean():.1f} %"], share
    stance("plot", "table.h5", "--for", "column", "--format", "svg", "-o", "narrow")
    says(Picture("narrow/table-map.svg"), "torque_limit (N m)", "5", "10")
    run("many", "friction_sweep.yaml", "sweep.grid[0]={path: ground.friction, from: 0.1, to: 0.8, count: 40}",
        "sweep.grid[1].count=2", "sweep.grid[2].count=2", "stop.time=0.1", "record.cases=none")
    stance("plot", "many.h5")
    p = Picture("many-map.svg")
    assert len(p.panels) == 30 and "30 of the 40 values of ground.friction are drawn" in " ".join(p.said()), p.said()


def axes():
    """A map is over axes of several values, also where those of one come later."""
    grid = "sweep.grid=[{path: ground.friction, from: 0.1, to: 0.8, count: 4, spacing: log}, {path: controller.torque_limit, values: [5, 10, 20]}, " \
        "{path: initial.offset.theta, values: [0.01]}, {path: initial.offset.vtheta, values: [0.02]}]"
    data = run("axes", "basin_one_foot.yaml", grid, "record.cases=none")
    stance("plot", "axes.h5")
    p = Picture("axes-map.svg")
    says(p, "ground.friction", "controller.torque_limit (N m)")
    assert "at initial.offset.theta = 0.01 rad, initial.offset.vtheta = 0.02 rad/s" in " ".join(p.said())
    assert (hexes(image_of(p.panels[0])) == np.vectorize(COLOURS.get)(names(data)[:, :, 0, 0].T)).all()
    spans(p.panels[0], 0, data["ground.friction"][...], log=True)


def greys():
    """Outcomes are told apart without colours."""
    bright = sorted(sum(w * int(c[i:i + 2], 16) for w, i in ((0.299, 0), (0.587, 2), (0.114, 4))) for c in COLOURS.values())
    assert min(np.diff(bright)) > 30, bright


def dashes(picture, panel, hue="000000"):
    """Points of the dashed lines of a colour in a panel's frame; a map's stand before it."""
    found = [(x, y) for p in [picture.page, *picture.panels] for c, dashed, line in p.lines if c == hue and dashed
             for x, y in line if panel.left - 1 < x < panel.right + 1 and panel.top - 1 < y < panel.bottom + 1]
    return np.array(found).reshape(-1, 2)


def allowed():
    """The line of what linear theory allows is where the gauge is 1, in each panel by its own limits and starts."""
    settings = ["record.cases=none", "stop.time=0.01", "stop.settle=off"]
    for name, first, others, grid in (
            ("limits", "{path: controller.torque_limit, values: [8, 14]}, ", {},
             [({"theta": 1}, -0.2, 0.12, 17), ({"vtheta": 1}, -0.8, 0.5, 15)]),
            ("oblique", "", {"theta": 0.05}, [({"q1": 1, "q2": -2}, -0.3, 0.4, 15), ({"vtheta": 1, "vq1": -0.5}, -2, 1.5, 14)])):
        axes = ["{paths: [%s], from: [%s], to: [%s], count: %d}" % (", ".join(f"initial.offset.{n}" for n in along),
                                                                    ", ".join(str(low * f) for f in along.values()),
                                                                    ", ".join(str(high * f) for f in along.values()), count)
                for along, low, high, count in grid]
        data = run(name, "basin_one_foot.yaml", f"sweep.grid=[{first}{', '.join(axes)}]", *settings,
                   *[f"initial.offset.{n}={v}" for n, v in others.items()])
        stance("plot", f"{name}.h5", "--allowed", "--picture", "map")
        stance("plot", f"{name}.h5", "--allowed", "--outline", "--of", "rested", "--format", "svg")
        p, outline = Picture(f"{name}-map.svg"), Picture(f"{name}-outline.svg")
        limits = [8, 14] if first else [10]
        shares = {round(100 * r["allowed"], 1) for r in json.loads(stance("basin", f"{name}.h5", "--allowed", "--json"))["rows"]}
        share = f"  {shares.pop()} %" if len(limits) == 1 else ""
        for picture in p, outline:
            says(picture, f"linear theory allows{share}")
            assert "linear theory allows: some controller recovers, while the contacts stand" in " ".join(picture.said())
        for k, limit in enumerate(limits):
            design = json.loads(stance("design", f"{SCENARIOS}/basin_one_foot.yaml", "--set", f"controller.torque_limit={limit}", "--json"))

            def states(u, v):
                x = np.zeros((len(u), 6)) + [others.get(n, 0) for n in design["states"]]
                for (along, *_), value in zip(grid, (u, v)):
                    for n, factor in along.items():
                        x[:, design["states"].index(n)] += factor * value
                return x
            for panel, marks in ((p.panels[k], dashes(p, p.panels[k])),
                                 (outline.panels[0], dashes(outline, outline.panels[0]) if len(limits) == 1 else None)):
                if marks is None:
                    lines = [np.array(line) for c, dashed, line in outline.panels[0].lines if c == HUES[k] and len(line) > 5]
                    marks = np.vstack(lines)
                at = panel.x(marks[:, 0]), panel.y(marks[:, 1])
                off = np.abs(null_set.gauge(design, limit, states(*at)) - 1)
                assert len(off) > 10 and off.max() < 1e-3, (name, limit, len(off), off.max())
            # and it is all of the line: gauges are on the same side of 1 on the panel's edges but where it meets them
            low, high = zip(*(p.panels[k].range(axis) for axis in (0, 1)))
            marks = dashes(p, p.panels[k])
            ends = np.stack([p.panels[k].x(marks[:, 0]), p.panels[k].y(marks[:, 1])], 1)
            for axis in 0, 1:
                for edge in low[axis], high[axis]:
                    u = np.linspace(low[1 - axis], high[1 - axis], 400)
                    inside = null_set.gauge(design, limit, states(*((np.full(400, edge), u) if axis == 0 else (u, np.full(400, edge))))) < 1
                    for place in u[1:][inside[1:] != inside[:-1]]:
                        size = (np.array(high) - low)
                        there = (edge, place) if axis == 0 else (place, edge)
                        assert (np.abs((ends - there) / size).max(1) < 0.01).any(), (name, limit, there)


def answers():
    data = h5py.File("map.h5")
    stance("plot", "map.h5", "--answer", "friction_used", "--of", "fell")
    p, used = Picture("map-friction_used.svg"), data["friction_used"][...]
    used = np.where(names(data) == "fell", used, np.nan)
    says(p, "friction_used", title_of(data))
    assert p.legend() == {"not fell": "d9d9d9"}
    says(p, f"friction_used: largest ratio |rT|/rN of a contact, of the fell cases{cut(data, 'fell').partition(': its')[0]}")
    assert cut(data, "fell")
    close(p.bar(), [np.nanmin(used), np.nanmax(used)], 0.03)
    for k in range(2):
        numbers_shown(p.panels[k], used[k].T, np.nanmin(used), np.nanmax(used))


def curve_of_shares():
    data = h5py.File("map.h5")
    basin = json.loads(stance("basin", "map.h5", "--by", "ground.friction", "--json"))
    p, friction = Picture("map-curve.svg"), data["ground.friction"][...]
    says(p, title_of(data), f"Stabilised cases against ground.friction, 63 cases per value{cut(data)}", "share of the box of starts (%)",
         "ground.friction", "theta (rad)", "vtheta (rad/s)")
    assert " ".join(p.said()).endswith("band: likely error (95 %), light: certain bounds below: how far it is stabilised along each axis "
                                        "through the equilibrium"), p.said()
    assert p.legend() == {"stabilised": COLOURS["stabilised"]}
    panel = p.panels[0]
    marks = panel.marks(COLOURS["stabilised"])
    close(panel.x(marks[:, 0]), friction, 0.002)
    close(panel.y(marks[:, 1]), [100 * r["share"] for r in basin["rows"]], 0.2)
    fill, area = panel.areas[0]
    assert fill == COLOURS["stabilised"]
    ends = sorted(100 * r[k] / basin["box"] for r in basin["rows"] for k in ("low", "high"))
    close(sorted(set(np.round(panel.y([y for _, y in area]), 1))), sorted(set(np.round(ends, 1))), 0.2)
    # The unbroken stretch of stabilised cases through the equilibrium ends midway to the next case.
    stable, theta = names(data) == "stabilised", data["initial.offset.theta"][...]
    zero = [np.argmin(np.abs(data[n][...])) for n in EQUILIBRIUM]
    for k in range(2):
        line, i, j = stable[k, :, zero[1]], zero[0], zero[0]
        while i > 0 and line[i - 1]:
            i -= 1
        while j + 1 < len(theta) and line[j + 1]:
            j += 1
        low = theta[i] if i == 0 else (theta[i] + theta[i - 1]) / 2
        high = theta[j] if j + 1 == len(theta) else (theta[j] + theta[j + 1]) / 2
        marks = p.panels[1].marks()
        here = marks[np.abs(p.panels[1].x(marks[:, 0]) - friction[k]) < 0.01]
        close(sorted(p.panels[1].y(here[:, 1])), [low, high], 0.001)


def lines():
    data = run("line", "ball_bounce.yaml", "sweep.grid[0]={path: ground.restitution, values: [0.1, 0.2, 0.4, 0.8, 0.99]}",
               "stop.time=5", "record.cases=none")
    stance("plot", "line.h5")
    p, outcome = Picture("line-curve.svg"), names(data)
    says(p, title_of(data), "What became of each of 5 cases", "outcome", "settle_time (s)", "end_time (s)", "friction_used",
         "ground.restitution")
    assert p.legend() == shares(data) and len(p.legend()) == 2
    strip = sorted(p.panels[0].areas, key=lambda a: min(x for x, _ in a[1]))
    assert [c for c, _ in strip] == [COLOURS["rested"], COLOURS["undecided"]]
    assert not p.panels[0].words(1), "a strip of outcomes has no scale"
    values = data["ground.restitution"][...]
    for k, name in enumerate(["settle_time", "end_time", "friction_used"]):
        panel, wanted = p.panels[k + 1], data[name][...]
        here = np.isfinite(wanted)
        marks = panel.marks()
        close(panel.x(marks[:, 0]), values[here], 0.004)
        close(panel.y(marks[:, 1]), wanted[here], 0.01 * (1e-3 + np.nanmax(wanted)))
        assert [q[2] for q in panel.points] == [COLOURS[w] for w in outcome[here]]
    stance("plot", "line.h5", "--answer", "steps")
    p = Picture("line-steps.svg")
    says(p, "steps")
    close(p.panels[1].y(p.panels[1].marks()[:, 1]), data["steps"][...], 0.01 * data["steps"][...].max())


def tics():
    """A logarithmic axis of less than a decade has tics to read by."""
    data = run("long", "ball_bounce.yaml", "sweep.grid[0]={path: ground.restitution, from: 0.2, to: 0.4, count: 5, spacing: log}",
               "stop.time=1", "record.cases=none")
    stance("plot", "long.h5")
    panel = Picture("long-curve.svg").panels[-1]
    texts = [t for _, t in panel.words(0)]
    assert 4 <= len(texts) <= 10 and all(float(t) * 1000 % 1 < 1e-6 for t in texts), texts
    close(panel.x(panel.marks()[:, 0], log=True), data["ground.restitution"][...], 0.001)


def samples():
    data = run("sample", "sampled.yaml", "sweep.sample.count=40", "record.cases=none")
    stance("plot", "sample.h5")
    p = Picture("sample-sample.svg")
    paths = [n for n in data if n.startswith(("ground.", "controller.", "initial.")) and data[n].shape == (40,)]
    says(p, "200 cases at 40 points of a design, sobol; what is stabilised is cut by the box at initial.offset.theta (lower end)",
         "controller.torque_limit (N m)", "stabilised (%)", "bars: 95 % interval")
    panel, marks = p.panels[0], p.panels[0].marks()
    # each point is drawn at its values, in the palette's colour of its share
    axis = names(data).shape.index(40)
    share = (names(data) == "stabilised").mean(axis=1 - axis)
    where = np.stack([panel.x(marks[:, 0], log=True), panel.y(marks[:, 1], log=True)], 1)
    wanted = np.stack([data["ground.friction"][...], data["controller.torque_limit"][...]], 1)
    close(where, wanted, 0.05)
    drawn = np.array([[int(q[2][i:i + 2], 16) for i in (0, 2, 4)] for q in panel.points])
    assert np.abs(drawn - cividis(share, 0, 1)).max() < 8
    below = p.panels[1:]
    assert len(below) == len(paths) and all(len(q.marks(COLOURS["stabilised"])) == 8 for q in below)
    for q in below: # eight bins of five points
        close(q.y(q.marks(COLOURS["stabilised"])[:, 1]).mean(), 100 * share.mean(), 1)
    order = np.argsort(data["ground.friction"][...]).reshape(8, 5)
    marks = below[0].marks(COLOURS["stabilised"])
    close(below[0].y(marks[:, 1]), 100 * share[order].mean(axis=1), 1)
    close(below[0].x(marks[:, 0], log=True), np.median(data["ground.friction"][...][order], axis=1), 0.02)


def rays():
    settings = "sweep={grid: [{path: initial.offset.scale, from: 0.05, to: 1, count: 20}], sample: {method: sphere, " \
        "count: 16, vary: [{path: initial.offset.theta, from: -0.1, to: 0.1}, {path: initial.offset.vtheta, from: -0.5, to: 0.5}]}}"
    run("rays", "basin_one_foot.yaml", settings, "record.cases=none")
    stance("plot", "rays.h5")
    rows = list(csv.DictReader(io.StringIO(stance("basin", "rays.h5", "--boundary"))))
    p = Picture("rays-rays.svg")
    nearest, = json.loads(stance("basin", "rays.h5", "--descend", "1", "--json"))["rows"]
    nearest = nearest["nearest"]
    says(p, "Where 16 rays from the equilibrium cease to be stabilised; nearest end in units of half the ranges: "
         + ", ".join(f"{path} {x:.2g}" for path, x in nearest["of_ranges"].items()), "initial.offset.theta (rad)",
         "diamond: the nearest end",
         "initial.offset.vtheta (rad/s)", "dashed: the ray that ends first", "circles: followed no further")
    assert p.legend() == {"stabilised": HUES[0]}
    panel = p.panels[0]
    ends = [[float(r[n]) for n in EQUILIBRIUM] for r in rows if r["end"] == "crosses"]
    dots = np.array([(x, y) for x, y, _, kind, size in panel.points if kind == 6])
    dots = np.stack([panel.x(dots[:, 0]), panel.y(dots[:, 1])], 1)
    for end in ends:
        assert (np.abs(dots - end).max(axis=1) < 0.003).any(), (end, dots)
    circles = [q for q in panel.points if q[3] == 5]
    assert len(circles) == sum(r["end"] == "open" for r in rows)
    diamonds = np.array([(panel.x(x), panel.y(y)) for x, y, _, kind, _ in panel.points if kind == 12])
    close(diamonds, [list(nearest["at"].values())] * 2, 0.003)
    # a scatter of rays: every case at its own place, in its outcome's colour
    data, panel = h5py.File("rays.h5"), Picture("rays-sample.svg").panels[0]
    outcome, marks = names(data), panel.marks()
    scale = data["initial.offset.scale"][...]
    for k, name in enumerate(EQUILIBRIUM):
        close((panel.x, panel.y)[k](marks[:, k]), (scale[:, None] * data[name][...]).ravel(), (0.0005, 0.003)[k])
    assert [q[2] for q in panel.points] == [COLOURS[w] for w in outcome.ravel()]
    assert Picture("rays-sample.svg").legend() == shares(data)


def case():
    data = run("case", "balance_recovers.yaml")
    stance("plot", "case.h5")
    track, time = data["trajectory"], data["trajectory/time"][...]
    rows = int(np.isfinite(track["position"][0, :, 0]).sum())
    p = Picture("case-coordinates.svg")
    says(p, title_of(data), "time (s)", "x (m)", "z (m)", "theta (rad)", "q1 (rad)", "q2 (rad)", "dashed: equilibrium",
         "pitch of the trunk, counter-clockwise")
    assert len(p.panels) == 5

    def shown(panel, wanted, hue, low=-np.inf, high=np.inf):
        """A line of that colour has the values, at the times it is read at, where they are in range."""
        ends = panel.range(1)
        line = np.array([point for q in panel.lines if q[0] == hue and not q[1] for point in q[2]])
        at, y = p_axis.x(line[:, 0]), panel.y(line[:, 1])
        close(y, np.interp(at, time[:rows], np.clip(wanted, max(low, ends[0]), min(high, ends[1]))), 0.012 * (ends[1] - ends[0]))
        assert at.min() < 0.011 and at.max() > time[rows - 1] - 0.02

    p_axis = p.panels[-1]
    for k in range(5):
        shown(p.panels[k], track["position"][0, :rows, k], HUES[0])
    for k, target in enumerate(data["design/equilibrium_position"][...]):
        dashed = [q for q in p.panels[k].lines if q[0] == HUES[1] and q[1]]
        assert len(dashed) == (k >= 2)
        if k >= 2:
            close(p.panels[k].y(dashed[0][2][0][1]), target, 0.002)
    p = Picture("case-forces.svg")
    says(p, "normal (N)", "tangential (N)")
    assert p.legend() == {"foot1": HUES[0], "foot2": HUES[1]}
    p_axis = p.panels[-1]
    for k in range(2):
        shown(p.panels[k], track["force"][0, :rows, 0, k], HUES[0])
    p = Picture("case-torques.svg")
    says(p, "torque (N m)", "dashed: limit 10 N m")
    assert p.legend() == {"hip1": HUES[0], "hip2": HUES[1]}
    p_axis = p.panels[-1]
    for k in range(2):
        shown(p.panels[0], track["torque"][0, :rows, k], HUES[k])
    close(sorted(p.panels[0].y(q[2][0][1]) for q in p.panels[0].lines if q[1]), [-10, 10], 0.1)
    p = Picture("case-gaps.svg")
    says(p, "gap (m)")
    p_axis = p.panels[-1]
    shown(p.panels[0], track["gap"][0, :rows, 1], HUES[1])


def strip():
    data = h5py.File("case.h5")
    p, time, gap = Picture("case-strip.svg"), data["trajectory/time"][...], data["trajectory/gap"][0]
    position = data["trajectory/position"][0]
    rows = int(np.isfinite(gap[:, 0]).sum())
    at = [k * (rows - 1) // 13 for k in range(14)]
    says(p, *[f"{time[k]:.3g} s" for k in at])
    assert p.legend() == {"foot1": HUES[0], "foot2": HUES[1], "body": "303030"}
    bar = next(t for t in p.said() if re.fullmatch(r"[\d.]+ m", t))
    lengths = [abs(q[2][1][0] - q[2][0][0]) for q in p.page.lines if q[0] == "404040"]
    metre = max(lengths) / float(bar.split()[0])
    ground = sorted({q[2][0][1] for q in p.page.lines if q[0] == "a0a0a0"})
    assert len(ground) == 2
    for hue, contact in ((HUES[0], 0), (HUES[1], 1)):
        marks = p.page.marks(hue)
        row = (marks[:, 1] > ground[0] + 40).astype(int)
        marks, row = marks[np.lexsort((marks[:, 0], row))], np.sort(row)
        close((np.array(ground)[row] - marks[:, 1]) / metre, gap[at, contact], 0.005)
    # the trunk's mass moves by as much as it does
    feet, body = p.page.marks(HUES[0]), np.unique(p.page.marks("303030"), axis=0)
    assert len(feet) == 14 and len(body) == 28
    high = sorted(ground[0] - y for x, y in body if y < ground[0] and y < ground[1] - 350)
    assert abs(max(high) / metre - (position[at[:7], 1]).max()) < 0.6


def mechanisms():
    """Stops are no feet, forces no torques; the ground slopes; what touches nothing is drawn, too."""
    stance("run", f"{SCENARIOS}/mechanisms/compass_gait.yaml", "--only", "4009", "--trace", "--set", "stop.time=0.8",
           "--quiet", "-o", "gait.h5")
    stance("plot", "gait.h5")
    p = Picture("gait-strip.svg")
    assert p.legend() == {"foot1": HUES[0], "foot2": HUES[1], "body": "303030"}
    ground = [np.subtract(q[2][1], q[2][0]) for q in p.page.lines if q[0] == "a0a0a0" and len(q[2]) == 2]
    assert len(ground) >= 14, ground
    close([y - math.tan(0.05235987755982988) * x for x, y in ground], np.zeros(len(ground)), 0.5)
    assert len(p.page.marks(HUES[1])) == 14
    for name, label in (("cart_pole", "force (N)"), ("acrobot", "torque (N m)")):
        stance("run", f"{SCENARIOS}/mechanisms/{name}.yaml", "--only", "3000", "--trace", "--quiet", "-o", f"{name}.h5")
        drawn = stance("plot", f"{name}.h5")
        assert "forces" not in drawn and "gaps" not in drawn
        says(Picture(f"{name}-torques.svg"), label)
        assert Picture(f"{name}-strip.svg").legend() == {"body": "303030"}


def sensitivities():
    run("what", "what_decides.yaml", "sweep.grid[0].count=3", "sweep.grid[1].count=3", "sweep.sample.count=16")
    stance("plot", "what.h5")
    study = json.loads(stance("sensitivity", "what.h5", "--json"))["tables"][0]["factors"]
    p = Picture("what-sensitivity.svg")
    says(p, "share of the variance")
    assert p.legend() == {"first: the factor alone": HUES[0], "total: with interactions": HUES[1]}
    panel = p.panels[0]
    for hue, measure in ((HUES[0], "first"), (HUES[1], "total")):
        marks = panel.marks(hue)
        rows = sorted(study, key=lambda f: -f["total"]["estimate"])
        close(panel.x(marks[:, 0]), [f[measure]["estimate"] for f in rows], 0.01)
        assert (np.diff(marks[:, 1]) > 0).all() # the most important above
        for f, (_, y) in zip(rows, marks): # named beside its marks
            assert [t for ty, t in panel.words(1) if abs(ty - y) < 8 and t.split(",")[0] == f["path"]], f["path"]
        bars = [q[2] for q in panel.lines if q[0] == hue and len(q[2]) == 2 and q[2][0][1] == q[2][1][1]]
        ends = sorted((min(a[0], b[0]), max(a[0], b[0])) for a, b in bars)
        wanted = sorted((f[measure]["low"], f[measure]["high"]) for f in rows if f[measure]["high"] > f[measure]["low"])
        for end in (0, 1):
            close(sorted(panel.x([e[end] for e in ends])), sorted(w[end] for w in wanted), 0.01)


def morris():
    with open("morris.local.yaml", "w", encoding="utf-8") as file:
        file.write("stance: 1\ntitle: Effects\nscene: ball\ninitial: {state: {z: 1}}\nstop: {time: 2, settle: off}\n"
                   "sweep: {sample: {method: morris, count: 12, vary: [{path: initial.state.z, from: 1, to: 2},\n"
                   "  {path: initial.state.vx, from: 0, to: 3}, {path: ground.friction, from: 0, to: 1}]}}\n")
    run("morris", "morris.local.yaml")
    stance("plot", "morris.h5", "--answer", "slip_distance")
    study = json.loads(stance("sensitivity", "morris.h5", "--answer", "slip_distance", "--json"))["tables"][0]["factors"]
    p = Picture("morris-slip_distance-sensitivity.svg")
    says(p, "mu*, mean magnitude of the effects", "sigma, standard deviation of the effects")
    panel = p.panels[0]
    marks = [(float(panel.x(x)), float(panel.y(y))) for x, y, c, kind, _ in panel.points if kind == 6]
    rows = sorted(study, key=lambda f: -f["mu_star"]["estimate"])
    close(marks, [[f[k]["estimate"] for k in ("mu_star", "sigma")] for f in rows], 0.02 * (1 + rows[0]["mu_star"]["estimate"]))
    for k, f in enumerate(rows):
        says(p, f"{k + 1}  {f['path']}")


def accuracy():
    with open("accuracy.local.yaml", "w", encoding="utf-8") as file, open(f"{SCENARIOS}/accuracy/block.yaml", encoding="utf-8") as old:
        text = re.sub(r"^ *- \[(\w|-)+, 0.000[12], 1\]\n", "", old.read(), flags=re.M)
        file.write(text.replace("count: 8}", "count: 2}"))
    stance("bench", "accuracy", "accuracy.local.yaml", "-o", ".")
    rows = json.loads(stance("bench", "accuracy", "--reuse", "--json", "accuracy.local.yaml", "-o", "."))["studies"][0]["rows"]
    p = Picture("accuracy.local.svg")
    says(p, "largest error of a coordinate (m, rad)", "mean over time of the velocity error (m/s, rad/s)",
         "cost: microseconds of one core per simulated second")
    methods = [m for m in dict.fromkeys(r["method"] for r in rows)]
    legend = p.legend()
    assert set(legend) == set(methods), legend
    for k, name in enumerate(["position_error", "velocity_error"]):
        for method in methods:
            wanted = sorted(r[name] for r in rows if r["method"] == method and r[name] and not r["reference"])
            drawn = sorted(p.panels[k].y([y for _, y, c, kind, _ in p.panels[k].points if c == legend[method]], log=True))
            close(np.log10(drawn), np.log10(wanted), 0.05)
        p.panels[k].x(0, log=True)


def failures():
    with open(f"{SCENARIOS}/failure/step_stiffness.yaml", encoding="utf-8") as old:
        text = old.read()
    values = re.findall(r"^ +- \[[\d.e+]+, [\d.e+]+\]\n", text, re.M)
    for k, line in enumerate(values):
        text = text if k % 6 == 0 else text.replace(line, "", 1)
    steps = re.search(r"values:\s*\[(0\.0001[^\]]*)\]", text)
    few = re.split(r",\s*", steps[1])[10::4]
    text = text.replace(steps[1], ", ".join(few))
    with open("failure.local.yaml", "w", encoding="utf-8") as file:
        file.write(text)
    stance("bench", "failure", "failure.local.yaml", "-o", ".")
    study = json.loads(stance("bench", "failure", "--reuse", "--json", "failure.local.yaml", "-o", "."))["studies"][0]
    p = Picture("failure.local.svg")
    x, y = (np.array(a["values"]) for a in study["axes"])
    says(p, study["title"], "method.step (s)", "controller.kp (N m/rad), with kd", "reasons of failures", study["theory"]["text"])
    words = {"gave_up": "gave up", "ran_away": "ran away", "broke_law": "broke a contact law", "wrong_outcome": "wrong outcome",
             "inaccurate": "right outcome, inaccurate", "unjudged": "kept the laws, no reference",
             "right_other": "right: fell, or still moves", "right_stands": "right: came to stand or rest"}
    colours = dict(zip(words, ["000000", "d55e00", "cc79a7", "e69f00", "f0e442", "c8c8c8", "9fd4f5", "0072b2"]))
    counted = {v for r in study["rows"] for v, n in r["cases"].items() if n}
    assert p.legend() == {words[v]: colours[v] for v in counted}, p.legend()
    assert len(p.panels) == len(study["rows"]) == 5
    for panel, row in zip(p.panels, study["rows"]):
        verdicts = np.array(row["map"]) # [step][kp]
        assert (hexes(image_of(panel)) == np.vectorize(colours.get)(verdicts.T)).all(), row["method"]
        spans(panel, 0, x, log=True)
        spans(panel, 1, y, log=True)
        titles = [t for tx, ty, t, _ in p.texts if tx is not None and abs(tx - panel.left) < 2 and 0 < panel.top - ty < 14]
        assert titles and titles[0].startswith(row["method"]), titles
        for n in row["cases"].values(): # of the table
            share = 100 * n / verdicts.size
            says(p, f"{share:.1f} %" if share >= 1 else "-" if n == 0 else f"{share:.2g} %")
        black = [q[2] for q in panel.lines if q[0] == "000000"]
        if black: # of the line of theory those ends that are on the map
            line = np.array(black[-1])
            steps = np.interp(np.log10(panel.y(line[:, 1], log=True)), np.log10(y), np.log10(study["theory"]["values"]))
            close(np.log10(panel.x(line[:, 0], log=True)), steps, 0.05)
    assert any(q[0] == "000000" for panel in p.panels for q in panel.lines)
    p = Picture("failure.local-energy.svg")
    says(p, "failed", "over each map: the largest share", *[f"{r['energy_share']:.2g}" for r in study["rows"]])
    top = [cividis([math.log10(min(max(r["energy_share"], 1e-16), 10))], -16, 1)[0] for r in study["rows"]]
    for panel, row, wanted in zip(p.panels, study["rows"], top):
        pixels = image_of(panel)
        gone = np.array(row["map"]).T == "gave_up"
        assert (pixels[..., 3][gone] == 0).all()
        drawn = pixels[..., :3][pixels[..., 3] == 255]
        best = drawn[np.argmax(drawn[:, 0])]
        assert np.abs(best - wanted).max() < 8, (row["method"], best, wanted)


def speeds():
    text = stance("bench", "--csv", "--repeats", "1", "--cases", "4", "--scene", "biped")
    rows = list(csv.DictReader(io.StringIO(text)))
    for cases, seconds in ((65536, 1.5), (262144, 6.5), (1048576, 25)):
        rows.append(dict(rows[0], subject="program", regime="basin full", ranks=2, cases=cases, quantity="wall time",
                         median=seconds, lowest=0.9 * seconds, highest=1.2 * seconds))
    with open("speed.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    stance("bench", "plot", "speed.csv", "-o", ".")
    p = Picture("speed.svg")
    says(p, "Speed of the stepping kernels", "nanoseconds per case-step of one core", "wall time of the program on 2 ranks (s)",
         "cases of the stability map", "every case")
    steps = [r for r in rows if r["quantity"] == "time per step"]
    own = [r for r in steps if r["method"] == "implicit"]
    legend = p.legend()
    isas = {"scalar": "1 lane", "sse2": "SSE2", "avx2": "AVX2", "avx512": "AVX-512", "neon": "NEON"}
    for isa in {r["isa"] for r in own}:
        assert isas[isa] in legend

    def bars(panel, hue):
        """Heights of the bars of a colour, from left to right."""
        tops = sorted((min(x for x, _ in q), min(y for _, y in q)) for c, q in panel.areas if c == hue)
        return panel.y([y for _, y in tops], log=True)

    upper, lower = p.panels[0], p.panels[1]
    for isa in {r["isa"] for r in own}:
        wanted = [float(r["median"]) for g in ("flight", "one foot", "two feet") for r in own if r["regime"] == g and r["isa"] == isa]
        close(np.log10(bars(upper, legend[isas[isa]])), np.log10(wanted), 0.03)
    best = {}
    for r in steps:
        key = (r["method"], r["regime"])
        best[key] = r if key not in best or int(best[key]["lanes"]) <= int(r["lanes"]) else best[key]
    for method in {m for m, _ in best}:
        wanted = [float(best[method, g]["median"]) for g in ("flight", "one foot", "two feet")]
        close(np.log10(bars(lower, legend[method])), np.log10(wanted), 0.03)
    panel = p.panels[2]
    close(panel.y(panel.marks(HUES[0])[:, 1], log=True), [1.5, 6.5, 25], 0.5)
    assert [t for _, t in panel.words(0)] == ["256²", "512²", "1024²"]


tap([maps, tables, axes, greys, allowed, answers, curve_of_shares, lines, tics, samples, rays, case, strip, mechanisms, sensitivities, morris, accuracy, failures,
     speeds])
