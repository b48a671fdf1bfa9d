"""The structs of the library, as in its headers. A test compares both.

A struct of an older or a newer library is shorter or longer: functions get the size that is declared
here, and members that the library does not know are 0.
"""
from __future__ import annotations

from ctypes import (CFUNCTYPE, POINTER, Structure, c_bool, c_char_p, c_double, c_int, c_long,
                    c_size_t, c_void_p)
from typing import Any

Doubles = Ints = Bools = c_void_p  # addresses; _arrays.py makes numpy views of them
Log = CFUNCTYPE(None, c_void_p, c_int, c_char_p)
Write = CFUNCTYPE(None, c_void_p, c_char_p)
Allocate = CFUNCTYPE(c_void_p, c_void_p, c_void_p, c_size_t, c_size_t)


class Options(Structure):  # pdyn_options
    _fields_ = [("threads", c_int), ("allocate", Allocate), ("allocate_user", c_void_p),
                ("log", Log), ("log_user", c_void_p), ("refuse_scene_plugins", c_bool)]


class StepInfo(Structure):  # pdyn_step_info
    """Results of a step.

    time, h                     s, at the end of the step; its length
    frame                       whether the step reached a frame of the output
    outer_iterations            local/global iterations
    linear_iterations           iterations of the linear solver
    impacts                     one-sided constraints that stopped a motion
    retries                     rejected attempts; each made the step shorter
    particles                   live particles of all bodies of particles
    density_error_mean, _max    of the fluid, relative to its rest density
    step_residual               largest |grad E| / (max(|M g|, impact) + load) of a body
    kinetic_energy, potential_energy, constraint_energy     J
    momentum, pin_reaction      kg m/s and N, tuples of three numbers
    ms_neighbours, ms_local, ms_global, ms_contact, ms_cpu  ms, wall-clock and processor time
    leaked                      particles that passed through a surface or solid
    """
    _fields_ = [("time", c_double), ("h", c_double), ("frame", c_bool),
                ("outer_iterations", c_int), ("linear_iterations", c_int), ("impacts", c_int),
                ("retries", c_int), ("particles", c_int), ("density_error_mean", c_double),
                ("density_error_max", c_double), ("step_residual", c_double),
                ("kinetic_energy", c_double), ("potential_energy", c_double),
                ("constraint_energy", c_double), ("momentum", c_double * 3),
                ("pin_reaction", c_double * 3), ("ms_neighbours", c_double),
                ("ms_local", c_double), ("ms_global", c_double), ("ms_contact", c_double),
                ("ms_cpu", c_double), ("leaked", c_long)]

    def to_dict(self) -> dict[str, Any]:
        """A copy by name: pandas.DataFrame([info.to_dict() for info in sim.run()]) is a table."""
        return {name: getattr(self, name) for name, *_ in self._fields_}

    def __repr__(self) -> str:
        return (f"<step to {self.time:.6g} s, h = {self.h:.4g} s, {self.outer_iterations} outer "
                f"iterations, residual {self.step_residual:.3g}>")


def _as_tuple(member: Any) -> property:
    """A member that is an array, as a tuple: an array of ctypes prints no numbers."""
    return property(lambda struct: tuple(member.__get__(struct)))


for _name in ("momentum", "pin_reaction"):
    setattr(StepInfo, _name, _as_tuple(getattr(StepInfo, _name)))


class State(Structure):  # pdyn_state
    _fields_ = [("particles", c_int), ("x", Doubles), ("v", Doubles), ("mass", Doubles),
                ("density", Doubles), ("pressure", Doubles), ("live", Bools), ("boundary", c_int),
                ("moving", c_int), ("boundary_x", Doubles), ("bodies", c_int),
                ("constraints", c_int), ("samples", c_int)]


class BodyInfo(Structure):  # pdyn_body_info
    _fields_ = [("name", c_char_p), ("first", c_int), ("count", c_int), ("live", c_int),
                ("radius", c_double), ("rest_density", c_double), ("triangles", c_int),
                ("triangle", Ints), ("residual", c_double), ("rest", Doubles), ("edges", c_int),
                ("edge", Ints), ("tets", c_int), ("tet", Ints)]


class ConstraintInfo(Structure):  # pdyn_constraint_info
    _fields_ = [("type", c_char_p), ("body", c_char_p), ("elements", c_int), ("energy", c_double)]


class ParameterInfo(Structure):  # pdyn_parameter_info
    _fields_ = [("name", c_char_p), ("unit", c_char_p), ("value", c_double),
                ("minimum", c_double), ("maximum", c_double), ("changeable", c_bool),
                ("doc", c_char_p)]


class VectorInfo(Structure):  # pdyn_vector_info
    _fields_ = [("name", c_char_p), ("unit", c_char_p), ("count", c_int), ("value", Doubles),
                ("changeable", c_bool), ("doc", c_char_p), ("width", c_int)]


class WarningInfo(Structure):  # pdyn_warning
    _fields_ = [("code", c_char_p), ("subject", c_char_p), ("text", c_char_p), ("count", c_long),
                ("first", c_double), ("last", c_double)]


class ProbeInfo(Structure):  # pdyn_probe_info
    _fields_ = [("name", c_char_p), ("values", c_int), ("column", POINTER(c_char_p)),
                ("value", Doubles)]
