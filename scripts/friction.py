#!/usr/bin/env python3
"""Measures friction on a plane and prints one table of docs/results/contact.md.

Usage: friction.py incline    acceleration of a sheet on an inclined plane
       friction.py landing    friction of bodies that are thrown onto a plane

Needs NumPy, the package python/ on PYTHONPATH and PROJDYN_LIBRARY.
"""
import math
import sys

import numpy as np

import projdyn

G = 9.81


def start(body, h, mu, integrator, gravity=(0, -G, 0)):
    """The simulation of a body above a plane."""
    plane = {"name": "floor", "plane": {"center": [0, 0, 0], "normal": [0, 1, 0], "size": 40}}
    return projdyn.Scene(threads=1, duration=100, frame_interval=100, gravity=list(gravity),
                         time_step={"fixed": h, "integrator": integrator}, solver={"tolerance": 1e-3},
                         contact={"thickness": 0.004, "friction": mu},
                         solids=[plane], bodies=[{"name": "body", **body}]).load()


def sheet(y):
    return {"surface": {"grid": {"size": [0.4, 0.4], "vertices": [9, 9]}, "area_density": 0.2, "translate": [0, y, 0]},
            "constraints": [{"type": "triangle", "stretching_stiffness": 1e3}, {"type": "bending", "bending_rigidity": 1e-3}]}


def acceleration(degrees, mu):
    """Of a sheet down a plane, m/s², from 1.7 to 2 s."""
    angle = math.radians(degrees)
    sim = start(sheet(0.004), 0.01, mu, "euler", (G * math.sin(angle), -G * math.cos(angle), 0))
    speeds = []
    for end in 1.7, 2.0:
        while sim.time < end - 1e-9:
            sim.step()
        speeds.append(np.array(sim.bodies["body"].v)[:, 0].mean())
    return (speeds[1] - speeds[0]) / 0.3


def incline():
    print("| angle | mu | acceleration, m/s² | g (sin a - mu cos a) |")
    print("|---|---|---|---|")
    steep = math.tan(math.radians(30))
    for degrees, name, mu in ((20, "0.3", 0.3), (30, "0", 0.0), (30, "0.3", 0.3), (30, "0.5", 0.5), (40, "0.5", 0.5),
                              (30, "0.99 tan a", 0.99 * steep), (30, "1.02 tan a", 1.02 * steep)):
        angle = math.radians(degrees)
        exact = max(0.0, G * (math.sin(angle) - mu * math.cos(angle)))
        print(f"| {degrees} | {name} | {abs(acceleration(degrees, mu)):.4f} | {exact:.4f} |", flush=True)


LANDING = (("box", 0.3, lambda y: {"rigid": {"box": {"minimum": [-0.2, y, -0.2], "maximum": [0.2, y + 0.02, 0.2]}, "density": 1000}}),
           ("ball", 0.1, lambda y: {"rigid": {"sphere": {"center": [0, y + 0.1, 0], "radius": 0.1}, "density": 500}}),
           ("sheet", 0.3, sheet),
           ("soft block", 0.3, lambda y: {"volume": {"grid": {"size": [0.4, 0.1, 0.4], "cells": [6, 2, 6]}, "density": 500,
                                                     "translate": [0, y + 0.05, 0]},
                                          "constraints": [{"type": "tet", "stiffness": 1e5, "damping": 0.003}]}))


def land(body, mu, integrator, h):
    """The change of momentum along the plane over mu times the impulse of the plane, until 0.24 s."""
    sim = start({**body, "velocity": [4, -2, 0]}, h, mu, integrator)
    momentum = sim.step().momentum
    mass = momentum[0] / 4  # in flight
    while sim.time < 0.24 - 1e-9:
        momentum = sim.step().momentum
    return (4 * mass - momentum[0]) / (momentum[1] + mass * (2 + G * sim.time)) / mu


def landing():
    """Least and greatest ratio of six heights: impacts begin at different parts of a step."""
    print("| body, mu | euler, 5 ms | bdf2, 5 ms | bdf2, 1 ms |")
    print("|---|---|---|---|")
    for name, mu, body in LANDING:
        cells = []
        for integrator, h in ("euler", 0.005), ("bdf2", 0.005), ("bdf2", 0.001):
            ratios = [land(body(y), mu, integrator, h) for y in np.linspace(0.05, 0.1, 6)]
            ends = f"{min(ratios):.2f}", f"{max(ratios):.2f}"
            cells.append(" to ".join(sorted(set(ends))))
        print(f"| {name}, {mu:g} | " + " | ".join(cells) + " |", flush=True)


commands = {"incline": incline, "landing": landing}
if len(sys.argv) != 2 or sys.argv[1] not in commands:
    sys.exit(__doc__)
commands[sys.argv[1]]()
