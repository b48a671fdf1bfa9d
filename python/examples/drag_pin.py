#!/usr/bin/env python3
"""Takes a corner of a hanging cloth, drags it along a path, and lets it go."""
import numpy as np

import projdyn

scene = projdyn.Scene(duration=3)
scene.add_cloth(grid={"size": [1, 1], "vertices": [25, 25]}, name="sheet", area_density=0.2,
                spring={"stretching_stiffness": 500, "damping": 0.01},
                bending={"bending_rigidity": 1e-3},
                pin={"vertices": {"vertices": [0, 24]}})
sim = scene.load()
sheet, corner = sim.bodies["sheet"], 624
start, end = sheet.x[corner].copy(), np.array([0.2, 0.3, 0.4])
target = start
for info in sim.run(until=1.0):
    if info.frame and round(info.time * 30) % 3 == 0:
        distance = np.linalg.norm(sheet.x[corner] - target)
        print(f"{info.time:.2f} s: {1e3 * distance:.3f} mm from the target")
    target = start + min(info.time / 0.8, 1) * (end - start)
    sheet.hold(corner, target, stiffness=1e5)
sheet.release(corner)
for info in sim.run(until=1.3):
    pass
print(f"released: the corner fell by {end[1] - sheet.x[corner, 1]:.3f} m in 0.3 s")
