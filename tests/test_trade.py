"""Runs `projdyn trade` on a small scene and recomputes its table from the frames and metrics of its runs.

Usage: test_trade.py PROJDYN SCENE.json
"""
import csv
import json
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import unittest

try:
    import numpy as np
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

SMALL = ["--set", "bodies.water.particles.radius=0.05", "--set", "bodies.sheet.surface.grid.vertices=[9, 9]",
         "--window", "0.12", "--minutes", "0.01"]
MEASURES = ["density", "cloth", "front", "profile", "energy", "gained"]


def trade(*options, code=0):
    command = [PROJDYN, "trade", SCENE, "-o", str(OUT), *SMALL, *options]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600)
    assert done.returncode == code, (command, done.returncode, done.stdout, done.stderr)
    return done.stdout + done.stderr


def frames(directory, name):
    """frames x points x 3"""
    out = []
    for path in sorted(directory.glob(f"{name}_??????.vtk")):
        data = path.read_bytes()
        at = data.index(b"POINTS ")
        line = data[at:data.index(b"\n", at)].split()
        start = data.index(b"\n", at) + 1
        out.append(np.frombuffer(data, ">f4", 3 * int(line[1]), start).reshape(-1, 3).astype(float))
    return np.array(out)


def size(x):
    return np.linalg.norm(x.max(0) - x.min(0))


def levels(x, parts):
    """The coordinates below which these parts of the points are, for each axis."""
    return np.sort(x, 0)[[int(p * (len(x) - 1) + 0.5) for p in parts]]


def steps(directory):
    with open(directory / "metrics.csv") as file:
        rows = list(csv.DictReader(file))
    return {key: np.array([float(row[key]) for row in rows]) for key in rows[0]}


def energy_at_frames(directory):
    s, total = steps(directory), []
    for frame in json.loads((directory / "water.vtk.series").read_text())["files"][1:]:
        k = np.argmin(abs(s["time_s"] - frame["time"]))
        total.append(s["kinetic_J"][k] + s["potential_J"][k] + s["constraint_J"][k])
    return np.array(total)


def gained(directory):
    s, start = steps(directory), json.loads((directory / "report.json").read_text())["energy"]["start"]["total"]
    return max(0, (s["kinetic_J"] + s["potential_J"] + s["constraint_J"]).max() - start)


def measure(run, reference):
    sheet, sheet_ref = frames(run, "sheet")[1:], frames(reference, "sheet")[1:]
    water, water_ref = frames(run, "water"), frames(reference, "water")
    ends, even = [0.05, 0.95], [(k + 0.5) / 64 for k in range(64)]
    front = [abs(levels(a, ends) - levels(b, ends)).max(0) for a, b in zip(water[1:], water_ref[1:])]
    profile = [abs(levels(a, even) - levels(b, even)).mean(0) for a, b in zip(water[1:], water_ref[1:])]
    s = steps(reference)
    scale = max(s["kinetic_J"].max(), np.ptp(s["potential_J"]))
    return {
        "density": steps(run)["density_error_mean"].mean(),
        "cloth": np.sqrt(((sheet - sheet_ref) ** 2).sum(-1).mean()) / size(frames(reference, "sheet")[0]),
        "front": np.sqrt((np.array(front) ** 2).mean(0)).max() / size(water_ref[0]),
        "profile": np.sqrt((np.array(profile) ** 2).mean(0)).max() / size(water_ref[0]),
        "energy": np.sqrt(((energy_at_frames(run) - energy_at_frames(reference)) ** 2).mean()) / scale,
        "gained": max(0, gained(run) - gained(reference)) / scale,
    }


def runs():
    """The directories of all runs with frames, by their settings."""
    out = {}
    for path in OUT.glob("*/result.json"):
        own = [s for s in json.loads(path.read_text())["set"][4:]]
        if list(path.parent.glob("sheet_??????.vtk")):
            out[" ".join(own)] = path.parent
    return out


