"""Results files: xarray of what is in them, and what the program says of them."""
from __future__ import annotations

import difflib
import functools
import io
import json
import operator
import os
import pathlib
import posixpath
import tempfile
from typing import Any, Callable, Mapping, Optional, Union

import h5py
import numpy
import pandas
import xarray

from . import scenarios
from .errors import Error
from .picture import Picture
from .program import File, call, name_of, options


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
    """A group of the file, in memory, the file closed again. Axes are dimensions, with values, `units`, `long_name`;
    codes are words; what a case does not have is NaN or "none"."""
    def attributes(node: Any) -> dict[str, Any]:
        values = {name: value.item() if getattr(value, "size", 0) == 1 else value for name, value in node.attrs.items()}
        return {name: value.decode() if isinstance(value, bytes) else value for name, value in values.items()}

    def variable(dims: list[str], node: h5py.Dataset) -> tuple[list[str], Any, dict[str, Any]]:
        values = node.asstr()[...] if h5py.check_string_dtype(node.dtype) else node[...]
        shown = {name: text for name, text in attributes(node).items() if name in ("units", "long_name")}
        fill = node.attrs.get("_FillValue")
        if "flag_meanings" in node.attrs:
            words = numpy.array(node.attrs["flag_meanings"].decode().split(), dtype=object)
            values = numpy.asarray(words[numpy.searchsorted(node.attrs["flag_values"], values)], dtype=object)
        elif values.dtype.kind == "i" and fill is not None and (values == fill).any():
            values = numpy.where(values == fill, numpy.nan, values)
        return dims, values, shown

    try:
        h5 = h5py.File(file, "r", locking=False)
    except OSError:
        raise Error(f"{file} is not a results file; stance run makes one", file) from None
    with h5:
        data, coordinates = {}, {}
        for name, node in h5[group].items():
            if isinstance(node, h5py.Dataset) and name != "checksum" and "CLASS" not in node.attrs:
                scales = {posixpath.basename(dimension[0].name): dimension[0] for dimension in node.dims}
                # Paths are axes, what moves along with them, and factors of a sample.
                (coordinates if "." in name else data)[name] = variable(list(scales), node)
                coordinates.update({dim: variable([dim], scale) for dim, scale in scales.items()
                                    if not scale.attrs["NAME"].startswith(b"This is a netCDF dimension but not")})
        dataset = xarray.Dataset(data, coordinates, attributes(h5[group]))
    pending = dataset["status"] == "pending" if "status" in dataset and group == "/" else numpy.False_
    if pending.any():  # their rows mean nothing
        dataset = dataset.map(lambda v: v if v.dtype == object else v.where(~pending), keep_attrs=True)
    return dataset


class File_:
    """A file of the program's. data: an xarray Dataset of all that it holds, read once into memory; file.NAME and
    file["NAME"] are its variables."""

    def __init__(self, file: File):
        self.file = name_of(file)

    @functools.cached_property
    def data(self) -> xarray.Dataset:
        """Everything, over the dimensions that its attribute `axes` names, the last one fastest."""
        return read(self.file)

    @property
    def scenario(self) -> scenarios.Scenario:
        """What it was computed with."""
        return scenarios.Scenario(text=self.data.attrs["scenario"], name=pathlib.Path(self.file).stem)

    def summary(self, **given: Any) -> Any:
        """What came out: a dict, or with frame=True a data frame (`stance summary -h` has keys and columns)."""
        return answer(call, "summary", given, self.file)

    def plot(self, answer: Optional[str] = None, **given: Any) -> Picture:  # pylint: disable=redefined-outer-name
        """The pictures that the file calls for, or that of an answer (`stance plot -h`)."""
        return Picture(lambda *words: call("plot", self.file, *options({"answer": answer, **given}), *words))

    def view(self, **given: Any) -> Any:
        """Makes a page for the browser beside the file (`stance view -h`): a frame in a notebook, else its path."""
        page = call("view", self.file, *options(given)).partition("\n")[0]
        try:
            from IPython.display import IFrame  # pylint: disable=import-outside-toplevel
        except ImportError:
            return page
        return IFrame(os.path.relpath(page), "100%", 700)

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

    def sensitivity(self, **given: Any) -> Any:
        """Which factor of a sampled study decides: as of summary (`stance sensitivity -h`)."""
        return answer(call, "sensitivity", given, self.file)

    def compare(self, other: Union[File, Results], **given: Any) -> Any:
        """What differs from another file: as of summary (`stance compare -h`)."""
        name = name_of(other.file if isinstance(other, Results) else other)
        return answer(call, "compare", given, self.file, name, codes=(0, 1))

    def replay(self, case: Optional[int] = None, **given: Any) -> Picture:
        """One case again, drawn (`stance replay -h`), also near={"theta": 0.02}; save("x.gif") makes a film."""
        return Picture(lambda *words: call("replay", self.file, *options({"case": case, **given}), *words))

    def trajectory(self, case: Optional[int] = None) -> xarray.Dataset:
        """One case until its end, over `time` (s), from the file, or simulated again: position and velocity (time,
        coordinate), torque (time, actuator), force (time, contact, component; N), gap (time, contact; m).
        case: its flat index, which a file of one case has no need of; else IndexError."""
        first = int(self.data["case"][0]) if "case" in self.data else 0
        case = first if case is None else operator.index(case)
        if not first <= case < first + self.status.size:
            raise IndexError(f"the cases of {self.file} are {first} ... {first + self.status.size - 1}")
        with h5py.File(self.file, "r", locking=False) as h5:
            recorded = "trajectory" in h5 and case in h5["trajectory/case"][...]
            texts = [*(h5["history/scenario"].asstr()[...] if "history" in h5 else ()), self.data.attrs["scenario"]]
        number = int(self.scenario_number.values.flat[case]) if len(texts) > 1 else 0
        with tempfile.TemporaryDirectory() as folder:
            file = self.file if recorded else os.path.join(folder, "case.h5")
            if not recorded:
                scenarios.Scenario(text=texts[number]).run(output=file, only=case, trace=True)
            return read(file, "trajectory").sel(case=case).dropna("time", how="all", subset=["position"])


class Search(File_):
    """The file of a search by `stance optimise`: candidates and generations."""

    @property
    def best(self) -> scenarios.Scenario:
        """The scenario with the best candidate, NAME-best.yaml beside the file."""
        stem = os.path.splitext(self.file)[0]
        return scenarios.scenario((stem[:-7] if stem.endswith("-search") else stem) + "-best.yaml")

    @property
    def convergence(self) -> pandas.DataFrame:
        """A row for each generation: stage, starts, candidates until then, step of the distribution, the stage's best
        candidate so far and its objective."""
        frame = self.data[["stage", "starts", "candidates", "step", "best"]].to_dataframe()
        return frame.assign(objective=self.objective.values[frame["best"].astype(int)])
