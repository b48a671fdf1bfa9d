"""Runs a scene for a few frames and reads its output files with independent readers.

Usage: test_output.py PROJDYN SCENE.json
"""
import csv
import json
import math
import pathlib
import resource
import signal
import subprocess
import sys
import tempfile
import unittest

try:
    import meshio
    import numpy as np
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOLegacy import vtkUnstructuredGridReader
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

TIME = 0.1  # s
COLUMNS = (
    "time_s,h_s,outer_iterations,linear_iterations,particles,density_error_mean,density_error_max,"
    "step_residual,kinetic_J,potential_J,constraint_J,momentum_x,momentum_y,momentum_z,"
    "pin_reaction_x_N,pin_reaction_y_N,pin_reaction_z_N,ms_neighbours,ms_local,ms_global,ms_contact,"
    "retries,ms_cpu,impacts,leaked,residual_water,residual_sheet,"
    "energy_water.fluid_J,energy_sheet.spring_J,energy_sheet.bending_J,energy_sheet.pin_J"
).split(",")
REPORT = """version scene name threads particles.fluid particles.cloth particles.boundary
particles.start particles.peak particles.end particles.emitted particles.removed bodies
constraints solver.type solver.step solver.reason solver.dual_steps steps simulated_s wall_s ms_per_step
ms.neighbours ms.local ms.global ms.contact ms.output impacts.mean impacts.max retries outer_iterations.mean outer_iterations.max
linear_iterations.mean linear_iterations.max density_error.mean density_error.worst_mean
density_error.mean_max density_error.max step_residual.mean step_residual.max
energy.start.kinetic energy.start.potential energy.start.constraint energy.start.total
energy.end.kinetic energy.end.potential energy.end.constraint energy.end.total momentum.start
momentum.end pin_reaction_N pin_reaction solids strings peak_memory_bytes peak_rss_bytes state_hash time_step.integrator time_step.min
time_step.mean time_step.max leaked warnings interrupted failed""".split()
CELL = {"particles": (1, "vertex"), "surface": (5, "triangle")}  # VTK's number, meshio's name

SOLIDS = {  # kind, triangles, bounds
    "tank": ("box", 10, [-0.6, 0, -0.6], [0.6, 0.4, 0.6]),
    "ball": ("sphere", 3968, [-0.5, 1.5, -0.5], [0.5, 2.5, 0.5]),
    "floor": ("plane", 2, [-2, -1, -2], [2, -1, 2]),
}


def run(directory, *options, limit=None, scene=None):
    """limit: bytes that a file may have."""
    def prepare():
        if limit:
            signal.signal(signal.SIGXFSZ, signal.SIG_DFL)  # Python ignores it
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    command = [PROJDYN, "run", scene or SCENE, "-o", str(directory), "--quiet", "--threads", "1", *options]
    return subprocess.run(command, capture_output=True, text=True, timeout=600, preexec_fn=prepare)


def read_vtk(path):
    """Points, cells (each of one type, equally long), their types, point arrays by name."""
    errors = []
    reader = vtkUnstructuredGridReader()
    reader.AddObserver("ErrorEvent", lambda *_: errors.append(path))
    reader.SetFileName(str(path))
    reader.ReadAllScalarsOn()
    reader.ReadAllVectorsOn()
    reader.Update()
    assert not errors, f"vtk cannot read {path}"
    grid = reader.GetOutput()
    count = grid.GetNumberOfCells()
    data = grid.GetPointData()
    arrays = {data.GetArrayName(k): vtk_to_numpy(data.GetArray(k))
              for k in range(data.GetNumberOfArrays())}
    cells = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(count, -1)
    types = {grid.GetCellType(k) for k in range(count)}
    return vtk_to_numpy(grid.GetPoints().GetData()), cells, types, arrays


def finite_numbers(value):
    if isinstance(value, dict):
        return all(map(finite_numbers, value.values()))
    if isinstance(value, list):
        return all(map(finite_numbers, value))
    return not isinstance(value, float) or math.isfinite(value)


