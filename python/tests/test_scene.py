"""Scenes from arrays, files and keys."""
import inspect
import json
import os
import pathlib
import re
import tempfile
import unittest

import numpy as np

import projdyn
from scenes import hanging_sheet, square, tank_of_water

SCENES = pathlib.Path(os.environ["PROJDYN_SOURCE_ROOT"], "scenes")


class Scenes(unittest.TestCase):
    def test_keys(self):
        scene = hanging_sheet(gravity=[0, -1, 0])
        scene["time_step.maximum"] = np.float64(0.002)
        self.assertEqual(scene["time_step"], {"maximum": 0.002})
        self.assertEqual(scene["bodies.sheet.constraints.pin.vertices.vertices.1"], 8)
        self.assertEqual(scene["bodies.0.name"], "sheet")
        self.assertEqual(scene["bodies[0].name"], "sheet")
        with self.assertRaises(KeyError):
            scene["bodies.water"]
        sim = scene.load()
        self.assertEqual(list(sim.gravity), [0, -1, 0])
        self.assertLessEqual(sim.step().h, 0.002)

    def test_methods_have_the_keys_of_the_schema(self):
        text = pathlib.Path(os.environ["PROJDYN_SOURCE_ROOT"], "schema/scene.schema.json").read_text()
        bodies = json.loads(text)["$defs"]
        for body, shape, method in (("body_with_surface", "surface", projdyn.Scene.add_cloth),
                                    ("body_with_volume", "volume", projdyn.Scene.add_soft),
                                    ("body_that_is_rigid", "rigid", projdyn.Scene.add_rigid),
                                    ("body_of_particles", "particles", projdyn.Scene.add_fluid)):
            keys = bodies[body]["properties"]
            wanted = {*keys, *keys[shape]["properties"]} - {shape, "constraints"}
            self.assertEqual(wanted - set(inspect.signature(method).parameters), set(), method)

    def test_ballast(self):
        scene = projdyn.Scene(duration=1)
        scene.add_rigid(box=([0, 0, 0], [1, 1, 1]), mass=2, center_of_mass=[0.5, 0.1, 0.5])
        np.testing.assert_allclose(scene.load().bodies["body0"].position, [0.5, 0.1, 0.5], rtol=0, atol=1e-12)

    def test_a_path_makes_no_body_of_a_misspelt_name(self):
        scene = hanging_sheet()
        before = scene.to_dict()
        with self.assertRaisesRegex(
                projdyn.InputError, r'^bodies\.shet\.surface\.area_density: bodies has no element '
                r'"shet"; did you mean "sheet"\?; known: sheet$'):
            scene["bodies.shet.surface.area_density"] = 1
        with self.assertRaisesRegex(projdyn.InputError, 'no element "ball"; known: none$'):
            scene["solids[ball].sphere.radius"] = 1
        self.assertEqual(scene.to_dict(), before)
        scene["solids.ball"] = {"sphere": {"center": [0, -9, 0], "radius": 1}}
        scene["solids.ball.sphere.radius"] = 2
        scene["probes.0.name"] = "border"
        scene["probes.border.pins"] = "sheet"
        scene["bodies.sheet.constraints.wind.velocity"] = [1, 2, 3]
        sim = scene.load()
        self.assertEqual((list(sim.solids), list(sim.probes)), (["ball"], ["border"]))

    def test_values_are_removed(self):
        scene = hanging_sheet(gravity=[0, -1, 0], contact=None)
        self.assertIn("bodies.sheet.constraints.pin", scene)
        self.assertNotIn("contact", scene)
        self.assertNotIn("bodies.0.constraints.wind", scene)
        self.assertEqual(list(scene)[:2], ["name", "duration"])
        del scene["bodies.sheet.constraints.pin"]
        self.assertNotIn("bodies.sheet.constraints.pin", scene)
        scene["gravity"] = None
        self.assertNotIn("gravity", scene)
        with self.assertRaises(KeyError):
            del scene["gravity"]
        with self.assertRaisesRegex(projdyn.InputError, 'no key "gravity" to remove'):
            scene["gravity"] = None
        scene.add_solid(name="ground", plane={"center": [0, 0, 0], "normal": [0, 1, 0], "size": 1})
        self.assertRegex(repr(scene), "^<scene .*: sheet; solids ground>$")
        del scene["solids.ground"], scene["bodies.sheet"]
        self.assertRegex(repr(scene), "^<scene .*: >$")
        with self.assertRaisesRegex(projdyn.InputError, "at least one body"):
            scene.load()
        sim = projdyn.load(SCENES / "hanging_cloth.json", {"bodies.sheet.constraints.pin": None})
        self.assertNotIn(("sheet", "pin"), sim.constraints)

    def test_all_kinds_of_bodies(self):
        vertices, triangles = square()
        scene = projdyn.Scene(threads=1)
        scene.add_cloth(vertices + [0, 2, 0], triangles, name="sheet", area_density=0.1,
                        triangle={"stretching_stiffness": 10})
        scene.add_soft([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2, 3]], density=500,
                       name="soft", velocity=[1, 0, 0], tet={"stiffness": 1e4})
        scene.add_fluid([[5, 0, 0], [6, 0, 0]], velocities=[[0, 1, 0], [0, 2, 0]], radius=0.1,
                        name="drops", fluid={"sound_speed": 10})
        scene.add_rigid(box=([7, 0, 0], [8, 1, 2]), density=500, name="crate")
        scene.add_rigid([[12, 0, 0], [13, 0, 0], [12, 1, 0], [12, 0, 1]],
                        [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], mass=3, name="stone",
                        velocity=[0, 1, 0])
        scene.add_soft([[15, 0, 0], [16, 0, 0], [15, 1, 0], [15, 0, 1]], name="jelly", cell=0.1,
                       triangles=[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], density=500)
        scene.add_solid([[9, 0, 0], [10, 0, 0], [9, 1, 0]], [[0, 1, 2]], name="wall")
        sim = scene.load()
        self.assertEqual(list(sim.bodies), ["sheet", "soft", "drops", "crate", "stone", "jelly"])
        self.assertGreater(len(sim.bodies["jelly"].tets), 500)
        self.assertEqual(list(sim.solids), ["wall"])
        np.testing.assert_array_equal(sim.bodies["sheet"].x, vertices + [0, 2, 0])
        np.testing.assert_array_equal(sim.bodies["sheet"].triangles, triangles)
        self.assertEqual(sim.bodies["sheet"].edges.shape, (5, 2))
        self.assertEqual(sim.bodies["soft"].tets.shape, (1, 4))
        np.testing.assert_array_equal(sim.bodies["soft"].v, np.tile([1, 0, 0], (4, 1)))
        np.testing.assert_array_equal(sim.bodies["drops"].v, [[0, 1, 0], [0, 2, 0]])
        masses = [body.total_mass for body in sim.bodies.values()]
        self.assertAlmostEqual(masses.pop() / (500 / 6), 1, delta=0.1)
        np.testing.assert_allclose(masses, [0.1, 500 / 6, 2 * 0.2**3 * 1000, 1000, 3])
        np.testing.assert_array_equal(sim.bodies["crate"].x[[0, 1, 2, 4, 7]],
                                      [[7, 0, 0], [8, 0, 0], [7, 1, 0], [7, 0, 2], [8, 1, 2]])
        np.testing.assert_array_equal(sim.bodies["stone"].v, np.tile([0, 1, 0], (4, 1)))

    def test_water_fills_a_mesh_of_arrays(self):
        crate = projdyn.Scene(threads=1)
        crate.add_rigid(box=([0, 0, 0], [0.2, 0.3, 0.4]), density=500, name="crate")
        corners = crate.load().bodies["crate"]
        scene = projdyn.Scene("pool", threads=1)
        scene.add_fluid([[5, 0, 0]], vertices=corners.x, triangles=corners.triangles, radius=0.02,
                        name="water", fluid={"compression": 0.01})
        water = scene.load().bodies["water"]
        self.assertEqual((len(water), water.x[0, 0]), (1 + 5 * 7 * 10, 5))
        self.assertTrue((corners.x.min(axis=0) < water.x[1:]).all() and (water.x[1:] < corners.x.max(axis=0)).all())
        with tempfile.TemporaryDirectory() as folder:
            scene.write(pathlib.Path(folder, "pool.json"))
            self.assertEqual(len(projdyn.load(pathlib.Path(folder, "pool.json")).bodies["water"]), len(water))

    def test_colours(self):
        scene = projdyn.Scene(threads=1)
        scene.add_cloth(grid={"size": [1, 1], "vertices": [2, 2]}, area_density=1, color="#ff0000")
        scene.add_soft(grid={"size": [1, 1, 1], "cells": [1, 1, 1]}, density=500, color="#00ff00")
        scene.add_rigid(box=([7, 0, 0], [8, 1, 2]), density=500, color="#0000ff")
        scene.add_fluid([[5, 0, 0]], radius=0.1, color="#ffffff")
        self.assertEqual([body["color"] for body in scene.to_dict()["bodies"]],
                         ["#ff0000", "#00ff00", "#0000ff", "#ffffff"])

    def test_names_are_given(self):
        vertices, triangles = square()
        scene = projdyn.Scene(threads=1)
        self.assertEqual(scene.add_cloth(vertices, triangles, area_density=1), "body0")
        self.assertEqual(scene.add_cloth(vertices + 2, triangles, area_density=1), "body1")
        self.assertEqual(list(scene.load().bodies), ["body0", "body1"])
        scene["bodies"] = scene["bodies"][1:]  # removes the first one
        self.assertEqual(scene.add_cloth(vertices + 4, triangles, area_density=1), "body2")
        self.assertEqual(list(scene.load().bodies), ["body1", "body2"])
        np.testing.assert_array_equal(scene.load().bodies["body1"].x, vertices + 2)

    def test_several_constraints_of_a_type(self):
        scene = projdyn.Scene(threads=1)
        scene.add_cloth(*square(), name="sheet", area_density=1, spring={"stretching_stiffness": 9},
                        pin=[{"vertices": {"vertices": [0]}}, {"vertices": {"vertices": [1]}}])
        self.assertEqual(list(scene.load().constraints),
                         [("sheet", "spring"), ("sheet", "pin"), ("sheet", "pin", 1)])

    def test_file_with_overrides(self):
        sim = projdyn.load(SCENES / "hanging_cloth.json", {"time_step.fixed": 0.005}, threads=1)
        self.assertEqual(sim.step().h, 0.005)

    def test_empty_scene_with_the_name_of_a_file(self):
        with self.assertRaisesRegex(projdyn.InputError, "a.json: Scene.open reads a file"):
            projdyn.Scene("a.json")

    def test_written_scene_has_the_same_bits(self):
        scene = projdyn.Scene("square", threads=1)
        vertices, triangles = square()
        scene.add_cloth(vertices / 3, triangles, name="sheet", area_density=0.1,
                        spring={"stretching_stiffness": 10}, pin={"vertices": {"vertices": [0]}})
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "square.json")
            scene.write(path)
            self.assertEqual(json.loads(path.read_text()), scene.to_dict())
            read, made = projdyn.load(path, threads=1), scene.load()
        for sim in (read, made):
            sim.step()
        self.assertEqual(read.hash, made.hash)

    def test_a_scene_is_loaded_again(self):
        scene = hanging_sheet()
        first = scene.load()
        scene["bodies.sheet.constraints.spring.stretching_stiffness"] = 5
        second = scene.load()
        for sim in (first, second):
            for _ in range(3):
                sim.step()
        self.assertNotEqual(first.hash, second.hash)

    def test_threads_do_not_change_bits(self):
        hashes = []
        for threads in (1, np.int64(2)):
            sim = tank_of_water(threads=threads).load()
            for _ in range(3):
                sim.step()
            hashes.append(sim.hash)
        self.assertEqual(hashes[0], hashes[1])


