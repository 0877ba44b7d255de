#!/usr/bin/python3
"""Makes small results files with h5py, in the layout that runner/store/store.h describes.

The answers are not simulated: they follow formulas, so that the analysis has something known to
be compared with. Usage: make_sample_results.py DIRECTORY

  basin.h5       two offsets, 41 x 31: stabilised inside the ellipse (theta / 0.05)^2 +
                 (vtheta / 0.4)^2 <= 1, fell outside; settle_time = 1 + its left-hand side
  partial.h5     the same 10 x 6, with pending and failed cases; pending rows hold rubbish
  friction.h5    ground.friction (5 values) x 21 x 11: the ellipse shrinks with the friction
  line.h5        controller.sample_time, 9 values, log spacing: stabilised up to 0.01 s
  methods.h5     words x numbers
  one.h5         a grid of 1 x 1
  nothing.h5     all cases stabilised, every number NAN
  sparse.h5      record.answers: outcome is not stored
  single.h5      one case with a trajectory: z falls to the ground, theta = 0.1 exp(-t) - 0.41
  bare.h5        one case without a trajectory
  only.h5        one case of a sweep (run --only), with a trajectory
  ball.h5        another scene, without actuators: ground.restitution, 5 values; three cases rested,
                 one undecided, one failed, its reason numbered as program 0.1 did
  title.h5       a title that gnuplot and XML could misread
  changed.h5     basin.h5 with end_time of case 97 changed, and another host and timing
  rubbish.h5     partial.h5 with other rubbish in the pending rows
  unfinished.h5  partial.h5 with the case nearest to the equilibrium pending
  unlucky.h5     friction.h5 with that case failed at the friction 0.3, pending at 0.5
  bytes.h5       basin.h5 with a damaged byte in its title, which is then no UTF-8
  foreign.h5     an HDF5 file that is not ours
"""
import hashlib
import os
import shutil
import sys

import h5py
import numpy as np

from results_tools import put_checksums

SCENARIO = """stance: 1
title: {title}
scene: biped
ground: {{friction: 0.8, restitution: 0, contacts: [foot1]}}
initial:
  equilibrium: {{theta: -0.41, q2: 0.82}}
  support_foot: 1
controller:
  kind: state-feedback
  design: place
  poles: [-3, -3.3, -3.6, -3.9, -4.2, -4.6]
  sample_time: 0.001
  torque_limit: 10
method: {{name: implicit, step: 0.001}}
stop: {{time: 8}}
seed: 1
"""
BALL = """stance: 1
title: {title}
scene: ball
initial: {{state: {{z: 0.6}}}}
method: {{name: capturing}}
stop: {{time: 8}}
"""
STATES = ["x", "z", "theta", "q1", "q2", "vx", "vz", "vtheta", "vq1", "vq2"]
EQUILIBRIUM = [0.1, 1.0, -0.41, 0.5701271, 0.82]
WORDS = h5py.string_dtype("utf-8")
MEANINGS = {
    "status": "pending done failed",
    "outcome": "none stabilised fell rested undecided",
    "failure": "none newton not_finite angle contact initial",
}
UNITS = {"end_time": "s", "settle_time": "s", "fall_time": "s", "max_penetration": "m",
         "peak_torque": "N m", "impact_energy": "J", "projection_energy": "J"}


