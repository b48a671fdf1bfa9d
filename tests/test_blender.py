"""Imports a run in Blender without a window and compares the scene with the files of the run, as
VTK reads them.

Usage: test_blender.py PROJDYN SCENE.json"""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

if not shutil.which("blender"):
    print("skipped: blender is not installed")
    sys.exit(77)
try:
    import numpy as np
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOLegacy import vtkUnstructuredGridReader
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

ROOT = pathlib.Path(__file__).parent.parent
FRAMES = [3, 0, 5]  # in this order: back and forth
MOTION = [{"time": 0}, {"time": 1, "translate": [0.5, 0, 0]}]
SOLIDS = [{"name": "tank", "box": {"minimum": [-0.6, 0, -0.6], "maximum": [0.6, 0.4, 0.6]},
           "open": ["+y"]},
          {"name": "ball", "sphere": {"center": [0, 0.2, 0], "radius": 0.1}, "motion": MOTION}]


def blender(script, *arguments):
    return subprocess.run(
        ["blender", "--background", "--factory-startup", "--python-exit-code", "1", "--python",
         script, "--", *map(str, arguments)], capture_output=True, text=True, timeout=240)


def z_up(points):
    return np.column_stack([points[:, 0], -points[:, 2], points[:, 1]])


def read(path):
    """Points, triangles, and arrays by name of a file, as VTK reads it."""
    reader = vtkUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.ReadAllScalarsOn()
    reader.ReadAllVectorsOn()
    reader.Update()
    grid = reader.GetOutput()
    count, data = grid.GetNumberOfCells(), grid.GetPointData()
    cells = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(count, -1)
    arrays = {data.GetArrayName(k): vtk_to_numpy(data.GetArray(k))
              for k in range(data.GetNumberOfArrays())}
    return (vtk_to_numpy(grid.GetPoints().GetData()),
            cells if cells.shape[1] == 3 else np.empty((0, 3)), arrays)


