"""Scenes: the values of a scene file and the arrays that stand for its mesh files."""
from __future__ import annotations

import json
import os
from ctypes import c_char_p
from typing import Any, Callable, Iterator, Optional, Sequence, Union

import numpy as np

from ._arrays import address, doubles, indices
from ._handles import Handle, new_context
from ._library import lib
from ._paths import Path
from ._structs import Write
from .errors import InputError
from .simulation import Simulation

Box = Union[dict[str, Any], Sequence[Any]]  # {"minimum": ..., "maximum": ...} or the two corners
Constraints = Union[dict[str, Any], Sequence[dict[str, Any]]]


class Scene:
    """A scene that can be changed and loaded, again and again.

    Keys of the scene file are given by keyword or set as items; docs/guide/scene.md lists them:

        scene = Scene(duration=2, solver={"tolerance": 0.05}, contact={"thickness": 0.004})
        scene["time_step.maximum"] = 0.002
        scene["bodies.sheet.constraints.spring.stretching_stiffness"] = 500

    A path has dots between keys; an element of an array has its name, its type or its index.
    """

    def __init__(self, name: str = "scene", *, duration: float = 1.0, threads: int = 0,
                 allow_plugins: bool = False, **keys: Any) -> None:
        """An empty scene.

        duration: s, the end of Simulation.run. threads: of its simulations; 0: one per core.
        allow_plugins: load plug-ins, which are code, that the scene names.
        """
        if name.endswith(".json"):
            raise InputError(f"{name}: Scene.open reads a file; Scene makes an empty scene of this name")
        self._handle = _new(lib.pdyn_scene_create, name, threads, allow_plugins)
        values = {"name": name, "duration": duration, "bodies": [], **keys}
        for key, value in _given(**values).items():
            self[key] = value

    @classmethod
    def open(cls, path: Path, *, threads: int = 0, allow_plugins: bool = False) -> Scene:
        """The scene of a file."""
        scene = cls.__new__(cls)
        scene._handle = _new(lib.pdyn_scene_open, path, threads, allow_plugins)
        return scene

    # ---- values ---------------------------------------------------------------------------------

    def __repr__(self) -> str:
        values = self.to_dict()
        return f"<scene {values.get('name', '')}: {_names(values, 'bodies', 'body')}" \
            f"{_names(values, 'solids', 'solid', '; solids ')}>"

    def __iter__(self) -> Iterator[str]:
        """The keys of the scene."""
        return iter(self.to_dict())

    def __contains__(self, path: object) -> bool:
        """Whether a value was given."""
        try:
            self[str(path)]
        except KeyError:
            return False
        return True

    def __delitem__(self, path: str) -> None:
        """Removes a value, an element of an array too. KeyError: it was not given."""
        self[path]
        self[path] = None

    def __setitem__(self, path: str, value: Any) -> None:
        """Sets a value; None removes it. What is missing on the way is made. Checks are made by
        load."""
        self._handle.call(lib.pdyn_scene_set, path.encode(), b"%s", _json(path, value).encode())

    def __getitem__(self, path: str) -> Any:
        """A copy of a value. KeyError: it was not given."""
        value: Any = self.to_dict()
        for key in path.replace("[", ".").replace("]", "").split("."):
            try:
                value = value[key] if isinstance(value, dict) else _element(value, key)
            except (KeyError, IndexError, TypeError, ValueError):
                raise KeyError(f"{path}: no {key}") from None
        return value

    def to_text(self) -> str:
        """The scene as the JSON text of a file. Arrays are left out: see write."""
        pieces = []
        self._handle.call(lib.pdyn_scene_text, Write(lambda _, text: pieces.append(text)), None)
        return b"".join(pieces).decode()

    def to_dict(self) -> dict[str, Any]:
        """A copy of the scene as a dictionary."""
        return json.loads(self.to_text())

    def write(self, path: Path) -> None:
        """Writes the scene to a file, and its arrays to files beside it."""
        self._handle.call(lib.pdyn_scene_write, os.fsencode(path))

    # ---- bodies and solids ----------------------------------------------------------------------

    def add_cloth(self, vertices: Any = None, triangles: Any = None, *, area_density: float,
                  name: Optional[str] = None, velocity: Any = None, grid: Any = None,
                  mesh: Optional[Path] = None, scale: Any = None, rotate: Any = None,
                  translate: Any = None, fluid_friction: Optional[float] = None,
                  permeability: Optional[float] = None, **constraints: Constraints) -> str:
        """Adds a sheet and returns its name.

        vertices: n x 3, m, and triangles: m x 3, indices from 0; or grid={"size": ..,
        "vertices": ..}; or mesh, the path of a file. area_density: kg/m^2. velocity: m/s, at the
        start. constraints: a dictionary of parameters by type, or a list of these, for example
        spring={"stretching_stiffness": 500}, pin=[{...}, {...}].
        """
        name = name or self._free_name("bodies", "body")
        if vertices is not None:
            mesh = self._mesh(name, vertices, triangles)
        surface = _given(grid=grid, mesh=mesh, scale=scale, rotate=rotate, translate=translate,
                         area_density=area_density, fluid_friction=fluid_friction,
                         permeability=permeability)
        return self._add_body(name, "surface", surface, velocity, constraints)

    def add_soft(self, vertices: Any = None, tets: Any = None, *, density: float,
                 name: Optional[str] = None, velocity: Any = None, grid: Any = None,
                 triangles: Any = None, mesh: Optional[Path] = None, cell: Optional[float] = None,
                 scale: Any = None, rotate: Any = None, translate: Any = None, fluid_friction: Optional[float] = None,
                 **constraints: Constraints) -> str:
        """Adds a soft solid and returns its name.

        vertices: n x 3, m, and tets: m x 4, indices from 0; or grid={"size": .., "cells": ..}; or
        mesh, the path of a file of tetrahedra. With cell, their size, m: vertices and triangles,
        m x 3, or the file are a closed mesh, which is filled. density: kg/m^3. Otherwise as
        add_cloth.
        """
        name = name or self._free_name("bodies", "body")
        if triangles is not None:
            mesh = self._mesh(name, vertices, triangles)
        elif vertices is not None:
            mesh = f"{name}.msh"
            x, t = doubles(vertices, (None, 3), "vertices"), indices(tets, (None, 4), "tets")
            self._handle.call(lib.pdyn_scene_tets, mesh.encode(), len(x), address(x), len(t),
                              address(t))
        volume = _given(grid=grid, mesh=mesh, cell=cell, scale=scale, rotate=rotate, translate=translate,
                        density=density, fluid_friction=fluid_friction)
        return self._add_body(name, "volume", volume, velocity, constraints)

    def add_rigid(self, vertices: Any = None, triangles: Any = None, *,
                  density: Optional[float] = None, mass: Optional[float] = None,
                  name: Optional[str] = None, velocity: Any = None, angular_velocity: Any = None,
                  box: Optional[Box] = None, sphere: Any = None, capsule: Any = None,
                  mesh: Optional[Path] = None, cell: Optional[float] = None, scale: Any = None,
                  rotate: Any = None, translate: Any = None,
                  fluid_friction: Optional[float] = None, **constraints: Constraints) -> str:
        """Adds a rigid body and returns its name.

        vertices: n x 3, m, and triangles: m x 3, indices from 0, counter-clockwise as seen from
        outside; or box: (minimum, maximum), m; or sphere, capsule as in a scene file; or mesh, the
        path of a file; cell, m, as in a scene file. Either density, kg/m^3, or mass, kg. velocity: m/s, and angular_velocity:
        rad/s, at the start. Otherwise as add_cloth.
        """
        name = name or self._free_name("bodies", "body")
        if vertices is not None:
            mesh = self._mesh(name, vertices, triangles)
        rigid = _given(box=None if box is None else _box(box), sphere=sphere, capsule=capsule,
                       mesh=mesh, cell=cell, scale=scale, rotate=rotate, translate=translate,
                       density=density, mass=mass, angular_velocity=angular_velocity, fluid_friction=fluid_friction)
        return self._add_body(name, "rigid", rigid, velocity, constraints)

    def add_fluid(self, positions: Any = None, *, radius: float, velocities: Any = None,
                  box: Optional[Box] = None, fill: Sequence[dict[str, Any]] = (),
                  name: Optional[str] = None, velocity: Any = None,
                  rest_density: Optional[float] = None, inlets: Any = None,
                  budget: Optional[int] = None, overlap: Optional[str] = None,
                  **constraints: Constraints) -> str:
        """Adds a body of particles and returns its name.

        positions: n x 3, m, of particles, with velocities: n x 3, m/s, or at rest; and a box to
        fill: (minimum, maximum), m; and further entries of fill as in a scene file. radius: m, of
        a particle; a particle has the mass of a cube of two radii. constraints: as add_cloth, for
        example fluid={"compression": 0.001}.
        """
        name = name or self._free_name("bodies", "body")
        fill = list(fill)
        if positions is not None:
            fill.append({"file": self._particles(name, positions, velocities)})
        if box is not None:
            fill.append({"box": _box(box)})
        particles = _given(radius=radius, rest_density=rest_density, fill=fill or None,
                           inlets=inlets, budget=budget, overlap=overlap)
        return self._add_body(name, "particles", particles, velocity, constraints)

    def add_solid(self, vertices: Any = None, triangles: Any = None, *,
                  name: Optional[str] = None, box: Optional[Box] = None,
                  mesh: Optional[Path] = None, **keys: Any) -> str:
        """Adds a wall or obstacle and returns its name.

        vertices: n x 3, m, and triangles: m x 3, indices from 0; or box: (minimum, maximum), m; or
        mesh, the path of a file; or sphere, capsule, plane as in a scene file. Further keys of a
        scene file: open, scale, rotate, translate, motion, pivot.
        """
        name = name or self._free_name("solids", "solid")
        if vertices is not None:
            mesh = self._mesh(name, vertices, triangles)
        self._append("solids", _given(name=name, box=None if box is None else _box(box), mesh=mesh,
                                      **keys))
        return name

    # ---- simulation -----------------------------------------------------------------------------

    def load(self) -> Simulation:
        """Makes a simulation. InputError: the scene is not valid; the text says where."""
        sim = self._handle.make(lib.pdyn_scene_load)
        return Simulation(Handle(sim, lib.pdyn_free, self._handle.parent))

    # ---- parts ----------------------------------------------------------------------------------

    def _mesh(self, name: str, vertices: Any, triangles: Any) -> str:
        x, t = doubles(vertices, (None, 3), "vertices"), indices(triangles, (None, 3), "triangles")
        file = f"{name}.ply"
        self._handle.call(lib.pdyn_scene_mesh, file.encode(), len(x), address(x), len(t),
                          address(t))
        return file

    def _particles(self, name: str, positions: Any, velocities: Any) -> str:
        x = doubles(positions, (None, 3), "positions")
        v = None if velocities is None else doubles(velocities, x.shape, "velocities")
        file = f"{name}.ply"
        self._handle.call(lib.pdyn_scene_particles, file.encode(), len(x), address(x), address(v))
        return file

    def _add_body(self, name: str, form: str, shape: dict[str, Any], velocity: Any,
                  constraints: dict[str, Constraints]) -> str:
        parts = [{"type": kind, **part} for kind, given in constraints.items()
                 for part in _parts(kind, given)]
        self._append("bodies", _given(name=name, velocity=velocity, **{form: shape},
                                      constraints=parts))
        return name

    def _append(self, key: str, entry: dict[str, Any]) -> None:
        self[f"{key}.{len(self.to_dict().get(key, []))}"] = entry

    def _free_name(self, key: str, word: str) -> str:
        """The name that the library gives to a new last element, or the next one that is free."""
        entries = self.to_dict().get(key, [])
        taken = {entry.get("name", f"{word}{k}") for k, entry in enumerate(entries)}
        k = len(entries)
        while f"{word}{k}" in taken:
            k += 1
        return f"{word}{k}"


