"""Scenes of SPlisHSPlasH: particles, places, rotations, and what is left out."""
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import projdyn
from projdyn import splishsplash

TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
SCENE = {
    "Configuration": {"particleRadius": 0.025, "gravitation": [0, -9, 0], "stopAt": 2},
    "Materials": [{"id": "Oil", "density0": 900, "viscosityMethod": 1}],
    "FluidBlocks": [{"id": "Oil", "start": [0, 0, 0], "end": [0.5, 0.5, 0.25], "scale": [1, 2, 1],
                     "translation": [0.1, 0, 0], "initialVelocity": [1, 0, 0]}],
    "Emitters": [{"id": "Oil", "width": 4, "height": 2, "translation": [0.5, 1.5, 0],
                  "rotationAxis": [0, 0, 1], "rotationAngle": -math.pi / 2, "velocity": 2,
                  "emitStartTime": 0.5, "emitEndTime": 1.5}],
    "RigidBodies": [
        {"geometryFile": "UnitBox.obj", "scale": [2, 4, 2], "translation": [0.5, 2, 0], "isWall": True},
        {"geometryFile": "rock.obj", "translation": [3, 0, 0], "rotationAxis": [1, 2, 3],
         "rotationAngle": 0.7, "scale": [0.5, 0.5, 0.5]},
        {"geometryFile": "rock.obj", "translation": [0.2, 2, -0.2], "isDynamic": True, "density": 300}],
}


def turned(angles):
    """The matrix of angles, degrees, about x, then y, then z."""
    (a, b, c), eye = np.radians(angles), np.eye(3)

    def about(axis, angle):
        k, m = (axis + 1) % 3, (axis + 2) % 3
        matrix = eye.copy()
        matrix[k, k] = matrix[m, m] = math.cos(angle)
        matrix[m, k], matrix[k, m] = math.sin(angle), -math.sin(angle)
        return matrix

    return about(2, c) @ about(1, b) @ about(0, a)