class Trade(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.said = trade("--error", "90%", "--write", str(OUT / "cheap.json"))
        with open(OUT / "trade.csv") as file:
            cls.rows = list(csv.DictReader(file))

    def test_says_once(self):
        """The notes of a scene come once, not with each run."""
        self.assertEqual(self.said.count("particles of radius 0.05 m fill 93.8 %"), 1)

    def test_many(self):
        self.assertGreater(len(self.rows), 30)
        self.assertGreaterEqual(sum(row["on_front"] == "1" for row in self.rows), 2)

    def test_prints_the_scene_itself(self):
        """How accurate is my run: in the table, also where other settings are better."""
        scene = next(row for row in self.rows if row["name"] == "scene unchanged")
        self.assertIn("scene unchanged" + " (not on the front)" * (scene["on_front"] == "0") + "\n", self.said)

    def test_measures(self):
        reference = [path for path in runs().items() if "tolerance=0.01 " in path[0]]
        finest = min(reference, key=lambda item: float(item[0].split("maximum=")[1].split()[0]))[1]
        where = runs()
        for row in self.rows[:: len(self.rows) // 6]:
            expected = measure(where[row["settings"]], finest)
            for name in MEASURES:
                self.assertAlmostEqual(float(row[name]), expected[name], delta=1e-6 + 1e-3 * expected[name])
            self.assertEqual(float(row["error"]), max(float(row[name]) for name in MEASURES))

    def test_front(self):
        for row in self.rows:
            ms, error = float(row["ms_per_frame"]), float(row["error"])
            beaten = any(float(r["ms_per_frame"]) <= ms and float(r["error"]) <= error
                         and (float(r["ms_per_frame"]) < ms or float(r["error"]) < error) for r in self.rows)
            if row["on_front"] == "1":
                self.assertFalse(beaten, row)
            if error >= 1:
                self.assertEqual(row["on_front"], "0")  # nothing to do with the reference
            elif row["on_front"] == "0" and not beaten:  # the same time and error as another one
                self.assertTrue([r for r in self.rows if r is not row and float(r["error"]) == error], row)

    def test_recommends(self):
        front = [row for row in self.rows if row["on_front"] == "1" and float(row["error"]) <= 0.9]
        cheapest = min(front, key=lambda row: float(row["ms_per_frame"]))
        self.assertIn("Recommended: " + cheapest["name"], self.said)
        scene = json.loads((OUT / "cheap.json").read_text())
        self.assertEqual(scene["duration"], 0.2)  # not the window
        self.assertEqual(scene["bodies"][0]["particles"]["radius"], 0.05)
        subprocess.run([PROJDYN, "check", str(OUT / "cheap.json")], check=True, capture_output=True)

    def test_resolution(self):
        """An error that the reference does not resolve is said beside the recommendation."""
        said = re.search(r"Estimated error of the reference .*, in %:(.*);", self.said).group(1)
        reference = max(float(number) for number in re.findall(r" (\d\S*?),? ", said + ", "))
        least = 100 * min(float(row["error"]) for row in self.rows)
        said = trade("--error", f"{1.001 * least}%")
        self.assertEqual("does not resolve an error" in said, 1.001 * least < 2 * reference, (least, reference))
        self.assertNotIn("does not resolve", self.said)

    def test_kept(self):
        self.assertNotIn(" good,", trade("--budget", "100s"))
        said = trade("--budget", "100s", "--by", "cloth")
        front = [row for row in csv.DictReader((OUT / "trade.csv").read_text().splitlines()) if row["on_front"] == "1"]
        self.assertIn("Recommended: " + min(front, key=lambda row: float(row["cloth"]))["name"], said)

    def test_refuses(self):
        self.assertIn("no setting reaches the target", trade("--error", "1e-12", code=1))
        self.assertIn("0.001 or 0.1%", trade("--error", "much", code=2))
        self.assertIn("0.001 or 0.1%", trade("--error", "-1", code=2))
        self.assertIn('found "5", expected a fraction below 1', trade("--error", "5", code=2))
        self.assertIn("33ms", trade("--budget", "33", code=2))
        self.assertIn("expected density", trade("--by", "colour", code=2))
        self.assertIn("--error or --budget", trade("--write", "x.json", code=2))

    def test_errors_of_no_body(self):
        """An error that no body can have would be 0 for every setting."""
        for name, metric in (("hanging_cloth", "density"), ("hanging_cloth", "front"), ("dam_break", "cloth")):
            scene = pathlib.Path(SCENE).parents[1] / "scenes" / f"{name}.json"
            done = subprocess.run([PROJDYN, "trade", scene, "-o", OUT / "none", "--by", metric, *SMALL[-4:]],
                                  capture_output=True, text=True, timeout=600)
            self.assertEqual(done.returncode, 2)
            self.assertIn(f'--by: found "{metric}", expected', done.stderr)
            self.assertFalse((OUT / "none").exists())


class TradeFixed(unittest.TestCase):
    """A fixed step of 8 ms, in frames of 20 ms: a run takes steps of 20/3 ms."""

    @classmethod
    def setUpClass(cls):
        cls.sets = ["--set", 'time_step={"fixed": 0.008}', "--set", 'contact={"thickness": 0.01}']
        trade(*cls.sets)
        with open(OUT / "trade.csv") as file:
            cls.rows = list(csv.DictReader(file))

    def test_names_the_real_step(self):
        factors = set()
        for row in self.rows:
            factor = re.search("h x ([0-9.]+)", row["name"])
            fixed = re.search("time_step.fixed=([^ ]+)", row["settings"])
            if not fixed:
                continue
            per_frame = 0.02 / float(fixed.group(1))
            self.assertAlmostEqual(per_frame, round(per_frame), delta=1e-9)
            self.assertAlmostEqual(float(factor.group(1)), 3 / per_frame, delta=1e-5)
            factors.add(factor.group(1))
        self.assertEqual({"3", "1.5", "0.5"}, factors & {"8", "4", "3", "2", "1.5", "0.5"})
        names = [row["name"] for row in self.rows]
        self.assertEqual(len(names), len(set(names)))

    def test_recommends_without_warning(self):
        """A residual of 1 or 10 is a tolerance that `check` warns of: fluid and contact."""
        loose = [row for row in self.rows if row["on_front"] == "1" and re.search("residual 10?$", row["name"])]
        self.assertTrue(loose)
        for row in loose:
            said = trade(*self.sets, "--error", str(1.0001 * float(row["error"])), "--write", str(OUT / "fixed.json"))
            self.assertNotRegex(said, "Recommended: .*residual 10?\n")
            check = subprocess.run([PROJDYN, "check", OUT / "fixed.json"], capture_output=True, text=True, check=True)
            self.assertNotIn("[tolerance]", check.stderr)

    def test_short_window(self):
        """Frames that a short window adds divide those of the scene, so that its steps fit them, too."""
        said = trade("--window", "0.05", "--set", 'time_step={"fixed": 0.008}', "--budget", "100s")
        self.assertIn("a frame every 0.005 s", said)
        with open(OUT / "trade.csv") as file:
            names = [row["name"] for row in csv.DictReader(file)]
        self.assertIn("h x 0.75", names)  # 5 ms
        self.assertNotIn("scene unchanged", names)


class TradeInlet(unittest.TestCase):
    def test_errors(self):
        """A body that has no particle in the first frame: its errors are relative to its first size."""
        jet = {"duration": 0.1, "frame_interval": 0.02, "bodies": [
            {"name": "water", "constraints": [{"type": "fluid"}], "particles": {"radius": 0.02, "inlets": [
                {"rectangle": {"center": [0, 0.3, 0], "size": [0.08, 0.08]}, "direction": [0, -1, 0], "speed": 1,
                 "start": 0.01}]}}]}
        with tempfile.TemporaryDirectory() as folder:
            scene = pathlib.Path(folder, "jet.json")
            scene.write_text(json.dumps(jet))
            subprocess.run([PROJDYN, "trade", scene, "-o", folder + "/out", "--minutes", "0.01", "--quiet"], check=True,
                           capture_output=True)
            with open(folder + "/out/trade.csv") as file:
                errors = [float(row["front"]) for row in csv.DictReader(file)]
        self.assertTrue(errors)
        self.assertTrue(0 < max(errors) < 1, errors)


class TradeSheet(unittest.TestCase):
    def test_no_trial_is_bad_input(self):
        sheet = {"duration": 0.1, "frame_interval": 0.02, "bodies": [
            {"name": "sheet", "surface": {"grid": {"size": [1, 1], "vertices": [4, 4]}, "area_density": 0.2},
             "constraints": [{"type": "spring", "stretching_stiffness": 100}]}]}
        with tempfile.TemporaryDirectory() as folder:
            scene = pathlib.Path(folder, "sheet.json")
            scene.write_text(json.dumps(sheet))
            said = subprocess.run([PROJDYN, "trade", scene, "-o", folder + "/out", "--minutes", "0.01"], check=True,
                                  capture_output=True, text=True).stdout
        self.assertIn("good", said)
        self.assertNotIn("bad input", said)

    def test_budget_below_the_expected_time(self):
        """3^4 times the time of a replica is expected, and a sheet takes less: that is measured."""
        sheet = {"duration": 0.1, "frame_interval": 0.02, "bodies": [
            {"name": "sheet", "surface": {"grid": {"size": [1, 1], "vertices": [28, 28]}, "area_density": 0.2},
             "constraints": [{"type": "spring", "stretching_stiffness": 100},
                             {"type": "pin", "vertices": {"border": True}}]}]}
        with tempfile.TemporaryDirectory() as folder:
            scene = pathlib.Path(folder, "sheet.json")
            scene.write_text(json.dumps(sheet))
            said = subprocess.run([PROJDYN, "trade", scene, "-o", folder + "/out", "--minutes", "0.1", "--twin", "3",
                                   "--budget", "1e-4ms"], capture_output=True, text=True).stderr
        self.assertRegex(said, "no setting reaches the target; the scene itself takes about")
        self.assertLess(float(re.search(r"about (\S+) times", said).group(1)), 50)


class TradeReplica(unittest.TestCase):
    """Settings run on a coarse replica, recommended for the scene."""

    @classmethod
    def setUpClass(cls):
        cls.said = trade("--twin", "1.25", "--error", "90%", "--by", "energy", "--write", str(OUT / "whole.json"))
        with open(OUT / "trade.csv") as file:
            cls.rows = list(csv.DictReader(file))
        cls.coarse = [json.loads(path.read_text())["set"] for path in OUT.glob("*/result.json")]
        cls.coarse = [s for s in cls.coarse if "bodies.0.particles.radius=0.0625" in s]

    def test_is_coarser(self):
        self.assertIn("coarse replica of the scene", self.said)
        for override in ["bodies.1.surface.grid.vertices=[7, 7]", "time_step.cfl=0.8"]:
            self.assertIn(f"--set {shlex.quote(override)}\n", self.said)
            self.assertTrue(all(override in s for s in self.coarse))
        scene = json.loads(pathlib.Path(SCENE).read_text())
        fluid = next(c for c in scene["bodies"][0]["constraints"] if c["type"] == "fluid")
        self.assertIn("constraints.0.viscosity=%.9g" % (fluid.get("viscosity", 0.02) / 1.25**2), self.said)

    def test_compression_follows_the_radius(self):
        said = trade("--twin", "1.25", "--by", "energy", "--budget", "1000s", "--set",
                     "bodies.water.constraints.fluid.compression=0.001")
        self.assertIn("bodies.0.particles.radius=0.0625", said)
        self.assertNotIn("stiffness", said)

    def test_stiffness_grows_with_the_radius(self):
        said = trade("--twin", "1.25", "--by", "energy", "--budget", "1000s", "--set",
                     'bodies.water.constraints.fluid={"type": "fluid", "stiffness": 1e5}')
        self.assertIn("constraints.0.stiffness=125000", said)

    def test_same_iterations(self):
        names = {row["name"] for row in self.rows}
        self.assertIn("h x 1, 2 x 10 iterations", names)  # 8 on the replica
        self.assertTrue(any("solver.linear_iterations=8" in s for s in self.coarse))

    def test_recommends(self):
        self.assertIn("s of the scene itself", self.said)
        self.assertNotRegex(self.said, "Recommended: .* iterations")  # truncated steps are not recommended from a replica
        scene = json.loads((OUT / "whole.json").read_text())
        self.assertEqual(scene["bodies"][0]["particles"]["radius"], 0.05)
        self.assertEqual(scene["bodies"][1]["surface"]["grid"]["vertices"], [9, 9])

    def test_budget(self):
        ms = float(re.search(r"(\S+) ms a frame", self.said).group(1))
        said = trade("--twin", "1.25", "--by", "energy", "--budget", f"{1000 * ms}ms")
        solved = [row for row in self.rows if "iterations" not in row["name"] and float(row["energy"]) < 1]
        best = min(solved, key=lambda row: float(row["energy"]))
        self.assertEqual(re.search(r"error (\S+) %", said).group(1), f"{100 * float(best['energy']):.4f}")
        self.assertLessEqual(float(re.search(r"(\S+) ms a frame", said).group(1)), 1000 * ms)
        said = trade("--twin", "1.25", "--by", "energy", "--budget", f"{0.01 * ms}ms", code=1)
        self.assertIn("no setting reaches the target; the scene itself takes about", said)

    def test_refuses(self):
        said = trade("--twin", "2", "--set", 'bodies.1.constraints.pin.vertices={"vertices": [0]}',
                     "--set", 'bodies.water.particles.fill=[{"file": "x.ply"}]', code=2)
        self.assertIn("nothing in the scene can be made coarser", said)
        self.assertIn("a factor above 0", trade("--twin", "much", code=2))


if __name__ == "__main__":
    PROJDYN, SCENE = (str(pathlib.Path(a).resolve()) for a in sys.argv[1:3])
    with tempfile.TemporaryDirectory() as directory:
        OUT = pathlib.Path(directory)
        unittest.main(argv=sys.argv[:1])