def load(path: Path, overrides: Optional[dict[str, Any]] = None, *, threads: int = 0,
         allow_plugins: bool = False) -> Simulation:
    """Loads a scene file. overrides: values by their path, e.g. {"solver.type": "cholesky"}."""
    context = new_context(threads, allow_plugins)
    texts = [f"{key}={_json(key, value)}".encode() for key, value in (overrides or {}).items()]
    sim = context.make(lib.pdyn_load, os.fsencode(path), (c_char_p * len(texts))(*texts),
                       len(texts))
    return Simulation(Handle(sim, lib.pdyn_free, context))


def _new(make: Callable[..., int], name: Path, threads: int, allow_plugins: bool) -> Handle:
    """A scene in a context of its own."""
    context = new_context(threads, allow_plugins)
    return Handle(context.make(make, os.fsencode(name)), lib.pdyn_scene_free, context)


def _json(path: str, value: Any) -> str:
    """A value as JSON text; path: of the value, for messages."""
    try:
        return json.dumps(value, default=_plain, allow_nan=False)
    except (TypeError, ValueError) as error:
        raise InputError(f"{path}: {error}") from None


def _plain(value: Any) -> Any:
    """Paths and numpy's arrays and numbers as JSON has them."""
    return os.fspath(value) if isinstance(value, os.PathLike) else np.asarray(value).tolist()


