"""Pictures that the program draws."""
from __future__ import annotations

import base64
import pathlib
import tempfile
from typing import Any, Callable, Optional

from .program import File, name_of, options


class Picture:
    """What a command draws, as a notebook shows it: pictures by their names, such as map and settle_time, of which
    picture["map"] is one; svg: text of the first."""

    def __init__(self, draw: Callable[..., str], only: Optional[str] = None):
        """draw(words ...) calls the command with these words, too, and returns the names that it prints."""
        self._draw = (lambda *words: draw("--picture", only, *words)) if only else draw
        with tempfile.TemporaryDirectory() as folder:
            files = map(pathlib.Path, self._draw("-o", folder, "--format", "svg").splitlines())
            self._svg = {file.stem.rpartition("-")[2]: file.read_text("utf-8") for file in files if file.suffix == ".svg"}
        self.names, self.svg = list(self._svg), next(iter(self._svg.values()))

    def __getitem__(self, name: str) -> Picture:
        if name not in self._svg:
            raise KeyError(f"no picture {name!r}; there are {', '.join(self.names)}")
        return Picture(self._draw, name)

    def save(self, path: File, **style: Any) -> str:
        """Draws it into a file, whose ending says what it is (pdf, svg, png; of a replay gif: a film), or all into a
        folder. style: options of the command, such as for_="column", size="88x60". Returns the path."""
        name = name_of(path, there=False)
        self._draw("-o", name, *options(style))
        return name

    def _repr_svg_(self) -> Optional[str]:
        return self.svg if len(self.names) == 1 else None

    def _repr_html_(self) -> Optional[str]:
        """Several, as images: names inside of one must not meet another's."""
        images = [base64.b64encode(svg.encode()).decode() for svg in self._svg.values()]
        return "".join(f'<img src="data:image/svg+xml;base64,{image}"/>' for image in images) if images[1:] else None

    def __repr__(self) -> str:
        return f"<stance picture: {', '.join(self.names)}>"
