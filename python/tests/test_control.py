"""Changes between two steps."""
import os
import pathlib
import re
import tempfile
import unittest

import numpy as np

import projdyn
from scenes import hanging_sheet


def steps(sim, count):
    for _ in range(count):
        sim.step()


class Control(unittest.TestCase):
    def test_forces_carry_the_weight(self):
        sim = hanging_sheet().load()
        sheet = sim.bodies["sheet"]
        sheet.set_forces(9.81 * sheet.mass[:, None] * [0, 1, 0])
        steps(sim, 20)
        np.testing.assert_allclose(sheet.x, sheet.rest, atol=1e-9)
        sheet.add_forces(sheet.mass[:, None] * [0, 1, 0])
        steps(sim, 20)
        self.assertGreater(sheet.x[40, 1], 1e-3)
        sheet.set_forces(None)
        sheet.set_velocities([0, 0, 0])
        steps(sim, 60)
        self.assertLess(sheet.x[40, 1], -1e-3)

    def test_force_on_few_vertices_in_a_long_step(self):
        scene = projdyn.Scene(threads=1, duration=6, frame_interval=1, gravity=[0, 0, 0],
                              time_step={"fixed": 1, "integrator": "euler"}, solver={"tolerance": 0.01})
        foot = {"box": {"minimum": [-1, -1, -1], "maximum": [1, -0.249, 1]}}
        scene.add_soft(grid={"size": [0.1, 0.5, 0.1], "cells": [2, 10, 2]}, name="bar", density=1000,
                       tet={"stiffness": 1e5}, pin={"vertices": foot})
        sim = scene.load()
        bar = sim.bodies["bar"]
        top = bar.rest[:, 1] > 0.249
        bar.set_forces(np.outer(top, [0, 10 / top.sum(), 0]))  # 1 % of strain
        self.assertLessEqual(sim.step().outer_iterations, 20)
        steps(sim, 5)
        self.assertAlmostEqual((bar.x - bar.rest)[top, 1].mean(), 0.005, delta=0.0002)

    def test_the_second_of_two_bodies(self):
        scene = projdyn.Scene(threads=1, gravity=[0, 0, 0])
        for name, y in (("first", 0), ("second", 1)):
            scene.add_cloth(grid={"size": [1, 1], "vertices": [3, 3]}, translate=[0, y, 0],
                            name=name, area_density=1, spring={"stretching_stiffness": 10})
        sim = scene.load()
        first, second = sim.bodies["first"], sim.bodies["second"]
        self.assertEqual(second.particles, slice(9, 18))
        np.testing.assert_array_equal(sim.x[second.particles], second.x)
        second.set_forces([0, 0.01, 0])
        second.add_forces([0, 0.02, 0])
        sim.step()
        self.assertTrue((second.v[:, 1] > 0).all())
        second.set_forces(None)
        second.set_velocities([0, 0, 0])
        second.set_positions(second.rest)
        second.hold(4, [0, 1.5, 0], stiffness=10)
        sim.step()
        self.assertEqual(second.v[:, 1].argmax(), 4)
        second.release(4)
        np.testing.assert_allclose(first.x, first.rest, atol=1e-12)
        sim.constraints["second", "spring"]["stretching_stiffness"] = 20
        self.assertEqual(sim.constraints["first", "spring"]["stretching_stiffness"], 10)

    def test_hold_several(self):
        """An animated surface: all of its vertices are held, and follow."""
        sim = hanging_sheet().load()
        sheet = sim.bodies["sheet"]
        for k in range(40):
            target = sheet.rest + [0, 0.1 * min(1, k / 20), 0]
            sheet.hold(np.arange(len(sheet)), target, stiffness=1e5)
            sim.step()
        np.testing.assert_allclose(sheet.x[9:], target[9:], atol=1e-3)  # pins hold the first row, too
        sheet.release(np.arange(len(sheet)))
        for _ in sim.run(until=sim.time + 0.2):
            pass
        self.assertLess(sheet.x[80, 1], target[80, 1] - 0.05)
        with self.assertRaisesRegex(projdyn.InputError, "target: expected the shape 2 x 3, found 3"):
            sheet.hold([1, 2], [0, 0, 0])

    def test_hold_all_or_none(self):
        """A wrong target among several: none of the vertices is held."""
        sims = [hanging_sheet().load() for _ in range(2)]
        for wrong in (np.nan, 1e7):
            with self.assertRaisesRegex(projdyn.InputError, "expected a target from"):
                sims[0].bodies["sheet"].hold([70, 80], [[0, 9, 0], [0, wrong, 0]])
        sims[0].bodies["sheet"].hold([], np.zeros((0, 3)))
        for sim in sims:
            sim.step()
        np.testing.assert_array_equal(sims[0].bodies["sheet"].x, sims[1].bodies["sheet"].x)

    def test_animated_character(self):
        """The recipe in docs/guide/recipes.md: the character follows, without warnings."""
        page = pathlib.Path(os.environ["PROJDYN_SOURCE_ROOT"], "docs/guide/recipes.md").read_text()
        recipe = {}
        exec(re.search("## Animated character.*?```python\n(.*?)```", page, re.S)[1], recipe)
        scene = projdyn.Scene(duration=0.1, frame_interval=0.02, threads=1, time_step={"fixed": 0.002})
        with tempfile.TemporaryDirectory() as folder:
            mesh = pathlib.Path(folder, "square.obj")
            mesh.write_text("v 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\nf 1 3 2\nf 2 3 4\n")
            name = recipe["add_character"](scene, mesh)
            sim = scene.load()
            body = sim.bodies[name]
            recipe["follow"](sim, name, lambda time: body.rest * [1 + time, 1, 1], folder)
            self.assertTrue(pathlib.Path(folder, "character_000005.vtk").exists())
        self.assertEqual(sim.warnings, [])
        np.testing.assert_allclose(body.x, body.rest * [1.1, 1, 1], atol=0.01)

    def test_wrong_numbers(self):
        sim = hanging_sheet().load()
        sheet, spring = sim.bodies["sheet"], sim.constraints["sheet", "spring"]
        for text, call, arguments in (
                ("a step from 1e-09 to 1000 s, found 0 s", sim.step, [0]),
                ("a step from .*, found nan s", sim.step, [np.nan]),
                ("h: expected one number, found 2 numbers", sim.step, [[0.1, 0.2]]),
                ("h: a number is too large", sim.step, [10**400]),
                ("forces: expected the shape 81 x 3, found one number", sheet.set_forces, [3]),
                ("forces: .* found rows of different lengths", sheet.set_forces, [[[1, 2], [3]]]),
                ("damping: .* found rows of different lengths", spring.__setitem__, ["damping", [[1, 2], [3]]]),
                ("velocities: expected numbers, found masked", sheet.set_velocities,
                 [np.ma.masked_array([1, 2, 3], [0, 1, 0])]),
                ("vertex: .* found 2 dimensions", sheet.release, [[[1, 2]]]),
                ("a vertex from 0 to 80, found 81", sheet.hold, [81, [0, 0, 0]]),
                ("a vertex from 0 to 80, found -1", sheet.release, [-1])):
            with self.assertRaisesRegex(projdyn.InputError, text):
                call(*arguments)
        for text, call, arguments in (
                ("h: expected numbers, found str", sim.step, ["fast"]),
                ("name: expected a text, found int", spring.__setitem__, [0, 1]),
                ("damping: expected numbers, found str$", spring.__setitem__, ["damping", "strong"]),
                ("damping: expected numbers, found bool$", spring.__setitem__, ["damping", True]),
                ("damping: expected numbers, found list with str$", spring.__setitem__, ["damping", [1, "2"]]),
                ("forces: expected numbers, found ndarray of bool$", sheet.set_forces, [sheet.x > 0]),
                ("forces: expected numbers, found ndarray of object$", sheet.set_forces,
                 [np.array([1, "2", 3], object)]),
                ("enabled: expected True or False, found str", spring.__class__.enabled.fset, [spring, "no"]),
                ("vertex: expected a whole number, .* found float", sheet.hold, [1.5, [0, 0, 0]]),
                ("vertex: expected numbers, found str$", sheet.release, ["two"]),
                ("stiffness: expected numbers, found str", sheet.hold, [1, [0, 0, 0], "soft"])):
            with self.assertRaisesRegex(TypeError, text):
                call(*arguments)

    def test_one_force_for_all(self):
        sims = [hanging_sheet().load() for _ in range(2)]
        sims[0].bodies["sheet"].set_forces([0, 0, 0.01])
        sims[1].bodies["sheet"].set_forces(np.tile([0, 0, 0.01], (81, 1)))
        for sim in sims:
            steps(sim, 3)
        self.assertEqual(sims[0].hash, sims[1].hash)

    def test_positions_and_velocities(self):
        sim = hanging_sheet().load()
        sheet = sim.bodies["sheet"]
        with self.assertRaises(projdyn.InputError):
            sheet.set_positions([0, 1, 0])  # not one point for all
        sheet.set_positions(sheet.rest + [0, 1, 0])
        sheet.set_velocities(np.zeros((81, 3)) + [1, 2, 3])
        np.testing.assert_array_equal(sheet.x, sheet.rest + [0, 1, 0])
        np.testing.assert_array_equal(sheet.v[17], [1, 2, 3])

    def test_a_held_vertex_reaches_its_target_and_falls(self):
        sim = hanging_sheet().load()
        sheet, corner = sim.bodies["sheet"], 80
        start, end = sheet.x[corner].copy(), sheet.x[corner] + [-0.1, 0.2, -0.1]
        for k in range(100):
            sheet.hold(corner, start + min(1, k / 50) * (end - start), stiffness=1e5)
            sim.step()
        self.assertLess(np.linalg.norm(sheet.x[corner] - end), 1e-3)
        sheet.release(corner)
        for _ in sim.run(until=sim.time + 0.2):
            pass
        self.assertLess(sheet.x[corner, 1], end[1] - 0.1)

    def test_gravity(self):
        sim = hanging_sheet().load()
        sim.gravity = [0, 0, 0]
        steps(sim, 3)
        np.testing.assert_array_equal(sim.bodies["sheet"].x, sim.bodies["sheet"].rest)
        with self.assertRaises(ValueError):
            sim.gravity[0] = 1  # a copy

    def test_a_parameter_has_the_bits_of_a_restored_state(self):
        scene = hanging_sheet()
        sim, other = scene.load(), scene.load()
        steps(sim, 10)
        sim.constraints["sheet", "spring"]["stretching_stiffness"] = 50
        self.assertEqual(sim.constraints["sheet", "spring"]["stretching_stiffness"], 50)
        with tempfile.TemporaryDirectory() as folder:
            sim.save(pathlib.Path(folder, "state"))
            other.restore(pathlib.Path(folder, "state"))
        self.assertEqual(other.constraints["sheet", "spring"]["stretching_stiffness"], 50)
        steps(sim, 20)
        steps(other, 20)
        self.assertEqual(sim.hash, other.hash)
        unchanged = scene.load()
        steps(unchanged, 30)
        self.assertNotEqual(sim.hash, unchanged.hash)

    def test_parameters(self):
        spring = hanging_sheet().load().constraints["sheet", "spring"]
        stiffness = spring.parameters["stretching_stiffness"]
        self.assertEqual((stiffness.value, stiffness.unit, stiffness.changeable), (500, "N/m", True))
        with self.assertRaisesRegex(KeyError, "stretching_stiffness"):
            spring["stiffness"]
        with self.assertRaises(projdyn.InputError):
            spring["stretching_stiffness"] = -1
        self.assertEqual(spring["stretching_stiffness"], 500)
        with self.assertRaisesRegex(AttributeError, 'items: \\["stretching_stiffness"\\]'):
            spring.stretching_stiffness
        self.assertEqual(dict(spring), {"stretching_stiffness": 500, "damping": 0})
        self.assertEqual(list(spring), ["stretching_stiffness", "damping"])

    def test_plugins_without_permission(self):
        scene = projdyn.Scene(threads=1, plugins=[os.environ["PROJDYN_MUSCLE"]])
        with self.assertRaisesRegex(projdyn.InputError, "allow_plugins=True in Python"):
            scene.load()

    def test_tables(self):
        scene = projdyn.Scene(threads=1, plugins=[os.environ["PROJDYN_MUSCLE"]],
                              allow_plugins=True, gravity=[0, 0, 0])
        fibre = np.tile([1.0, 0, 0], (6, 1))
        fibre[4] = 0
        scene.add_soft(grid={"size": [1, 1, 1], "cells": [1, 1, 1]}, density=1000, name="cube",
                       tet={"stiffness": 1e4}, muscle={"fibre": fibre, "stiffness": 1e4})
        muscle = scene.load().constraints["cube", "muscle"]
        np.testing.assert_array_equal(muscle["fibre"], fibre)
        fibre[2] = [0, 1, 0]
        muscle["fibre"] = fibre
        np.testing.assert_array_equal(muscle["fibre"], fibre)
        muscle["fibre"] = [0, 0, 2]
        np.testing.assert_array_equal(muscle["fibre"], np.tile([0.0, 0, 2], (6, 1)))
        with self.assertRaisesRegex(projdyn.InputError, "6 rows of 3 numbers, one per tetra"):
            muscle["fibre"] = fibre[:5]
        for wrong in (fibre.T, fibre.reshape(9, 2), fibre.reshape(2, 3, 3)):
            with self.assertRaisesRegex(projdyn.InputError, "fibre: expected the shape n x 3, found "):
                muscle["fibre"] = wrong
        muscle["fibre"] = [[0, 1, 0]]
        np.testing.assert_array_equal(muscle["fibre"], np.tile([0.0, 1, 0], (6, 1)))

    def test_vectors_and_paths(self):
        scene = hanging_sheet()
        scene["bodies.sheet.constraints.wind.velocity"] = [1, 2, 3]
        sim = scene.load()
        wind, pin = sim.constraints["sheet", "wind"], sim.constraints["sheet", "pin"]
        self.assertEqual(list(wind["velocity"]), [1, 2, 3])
        wind["velocity"] = [4, 5, 6]
        self.assertEqual(list(wind["velocity"]), [4, 5, 6])
        self.assertEqual(pin["path"].shape, (0, 4))
        pin["path"] = [[0, 0, 0, 0], [1, 0, 0.5, 0]]
        np.testing.assert_array_equal(pin["path"], [[0, 0, 0, 0], [1, 0, 0.5, 0]])
        with self.assertRaisesRegex(KeyError, "velocity"):
            wind["velocty"]

    def test_a_pin_is_switched_off(self):
        sim = hanging_sheet().load()
        pin = sim.constraints["sheet", "pin"]
        self.assertTrue(pin.enabled)
        pin.enabled = False
        self.assertFalse(pin.enabled)
        for _ in sim.run(until=0.2):
            pass
        self.assertAlmostEqual(sim.bodies["sheet"].x[0, 1], -0.5 * 9.81 * 0.2**2, delta=0.01)

    def test_a_solid_moves(self):
        scene = projdyn.Scene(threads=1, gravity=[0, 0, 0], contact={"thickness": 0.01})
        scene.add_cloth(grid={"size": [0.4, 0.4], "vertices": [9, 9]}, name="sheet",
                        area_density=0.2, spring={"stretching_stiffness": 500},
                        bending={"bending_rigidity": 1e-3})
        scene.add_solid(name="plate", box=([-1, -0.2, -1], [1, -0.05, 1]), motion=[{"time": 0}], pivot=[0.5, 0, 0])
        scene.add_solid(name="floor", plane={"center": [0, -1, 0], "size": 1, "normal": [0, 1, 0]})
        sim = scene.load()
        plate = sim.solids["plate"]
        plate.move(0.2, translate=[0, 0.1, 0])
        sim.step()
        np.testing.assert_allclose(plate.pose.translate, [0, 0.5 * sim.time, 0], atol=1e-15)
        for _ in sim.run(until=0.3):
            pass
        np.testing.assert_allclose(plate.pose, [[0, 0.1, 0], [0, 0, 0]], atol=1e-15)
        plate.move(sim.time + 0.001, rotate=[10, 20, 30])
        sim.step(h=0.001)
        np.testing.assert_allclose(plate.pose.rotate, [10, 20, 30], atol=1e-12)
        np.testing.assert_array_equal(sim.solids["floor"].pose, np.zeros((2, 3)))
        np.testing.assert_allclose(np.unique(sim.solids["floor"].vertices, axis=0),
                                   [[x, -1, z] for x in (-0.5, 0.5) for z in (-0.5, 0.5)])
        corners = sim.solids["floor"].vertices[sim.solids["floor"].triangles]
        np.testing.assert_allclose(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]),
                                   [[0, 1, 0], [0, 1, 0]])
        turned = plate.vertices - plate.vertices.mean(0)
        np.testing.assert_allclose(np.linalg.norm(turned, axis=1), np.linalg.norm([1, 0.075, 1]))
        self.assertEqual(plate.triangles.shape, (12, 3))
        self.assertGreater(sim.bodies["sheet"].x[:, 1].min(), 0.05)

    def test_an_inlet_opens_moves_and_shuts(self):
        scene = projdyn.Scene(threads=1, gravity=[0, 0, 0])
        scene.add_fluid(name="jet", radius=0.01, budget=2000, fluid={"sound_speed": 20}, inlets=[
            {"rectangle": {"center": [0, 0, 0], "size": [0.06, 0.06]}, "direction": [1, 0, 0],
             "speed": [{"time": 0, "speed": 0}], "motion": [{"time": 0}]}])
        sim = scene.load()
        jet = sim.bodies["jet"]
        inlet, = jet.inlets
        inlet.set_speed(2)
        for _ in sim.run(until=0.1):
            pass
        inlet.move(0.2, translate=[0, 0.05, 0])
        inlet.set_speed(0, time=0.2)
        for info in sim.run(until=0.4):
            pass
        self.assertEqual(info.particles, 9 * (2 + 0.3 / 0.02))
        x = jet.x[jet.live]
        self.assertAlmostEqual(jet.total_mass, info.particles * 1000 * 0.02**3)  # not the budget's
        self.assertAlmostEqual(x[x[:, 0] < 0.011, 1].mean(), 0.05)  # the plug in the opening
        with self.assertRaisesRegex(projdyn.InputError, "inlet 0 of body \"jet\": expected a speed"):
            inlet.set_speed(-1)

    def test_what_cannot_be_assigned(self):
        sim = hanging_sheet().load()
        spring = sim.constraints["sheet", "spring"]
        for thing, name, way in ((sim.bodies["sheet"], "x", "such as .*set_positions"),
                                 (sim.bodies["sheet"], "forces", "such as .*set_forces"),
                                 (sim, "graviti", "methods"), (sim, "time", "methods"),
                                 (spring, "stretching_stiffness", "items: .\"stretching_stiffness\"")):
            with self.assertRaisesRegex(AttributeError, f"{name} of .* cannot be assigned: .*{way}"):
                setattr(thing, name, 0)

    def test_mistakes(self):
        sheet = hanging_sheet().load().bodies["sheet"]
        with self.assertRaises(AttributeError):  # hold and pin do it
            sheet.fix()
        with self.assertRaisesRegex(projdyn.InputError, "forces: expected the shape 81 x 3"):
            sheet.set_forces(np.zeros((80, 3)))
        with self.assertRaises(projdyn.Error):
            sheet.set_forces([np.nan, 0, 0])
        with self.assertRaisesRegex(projdyn.InputError, "vertex from 0 to 80, found 81"):
            sheet.hold(81, [0, 0, 0])
        with self.assertRaisesRegex(projdyn.InputError, "target: expected the shape 3"):
            sheet.hold(1, 7)
        with self.assertRaises(projdyn.Error):
            sheet.hold(1, [0, np.inf, 0])


if __name__ == "__main__":
    unittest.main()
