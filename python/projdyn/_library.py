"""The shared library: where it is, and the types of its functions, as in its headers."""
from __future__ import annotations

import os
from ctypes import (CDLL, POINTER, c_bool, c_char_p, c_double, c_int, c_size_t, c_uint64, c_void_p)

from ._installed import installed_file
from ._structs import (BodyInfo, ConstraintInfo, Doubles, Ints, Options, ParameterInfo, ProbeInfo,
                      State, StepInfo, VectorInfo, WarningInfo, Write)

Status = c_int
Context = Sim = Scene = Writer = User = c_void_p
Out = POINTER(c_void_p)  # where a new object is stored
Strings = POINTER(c_char_p)

# name: result, arguments...
FUNCTIONS = {
    # projdyn.h
    "pdyn_version": (c_char_p,),
    "pdyn_create_sized": (Status, POINTER(Options), c_size_t, Out),
    "pdyn_default_options_sized": (None, POINTER(Options), c_size_t),
    "pdyn_destroy": (None, Context),
    "pdyn_last_error": (c_char_p, Context),
    "pdyn_load": (Status, Context, c_char_p, Strings, c_int, Out),
    "pdyn_free": (None, Sim),
    "pdyn_step_sized": (Status, Sim, POINTER(StepInfo), c_size_t),
    "pdyn_time": (c_double, Sim),
    "pdyn_duration": (c_double, Sim),
    "pdyn_has_reached": (c_bool, Sim, c_double),
    "pdyn_is_finished": (c_bool, Sim),
    "pdyn_frame_interval": (c_double, Sim),
    "pdyn_solver_type": (c_char_p, Sim),
    "pdyn_integrator": (c_char_p, Sim),
    "pdyn_contact_stiffness": (c_double, Sim),
    "pdyn_state_hash": (c_uint64, Sim),
    "pdyn_get_state_sized": (None, Sim, POINTER(State), c_size_t),
    "pdyn_get_body_sized": (None, Sim, c_int, POINTER(BodyInfo), c_size_t),
    "pdyn_get_constraint_sized": (None, Sim, c_int, POINTER(ConstraintInfo), c_size_t),
    "pdyn_get_parameter_sized": (None, Sim, c_int, c_int, POINTER(ParameterInfo), c_size_t),
    "pdyn_get_vector_sized": (None, Sim, c_int, c_int, POINTER(VectorInfo), c_size_t),
    "pdyn_get_warning_sized": (None, Sim, c_int, POINTER(WarningInfo), c_size_t),
    "pdyn_solid_name": (c_char_p, Sim, c_int),
    "pdyn_solid_vertices": (c_int, Sim, c_int, Doubles),
    "pdyn_solid_triangles": (c_int, Sim, c_int, Ints),
    "pdyn_save": (Status, Sim, c_char_p),
    "pdyn_restore": (Status, Sim, c_char_p),
    "pdyn_save_memory": (Status, Sim, c_void_p, c_size_t, POINTER(c_size_t)),
    "pdyn_restore_memory": (Status, Sim, c_void_p, c_size_t),
    "pdyn_writer_open": (Status, Sim, c_char_p, c_bool, Out),
    "pdyn_writer_frame": (Status, Writer),
    "pdyn_writer_step_sized": (Status, Writer, POINTER(StepInfo), c_size_t),
    "pdyn_writer_report": (Status, Writer, c_char_p, c_bool, c_char_p),
    "pdyn_writer_save": (Status, Writer),
    "pdyn_writer_resume": (Status, Sim, c_char_p, Out),
    "pdyn_writer_close": (None, Writer),
    # scene.h
    "pdyn_scene_create": (Status, Context, c_char_p, Out),
    "pdyn_scene_open": (Status, Context, c_char_p, Out),
    "pdyn_scene_free": (None, Scene),
    "pdyn_scene_set": (Status, Scene, c_char_p, c_char_p),
    "pdyn_scene_mesh": (Status, Scene, c_char_p, c_int, Doubles, c_int, Ints),
    "pdyn_scene_tets": (Status, Scene, c_char_p, c_int, Doubles, c_int, Ints),
    "pdyn_scene_particles": (Status, Scene, c_char_p, c_int, Doubles, Doubles),
    "pdyn_scene_load": (Status, Scene, Out),
    "pdyn_scene_text": (Status, Scene, Write, User),
    "pdyn_scene_write": (Status, Scene, c_char_p),
    # control.h
    "pdyn_set_forces": (Status, Sim, c_int, c_int, Doubles),
    "pdyn_add_forces": (Status, Sim, c_int, c_int, Doubles),
    "pdyn_set_gravity": (Status, Sim, Doubles),
    "pdyn_get_gravity": (None, Sim, Doubles),
    "pdyn_set_positions": (Status, Sim, c_int, c_int, Doubles),
    "pdyn_set_velocities": (Status, Sim, c_int, c_int, Doubles),
    "pdyn_set_parameter": (Status, Sim, c_int, c_char_p, Doubles, c_int),
    "pdyn_enable": (Status, Sim, c_int, c_bool),
    "pdyn_is_enabled": (c_bool, Sim, c_int),
    "pdyn_hold": (Status, Sim, c_int, c_double, Doubles),
    "pdyn_release": (Status, Sim, c_int),
    "pdyn_move_solid": (Status, Sim, c_int, c_double, Doubles, Doubles),
    "pdyn_solid_pose": (Status, Sim, c_int, Doubles, Doubles),
    "pdyn_inlets": (c_int, Sim, c_int),
    "pdyn_move_inlet": (Status, Sim, c_int, c_int, c_double, Doubles, Doubles),
    "pdyn_set_inlet_speed": (Status, Sim, c_int, c_int, c_double, c_double),
    "pdyn_step_by_sized": (Status, Sim, c_double, POINTER(StepInfo), c_size_t),
    # probe.h
    "pdyn_constraint_forces": (Status, Sim, c_int, Doubles),
    "pdyn_constraint_load": (Status, Sim, c_int, Doubles, Doubles),
    "pdyn_contact_forces": (Status, Sim, Doubles),
    "pdyn_solid_load_by": (Status, Sim, c_int, c_int, Doubles, Doubles),
    "pdyn_body_load_by": (Status, Sim, c_int, c_int, Doubles, Doubles),
    "pdyn_element_values": (Status, Sim, c_int, Doubles, Doubles),
    "pdyn_fluid_at": (Status, Sim, c_int, Doubles, Doubles, Doubles),
    "pdyn_get_probe_sized": (None, Sim, c_int, POINTER(ProbeInfo), c_size_t),
}


def library_path() -> str:
    """PROJDYN_LIBRARY of the environment, the library of the wheel, or that of the system."""
    return os.environ.get("PROJDYN_LIBRARY") or installed_file("libprojdyn.so*") or "libprojdyn.so.0"


def open_library(path: str) -> CDLL:
    """The library with typed functions. A function that it lacks is an AttributeError when used."""
    try:
        library = CDLL(path)
    except OSError as error:
        raise ImportError(f"{error}: install the wheel or python3-projdyn, or set PROJDYN_LIBRARY to the library "
                          "of a build, build/src/libprojdyn.so.0") from None
    for name, (result, *arguments) in FUNCTIONS.items():
        function = getattr(library, name, None)
        if function is not None:
            function.restype, function.argtypes = result, arguments
    return library


lib = open_library(library_path())


def version() -> str:
    """Version of the library that was found, e.g. "0.1.0"."""
    return lib.pdyn_version().decode()
