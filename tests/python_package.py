#!/usr/bin/python3
"""The Python package: `import stance`, see analysis/python. Where this is called stands own.yaml. Speaks TAP.

    python_package.py page PAGE     every line of code of a page, in order, each block a check, and that of the READMEs
    python_package.py package       types, names, errors, words, ranks, Ctrl-C
    python_package.py notebook PAGE its first block in a notebook, and the picture shown
"""
import copy
import os
import pathlib
import pickle
import re
import signal
import subprocess
import sys
import time
import warnings
import xml.etree.ElementTree

import h5py
import numpy
import pandas
import xarray

from tap import PATIENCE, tap

import stance

TOP = pathlib.Path(__file__).resolve().parent.parent
TWO = [stance.axis("initial.offset.body", -0.3, 0.2, 6), stance.axis("initial.offset.vbody", -1, 0.6, 9)]


def own(**keys):
    """The robot of the README with a grid of 6 x 9."""
    return stance.scenario("own.yaml").set({"sweep.grid": TWO}).set(keys)


def blocks(page):
    """Its code: what is indented by four, until something else comes."""
    text, found = pathlib.Path(page).read_text(encoding="utf-8"), []
    for line in text.splitlines():
        if line.startswith("    "):
            found[-1:] = [(found[-1] if found else "") + line[4:] + "\n"]
        elif not found or found[-1]:
            found.append("")
    return [block for block in found if block]


def of_page(page):
    """A check for each block, in one namespace."""
    names = {}

    def check(number, block):
        def run():
            exec(compile(block, f"block {number}", "exec"), names)  # pylint: disable=exec-used
        run.__name__ = f"block {number}: {block.splitlines()[0].strip()}"
        return run

    def what_it_tells():
        assert len(blocks(page)[0].splitlines()) == 8
        assert 75 < names["ankles"].basin(threshold=0.8, of="robot.actuators.ankle.limit")["rows"][0]["value"] < 105
        assert pathlib.Path("ankles.pdf").read_bytes().startswith(b"%PDF-")
        assert pathlib.Path("swing.gif").read_bytes().startswith(b"GIF89a")
        assert names["picture"].names == ["map", "settle_time", "curve"] and names["seen"][-1] == 1
        assert names["swing"].outcome.dims == ("initial.offset.rod", "initial.offset.vrod")
        assert names["swing"].share() > 0
    others = [block for name in ("README.md", "runner/README.md") for block in blocks(TOP / name)
              if re.match(r"import (stance|h5py)\n|study = stance\.", block)]
    assert len(others) == 3, others
    return [check(*each) for each in enumerate(blocks(page) + others, 1)] + [what_it_tells]


def in_notebook(page):
    """The page's first study in a notebook's cell, and its map in the next."""
    def a_notebook_shows_the_map():
        import nbclient  # pylint: disable=import-outside-toplevel
        import nbformat  # pylint: disable=import-outside-toplevel
        cells = [nbformat.v4.new_code_cell(block) for block in (blocks(page)[0], "ankles.plot()")]
        book = nbformat.v4.new_notebook(cells=cells)
        nbclient.NotebookClient(book, timeout=PATIENCE, kernel_name="python3").execute()
        shown = book.cells[1].outputs[0]["data"]["image/svg+xml"]
        assert xml.etree.ElementTree.fromstring(shown).tag == "{http://www.w3.org/2000/svg}svg"
    return [a_notebook_shows_the_map]


def fails(kind, call, *patterns):
    """The exception, which has to be of this kind, and say all that."""
    try:
        call()
    except kind as error:
        for pattern in patterns:
            assert re.search(pattern, str(error)), error
        return error
    raise AssertionError("nothing is raised")


