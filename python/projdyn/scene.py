"""Scenes: the values of a scene file and the arrays that stand for its mesh files."""
from __future__ import annotations

import difflib
import hashlib
import json
import reprlib
from ctypes import c_char_p
from typing import Any, Callable, Iterator, NamedTuple, Optional, Sequence, Union

import numpy as np

from ._arrays import address, doubles, indices
from ._handles import Handle, new_context
from ._json import json_text
from ._library import lib
from ._paths import Path, path as path_of, text
from ._structs import Write
from ._unique import Unique
from .errors import InputError, wrong_type
from .simulation import Simulation

Box = Union[dict[str, Any], Sequence[Any]]  # {"minimum": ..., "maximum": ...} or the two corners
Constraints = Union[dict[str, Any], Sequence[dict[str, Any]]]


class Scene(Unique):
    """A scene that can be changed and loaded, again and again.

    Keys of the scene file are given by keyword or set as items; docs/guide/scene.md lists them:

        scene = Scene(duration=2, solver={"tolerance": 0.05}, contact={"thickness": 0.004})
        scene["time_step.maximum"] = 0.002
        scene["bodies.sheet.constraints.spring.stretching_stiffness"] = 500

    A path has dots between keys; an element of an array has its name, its type or its index. A path
    into a body, solid or probe that the scene does not have is an error.
    """

    def __init__(self, name: str = "scene", *, duration: float = 1.0, threads: int = 0,
                 allow_plugins: bool = False, **keys: Any) -> None:
        """An empty scene.

        duration: s, the end of Simulation.run. threads: of its simulations; 0: one per core.
        allow_plugins: load plug-ins, which are code, that the scene names.
        """
        if text(name, "name").endswith(".json"):
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

    def __setattr__(self, name: str, value: Any) -> None:
        """An attribute would change nothing in the scene."""
        if name != "_handle":
            raise AttributeError(f'{name}: keys of a scene are items: scene["{name}"] = ...')
        object.__setattr__(self, name, value)

    # ---- values ---------------------------------------------------------------------------------

    def __repr__(self) -> str:
        values = self.to_dict()
        bodies, solids = (", ".join(_element_names(values, key)) for key in ("bodies", "solids"))
        return f"<scene {values.get('name', '')}: {bodies}{solids and '; solids ' + solids}>"

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
        """Sets a value; None removes it. What is missing on the way is made, except a body, solid
        or probe. Checks are made by load."""
        keys = _keys(path)
        if len(keys) > 2:
            self._check_element(path, keys[0], keys[1])
        self._set(path, json_text(path, value))

    def __getitem__(self, path: str) -> Any:
        """A copy of a value. KeyError: it was not given."""
        value: Any = self.to_dict()
        for key in _keys(path):
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
        """Writes the scene to a file, and its arrays to files beside it. Their names contain a hash
        of the arrays. Relative paths of other files are not changed: they count from the new folder."""
        self._handle.call(lib.pdyn_scene_write, path_of(path, "path"))

    # ---- bodies and solids ----------------------------------------------------------------------

    def add_cloth(self, vertices: Any = None, triangles: Any = None, *, area_density: float,
                  name: Optional[str] = None, velocity: Any = None, color: Optional[str] = None,
                  grid: Any = None, mesh: Optional[Path] = None, scale: Any = None,
                  rotate: Any = None, translate: Any = None, fluid_friction: Optional[float] = None,
                  permeability: Optional[float] = None, **constraints: Constraints) -> str:
        """Adds a sheet and returns its name.

        vertices: n x 3, m, and triangles: m x 3, indices from 0; or grid={"size": ..,
        "vertices": ..}; or mesh, the path of a file. area_density: kg/m^2. velocity: m/s, at the
        start. color: in pictures, as "#3070c0". constraints: a dictionary of parameters by type, or a
        list of these, for example spring={"stretching_stiffness": 500}, pin=[{...}, {...}].
        """
        name = self._name(name, "bodies", "body")
        arrays, mesh = _shape(_mesh, name, vertices, triangles, mesh)
        surface = _given(grid=grid, mesh=mesh, scale=scale, rotate=rotate, translate=translate,
                         area_density=area_density, fluid_friction=fluid_friction,
                         permeability=permeability)
        return self._add_body(name, "surface", surface, _given(velocity=velocity, color=color),
                              constraints, arrays)

    def add_soft(self, vertices: Any = None, tets: Any = None, *, density: float,
                 name: Optional[str] = None, velocity: Any = None, color: Optional[str] = None,
                 grid: Any = None, triangles: Any = None, mesh: Optional[Path] = None, cell: Optional[float] = None,
                 scale: Any = None, rotate: Any = None, translate: Any = None, fluid_friction: Optional[float] = None,
                 **constraints: Constraints) -> str:
        """Adds a soft solid and returns its name.

        vertices: n x 3, m, and tets: m x 4, indices from 0; or grid={"size": .., "cells": ..}; or
        mesh, the path of a file of tetrahedra. With cell, their size, m: vertices and triangles,
        m x 3, or the file are a closed mesh, which is filled. density: kg/m^3. Otherwise as
        add_cloth.
        """
        name = self._name(name, "bodies", "body")
        if tets is not None and triangles is not None:
            raise InputError("triangles: expected tets or triangles, found both")
        make, elements = (_tets, tets) if triangles is None else (_mesh, triangles)
        arrays, mesh = _shape(make, name, vertices, elements, mesh)
        volume = _given(grid=grid, mesh=mesh, cell=cell, scale=scale, rotate=rotate, translate=translate,
                        density=density, fluid_friction=fluid_friction)
        return self._add_body(name, "volume", volume, _given(velocity=velocity, color=color),
                              constraints, arrays)

    def add_rigid(self, vertices: Any = None, triangles: Any = None, *,
                  density: Optional[float] = None, mass: Optional[float] = None,
                  name: Optional[str] = None, velocity: Any = None, color: Optional[str] = None,
                  angular_velocity: Any = None, center_of_mass: Any = None,
                  box: Optional[Box] = None, sphere: Any = None, capsule: Any = None,
                  mesh: Optional[Path] = None, cell: Optional[float] = None, scale: Any = None,
                  rotate: Any = None, translate: Any = None,
                  fluid_friction: Optional[float] = None, **constraints: Constraints) -> str:
        """Adds a rigid body and returns its name.

        vertices: n x 3, m, and triangles: m x 3, indices from 0, counter-clockwise as seen from
        outside; or box: (minimum, maximum), m; or sphere, capsule as in a scene file; or mesh, the
        path of a file; cell, m, as in a scene file. Either density, kg/m^3, or mass, kg.
        velocity: m/s, and angular_velocity: rad/s, at the start. center_of_mass: m, of a body with
        ballast. Otherwise as add_cloth.
        """
        name = self._name(name, "bodies", "body")
        arrays, mesh = _shape(_mesh, name, vertices, triangles, mesh)
        rigid = _given(box=None if box is None else _box(box), sphere=sphere, capsule=capsule,
                       mesh=mesh, cell=cell, scale=scale, rotate=rotate, translate=translate,
                       density=density, mass=mass, center_of_mass=center_of_mass,
                       angular_velocity=angular_velocity, fluid_friction=fluid_friction)
        return self._add_body(name, "rigid", rigid, _given(velocity=velocity, color=color),
                              constraints, arrays)

    def add_fluid(self, positions: Any = None, *, radius: float, velocities: Any = None,
                  box: Optional[Box] = None, vertices: Any = None, triangles: Any = None,
                  mesh: Optional[Path] = None, fill: Sequence[dict[str, Any]] = (),
                  name: Optional[str] = None, velocity: Any = None, color: Optional[str] = None,
                  rest_density: Optional[float] = None, inlets: Any = None,
                  budget: Optional[int] = None, overlap: Optional[str] = None,
                  **constraints: Constraints) -> str:
        """Adds a body of particles and returns its name.

        positions: n x 3, m, of particles, with velocities: n x 3, m/s, or at rest; and a box to
        fill: (minimum, maximum), m; and a closed mesh to fill: vertices: n x 3, m, and triangles:
        m x 3, indices from 0, or mesh, the path of a file; and further entries of fill as in a
        scene file. radius: m, of a particle; a particle has the mass of a cube of two radii.
        constraints: as add_cloth, for example fluid={"compression": 0.001}.
        """
        name = self._name(name, "bodies", "body")
        if not isinstance(fill, (list, tuple)):
            raise wrong_type("fill", "a list of dictionaries", fill)
        if positions is None and velocities is not None:
            raise InputError("velocities: expected them with positions; velocity is that of all particles")
        arrays = None if positions is None else _particles(name, positions, velocities)
        volume, mesh = _shape(_mesh, name, vertices, triangles, mesh)
        fill = [*fill, *([{"file": arrays.file}] if arrays else []),
                *([{"box": _box(box)}] if box is not None else []),
                *([{"mesh": mesh}] if mesh is not None else [])]
        particles = _given(radius=radius, rest_density=rest_density, fill=fill or None,
                           inlets=inlets, budget=budget, overlap=overlap)
        return self._add_body(name, "particles", particles, _given(velocity=velocity, color=color),
                              constraints, arrays, volume)

    def add_solid(self, vertices: Any = None, triangles: Any = None, *,
                  name: Optional[str] = None, box: Optional[Box] = None,
                  mesh: Optional[Path] = None, **keys: Any) -> str:
        """Adds a wall or obstacle and returns its name.

        vertices: n x 3, m, and triangles: m x 3, indices from 0; or box: (minimum, maximum), m; or
        mesh, the path of a file; or sphere, capsule, plane as in a scene file. Further keys of a
        scene file: open, scale, rotate, translate, motion, pivot.
        """
        name = self._name(name, "solids", "solid")
        arrays, mesh = _shape(_mesh, name, vertices, triangles, mesh)
        self._append("solids", _given(name=name, box=None if box is None else _box(box), mesh=mesh,
                                      **keys), arrays)
        return name

    # ---- simulation -----------------------------------------------------------------------------

    def load(self) -> Simulation:
        """Makes a simulation. InputError: the scene is not valid; the text says where."""
        if not isinstance(self, Scene):  # Scene.load("a.json")
            raise TypeError("Scene.load() is a method of a scene: projdyn.load(path) loads a file")
        sim = self._handle.make(lib.pdyn_scene_load)
        return Simulation(Handle(sim, lib.pdyn_free, self._handle.parent))

    # ---- parts ----------------------------------------------------------------------------------

    def _set(self, path: str, value: str) -> None:
        self._handle.call(lib.pdyn_scene_set, path.encode(), b"%s", value.encode())

    def _check_element(self, path: str, key: str, name: str) -> None:
        """InputError: the path leads into a body, solid or probe of a name that nothing has."""
        if key not in dict(_NAMED) or name.isdigit() or f"{key}.{name}" in self:
            return
        known = _element_names(self.to_dict(), key)
        nearest = difflib.get_close_matches(name, known, 1)
        raise InputError(f'{path}: {key} has no element "{name}"'
                         + (f'; did you mean "{nearest[0]}"?' if nearest else "")
                         + f"; known: {', '.join(known) or 'none'}")

    def _add_body(self, name: str, form: str, shape: dict[str, Any], others: dict[str, Any],
                  constraints: dict[str, Constraints], *arrays: Optional[_Arrays]) -> str:
        parts = [{"type": kind, **part} for kind, given in constraints.items()
                 for part in _parts(kind, given)]
        self._append("bodies", _given(name=name, **others, **{form: shape}, constraints=parts), *arrays)
        return name

    def _append(self, key: str, entry: dict[str, Any], *arrays: Optional[_Arrays]) -> None:
        """Adds an element and its arrays, or nothing if one of them is not valid."""
        path = f"{key}.{len(self.to_dict().get(key, []))}"
        value = json_text(path, entry)
        for given in filter(None, arrays):
            self._handle.call(given.function, given.file.encode(), *given.arguments)
        self._set(path, value)

    def _name(self, name: Optional[str], key: str, word: str) -> str:
        """The name of a new element: the given one, which nothing else may have, or a free one."""
        values = self.to_dict()
        taken = {known for list_, _ in _NAMED for known in _element_names(values, list_)}
        if name:
            if text(name, "name") in taken:
                raise InputError(f'name: "{name}" is already taken by another body, solid or probe')
            return name
        k = len(values.get(key, []))  # the library gives this name to a new last element
        while f"{word}{k}" in taken:
            k += 1
        return f"{word}{k}"


