"""Probes of a scene: named numbers at the end of every step."""
from __future__ import annotations

import numpy as np

from ._arrays import view
from ._fixed import Fixed
from ._handles import Handle, listed
from ._library import lib
from ._names import Names
from ._structs import ProbeInfo


class Probe(Fixed):
    """A probe of the scene ("probes" in docs/guide/scene.md).

    name      str
    columns   its columns in probes.csv, NAME.QUANTITY_UNIT
    values    one number per column at the end of the last step; a read-only view
    """

    def __init__(self, handle: Handle, info: ProbeInfo) -> None:
        self.name: str = info.name.decode()
        self.columns: tuple[str, ...] = tuple(info.column[k].decode() for k in range(info.values))
        self.values: np.ndarray = view(info.value, (info.values,), handle)
        self._fix()

    def __getitem__(self, column: str) -> float:
        """The value of a column, by its name or by the part after the dot."""
        names = {name: k for k, full in enumerate(self.columns)
                 for name in (full, full.partition(".")[2])}
        if column not in names:
            raise KeyError(f"{column}: the probe has {', '.join(self.columns)}")
        return float(self.values[names[column]])

    def __repr__(self) -> str:
        return f"<probe {self.name}: {', '.join(self.columns)}>"


def probes_of(handle: Handle) -> dict[str, Probe]:
    """The probes of a simulation by their names."""
    return Names({info.name.decode(): Probe(handle, info)
                  for info in listed(ProbeInfo, lib.pdyn_get_probe_sized, handle.pointer)})
