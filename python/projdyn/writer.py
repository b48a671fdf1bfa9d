"""Output of a simulation: frames, metrics.csv, report.json, as `projdyn run` writes them."""
from __future__ import annotations

import os
import warnings
from ctypes import byref, sizeof
from typing import Any

from ._handles import Handle
from ._library import lib
from ._paths import Path, flag, path as path_of
from ._structs import StepInfo
from ._unique import Unique
from .errors import wrong_type


class Writer(Unique):
    """Writes a run; the directory can be replayed (projdyn.replay), read and rendered:

        with sim.write("out") as writer:
            for info in sim.run():
                writer.step(info)

    The first frame is written at the start; the report and the state, from which the run can go on,
    at the end of the block, after an exception and Ctrl-C, too.
    """

    def __init__(self, handle: Handle, directory: Path, ply: bool, resume: bool,
                 last: list[StepInfo]) -> None:
        path = path_of(directory, "directory")
        ply, resume = flag(ply, "ply"), flag(resume, "resume")
        self.directory = os.fspath(directory)
        writer = (handle.make(lib.pdyn_writer_resume, path) if resume
                  else handle.make(lib.pdyn_writer_open, path, ply))
        self._handle, self._simulation = Handle(writer, lib.pdyn_writer_close, handle), handle
        if not resume:
            self.frame()
        self._start, self._is_used = lib.pdyn_time(handle.pointer), False
        self._last, self._written = last, self._start

    def __repr__(self) -> str:
        return f"<writer of the run in {self.directory}>"

    def step(self, info: StepInfo) -> None:
        """Writes the row of the last step in metrics.csv, and a frame if the step reached one."""
        if not isinstance(info, StepInfo):
            raise wrong_type("info", "the result of a step", info)
        self._is_used = True
        self._written = info.time  # before the call, at whose end Python raises KeyboardInterrupt
        self._handle.call(lib.pdyn_writer_step_sized, byref(info), sizeof(info))
        if info.frame:
            self.frame()

    def frame(self) -> None:
        """Writes a frame, in place of those of its time and later."""
        self._is_used = True
        self._handle.call(lib.pdyn_writer_frame)

    def save(self) -> None:
        """Saves the state, DIRECTORY/state.pdyn, from which write(..., resume=True) goes on."""
        self._handle.call(lib.pdyn_writer_save)

    def close(self, failed: str = "") -> None:
        """Writes the report, saves the state and closes the files; a second call does nothing.
        failed: why the run stopped early."""
        self._end(failed, False)

    def _write_last(self) -> None:
        """Python raises KeyboardInterrupt at the end of a call, mostly of a step: its row is missing."""
        info, time = self._last[0], lib.pdyn_time(self._simulation.pointer)
        if info.time != time:
            return
        if abs(info.time - info.h - self._written) < 1e-6 * info.h:
            self.step(info)
        elif info.frame and self._written == time:
            self.frame()

    def _end(self, failed: str, interrupted: bool) -> None:
        if not self._handle.finalize.alive:
            return
        try:
            if interrupted:
                self._write_last()
            self._handle.call(lib.pdyn_writer_report, None, interrupted, failed.encode() or None)
            self.save()
        finally:
            self._handle.finalize()
        if not (failed or interrupted or self._is_used) and lib.pdyn_time(self._simulation.pointer) > self._start:
            warnings.warn(f"{self.directory}: none of the steps was written: call writer.step(info) after each",
                          RuntimeWarning, stacklevel=3)

    def __enter__(self) -> Writer:
        return self

    def __exit__(self, kind: Any, error: Any, trace: Any) -> None:
        interrupted = isinstance(error, KeyboardInterrupt)
        self._end(repr(error) if error and not interrupted else "", interrupted)
