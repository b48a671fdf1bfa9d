"""Replay of a run in a cell of a notebook."""
from __future__ import annotations

import html
import pathlib

from ._paths import Path
from ._program import run_program


class Replay:
    """The interactive page of a run: a notebook shows it in the output of a cell.

    path: of the HTML file, which opens in any browser.
    """

    def __init__(self, path: pathlib.Path, height: int) -> None:
        self.path, self.height = path, height

    def _repr_html_(self) -> str:
        page = html.escape(self.path.read_text(), quote=True)
        return (f'<iframe srcdoc="{page}" width="100%" height="{self.height}" '
                f'style="border:0" allowfullscreen></iframe>')


def replay(directory: Path, *, height: int = 480) -> Replay:
    """Packs the frames of a run into DIRECTORY/replay.html (`projdyn replay`). height: pixels."""
    run_program("replay", directory)
    return Replay(pathlib.Path(directory, "replay.html"), height)
