#!/usr/bin/env python3
"""Measures flows that have a formula: a jet on a plate, an orifice, a bucket that turns, a U-tube. Prints a table of
docs/results/validation.md, with `quick` its first row.

Needs NumPy, the package python/ on PYTHONPATH and PROJDYN_LIBRARY.
"""
import sys

import numpy as np

import projdyn

G = 9.81


def box(low, high):
    return {"minimum": low, "maximum": high}


def start(spacing, particles, solids, **keys):
    """A simulation of water (keys of "particles") among solids."""
    scene = projdyn.Scene(threads=2, duration=100, time_step={"maximum": 0.005}, **keys)
    water = {"name": "water", "particles": {"radius": spacing / 2, **particles},
             "constraints": [{"type": "fluid", "sound_speed": 40}]}
    scene["bodies"], scene["solids"] = [water], solids
    return scene.load()


def positions(sim):
    """Of the particles that are in the scene."""
    return np.array(sim.bodies["water"].x)


def jet(across):
    """The force of a jet on a plate over that of its momentum, which leaves along the plate."""
    radius, speed = 0.04, 2.0
    spacing = radius / across
    nozzle = {"disc": {"center": [-0.12, 0, 0], "radius": radius}, "direction": [1, 0, 0], "speed": speed, "duration": 1}
    sim = start(spacing, {"inlets": [nozzle]}, [{"name": "plate", "box": box([0, -0.3, -0.3], [0.05, 0.3, 0.3])}],
                gravity=[0, 0, 0], outlets=[{"box": box([-0.3, -0.15, -0.15], [1, 0.15, 0.15]), "outside": True}],
                probes=[{"name": "force", "solid": "plate"}])
    i = np.arange(-across, across + 1)
    layer = np.count_nonzero(i[:, None] ** 2 + i ** 2 <= across ** 2)
    forces = []
    while sim.time < 0.4:
        sim.step()
        forces.append((sim.time, sim.probes["force"]["force_x_N"]))
    mean = np.mean([force for time, force in forces if time > 0.25])
    return spacing, mean / (1000 * layer * spacing ** 2 * speed ** 2), 1.0


def orifice(across):
    """The flow through a square hole in the floor of a tank over that of Torricelli. 0.61: contraction of the jet."""
    half = 0.05
    spacing = 2 * half / across
    rim = [([-0.3, -0.02, -0.3], [-half, 0, 0.3]), ([half, -0.02, -0.3], [0.3, 0, 0.3]),
           ([-half, -0.02, -0.3], [half, 0, -half]), ([-half, -0.02, half], [half, 0, 0.3])]
    tank = {"name": "tank", "box": box([-0.2, 0, -0.2], [0.2, 0.8, 0.2]), "open": ["+y", "-y"]}
    sim = start(spacing, {"fill": [{"box": box([-0.2, 0, -0.2], [0.2, 0.5, 0.2])}]},
                [tank] + [{"name": f"floor{k}", "box": box(*rim[k])} for k in range(4)],
                outlets=[{"box": box([-1, -0.3, -1], [1, 2, 1]), "outside": True}])
    times, volumes = [], []
    while sim.time < 0.8:
        sim.step()
        times.append(sim.time)
        volumes.append(np.count_nonzero(positions(sim)[:, 1] > 0) * spacing ** 3)
    late = np.array(times) > 0.3
    flow, volume = -np.polyfit(np.array(times)[late], np.array(volumes)[late], 1)[0], np.mean(np.array(volumes)[late])
    return spacing, flow / (4 * half ** 2 * np.sqrt(2 * G * volume / 0.16)), 0.61


def bucket(across):
    """How much higher, m, water stands 135 mm from the axis of a bucket that turns once a second than 15 mm from it."""
    side, turns = 0.3, 2 * np.pi
    spacing = side / across
    sim = start(spacing, {"fill": [{"box": box([-0.15, 0, -0.15], [0.15, 0.14, 0.15])}]},
                [{"name": "bucket", "box": box([-0.15, 0, -0.15], [0.15, 0.5, 0.15]), "open": ["+y"],
                  "motion": [{"time": 0}, {"time": 100, "rotate": [0, 36000, 0]}]}])
    heights = []
    while sim.time < 5:
        sim.step()
        if sim.time < 4:
            continue
        x = positions(sim)
        r, row = np.hypot(x[:, 0], x[:, 2]), []
        for inner in (0.0, 0.12):
            y = np.sort(x[(r >= inner) & (r < inner + 0.03), 1])
            row.append(np.mean(y[-max(3, int(np.pi * ((inner + 0.03) ** 2 - inner ** 2) / spacing ** 2)):]))
        heights.append(row[1] - row[0])
    return spacing, np.mean(heights), turns ** 2 * (0.135 ** 2 - 0.015 ** 2) / (2 * G)


def u_tube(across):
    """Half a period, s, of water in a square U-tube of 80 mm: from its first to its second passage through rest."""
    side, width, height, start_height = 0.08, 0.36, 0.28, 0.04
    spacing = side / across
    depth = 6 * spacing
    legs = [box([0, 0, 0], [side, height + start_height, depth]),
            box([width - side, 0, 0], [width, height - start_height, depth]),
            box([side, 0, 0], [width - side, side, depth])]
    sim = start(spacing, {"fill": [{"box": leg} for leg in legs]},
                [{"name": "tube", "box": box([0, 0, 0], [width, 0.6, depth]), "open": ["+y"]},
                 {"name": "between", "box": box([side, side, -0.1], [width - side, 0.7, depth + 0.1])}])
    passages, before = [], 1.0
    while len(passages) < 2 and sim.time < 2:
        h, x = sim.step().h, positions(sim)
        x = x[x[:, 1] > side, 0]
        difference = float(np.count_nonzero(x < width / 2) - np.count_nonzero(x > width / 2))
        if difference * before < 0:
            passages.append(sim.time - h * difference / (difference - before))
        before = difference or before
    length = 0.69  # m, of the flow without friction through the corners; along the middle it is 0.76
    return spacing, passages[1] - passages[0], np.pi * np.sqrt(length / (2 * G))


def main():
    rows = [("force of a jet on a plate, of rho A v²", jet, 4), ("", jet, 8), ("flow through an orifice, of A sqrt(2 g h)", orifice, 5),
            ("", orifice, 8), ("rise of water in a turning bucket, m", bucket, 15),
            ("", bucket, 24),
            ("half a period of water in a U-tube, s", u_tube, 8), ("", u_tube, 12)]
    if sys.argv[1:] == ["quick"]:
        rows = rows[:1]
    elif sys.argv[1:]:
        sys.exit(__doc__)
    print("| | d, mm | spacings across | measured | formula | off by |")
    print("|---|---|---|---|---|---|")
    for name, flow, across in rows:
        spacing, measured, exact = flow(across)
        print(f"| {name} | {1e3 * spacing:.3g} | {across * (2 if flow is jet else 1)} | {measured:.3f} | {exact:.3f} | "
              f"{100 * (measured / exact - 1):+.0f} % |", flush=True)


main()