class File:
    """One results file under construction."""

    def __init__(self, path, title, axes, extra="", scenario=SCENARIO):
        self.file = h5py.File(path, "w", track_order=True)
        self.dimensions = 0
        attributes = self.file.attrs
        text = scenario.format(title="'" + title.replace("'", "''") + "'") + extra
        names = ",".join(name for name, *_ in axes)
        for name, value in {
                "Conventions": "CF-1.8", "title": title, "program_version": "0.1.0",
                "git_revision": "sample", "compiler": "none", "library_versions": "h5py",
                "hosts": "here", "date": "2024-01-01T00:00:00Z", "axes": names, "scenario": text,
                "scenario_sha256": hashlib.sha256(text.encode()).hexdigest()}.items():
            attributes[name] = value
        attributes["format_version"] = np.int32([1])
        attributes["ranks"] = np.int32([2])
        attributes["seed"] = np.uint64([1])
        self.axes = [self.scale(self.file, *axis) for axis in axes]
        self.shape = tuple(len(axis) for axis in self.axes)
        timing = self.file.create_group("timing")
        timing["wall_time"] = np.array([2.0, 3.0])
        timing["cases"] = np.array([100, 150], dtype="i8")

    def scale(self, group, name, values, unit=None, text=None):
        """A dimension with its values: numbers or words."""
        words = isinstance(values[0], str)
        data = group.create_dataset(name, data=list(values) if words else np.asarray(values),
                                    dtype=WORDS if words else None)
        data.make_scale(name)
        data.attrs["_Netcdf4Dimid"] = np.int32(self.dimensions)
        self.dimensions += 1
        if unit:
            data.attrs["units"] = unit
        if text:
            data.attrs["long_name"] = text
        return data

    def variable(self, name, data, dimensions, group=None):
        """A variable over dimensions."""
        variable = (group or self.file).create_dataset(name, data=data)
        for k, dimension in enumerate(dimensions):
            variable.dims[k].attach_scale(dimension)
        if name in MEANINGS:
            words = MEANINGS[name]
            variable.attrs["flag_values"] = np.arange(len(words.split()), dtype="u1")
            variable.attrs["flag_meanings"] = words
        if name in UNITS:
            variable.attrs["units"] = UNITS[name]

    def answers(self, stabilised, settle=None, status=None, failure=None, without=()):
        """Every answer of the cases, from whether they were stabilised."""
        n = stabilised.shape
        status = np.ones(n, "u1") if status is None else status
        settle = np.ones(n) if settle is None else settle
        done = status == 1
        outcome = np.where(done, np.where(stabilised, 1, 2), 0).astype("u1")
        count = np.arange(stabilised.size).reshape(n)
        data = {
            "outcome": outcome, "evidence": done.astype("u1"),
            "failure": np.zeros(n, "u1") if failure is None else failure,
            "end_time": np.where(stabilised, settle + 0.5, 0.8),
            "settle_time": np.where(stabilised, settle, np.nan),
            "fall_time": np.where(stabilised, np.nan, 0.8),
            "steps": np.full(n, 1000, "i8"), "iterations": np.full(n, 2500, "i8"),
            "ambiguous_steps": (count % 7 == 0).astype("i8"),
            "subdivided_steps": np.zeros(n, "i8"),
            "max_penetration": 1e-9 * (1.0 + count),
            "slip_distance": np.zeros(n), "peak_torque": np.full(n, 10.0),
            "friction_used": np.where(stabilised, 0.1 + 0.1 * settle, 0.8),
            "impact_energy": np.zeros(n), "projection_energy": np.full(n, 1e-12),
        }
        for name, values in data.items():
            if name not in without:
                if name not in ("outcome", "evidence", "failure"):
                    values = np.where(status == 0, 7, values).astype(values.dtype)
                self.variable(name, values, self.axes)
        if "final_state" not in without:
            state = self.scale(self.file, "state", STATES)
            final = np.zeros(n + (10,)) + np.array(EQUILIBRIUM + [0.0] * 5)
            self.variable("final_state", final, self.axes + [state])
        self.variable("checksum", np.zeros(n, "u4"), self.axes)
        self.variable("status", status, self.axes)
        design = self.file.create_group("design")
        coordinate = self.scale(design, "coordinate", STATES[:5])
        for name in ("equilibrium_position", "start_position"):
            self.variable(name, np.array(EQUILIBRIUM), [coordinate], design)

    def trajectory(self, case, end=3.0, last=8.0, interval=0.01):
        """A robot that drops to the ground, sways and stands; nothing after `end`."""
        group = self.file.create_group("trajectory")
        number = self.scale(group, "case", np.array([case], dtype="i8"))
        t = interval * np.arange(round(last / interval) + 1)
        time = self.scale(group, "time", t, "s")
        coordinate = self.scale(group, "coordinate", STATES[:5])
        actuator = self.scale(group, "actuator", ["hip1", "hip2"])
        contact = self.scale(group, "contact", ["foot1", "foot2"])
        component = self.scale(group, "component", ["normal", "tangential"])
        sway = 0.1 * np.exp(-t) * np.cos(6 * t)
        landing = 0.3
        z = np.maximum(1.0 + 0.5 * 9.81 * (landing**2 - t**2), 1.0)
        position = np.stack([0.2 + sway, z, -0.41 + 0.1 * np.exp(-t), 0.57 - 2 * sway,
                             0.82 + 3 * sway], axis=1)
        velocity = np.gradient(position, interval, axis=0)
        torque = np.clip(np.stack([120 * sway, -60 * sway - 1.5], axis=1), -10, 10)
        down = t >= landing
        force = np.zeros((len(t), 2, 2))
        force[:, 0, 0] = np.where(down, 111.2 * (1 + 2 * sway), 0)
        force[:, 0, 1] = np.where(down, 60 * sway, 0)
        force[np.argmax(down), 0] = [9000.0, -2500.0]
        gap = np.stack([z - 1.0, np.full_like(t, 0.0375) + 0.2 * np.abs(sway)], axis=1)
        for values in (position, velocity, torque, force, gap):
            values[t > end + 1e-9] = np.nan
        base = [number, time]
        self.variable("position", position[None], base + [coordinate], group)
        self.variable("velocity", velocity[None], base + [coordinate], group)
        self.variable("torque", torque[None], base + [actuator], group)
        self.variable("force", force[None], base + [contact, component], group)
        self.variable("gap", gap[None], base + [contact], group)

    def close(self):
        """Brings it to the disk."""
        put_checksums(self.file)
        self.file.close()