def _names(values: dict[str, Any], key: str, word: str, before: str = "") -> str:
    """The names of the bodies or the solids of a scene."""
    names = [entry.get("name", f"{word}{k}") for k, entry in enumerate(values.get(key, []))]
    return before + ", ".join(names) if names else ""


def _given(**keys: Any) -> dict[str, Any]:
    return {key: value for key, value in keys.items() if value is not None}


def _box(box: Box) -> dict[str, Any]:
    if isinstance(box, dict):
        return box
    minimum, maximum = doubles(box, (2, 3), "box")
    return {"minimum": minimum, "maximum": maximum}


def _parts(kind: str, given: Constraints) -> Sequence[dict[str, Any]]:
    parts = [given] if isinstance(given, dict) else given
    if not isinstance(parts, (list, tuple)) or not all(isinstance(part, dict) for part in parts):
        raise InputError(f"{kind}: expected the parameters of a constraint as a dictionary, or a "
                         f"list of these, found {given!r}")
    return parts


def _element(elements: Sequence[Any], key: str) -> Any:
    """Element of an array of a scene by its name, its type or its index."""
    for index, element in enumerate(elements):
        named = isinstance(element, dict) and key in (element.get("name"), element.get("type"))
        if named or key == str(index):
            return element
    raise KeyError(key)
