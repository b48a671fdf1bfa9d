#!/usr/bin/env python3
"""Drops a skirt, a ring of cloth from arrays, over the hips of a body and measures how it drapes."""
import numpy as np

import projdyn

rings, around = 15, 36
angle, radius = 2 * np.pi * np.arange(around) / around, np.linspace(0.13, 0.42, rings)
vertices = np.column_stack([np.outer(radius, np.cos(angle)).ravel(), np.full(rings * around, 1.12),
                            np.outer(radius, np.sin(angle)).ravel()])
p = np.arange((rings - 1) * around)
q = p + 1 - around * (p % around == around - 1)  # the next vertex of the ring
triangles = np.vstack([np.column_stack([p, q, p + around]),
                       np.column_stack([q, q + around, p + around])])

scene = projdyn.Scene(duration=0.6, time_step={"maximum": 0.01},
                      contact={"thickness": 0.006, "friction": 0.4})
scene.add_cloth(vertices, triangles, name="skirt", area_density=0.2,
                triangle={"stretching_stiffness": 300, "damping": 0.005},
                bending={"bending_rigidity": 1e-5})
scene.add_solid(name="waist", capsule={"from": [0, 0.95, 0], "to": [0, 1.5, 0], "radius": 0.11})
scene.add_solid(name="hips", capsule={"from": [-0.06, 0.95, 0], "to": [0.06, 0.95, 0], "radius": 0.15})
sim = scene.load()
for info in sim.run():
    if info.frame and round(info.time * 30) % 6 == 0:
        y = sim.bodies["skirt"].x[:, 1]
        print(f"{info.time:.2f} s: hem at {y.min():.3f} m, kinetic energy {info.kinetic_energy:.4f} J")
waist, hem = sim.bodies["skirt"].x[:around], sim.bodies["skirt"].x[-around:]
print(f"waist at {waist[:, 1].mean():.3f} m, hem at {hem[:, 1].mean():.3f} m")
print(f"radius of the hem: {np.hypot(hem[:, 0], hem[:, 2]).mean():.3f} m")
force = sim.solids["waist"].load().force + sim.solids["hips"].load().force
print(f"the body carries {-force[1]:.2f} N, the skirt weighs {9.81 * sim.mass.sum():.2f} N")
