"""Pictures of the numbers of a run over time, and of a sweep over a parameter (matplotlib)."""
from __future__ import annotations

import csv
import difflib
import fnmatch
import pathlib
import re
from typing import Any, Iterable, Optional

import numpy as np

from ._paths import Path, path as path_of, text
from .errors import InputError

_UNITS = {"J": "J", "N": "N", "Nm": "N m", "Pa": "Pa", "m_s": "m/s", "m3": "m³", "m": "m", "s": "s"}


def _pyplot() -> Any:
    try:
        from matplotlib import pyplot
    except ImportError:
        raise ImportError("projdyn.plot needs matplotlib: pip install matplotlib") from None
    return pyplot


def _diagrams(count: int) -> Any:
    """A figure, and its diagrams one below the other, which share the horizontal axis."""
    figure, diagrams = _pyplot().subplots(count, sharex=True, squeeze=False, layout="constrained",
                                          figsize=(6.4, max(4.8, 1.6 * count)))  # inches
    return figure, diagrams[:, 0]


def _choose(columns: Iterable[str], known: list[str], where: Path) -> list[str]:
    """The columns by their names, which may be patterns such as "energy_*"."""
    chosen: list[str] = []
    for name in columns:
        found = [name] if text(name, "columns") in known else fnmatch.filter(known, name)
        if not found:
            near = difflib.get_close_matches(name, known, 1)
            hint = f'did you mean "{near[0]}"?' if near else f"known: {', '.join(known)}"
            raise InputError(f'{where}: unknown column "{name}"; {hint}')
        chosen += [key for key in found if key not in chosen]
    return chosen


# ---- runs ---------------------------------------------------------------------------------------


def _read(file: pathlib.Path) -> dict[str, np.ndarray]:
    """The columns of a CSV file of a run by their names; a row that is being written is left out. An
    empty cell stands for a number that is not finite."""
    names, *rows = [row.split(",") for row in file.read_text().rpartition("\n")[0].split("\n")]
    values = [[float(cell or "nan") for cell in row] for row in rows]
    return dict(zip(names, np.reshape(values, (-1, len(names))).T))


def _unit(column: str) -> str:
    end = re.search("_(m_s|[A-Za-z]+3?)$", column)
    return "ms" if column.startswith("ms_") else _UNITS.get(end[1], "") if end else ""


def plot(run: Path, *columns: str, file: Optional[Path] = None) -> Any:
    """Draws columns of metrics.csv and probes.csv of a run over time, one diagram for each unit, and
    returns the figure of matplotlib. Without columns: the energies. A name may be a pattern:
    "energy_*" is the energy of each constraint. file: where to save it, as "energies.png". The run
    may still go on. InputError: there is no such run or column."""
    _pyplot()
    path_of(run, "run")
    tables = [_read(path) for path in (pathlib.Path(run, "metrics.csv"),
                                       pathlib.Path(run, "probes.csv")) if path.exists()]
    if not tables or not len(tables[0].get("time_s", ())):
        raise InputError(f"{run}: expected the directory of a run with metrics.csv and a step in it")
    names = _choose(columns or ("kinetic_J", "potential_J", "constraint_J"),
                    [key for table in tables for key in table], run)
    units = list(dict.fromkeys(map(_unit, names)))
    figure, diagrams = _diagrams(len(units))
    for unit, axes in zip(units, diagrams):
        for name in (name for name in names if _unit(name) == unit):
            table = next(table for table in tables if name in table)
            axes.plot(table["time_s"], table[name], label=name)
        axes.set_ylabel(unit)
        axes.legend()
    diagrams[-1].set_xlabel("time, s")
    if file is not None:
        figure.savefig(file)
    return figure


# ---- sweeps -------------------------------------------------------------------------------------


def _is_number(cell: str) -> bool:
    try:
        return np.isfinite(float(cell))
    except ValueError:
        return False


def _axis(rows: list[dict[str, str]], varied: list[str]) -> tuple[str, list[Any]]:
    """The first varied parameter whose values are numbers, otherwise the first; its values."""
    numeric = [path for path in varied if all(_is_number(row[path]) for row in rows)]
    along = (numeric or varied)[0]
    return along, [float(row[along]) if numeric else row[along] for row in rows]


def plot_sweep(sweep: Path, *columns: str, file: Optional[Path] = None) -> Any:
    """Draws columns of sweep.csv over a swept parameter, the first one that is a number: a diagram
    for each column, and in it a line for each combination of the other parameters. Returns the
    figure of matplotlib. The axis is logarithmic where the values span more than a factor of 20.
    Without columns: processor time and step residual. Names, file: as for plot. Runs that are not
    good are left out. InputError: there is no such sweep or column."""
    _pyplot()
    path_of(sweep, "sweep")
    path = pathlib.Path(sweep, "sweep.csv")
    if not path.exists():
        raise InputError(f"{sweep}: expected the directory of a sweep with sweep.csv")
    with open(path, newline="", encoding="utf-8") as table:
        reader = csv.DictReader(table)
        rows = [row for row in reader if row["status"] == "good"]
    known = list(reader.fieldnames or ())
    names = _choose(columns or ("cpu_s_per_s", "max_step_residual"), known, sweep)
    if not rows:
        raise InputError(f"{path}: expected a run that is good")
    paths = known[:known.index("status")]
    varied = [path for path in paths if len({row[path] for row in rows}) > 1] or paths
    along, places = _axis(rows, varied)
    labels = [", ".join(f"{path}={row[path]}" for path in varied if path != along) for row in rows]
    figure, diagrams = _diagrams(len(names))
    for name, axes in zip(names, diagrams):
        for label in dict.fromkeys(labels):
            line = [k for k in range(len(rows)) if labels[k] == label]
            if isinstance(places[0], float):
                line.sort(key=lambda k: places[k])
            axes.plot([places[k] for k in line], [float(rows[k][name] or "nan") for k in line],
                      marker="o", label=label)
        axes.set_title(name, loc="left", fontsize="medium")
    if any(labels):
        diagrams[0].legend()
    if isinstance(places[0], float) and max(places) > 20 * min(places) > 0:
        axes.set_xscale("log")
    diagrams[-1].set_xlabel(along)
    if file is not None:
        figure.savefig(file)
    return figure
