"""Pictures of the numbers of a run over time (matplotlib)."""
from __future__ import annotations

import difflib
import pathlib
import re
from typing import Any, Optional

import numpy as np

from ._paths import Path
from .errors import InputError

_UNITS = {"J": "J", "N": "N", "Nm": "N m", "Pa": "Pa", "m_s": "m/s", "m3": "m³", "m": "m", "s": "s"}


def _read(file: pathlib.Path) -> dict[str, np.ndarray]:
    """The columns of a CSV file of a run by their names; a row that is being written is left out."""
    names, *rows = [row.split(",") for row in file.read_text().rpartition("\n")[0].split("\n")]
    return dict(zip(names, np.array(rows, float).reshape(-1, len(names)).T))


def _unit(column: str) -> str:
    end = re.search("_(m_s|[A-Za-z]+3?)$", column)
    return "ms" if column.startswith("ms_") else _UNITS.get(end[1], "") if end else ""


def plot(run: Path, *columns: str, file: Optional[Path] = None) -> Any:
    """Draws columns of metrics.csv and probes.csv of a run over time, one diagram for each unit, and
    returns the figure of matplotlib. Without columns: the energies. file: where to save it, as
    "energies.png". The run may still go on. InputError: there is no such run or column."""
    try:
        from matplotlib import pyplot
    except ImportError:
        raise ImportError("projdyn.plot needs matplotlib: pip install matplotlib") from None
    tables = [_read(path) for path in (pathlib.Path(run, "metrics.csv"),
                                       pathlib.Path(run, "probes.csv")) if path.exists()]
    if not tables or not len(tables[0].get("time_s", ())):
        raise InputError(f"{run}: expected the directory of a run with metrics.csv and a step in it")
    names = list(columns) or ["kinetic_J", "potential_J", "constraint_J"]
    for name in names:
        if not any(name in table for table in tables):
            known = [key for table in tables for key in table]
            near = difflib.get_close_matches(name, known, 1)
            hint = f'did you mean "{near[0]}"?' if near else f"known: {', '.join(known)}"
            raise InputError(f'{run}: unknown column "{name}"; {hint}')
    units = list(dict.fromkeys(map(_unit, names)))
    figure, diagrams = pyplot.subplots(len(units), sharex=True, squeeze=False,
                                       layout="constrained")
    for unit, axes in zip(units, diagrams[:, 0]):
        for name in (name for name in names if _unit(name) == unit):
            table = next(table for table in tables if name in table)
            axes.plot(table["time_s"], table[name], label=name)
        axes.set_ylabel(unit)
        axes.legend()
    diagrams[-1, 0].set_xlabel("time, s")
    if file is not None:
        figure.savefig(file)
    return figure
