#!/usr/bin/env python3
"""Builds scenes/water_on_cloth.json from arrays, steps it, and prints the hash of its state.

    python3 scene_from_arrays.py [STEPS]
"""
import sys

import numpy as np

import projdyn

n, size, sag, radius = 93, 0.9, 0.1, 0.005
i, j = np.tile(np.arange(n), n), np.repeat(np.arange(n), n)
a, b = i / (n - 1) - 0.5, j / (n - 1) - 0.5
depth = sag * (1 - 4 * a * a) * (1 - 4 * b * b)
vertices = np.column_stack([size * a, 0.28 - depth, size * b])
p = np.flatnonzero((i < n - 1) & (j < n - 1))  # corners of the cells: p q above s r
q, s, r, even = p + 1, p + n, p + n + 1, ((i + j) % 2 == 0)[p, None]
triangles = np.where(even, np.column_stack([p, s, r, p, r, q]), np.column_stack([p, s, q, q, s, r]))
z, y, x = np.indices((50, 8, 50)).reshape(3, -1)
water = [-0.25, 0.24, -0.25] + radius * (2 * np.column_stack([x, y, z]) + 1)

scene = projdyn.Scene(duration=3, frame_interval=0.04, time_step={"maximum": 0.005, "cfl": 1},
                      solver={"tolerance": 0.3, "outer_iterations": 100, "linear_tolerance": 0.3},
                      outlets=[{"box": {"minimum": [-0.6, -0.1, -0.6], "maximum": [0.6, 2, 0.6]},
                                "outside": True}])
scene.add_fluid(water, name="water", radius=radius, fluid={"compression": 0.002, "viscosity": 0.2})
scene.add_cloth(vertices, triangles.reshape(-1, 3), name="sheet", area_density=0.3,
                spring={"stretching_stiffness": 10000}, bending={"bending_rigidity": 1e-4},
                pin={"vertices": {"border": True}})
scene.add_solid(name="tray", box=([-0.55, 0, -0.55], [0.55, 0.4, 0.55]), open=["+y"])
sim = scene.load()
for _ in range(int(sys.argv[1]) if len(sys.argv) > 1 else 3):
    sim.step()
print(f"{sim.time:.4f} s: {sim.hash:016x}")