_NAMED = (("bodies", "body"), ("solids", "solid"), ("probes", "probe"))


class _Arrays(NamedTuple):
    """Arrays that stand for a file of the scene, and the function of the library that takes them."""
    file: str
    function: Callable[..., int]
    arguments: tuple[Any, ...]
    kept: tuple[Any, ...]  # the arrays of the addresses among the arguments


def _file(name: str, ending: str, *arrays: Optional[np.ndarray]) -> str:
    """A name that other arrays and the files of the user do not have: write puts the arrays of
    several scenes into one folder."""
    digest = hashlib.blake2b(digest_size=6)
    for array in arrays:
        digest.update(b"" if array is None else array.tobytes())
    return f"{name}-{digest.hexdigest()}.{ending}"


def _mesh(name: str, vertices: Any, triangles: Any) -> _Arrays:
    x, t = doubles(vertices, (None, 3), "vertices"), indices(triangles, (None, 3), "triangles")
    return _Arrays(_file(name, "ply", x, t), lib.pdyn_scene_mesh,
                   (len(x), address(x), len(t), address(t)), (x, t))


def _shape(make: Callable[[str, Any, Any], _Arrays], name: str, vertices: Any, elements: Any,
           mesh: Optional[Path]) -> tuple[Optional[_Arrays], Optional[Path]]:
    """The arrays of a mesh, if there are any, and its file."""
    if vertices is None and elements is None:
        return None, mesh
    if mesh is not None:
        raise InputError("mesh: expected a file or vertices, found both")
    arrays = make(name, vertices, elements)
    return arrays, arrays.file


