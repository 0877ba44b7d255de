"""Scenarios: keys and values, and what the program makes of them."""
from __future__ import annotations

import contextlib
import functools
import json
import os
import pathlib
import re
import sys
import tempfile
from typing import Any, Callable, Mapping, Optional, Union

from . import results
from .errors import Error, OptionError, PathError
from .picture import Picture
from .program import File, as_yaml, call, name_of, options

Progress = Union[bool, None, Callable[[int, int], None]]


def scenario(what: Union[File, Mapping[str, Any]], name: str = "scenario") -> Scenario:
    """A scenario: a file, or a dict with the keys of `stance describe` (`stance: 1` may be left out), whose results
    go by `name`."""
    if isinstance(what, Mapping):
        return Scenario(text=dump(json.loads(as_yaml({"stance": 1, **what}))), name=name)
    return Scenario(file=name_of(what))


def axis(path: str, low: float, high: float, count: int, **more: Any) -> dict[str, Any]:
    """A line of sweep.grid: `count` values of the path from `low` to `high`, in its unit."""
    return {"path": path, "from": low, "to": high, "count": count, **more}


class Scenario:
    """A scenario file, or text, and what is set in it.

    s["ground.friction"] reads; s["ground.friction"] = 0.5 sets as --set does: the file stays as it is, errors have its
    lines and columns. Values are numbers, words, lists and dicts, in the units of `stance describe`.
    """

    def __init__(self, file: Optional[str] = None, text: str = "", name: str = "scenario"):
        self.file, self._given, self._sets = file, text, {}
        self.name = re.sub(r"\.ya?ml$", "", os.path.basename(file)) if file else name

    def __getitem__(self, path: str) -> Any:
        node = self._tree()
        try:
            for step in steps(path):
                node = node[step]
        except (LookupError, TypeError):
            known(path)
            raise PathError(f"{path} is not in the scenario (stance describe {path} has its default)") from None
        return node

    def __setitem__(self, path: str, value: Any) -> None:
        known(path)
        self._sets = {p: v for p, v in self._sets.items() if not (p + ".").replace("[", ".").startswith(path + ".")}
        self._sets[path] = json.loads(as_yaml(value))

    def set(self, values: Mapping[str, Any] = (), **more: Any) -> Scenario:
        """Sets several, {path: value} or title="...", and returns the scenario itself."""
        for path, value in {**dict(values), **more}.items():
            self[path] = value
        return self

    def copy(self) -> Scenario:
        """Another one, to be set otherwise."""
        other = Scenario(self.file, self._given, self.name)
        other._sets = dict(self._sets)
        return other

    @property
    def text(self) -> str:
        """As YAML: the file's own text, or where something is set one without comments."""
        return dump(self._tree()) if self._sets else self._text()

    def save(self, path: File) -> Scenario:
        """Writes its text into a file, and returns the scenario of that."""
        pathlib.Path(path).write_text(self.text, encoding="utf-8")
        return scenario(path)

    def _text(self) -> str:
        return pathlib.Path(self.file).read_text(encoding="utf-8") if self.file else self._given

    def _tree(self) -> Any:
        tree = load(self._text())
        for path, value in self._sets.items():
            *above, last = steps(path)
            node = tree
            try:
                for step in above:
                    node = node.setdefault(step, {}) if isinstance(node, dict) else node[step]
                node[last] = json.loads(json.dumps(value))
            except (LookupError, TypeError):
                raise PathError(f"{path}: the scenario's text has no such place") from None
        return tree

    def _call(self, command: str, *words: str, **how: Any) -> str:
        """The command with the file, or the text in one for the while, and with what is set."""
        words += tuple(word for path, value in self._sets.items() for word in ("--set", f"{path}={as_yaml(value)}"))
        if self.file:
            return call(command, name_of(self.file), *words, **how)
        with tempfile.TemporaryDirectory() as folder:
            file, shown = os.path.join(folder, self.name + ".yaml"), f"<{self.name}>"
            pathlib.Path(file).write_text(self._given, encoding="utf-8")
            try:
                return call(command, file, *words, **how)
            except Error as error:
                where = error.file and error.file.replace(file, shown)
                raise type(error)(error.message.replace(file, shown), where, error.line, error.column, error.code) from None

    def check(self) -> dict[str, Any]:
        """What it asks for: cases, dimensions, designs, file_bytes, seconds_on_one_rank (`stance check -h`)."""
        return json.loads(self._call("check", "--json"))

    def design(self, **given: Any) -> dict[str, Any]:
        """Equilibrium, A, B, gains, poles, critical sample time (`stance design -h`)."""
        return json.loads(self._call("design", "--json", *options(given)))

    def ranges(self, **given: Any) -> dict[str, Any]:
        """Ranges of starts that show the domain (`stance ranges -h`); "grid" is what sweep.grid takes."""
        found = json.loads(self._call("ranges", "--json", *options(given)))
        which = "whole" if found["resolved"] else "close"
        return {**found, "grid": [{"paths": line["paths"], **line[which]} for line in found["axes"]]}

    def gait(self, **given: Any) -> Any:
        """A walker's cycle with its multipliers (`stance gait -h`); along={path: (from, to)} follows it, frame=True
        then gives a data frame."""
        return results.answer(self._call, "gait", given)

    def plot_model(self, **given: Any) -> Picture:
        """The robot where the first case begins, with coordinates, actuators, contacts."""
        return Picture(lambda *words: self._call("plot --model", *options(given), *words))

    def replay(self, case: int = 0, **given: Any) -> Picture:
        """One case, by its flat index, simulated and drawn: as of Results."""
        def draw(*words: str) -> str:
            with tempfile.TemporaryDirectory() as folder:
                file = os.path.join(folder, self.name + ".h5")
                return self.run(output=file, only=case).replay(**given)._draw(*words)
        return Picture(draw)

    def run(self, ranks: int = 1, output: Optional[File] = None, progress: Progress = None, force: bool = False,
            resume: bool = False, **given: Any) -> results.Results:
        """Computes every case into results/NAME.h5, or `output`: ExistsError where that is there, which force=True
        replaces and resume=True goes on with. progress: True for a bar, or called with the numbers of cases done and
        of all. Ctrl-C stops it, to be resumed. given: options of `stance run -h`."""
        return results.Results(self._compute("run", ".h5", ranks, output, progress,
                                             {"force": force, "resume": resume, **given}))

    def optimise(self, ranks: int = 1, output: Optional[File] = None, progress: Progress = None, force: bool = False,
                 resume: bool = False, **given: Any) -> results.Search:
        """Searches for a better controller, as its section `optimise` says, into results/NAME-search.h5 or `output`:
        arguments as of run, progress of generations."""
        return results.Search(self._compute("optimise", "-search.h5", ranks, output, progress,
                                            {"force": force, "resume": resume, **given}))

    def _compute(self, command: str, ending: str, ranks: int, output: Optional[File], progress: Progress,
                 given: Mapping[str, Any]) -> str:
        if output is None:  # as the program names it
            if given.get("shard"):
                raise OptionError("a shard wants an output of its own: output=")
            for option, part in ("only", "-case"), ("extend", "-"):
                ending = ending if given.get(option) is None else f"{part}{given[option]}{ending}"
            os.makedirs("results", exist_ok=True)
            output = os.path.join("results", self.name + ending)
        file = name_of(output, there=False)
        watch = functools.partial(tell, file, bar if progress is True else progress) if progress else None
        self._call(command, "-o", file, *options(given), ranks=ranks, watch=watch,
                   codes=(0, 1, 4) if given.get("time_limit") else (0, 1))
        return file

    def __repr__(self) -> str:
        sets = "".join(f", {path}={as_yaml(value)}" for path, value in self._sets.items())
        return f"<stance scenario {self.file or self.name}{sets}>"


