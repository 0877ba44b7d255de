"""Results files: xarray of what is in them, what the program says of them, and draws."""
from __future__ import annotations

import contextlib
import difflib
import functools
import io
import json
import operator
import os
import pathlib
import tempfile
from typing import Any, Callable, Mapping, Optional, Union

import h5py
import numpy
import pandas
import xarray

from . import scenarios
from .program import Error, File, call, name_of, options


def open(file: File) -> Union[Results, Search]:  # pylint: disable=redefined-builtin
    """What `stance run` or `stance optimise` left in a file."""
    return (Search if "search_version" in File_(file).data.attrs else Results)(file)


def table(text: str) -> pandas.DataFrame:
    """CSV of the program as a data frame: empty is missing, "none" is a word."""
    return pandas.read_csv(io.StringIO(text), keep_default_na=False, na_values=[""])


def answer(caller: Callable[..., str], command: str, given: Mapping[str, Any], *words: str, **how: Any) -> Any:
    """What a command says: of --json, or with frame=True of --csv as a data frame."""
    frame = given.get("frame", False)
    words += ("--csv" if frame else "--json", *options({name: v for name, v in given.items() if name != "frame"}))
    return (table if frame else json.loads)(caller(command, *words, **how))


def read(file: str, group: str = "/") -> xarray.Dataset:
    """A group of the file, in memory: axes are dimensions, codes words, what a case does not have NaN or "none"."""
    def attributes(node: Any) -> dict[str, Any]:
        return {name: value.decode() if isinstance(value, bytes) else value.item() if value.size == 1 else value
                for name, value in node.attrs.items() if node.name == "/" or name in ("units", "long_name")}

    def variable(dims: list[str], node: h5py.Dataset) -> tuple[list[str], Any, dict[str, Any]]:
        values = (node.asstr() if h5py.check_string_dtype(node.dtype) else node)[...]
        if "flag_meanings" in node.attrs:
            words = numpy.array(node.attrs["flag_meanings"].decode().split(), dtype=object)
            values = numpy.asarray(words[numpy.searchsorted(node.attrs["flag_values"], values)], dtype=object)
        elif values.dtype == numpy.int64 and (missing := values == -2**63).any():  # not 0, the _FillValue of old files
            values = numpy.where(missing, numpy.nan, values)
        return dims, values, attributes(node)

    try:
        h5 = h5py.File(file)
    except OSError as error:
        raise Error(f"{file} is not a results file, which stance run makes: {error}", file) from None
    with h5:
        data, coordinates = {}, {}
        for name, node in h5[group].items():
            if isinstance(node, h5py.Dataset) and name != "checksum" and "CLASS" not in node.attrs:
                scales = {dimension[0].name.rpartition("/")[2]: dimension[0] for dimension in node.dims}
                # Paths are axes, what moves along with them, and factors of a sample.
                (coordinates if "." in name else data)[name] = variable(list(scales), node)
                coordinates.update({dim: variable([dim], scale) for dim, scale in scales.items()
                                    if not scale.attrs["NAME"].startswith(b"This is a netCDF dimension but not")})
        dataset = xarray.Dataset(data, coordinates, attributes(h5[group]))
    pending = dataset["status"] == "pending" if "status" in dataset and group == "/" else numpy.False_
    if pending.any():  # their rows mean nothing
        dataset = dataset.map(lambda v: v if v.dtype == object else v.where(~pending), keep_attrs=True)
    return dataset


class Picture:
    """What a command draws, as a notebook shows it: pictures by their names, such as map and settle_time, of which
    picture["map"] is one; svg: text of the first."""

    def __init__(self, draw: Callable[..., str], only: Optional[str] = None):
        """draw(words ...) calls the command with these, too, and returns the names of files that it prints."""
        self._draw = (lambda *words: draw("--picture", only, *words)) if only else draw
        with tempfile.TemporaryDirectory() as folder:
            files = map(pathlib.Path, self._draw("-o", folder, "--format", "svg").splitlines())
            self._svg = {f.stem.rpartition("-")[2]: f.read_text("utf-8") for f in files if f.suffix == ".svg"}
        self.names, self.svg = list(self._svg), next(iter(self._svg.values()))

    def __getitem__(self, name: str) -> Picture:
        if name not in self._svg:
            raise KeyError(f"no picture {name!r}; there are {', '.join(self.names)}")
        return Picture(self._draw, name)

    def save(self, path: File, **style: Any) -> None:
        """Draws it into a file, whose ending says what it is (pdf, svg, png; of a replay gif: a film), or all into a
        folder. style: options of the command, such as for_="column", size="88x60"."""
        self._draw("-o", name_of(path, there=False), *options(style))

    def _repr_svg_(self) -> str:
        return self.svg