class Output(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.holder = tempfile.TemporaryDirectory()
        cls.directory = pathlib.Path(cls.holder.name) / "deep" / "out"
        cls.done = run(cls.directory, "--time", str(TIME), "--ply")
        assert cls.done.returncode == 0, cls.done.stderr
        cls.report = json.loads((cls.directory / "report.json").read_text())
        cls.interval = json.loads(pathlib.Path(SCENE).read_text()).get("frame_interval", 1 / 30)

    @classmethod
    def tearDownClass(cls):
        cls.holder.cleanup()

    def series(self, body):
        return json.loads((self.directory / f"{body['name']}.vtk.series").read_text())

    def frames(self):
        for body in self.report["bodies"]:
            for frame in self.series(body)["files"]:
                yield body, self.directory / frame["name"]

    def check_arrays(self, body, points, arrays):
        count = body["count"]
        self.assertEqual(points.shape, (count, 3))
        wanted = {"velocity", "density", "pressure"} if body["kind"] == "particles" else {"velocity"}
        self.assertEqual(set(arrays), wanted)
        self.assertEqual(arrays["velocity"].shape, (count, 3))
        for values in (points, *arrays.values()):
            self.assertTrue(np.isfinite(values).all())
        if "density" in arrays:
            density = arrays["density"].ravel()
            self.assertEqual(len(density), count)
            self.assertTrue((density > 0.1 * body["rest_density"]).all(), density.min())
            self.assertTrue((density < 10 * body["rest_density"]).all(), density.max())
            pressed = arrays["pressure"].ravel() > 0
            self.assertEqual(len(pressed), count)
            self.assertTrue((density[pressed] >= body["rest_density"]).all())

    def check_cells(self, body, cells):
        if body["kind"] == "particles":
            self.assertEqual(cells.ravel().tolist(), list(range(body["count"])))
        else:
            self.assertEqual(cells.shape, (body["triangles"], 3))
            self.assertEqual(set(cells.ravel().tolist()), set(range(body["count"])))

    def test_vtk_reads_every_frame(self):
        for body, path in self.frames():
            with self.subTest(path.name):
                points, cells, types, arrays = read_vtk(path)
                self.check_arrays(body, points, arrays)
                self.check_cells(body, cells)
                self.assertEqual(types, {CELL[body["kind"]][0]})

    def test_meshio_reads_the_same(self):
        for body, path in self.frames():
            with self.subTest(path.name):
                points, cells, _, arrays = read_vtk(path)
                mesh = meshio.read(path)
                self.check_arrays(body, mesh.points, mesh.point_data)
                self.assertTrue((mesh.points == points).all())
                self.assertTrue((mesh.cells_dict[CELL[body["kind"]][1]] == cells).all())
                for name, values in arrays.items():
                    self.assertTrue((mesh.point_data[name].ravel() == values.ravel()).all(), name)

    def test_ply_holds_the_same(self):
        for body, path in self.frames():
            with self.subTest(path.stem):
                points, cells, _, arrays = read_vtk(path)
                mesh = meshio.read(path.with_suffix(".ply"))
                self.assertTrue((mesh.points == points).all())
                velocity = np.column_stack([mesh.point_data[k] for k in ("vx", "vy", "vz")])
                self.assertTrue((velocity == arrays["velocity"]).all())
                self.assertEqual("density" in mesh.point_data, body["kind"] == "particles")
                if body["kind"] == "particles":
                    for name in ("density", "pressure"):
                        self.assertTrue((mesh.point_data[name] == arrays[name]).all())
                else:
                    self.assertTrue((mesh.cells_dict["triangle"] == cells).all())

    def test_particles_that_are_not_live_are_left_out(self):
        """A file has the live particles alone, each with its own numbers: VTK and PLY agree."""
        inlet = {"disc": {"center": [0, 0.3, 0], "radius": 0.05}, "direction": [0, -1, 0], "speed": 1}
        jet = {"name": "jet", "particles": {"radius": 0.01, "inlets": [inlet], "budget": 5000},
               "constraints": [{"type": "fluid", "stiffness": 1e5}]}
        with tempfile.TemporaryDirectory() as name:
            done = run(name, "--time", "0.1", "--ply", "--set", f"bodies={json.dumps([jet])}")
            self.assertEqual(done.returncode, 0, done.stderr)
            last = sorted(pathlib.Path(name).glob("jet_*.vtk"))[-1]
            points, _, _, arrays = read_vtk(last)
            mesh = meshio.read(last.with_suffix(".ply"))
            self.assertTrue(50 < len(points) == len(np.unique(points, axis=0)) < 5000)
            self.assertTrue((mesh.points == points).all())
            self.assertTrue((mesh.point_data["vy"] == arrays["velocity"][:, 1]).all())

    def test_something_moves(self):
        for body in self.report["bodies"]:
            files = self.series(body)["files"]
            first, _, _, _ = read_vtk(self.directory / files[0]["name"])
            last, _, _, arrays = read_vtk(self.directory / files[-1]["name"])
            self.assertGreater(np.abs(last - first).max(), 1e-3, body["name"])
            self.assertGreater(np.abs(arrays["velocity"]).max(), 1e-3, body["name"])

    def test_series(self):
        last = int(self.report["simulated_s"] / self.interval + 1e-9)
        self.assertGreaterEqual(last, 1)
        for body in self.report["bodies"]:
            series = self.series(body)
            self.assertEqual(series["file-series-version"], "1.0")
            self.assertEqual(len(series["files"]), last + 1)
            for number, frame in enumerate(series["files"]):
                self.assertEqual(frame["name"], f"{body['name']}_{number:06d}.vtk")
                self.assertAlmostEqual(frame["time"], number * self.interval, delta=1e-12)

    def test_series_times_are_exact(self):
        interval = 1 / 30  # has no short decimal
        with tempfile.TemporaryDirectory() as name:
            done = run(name, "--time", str(TIME), "--set", f"frame_interval={interval!r}")
            self.assertEqual(done.returncode, 0, done.stderr)
            for body in self.report["bodies"]:
                series = json.loads((pathlib.Path(name) / f"{body['name']}.vtk.series").read_text())
                times = [frame["time"] for frame in series["files"]]
                self.assertEqual(times, [k * interval for k in range(4)])

    def test_report_tells_the_start(self):
        body = self.report["bodies"][0]["name"]
        with tempfile.TemporaryDirectory() as name:
            done = run(name, "--time", str(TIME), "--set", f"bodies.{body}.velocity=[1, 0, 0]")
            self.assertEqual(done.returncode, 0, done.stderr)
            report = json.loads((pathlib.Path(name) / "report.json").read_text())
            with open(pathlib.Path(name) / "metrics.csv", newline="") as file:
                first = next(csv.DictReader(file))
        start, momentum = report["energy"]["start"], report["momentum"]["start"]
        self.assertGreater(momentum[0], 0)
        self.assertEqual(momentum[1:], [0, 0])
        self.assertAlmostEqual(start["kinetic"], momentum[0] / 2, delta=1e-9 * momentum[0])  # 1 m/s
        self.assertAlmostEqual(start["constraint"], 0, 9)
        potential = float(first["potential_J"])  # a step later
        self.assertAlmostEqual(start["potential"], potential, delta=1e-2 * abs(potential))

    def test_report_does_not_guess_energies(self):
        """Where a gas gives energy, that of the constraints at the start is not known."""
        cushion = pathlib.Path(__file__).parent.parent / "scenes/cushion.json"
        with tempfile.TemporaryDirectory() as name:
            done = run(name, "--time", "0.01", "--no-frames", scene=str(cushion))
            self.assertEqual(done.returncode, 0, done.stderr)
            start = json.loads((pathlib.Path(name) / "report.json").read_text())["energy"]["start"]
        self.assertEqual((start["kinetic"], start["constraint"], start["total"]), (0, None, None))

    def test_loads(self):
        names = [solid["name"] for solid in json.loads(pathlib.Path(SCENE).read_text())["solids"]]
        self.assertEqual([load["name"] for load in self.report["solids"]], names)
        for load in self.report["solids"]:
            self.assertEqual(sorted(load), ["file", "force_N", "kind", "moment_Nm", "moving", "name"])
            self.assertEqual((len(load["force_N"]), len(load["moment_Nm"])), (3, 3))

    def test_boundary(self):
        path = self.directory / "boundary.vtk"
        count = self.report["particles"]["boundary"]
        self.assertEqual(path.exists(), count > 0)
        if count:
            points, cells, types, arrays = read_vtk(path)
            self.assertEqual(points.shape, (count, 3))
            self.assertTrue(np.isfinite(points).all())
            self.assertEqual(cells.ravel().tolist(), list(range(count)))
            self.assertEqual((types, arrays), ({1}, {}))
            self.assertTrue((meshio.read(path).points == points).all())

    def test_moving_boundary(self):
        motion = [{"time": 0}, {"time": 1, "translate": [1, 0, 0]}]
        walls = {"name": "lid", "box": {"minimum": [-0.6, 2, -0.6], "maximum": [0.6, 2.1, 0.6]}}
        tank = json.loads(pathlib.Path(SCENE).read_text())["solids"][0]
        for resting in ([], [walls]):
            with self.subTest(resting=len(resting)), tempfile.TemporaryDirectory() as name:
                directory = pathlib.Path(name)
                (directory / "boundary.vtk").write_text("of a former run")
                solids = json.dumps(resting + [tank | {"motion": motion}])
                done = run(name, "--time", str(TIME), "--set", f"solids={solids}")
                self.assertEqual(done.returncode, 0, done.stderr)
                count = json.loads((directory / "report.json").read_text())["particles"]["boundary"]
                path = directory / "boundary.vtk"
                self.assertEqual(path.exists(), len(resting) > 0)
                rest = len(read_vtk(path)[0]) if resting else 0
                files = json.loads((directory / "boundary.vtk.series").read_text())["files"]
                body = self.series(self.report["bodies"][0])["files"]
                self.assertEqual([f["time"] for f in files], [f["time"] for f in body])
                first = read_vtk(directory / files[0]["name"])[0]
                self.assertEqual(len(first), count - rest)
                for file in files:
                    points, cells, types, arrays = read_vtk(directory / file["name"])
                    self.assertEqual((types, arrays), ({1}, {}))
                    moved = first + [file["time"], 0, 0]
                    self.assertLess(np.abs(points - moved).max(), 1e-6)
                self.assertEqual(run(name, "--time", str(TIME)).returncode, 0)
                left = {path.name for path in directory.glob("boundary*")}
                self.assertEqual(left, {"boundary.vtk"})

    def check_grid(self, directory, name):
        points, cells, _, _ = read_vtk(directory / f"{name}_000000.vtk")
        mesh = meshio.read(directory / f"{name}.obj")
        self.assertTrue(np.allclose(mesh.points, points, atol=1e-6))
        self.assertTrue((mesh.cells_dict["triangle"] == cells).all())
        low, high = points.min(axis=0), points.max(axis=0)
        u, v = ((points - low)[:, [0, 2]] / (high - low)[[0, 2]]).T
        lines = (directory / f"{name}.obj").read_text().splitlines()
        texture = np.array([line.split()[1:] for line in lines if line.startswith("vt ")], float)
        self.assertTrue(np.allclose(texture, np.column_stack([u, 1 - v]), atol=1e-6))

    def test_obj_of_a_file(self):
        """Faces, texture coordinates, groups and materials stay; positions are those of the scene."""
        text = """# a square of two colours
mtllib colours.mtl
v 0 0 0\nv 1 0 0\n  v 1 0 1 0.5\nv 0 0 1
v 0.5 0 2
vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1
vn 0 1 0
g first
usemtl red
f 1/1/1 2/2/1 \\
  3/3/1 4/4/1 # a quadrilateral
usemtl blue
f -2//1 3//1 5//1
"""
        wanted = """# a square of two colours
mtllib colours.mtl
v 0 0.9 0\nv 2 0.9 0\nv 2 0.9 2\nv 0 0.9 2
v 1 0.9 4
vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1
g first
usemtl red
f 1/1 2/2 3/3 4/4

usemtl blue
f -2 3 5
"""
        with tempfile.TemporaryDirectory() as name:
            source = pathlib.Path(name) / "meshes" / "square.obj"
            source.parent.mkdir()
            source.write_text(text)
            surface = {"mesh": str(source), "scale": 2, "translate": [0, 0.9, 0], "area_density": 1}
            body = {"name": "square", "surface": surface, "constraints": []}
            done = run(name, "--time", "0.02", "--set", f"bodies={json.dumps([body])}")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertTrue((pathlib.Path(name) / "square_000000.vtk").exists())
            self.assertEqual((pathlib.Path(name) / "square.obj").read_text().split(), wanted.split())
            done = run(source.parent, "--time", "0.02", "--set", f"bodies={json.dumps([body])}")
            self.assertEqual(done.returncode, 2)
            self.assertIn("square.obj: the scene reads this file", done.stderr)
            self.assertEqual(source.read_text(), text)

    def test_two_grids(self):
        """An attachment: its vertices and times, and where its springs end on the other body. Grids
        have texture coordinates, and each constraint on each body has its own column of energy."""
        with tempfile.TemporaryDirectory() as name:
            spring = {"type": "spring", "stretching_stiffness": 9}
            low, high = ({"name": body, "constraints": [spring], "surface": {
                "grid": {"size": [1, 1], "vertices": [3, 4]}, "translate": [0, height, 0],
                "area_density": 1}} for body, height in (("low", 2), ("high", 3)))
            low["constraints"] = [spring, {"type": "attachment", "to": "high", "stiffness": 5,
                                           "vertices": {"vertices": [4, 8]}, "from": 0.01}]
            done = run(name, "--time", "0.02", "--set", f"bodies={json.dumps([low, high])}")
            self.assertEqual(done.returncode, 0, done.stderr)
            strings, = json.loads((pathlib.Path(name) / "report.json").read_text())["strings"]
            self.assertEqual((strings["body"], strings["to"], strings["from"]), ("low", "high", 0.01))
            for body in ("low", "high"):
                self.check_grid(pathlib.Path(name), body)
            header = (pathlib.Path(name) / "metrics.csv").read_text().splitlines()[0].split(",")
            self.assertEqual([column for column in header if column.startswith("energy_")], [
                "energy_low.spring_J", "energy_low.attachment_J", "energy_high.spring_J"])
            for vertex, (own, *ends) in zip((4, 8), strings["ends"]):
                self.assertEqual(own, vertex)
                self.assertAlmostEqual(sum(w for end, w in zip(ends[:3], ends[3:]) if end == vertex), 1)

    def test_a_refused_run_keeps_the_last_one(self):
        """A scene that reads a file of the directory's run: nothing is removed."""
        with tempfile.TemporaryDirectory() as name:
            directory = pathlib.Path(name)
            sheet = {"name": "sheet", "constraints": [{"type": "spring", "stretching_stiffness": 9}]}
            grid = dict(sheet, surface={"grid": {"size": [1, 1], "vertices": [3, 3]},
                                        "translate": [0, 2, 0], "area_density": 1})
            copy = dict(sheet, surface={"mesh": str(directory / "sheet.obj"), "area_density": 1})
            done = run(name, "--time", "0.02", "--set", f"bodies={json.dumps([grid])}")
            self.assertEqual(done.returncode, 0, done.stderr)
            before = {p: p.stat().st_mtime_ns for p in directory.iterdir() if p.name != "lock"}
            done = run(name, "--time", "0.02", "--set", f"bodies={json.dumps([copy])}")
            self.assertEqual(done.returncode, 2)
            self.assertIn("sheet.obj: the scene reads this file", done.stderr)
            water = {"name": "water", "constraints": [],
                     "particles": {"radius": 0.1, "rest_density": 1000, "fill": [
                         {"file": str(directory / "sheet_000000.vtk")}]}}
            frame = run(name, "--time", "0.02", "--set", f"bodies={json.dumps([water])}")
            self.assertEqual(frame.returncode, 2)
            self.assertIn("sheet_000000.vtk: the scene reads this file", frame.stderr)
            self.assertEqual(
                before, {p: p.stat().st_mtime_ns for p in directory.iterdir() if p.name != "lock"})

    def check_solid(self, directory, report, path, displacement, name):
        solid = next(solid for solid in report["solids"] if solid["name"] == name)
        points, cells, types, arrays = read_vtk(path)
        self.assertEqual((types, arrays), ({5}, {}))
        self.assertEqual((solid["kind"], len(cells)), SOLIDS[name][:2])
        low, high = SOLIDS[name][2:]
        self.assertLess(np.abs(points.min(axis=0) - low - displacement).max(), 1e-6)
        self.assertLess(np.abs(points.max(axis=0) - high - displacement).max(), 1e-6)
        a, b, c = (points[cells[:, k]] for k in range(3))
        normal = np.cross(b - a, c - a)
        middle = points.mean(axis=0) if name != "floor" else points.mean(axis=0) - [0, 1, 0]
        self.assertTrue((((a + b + c) / 3 - middle) * normal).sum(axis=1).min() > 0, "faces outwards")

    def check_solids(self, directory, moving):
        report = json.loads((directory / "report.json").read_text())
        wanted = set()
        for solid in report["solids"]:
            name = solid["name"]
            self.assertIs(solid["moving"], name in moving)
            path = directory / solid["file"]
            wanted.add(path.name)
            if name not in moving:
                self.assertEqual(solid["file"], f"solids/{name}.vtk")
                self.check_solid(directory, report, path, [0, 0, 0], name)
                continue
            self.assertEqual(solid["file"], f"solids/{name}.vtk.series")
            files = json.loads(path.read_text())["files"]
            body = self.series(self.report["bodies"][0])["files"]
            self.assertEqual([f["time"] for f in files], [f["time"] for f in body])
            for file in files:
                wanted.add(file["name"])
                self.check_solid(directory, report, path.parent / file["name"], [file["time"], 0, 0], name)
        self.assertEqual({path.name for path in (directory / "solids").iterdir()}, wanted)

    def test_solids(self):
        tank = json.loads(pathlib.Path(SCENE).read_text())["solids"][0]
        ball = {"name": "ball", "sphere": {"center": [0, 2, 0], "radius": 0.5}}
        floor = {"name": "floor", "plane": {"center": [0, -1, 0], "normal": [0, 1, 0], "size": 4}}
        motion = {"motion": [{"time": 0}, {"time": 1, "translate": [1, 0, 0]}]}
        with tempfile.TemporaryDirectory() as name:
            directory = pathlib.Path(name)
            for moving in ({"ball", "floor"}, {"tank"}, set()):
                with self.subTest(moving=moving):
                    solids = [s | (motion if s["name"] in moving else {}) for s in (tank, ball, floor)]
                    done = run(name, "--time", str(TIME), "--set", f"solids={json.dumps(solids)}")
                    self.assertEqual(done.returncode, 0, done.stderr)
                    self.check_solids(directory, moving)

    def test_metrics(self):
        with open(self.directory / "metrics.csv", newline="") as file:
            header, *rows = csv.reader(file)
        self.assertEqual(header, COLUMNS)
        self.assertEqual(len(rows), self.report["steps"])
        table = np.array(rows, dtype=float)
        self.assertTrue(np.isfinite(table).all())
        time, h = table[:, 0], table[:, 1]
        self.assertTrue(np.allclose(np.cumsum(h), time, rtol=1e-6))
        self.assertAlmostEqual(time[-1], self.report["simulated_s"], delta=1e-8)
        for key in ("outer_iterations", "linear_iterations", "step_residual"):
            column = COLUMNS.index(key)
            self.assertAlmostEqual(self.report[key]["mean"], table[:, column].mean(),
                                   delta=1e-6 * max(1, table[:, column].mean()))
            self.assertAlmostEqual(self.report[key]["max"], table[:, column].max(),
                                   delta=1e-6 * max(1, table[:, column].max()))
        self.assertAlmostEqual(self.report["density_error"]["worst_mean"], table[:, 5].max(), 6)
        self.assertEqual(self.report["particles"]["peak"], table[:, 4].max())
        self.assertAlmostEqual(self.report["time_step"]["min"], h.min(), delta=1e-9)
        end = self.report["energy"]["end"]
        told = [end["kinetic"], end["potential"], end["constraint"],
                *self.report["momentum"]["end"], *self.report["pin_reaction"]]
        self.assertTrue(np.allclose(told, table[-1, 8:17], rtol=1e-7, atol=1e-12))
        self.assertAlmostEqual(self.report["pin_reaction_N"], np.linalg.norm(table[-1, 14:17]), 5)

    def test_statistics(self):
        """A hard impact in few iterations: the report has means, sums and extremes of the columns."""
        with tempfile.TemporaryDirectory() as name:
            done = run(name, "--time", "0.06", "--no-frames", "--set", "bodies.water.velocity=[0, -2, 0]",
                       "--set", "solver.outer_iterations=3", "--set", "time_step.cfl=0.4")
            self.assertEqual(done.returncode, 0, done.stderr)
            report = json.loads((pathlib.Path(name) / "report.json").read_text())
            with open(pathlib.Path(name) / "metrics.csv", newline="") as file:
                header, *rows = csv.reader(file)
        column = dict(zip(header, np.array(rows, dtype=float).T))
        residual = {body["name"]: column["residual_" + body["name"]] for body in report["bodies"]}
        error, most, h = column["density_error_mean"], column["density_error_max"], column["h_s"]
        told = [*report["impacts"].values(), *report["density_error"].values(), report["retries"],
                *(report["time_step"][k] for k in ("min", "mean", "max")), report["unsolved_steps"],
                *(report["ms"][k] for k in ("neighbours", "local", "global", "contact")),
                *(body["step_residual"][k] for body in report["bodies"] for k in ("mean", "max"))]
        wanted = [column["impacts"].mean(), column["impacts"].max(),
                  error.mean(), error.max(), most.mean(), most.max(), column["retries"].sum(),
                  h.min(), h.mean(), h.max(), (column["step_residual"] > 0.1).sum(),
                  *(column["ms_" + k].mean() for k in ("neighbours", "local", "global", "contact")),
                  *(value for r in residual.values() for value in (r.mean(), r.max()))]
        self.assertTrue(np.allclose(told, wanted, rtol=1e-7, atol=1e-12), (told, wanted))
        self.assertTrue((np.maximum(*residual.values()) == column["step_residual"]).all())
        for warning in report["warnings"]:
            unsolved = column["time_s"][residual[warning["subject"]] > 0.1]
            self.assertEqual((warning["code"], warning["count"]), ("unsolved", len(unsolved)))
            self.assertTrue(np.allclose([warning["first_s"], warning["last_s"]], unsolved[[0, -1]]))
        self.assertEqual(len(report["warnings"]), 2)

    def test_report(self):
        for path in REPORT:
            value = self.report
            for key in path.split("."):
                self.assertIn(key, value, path)
                value = value[key]
            if path != "failed":
                self.assertIsNotNone(value, path)
        report = self.report
        self.assertTrue(finite_numbers(report))
        self.assertEqual(report["scene"], SCENE)
        self.assertIs(report["interrupted"], False)
        self.assertIsNone(report["failed"])
        self.assertGreaterEqual(report["simulated_s"], TIME - 1e-6)
        self.assertLess(report["simulated_s"], TIME + 1.001 * report["time_step"]["max"])
        self.assertRegex(report["state_hash"], "^[0-9a-f]{16}$")
        counts = {"particles": 0, "surface": 0}
        for body in report["bodies"]:
            counts[body["kind"]] += body["count"]
        self.assertEqual((report["particles"]["fluid"], report["particles"]["cloth"]),
                         (counts["particles"], counts["surface"]))
        self.assertTrue(all(count > 0 for count in report["constraints"].values()))
        fluid = next(c for c in report["parameters"] if c["type"] == "fluid")
        self.assertEqual(fluid["body"], "water")
        self.assertGreater(fluid["numbers"]["stiffness"], 0)
        self.assertGreater(fluid["numbers"]["sound_speed"], 0)
        for moment in report["energy"].values():
            parts = moment["kinetic"] + moment["potential"] + moment["constraint"]
            self.assertAlmostEqual(parts, moment["total"], delta=1e-9 * (1 + abs(parts)))

    def test_nothing_half_written(self):
        self.assertEqual([path.name for path in self.directory.iterdir()
                          if path.suffix == ".tmp"], [])

    def test_a_shorter_run_leaves_no_old_frames(self):
        with tempfile.TemporaryDirectory() as name:
            directory = pathlib.Path(name)
            body = self.report["bodies"][0]["name"]
            kept = {directory / f"{body}_notes.txt", directory / f"{body}_999999.vtk"}
            self.assertEqual(run(directory, "--time", str(TIME), "--ply").returncode, 0)
            for path in kept:
                path.write_text("mine")
            self.assertEqual(run(directory, "--time", str(self.interval)).returncode, 0)
            frames = {directory / f"{b['name']}_{k:06d}.vtk"
                      for b in self.report["bodies"] for k in range(2)}
            self.assertEqual({path for path in directory.glob("*_*")}, kept | frames)
            self.assertTrue(all(path.read_text() == "mine" for path in kept))

    def test_another_scene_leaves_its_files_alone(self):
        """After a run the directory holds the files of that run, and those of others."""
        alone = {"duration": 0.1, "frame_interval": 0.1, "bodies": [{
            "name": "cloth", "surface": {"grid": {"size": [1, 1], "vertices": [5, 5]},
                                         "area_density": 0.2},
            "constraints": [{"type": "spring", "stretching_stiffness": 100}]}]}
        solids = [{"name": "rest", "sphere": {"center": [0, -3, 0], "radius": 0.1}},
                  {"name": "moved", "sphere": {"center": [0, -2, 0], "radius": 0.1},
                   "motion": [{"time": 0}, {"time": 1, "translate": [0.1, 0, 0]}]}]
        long_name = "b" * 64
        several = dict(alone, solids=solids, bodies=[
            dict(alone["bodies"][0], name=long_name),
            {"name": "water", "particles": {"radius": 0.05, "fill": [
                {"box": {"minimum": [0, 1, 0], "maximum": [0.5, 1.5, 0.5]}}]},
             "constraints": [{"type": "fluid", "compression": 0.01}]}])

        def files_of(scene, directory, *options):
            path = directory.parent / "scene.json"
            path.write_text(json.dumps(scene))
            subprocess.run([PROJDYN, "run", path, "-o", directory, "--quiet", *options], check=True,
                           capture_output=True, timeout=600)
            return {str(p.relative_to(directory)) for p in directory.rglob("*") if p.is_file()}

        with tempfile.TemporaryDirectory() as name:
            expected = files_of(alone, pathlib.Path(name) / "alone")
            directory = pathlib.Path(name) / "both"
            old = files_of(several, directory, "--ply")
            self.assertLessEqual({f"{long_name}.obj", "water_000001.ply", "solids/rest.vtk",
                                  "solids/moved_000001.vtk", "boundary.vtk.series"}, old)
            subprocess.run([PROJDYN, "mesh", directory], check=True, capture_output=True,
                           timeout=600)
            kept = {"notes.txt", "water.obj", "water_999999.vtk", "solids/mine.vtk",
                    "mesh/mine_000000.obj"}
            for file in kept:
                (directory / file).write_text("mine")
            self.assertEqual(files_of(alone, directory), expected | kept)
            self.assertTrue(all((directory / file).read_text() == "mine" for file in kept))

    def test_a_list_of_files_of_others_is_ignored(self):
        with tempfile.TemporaryDirectory() as name:
            directory = pathlib.Path(name) / "run"
            (directory / "solids").mkdir(parents=True)
            kept = [pathlib.Path(name) / "mine.obj", directory / "mine.txt", directory / "mine.csv"]
            for path in kept:
                path.write_text("mine")
            (directory / "files.json").write_text(json.dumps({"files": [
                "../mine.obj", "solids/../mine.txt", "mine.txt", "mine.csv", 7, None, ".vtk",
                str(kept[0])], "series": ["../mine", "", 3]}))
            self.assertEqual(run(directory, "--time", str(self.interval)).returncode, 0)
            self.assertTrue(all(path.read_text() == "mine" for path in kept))

    def test_metrics_through_a_link_are_refused(self):
        with tempfile.TemporaryDirectory() as name:
            (pathlib.Path(name) / "metrics.csv").symlink_to("/dev/full")
            done = run(name, "--time", str(TIME))
            self.assertEqual(done.returncode, 2)
            self.assertIn("metrics.csv: expected a regular file with a single name", done.stderr)

    def test_a_file_that_does_not_fit_leaves_nothing(self):
        with tempfile.TemporaryDirectory() as name:
            done = run(name, "--time", str(TIME), limit=4096)
            self.assertNotEqual(done.returncode, 0)
            self.assertRegex(done.stderr, r"\.vtk: writing failed: File too large")
            self.assertEqual([path.name for path in pathlib.Path(name).iterdir()
                              if path.suffix in (".tmp", ".vtk")], [])

    def test_a_file_in_the_way_is_told(self):
        with tempfile.NamedTemporaryFile() as file:
            done = run(pathlib.Path(file.name) / "out", "--time", str(TIME))
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(f"{file.name}: cannot make the directory: File exists", done.stderr)


if __name__ == "__main__":
    PROJDYN, SCENE = sys.argv[1:3]
    unittest.main(argv=sys.argv[:1])
