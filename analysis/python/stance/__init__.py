"""stance in Python: scenarios as keys and values, results as xarray, pictures in a notebook.

    import stance
    robot = stance.scenario("own.yaml")            # or a dict
    robot["ground.friction"] = 0.5
    study = robot.run(ranks=2)                     # or stance.open("results/own.h5")
    study.outcome, study["initial.offset.body"]    # xarray: words as words, units as attributes
    study.basin(), study.plot()

It computes nothing: it calls the program `stance` and reads its files. Units are the program's, SI and radians.
Keyword arguments that a method does not name are options of its command, time_limit="55m" for --time-limit 55m (see
program.options). Examples: analysis/python.md.
"""
from .errors import Error, ExistsError, OptionError, PathError, ScenarioError
from .picture import Picture
from .program import VERSION as __version__, program
from .results import Results, Search, open  # pylint: disable=redefined-builtin
from .scenarios import Scenario, axis, scenario
