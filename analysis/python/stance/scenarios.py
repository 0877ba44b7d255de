"""Scenarios: keys and values, and what the program makes of them."""
from __future__ import annotations

import contextlib
import copy
import functools
import json
import operator
import os
import pathlib
import re
import sys
import tempfile
from typing import Any, Callable, Mapping, Optional, Union

from . import results
from .program import Error, File, OptionError, PathError, as_yaml, call, name_of, options

Progress = Union[bool, Callable[[int, int], None]]  # True, or called with numbers of cases, done and all


def scenario(what: Union[File, Mapping[str, Any]], name: str = "scenario") -> Scenario:
    """A file, or a dict with the keys of `stance describe` (`stance: 1` may be left out) whose results go by `name`."""
    if isinstance(what, Mapping):
        return Scenario(text=dump(placed("", json.loads(as_yaml({"stance": 1, **what})))), name=name)
    return Scenario(file=name_of(what))


def axis(path: str, low: float, high: float, count: int, **more: Any) -> dict[str, Any]:
    """A line of sweep.grid: `count` values of the path from `low` to `high`, in its unit."""
    return {"path": path, "from": low, "to": high, "count": count, **more}


class Scenario:
    """A scenario file, or text, and what is set in it: s["ground.friction"] reads, s["ground.friction"] = 0.5 sets as
    --set does; the file stays as it is, errors have its lines and columns. Units are those of `stance describe`."""

    def __init__(self, file: Optional[str] = None, text: str = "", name: str = "scenario"):
        self.file, self._given, self._sets = file, text, {}
        self.name = re.sub(r"\.ya?ml$", "", os.path.basename(file)) if file else name

    def __getitem__(self, path: str) -> Any:
        try:
            return functools.reduce(operator.getitem, steps(path), load(self.text))
        except (LookupError, TypeError):
            if path in self._sets:
                return self._sets[path]
            known(path)
            raise PathError(f"{path} is not in the scenario (stance describe {path} has its default)") from None

    def __setitem__(self, path: str, value: Any) -> None:
        known(path, str(path).startswith("controller.") and "program" in self.text)  # a law in C has keys of its own
        others = {p: v for p, v in self._sets.items() if not (p + ".").replace("[", ".").startswith(path + ".")}
        value = json.loads(as_yaml(value))
        self._sets = {**others, path: value if self.file else placed(path, value)}

    def set(self, values: Mapping[str, Any] = (), **more: Any) -> Scenario:
        """Sets several, {path: value} or title="...", and returns the scenario itself."""
        for path, value in {**dict(values), **more}.items():
            self[path] = value
        return self

    def copy(self) -> Scenario:
        """Another one, to be set otherwise."""
        return copy.copy(self)

    @property
    def text(self) -> str:
        """As YAML: the file's own text, or where something is set one without comments."""
        text = pathlib.Path(self.file).read_text("utf-8") if self.file else self._given
        if not self._sets:
            return text
        tree = load(text)
        for path, value in self._sets.items():
            *above, last = steps(path)
            try:
                node = functools.reduce(lambda n, s: n.setdefault(s, {}) if isinstance(n, dict) else n[s], above, tree)
                node[last] = json.loads(json.dumps(value))
            except (LookupError, TypeError):
                raise PathError(f"{path}: the scenario's text has no such place") from None
        return dump(tree)

    def save(self, path: File) -> Scenario:
        """Writes its text into a file, and returns the scenario of that."""
        pathlib.Path(path).write_text(self.text, encoding="utf-8")
        return scenario(path)

    def _call(self, command: str, *words: str, **how: Any) -> str:
        words += tuple(word for path, value in self._sets.items() for word in ("--set", f"{path}={as_yaml(value)}"))
        if self.file:
            return call(command, name_of(self.file), *words, **how)
        with tempfile.TemporaryDirectory() as folder:
            file, shown = os.path.join(folder, self.name + ".yaml"), f"<{self.name}>"
            pathlib.Path(file).write_text(self._given, encoding="utf-8")
            try:
                return call(command, file, *words, **how)
            except Error as error:
                error.message, error.file = error.message.replace(file, shown), error.file and shown
                raise

    def check(self) -> dict[str, Any]:
        """What it asks for: cases, dimensions, designs, file_bytes, seconds_on_one_rank (`stance check -h`)."""
        return json.loads(self._call("check", "--json"))

    def design(self, **given: Any) -> dict[str, Any]:
        """Equilibrium, A, B, gains, poles, critical sample time (`stance design -h`)."""
        return json.loads(self._call("design", "--json", *options(given)))

    def ranges(self, **given: Any) -> dict[str, Any]:
        """Ranges of starts that show the domain (`stance ranges -h`); "grid" is what sweep.grid takes."""
        found = json.loads(self._call("ranges", "--json", *options(given)))
        kind = "whole" if found["resolved"] else "close"
        return {**found, "grid": [{"paths": line["paths"], **line[kind]} for line in found["axes"]]}

    def gait(self, **given: Any) -> Any:
        """A walker's cycle, with its multipliers; along={path: (from, to)} follows it (`stance gait -h`)."""
        return results.answer(self._call, "gait", given)

    def plot_model(self, **given: Any) -> results.Picture:
        """The robot where the first case begins, with coordinates, actuators, contacts."""
        return results.Picture(lambda *words: self._call("plot --model", *options(given), *words))

    def replay(self, case: int = 0, **given: Any) -> results.Picture:
        """One case, by its flat index, simulated and drawn: as of Results."""
        folder = tempfile.TemporaryDirectory()  # pylint: disable=consider-using-with
        picture = self.run(output=os.path.join(folder.name, self.name + ".h5"), only=case).replay(**given)
        picture.folder = folder  # as long as it may be saved
        return picture

    def run(self, ranks: int = 1, output: Optional[File] = None, progress: Progress = False,
            **given: Any) -> results.Results:
        """Computes every case into results/NAME.h5, or `output`: ExistsError of one that is there, which force=True
        replaces and resume=True goes on with, after a Ctrl-C, too (`stance run -h`). progress: True for a bar, or
        called with the numbers of cases done and of all."""
        return results.Results(self._compute("run", ".h5", ranks, output, progress, given))

    def optimise(self, ranks: int = 1, output: Optional[File] = None, progress: Progress = False,
                 **given: Any) -> results.Search:
        """Searches for a better controller, into results/NAME-search.h5 or `output`, as run (`stance optimise -h`)."""
        return results.Search(self._compute("optimise", "-search.h5", ranks, output, progress, given))

    def _compute(self, command: str, ending: str, ranks: int, output: Optional[File], progress: Progress,
                 given: Mapping[str, Any]) -> str:
        if output is None:  # as the program names it
            parts = [part + str(given[option]).replace("/", "-of-") for option, part in
                     (("only", "-case"), ("extend", "-"), ("shard", ".shard-")) if given.get(option) is not None]
            os.makedirs("results", exist_ok=True)
            output = os.path.join("results", "".join([self.name, *parts, ending]))
        file = name_of(output, there=False)
        old = os.stat(file).st_mtime_ns if given.get("force") and os.path.exists(file) else None
        watch = functools.partial(tell, file, old, bar if progress is True else progress) if progress else None
        codes = (0, 1, 4) if given.get("time_limit") else (0, 1)
        self._call(command, "-o", file, *options(given), ranks=ranks, watch=watch, codes=codes)
        return file

    def __repr__(self) -> str:
        return f"<stance scenario {self.file or self.name} {as_yaml(self._sets)}>"


