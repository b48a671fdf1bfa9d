"""Solids: the load on them, and their motion."""
from __future__ import annotations

from typing import Any, Callable, NamedTuple, Optional

import numpy as np

from ._arrays import address, doubles, number
from ._fixed import Fixed
from ._handles import Handle
from ._library import lib
from .errors import InputError


class Load(NamedTuple):
    """Force, N, and moment about the origin of the world, N m, three numbers each."""
    force: np.ndarray
    moment: np.ndarray


class Pose(NamedTuple):
    """Translation, m, and turns, degrees about x, then y, then z through the pivot, three numbers
    each, both from the place in the scene."""
    translate: np.ndarray
    rotate: np.ndarray


def load_by(handle: Handle, function: Callable[..., int], index: int,
            source: Optional[str]) -> Load:
    """The load on a solid or a body by a source; None: by all of them."""
    sources = (None, "fluid", "contact")  # the order of pdyn_load_source
    if source not in sources:
        raise InputError(f'source: expected "fluid", "contact" or None, found {source!r}')
    force, moment = np.empty(3), np.empty(3)
    handle.call(function, index, sources.index(source), address(force), address(moment))
    return Load(force, moment)


class Solid(Fixed):
    """A wall or an obstacle."""

    _instead = {"set_pose": 'move moves it there, with "motion" in the scene',
                "set_motion": 'move moves it, with "motion" in the scene',
                "position": "pose.translate is that from its place in the scene",
                "rotation": "pose.rotate is that from its place in the scene"}

    def __init__(self, handle: Handle, index: int, name: str) -> None:
        self._handle, self._index, self.name = handle, index, name
        self._fix()

    def __repr__(self) -> str:
        return f"<solid {self.name}>"

    def load(self, source: Optional[str] = None) -> Load:
        """The load at the end of the last step: pressure and shear of the fluid, contact and
        friction. "fluid" or "contact": the part by this source."""
        return load_by(self._handle, lib.pdyn_solid_load_by, self._index, source)

    @property
    def pose(self) -> Pose:
        """The pose that its motion gives it at the present time, as move takes it. With contact, a
        surface may hold the solid up before it."""
        pose = Pose(np.empty(3), np.empty(3))
        self._handle.call(lib.pdyn_solid_pose, self._index, address(pose.translate),
                          address(pose.rotate))
        return pose

    @property
    def vertices(self) -> np.ndarray:
        """n x 3, m: the vertices of its mesh at the present time. With contact, a surface may hold
        the solid up before its pose."""
        return self._mesh(lib.pdyn_solid_vertices, np.float64)

    @property
    def triangles(self) -> np.ndarray:
        """m x 3: indices of its vertices, from 0. They face outwards."""
        return self._mesh(lib.pdyn_solid_triangles, np.intc)

    def move(self, time: float, translate: Any = (0, 0, 0), rotate: Any = (0, 0, 0)) -> None:
        """Moves the solid evenly so that at `time`, s, it has this pose, in which it rests.

        translate: m, and rotate: degrees about x, then y, then z through the pivot, both from the
        place of the solid in the scene. It replaces what is left of an earlier motion: moves that
        follow each other are called one after the other, each when the last has ended. InputError:
        the solid has no "motion" in the scene.
        """
        step, turn = doubles(translate, (3,), "translate"), doubles(rotate, (3,), "rotate")
        self._handle.call(lib.pdyn_move_solid, self._index, number(time, "time"),
                          address(step), address(turn))

    # ---- parts ----------------------------------------------------------------------------------

    def _mesh(self, function: Callable[..., int], dtype: Any) -> np.ndarray:
        """A copy of the vertices or triangles."""
        with self._handle.lock:
            rows = np.empty((function(self._handle.pointer, self._index, None), 3), dtype)
            function(self._handle.pointer, self._index, address(rows))
        rows.flags.writeable = False
        return rows
