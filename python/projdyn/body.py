"""Bodies: arrays of their particles, and changes to these."""
from __future__ import annotations

from ctypes import byref, sizeof
from typing import Any, Callable, Optional

import numpy as np

from ._arrays import address, doubles, number, numbers, rows, view
from ._fixed import Fixed
from ._handles import Handle, listed
from ._library import lib
from ._structs import BodyInfo
from .errors import InputError
from .inlet import Inlet
from .solid import Load, load_by

POINTS = 4  # of a rigid body, which have its mass, behind its vertices


def body_info(handle: Handle, index: int) -> BodyInfo:
    """What the library tells of a body; without a name if there is none."""
    info = BodyInfo()
    lib.pdyn_get_body_sized(handle.pointer, index, byref(info), sizeof(info))
    return info


def end_of_masses(handle: Handle, index: int, particles: int) -> int:
    """End of the masses of a body: those of a rigid one are at four points behind its vertices."""
    after = body_info(handle, index + 1)
    return after.first if after.name else particles


def has_pose(handle: Handle, index: int, particles: int) -> bool:
    """Whether a body of the simulation is rigid: it has points behind its vertices."""
    info = body_info(handle, index)
    return end_of_masses(handle, index, particles) - info.first - info.count == POINTS


class Body(Fixed):
    """A fluid, a sheet, a soft solid or a rigid body of n particles (vertices).

    Arrays are read-only views of the simulation's memory, without copies: they change with every
    step, and stay valid when the simulation is dropped. Take a copy to remember a state.

    name            str
    particles       slice: its rows in arrays of all particles, e.g. of Constraint.forces
    x, v            n x 3, m and m/s
    mass            n, kg; close to 0 at the vertices of a rigid body: see total_mass
    density         n, kg/m^3; the rest density without a fluid constraint
    pressure        n, Pa; 0 without a fluid constraint
    live            n, bool: whether a particle is in the scene, see inlets and outlets
    rest            n x 3, m: positions in the scene, before the first step
    triangles       m x 3, edges: m x 2, tets: m x 4: indices of vertices, from 0; empty where the
                    body has none
    radius          m, of a particle; 0 for a surface
    rest_density    kg/m^3, of a body of particles; 0 for a surface
    inlets          list of Inlet, in the order of the scene
    is_rigid        bool: it is a Rigid (rigid.py)
    """

    is_rigid = False
    _instead = {"set_pose": "set_positions places its particles",
                "set_motion": "set_velocities sets those of its particles",
                "set_wrench": "set_forces sets those on its particles",
                "position": "x has those of its particles",
                "velocity": "v has those of its particles",
                "positions": "x has them", "velocities": "v has them"}

    def __init__(self, handle: Handle, index: int, state: dict) -> None:
        self._handle, self._index = handle, index
        info = self._info()
        n = info.count
        self.name: str = info.name.decode()
        self.particles = slice(info.first, info.first + n)
        self.x: np.ndarray = state["x"][self.particles]
        self.v: np.ndarray = state["v"][self.particles]
        self.mass: np.ndarray = state["mass"][self.particles]
        self.density: np.ndarray = state["density"][self.particles]
        self.pressure: np.ndarray = state["pressure"][self.particles]
        self.live: np.ndarray = state["live"][self.particles]
        self.rest = view(info.rest, (n, 3), handle)
        self.triangles = view(info.triangle, (info.triangles, 3), handle, np.intc)
        self.edges = view(info.edge, (info.edges, 2), handle, np.intc)
        self.tets = view(info.tet, (info.tets, 4), handle, np.intc)
        self._all = state
        end = end_of_masses(handle, index, len(state["mass"]))
        self._total = state["mass"][info.first:end]
        self.radius: float = info.radius
        self.rest_density: float = info.rest_density
        inlets = lib.pdyn_inlets(handle.pointer, index)
        self.inlets = [Inlet(handle, index, k) for k in range(inlets)]
        self._fix()

    def __len__(self) -> int:
        """Number of particles, n."""
        return self.particles.stop - self.particles.start

    def __repr__(self) -> str:
        return f"<body {self.name} of {len(self)} particles>"

    @property
    def total_mass(self) -> float:
        """kg, of the particles in the scene, or of the rigid body."""
        live = self.live if len(self._total) == len(self) else True
        return float(self._total.sum(where=live))

    @property
    def residual(self) -> float:
        """|grad E| over weight (or impact) and load of its particles, at the end of the last step."""
        return self._info().residual

    def load(self, source: Optional[str] = None) -> Load:
        """Force and moment on the body at the end of the last step, of all but gravity and applied
        forces. "fluid" or "contact": the part by this source."""
        return load_by(self._handle, lib.pdyn_body_load_by, self._index, source)

    # ---- between two steps ----------------------------------------------------------------------

    def set_forces(self, forces: Any) -> None:
        """Sets the force on the particles, N, until it is set again. forces: n x 3; three numbers
        for every particle alike; or None: no force."""
        self._call(lib.pdyn_set_forces, None if forces is None else rows(forces, len(self), "forces"))

    def add_forces(self, forces: Any) -> None:
        """Adds to the force on the particles, N, n x 3, or three numbers."""
        self._call(lib.pdyn_add_forces, rows(forces, len(self), "forces"))

    def set_positions(self, positions: Any) -> None:
        """Places the particles, n x 3, m. The body does not pass what lies between."""
        self._call(lib.pdyn_set_positions, doubles(positions, (len(self), 3), "positions"))

    def set_velocities(self, velocities: Any) -> None:
        """Sets the velocities, m/s, n x 3, or three numbers."""
        self._call(lib.pdyn_set_velocities, rows(velocities, len(self), "velocities"))

    def hold(self, vertex: Any, target: Any, stiffness: float = 1e5) -> None:
        """Pulls a vertex to the target, three numbers, m, by a spring of the stiffness, N/m. Held
        again, the target moves. Several vertices: an array of n, targets n x 3."""
        particles = self._particles(vertex)
        shape = (len(particles), 3) if np.ndim(vertex) else (3,)
        points = doubles(target, shape, "target").reshape(-1, 3)
        k = number(stiffness, "stiffness")
        # The farthest target comes first, or one that is not finite: if it is valid, all of them are.
        farthest = [np.argmax(np.abs(points).max(axis=1))] if len(points) else []
        for row in [*farthest, *range(len(points))]:
            self._handle.call(lib.pdyn_hold, particles[row], k, address(points[row]))

    def release(self, vertex: Any) -> None:
        """Ends the hold of a vertex, or of several."""
        for particle in self._particles(vertex):
            self._handle.call(lib.pdyn_release, particle)

    # ---- parts ----------------------------------------------------------------------------------

    def _hint(self, name: str) -> str:
        bodies = listed(BodyInfo, lib.pdyn_get_body_sized, self._handle.pointer)
        rigid = [info.name.decode() for index, info in enumerate(bodies)
                 if has_pose(self._handle, index, len(self._all["mass"]))]
        return f"{self._instead[name]}; rigid bodies have {name}: {', '.join(rigid) or 'none here'}"

    def _info(self) -> BodyInfo:
        return body_info(self._handle, self._index)

    def _call(self, function: Callable[..., int], values: Optional[np.ndarray]) -> None:
        self._handle.call(function, self.particles.start, len(self), address(values))

    def _particles(self, vertex: Any) -> list[int]:
        """The particles of a vertex, or of an array of them."""
        found = numbers(vertex, "vertex")
        if found.ndim > 1:
            raise InputError(f"vertex: expected a whole number, or an array of n, found {found.ndim} dimensions")
        if found.size and (dtype := np.asarray(vertex).dtype).kind == "f":
            raise TypeError(f"vertex: expected a whole number, or an array of them, found {dtype}")
        wrong = found[(found < 0) | (found >= len(self))]
        if len(wrong):
            raise InputError(f"{self.name}: expected a vertex from 0 to {len(self) - 1}, found {wrong[0]:.17g}")
        return [self.particles.start + int(v) for v in found.flat]
