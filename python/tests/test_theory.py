"""The equations of docs/theory, computed by numpy, against energies and forces of the library."""
import unittest

import numpy as np

import projdyn
import scenes  # no messages of the library

D = 0.02  # m, particle spacing
VOLUME = D ** 3
SUPPORT = 2 * D


def scene(h=None, **keys):
    """A scene without gravity; h: a fixed step of implicit Euler, s."""
    if h:
        keys |= {"time_step": {"fixed": h, "integrator": "euler"}, "frame_interval": 100 * h}
    return projdyn.Scene(**{"duration": 1, "threads": 1, "gravity": [0, 0, 0], **keys})


def kernel(r):
    """W of the cubic spline, 1/m^3, and dW/dr, 1/m^4 (theory/fluid.md)."""
    q, scale = r / SUPPORT, 8 / (np.pi * SUPPORT ** 3)
    value = np.where(q < 0.5, 1 - 6 * q ** 2 + 6 * q ** 3, 2 * np.maximum(1 - q, 0) ** 3)
    slope = np.where(q < 0.5, -12 * q + 18 * q ** 2, -6 * np.maximum(1 - q, 0) ** 2)
    return scale * value, scale / SUPPORT * slope


def gradients(x, i):
    """V grad W between particle i and all others, n x 3, and V W of all."""
    to = x[i] - x
    r = np.linalg.norm(to, axis=1)
    value, slope = kernel(r)
    return VOLUME * (slope / np.where(r > 0, r, 1))[:, None] * to, VOLUME * value


def stretches(x, rest, cell):
    """Principal stretches of a triangle or tetrahedron, and its area or volume at rest."""
    at_rest = np.linalg.qr((rest[cell[1:]] - rest[cell[0]]).T)[1]
    size = abs(np.linalg.det(at_rest)) / (2 if len(cell) == 3 else 6)
    F = (x[cell[1:]] - x[cell[0]]).T @ np.linalg.inv(at_rest)
    return np.linalg.svd(F, compute_uv=False), size


def hung(**constraints):
    """A sheet that has fallen for 30 steps."""
    made = scene(gravity=[0, -9.81, 0])
    made.add_cloth(grid={"size": [0.4, 0.3], "vertices": [7, 6]}, name="sheet", area_density=0.3,
                   pin={"vertices": {"vertices": [0, 6]}}, **constraints)
    sim = made.load()
    for _ in range(30):
        sim.step()
    return sim, sim.bodies["sheet"]


def two_particles(**constraints):
    """Two particles that move, before and after a step of 1 ms."""
    made = scene(0.001, solver={"tolerance": 1e-9})
    made.add_fluid([[0, 0, 0], [0.022, 0.005, 0]], velocities=[[0, 0, 0], [0.5, -0.3, 0.2]], radius=D / 2,
                   name="water", **constraints)
    sim = made.load()
    x, v = sim.x.copy(), sim.v.copy()
    sim.step()
    return sim, x[0] - x[1], v