def write_quads(path):
    """An OBJ file: a sheet of 9 x 9 vertices, texture coordinates x and z, quads that count back
    from the last vertex."""
    places = [(0.1 * (k % 9) - 0.4, 0.1 * (k // 9) - 0.4) for k in range(81)]
    lines = [f"v {x} 0.5 {z}" for x, z in places] + [f"vt {x} {z}" for x, z in places]
    for i in (9 * row + column - 81 for row in range(8) for column in range(8)):
        lines.append("f " + " ".join(f"{c}/{c}" for c in (i, i + 9, i + 10, i + 1)))
    path.write_text("\n".join(lines) + "\n")


class Blender(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.holder = tempfile.TemporaryDirectory()
        cls.directory = pathlib.Path(cls.holder.name) / "run"
        quads = pathlib.Path(cls.holder.name) / "quads.obj"
        write_quads(quads)
        surface = {"mesh": str(quads), "area_density": 0.4}
        done = subprocess.run(
            [PROJDYN, "run", SCENE, "-o", cls.directory, "--quiet", "--time", "0.1",
             "--set", f"solids={json.dumps(SOLIDS)}",
             "--set", f"bodies.sheet.surface={json.dumps(surface)}",
             "--set", 'solids.ball.color="#336699"', "--set", 'bodies.water.color="#d08a14"'],
            capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        cls.particles, cls.arrays = cls.dump("particles")
        done = subprocess.run([PROJDYN, "mesh", cls.directory], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        cls.surface, cls.surface_arrays = cls.dump("surface")

    @classmethod
    def tearDownClass(cls):
        cls.holder.cleanup()

    @classmethod
    def dump(cls, name):
        out = pathlib.Path(cls.holder.name) / name
        done = blender(ROOT / "tests/blender_dump.py", ROOT / "blender", cls.directory, out,
                       *FRAMES)
        assert done.returncode == 0, done.stdout + done.stderr
        return json.loads(out.with_suffix(".json").read_text()), np.load(f"{out}.npz")

    def check(self, arrays, name, frame, file, turn=z_up):
        points, triangles, data = read(self.directory / file)
        self.assertTrue((arrays[f"{name}.{frame}.points"] == turn(points)).all())
        self.assertTrue((arrays[f"{name}.{frame}.triangles"] == triangles).all())
        for key in {"velocity", "density", "pressure"} & set(data):
            values = turn(data[key]) if key == "velocity" else data[key].reshape(-1, 1)
            self.assertTrue((arrays[f"{name}.{frame}.{key}"] == values).all())

    def test_every_frame_is_that_of_the_file(self):
        for frame in FRAMES:
            for name, file in (("water", f"water_{frame:06d}.vtk"),
                               ("sheet", f"sheet_{frame:06d}.vtk"), ("tank", "solids/tank.vtk"),
                               ("ball", f"solids/ball_{frame:06d}.vtk")):
                with self.subTest(name, frame=frame):
                    self.check(self.arrays, name, frame, file)

    def test_a_scene_with_z_up_is_not_turned(self):
        report = self.directory / "report.json"
        text = report.read_text()
        self.addCleanup(report.write_text, text)
        report.write_text(json.dumps({**json.loads(text), "up": "z"}))
        _, arrays = self.dump("z_up")
        self.check(arrays, "sheet", 3, "sheet_000003.vtk", turn=lambda vectors: vectors)

    def test_the_surface_of_the_water_takes_the_place_of_particles(self):
        for frame in FRAMES:
            with self.subTest(frame=frame):
                self.check(self.surface_arrays, "water", frame, f"mesh/water_{frame:06d}.vtk")
                self.assertIn(f"water.{frame}.velocity", self.surface_arrays)
        self.assertEqual(self.particles["objects"]["water"]["modifiers"], ["NODES"])
        self.assertEqual(self.surface["objects"]["water"]["modifiers"], [])

    def test_texture_coordinates(self):
        points, triangles, _ = read(self.directory / "sheet_000000.vtk")
        expected = points[triangles.ravel()][:, (0, 2)]
        for frame in FRAMES:
            self.assertLess(np.abs(self.arrays[f"sheet.{frame}.uv"] - expected).max(), 1e-6)
        self.assertNotIn("water.0.uv", self.surface_arrays)

    def test_time(self):
        self.assertAlmostEqual(self.particles["fps"], 50, 4)
        self.assertEqual((self.particles["start"], self.particles["end"]), (0, 5))

    def test_materials(self):
        told = {name: thing["material"] for name, thing in self.surface["objects"].items()}
        self.assertEqual(told, {"water": "projdyn water #d08a14", "sheet": "projdyn cloth 0",
                                "tank": "projdyn tank", "ball": "projdyn obstacle #336699"})
        ball, water = (self.surface["objects"][name]["color"] for name in ("ball", "water"))
        for found, srgb in zip(ball + water, (0x33, 0x66, 0x99, 0xd0, 0x8a, 0x14)):
            self.assertAlmostEqual(found, ((srgb / 255 + 0.055) / 1.055) ** 2.4, 4)
        self.assertTrue(self.surface["objects"]["sheet"]["smooth"])

    def test_cycles_blurs_by_the_velocity(self):
        def border(kind):  # pixels that are neither empty nor full
            opacity = self.surface_arrays[f"opacity.{kind}"]
            return np.count_nonzero((opacity > 0.05) & (opacity < 0.95))

        self.assertGreater(border("sharp"), 0)
        self.assertGreater(border("blur"), 1.5 * border("sharp"))

    def test_a_moving_solid_has_a_velocity(self):
        for frame in FRAMES:
            velocity = self.arrays[f"ball.{frame}.velocity"]
            self.assertTrue(np.allclose(velocity, (0.5, 0, 0), atol=1e-4))
        self.assertNotIn("tank.0.velocity", self.arrays)

    def test_bad_runs_are_told(self):
        with tempfile.TemporaryDirectory() as name:
            directory = pathlib.Path(name)
            for file, text, expected in (
                    ("other", "", "report.json: No such file or directory; expected a directory"),
                    ("report.json", "{", "report.json: expected JSON")):
                (directory / file).write_text(text)
                done = blender(ROOT / "tests/blender_dump.py", ROOT / "blender", directory,
                               directory / "out", 0)
                self.assertEqual(done.returncode, 1)
                self.assertIn(expected, done.stdout + done.stderr)
            shutil.copytree(self.directory, directory / "cut")
            frame = directory / "cut/sheet_000000.vtk"
            frame.write_bytes(frame.read_bytes()[:300])
            done = blender(ROOT / "tests/blender_dump.py", ROOT / "blender", directory / "cut",
                           directory / "out", 0)
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stdout + done.stderr, r"sheet_000000.vtk: byte \d+: expected")
            shutil.copy(self.directory / "sheet_000000.vtk", frame)
            (directory / "cut/sheet.obj").write_text("v 0 0 0\nvt 0 0\nf 1/1 1/1 1/1\n")
            done = blender(ROOT / "tests/blender_dump.py", ROOT / "blender", directory / "cut",
                           directory / "out", 0)
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stdout + done.stderr, r"sheet.obj: expected the \d+ triangles")


if __name__ == "__main__":
    PROJDYN, SCENE = sys.argv[1:3]
    unittest.main(argv=sys.argv[:1])
