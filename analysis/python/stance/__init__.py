"""stance in Python: scenarios as keys and values, results as xarray, pictures in a notebook.

    study = stance.scenario("own.yaml").set({"ground.friction": 0.5}).run(ranks=2)
    study.outcome, study["initial.offset.body"], study.basin(), study.plot()

It computes nothing: it calls the program and reads its files, in SI and radians. Keyword arguments that a method does
not name are options of its command: time_limit="55m" is --time-limit 55m. Examples: analysis/python.md.
"""
from .program import VERSION as __version__, Error, ExistsError, OptionError, PathError, ScenarioError, program
from .results import Picture, Results, Search, open  # pylint: disable=redefined-builtin
from .scenarios import Scenario, axis, scenario