class Theory(unittest.TestCase):
    def test_spring(self):
        sim, sheet = hung(spring={"stretching_stiffness": 50})
        energy = 0.0
        for t in sheet.triangles:
            ends = [[t[k], t[k - 1]] for k in range(3)]
            rest, length = (np.array([np.linalg.norm(x[a] - x[b]) for a, b in ends]) for x in (sheet.rest, sheet.x))
            area = stretches(sheet.x, sheet.rest, t)[1]
            energy += 3 * 50 * area / (rest ** 2).sum() / 2 * ((length - rest) ** 2).sum()
        self.assertAlmostEqual(sim.constraints["sheet", "spring"].energy / energy, 1, 9)

    def test_triangle(self):
        sim, sheet = hung(triangle={"stretching_stiffness": 50, "shortest": 0.9, "longest": 1.01})
        energy = 0.0
        for t in sheet.triangles:
            s, area = stretches(sheet.x, sheet.rest, t)
            energy += 50 / 2 * area * ((s - s.clip(0.9, 1.01)) ** 2).sum()
        self.assertAlmostEqual(sim.constraints["sheet", "triangle"].energy / energy, 1, 9)

    def test_tet(self):
        """Strain alone; the volume as the closest s with the product 1 by Newton's method."""
        made = scene(gravity=[0, -9.81, 0])
        made.add_soft(grid={"size": [0.2, 0.2, 0.2], "cells": [2, 2, 2]}, name="block", density=500,
                      tet={"stiffness": 3e3, "volume_stiffness": 5e3},
                      pin={"vertices": {"box": {"minimum": [-1, 0.09, -1], "maximum": [1, 1, 1]}}})
        sim = made.load()
        for _ in range(30):
            sim.step()
        block, energy = sim.bodies["block"], 0.0
        for t in block.tets:
            s, volume = stretches(block.x, block.rest, t)
            p, factor = s.copy(), 0.0  # p = s - factor grad(p0 p1 p2), p0 p1 p2 = 1
            for _ in range(50):
                g = np.prod(p) / p
                factor += (np.prod(p) - 1) / (g @ g)
                p = s - factor * g
            energy += volume / 2 * (3e3 * ((s - 1) ** 2).sum() + 5e3 * ((s - p) ** 2).sum())
        self.assertAlmostEqual(sim.constraints["block", "tet"].energy / energy, 1, 6)

    def test_bending(self):
        """A cylinder with the radius 1 m, whose borders have no moment."""
        made = scene(1e-6, solver={"tolerance": 1e3, "outer_iterations": 1})
        made.add_cloth(grid={"size": [0.6, 0.3], "vertices": [61, 31]}, name="sheet", area_density=1e3,
                       bending={"bending_rigidity": 2}, spring={"stretching_stiffness": 1e-3})
        sim = made.load()
        sheet = sim.bodies["sheet"]
        angle = sheet.rest[:, 0]
        sheet.set_positions(np.column_stack([np.sin(angle), np.cos(angle), sheet.rest[:, 2]]))
        sim.step()
        self.assertAlmostEqual(sim.constraints["sheet", "bending"].energy / (2 / 2 * 0.6 * 0.3), 1, delta=0.02)

    def test_gas(self):
        """A closed block of which the triangles face outwards, or inwards."""
        x = np.array([[a, b, c] for a in (0, 0.2) for b in (0, 0.2) for c in (0, 0.2)])
        outwards = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6],
                             [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])
        start, outside = 101825.0, 101325.0  # Pa
        laws = {"gamma": lambda s, g: ((start * (s ** (1 - g) - 1) / (g - 1) if g != 1 else -start * np.log(s))
                                       + outside * (s - 1), start * s ** -g),
                "bulk_modulus": lambda s, K: (K / 2 * (s - 1) ** 2 - 500 * (s - 1), start + K * (1 - s))}
        for triangles in outwards, outwards[:, ::-1]:
            for law, value in ("gamma", 1.4), ("gamma", 1), ("bulk_modulus", 1e5):
                made = scene()
                made.add_cloth(x, triangles, name="bag", area_density=0.3, triangle={"stretching_stiffness": 200},
                               gas={"overpressure": 500, "inflation": 1.1, law: value})
                sim = made.load()
                for _ in range(5):
                    sim.step()
                a, b, c = (sim.x[outwards[:, k]] for k in range(3))
                volume, first = np.einsum("ij,ij", a, np.cross(b, c)) / 6, 1.1 * 0.008  # m^3
                energy, pressure = laws[law](volume / first, value)
                gas = sim.constraints["bag", "gas"]
                self.assertAlmostEqual(gas.energy / (first * energy), 1, 6)
                force = np.zeros_like(sim.x)
                for k in range(3):
                    np.add.at(force, outwards[:, k], (pressure - outside) / 6 * np.cross(b - a, c - a))
                np.testing.assert_allclose(gas.forces(), force, atol=1e-9 * np.abs(force).max())

    def test_wind(self):
        made = scene(0.001, solver={"tolerance": 1e-8})
        made.add_cloth(grid={"size": [0.2, 0.2], "vertices": [3, 3]}, name="sheet", area_density=1,
                       spring={"stretching_stiffness": 100},
                       wind={"velocity": [1, 5, 0], "drag": 1.1, "air_density": 1.3})
        sim = made.load()
        sim.step()
        force = 0.5 * 1.3 * 1.1 * 5 * (5 - sim.v[:, 1].mean()) * 0.04
        np.testing.assert_allclose(sim.constraints["sheet", "wind"].forces().sum(0), [0, force, 0], atol=1e-9)

    def test_contact(self):
        """The four vertices of a square above a plane."""
        made = scene(1e-7, contact={"thickness": 0.01, "stiffness": 1000})
        made.add_cloth(grid={"size": [0.1, 0.1], "vertices": [2, 2]}, translate=[0, 0.006, 0], name="sheet",
                       area_density=1, spring={"stretching_stiffness": 100})
        made.add_solid(name="floor", plane={"center": [0.01, 0, 0.02], "normal": [0, 1, 0], "size": 2})
        energy = 4 * 1000 * (0.01 - 0.006) ** 3 / (2 * 0.006)
        self.assertAlmostEqual(made.load().step().constraint_energy / energy, 1, 6)

    def test_fluid(self):
        """C, and p = k C / V with k = w / |grad C|^2, bounded, away from the walls."""
        made = scene(gravity=[0, -9.81, 0], time_step={"fixed": 0.002})
        made.add_fluid(box=([0, 0, 0], [0.2, 0.2, 0.2]), radius=D / 2, name="water",
                       fluid={"stiffness": 2e4, "viscosity": 0, "damping": 0})
        made.add_solid(name="tank", box=([0, 0, 0], [0.2, 0.4, 0.2]), open=["+y"])
        sim = made.load()
        for _ in range(60):
            sim.step()
        water, ratios = sim.bodies["water"], []
        x, wall = water.x, 2.1 * D
        inside = (x[:, [0, 2]] > wall).all(1) & (x[:, [0, 2]] < 0.2 - wall).all(1) & (x[:, 1] > wall)
        for i in np.flatnonzero(inside):
            g, value = gradients(x, i)
            C = value.sum() - 1
            self.assertAlmostEqual(water.density[i] / 1000 - 1, C, 9)
            squares = ((g ** 2).sum() + (g.sum(0) ** 2).sum()) * D ** 2
            k = 2e4 * D ** 2 / np.clip(squares, 0.42484, 4 * 0.42484)
            if C > 1e-5:
                ratios.append(water.pressure[i] * VOLUME / (k * C))
        self.assertGreater(len(ratios), 30)
        np.testing.assert_allclose(ratios, 1, atol=0.02)  # k is that of the step before

    def test_viscosity(self):
        sim, before, _ = two_particles(fluid={"stiffness": 0, "viscosity": 0, "damping": 0},
                                       viscosity={"viscosity": 3.0})
        u = sim.x[0] - sim.x[1]
        start, end = np.linalg.norm(before), np.linalg.norm(u)
        q = start / (2 * D)
        force = -2.161 * 3 * D * (1 - q) * (7 / 4 - q) * (end - start) / 0.001 * u / end
        np.testing.assert_allclose(sim.constraints["water", "viscosity"].forces()[0], force, rtol=1e-6)

    def test_no_slip(self):
        """A particle half a spacing above a plane feels the stress mu v / (d/2) on d^2."""
        made = scene(0.001, solver={"tolerance": 1e-9})
        made.add_fluid([[0.001, D / 2, 0.002]], velocities=[[1, 0, 0]], radius=D / 2, name="water",
                       fluid={"stiffness": 0, "viscosity": 0, "damping": 0}, no_slip={"viscosity": 0.5})
        made.add_solid(name="floor", plane={"center": [0, 0, 0], "normal": [0, 1, 0], "size": 0.4})
        sim = made.load()
        sim.step()
        self.assertAlmostEqual(sim.solids["floor"].load().force[0] / (2 * 0.5 * D * sim.v[0, 0]), 1, delta=0.01)

    def test_attachment(self):
        made = scene(gravity=[0, -9.81, 0])
        for name, height in ("upper", 0.1), ("lower", 0):
            made.add_cloth(grid={"size": [0.2, 0.2], "vertices": [3, 3]}, translate=[0, height, 0], name=name,
                           area_density=1, spring={"stretching_stiffness": 100})
        made["bodies.upper.constraints.pin"] = {"type": "pin", "vertices": {"all": True}}
        made["bodies.lower.constraints.attachment"] = {
            "type": "attachment", "to": "upper", "vertices": {"all": True}, "stiffness": 50, "length": 0.5}
        sim = made.load()
        for _ in range(10):
            sim.step()
        lengths = np.linalg.norm(sim.bodies["upper"].x - sim.bodies["lower"].x, axis=1)
        energy = 50 / 2 * ((lengths - 0.5 * 0.1) ** 2).sum()
        self.assertAlmostEqual(sim.constraints["lower", "attachment"].energy / energy, 1, 9)

    def test_xsph(self):
        sim, _, v = two_particles(fluid={"stiffness": 0, "viscosity": 0.1, "damping": 0})
        u = sim.x[0] - sim.x[1]
        n = u / np.linalg.norm(u)
        change = 3 * 0.1 * VOLUME * kernel(np.linalg.norm(u))[0] * ((v[1] - v[0]) @ n) * n
        np.testing.assert_allclose(sim.v[0] - v[0], change, rtol=1e-5)

    def test_friction_and_permeability(self):
        """The force of a uniform stream along a sheet, on one side, and through it."""
        for key, value, bottom, velocity, force in (
                ("fluid_friction", 7.0, 0.0, [1, 0, 0], [7 * 1 * 0.04, 0, 0]),
                ("permeability", 0.01, -0.08, [0, 0.3, 0], [0, 0.3 / 0.01 * 0.04, 0])):
            made = scene(0.0005, solver={"tolerance": 1e-6})
            made.add_fluid(box=([-0.2, bottom, -0.2], [0.2, 0.08, 0.2]), radius=D / 2, name="water", overlap="keep",
                           velocity=velocity, fluid={"sound_speed": 20, "viscosity": 0})
            made.add_cloth(grid={"size": [0.2, 0.2], "vertices": [11, 11]}, name="sheet", area_density=5,
                           spring={"stretching_stiffness": 1e4}, pin={"vertices": {"all": True}}, **{key: value})
            sim = made.load()
            sim.step()
            held = -sim.constraints["sheet", "pin"].load().force
            axis = np.argmax(force)
            self.assertAlmostEqual(held[axis] / force[axis], 1, delta=0.01)

    def test_surface_tension(self):
        """The energy is A gamma times the sum of a_i: the weights have 2 A gamma sum a_i as sum of w r^2."""
        lattice = D * (np.indices((9, 9, 9)).reshape(3, -1).T - 4.0)
        drop = lattice[np.linalg.norm(lattice, axis=1) < 4.1 * D]
        made = scene(1e-6)
        made.add_fluid(drop, radius=D / 2, name="drop", fluid={"stiffness": 0, "viscosity": 0, "damping": 0},
                       surface_tension={"tension": 0.072})
        sim = made.load()
        sim.step()
        slope = np.array([D * np.linalg.norm(gradients(sim.x, i)[0].sum(0)) for i in range(len(drop))])
        t = np.clip((slope - 0.1) / 0.3, 0, 1)
        area = 2 * D ** 2 * (slope * t * t * (3 - 2 * t)).sum()
        energy = sim.constraints["drop", "surface_tension"].energy
        self.assertAlmostEqual(energy / (1.6 * 0.072 * area), 1, 6)


if __name__ == "__main__":
    unittest.main()