class File_:
    """A file of the program's; file.NAME and file["NAME"] are variables of its data."""

    def __init__(self, file: File):
        self.file = name_of(file)

    @functools.cached_property
    def data(self) -> xarray.Dataset:
        """Axes and answers, read once into memory."""
        return read(self.file)

    @property
    def scenario(self) -> scenarios.Scenario:
        """What it was computed with."""
        return scenarios.Scenario(text=self.data.attrs["scenario"], name=pathlib.Path(self.file).stem)

    def summary(self, **given: Any) -> Any:
        """What came out: a dict, or with frame=True a data frame (keys and columns: `stance summary -h`)."""
        return answer(call, "summary", given, self.file)

    def plot(self, answer: Optional[str] = None, **given: Any) -> Picture:  # pylint: disable=redefined-outer-name
        """The pictures that the file calls for, or that of an answer (`stance plot -h`)."""
        return Picture(lambda *words: call("plot", self.file, *options({"answer": answer, **given}), *words))

    def view(self, **given: Any) -> Any:
        """Makes a page for the browser beside the file (`stance view -h`): a frame in a notebook, else its path."""
        page = call("view", self.file, *options(given)).partition("\n")[0]
        with contextlib.suppress(ImportError):
            from IPython.display import IFrame  # pylint: disable=import-outside-toplevel
            return IFrame(os.path.relpath(page), "100%", 700)
        return page

    def __getitem__(self, name: str) -> xarray.DataArray:
        if name not in self.data.variables:
            near = difflib.get_close_matches(str(name), map(str, self.data.variables), 1)
            raise KeyError(f"{self.file} has no {name!r}" + "".join(f"; did you mean {n!r}?" for n in near))
        return self.data[name]

    def __getattr__(self, name: str) -> xarray.DataArray:
        try:
            return self[name] if not name.startswith("_") else {}[name]
        except KeyError as error:
            raise AttributeError(*error.args) from None

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *map(str, self.data.variables)]

    def __repr__(self) -> str:
        return f"<stance {type(self).__name__.lower()} {self.file}: {dict(self.data.sizes)}>"


class Results(File_):
    """A results file: answers over the axes of the sweep, `sample` of sweep.sample, or `case` without a sweep."""

    def share(self, outcome: str = "stabilised") -> float:
        """Of the cases done, of 1, as `stance summary` counts (which has intervals where there are some)."""
        outcomes = self.summary()["outcomes"]
        if outcome not in outcomes:
            raise ValueError(f"an outcome is one of {', '.join(outcomes)}, not {outcome!r}")
        return outcomes[outcome]["share"]

    def table(self, **given: Any) -> pandas.DataFrame:
        """A row for each case: its number, values of the axes, answers (`stance table -h`)."""
        return table(call("table", self.file, *options(given)))

    def basin(self, **given: Any) -> Any:
        """How large the basin is, and how sure that is: as of summary (`stance basin -h`)."""
        return answer(call, "basin", given, self.file)

    def critical(self, **given: Any) -> Any:
        """How far along a number the outcome is kept: as of summary (`stance critical -h`)."""
        return answer(call, "critical", given, self.file)

    def sensitivity(self, **given: Any) -> Any:
        """Which factor of a sampled study decides: as of summary (`stance sensitivity -h`)."""
        return answer(call, "sensitivity", given, self.file)

    def compare(self, other: Union[File, Results], **given: Any) -> Any:
        """What differs from another file: as of summary (`stance compare -h`)."""
        return answer(call, "compare", given, self.file, name_of(getattr(other, "file", other)), codes=(0, 1))

    def replay(self, case: Optional[int] = None, **given: Any) -> Picture:
        """One case again, drawn (`stance replay -h`), also near={"theta": 0.02}; save("x.gif") makes a film."""
        return Picture(lambda *words: call("replay", self.file, *options({"case": case, **given}), *words))

    def trajectory(self, case: Optional[int] = None, **given: Any) -> xarray.Dataset:
        """One case, by its flat index, over `time` (s): position, velocity, torque, force (N) and gap (m)."""
        first = int(self.data["case"][0]) if "case" in self.data else 0
        case = first if case is None else operator.index(case)
        if not first <= case < first + self.status.size:
            raise IndexError(f"the cases of {self.file} are {first} ... {first + self.status.size - 1}")
        with h5py.File(self.file) as h5:
            texts = [*(h5["history/scenario"].asstr()[...] if "history" in h5 else ()), self.data.attrs["scenario"]]
            recorded = "trajectory" in h5 and case in h5["trajectory/case"][...]
        number = int(self.scenario_number.values.flat[case - first]) if len(texts) > 1 else 0
        with tempfile.TemporaryDirectory() as folder:
            file = self.file if recorded else folder + "/case.h5"
            if not recorded:
                scenarios.Scenario(text=texts[number]).run(output=file, only=case, trace=True, **given)
            return read(file, "trajectory").sel(case=case).dropna("time", how="all", subset=["position"])


class Search(File_):
    """The file of a search by `stance optimise`: candidates and generations."""

    @property
    def best(self) -> scenarios.Scenario:
        """The scenario with the best candidate, NAME-best.yaml beside the file."""
        return scenarios.scenario(self.file.removesuffix(".h5").removesuffix("-search") + "-best.yaml")

    @property
    def convergence(self) -> pandas.DataFrame:
        """A row for each generation: the stage's best candidate so far and its objective, step of the distribution."""
        of = self.data[["stage", "starts", "candidates", "step", "best"]].to_dataframe()
        return of.assign(objective=self.objective.values[of["best"].astype(int)])
