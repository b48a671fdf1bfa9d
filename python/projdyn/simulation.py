"""Simulations: steps, state, results."""
from __future__ import annotations

import warnings
from ctypes import byref, c_size_t, create_string_buffer, sizeof
from dataclasses import dataclass
from os import PathLike
from typing import Any, Iterator, Optional, Union

import numpy as np

from ._arrays import address, doubles, number, view
from ._fixed import Fixed, Vector
from ._handles import Handle, listed
from ._library import lib
from ._names import Names
from ._paths import Path, path as path_of
from ._structs import State, StepInfo, WarningInfo
from .body import Body
from .constraint import Constraint
from .errors import InputError, wrong_type
from .probe import Probe, probes_of
from .rigid import Rigid, body_of
from .run import Run
from .solid import Solid
from .writer import Writer


@dataclass(frozen=True)
class Warning:
    """Something legal but surely not meant, or what went wrong in steps
    (docs/guide/troubleshooting.md)."""
    code: str
    subject: str  # name of the body or solid; "" for the whole scene
    text: str
    count: int
    first: float  # s, times of the first and of the last occurrence
    last: float


class Simulation(Fixed):
    """A scene that is simulated. Scene.load and projdyn.load make it.

    x, v, mass      arrays of all particles, as in Body
    bodies          Body by name
    constraints     Constraint by body and type, e.g. ["sheet", "spring"]; of several of one type the
                    second is ["sheet", "pin", 1], the third ["sheet", "pin", 2]
    solids          Solid by name
    """

    _instead = {"reset": "restore(start) goes back to a state that state() or save() gave",
                "positions": "x has those of all particles", "velocities": "v has those of all particles"}

    def __init__(self, handle: Handle) -> None:
        if not isinstance(handle, Handle):
            raise TypeError("a simulation is made by projdyn.load(path) or Scene.load(), not by Simulation()")
        self._handle = handle
        state = State()
        lib.pdyn_get_state_sized(handle.pointer, byref(state), sizeof(state))
        arrays = _arrays(state, handle)
        self.x: np.ndarray = arrays["x"]
        self.v: np.ndarray = arrays["v"]
        self.mass: np.ndarray = arrays["mass"]
        bodies = (body_of(handle, k, arrays) for k in range(state.bodies))
        self.bodies: dict[str, Body] = Names({body.name: body for body in bodies})
        self.constraints = _constraints(handle, state)
        self.solids = _solids(handle)
        self._last = [StepInfo()]  # what the last step gave, for writers
        self._fix()

    def __repr__(self) -> str:
        return f"<simulation at {self.time:.6g} s of {len(self.mass)} particles>"

    # ---- steps ----------------------------------------------------------------------------------

    def step(self, h: Optional[float] = None) -> StepInfo:
        """Computes a step. h: its length, s, which "cfl" does not limit; None: chosen by the
        scene, ends at frames at the latest. StepError: the step failed, and the state is that of
        the step before."""
        if isinstance(h, int) and h > 1:
            warnings.warn(f"step({h}) is one step of {h} s, not {h} steps; sim.run(until=...) makes many, "
                          f"and step({h}.0) does not warn", RuntimeWarning, stacklevel=2)
        info = self._last[0] = StepInfo()
        for body in self.bodies.values():
            if isinstance(body, Rigid):
                body.begin_step()
        if h is None:
            self._handle.call(lib.pdyn_step_sized, byref(info), sizeof(info))
        else:
            self._handle.call(lib.pdyn_step_by_sized, number(h, "h"), byref(info), sizeof(info))
        return info

    def run(self, until: Optional[float] = None) -> Iterator[StepInfo]:
        """An iterator that computes a step and gives its results, up to the time `until`, s, or the
        duration of the scene. The last step may end after it, unless it is the time of a frame.
        InputError: `until` is below 0, or more than a frame interval, the longest step, before the
        time."""
        if until is None and self.is_finished:
            warnings.warn(f"the simulation has reached its duration, {self.duration:g} s: no steps; "
                          "sim.run(until=...) goes on, scene.load() begins anew", RuntimeWarning, stacklevel=2)
        end = self.duration if until is None else number(until, "until")
        if until is not None and not end >= max(0.0, self.time - self.frame_interval):
            raise InputError(f"until: expected a time after the present one, {self.time:.6g} s, "
                             f"found {end:g} s")
        return Run(self.step, lambda: lib.pdyn_has_reached(self._handle.pointer, end))

    @property
    def time(self) -> float:
        """s."""
        return lib.pdyn_time(self._handle.pointer)

    @property
    def duration(self) -> float:
        """s, from the scene."""
        return lib.pdyn_duration(self._handle.pointer)

    @property
    def is_finished(self) -> bool:
        """Whether the time has reached the duration. `time < duration` may take one step too many,
        because the time is a sum of rounded steps."""
        return lib.pdyn_is_finished(self._handle.pointer)

    @property
    def frame_interval(self) -> float:
        """s, between two frames of the output."""
        return lib.pdyn_frame_interval(self._handle.pointer)

    @property
    def solver(self) -> str:
        """Type of the linear solver in use."""
        with self._handle.lock:  # a step of another thread may make the solver anew
            return lib.pdyn_solver_type(self._handle.pointer).decode()

    @property
    def integrator(self) -> str:
        """"bdf2" or "euler"."""
        return lib.pdyn_integrator(self._handle.pointer).decode()

    @property
    def contact_stiffness(self) -> float:
        """N/m: of the scene, or its default; 0 without contact."""
        return lib.pdyn_contact_stiffness(self._handle.pointer)

    # ---- state ----------------------------------------------------------------------------------

    def _get_gravity(self) -> np.ndarray:
        """Acceleration of all bodies, three numbers, m/s^2. Assign three numbers to change it."""
        gravity = np.empty(3)
        with self._handle.lock:
            lib.pdyn_get_gravity(self._handle.pointer, address(gravity))
        gravity.flags.writeable = False
        return gravity

    def _set_gravity(self, gravity: Any) -> None:
        self._handle.call(lib.pdyn_set_gravity, address(doubles(gravity, (3,), "gravity")))

    gravity = Vector(_get_gravity, _set_gravity)

    @property
    def hash(self) -> int:
        """Hash of positions and velocities: equal for equal bits."""
        with self._handle.lock:  # a step of another thread changes the state
            return lib.pdyn_state_hash(self._handle.pointer)

    def save(self, path: Path) -> None:
        """Saves the state to a file."""
        self._handle.call(lib.pdyn_save, path_of(path, "path"))

    def state(self) -> bytes:
        """The state in memory: the bytes of the file that save writes."""
        size = c_size_t()
        with self._handle.lock:  # the size changes with every step
            self._handle.call(lib.pdyn_save_memory, None, 0, byref(size))
            state = create_string_buffer(size.value)
            self._handle.call(lib.pdyn_save_memory, state, size, byref(size))
        return state.raw

    def restore(self, state: Union[bytes, bytearray, memoryview, Path]) -> None:
        """Restores the state of a simulation of the same scene, from bytes or from a file; it goes
        on with the same bits. Until the next step forces, loads and energies are 0; pressures and
        probes have the values of the state."""
        if isinstance(state, (bytes, bytearray, memoryview)):
            state = bytes(state)
            self._handle.call(lib.pdyn_restore_memory, state, len(state))
        elif isinstance(state, (str, PathLike)):
            self._handle.call(lib.pdyn_restore, path_of(state, "state"))
        else:
            raise wrong_type("state", "bytes or a path", state)
        self._end_wrenches()

    # ---- results --------------------------------------------------------------------------------

    @property
    def warnings(self) -> list[Warning]:
        """The warnings so far, those about the scene first."""
        with self._handle.lock:  # a step changes the texts
            return [Warning(info.code.decode(), info.subject.decode(), info.text.decode(),
                            info.count, info.first, info.last)
                    for info in listed(WarningInfo, lib.pdyn_get_warning_sized,
                                       self._handle.pointer)]

    @property
    def probes(self) -> dict[str, Probe]:
        """The probes of the scene by their names."""
        return probes_of(self._handle)

    def contact_forces(self) -> np.ndarray:
        """Forces of contact and friction on all particles, n x 3, N."""
        forces = np.empty_like(self.x)
        self._handle.call(lib.pdyn_contact_forces, address(forces))
        return forces

    def fluid_at(self, points: Any) -> tuple[np.ndarray, np.ndarray]:
        """Pressure, n, Pa, and velocity, n x 3, m/s, of the fluid at points, n x 3, m; 0 where
        there is no fluid."""
        x = doubles(points, (None, 3), "points")
        pressure, velocity = np.empty(len(x)), np.empty((len(x), 3))
        self._handle.call(lib.pdyn_fluid_at, len(x), address(x), address(pressure),
                          address(velocity))
        return pressure, velocity

    def write(self, directory: Path, *, ply: bool = False, resume: bool = False) -> Writer:
        """A writer of frames, metrics.csv and report.json into a directory; see Writer. resume: goes
        on with the run in the directory, of the same scene, from the state that was saved there."""
        writer = Writer(self._handle, directory, ply, resume, self._last)
        if resume:
            self._end_wrenches()
        return writer

    def _end_wrenches(self) -> None:
        """After a restored state, whose forces act alone."""
        for body in self.bodies.values():
            if isinstance(body, Rigid):
                body.end_wrench()


def _arrays(state: State, handle: Handle) -> dict[str, np.ndarray]:
    n = state.particles
    live = view(state.live, (n,), handle, np.bool_) if state.live else np.ones(n, np.bool_)
    live.flags.writeable = False
    return {"x": view(state.x, (n, 3), handle), "v": view(state.v, (n, 3), handle),
            "mass": view(state.mass, (n,), handle), "density": view(state.density, (n,), handle),
            "pressure": view(state.pressure, (n,), handle), "live": live}


def _constraints(handle: Handle, state: State) -> dict[tuple[Any, ...], Constraint]:
    found: dict[tuple[Any, ...], Constraint] = Names()
    for index in range(state.constraints):
        constraint = Constraint(handle, index, state.particles)
        key: tuple[Any, ...] = (constraint.body, constraint.type)
        count = 0
        while key in found:
            count += 1
            key = (constraint.body, constraint.type, count)
        found[key] = constraint
    return found


def _solids(handle: Handle) -> dict[str, Solid]:
    found: dict[str, Solid] = Names()
    while True:
        name = lib.pdyn_solid_name(handle.pointer, len(found))
        if name is None:
            return found
        found[name.decode()] = Solid(handle, len(found), name.decode())