def theta_axis(n, low=-0.1, high=0.1):
    """An axis of tilts."""
    return ("initial.offset.theta", np.linspace(low, high, n), "rad",
            "initial offset: pitch of the trunk, counter-clockwise from upright")


def rate_axis(n):
    """An axis of rates."""
    return ("initial.offset.vtheta", np.linspace(-0.6, 0.6, n), "rad/s",
            "initial offset: rate of the pitch of the trunk")


def friction_axis(values):
    """An axis of frictions."""
    return ("ground.friction", np.array(values), "1", "Coulomb coefficient of friction")


SWEEP = """sweep:
  grid:
    - {path: initial.offset.theta, from: %g, to: %g, count: %d}
    - {path: initial.offset.vtheta, from: -0.6, to: 0.6, count: %d}
"""


def ellipse(file, scale=1.0):
    """(theta / 0.05)^2 + (vtheta / 0.4)^2 over the last two axes, halved in size by scale 2."""
    theta, rate = file.axes[-2][:], file.axes[-1][:]
    return ((scale * theta[:, None] / 0.05) ** 2 + (scale * rate[None, :] / 0.4) ** 2)


def make_maps(where):
    """Sweeps over two and three axes."""
    file = File(where("basin"), "An ellipse", [theta_axis(41), rate_axis(31)],
                SWEEP % (-0.1, 0.1, 41, 31))
    level = ellipse(file)
    file.answers(level <= 1, 1 + level)
    file.close()

    file = File(where("partial"), "Half done", [theta_axis(10, -0.09, 0.09), rate_axis(6)],
                SWEEP % (-0.09, 0.09, 10, 6))
    level = ellipse(file)
    status = np.ones(level.shape, "u1")
    status[7:, :] = 0
    failure = np.zeros(level.shape, "u1")
    status[2, 1:3] = 2
    failure[2, 1:3] = [1, 4]
    file.answers(level <= 1, 1 + level, status, failure)
    file.close()

    file = File(where("friction"), "Friction", [friction_axis([0.1, 0.2, 0.3, 0.5, 0.8]),
                                                theta_axis(21), rate_axis(11)])
    level = np.stack([ellipse(file, scale) for scale in (100, 3, 2, 1, 1)])
    file.answers(level <= 1, 1 + level)
    file.close()

    file = File(where("one"), "A single point", [theta_axis(1, 0.0, 0.0), rate_axis(1)])
    file.answers(np.ones((1, 1), bool))
    file.close()

    file = File(where("nothing"), "No numbers", [theta_axis(4), rate_axis(3)])
    file.answers(np.ones((4, 3), bool), np.full((4, 3), np.nan))
    file.close()

    file = File(where("sparse"), "No outcomes", [theta_axis(4), rate_axis(3)])
    file.answers(np.ones((4, 3), bool), without=("outcome", "settle_time", "final_state"))
    file.close()

    file = File(where("title"), "It's \"100 %\" <b> & a_b^{c} \\n `touch pwned` @x $y {/*3 z} \u03b8",
                [theta_axis(5), rate_axis(5)])
    level = ellipse(file)
    file.answers(level <= 1, 1 + level)
    file.close()


