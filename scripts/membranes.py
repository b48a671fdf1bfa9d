#!/usr/bin/env python3
"""Measures sheets at rest under the pressure of water: an elastic dam, and a tube full of water on a floor. Prints two
tables of docs/results/coupling.md, which has the equations of the exact solutions; with `quick` the first row of each.

Needs NumPy, the package python/ on PYTHONPATH and PROJDYN_LIBRARY.
"""
import sys

import numpy as np

import projdyn

G, DENSITY = 9.81, 1000.0
LENGTH, BASIN, FILL = 0.2, 0.2, 0.15  # m: of the dam; length and depth of the water behind it
DAM = 2.0  # kg/m²
PERIMETER, STIFFNESS = 1.0, 1e4  # m, N/m: of the tube
SETTLED, END = 2.5, 3.0  # s: positions are means between these times
THICKNESS, GAP = 0.001, 0.002  # m: of contact; between the tube and a wall
WATER = {"compression": 1e-3, "viscosity": 0.1}
BASE = 0.02  # of the height of the tube: where the width of its base is measured
ACROSS = 4  # particles between the walls of a slice
POINTS = 2000  # of an exact solution


def sums(values):
    """Sums from the start to the middle of each segment."""
    return np.cumsum(values) - values / 2


def sums_above(values):
    """Sums from the middle of each segment to the end."""
    return sums(values[::-1])[::-1]


def exact_dam(rigidity, area):
    """Displacement of the tip, m, and force of the water along x, N/m, by successive substitution. area: of the water, m²."""
    ds = LENGTH / POINTS
    angle, level = np.zeros(POINTS), area / BASIN
    for _ in range(100):
        dx, dy = ds * np.sin(angle), ds * np.cos(angle)
        x, y = sums(dx), sums(dy)
        wet = np.clip((level - y) / dy + 0.5, 0, 1)  # share of a segment
        level = (area - np.sum(x * dy * wet)) / BASIN
        pressure = DENSITY * G * np.maximum(level - y, 0)
        force_x, force_y = sums_above(pressure * dy), sums_above(-pressure * dx - DAM * G * ds)
        angle = sums(sums_above(force_x * dy - force_y * dx) / rigidity * ds)
    return np.sum(dx), DENSITY * G * level ** 2 / 2


def linear_dam(rigidity, depth):
    """Displacement of the tip, m, of a dam without weight that bends so little that the load stays as it is."""
    return DENSITY * G / rigidity * (depth ** 5 / 30 + (LENGTH - depth) * depth ** 4 / 24)


def exact_tube(inside, weight):
    """The curve, x and y in m, and its tension, N/m. inside: area, m². weight: of the water per area, N/m³."""
    step = np.pi / POINTS
    angle = (np.arange(POINTS) + 0.5) * step
    low, high = 0.0, 1 - 1e-6
    while high - low > 1e-14:
        m = (low + high) / 2
        ds = step / np.sqrt(1 - m * np.sin(angle / 2) ** 2)  # over r = T / P
        dx, dy = ds * np.cos(angle), ds * np.sin(angle)
        half = -np.sum(dx)  # of the contact with the floor
        r = PERIMETER / (2 * (half + np.sum(ds)))
        r *= 1 + 4 * weight * r * r / m / STIFFNESS  # the sheet is longer by the strain T / stiffness
        low, high = (low, m) if 8 * half * r * r / m < inside else (m, high)
    x, y = r * (half + np.cumsum(dx)), r * np.cumsum(dy)
    return np.append(x, -x[::-1]), np.append(y, y[::-1]), 4 * weight * r * r / m


def strip(rows, z, closed):
    """Vertices and triangles of a sheet: rows of points (x, y), each at all places z; closed: the last row meets the first."""
    n, width = len(rows), len(z)
    vertices = [(x, y, depth) for x, y in rows for depth in z]
    triangles = []
    for i in range(n if closed else n - 1):
        for j in range(width - 1):
            a, b = i * width + j, (i + 1) % n * width + j
            triangles += [(a, b, a + 1), (b, b + 1, a + 1)] if (i + j) % 2 else [(a, b, b + 1), (a, b + 1, a + 1)]
    return np.array(vertices), np.array(triangles)


def slice_of(spacing, walls, tolerance, **keys):
    """A scene between walls in z, and the distance between these. walls: box in x and y with its open sides."""
    scene = projdyn.Scene(threads=1, duration=100, time_step={"integrator": "euler", "maximum": 0.005},
                          solver={"tolerance": tolerance}, **keys)
    low, high, sides = walls
    scene.add_solid(name="walls", box=([*low, 0], [*high, ACROSS * spacing]), open=sides)
    return scene, ACROSS * spacing


def rest(scene, rows):
    """Mean positions of the sheet between SETTLED and END, m, as rows x vertices x 3, and the simulation at END."""
    sim = scene.load()
    positions = [np.array(sim.bodies["sheet"].x) for _ in sim.run(until=END) if sim.time > SETTLED]
    return np.mean(positions, 0).reshape(rows, -1, 3), sim


def water_area(sim, spacing):
    """m², in the plane of the slice."""
    return len(sim.bodies["water"].x) * spacing ** 2 / ACROSS


def off(value, exact):
    """A cell of a table: a value and its deviation."""
    return f"{value:.1f} ({100 * (value / exact - 1):+.1f} %)"


