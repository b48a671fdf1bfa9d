"""Constraints: parameters that can be read and changed, forces and energies."""
from __future__ import annotations

from ctypes import byref, sizeof
from typing import Any, Iterator, NamedTuple

import numpy as np

from ._arrays import address, doubles, numbers, view
from ._fixed import Fixed
from ._handles import Handle, listed
from ._library import lib
from ._paths import flag, text
from ._structs import ConstraintInfo, ParameterInfo, VectorInfo
from .solid import Load


class Parameter(NamedTuple):
    """A number that a simulation uses: given, default or computed."""
    value: float
    unit: str  # "1": dimensionless
    minimum: float
    maximum: float
    changeable: bool
    doc: str


class Constraint(Fixed):
    """A constraint on a body. Its parameters are items:

        spring = sim.constraints["sheet", "spring"]
        spring["stretching_stiffness"] *= 2
    """

    def __init__(self, handle: Handle, index: int, particles: int) -> None:
        self._handle, self._index, self._particles = handle, index, particles
        info = self._info()
        self.type: str = info.type.decode()
        self.body: str = info.body.decode()
        self._fix()

    def __repr__(self) -> str:
        return f"<{self.type} on {self.body}, {self.elements} elements>"

    # ---- parameters -----------------------------------------------------------------------------

    @property
    def parameters(self) -> dict[str, Parameter]:
        """The numbers that the simulation uses, by their names."""
        with self._handle.lock:  # a step of another thread may move the list of constraints
            return {info.name.decode(): Parameter(info.value, info.unit.decode(), info.minimum,
                                                  info.maximum, info.changeable, info.doc.decode())
                    for info in listed(ParameterInfo, lib.pdyn_get_parameter_sized,
                                       self._handle.pointer, self._index)}

    def keys(self) -> list[str]:
        """The names of the parameters; dict(constraint) has their values, too."""
        return list(self._items())

    def __iter__(self) -> Iterator[str]:
        return iter(self.keys())

    def __getitem__(self, name: str) -> Any:
        """A parameter: a number; an array of three for a vector; n x 4 for the keys of a path; the
        rows of a table, rows x width, or an array of n for rows of one number."""
        values = self._items()
        if name not in values:
            raise KeyError(f"{name}: {self!r} has {', '.join(values)}")
        return values[name]

    def __setitem__(self, name: str, value: Any) -> None:
        """Changes a parameter from the next step on: a number; three numbers for a vector; n x 4
        for the keys of a path (time and three numbers); the rows of a table, or one row for all."""
        found = numbers(value, text(name, "name"))
        if found.ndim > 1 and name in (widths := self._widths()):  # refuses a transposed array
            doubles(found, (None, widths[name]), name)
        flat = np.ravel(found)
        self._handle.call(lib.pdyn_set_parameter, self._index, name.encode(), address(flat), len(flat))

    @property
    def enabled(self) -> bool:
        """Whether the constraint acts; it can be switched off and on."""
        with self._handle.lock:
            return lib.pdyn_is_enabled(self._handle.pointer, self._index)

    @enabled.setter
    def enabled(self, enabled: bool) -> None:
        self._handle.call(lib.pdyn_enable, self._index, flag(enabled, "enabled"))

    # ---- results at the end of the last step ----------------------------------------------------

    @property
    def elements(self) -> int:
        """Number of elements; of some types, as viscosity, another one after each step."""
        return self._info().elements

    @property
    def energy(self) -> float:
        """J."""
        return self._info().energy

    def forces(self) -> np.ndarray:
        """Forces on all particles of the simulation, n x 3, N; Body.particles selects a body."""
        forces = np.empty((self._particles, 3))
        self._handle.call(lib.pdyn_constraint_forces, self._index, address(forces))
        return forces

    def load(self) -> Load:
        """Sum of the forces, N, and moment about the origin, N m: of pins, what holds the body."""
        force, moment = np.empty(3), np.empty(3)
        self._handle.call(lib.pdyn_constraint_load, self._index, address(force), address(moment))
        return Load(force, moment)

    def energies(self) -> np.ndarray:
        """Energy of each element, J."""
        return self._values()[0]

    def distances(self) -> np.ndarray:
        """Distance |G x - p| of each element: of a spring the change of its length, m; of a
        triangle or tetrahedron the norm of its strain."""
        return self._values()[1]

    def _items(self) -> dict[str, Any]:
        """All parameters by their names."""
        return {**{name: parameter.value for name, parameter in self.parameters.items()},
                **self._vectors()}

    def _vectors(self) -> dict[str, np.ndarray]:
        """Copies of the vectors, paths and tables, by their names."""
        with self._handle.lock:  # the memory of a value ends when another thread sets it
            return {info.name.decode(): _rows(np.array(view(info.value, (info.count,), self._handle)),
                                              info.width)
                    for info in self._infos()}

    def _widths(self) -> dict[str, int]:
        """Numbers in each row of the paths, and of the tables whose rows have several."""
        with self._handle.lock:
            return {info.name.decode(): info.width or 4 for info in self._infos()
                    if info.width > 1 or (info.width == 0 and info.count != 3)}

    def _infos(self) -> Iterator[VectorInfo]:
        """The vectors, paths and tables, under the lock."""
        return listed(VectorInfo, lib.pdyn_get_vector_sized, self._handle.pointer, self._index)

    # ---- parts ----------------------------------------------------------------------------------

    def _info(self) -> ConstraintInfo:
        info = ConstraintInfo()
        with self._handle.lock:
            lib.pdyn_get_constraint_sized(self._handle.pointer, self._index, byref(info), sizeof(info))
        return info

    def _values(self) -> tuple[np.ndarray, np.ndarray]:
        with self._handle.lock:  # the number of elements may change with every step
            elements = self.elements
            energy, distance = np.empty(elements), np.empty(elements)
            self._handle.call(lib.pdyn_element_values, self._index, address(energy), address(distance))
        return energy, distance


def _rows(values: np.ndarray, width: int) -> np.ndarray:
    """The numbers of a vector or of a path (width 0), or of a table with rows of this width."""
    if width == 1 or (width == 0 and len(values) == 3):
        return values
    return values.reshape(-1, width or 4)
