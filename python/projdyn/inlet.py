"""Inlets of a body: their motion and speed."""
from __future__ import annotations

from typing import Any, Optional

from ._arrays import address, doubles, number
from ._fixed import Fixed
from ._handles import Handle
from ._library import lib


class Inlet(Fixed):
    """Where particles stream into the scene."""

    def __init__(self, handle: Handle, body: int, index: int) -> None:
        self._handle, self._body, self._index = handle, body, index
        self._fix()

    def __repr__(self) -> str:
        return f"<inlet {self._index}>"

    def move(self, time: float, translate: Any = (0, 0, 0), rotate: Any = (0, 0, 0)) -> None:
        """Moves the inlet evenly so that at `time`, s, it has this pose, in which it rests.

        translate: m, and rotate: degrees about x, then y, then z through the pivot, both from its
        place in the scene. InputError: the inlet has no "motion" in the scene.
        """
        step, turn = doubles(translate, (3,), "translate"), doubles(rotate, (3,), "rotate")
        self._handle.call(lib.pdyn_move_inlet, self._body, self._index, number(time, "time"),
                          address(step), address(turn))

    def set_speed(self, speed: float, time: Optional[float] = None) -> None:
        """Changes the speed of the stream evenly, so that it is `speed`, m/s, at `time`, s; at once
        without a time. 0 shuts the inlet. InputError: the "duration" of the inlet has ended."""
        self._handle.call(lib.pdyn_set_inlet_speed, self._body, self._index,
                          number(0.0 if time is None else time, "time"), number(speed, "speed"))
