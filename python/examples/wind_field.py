#!/usr/bin/env python3
"""Blows a whirlwind, a field of velocities in numpy, at a curtain: a force on every particle."""
import numpy as np

import projdyn

DRAG = 0.3  # N s/m per kg: how strongly the air takes the cloth along
scene = projdyn.Scene(duration=1)
scene.add_cloth(grid={"size": [1, 1], "vertices": [25, 25]}, name="curtain", rotate=[90, 0, 0],
                area_density=0.15, spring={"stretching_stiffness": 300, "damping": 0.01},
                bending={"bending_rigidity": 1e-4},
                pin={"vertices": {"box": {"minimum": [-1, 0.49, -1], "maximum": [1, 1, 1]}}})
sim = scene.load()
curtain = sim.bodies["curtain"]


def wind(x, time):
    """m/s, n x 3: a vortex around the axis y that moves past the curtain."""
    from_axis = x - [np.sin(2 * time), 0, 0.3]
    swirl = np.column_stack([-from_axis[:, 2], np.zeros(len(x)), from_axis[:, 0]])
    return 12 * swirl / (0.1 + (swirl**2).sum(1, keepdims=True))


for info in sim.run():
    air = wind(curtain.x, info.time)
    curtain.set_forces(DRAG * curtain.mass[:, None] * (air - curtain.v))
    if info.frame and round(info.time * 30) % 5 == 0:
        print(f"{info.time:.1f} s: the curtain blows {1e3 * np.abs(curtain.x[:, 2]).max():.0f} mm out")
