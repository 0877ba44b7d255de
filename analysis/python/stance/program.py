"""The program: where it is, how it is called and stopped, what is wrong as an exception."""
from __future__ import annotations

import contextlib
import functools
import itertools
import json
import operator
import os
import pathlib
import re
import shutil
import signal
import subprocess
import tempfile
import traceback
import warnings
from typing import Any, Callable, Iterable, Mapping, Optional, Union

VERSION = "0.1.0"
File = Union[str, "os.PathLike[str]"]
# What Open MPI wants in a container, as root, on few cores: as the Makefile sets it.
MPI = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "PMIX_MCA_gds": "hash",
       "OMPI_MCA_btl_vader_single_copy_mechanism": "none", "OMPI_MCA_rmaps_base_oversubscribe": "1"}


class Error(Exception):
    """What `stance` did not do. message: why, a line a mistake; file, line, column (from 1): of a scenario's first one;
    code: exit code (2 bad use or scenario, 3 input or output, 4 stopped); None: there is none."""

    def __init__(self, message: str, file: Optional[str] = None, line: Optional[int] = None,
                 column: Optional[int] = None, code: Optional[int] = None):
        super().__init__(message)
        self.message, self.file, self.line, self.column, self.code = message, file, line, column, code

    def __str__(self) -> str:  # a KeyError would quote it
        return self.message


class ScenarioError(Error, ValueError):
    """A mistake in a scenario."""


class PathError(ScenarioError, KeyError):
    """The format has no such path, or this scenario nothing there."""


class OptionError(Error, ValueError):
    """An argument that the program does not take so."""


class ExistsError(Error, FileExistsError):
    """The file is there: force=True replaces it, resume=True goes on with it."""


def of_program(command: str, code: int, said: str) -> Exception:
    """The exception for what a command wrote to standard error when it ended with this code (negative: a signal)."""
    said = re.sub(r"(?ms)^-{20,}\n.*?^-{20,}\n?", "", said)  # mpirun's own, between rulers
    lines = [line for line in dict.fromkeys(re.split(r"[\r\n]+", said))
             if line and not re.match(r"stance: compiling|.*\bwarning: ", line)]
    place = re.search(r"(?m)^(.+?):(\d+):(\d+): ", "\n".join(lines))
    if place or code == 2 and lines and not re.match("stance[: ]", lines[0]):  # FILE: or --set PATH=VALUE:
        where = (place[1], int(place[2]), int(place[3])) if place else (None,) * 3
        return ScenarioError("\n".join(lines), *where, code)
    message = "\n".join(re.sub(r"^stance( \w+)*: ", "", line) for line in lines)
    message = re.sub(r"--(force|resume|trust)\b", r"\1=True", message)  # as it is written in Python
    message = re.sub(r"(?<![\w-])--([a-z][a-z-]*)\b", lambda option: option[1].replace("-", "_") + "=", message)
    if message.startswith("unknown option "):
        return TypeError(f"stance {command}: {message.replace('option', 'argument', 1)}")
    kind = ExistsError if " exists; force=True" in message else OptionError if code == 2 and "stance: the law " not in said else Error
    return kind(message or f"stance {command}: {'signal' if code < 0 else 'exit code'} {abs(code)}", code=code)


def program() -> str:
    """Its file: $STANCE, else bin/stance above the package, else on PATH."""
    asked = os.environ.get("STANCE")
    above = (str(folder / "bin/stance") for folder in pathlib.Path(__file__).resolve().parents)
    found = shutil.which(asked) if asked else next(filter(None, map(shutil.which, above)), shutil.which("stance"))
    if not found:
        what = f"$STANCE names {asked}, which is no program" if asked else "the program `stance` is not on PATH"
        raise Error(what + ": `make install` puts both in one place, or set STANCE to bin/stance")
    same_version(found)
    return found


@functools.lru_cache(None)
def same_version(file: str) -> None:
    """Warns, once, of a program of another version."""
    said = subprocess.run([file, "--version"], capture_output=True, text=True, check=False).stdout.partition("\n")[0]
    if said.split()[:2] != ["stance", VERSION]:
        warnings.warn(f"{file} says it is '{said}', the Python package is of stance {VERSION}", stacklevel=4)


