"""Compares docs/guide/metrics.md with the columns of metrics.csv and the keys of report.json of a
run: both list the same, no more and no less.

Usage: test_metrics_page.py PROJDYN SCENE.json"""
import csv
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

PAGE = pathlib.Path(__file__).parent.parent / "docs/guide/metrics.md"
PROBES = [{"point": [0, 0, 0]}, {"line": {"from": [0, 0, 0], "to": [1, 0, 0], "count": 2}},
          {"height": [0, 0, 0]}, {"box": {"minimum": [0, 0, 0], "maximum": [1, 1, 1]}},
          {"wall": [0, 0, 0]}, {"solid": "tank"}, {"pins": "sheet"},
          {"inside": "ball"}, {"body": "sheet"}]
STRING = {"type": "attachment", "to": "sheet", "vertices": {"vertices": [0]}, "stiffness": 1e-3,
          "until": 9}
BALL = {"name": "ball", "color": "#c02020",
        "constraints": [{"type": "gas"}, {"type": "pin", "vertices": {"all": True}}, STRING, STRING],
        "surface": {"mesh": str(PAGE.parents[2] / "scenes/meshes/ball.obj"), "scale": 0.01,
                    "translate": [0, 2, 0], "area_density": 1}}
OPEN_KEYS = {"constraints": "TYPE", "parameters[].numbers": "NAME"}  # keys that the scene chooses


def keys(value, path=""):
    """The keys of a report, as the page writes them: a.b and a[].b."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from keys(inner, f"{path}.{OPEN_KEYS.get(path, key)}".lstrip("."))
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        for inner in value:
            yield from keys(inner, f"{path}[]")
    else:
        yield path


def listed(section):
    """The code words in the first column of all tables of a section of the page."""
    text = PAGE.read_text(encoding="utf-8").split(f"\n## {section}\n")[1].split("\n## ")[0]
    cells = re.findall(r"^\| (`.*?) \|", text, re.MULTILINE)
    return [word for cell in cells for word in re.findall(r"`([^`]*)`", cell)]


class MetricsPage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with tempfile.TemporaryDirectory() as name:
            run = pathlib.Path(name)
            bodies = json.loads(pathlib.Path(SCENE).read_text())["bodies"] + [BALL]
            done = subprocess.run(
                [PROJDYN, "run", SCENE, "-o", run, "--quiet", "--time", "0.1", "--no-frames",
                 "--set", "bodies=" + json.dumps(bodies),
                 "--set", 'solids.tank.color="#808080"', "--set", "probes=" + json.dumps(PROBES), "--set", "frame_interval=0.03",
                 "--set", "contact={\"thickness\": 0.005}",
                 "--set", "time_step={\"fixed\": 0.02}"],
                capture_output=True, text=True, timeout=300)
            assert done.returncode == 0, done.stderr
            cls.report = json.loads((run / "report.json").read_text())
            with open(run / "metrics.csv", newline="", encoding="utf-8") as file:
                cls.columns = next(csv.reader(file))
            with open(run / "probes.csv", newline="", encoding="utf-8") as file:
                cls.probes = list(csv.reader(file))

    def compare(self, section, found):
        page = listed(section)
        self.assertEqual(len(page), len(set(page)), "a key is listed twice")
        self.assertEqual(set(page), set(found))

    def test_columns(self):
        self.compare("metrics.csv", [
            re.sub("^residual_.*", "residual_NAME",
                   re.sub(r"^energy_\w+\.[a-z_]+?(\.1)?_J", r"energy_NAME.TYPE\1_J", column))
            for column in self.columns])

    def test_probes(self):
        self.compare("probes.csv", [re.sub("^probe[0-9]", "NAME", re.sub("_[0-9]+_", "_K_", column))
                                    for column in self.probes[0]])
        self.assertGreater(len(self.probes), 2)
        for row in self.probes[1:]:
            self.assertEqual(len([float(number) for number in row]), len(self.probes[0]))

    def test_report(self):
        self.assertTrue(self.report["warnings"], "expected a run with a warning")
        self.compare("report.json", keys(self.report))


if __name__ == "__main__":
    PROJDYN, SCENE = sys.argv[1:3]
    unittest.main(argv=sys.argv[:1])
