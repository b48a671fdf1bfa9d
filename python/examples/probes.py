#!/usr/bin/env python3
"""Reads probes, the load on the walls and the pressure along one while a column of water collapses."""
import numpy as np

import projdyn

scene = projdyn.Scene(duration=0.8, probes=[
    {"name": "impact", "wall": [0.6, 0.05, 0.1]},
    {"name": "wall", "solid": "tank"},
])
scene.add_fluid(box=([0, 0, 0], [0.2, 0.4, 0.2]), radius=0.01, name="water",
                fluid={"compression": 0.002})
scene.add_solid(name="tank", box=([0, 0, 0], [0.6, 0.6, 0.2]), open=["+y"])
sim = scene.load()
impact, wall = sim.probes["impact"], sim.probes["wall"]
for info in sim.run():
    if info.frame and round(info.time * 30) % 4 == 0:
        print(f"{info.time:.2f} s: {impact['pressure_Pa']:5.0f} Pa on the wall, "
              f"{wall['force_x_N']:6.1f} N on all walls across")
depths = np.linspace(0.01, 0.2, 20)
pressure, velocity = sim.fluid_at(np.column_stack([np.full(20, 0.58), depths, np.full(20, 0.1)]))
for y, p, v in zip(depths, pressure, velocity):
    print(f"y = {y:.2f} m: {p:6.0f} Pa, {np.linalg.norm(v):.2f} m/s")
force, moment = sim.solids["tank"].load()
print(f"load on the tank: {force.round(2)} N, weight {9.81 * sim.mass.sum():.2f} N")