def _tets(name: str, vertices: Any, tets: Any) -> _Arrays:
    x, t = doubles(vertices, (None, 3), "vertices"), indices(tets, (None, 4), "tets")
    return _Arrays(_file(name, "msh", x, t), lib.pdyn_scene_tets,
                   (len(x), address(x), len(t), address(t)), (x, t))


def _particles(name: str, positions: Any, velocities: Any) -> _Arrays:
    x = doubles(positions, (None, 3), "positions")
    v = None if velocities is None else doubles(velocities, x.shape, "velocities")
    return _Arrays(_file(name, "ply", x, v), lib.pdyn_scene_particles,
                   (len(x), address(x), address(v)), (x, v))


def load(path: Path, overrides: Optional[dict[str, Any]] = None, *, threads: int = 0,
         allow_plugins: bool = False) -> Simulation:
    """Loads a scene file. overrides: values by their path, e.g. {"solver.type": "cholesky"}."""
    if not isinstance(overrides, (dict, type(None))):
        raise wrong_type("overrides", "a dictionary", overrides)
    file, context = path_of(path, "path"), new_context(threads, allow_plugins)
    texts = [f"{text(key, 'overrides: a key')}={json_text(key, value)}".encode()
             for key, value in (overrides or {}).items()]
    sim = context.make(lib.pdyn_load, file, (c_char_p * len(texts))(*texts),
                       len(texts))
    return Simulation(Handle(sim, lib.pdyn_free, context))


def _new(make: Callable[..., int], name: Path, threads: int, allow_plugins: bool) -> Handle:
    """A scene in a context of its own."""
    file, context = path_of(name, "path"), new_context(threads, allow_plugins)
    return Handle(context.make(make, file), lib.pdyn_scene_free, context)


def _keys(path: str) -> list[str]:
    """The keys of a path."""
    return text(path, "path").replace("[", ".").replace("]", "").split(".")


def _element_names(values: dict[str, Any], key: str) -> list[str]:
    """The names of the bodies, solids or probes of a scene."""
    word = dict(_NAMED)[key]
    return [entry.get("name", f"{word}{k}") for k, entry in enumerate(values.get(key, []))]


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
                         f"list of these, found {reprlib.repr(given)}; a keyword that the method does not "
                         "have is the name of a constraint")
    return parts


def _element(elements: Sequence[Any], key: str) -> Any:
    """Element of an array of a scene by its name, its type or its index."""
    for index, element in enumerate(elements):
        named = isinstance(element, dict) and key in (element.get("name"), element.get("type"))
        if named or key == str(index):
            return element
    raise KeyError(key)