def a_dataset_has_axes_units_and_words():
    study = own().run(output="grid.h5", force=True)
    data = study.data
    assert isinstance(data, xarray.Dataset) and study.outcome.dims == ("initial.offset.body", "initial.offset.vbody")
    assert study.outcome.shape == (6, 9) and study["initial.offset.body"].attrs["units"] == "rad"
    assert numpy.allclose(data["initial.offset.vbody"], numpy.linspace(-1, 0.6, 9)) and study.settle_time.attrs["units"] == "s"
    assert "settled" in study.settle_time.attrs["long_name"]
    with h5py.File("grid.h5") as file:
        words = file["outcome"].attrs["flag_meanings"].decode().split()
        assert (study.outcome == numpy.array(words)[file["outcome"][...]]).all()
        assert numpy.array_equal(data.settle_time, file["settle_time"][...], equal_nan=True)
    assert set(study.failure.values.flat) == {"none"} and "head" in study.fall_cause and data.steps.dtype == numpy.int64
    assert study.final_state.sel(state="body").shape == (6, 9)
    assert study.share("fell") == (study.outcome == "fell").mean() and "settle_time" in dir(study)


def numbers_are_those_of_other_readers():
    try:
        other = xarray.open_dataset("grid.h5", engine="netcdf4")
    except ValueError:
        return  # no netCDF4
    with other:
        data = stance.open("grid.h5").data
        for name in other.data_vars:
            if name != "checksum" and "flag_values" not in other[name].attrs:
                assert other[name].dims == data[name].dims, name
                assert numpy.array_equal(other[name], data[name], equal_nan=True), name


def a_table_is_a_data_frame():
    study = stance.open("grid.h5")
    table = study.table()
    assert isinstance(table, pandas.DataFrame) and len(table) == 54
    assert list(table["outcome"]) == list(study.outcome.values.flat) and set(table["failure"]) == {"none"}
    basin = study.basin()
    assert isinstance(study.basin(frame=True), pandas.DataFrame)
    assert numpy.isclose(study.basin(frame=True)["share"][0], basin["rows"][0]["share"])
    assert study.summary()["cases"]["total"] == 54 and study.compare("grid.h5")["identical"]


def the_file_is_closed():
    study = stance.open("grid.h5")
    assert study.outcome.size == 54
    assert not [f for f in os.listdir("/proc/self/fd") if os.path.realpath(f"/proc/self/fd/{f}").endswith("grid.h5")]
    own(**{"title": "again"}).run(output="grid.h5", force=True)
    assert study.data.attrs["title"] != "again" and stance.open("grid.h5").data.attrs["title"] == "again"


def a_sample_is_along_sample():
    study = own(sweep={"grid": [{"path": "method.name", "values": ["capturing", "midpoint"]},
                                {"paths": ["robot.bodies.body.mass", "robot.bodies.foot.mass"],
                                 "values": [[70, 2], [80, 3]]}],
                       "sample": {"method": "sobol", "count": 8, "vary": [
                           {"path": "initial.offset.body", "from": -0.3, "to": 0.2},
                           {"path": "ground.friction", "from": 0.1, "to": 1}]}}).run(output="sample.h5")
    assert study.outcome.dims == ("method.name", "robot.bodies.body.mass", "sample")
    assert study["ground.friction"].dims == ("sample",) and study["robot.bodies.foot.mass"].values.tolist() == [2, 3]
    assert study.outcome.sel({"method.name": "midpoint", "robot.bodies.body.mass": 80}).shape == (8,)
    assert len(study.sensitivity(frame=True)) == 8 and study.sensitivity()["method"] == "sobol"


def one_case_is_along_case():
    study = stance.scenario("own.yaml").run(output="one.h5")
    assert study.outcome.dims == ("case",) and study.trajectory().time[0] == 0