def name_of(file: File, there: bool = True) -> str:
    """A file's name as the program takes it. FileNotFoundError where it should be `there`, TypeError of no name."""
    name = os.fsdecode(file)
    if there and not os.path.exists(name):
        raise FileNotFoundError(2, "No such file", name)
    return os.path.join(".", name) if name.startswith("-") else name


def as_yaml(value: Any) -> str:
    """A value in one line of JSON, which YAML holds. NumPy's numbers and arrays are taken, too."""
    return json.dumps(value, ensure_ascii=False, allow_nan=False,
                      default=lambda v: v.tolist() if hasattr(v, "tolist") else os.fspath(v))


def options(given: Mapping[str, Any]) -> list[str]:
    """Keyword arguments as the program's options: time_limit="55m" is --time-limit 55m, for_="page" --for page; True
    stands alone; a list repeats it, a dict does with NAME=VALUE; (1, 2) is a range, with None for no end."""
    def word(value: Any) -> str:
        if isinstance(value, tuple):
            return "..".join("" if end is None else word(end) for end in value)
        if not isinstance(value := getattr(value, "item", lambda: value)(), (str, int, float, os.PathLike)):
            raise TypeError(f"an option takes text, numbers, ranges, lists or dicts, not {type(value).__name__}")
        return str(value)

    words = []
    for name, value in given.items():
        if isinstance(value, Mapping):
            value = [f"{key}={as_yaml(v) if name == 'set' else word(v)}" for key, v in value.items()]
        several = [word(v) for v in value] if isinstance(value, list) else [word(value)] if value is not None else []
        several = [",".join(several)] if several and name in ("near", "answers", "format") else several
        option = "-o" if name == "output" else "--" + name.rstrip("_").replace("_", "-")
        words += [option] if value is True else [w for v in several for w in (option, v)] if value is not False else []
    return words


def call(command: str, *words: str, ranks: int = 1, codes: Iterable[int] = (0,),
         watch: Optional[Callable[[bool], None]] = None) -> str:
    """What the command prints. Warnings become Python's, an exit code that is not among `codes` an exception; Ctrl-C
    stops it. `watch` is called twice a second, and with True at the end."""
    arguments = [program(), *command.split(), *words]
    if operator.index(ranks) != 1:
        if ranks < 1 or not shutil.which("mpirun"):
            raise OptionError("mpirun is not on PATH: ranks=1 does without" if ranks > 1 else "ranks is 1 at least")
        arguments[:0] = ["mpirun", "-n", str(ranks)]
    # In a session of its own: a terminal's Ctrl-C comes from here alone, and so that mpirun passes it on.
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        with subprocess.Popen(arguments, stdin=subprocess.DEVNULL, stdout=out, stderr=err,
                              env={**MPI, **os.environ}, start_new_session=True) as process:
            try:
                while process.returncode is None:
                    with contextlib.suppress(subprocess.TimeoutExpired):
                        process.wait(0.5 if watch else None)
                    if watch:
                        watch(process.returncode is not None)
            except BaseException:  # a run writes what has ended; a second Ctrl-C, or a minute, is its end
                process.send_signal(signal.SIGINT if ranks == 1 else signal.SIGUSR1)
                try:
                    process.wait(60)
                finally:
                    with contextlib.suppress(ProcessLookupError):
                        os.killpg(process.pid, signal.SIGKILL)
                raise
        printed, said = (file.seek(0) or file.read().decode(errors="replace") for file in (out, err))
    if process.returncode not in codes:
        raise of_program(command, process.returncode, said)
    callers = (frame.f_globals.get("__name__", "").partition(".")[0] for frame, _ in traceback.walk_stack(None))
    level = 2 + sum(1 for _ in itertools.takewhile("stance".__eq__, callers))
    for told in re.findall("warning: (.*)", said):
        warnings.warn(told, stacklevel=level)
    return printed
