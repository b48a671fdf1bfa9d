#!/usr/bin/env python3
"""Finds the bending rigidity of a cloth from the measured droop of a strip that overhangs a table."""
import math

import projdyn

MEASURED = 0.100  # m, droop of the end of a strip of 0.2 m
scene = projdyn.Scene(duration=4, frame_interval=4, threads=1, solver={"tolerance": 1e-3},
                      time_step={"fixed": 0.02, "integrator": "euler"})  # Euler's damping brings rest
scene.add_cloth(name="strip", area_density=0.15, spring={"stretching_stiffness": 500},
                grid={"size": [0.21, 0.02], "vertices": [43, 5]},
                bending={"bending_rigidity": 1e-5},
                pin={"vertices": {"box": {"minimum": [-0.11, -1, -1], "maximum": [-0.0995, 1, 1]}}})


def droop(rigidity):
    """m, of the free end at rest."""
    scene["bodies.strip.constraints.bending.bending_rigidity"] = rigidity
    sim = scene.load()
    for info in sim.run():
        pass
    return -sim.bodies["strip"].x[:, 1].min()


low, high = math.log(1e-4), math.log(1e-2)
for run in range(12):
    middle = (low + high) / 2
    found = droop(math.exp(middle))
    print(f"run {run}: {math.exp(middle):.3e} N m gives {1e3 * found:.2f} mm")
    low, high = (middle, high) if found > MEASURED else (low, middle)
print(f"bending rigidity: {math.exp((low + high) / 2):.3e} N m")