class Mistakes(unittest.TestCase):
    def fails(self, text, function, *arguments, **keys):
        with self.assertRaisesRegex(projdyn.InputError, text):
            function(*arguments, **keys)

    def test_scene(self):
        scene = hanging_sheet(durration=3)
        self.fails('durration.*did you mean "duration"', scene.load)
        self.fails("duration: expected a finite number .* found nan", hanging_sheet, duration=float("nan"))
        self.fails("solver.tolerance: expected .* found 1000", hanging_sheet, solver={"tolerance": 10**300})
        self.fails("gravity.1: expected .* found inf", hanging_sheet, gravity=np.array([0, np.inf, 0]))
        self.fails("gravity: expected numbers, found masked", hanging_sheet,
                   gravity=np.ma.masked_array([0, 1, 2], [0, 1, 0]))

    def test_arrays(self):
        vertices, triangles = square()
        scene = projdyn.Scene(threads=1)
        self.fails("vertices: expected the shape n x 3, found 4 x 2", scene.add_cloth,
                   vertices[:, :2], triangles, area_density=1)
        self.fails("triangles: expected whole numbers", scene.add_cloth, vertices,
                   np.array(triangles) + 0.5, area_density=1)
        self.fails("", scene.add_cloth, vertices, np.array(triangles) + 2, area_density=1)
        self.fails("", scene.add_cloth, vertices * np.nan, triangles, area_density=1)
        self.fails("velocities: expected the shape 4 x 3, found 3 x 3", scene.add_fluid, vertices,
                   radius=0.1, velocities=vertices[:3])
        self.fails("box: expected the shape 2 x 3", scene.add_fluid, box=[1, 2], radius=0.1)
        self.fails("spring: expected the parameters", scene.add_cloth, vertices, triangles,
                   area_density=1, spring=3)
        self.fails("^fluit: expected the parameters .{,180} is the name of a constraint$", scene.add_fluid, vertices,
                   radius=0.1, fluit=list(range(1000)))
        self.fails("mesh: expected a file or vertices", scene.add_cloth, vertices, triangles, area_density=1,
                   mesh="a.obj")
        self.fails("velocities: expected them with positions", scene.add_fluid, box=[[0] * 3, [1] * 3], radius=0.1,
                   velocities=vertices)
        self.fails("triangles: expected tets or triangles", scene.add_soft, vertices, [[0, 1, 2, 3]], density=1,
                   triangles=triangles)
        with self.assertRaisesRegex(TypeError, "vertices: expected numbers, found NoneType"):
            scene.add_solid(triangles=triangles, mesh=None)
        self.assertEqual(scene["bodies"], [])

    def test_types(self):
        scene = projdyn.Scene(threads=1)
        for text, call in [("name: expected a text, found int", lambda: projdyn.Scene(3)),
                           ("threads: expected a whole number, found str", lambda: projdyn.Scene(threads="2")),
                           ("path: expected a path, found dict", lambda: projdyn.Scene.open({})),
                           (r"projdyn.load\(path\) loads a file", lambda: projdyn.Scene.load("a.json")),
                           ("path: expected a path, found int", lambda: projdyn.load(3)),
                           ("overrides: expected a dictionary", lambda: projdyn.load("a.json", ["b=3"])),
                           ("path: expected a path, found int", lambda: scene.write(3)),
                           ("path: expected a text, found int", lambda: scene[0]),
                           ("name: expected a text, found int", lambda: scene.add_solid(name=3, plane={})),
                           ("vertices: expected numbers, found str", lambda: scene.add_solid("mesh.ply")),
                           ("fill: expected a list", lambda: scene.add_fluid(radius=1, fill={"box": 1})),
                           ("directory: expected a path, found Scene", lambda: projdyn.render(scene, "x.png")),
                           ("directory: expected a path, found Scene", lambda: projdyn.replay(scene)),
                           ("bodies.0.particles.radius: .* found object", lambda: scene.add_fluid(radius=object())),
                           ("solver: a key: expected a text", lambda: projdyn.Scene(solver={3: 1})),
                           ("size: expected two numbers, found 3", lambda: projdyn.render("o", "x.png", size=3)),
                           ("frames: expected two numbers", lambda: projdyn.render("o", "x.mp4", frames=(1,))),
                           ("camera: expected a path", lambda: projdyn.render("o", "x.png", camera=3)),
                           ("file: expected a path", lambda: projdyn.render("o", 3)),
                           ("file: expected a path", lambda: projdyn.usd("o", 3)),
                           ("allow_plugins: expected True or False", lambda: projdyn.Scene(allow_plugins="no"))]:
            with self.assertRaisesRegex(TypeError, text):
                call()

    def test_attributes(self):
        with self.assertRaisesRegex(AttributeError, r'gravity: .*: scene\["gravity"\] = ...'):
            projdyn.Scene(threads=1).gravity = [0, 0, 0]

    def test_a_failed_body_leaves_nothing(self):
        """Neither an element nor arrays: those of the sheet of this name stay."""
        vertices, triangles = square()
        scene = projdyn.Scene(threads=1)
        scene.add_cloth(vertices, triangles, name="sheet", area_density=1, spring={"stretching_stiffness": 10})
        scene.add_solid(vertices, triangles, name="wall")
        before = scene.to_text()
        for text, keys in [('name: "sheet" is already taken', {"area_density": 1, "name": "sheet"}),
                           ('name: "wall" is already taken', {"area_density": 1, "name": "wall"}),
                           ("spring: expected the parameters", {"area_density": 1, "spring": 3}),
                           ("bodies.1.surface.area_density: expected .* found nan", {"area_density": float("nan")})]:
            self.fails(text, scene.add_cloth, 2 * vertices, triangles, **{"name": "other", **keys})
        self.assertEqual(scene.to_text(), before)
        np.testing.assert_array_equal(scene.load().bodies["sheet"].x, vertices)
        with tempfile.TemporaryDirectory() as directory:
            scene.write(pathlib.Path(directory, "scene.json"))
            files = sorted(re.sub("-[0-9a-f]{12}", "", file) for file in os.listdir(directory))
            self.assertEqual(files, ["scene.json", "sheet.ply", "wall.ply"])

    def test_files_of_arrays(self):
        """Scenes in one folder keep their arrays, and so do files of the user."""
        vertices, triangles = square()
        with tempfile.TemporaryDirectory() as directory:
            own = pathlib.Path(directory, "sheet.ply")
            own.write_text("a file of the user")
            for size in (1, 2):
                scene = projdyn.Scene(threads=1)
                scene.add_cloth(size * vertices, triangles, name="sheet", area_density=1)
                scene.write(pathlib.Path(directory, f"{size}.json"))
            for size in (1, 2):
                sim = projdyn.load(pathlib.Path(directory, f"{size}.json"))
                np.testing.assert_array_equal(sim.bodies["sheet"].rest, size * vertices)
            self.assertEqual(own.read_text(), "a file of the user")

    def test_nul(self):
        """A text of C ends there: the rest would be left out."""
        scene = hanging_sheet()
        self.fails("path: .* no NUL", scene.__setitem__, "duration\0s", 3)
        self.fails("path: .* no NUL", projdyn.load, "a.json\0b")
        self.fails("a key: .* no NUL", projdyn.load, "a.json", {"duration\0s": 3})
        self.fails("name: .* no NUL", scene.add_solid, name="a\0b")
        self.assertEqual(scene["duration"], hanging_sheet()["duration"])

    def test_files(self):
        with self.assertRaisesRegex(projdyn.Error, "no_such.json"):
            projdyn.load("no_such.json")

    def test_plugins_are_refused(self):
        self.fails("plug-in", hanging_sheet(plugins=["./some.so"]).load)

    def test_threads(self):
        self.fails("expected 0 to 1024, found -1", projdyn.Scene, threads=-1)
        self.fails("expected 0 to 1024, found 2147483647", projdyn.Scene, threads=2**32 + 1)
        with self.assertRaisesRegex(TypeError, "threads: expected a whole number, found float"):
            projdyn.Scene(threads=1.5)


if __name__ == "__main__":
    unittest.main()