def tell(file: str, say: Callable[[int, int], None]) -> None:
    """What `stance status` knows of a run or a search, once there is a file."""
    with contextlib.suppress(Error):
        now = json.loads(call("status", "--json", file))
        done, total = ("done", "cases") if "cases" in now else ("generations", "most_generations")
        if now["running"] or now[done]:
            say(now[done], now[total])


def bar(done: int, total: int) -> None:
    """A line on standard error that is written over."""
    full = 40 * done // max(total, 1)
    print(f"\r{'#' * full}{'.' * (40 - full)} {done} of {total}", end="\n" * (done == total), file=sys.stderr, flush=True)


def steps(path: str) -> list[Union[str, int]]:
    """sweep.grid[0].count as ["sweep", "grid", 0, "count"]."""
    if not isinstance(path, str):
        raise TypeError(f"a path is text such as \"ground.friction\", not {type(path).__name__}")
    return [int(step[1:-1]) if step[0] == "[" else step for step in re.findall(r"\[\d+\]|[^.\[\]]+", path)]


@functools.lru_cache(None)
def known(path: str) -> None:
    """PathError, which names the nearest, where the format has no such path."""
    steps(path)
    try:
        call("describe", re.sub(r"(\[\d+\])+$", "", path))
    except OptionError as error:
        raise PathError(error.message, code=error.code) from None


@functools.lru_cache(None)
def yaml() -> tuple[Any, Any]:
    """PyYAML's reader, taught that `off` is a word and 1e-4 a number as in YAML 1.2, and its writer."""
    try:
        import yaml as library  # pylint: disable=import-outside-toplevel
    except ImportError:
        raise ImportError("a YAML file is run without PyYAML, but not read (Debian: python3-yaml)") from None

    class Loader(library.SafeLoader):  # pylint: disable=too-many-ancestors
        """The core schema, and keys that are merged."""
        yaml_implicit_resolvers: dict[str, Any] = {}
    for tag, pattern, first in (("merge", "<<", "<"), ("null", "~|null|", ["~", "n", ""]), ("bool", "true|false", "tf"),
                                ("int", "[-+]?(0|[1-9][0-9]*)", "-+0123456789"),
                                ("float", r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?", "-+.0123456789")):
        Loader.add_implicit_resolver("tag:yaml.org,2002:" + tag, re.compile(f"^(?:{pattern})$"), list(first))
    return functools.partial(library.load, Loader=Loader), library.safe_dump


def load(text: str) -> Any:
    """The tree of a scenario's text."""
    with contextlib.suppress(ValueError):
        return json.loads(text)
    return yaml()[0](text)


def dump(tree: Any) -> str:
    """A tree as YAML; without PyYAML as JSON, which is YAML, too."""
    with contextlib.suppress(ImportError):
        return yaml()[1](tree, sort_keys=False, allow_unicode=True, default_flow_style=None, width=110)
    return json.dumps(tree, indent=2, ensure_ascii=False) + "\n"