class SplishSplash(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = pathlib.Path(self.folder.name) / "scene.json"
        self.path.write_text(json.dumps(SCENE))
        (self.path.parent / "rock.obj").write_text(TETRAHEDRON)
        (self.path.parent / "UnitBox.obj").write_text(TETRAHEDRON)  # only its name counts

    def convert(self, *options):
        return subprocess.run([sys.executable, "-m", "projdyn.splishsplash", *options],
                              capture_output=True, text=True, check=False)

    def test_converts(self):
        out = self.path.parent / "converted.json"
        done = self.convert(str(self.path), "-o", str(out))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("Oil: viscosity is left out", done.stderr)
        self.assertNotIn("tension", done.stderr)
        scene = json.loads(out.read_text())
        self.assertEqual(scene["gravity"], [0, -9, 0])
        sim = projdyn.load(out)
        self.assertEqual(list(sim.bodies), ["Oil", "rigid2"])
        oil, tank = sim.bodies["Oil"].x, scene["solids"][0]["box"]
        block = oil[:9 * 19 * 4]  # then those of the emitter
        np.testing.assert_allclose(block.min(0), [0.15, 0.05, 0.05], atol=1e-9)
        np.testing.assert_allclose(block.max(0), [0.55, 0.95, 0.2], atol=1e-9)
        np.testing.assert_allclose(tank["maximum"], [1.5, 4, 1])
        inlet, = scene["bodies"][0]["particles"]["inlets"]
        np.testing.assert_allclose(inlet["direction"], [0, -1, 0], atol=1e-12)
        np.testing.assert_allclose(inlet["up"], [1, 0, 0], atol=1e-12)
        self.assertEqual((inlet["start"], inlet["duration"]), (0.5, 1))
        np.testing.assert_allclose(inlet["rectangle"]["size"], [0.2, 0.1])
        self.assertAlmostEqual(sim.bodies["rigid2"].total_mass / 50, 1, delta=0.12)

    def test_old_scenes(self):
        """Materials in "Configuration", emitters with a direction, boxes without a file."""
        old = {"Configuration": {"particleRadius": 0.1, "density0": 800, "viscosity": 5,
                                 "maxEmitterParticles": 70, "emitterReuseParticles": True,
                                 "emitterBoxMin": [-5, -5, -5], "emitterBoxMax": [5, 5, 5]},
               "Emitters": [{"type": 1, "width": 4, "height": 2, "translation": [0, 1, 0],
                             "direction": [0, -1, 0], "velocity": [0, -3, 0]}],
               "RigidBodies": [{"geometryFile": "no/UnitBoxOpened.obj", "scale": [4, 4, 4]},
                               {"geometryFile": "rock.obj", "isDynamic": 1, "velocity": [1, 0, 0],
                                "translation": [3, 0, 0], "scale": [2, 2, 2]}],
               "TargetVelocityMotorHingeJoints": [], "Simulation": {}}
        self.path.write_text(json.dumps(old))
        out = self.path.parent / "converted.json"
        done = self.convert(str(self.path), "-o", str(out))
        scene = json.loads(out.read_text())
        water = scene["bodies"][0]["particles"]
        self.assertEqual((water["rest_density"], water["budget"]), (800, 70))
        self.assertEqual((water["inlets"][0]["direction"], water["inlets"][0]["speed"]), ([0, -3, 0], 3))
        self.assertEqual(water["inlets"][0]["disc"], {"center": [0, 1, 0], "radius": 0.4})
        self.assertEqual(scene["solids"][0]["open"], ["+y"])
        self.assertEqual(scene["outlets"], [{"outside": True, "box": {"minimum": [-5, -5, -5],
                                                                       "maximum": [5, 5, 5]}}])
        for text in ("Fluid: viscosity is left out", "MotorHingeJoints: left out"):
            self.assertIn(text, done.stderr)
        for text in ("Simulation", "UnitBox", "tension", "elastic"):
            self.assertNotIn(text, done.stderr)
        self.assertEqual(projdyn.load(out).bodies["rigid1"].velocity[0], 1)

    def test_left_out(self):
        converter = splishsplash.Converter({
            "Configuration": {"sim2D": True},
            "Materials": [{"id": "Jelly", "elasticityMethod": 3, "surfaceTensionMethod": 0,
                           "surfaceTension": 0.2, "vorticityMethod": 1, "dragMethod": 2}],
            "FluidBlocks": [{"id": "Jelly", "start": [0, 0, 0], "end": [1, 1, 1],
                             "initialAngularVelocity": [0, 0, 1]}],
            "RigidBodies": [{"geometryFile": "UnitBox.obj", "isAnimated": True}],
            "AnimationFields": []}, "")
        converter.convert()
        notes = "\n".join(converter.notes)
        for text in ("Jelly: elasticity is left out", "vorticity", "drag", "initialAngularVelocity",
                     "UnitBox.obj: the motion", "AnimationFields: left out", "two dimensions"):
            self.assertIn(text, notes)
        self.assertNotIn("tension", notes)

    def test_rotations(self):
        for axis, angle in (([1, 2, 3], 0.7), ([0, 1, 0], math.pi / 2), ([0, -1, 0], 2),
                            ([1, 1, 0], math.pi), ([0, 1, 0], -math.pi / 2)):
            matrix = splishsplash.rotation({"rotationAxis": axis, "rotationAngle": angle})
            np.testing.assert_allclose(np.array(matrix) @ axis, axis, atol=1e-12)
            self.assertAlmostEqual(np.trace(matrix), 1 + 2 * math.cos(angle))
            np.testing.assert_allclose(turned(splishsplash.euler(matrix)), matrix, atol=1e-8)
        for angles in ([40, 90, 0], [40, -90, 10]):  # x and z turn about one axis
            matrix = turned(angles)
            np.testing.assert_allclose(turned(splishsplash.euler(matrix.tolist())), matrix, atol=1e-8)

    def test_errors(self):
        with self.assertRaisesRegex(projdyn.InputError, "python3 -m projdyn.splishsplash"):
            projdyn.load(self.path)
        self.path.write_text('{"FluidBlocks": [{"start": [0, 0, 0]}]}')
        for path, text in ((self.path, "KeyError: 'end'"), (self.path.parent / "no", "No such file")):
            done = self.convert(str(path))
            self.assertEqual(done.returncode, 2)
            self.assertIn(text, done.stderr)
        self.path.write_text('{"duration": 1, "bodies": []}')
        done = self.convert(str(self.path))
        self.assertEqual(done.returncode, 2)
        self.assertIn("expected a scene of SPlisHSPlasH, found none of its keys", done.stderr)
        self.path.write_text('{"Configuration": {"dataExportFPS": 0}}')
        self.assertIn("ZeroDivisionError", self.convert(str(self.path)).stderr.splitlines()[0])
        self.path.write_text(json.dumps({**SCENE, "RigidBodies": [{"geometryFile": "far.obj"}]}))
        self.assertIn("--models names the folder", self.convert(str(self.path)).stderr)


if __name__ == "__main__":
    unittest.main()
