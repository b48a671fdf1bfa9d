"""Steps of a simulation up to a time."""
from __future__ import annotations

import warnings
from typing import Callable, Iterator

from ._structs import StepInfo


class Run(Iterator[StepInfo]):
    """Each item computes a step. A run that is dropped without a step warns: nothing was done."""

    def __init__(self, step: Callable[[], StepInfo], is_over: Callable[[], bool]) -> None:
        self._step, self._is_over, self._is_used = step, is_over, False

    def __repr__(self) -> str:
        return "<steps of a simulation, computed by a loop: for info in sim.run(): pass>"

    def __next__(self) -> StepInfo:
        self._is_used = True
        if self._is_over():
            raise StopIteration
        return self._step()

    def __del__(self) -> None:
        if not self._is_used:
            warnings.warn("sim.run() computes its steps in a loop, and there was none: write "
                          "`for info in sim.run(): pass`", RuntimeWarning, stacklevel=2)
