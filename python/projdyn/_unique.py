"""Objects that have no copies."""
from __future__ import annotations

from typing import NoReturn


class Unique:
    """Refuses copies and pickles: a copy would be the same object of the library by another name."""

    def __reduce__(self) -> NoReturn:
        raise TypeError("objects of projdyn cannot be copied or pickled: write a scene to a file "
                        "(Scene.write), save a state (Simulation.save), and load them there")