def dam(spacing, rigidity):
    """A row of the table. rigidity: N m."""
    scene, width = slice_of(spacing, ([-BASIN, 0], [0.6, 0.6], ["+y", "+x"]), 0.01)
    scene.add_fluid(box=([-BASIN, 0, 0], [0, FILL, width]), radius=spacing / 2, name="water", fluid=WATER)
    rows = round(LENGTH / (0.8 * spacing)) + 2
    ds = LENGTH / (rows - 1.5)
    heights = ds * (np.arange(rows) - 0.5)  # the first two rows hold the clamp half way between them
    z = np.linspace(-spacing, width + spacing, 7)  # goes through the walls
    share = width / (z[-1] - z[0])  # stiffness and mass are those of the width of the water
    scene.add_cloth(*strip([(0, y) for y in heights], z, False), name="sheet", area_density=share * DAM,
                    triangle={"stretching_stiffness": share * 2e4},
                    bending={"bending_rigidity": share * rigidity, "damping": 0.1},
                    pin={"vertices": {"vertices": list(range(2 * len(z)))}})
    scene["probes"] = [{"name": "load", "body": "sheet", "source": "fluid"}]
    sheet, sim = rest(scene, rows)
    area = water_area(sim, spacing)
    exact, exact_force = exact_dam(rigidity, area)
    tip, force = np.mean(sheet[-1, :, 0]), sim.probes["load"]["force_x_N"] / width
    return (f"{rigidity:g} | {1e3 * spacing:g} | {len(sim.bodies['water'].x)} | {off(force, exact_force)} | "
            f"{off(1e3 * tip, 1e3 * exact)} | {1e3 * exact:.1f} | {1e3 * linear_dam(rigidity, area / BASIN):.1f}")


def stadium(n, height):
    """n points around two straight lines and two half circles, m, from the middle of the lower line to the right."""
    flat = (PERIMETER - np.pi * height) / 2
    corners = np.cumsum([0, flat / 2, np.pi * height / 2, flat, np.pi * height / 2, flat / 2])
    angle = np.interp((np.arange(n) + 0.5) * PERIMETER / n, corners, np.pi * np.array([0, 0, 1, 1, 2, 2]))
    edges = np.column_stack([np.cos(angle), np.sin(angle)]) * PERIMETER / n
    return np.cumsum(edges, 0) - edges


def water_in(height, spacing):
    """Positions of particles, m, in the stadium of a height."""
    x, y, z = np.meshgrid((np.arange(-60, 60) + 0.5) * spacing, (np.arange(60) + 0.55) * spacing,
                          (np.arange(ACROSS) + 0.5) * spacing)
    off_middle = np.maximum(np.abs(x) - (PERIMETER - np.pi * height) / 4, 0)
    inside = np.hypot(off_middle, y - height / 2) < height / 2 - 0.52 * spacing
    return np.column_stack([x[inside], y[inside], z[inside]])


def sizes(x, y):
    """Height, width and width of the base of a closed curve, mm."""
    level = np.min(y) + BASE * np.ptp(y)
    i = np.flatnonzero((y < level) != (np.roll(y, -1) < level))
    after = (i + 1) % len(x)
    base = x[i] + (level - y[i]) / (y[after] - y[i]) * (x[after] - x[i])
    return 1e3 * np.ptp(y), 1e3 * np.ptp(x), 1e3 * np.ptp(base)


def tension_of(sheet):
    """Mean tension of a tube, N/m."""
    rounds = np.sum(np.linalg.norm(np.roll(sheet, -1, 0) - sheet, axis=2), 0)
    return STIFFNESS * (np.mean(rounds[1:] + rounds[:-1]) / 2 / PERIMETER - 1)


def tube(spacing, start_height):
    """A row of the table. start_height: m."""
    scene, width = slice_of(spacing, ([-1, 0], [1, 1], ["+y"]), 0.1, contact={"thickness": THICKNESS, "friction": 0})
    lift = [0, THICKNESS, 0]
    scene.add_fluid(water_in(start_height, spacing) + lift, radius=spacing / 2, name="water", fluid=WATER)
    rows = 2 * round(PERIMETER / (1.6 * spacing))
    vertices, triangles = strip(stadium(rows, start_height), np.linspace(GAP, width - GAP, 6), True)
    scene.add_cloth(vertices + lift, triangles, name="sheet", area_density=0.2,
                    triangle={"stretching_stiffness": STIFFNESS, "damping": 0.002})
    sheet, sim = rest(scene, rows)
    x, y, _ = sheet.mean(1).T
    area, inside = water_area(sim, spacing), np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) / 2
    exact_x, exact_y, exact_tension = exact_tube(inside, DENSITY * G * area / inside)
    share = 1 - 2 * GAP / width  # the sheet is narrower than the water, which it carries alone
    cells = map(off, (*sizes(x, y), share * tension_of(sheet)), (*sizes(exact_x, exact_y), exact_tension))
    return (f"{area:.4f} | {1e3 * spacing:g} | {len(sim.bodies['water'].x)} | {100 * (inside / area - 1):+.1f} % | "
            f"{' | '.join(cells)}")


def main():
    dams = [(0.025, 1.2), (0.0125, 1.2), (0.00625, 1.2), (0.025, 0.5), (0.0125, 0.5), (0.00625, 0.5)]
    tubes = [(0.02, 0.15), (0.0125, 0.15), (0.02, 0.18), (0.0125, 0.18), (0.01, 0.18)]
    if sys.argv[1:] == ["quick"]:
        dams, tubes = dams[:1], tubes[:1]
    elif sys.argv[1:]:
        sys.exit(__doc__)
    print("| rigidity, N m | d, mm | particles | force of the water, N/m | tip, mm | exact, mm | of the linear equation, mm |")
    print("|---" * 7 + "|")
    for case in dams:
        print(f"| {dam(*case)} |", flush=True)
    print("\n| water, m² | d, mm | particles | inside, of the water | height, mm | width, mm | base, mm | tension, N/m |")
    print("|---" * 8 + "|")
    for case in tubes:
        print(f"| {tube(*case)} |", flush=True)


main()