def a_trajectory_is_recorded_or_made_again():
    again = stance.open("grid.h5").trajectory(7)
    traced = own().run(output="case7.h5", only=7, trace=True)
    assert traced.case.values.tolist() == [7] and again.identical(traced.trajectory())
    assert again.position.dims == ("time", "coordinate") and again.force.dims == ("time", "contact", "component")
    assert again.gap.attrs["units"] == "m" and not numpy.isnan(again.position).any()
    fails(IndexError, lambda: stance.open("grid.h5").trajectory(54), r"0 \.\.\. 53")
    fails(TypeError, lambda: stance.open("grid.h5").trajectory("7"))


def a_dict_is_a_scenario():
    drop = stance.scenario({"scene": "ball", "initial": {"state": {"z": numpy.float64(0.5)}}, "stop": {"time": 0.1}})
    assert drop["stance"] == 1 and drop["initial.state.z"] == 0.5 and drop.check()["cases"] == 1
    study = drop.run(output="drop é.h5")
    assert study.file == "drop é.h5" and study.scenario["initial.state.z"] == 0.5
    wrong = stance.scenario({"scene": "ball", "initial": {"state": {"z": 1}}, "stop": {"time": 1, "tim": 1}})
    error = fails(stance.ScenarioError, wrong.check, "'time'")
    line = wrong.text.splitlines()[error.line - 1]
    assert error.file == "<scenario>" and "tim" in line[error.column - 1:], (error.column, line)


def keys_are_read_and_set():
    pathlib.Path("words.yaml").write_text("stance: 1\nscene: ball # a comment\nx-a: &a {friction: 1e-1, law: off}\n"
                                          "ground: {<<: *a, slope: 0.1}\ninitial: {state: {z: 1}}\nstop: {time: 1}\n",
                                          encoding="utf-8")
    words = stance.scenario(pathlib.Path("words.yaml"))
    assert words["ground.friction"] == 0.1 and words["ground.law"] == "off" and words["ground.slope"] == 0.1
    assert "# a comment" in words.text and words.set(title="a: b")["title"] == "a: b"
    robot = own()
    other = robot.copy().set({"robot.bodies.foot.centre[1]": numpy.float32(0.5), "sweep.grid[1].count": 5})
    assert other["robot.bodies.foot.centre"] == [0.04, 0.5] and robot["robot.bodies.foot.centre[1]"] == 0.03
    assert other["sweep.grid"][1]["count"] == 5 and robot["sweep.grid[1].count"] == 9 and other.check()["cases"] == 30
    saved = other.save("saved ü.yaml")
    assert saved.check()["cases"] == 30 and saved["robot.bodies.foot.centre[1]"] == 0.5
    assert other.set({"sweep": {}}).check()["cases"] == 1 and copy.copy(other)["ground.friction"] == 0.7
    assert "own.yaml" in repr(other) and pickle.loads(pickle.dumps(other)).check()["cases"] == 1


def wrong_names_are_told():
    fails(KeyError, lambda: own()["ground.fricton"], "did you mean 'ground.friction'")
    fails(stance.PathError, lambda: own().set({"ground.fricton": 1}), "did you mean 'ground.friction'")
    fails(KeyError, lambda: own()["ground.slope"], "default")
    fails(KeyError, lambda: stance.open("grid.h5")["settletime"], "did you mean 'settle_time'")
    fails(AttributeError, lambda: stance.open("grid.h5").settletime, "did you mean 'settle_time'")
    fails(TypeError, lambda: stance.open("grid.h5").basin(levle=0.9), "levle", "did you mean 'level='")
    error = fails(stance.OptionError, lambda: stance.open("grid.h5").basin(of="stabilized"), "of= takes one of stabilised")
    assert isinstance(error, ValueError) and error.code == 2 and error.file is None
    fails(ValueError, lambda: stance.open("grid.h5").share("stabilized"), "stabilised")
    fails(KeyError, lambda: stance.open("grid.h5").plot()["mop"], "map")