def placed(path: str, value: Any) -> Any:
    """A value where there is no file: those that a law in C is of are beside the caller."""
    if isinstance(value, dict):
        return {key: placed(f"{path}.{key}" if path else key, one) for key, one in value.items()}
    return os.path.abspath(value) if path in ("controller.file", "controller.data") and str(value) == value else value


def bar(done: int, total: int) -> None:
    print(f"\r{'#' * (40 * done // total):.<40} {done} of {total}", end="", file=sys.stderr, flush=True)


def tell(file: str, old: Optional[int], say: Callable[[int, int], None], ended: bool) -> None:
    """Says what `stance status` knows of a run or a search. old: when a file that is replaced was written last."""
    with contextlib.suppress(Error, FileNotFoundError):  # there is none yet
        now = json.loads(call("status", "--json", file))
        if ended or now["running"] and os.stat(file).st_mtime_ns != old:
            say(*(now[n] for n in (("done", "cases") if "cases" in now else ("generations", "most_generations"))))
        if ended and say is bar:
            print(file=sys.stderr)


def steps(path: str) -> list[Union[str, int]]:  # of sweep.grid[0].count: ["sweep", "grid", 0, "count"]
    return [int(step[1:-1]) if step[0] == "[" else step for step in re.findall(r"\[\d+\]|[^.\[\]]+", path)]


@functools.lru_cache(None)
def known(path: str, other: bool = False) -> None:
    """PathError, which names the nearest, where the format has no such path and there are no `other` ones."""
    try:
        other or call("describe", re.sub(r"(\[\d+\])+$", "", path))
    except OptionError as error:
        raise PathError(error.message, code=error.code) from None


def load(text: str) -> Any:
    """The tree of a scenario's text, of which PyYAML shall take `off` for a word and 1e-4 for a number (YAML 1.2)."""
    with contextlib.suppress(ValueError):
        return json.loads(text)
    import yaml  # pylint: disable=import-outside-toplevel
    loader = type("Loader", (yaml.SafeLoader,), {"yaml_implicit_resolvers": {}})
    for tag, pattern in (("merge", "<<"), ("null", "~|null|"), ("bool", "true|false"), ("int", "[-+]?(0|[1-9][0-9]*)"),
                         ("float", r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")):
        loader.add_implicit_resolver("tag:yaml.org,2002:" + tag, re.compile(f"^(?:{pattern})$"), None)
    return yaml.load(text, loader)


def dump(tree: Any) -> str:  # YAML; without PyYAML JSON, which is YAML, too
    with contextlib.suppress(ImportError):
        import yaml  # pylint: disable=import-outside-toplevel
        return yaml.safe_dump(tree, sort_keys=False, allow_unicode=True, default_flow_style=None, width=110)
    return json.dumps(tree, indent=2, ensure_ascii=False) + "\n"
