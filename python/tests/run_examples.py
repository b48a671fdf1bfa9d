"""Every example runs, in at most 40 lines and 20 s, and does what it says."""
import importlib.util
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import projdyn

ROOT = pathlib.Path(os.environ["PROJDYN_SOURCE_ROOT"])
EXAMPLES = ROOT / "python/examples"


def run(name, *arguments):
    """What an example prints, run in an empty folder."""
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([sys.executable, EXAMPLES / f"{name}.py", *arguments], cwd=folder,
                              env={**os.environ, "MPLBACKEND": "agg", "TMPDIR": folder}, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        files = os.listdir(folder)
    if done.returncode:
        raise AssertionError(f"{name}: {done.stdout}")
    return done.stdout, files


def last_number(text):
    return float(re.findall(r"-?\d+(?:\.\d+)?(?:e-?\d+)?", text)[-1])


class Examples(unittest.TestCase):
    def test_length(self):
        for path in EXAMPLES.glob("*.py"):
            self.assertLessEqual(len(path.read_text().splitlines()), 40, path.name)
            self.assertTrue(hasattr(self, f"test_{path.stem}"), path.name)

    def test_scene_from_arrays(self):
        said, _ = run("scene_from_arrays", "2")
        sim = projdyn.load(ROOT / "scenes/water_on_cloth.json")
        sim.step()
        sim.step()
        self.assertEqual(said, f"{sim.time:.4f} s: {sim.hash:016x}\n")

    def test_drape(self):
        said, _ = run("drape")
        carried, weight = map(float, re.search(r"carries (\S+) N, the skirt weighs (\S+) N", said).groups())
        self.assertAlmostEqual(carried / weight, 1, delta=0.3)

    def test_drag_pin(self):
        said, _ = run("drag_pin")
        distances = [float(mm) for mm in re.findall(r"(\S+) mm from", said)]
        self.assertLess(distances[-1], 1)
        self.assertGreater(float(re.search(r"fell by (\S+) m", said)[1]), 0.1)

    def test_fit_bending(self):
        said, _ = run("fit_bending")
        self.assertAlmostEqual(last_number(re.findall(r"gives (\S+) mm", said)[-1]), 100, delta=0.2)

    def test_control_loop(self):
        said, _ = run("control_loop")
        self.assertLess(abs(float(re.findall(r"(\S+) mm below", said)[-1])), 5)

    def test_sweep(self):
        said, _ = run("sweep")
        depths = [float(m) for m in re.findall(r"N/m: (\S+) m", said)]
        self.assertEqual(len(depths), 5)
        self.assertEqual(sorted(depths, reverse=True), depths)

    def test_live_plot(self):
        if not importlib.util.find_spec("matplotlib"):
            self.skipTest("no matplotlib")
        _, files = run("live_plot")
        self.assertIn("live_plot.png", files)

    def test_wind_field(self):
        said, _ = run("wind_field")
        self.assertGreater(float(re.findall(r"blows (\d+) mm", said)[-1]), 20)

    def test_probes(self):
        said, _ = run("probes")
        pressures = [float(pa) for pa in re.findall(r"y = .* (\S+) Pa", said)]
        self.assertEqual(len(pressures), 20)
        self.assertGreater(pressures[0], 300)

    def test_notebook_replay(self):
        said, _ = run("notebook_replay")
        self.assertIn("replay.html", said)


if __name__ == "__main__":
    unittest.main()
