#!/usr/bin/env python3
"""Keeps a floating block at a height of its own choice: a controller sets the force on it every step."""
import projdyn

HEIGHT, STIFFNESS, DAMPING, INTEGRAL = 0.26, 400.0, 80.0, 3000.0  # m, N/m, N s/m, N/(m s)
scene = projdyn.Scene(duration=1.6, time_step={"maximum": 0.01}, contact={"thickness": 0.004})
scene.add_fluid(box=([0, 0, 0], [0.6, 0.24, 0.6]), radius=0.02, name="water",
                fluid={"compression": 0.005, "viscosity": 0.1})
scene.add_soft(name="block", grid={"size": [0.24, 0.12, 0.24], "cells": [3, 2, 3]}, density=600,
               translate=[0.3, 0.30, 0.3], tet={"stiffness": 1e5})
scene.add_solid(name="tank", box=([0, 0, 0], [0.6, 0.6, 0.6]), open=["+y"])
sim = scene.load()
block = sim.bodies["block"]
share = block.mass[:, None] / block.mass.sum()
integral = 0.0
for info in sim.run():
    error = HEIGHT - (share * block.x).sum(0)[1]
    integral += error * info.h
    pull = STIFFNESS * error - DAMPING * (share * block.v).sum(0)[1] + INTEGRAL * integral
    block.set_forces(share * [0, pull, 0])
    if info.frame and round(info.time * 30) % 6 == 0:
        print(f"{info.time:.1f} s: {1e3 * error:6.1f} mm below {HEIGHT} m, pull {pull:6.1f} N")
