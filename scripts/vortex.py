#!/usr/bin/env python3
"""Measures the viscosity of water without one: how fast a vortex in a tank slows down. Prints a table of
docs/results/validation.md, with `quick` its first row for a tenth of the time.

Needs NumPy, the package python/ on PYTHONPATH and PROJDYN_LIBRARY.
"""
import sys

import numpy as np

import projdyn

SIDE = 0.6  # m
K = np.pi / SIDE
REST, FAST, STIR, TIME = 0.4, 0.6, 1.2, 1.5  # s at rest, m/s of the stirred water, s stirred, s measured


def vortex(x):
    """Its velocity at positions x (n x 3) where the fastest water has 1 m/s: free slip at the sides, no divergence."""
    sine, cosine = np.sin(K * x), np.cos(K * x)
    return np.column_stack([sine[:, 0] * cosine[:, 2], 0 * x[:, 1], -cosine[:, 0] * sine[:, 2]])


def tank(spacing, depth, h, integrator, xsph, kernel):
    scene = projdyn.Scene(duration=100, threads=1, kernel=kernel, frame_interval=0.03,
                          time_step={"fixed": h, "integrator": integrator})
    scene.add_fluid(box=([0, 0, 0], [SIDE, depth, SIDE]), radius=spacing / 2, name="water",
                    fluid={"sound_speed": 40, "viscosity": xsph})
    scene.add_solid(name="tank", box=([0, 0, 0], [SIDE, 2 * depth, SIDE]), open=["+y"])
    return scene.load()


def step_until(sim, time):
    while sim.time < time:
        sim.step()


def stir(sim, share):
    """Brings the particles out of the lattice of the start, and stops them."""
    water = sim.bodies["water"]
    step_until(sim, REST * share)
    water.set_velocities(FAST * vortex(np.array(water.x)))
    step_until(sim, (REST + STIR) * share)
    water.set_velocities([0, 0, 0])
    step_until(sim, (REST + STIR + 0.2) * share)


def measure(speed, share, setting):
    """The viscosity, m^2/s, and the root mean square of the velocity of particles in water at rest, m/s."""
    sim = tank(**setting)
    water = sim.bodies["water"]
    stir(sim, share)
    unrest = np.sqrt(np.mean(np.sum(np.square(water.v), 1)))
    water.set_velocities(speed * vortex(np.array(water.x)))
    sim.step()
    start, times, amplitudes = sim.time, [], []
    while sim.time < start + TIME * share:
        mode = vortex(np.array(water.x))
        times.append(sim.time)
        amplitudes.append(np.sum(water.v * mode) / np.sum(mode * mode))
        sim.step()
    return -np.polyfit(times, np.log(amplitudes), 1)[0] / (2 * K * K), unrest


def main():
    usual = {"spacing": 0.03, "depth": 0.3, "h": 0.005, "integrator": "bdf2", "xsph": 0.0, "kernel": "cubic_spline"}
    smooth = {"kernel": "wendland"}
    rows = [(0.3, {}), (0.3, {"spacing": 0.02}), (0.3, {"depth": 0.15}), (0.3, {"depth": 0.6}), (0.1, {}), (0.6, {}),
            (0.3, {"h": 0.001}), (0.3, {"integrator": "euler"}), (0.3, {"xsph": 0.02}),
            (0.3, {"xsph": 0.02, "h": 0.001}), (0.3, smooth),
            (0.3, {**smooth, "spacing": 0.02}), (0.3, {**smooth, "depth": 0.15}), (0.3, {**smooth, "depth": 0.6}),
            (0.1, smooth), (0.6, smooth), (0.3, {**smooth, "xsph": 0.02})]
    share = 1.0
    if sys.argv[1:] == ["quick"]:
        rows, share = rows[:1], 0.1
    elif sys.argv[1:]:
        sys.exit(__doc__)
    print("| d, mm | depth, m | vortex, m/s | h, ms | integrator | XSPH | kernel | viscosity, m²/s | Pa s | particles at rest, m/s |")
    print("|---" * 10 + "|")
    for speed, changes in rows:
        setting = {**usual, **changes}
        viscosity, unrest = measure(speed, share, setting)
        print(f"| {1e3 * setting['spacing']:g} | {setting['depth']:g} | {speed:g} | {1e3 * setting['h']:g} | "
              f"{setting['integrator']} | {setting['xsph']:g} | {setting['kernel']} | {viscosity:.4f} | {1e3 * viscosity:.0f} | {unrest:.2f} |",
              flush=True)


main()