def wrong_types_are_told():
    for call in (lambda: stance.scenario(5), lambda: stance.open(None), lambda: own()[5], lambda: own().set({5: 1}),
                 lambda: own().set({"title": object()}), lambda: own().run(ranks="2"), lambda: own().run(output=5),
                 lambda: stance.open("grid.h5").basin(level=object())):
        fails(TypeError, call)
    fails(ValueError, lambda: own().run(ranks=0), "ranks")
    fails(ValueError, lambda: own().set({"stop.time": float("nan")}))


def missing_and_other_files_are_told():
    for call in (lambda: stance.scenario("no.yaml"), lambda: stance.open("no.h5"), lambda: stance.open("grid.h5").compare("no")):
        assert fails(FileNotFoundError, call, r"no").filename
    fails(stance.Error, lambda: stance.open("own.yaml"), "own.yaml is not a results file")
    fails(FileExistsError, lambda: own().run(output="grid.h5"), "force=True", "resume=True")
    assert fails(stance.Error, lambda: own().run(output="nowhere/x.h5"), "nowhere").code == 3


def mistakes_have_line_and_column():
    text = pathlib.Path("own.yaml").read_text(encoding="utf-8").replace("friction:", "fricton:").replace("time: 6", "time: x")
    pathlib.Path("bad ü.yaml").write_text(text, encoding="utf-8")
    error = fails(stance.ScenarioError, stance.scenario("bad ü.yaml").check, "did you mean 'friction'", "stop.time")
    row = next(k for k, line in enumerate(text.splitlines(), 1) if "fricton" in line)
    assert (error.file, error.line, error.code) == ("bad ü.yaml", row, 2) and len(error.message.splitlines()) == 2
    assert text.splitlines()[row - 1][error.column - 1:].startswith("fricton"), error.column
    assert isinstance(error, ValueError) and pickle.loads(pickle.dumps(error)).line == row
    # Of several ranks, and of what was set.
    error = fails(stance.ScenarioError, lambda: stance.scenario("bad ü.yaml").run(ranks=2), "did you mean 'friction'")
    assert error.line == row and "mpirun" not in error.message
    error = fails(stance.ScenarioError, lambda: own(**{"stop.time": -3}).run(ranks=2), "--set stop.time=-3", "out of range")
    assert error.line is None


def a_run_is_stopped_without_progress():
    def interrupt(*_):
        raise KeyboardInterrupt
    before = signal.signal(signal.SIGALRM, interrupt)
    study = own(**{"sweep.grid": [dict(line, count=801) for line in TWO]})
    try:
        signal.setitimer(signal.ITIMER_REAL, 1.5)
        fails(KeyboardInterrupt, lambda: study.run(output="quiet.h5"))
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    if os.path.exists("quiet.h5"):  # it was not as early as that
        status = subprocess.run([stance.program(), "status", "--json", "quiet.h5"], capture_output=True, check=True).stdout
        assert b'"running": false' in status, status


def two_ranks_are_one():
    seen = []
    two = own().run(output="two.h5", ranks=2, progress=lambda done, total: seen.append((done, total)))
    assert two.data.attrs["ranks"] == 2 and two.compare(own().run(output="alone.h5"))["equal"]
    assert seen[-1] == (54, 54)


def results_go_where_the_program_puts_them():
    study = own().run()
    assert study.file == "results/own.h5" and own().run(only=3).file == "results/own-case3.h5"
    assert own().run(shard="1/3").file == "results/own.shard-1-of-3.h5"
    assert (own().run(shard="2/3").status == "pending").sum() == 36


class Enough(Exception):
    """Raised by who is told of progress."""


