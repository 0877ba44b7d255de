"""The program: where it is, how it is called and stopped."""
from __future__ import annotations

import contextlib
import functools
import json
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import warnings
from typing import Any, Callable, Iterable, Mapping, Optional, Union

from .errors import Error, OptionError, of_program

VERSION = "0.1.0"
File = Union[str, "os.PathLike[str]"]
# What Open MPI wants in a container, as root, on few cores: as the Makefile sets it.
MPI = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "PMIX_MCA_gds": "hash",
       "OMPI_MCA_btl_vader_single_copy_mechanism": "none", "OMPI_MCA_rmaps_base_oversubscribe": "1"}


def program() -> str:
    """The program's file: $STANCE, else bin/stance in a folder above the package (where `make install` put both, or
    in a checkout), else the first on PATH."""
    asked = os.environ.get("STANCE")
    above = (str(folder / "bin/stance") for folder in pathlib.Path(__file__).resolve().parents)
    found = shutil.which(asked) if asked else next(filter(None, map(shutil.which, above)), shutil.which("stance"))
    if not found:
        what = f"$STANCE names {asked}, which is no program" if asked else "the program `stance` is not on PATH"
        raise Error(what + ": `make install` puts it and this package in one place, or set STANCE to bin/stance")
    same_version(found)
    return found


@functools.lru_cache(None)
def same_version(file: str) -> None:
    """Warns, once, of a program of another version."""
    said = subprocess.run([file, "--version"], capture_output=True, text=True, check=False).stdout.partition("\n")[0]
    if said.split()[:2] != ["stance", VERSION]:
        warnings.warn(f"{file} says it is '{said}', the Python package is of stance {VERSION}", stacklevel=4)


def name_of(file: File, there: bool = True) -> str:
    """A file's name as the program takes it. FileNotFoundError where it has to be `there`, TypeError of no name."""
    name = os.fsdecode(file)
    if there and not os.path.exists(name):
        raise FileNotFoundError(2, "No such file", name)
    return os.path.join(".", name) if name.startswith("-") else name


def as_yaml(value: Any) -> str:
    """A value in one line of JSON, which YAML holds. NumPy's numbers and arrays are taken, too."""
    def plain(other: Any) -> Any:
        if hasattr(other, "tolist"):
            return other.tolist()
        raise TypeError(f"a scenario holds numbers, words, lists and dicts, not {type(other).__name__}")
    return json.dumps(value, default=plain, ensure_ascii=False, allow_nan=False)


def options(given: Mapping[str, Any]) -> list[str]:
    """Keyword arguments as the program's options: time_limit="55m" is --time-limit 55m, for_="page" --for page; what
    is True stands alone; a list repeats the option, a dict does with NAME=VALUE; (1, 2) is a range, with None for no
    end."""
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
        if name in ("near", "answers", "format"):  # those that take all in one
            several = [",".join(several)] if several else []
        option = "--" + name.rstrip("_").replace("_", "-")
        words += [option] if value is True else [w for v in several for w in (option, v)] if value is not False else []
    return words


def call(command: str, *words: str, ranks: int = 1, codes: Iterable[int] = (0,),
         watch: Optional[Callable[[], None]] = None) -> str:
    """What the command prints. Its warnings become Python's; an exit code that is not among `codes` an exception.
    `watch` is called twice a second meanwhile. Ctrl-C (KeyboardInterrupt) stops it as it stops a run."""
    arguments, environment = [program(), *command.split(), *words], None
    if not isinstance(ranks, int):
        raise TypeError(f"ranks is a whole number, not {type(ranks).__name__}")
    if ranks != 1:
        mpirun = shutil.which("mpirun")
        if not mpirun or ranks < 1:
            raise OptionError("mpirun is not on PATH: ranks=1 does without" if ranks > 1 else "ranks is 1 at least")
        arguments, environment = [mpirun, "-n", str(ranks), *arguments], {**MPI, **os.environ}
    # In a session of its own: a terminal's Ctrl-C comes from here alone, and so that mpirun passes it on.
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        with subprocess.Popen(arguments, stdin=subprocess.DEVNULL, stdout=out, stderr=err, env=environment,
                              start_new_session=True) as process:
            try:
                while process.returncode is None:
                    with contextlib.suppress(subprocess.TimeoutExpired):
                        process.wait(0.5 if watch else None)
                    if watch:
                        watch()
            except BaseException:
                stop(process, signal.SIGINT if ranks == 1 else signal.SIGUSR1)
                raise
        printed, said = (file.seek(0) or file.read().decode(errors="replace") for file in (out, err))
    if process.returncode not in codes:
        raise of_program(command, process.returncode, said)
    for line in said.splitlines():
        if "warning: " in line:
            warnings.warn(line.partition("warning: ")[2], stacklevel=3)
    return printed


def stop(process: subprocess.Popen, by: int) -> None:
    """Waits for what a signal stops: a run writes what has ended. A second Ctrl-C, or a minute, kills it."""
    process.send_signal(by)
    try:
        process.wait(60)
    except (KeyboardInterrupt, subprocess.TimeoutExpired):
        os.killpg(process.pid, signal.SIGKILL)
