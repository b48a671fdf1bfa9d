#!/usr/bin/env python3
"""Steps a sheet of 10,000 vertices from Python; numpy arrays share the memory of the library, without copies.

    python3 cloth.py [libprojdyn.so.0]
"""
import ctypes as c
import json
import sys

import numpy as np

lib = c.CDLL(sys.argv[1] if len(sys.argv) > 1 else "libprojdyn.so.0")
doubles = c.POINTER(c.c_double)


class State(c.Structure):  # pdyn_state of projdyn.h
    _fields_ = [("particles", c.c_int), ("x", doubles), ("v", doubles), ("mass", doubles), ("density", doubles),
                ("pressure", doubles), ("live", c.POINTER(c.c_bool)), ("boundary", c.c_int), ("moving", c.c_int),
                ("boundary_x", doubles), ("bodies", c.c_int), ("constraints", c.c_int)]


lib.pdyn_last_error.restype = c.c_char_p
lib.pdyn_time.restype = c.c_double
lib.pdyn_get_state.restype = State
for name in ("last_error", "time", "get_state", "step", "free", "destroy"):
    getattr(lib, "pdyn_" + name).argtypes = [c.c_void_p] + ([c.c_void_p] if name == "step" else [])


def check(status, context):
    if status:
        sys.exit(lib.pdyn_last_error(context).decode())


scene = {
    "duration": 1,
    "bodies": [{
        "name": "sheet",
        "surface": {"grid": {"size": [1, 1], "vertices": [100, 100]}, "area_density": 0.2},
        "constraints": [{"type": "spring", "stretching_stiffness": 500},
                        {"type": "pin", "vertices": {"vertices": [0, 99]}}]
    }]
}
context, sim = c.c_void_p(), c.c_void_p()
check(lib.pdyn_create(None, c.byref(context)), context)
check(lib.pdyn_load_text(context, json.dumps(scene).encode(), b"scene", None, 0, c.byref(sim)), context)
state = lib.pdyn_get_state(sim)
x = np.ctypeslib.as_array(state.x, (state.particles, 3))
mass = np.ctypeslib.as_array(state.mass, (state.particles,))
for _ in range(20):
    check(lib.pdyn_step(sim, None), context)
    print(f"{lib.pdyn_time(sim):.4f} s: the centre of mass is at y = {mass @ x[:, 1] / mass.sum():.5f} m")
assert x.ctypes.data == c.cast(state.x, c.c_void_p).value and mass @ x[:, 1] < 0
del x, mass, state
lib.pdyn_free(sim)
lib.pdyn_destroy(context)