def stopped_and_resumed(ranks):
    """Ctrl-C in mid-run, and an exception of who is told of it: what has ended is kept, the rest computed later."""
    study, name, last = own(**{"sweep.grid": [dict(line, count=401) for line in TWO]}), f"stopped{ranks}.h5", []

    def interrupt(done, total):
        assert total == 401**2
        if done > 0 and not last:
            last.append(done)
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(1)

    def enough(done, _total):
        if done > last[0] + 100:
            raise Enough

    def pending():
        part = stance.open(name)
        waits = part.status.values == "pending"
        assert numpy.isnan(part.settle_time.values[waits]).all() and numpy.isnan(part.steps.values[waits]).all()
        assert part.summary()["cases"]["pending"] == waits.sum()
        return waits.sum()
    signal.signal(signal.SIGINT, signal.default_int_handler)  # whoever began this may ignore it
    fails(KeyboardInterrupt, lambda: study.run(output=name, ranks=ranks, progress=interrupt))
    first = pending()
    assert 0 < first <= 401**2 - last[0], (first, last)
    last[0] = 401**2 - first
    fails(Enough, lambda: study.run(output=name, ranks=ranks, progress=enough, resume=True))
    assert 0 < pending() < first
    assert study.run(output=name, ranks=ranks, resume=True, time_limit="1s").status.shape == (401, 401)


def one_rank_is_stopped_and_resumed():
    stopped_and_resumed(1)


def two_ranks_are_stopped_and_resumed():
    stopped_and_resumed(2)


def pictures_are_svg():
    study = stance.open("grid.h5")
    for picture in (study.plot(), study.plot()["settle_time"], study.plot("peak_torque"), study.replay(7),
                    own().plot_model(), own().replay(7)):
        root = xml.etree.ElementTree.fromstring(picture._repr_svg_())  # pylint: disable=protected-access
        assert root.tag == "{http://www.w3.org/2000/svg}svg" and picture.names, picture
    study.plot().save("map ü.pdf", for_="column")
    assert pathlib.Path("map ü.pdf").read_bytes().startswith(b"%PDF-")
    own().replay(7).save("own7.gif")
    study.plot().save(pathlib.Path("all"))
    assert len(os.listdir("all")) == 4


def a_page_is_made():
    try:
        page = stance.open("grid.h5").view(output="page.html")
    except stance.Error as error:
        assert "make web" in error.message, error  # built without it
    else:
        assert pathlib.Path("page.html").stat().st_size > 1e5 and "page.html" in str(getattr(page, "src", page))


def warnings_are_pythons():
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        own(**{"sweep.grid[0].count": 5}).check()
    assert len(told) == 1 and "leave out the equilibrium" in str(told[0].message) and told[0].filename == __file__, told


def the_program_is_found():
    asked = os.environ["STANCE"]
    assert os.path.samefile(stance.program(), asked)
    version = subprocess.run([asked, "--version"], capture_output=True, text=True, check=True).stdout.split()[1]
    assert stance.__version__ == version
    try:
        os.environ["STANCE"] = "/nowhere/stance"
        fails(stance.Error, stance.program, "/nowhere/stance", "make install")
        pathlib.Path("old").write_text("#!/bin/sh\necho stance 0.0.1\n", encoding="utf-8")
        os.chmod("old", 0o755)
        os.environ["STANCE"] = "./old"
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            stance.program()
        assert len(told) == 1 and "0.0.1" in str(told[0].message), told
    finally:
        os.environ["STANCE"] = asked


PACKAGE = [a_dataset_has_axes_units_and_words, numbers_are_those_of_other_readers, a_table_is_a_data_frame,
           the_file_is_closed, a_sample_is_along_sample, one_case_is_along_case, a_trajectory_is_recorded_or_made_again,
           a_dict_is_a_scenario, keys_are_read_and_set, wrong_names_are_told, wrong_types_are_told,
           missing_and_other_files_are_told, mistakes_have_line_and_column, two_ranks_are_one,
           results_go_where_the_program_puts_them, one_rank_is_stopped_and_resumed, two_ranks_are_stopped_and_resumed,
           a_run_is_stopped_without_progress,
           pictures_are_svg, a_page_is_made, warnings_are_pythons, the_program_is_found]

if __name__ == "__main__":
    tap({"page": of_page, "notebook": in_notebook}[sys.argv[1]](sys.argv[2]) if sys.argv[2:] else PACKAGE)
