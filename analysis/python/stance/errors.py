"""What the program says when something is wrong, as exceptions."""
from __future__ import annotations

import re
from typing import Optional


class Error(Exception):
    """What `stance` did not do, and why. (A file that is missing is Python's FileNotFoundError.)

    message: the program's, a line for each mistake; file, line, column (from 1): of the first one in a scenario, else
    None; code: the program's exit code (2 bad use or scenario, 3 input or output, 4 stopped), None where it did not run.
    """

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
    if place or code == 2 and any(line.startswith("--set ") for line in lines):
        where = (place[1], int(place[2]), int(place[3])) if place else (None,) * 3
        return ScenarioError("\n".join(lines), *where, code)
    message = "\n".join(re.sub(r"^stance( \w+)*: ", "", line) for line in lines)
    # As it is written in Python.
    message = re.sub(r"--(force|resume)\b", r"\1=True", message)
    message = re.sub(r"(?<![\w-])--([a-z][a-z-]*)\b", lambda option: option[1].replace("-", "_") + "=", message)
    if message.startswith("unknown option "):
        return TypeError(f"stance {command}: {message.replace('option', 'argument', 1)}")
    kind = ExistsError if " exists; force=True" in message else OptionError if code == 2 else Error
    return kind(message or f"stance {command}: {'signal' if code < 0 else 'exit code'} {abs(code)}", code=code)
