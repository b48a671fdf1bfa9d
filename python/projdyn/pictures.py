"""Pictures, films and files for other programs, of the frames of a run: `projdyn render`, `mesh`, `usd`."""
from __future__ import annotations

import base64
import os
import pathlib
from typing import Any, Optional, Union

import numpy as np

from ._json import json_text
from ._paths import Path, path as path_of
from ._program import run_program


class Picture:
    """A picture or a film, which a notebook shows in the output of a cell.

    path: of the file; of numbered pictures the pattern.
    """

    def __init__(self, path: pathlib.Path) -> None:
        self.path = path

    def __repr__(self) -> str:
        return f"<Picture {self.path}>"

    def _repr_png_(self) -> Optional[bytes]:
        return self.path.read_bytes() if self.path.suffix == ".png" and self.path.exists() else None

    def _repr_html_(self) -> Optional[str]:
        kind = self.path.suffix[1:]
        if kind == "png":
            return None
        data = base64.b64encode(self.path.read_bytes()).decode()
        return (f'<img src="data:image/gif;base64,{data}">' if kind == "gif" else
                f'<video src="data:video/{kind};base64,{data}" controls loop muted autoplay></video>')


def _two(values: Any, what: str, between: str) -> str:
    """Two numbers as an option."""
    if isinstance(values, np.ndarray):
        values = values.tolist()
    if not isinstance(values, (tuple, list)) or len(values) != 2:
        raise TypeError(f"{what}: expected two numbers, found {values!r}")
    return between.join(map(str, values))


def _range(frames: Optional[tuple[int, int]]) -> Optional[str]:
    return None if frames is None else _two(frames, "frames", ":")


def _file(path: Path, what: str) -> str:
    return os.fsdecode(path_of(path, what))


def render(directory: Path, file: Path, *, size: tuple[int, int] = (1280, 720),
           time: Optional[float] = None, frame: Optional[int] = None,
           frames: Optional[tuple[int, int]] = None, fps: Optional[float] = None,
           view: Optional[str] = None, camera: Union[None, Path, list[dict[str, Any]]] = None,
           turntable: Optional[float] = None) -> Picture:
    """Draws a picture (.png), all frames as a film (.mp4, .webm, .gif) or as numbered pictures
    ("out_%04d.png") of a run: `projdyn render`. Needs Chromium, and ffmpeg for films.

    size: pixels, even numbers. time: the picture is of the frame nearest to it, s; or frame: its number
    from 0; otherwise that of the view, or the last one. frames: first and last frame of a film. fps:
    pictures a second of a film, otherwise as fast as simulated. view: as "fluid=speed&camera=28,20,1". camera: keys over time,
    as [{"time": 0, "yaw": 0}, {"time": 1, "yaw": 90}], or a file of them. turntable: length of a film
    that goes once around a frame, s. InputError: an option or the directory is not valid.
    """
    keys = (None if camera is None else
            json_text("camera", camera) if isinstance(camera, list) else _file(camera, "camera"))
    run_program("render", directory, output=_file(file, "file"), size=_two(size, "size", "x"), time=time,
                frame=frame, frames=_range(frames), fps=fps, view=view, camera=keys, turntable=turntable)
    return Picture(pathlib.Path(file))


def mesh(directory: Path, *, format: str = "vtk", frames: Optional[tuple[int, int]] = None,
         threads: Optional[int] = None) -> pathlib.Path:
    """Writes triangle meshes of the surface of each fluid, and of bodies with "cell", to the folder
    DIRECTORY/mesh, and returns it: `projdyn mesh`. format: "vtk", "ply" or "obj". frames: first and last.
    threads: one per core without it."""
    run_program("mesh", directory, format=format, frames=_range(frames), threads=threads)
    return pathlib.Path(directory, "mesh")


def usd(directory: Path, file: Optional[Path] = None) -> pathlib.Path:
    """Writes the frames of a run as one file of USD, and returns its path: `projdyn usd`. file: .usda or
    .usd, DIRECTORY/run.usda without it."""
    path = os.path.join(_file(directory, "directory"), "run.usda") if file is None else _file(file, "file")
    run_program("usd", directory, output=path)
    return pathlib.Path(path)