def make_lines(where):
    """Sweeps over one axis, and one of words."""
    times = 0.001 * 10 ** (np.arange(9) / 4)
    file = File(where("line"), "Sample times", [
        ("controller.sample_time", times, "s", "interval at which the torques are renewed")])
    file.answers(times <= 0.0101, 1 + 30 * times)
    file.close()

    file = File(where("methods"), "Two methods", [
        ("method.name", ["implicit", "midpoint"], None, "time-stepping method"), theta_axis(9)])
    stabilised = np.stack([np.abs(file.axes[1][:]) < 0.06, np.abs(file.axes[1][:]) < 0.03])
    file.answers(stabilised)
    file.close()


def make_ball(where):
    """A scene without a controller, with the answers that came after program 0.1."""
    file = File(where("ball"), "A ball", [
        ("ground.restitution", np.linspace(0, 1, 5), "1", "coefficient of restitution")],
        scenario=BALL)
    file.answers(np.zeros(5, bool), status=np.array([1, 1, 1, 1, 2], "u1"),
                 failure=np.array([0, 0, 0, 0, 5], "u1"),
                 without=("outcome", "final_state", "peak_torque"))
    file.variable("outcome", np.array([3, 3, 3, 4, 0], "u1"), file.axes)
    file.variable("events", np.array([0, 2, 4, 8, 100]), file.axes)
    file.variable("evaluations", np.array([2500, 2500, 2500, 3300, 9]), file.axes)
    file.variable("energy_gain", np.array([1e-9, 3e-9, 2e-9, 0, 7]), file.axes)
    file.variable("signorini_residual", np.array([1e-12, 0, 0, 4e-12, 7]), file.axes)
    file.close()


def make_cases(where):
    """Single cases."""
    case = [("case", np.array([0], dtype="i8"), "1", "flat index of the case")]
    file = File(where("single"), "One case", case)
    file.answers(np.ones(1, bool), np.array([2.5]))
    file.trajectory(0)
    file.close()

    file = File(where("bare"), "One case", case)
    file.answers(np.ones(1, bool), np.array([2.5]))
    file.close()

    file = File(where("only"), "One case of many",
                [("case", np.array([17], dtype="i8"), "1", "flat index of the case")],
                SWEEP % (-0.1, 0.1, 41, 31))
    for name, *values in (theta_axis(41), rate_axis(31)):
        file.variable(name, values[0][[0 if "vtheta" not in name else 17]], file.axes)
    file.answers(np.zeros(1, bool))
    file.trajectory(17, end=0.8)
    file.close()


def make_others(where):
    """Copies that differ in a known way, and a file of somebody else."""
    shutil.copy(where("basin"), where("changed"))
    with h5py.File(where("changed"), "r+") as file:
        file["end_time"][3, 4] += 1e-15
        file["timing/wall_time"][0] = 99
        file.attrs["hosts"] = "there"
        put_checksums(file)
    shutil.copy(where("partial"), where("rubbish"))
    with h5py.File(where("rubbish"), "r+") as file:
        file["end_time"][8, 2] = 99
        file["final_state"][9] = 3
        file["outcome"][9, 1] = 200
    shutil.copy(where("partial"), where("unfinished"))
    with h5py.File(where("unfinished"), "r+") as file:
        file["status"][4, 2] = 0
        put_checksums(file)
    shutil.copy(where("friction"), where("unlucky"))
    with h5py.File(where("unlucky"), "r+") as file:
        file["status"][2, 10, 5] = 2
        file["status"][3, 10, 5] = 0
        put_checksums(file)
    shutil.copy(where("basin"), where("bytes"))
    with h5py.File(where("bytes"), "r+") as file:
        del file.attrs["title"]
        file.attrs["title"] = np.bytes_(b"An \xffellipse")
    with h5py.File(where("foreign"), "w") as file:
        file["temperature"] = np.arange(5.0)


def main():
    """Makes them all."""
    directory = sys.argv[1]

    def where(name):
        return os.path.join(directory, name + ".h5")

    make_maps(where)
    make_lines(where)
    make_ball(where)
    make_cases(where)
    make_others(where)


if __name__ == "__main__":
    main()
