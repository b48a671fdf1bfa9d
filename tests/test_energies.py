"""The energy columns of metrics.csv against energies computed by hand.

Usage: test_energies.py PROJDYN SCENE.json"""
import csv
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

G = 9.81  # m/s^2
DENSITY = 0.3  # kg/m^2


def pin(vertices, stiffness, **more):
    return {"type": "pin", "vertices": {"vertices": vertices}, "stiffness": stiffness, **more}


def sheet(vertices, *constraints, **more):
    """A scene with a horizontal sheet of 1 m x 1 m."""
    grid = {"size": [1, 1], "vertices": [vertices, vertices]}
    return {"gravity": [0, -G, 0], "duration": 1e3, "frame_interval": 1e3, **more,
            "bodies": [{"name": "sheet", "constraints": constraints,
                        "surface": {"grid": grid, "area_density": DENSITY}}]}


class Energies(unittest.TestCase):
    def rows(self, scene, *options):
        """The rows of metrics.csv of a run; the energies are among their keys."""
        with tempfile.TemporaryDirectory() as name:
            if isinstance(scene, dict):
                path = pathlib.Path(name, "scene.json")
                path.write_text(json.dumps(scene))
                scene = path
            done = subprocess.run([PROJDYN, "run", scene, "-o", name + "/run", "--quiet", "--no-frames", *options],
                                  capture_output=True, text=True, timeout=300)
            self.assertEqual(done.returncode, 0, done.stderr)
            with open(name + "/run/metrics.csv", newline="", encoding="utf-8") as file:
                return list(csv.DictReader(file))

    def at_rest(self, *constraints):
        """The energies of a sheet of four vertices that has come to rest."""
        scene = sheet(2, *constraints, time_step={"fixed": 1, "integrator": "euler"}, solver={"tolerance": 1e-9})
        last = self.rows(scene, "--time", "50")[-1]
        self.assertLess(float(last["kinetic_J"]), 1e-15)
        return energies(last)

    def test_pins(self):
        """A vertex of mass m that hangs from a pin of stiffness k: (m g)^2 / (2 k). Vertices on the
        diagonal have two of the six thirds of triangles, the others one."""
        found = self.at_rest(pin([0, 1], 100), pin([2, 3], 300))
        squares = ((DENSITY / 3) ** 2 + (DENSITY / 6) ** 2) * G ** 2
        self.assertEqual(list(found), ["energy_sheet.pin_J", "energy_sheet.pin.1_J"])
        self.assertAlmostEqual(found["energy_sheet.pin_J"], squares / 200, delta=1e-7 * squares / 200)
        self.assertAlmostEqual(found["energy_sheet.pin.1_J"], squares / 600, delta=1e-7 * squares / 600)

    def test_springs(self):
        """A square that pins stretch by 0.1 m: of its edges two have 0.1 m more, the diagonal is longer,
        too. The weight of an edge is 3 Y A / (l1^2 + l2^2 + l3^2) in each triangle."""
        Y = 1000
        found = self.at_rest({"type": "spring", "stretching_stiffness": Y}, pin([0, 2], 1e12),
                             pin([1, 3], 1e12, path=[[0, 0, 0, 0], [1, 0.1, 0, 0]]))
        w = 3 * Y * 0.5 / (1 + 1 + 2)
        expected = 2 * w / 2 * 0.1 ** 2 + 2 * w / 2 * (math.hypot(1.1, 1) - math.sqrt(2)) ** 2
        self.assertEqual(list(found)[0], "energy_sheet.spring_J")
        self.assertAlmostEqual(found["energy_sheet.spring_J"], expected, delta=1e-7 * expected)

    def test_balance(self):
        """A cloth that falls into its pins and swings: gravity, motion and constraints exchange energy."""
        scene = sheet(9, {"type": "spring", "stretching_stiffness": 20}, {"type": "bending", "bending_rigidity": 0.1},
                      pin([0, 8], 100), time_step={"fixed": 5e-4}, solver={"tolerance": 1e-5})
        rows = self.rows(scene, "--time", "0.6")
        for name in energies(rows[0]):
            self.assertGreater(max(energies(row)[name] for row in rows), 0.1)
        for row in rows:  # at the start it is 0
            total = float(row["kinetic_J"]) + float(row["potential_J"]) + sum(energies(row).values())
            self.assertAlmostEqual(total, 0, delta=1e-4)

    def test_sum(self):
        """The energies sum to constraint_J, without that of wind, which dissipates; the columns have the same
        bits for any number of threads."""
        scene = json.loads(pathlib.Path(SCENE).read_text())
        scene["contact"] = {"thickness": 0.01}
        scene["solids"].append({"name": "ball", "sphere": {"center": [0, 0.38, 0], "radius": 0.1}})
        scene["bodies"][1]["constraints"].append({"type": "wind", "velocity": [1, 0, 0]})
        rows = self.rows(scene, "--threads", "1")
        names = ["energy_water.fluid_J", "energy_sheet.spring_J", "energy_sheet.bending_J", "energy_sheet.pin_J",
                 "energy_contact_J"]
        self.assertEqual(list(energies(rows[0])), names)
        for row in rows:
            found = sum(energies(row).values())
            self.assertAlmostEqual(float(row["constraint_J"]), found, delta=1e-8 * found)
        for name in names:
            self.assertGreater(max(energies(row)[name] for row in rows), 1e-6)
        self.assertEqual(list(map(energies, rows)), list(map(energies, self.rows(scene, "--threads", "3"))))


def energies(row):
    return {name: float(value) for name, value in row.items() if name.startswith("energy_")}


if __name__ == "__main__":
    PROJDYN, SCENE = sys.argv[1:3]
    unittest.main(argv=sys.argv[:1])
