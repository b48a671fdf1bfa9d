"""Opens a run with VTK, as ParaView does; where ParaView is installed, runs its script, too.

Usage: test_paraview.py PROJDYN SCENE.json"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

try:
    from vtkmodules.vtkIOLegacy import vtkUnstructuredGridReader
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

ROOT = pathlib.Path(__file__).parent.parent
sys.path.append(str(ROOT / "blender/projdyn"))
import run_directory  # noqa: E402

MOTION = [{"time": 0}, {"time": 1, "translate": [0.5, 0, 0]}]
SOLIDS = [{"name": "tank", "box": {"minimum": [-0.6, 0, -0.6], "maximum": [0.6, 0.4, 0.6]},
           "open": ["+y"]},
          {"name": "ball", "sphere": {"center": [0, 0.2, 0], "radius": 0.1}, "motion": MOTION}]


class ParaView(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.holder = tempfile.TemporaryDirectory()
        cls.directory = pathlib.Path(cls.holder.name) / "run"
        done = subprocess.run(
            [PROJDYN, "run", SCENE, "-o", cls.directory, "--quiet", "--time", "0.06",
             "--set", f"solids={json.dumps(SOLIDS)}"], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        done = subprocess.run([PROJDYN, "mesh", cls.directory], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr

    @classmethod
    def tearDownClass(cls):
        cls.holder.cleanup()

    def check(self, use_mesh, expected):
        """expected: per part its name, role, whether it consists of particles, and frames."""
        parts = run_directory.read_run(self.directory, use_mesh)
        series = [run_directory.read_series(part.file) for part in parts]
        self.assertEqual([(p.name, p.role, p.radius > 0, len(s)) for p, s in zip(parts, series)],
                         expected)
        for _, file in (frame for frames in series for frame in frames):
            reader = vtkUnstructuredGridReader()
            reader.SetFileName(str(file))
            reader.Update()
            self.assertGreater(reader.GetOutput().GetNumberOfCells(), 0, file)

    def test_vtk_opens_all_parts(self):
        others = [("sheet", "cloth", False, 4), ("tank", "tank", False, 1),
                  ("ball", "obstacle", False, 4)]
        self.check(True, [("water", "water", False, 4), *others])
        self.check(False, [("water", "particles", True, 4), *others])

    def test_the_axis_that_is_up(self):
        self.assertFalse(run_directory.is_z_up(self.directory))
        turned = pathlib.Path(self.holder.name) / "turned"
        subprocess.run([PROJDYN, "run", SCENE, "-o", turned, "--quiet", "--time", "0.01", "--no-frames",
                        "--set", "gravity=[1, 2, -9]"], check=True, capture_output=True)
        self.assertTrue(run_directory.is_z_up(turned))

    def test_pvpython_draws_it(self):
        if not shutil.which("pvpython") or not shutil.which("Xvfb"):
            self.skipTest("pvpython or Xvfb is not installed")
        picture = pathlib.Path(self.holder.name) / "picture.png"
        with subprocess.Popen(["Xvfb", "-displayfd", "1"], stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL, text=True) as server:
            display = {"DISPLAY": f":{server.stdout.readline().strip()}"}
            done = subprocess.run(
                ["pvpython", ROOT / "scripts/paraview_run.py", self.directory, "-o", picture,
                 "--size", "320x200"], capture_output=True, text=True, timeout=240,
                env=os.environ | display)
            server.terminate()
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(picture.read_bytes()[:4], b"\x89PNG")
        state = (self.directory / "run.pvsm").read_text()
        names = set(re.findall(r'<Item id="\d+" name="(\w+)"', state))
        self.assertLessEqual({"water", "sheet", "tank", "ball"}, names)


if __name__ == "__main__":
    PROJDYN, SCENE = sys.argv[1:3]
    unittest.main(argv=sys.argv[:1])
