"""Meshes of the surface of fluids by `projdyn mesh`, from particles whose surface is known.

Usage: test_surface_mesh.py PROJDYN
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import meshio
    import numpy as np
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

RADIUS = 0.01
SPACING = 2 * RADIUS
ISO = 0.5879  # COLOUR_ISO of app/mesh/colour_field.h


def words(array, kind):
    return np.ascontiguousarray(array, dtype=kind).tobytes()


def write_frame(path, x, triangles=None, data=True):
    """A frame as `projdyn run` writes it: particles, or a surface if there are triangles."""
    corners = np.arange(len(x)).reshape(-1, 1) if triangles is None else np.array(triangles)
    count, size = corners.shape
    text = f"# vtk DataFile Version 4.2\nprojdyn test\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS {len(x)} float\n"
    parts = [text.encode(), words(x, ">f4"), f"\nCELLS {count} {count * (size + 1)}\n".encode(),
             words(np.column_stack([np.full(count, size), corners]), ">i4"), f"\nCELL_TYPES {count}\n".encode(),
             words(np.full(count, {1: 1, 3: 5}[size]), ">i4"), b"\n"]
    if data:
        parts.append(f"POINT_DATA {len(x)}\n".encode())
        for name in ("density", "pressure") if triangles is None else ():
            parts += [f"SCALARS {name} float 1\nLOOKUP_TABLE default\n".encode(), words(np.zeros(len(x)), ">f4"), b"\n"]
        parts += [b"VECTORS velocity float\n", words(np.tile([1, 2, 3], (len(x), 1)), ">f4"), b"\n"]
    path.write_bytes(b"".join(parts))


def write_series(directory, name, frames):
    files = [{"name": f"{name}_{k:06d}.vtk", "time": 0.1 * k} for k in range(frames)]
    (directory / f"{name}.vtk.series").write_text(json.dumps({"file-series-version": "1.0", "files": files}))


def write_run(directory, fluids, sheet=None, solid=None):
    """fluids: name -> list of frames; sheet, solid: (points, triangles), the same in all frames."""
    bodies, solids, frames = [], [], len(next(iter(fluids.values())))
    for name, points in fluids.items():
        bodies.append({"name": name, "kind": "particles", "count": max(map(len, points)), "radius_m": RADIUS,
                       "rest_density": 1000})
        write_series(directory, name, frames)
        for k, x in enumerate(points):
            write_frame(directory / f"{name}_{k:06d}.vtk", np.reshape(x, (-1, 3)))
    if sheet:
        bodies.append({"name": "sheet", "kind": "surface", "count": len(sheet[0]), "triangles": len(sheet[1])})
        write_series(directory, "sheet", frames)
        for k in range(frames):
            write_frame(directory / f"sheet_{k:06d}.vtk", *sheet)
    if solid:
        solids.append({"name": "wall", "kind": "mesh", "moving": False, "file": "solids/wall.vtk"})
        (directory / "solids").mkdir()
        write_frame(directory / "solids/wall.vtk", *solid, data=False)
    parameters = [{"type": "fluid", "body": name, "numbers": {}} for name in fluids]
    report = {"bodies": bodies, "solids": solids, "parameters": parameters}
    (directory / "report.json").write_text(json.dumps(report))


def mesh(directory, *options):
    return subprocess.run([PROJDYN, "mesh", str(directory), *options], capture_output=True, text=True, timeout=300)


def read_obj(path):
    """Points and triangles, in double precision of the text."""
    x, triangles = [], []
    for line in path.read_text().splitlines():
        if line.startswith("v "):
            x.append([float(n) for n in line.split()[1:]])
        if line.startswith("f "):
            triangles.append([int(corner.split("/")[0]) - 1 for corner in line.split()[1:]])
    return np.reshape(x, (-1, 3)), np.reshape(triangles, (-1, 3)).astype(int)


def is_closed(triangles):
    """Whether every directed edge occurs once, and its opposite once."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    there = {tuple(edge) for edge in edges.tolist()}
    return len(there) == len(edges) and there == {(b, a) for a, b in there}


def volume(x, triangles):
    a, b, c = (x[triangles[:, k]] for k in range(3))
    return (a * np.cross(b, c)).sum() / 6


def smallest_angles(x, triangles):
    """Of each triangle, degrees."""
    corner = x[triangles]
    angles = []
    for k in range(3):
        p, q = corner[:, (k + 1) % 3] - corner[:, k], corner[:, (k + 2) % 3] - corner[:, k]
        length = np.linalg.norm(p, axis=1) * np.linalg.norm(q, axis=1)
        angles.append(np.degrees(np.arccos(np.clip((p * q).sum(axis=1) / length, -1, 1))))
    return np.min(angles, axis=0)


def lattice(*counts):
    """Centres of cubes of one spacing in a box that begins at the origin."""
    return SPACING * (np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), -1).reshape(-1, 3) + 0.5)


def ball(radius, noise=0.0):
    """Of a radius in spacings, around the origin; the noise is in spacings, too."""
    n = 2 * int(radius) + 3
    x = lattice(n, n, n) - SPACING * n / 2
    x = x[np.linalg.norm(x, axis=1) <= SPACING * radius]
    return x + SPACING * noise * np.random.default_rng(1).normal(size=x.shape)


def colour_field(points, x):
    """phi at points: direct sums over all particles."""
    def kernel(a, b):
        rest = 1 - ((a[:, None] - b[None]) ** 2).sum(axis=2) / (2 * SPACING) ** 2
        return np.maximum(rest, 0) ** 5
    return (kernel(points, x) / kernel(x, x).sum(axis=1)).sum(axis=1)


def square(height, size, cells):
    """A horizontal sheet, (points, triangles), around the origin."""
    side = np.linspace(-size / 2, size / 2, cells + 1)
    points = np.array([[x, height, z] for x in side for z in side])
    triangles = []
    for i in range(cells):
        for j in range(cells):
            a = i * (cells + 1) + j
            triangles += [[a, a + 1, a + cells + 2], [a, a + cells + 2, a + cells + 1]]
    return points, triangles


class Mesh(unittest.TestCase):
    def setUp(self):
        self.holder = tempfile.TemporaryDirectory()
        self.directory = pathlib.Path(self.holder.name)
        self.addCleanup(self.holder.cleanup)

    def surface(self, particles, name="water", **more):
        """Writes a run with one frame, makes its mesh and checks it; returns points and triangles."""
        write_run(self.directory, {name: [particles]}, **more)
        done = mesh(self.directory, "--format", "obj", "--threads", "2")
        self.assertEqual(done.returncode, 0, done.stderr)
        x, triangles = read_obj(self.directory / f"mesh/{name}_000000.obj")
        self.assertTrue(is_closed(triangles))
        self.assertGreater(volume(x, triangles), 0, "triangles face outwards")
        return x, triangles

    def check_volume(self, x, triangles, particles, tolerance):
        ratio = volume(x, triangles) / (len(particles) * SPACING ** 3)
        self.assertLess(abs(ratio - 1), tolerance, ratio)

    def test_ball(self):
        particles = ball(8.2, 0.05)
        x, triangles = self.surface(particles)
        self.check_volume(x, triangles, particles, 0.03)
        radius = (3 / (4 * np.pi) * len(particles)) ** (1 / 3) * SPACING
        away = np.linalg.norm(x, axis=1) / radius
        self.assertLess(np.abs(away - 1).max(), 0.07)
        self.assertGreater(smallest_angles(x, triangles).min(), 5)

    def test_column(self):
        """The faces of a column of still water are flat, half a spacing from its outer particles."""
        counts = 14, 24, 10
        particles = lattice(*counts)
        x, triangles = self.surface(particles)
        self.check_volume(x, triangles, particles, 0.02)
        for axis in range(3):
            others = [a for a in range(3) if a != axis]
            middle = np.all([np.abs(x[:, a] / SPACING - counts[a] / 2) < counts[a] / 2 - 3 for a in others], axis=0)
            for face in (0, counts[axis]):
                there = x[middle & (np.abs(x[:, axis] / SPACING - face) < 2), axis] / SPACING
                self.assertGreater(len(there), 10)
                self.assertLess(np.abs(there - face).max(), 0.05)

    def test_level_set(self):
        """Vertices lie where the slow sum over all particles has the level of the surface."""
        particles = ball(5, 0.08)
        x, _ = self.surface(particles)
        away = colour_field(x, particles) - ISO
        self.assertLess(abs(away.mean()), 0.03)
        self.assertLess(away.std(), 0.1)

    def test_one_particle(self):
        x, triangles = self.surface(np.array([[0.3, -0.2, 0.1]]))
        self.check_volume(x, triangles, [0], 1e-4)
        away = np.linalg.norm(x - [0.3, -0.2, 0.1], axis=1)
        self.assertLess(away.max() - away.min(), 1e-6)

    def test_no_particles(self):
        write_run(self.directory, {"water": [np.zeros((0, 3)), np.zeros((1, 3))]})
        for form in ("vtk", "ply", "obj"):
            done = mesh(self.directory, "--format", form)
            self.assertEqual(done.returncode, 0, done.stderr)
        x, triangles = read_obj(self.directory / "mesh/water_000000.obj")
        self.assertEqual((len(x), len(triangles)), (0, 0))
        self.assertIn(b"\nCELLS 0 0\n", (self.directory / "mesh/water_000000.vtk").read_bytes())

    def test_hole(self):
        """A hole in the water has a surface of its own, which faces into the hole."""
        particles = ball(9.2)
        particles = particles[np.linalg.norm(particles, axis=1) > 3.5 * SPACING]
        x, triangles = self.surface(particles)
        self.check_volume(x, triangles, particles, 0.05)
        self.assertLess(np.linalg.norm(x, axis=1).min(), 4 * SPACING)

    def test_two_fluids(self):
        fluids = {"left": [ball(3)], "right": [ball(4) + [1, 0, 0]]}
        write_run(self.directory, fluids)
        self.assertEqual(mesh(self.directory, "--format", "obj").returncode, 0)
        for name, (particles,) in fluids.items():
            x, triangles = read_obj(self.directory / f"mesh/{name}_000000.obj")
            self.assertTrue(is_closed(triangles))
            self.assertLess(np.abs(x.mean(axis=0) - particles.mean(axis=0)).max(), SPACING)

    def check_above(self, x, height):
        self.assertGreaterEqual(x[:, 1].min(), height - 1e-6)
        touching = x[:, 1] < height + 0.03 * SPACING
        self.assertGreater(touching.sum(), 500)

    def test_sheet(self):
        """Water on a sheet that is closer to its particles than half a spacing ends at the sheet."""
        particles = lattice(16, 8, 16) - SPACING * np.array([8, 0, 8])
        x, _ = self.surface(particles, sheet=square(0.3 * SPACING, 30 * SPACING, 15))
        self.check_above(x, 0.3 * SPACING)

    def test_wall(self):
        particles = lattice(16, 8, 16) - SPACING * np.array([8, 0, 8])
        x, _ = self.surface(particles, solid=square(-0.2 * SPACING, 30 * SPACING, 1))
        self.check_above(x, -0.2 * SPACING)

    def test_sharp_edges(self):
        """Water in a corner of walls fills it, and its surface meets them in a smooth line."""
        particles = lattice(16, 10, 16)
        corners = 40 * SPACING * np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
        walls = [[0, 1, 3], [0, 3, 2], [0, 5, 1], [0, 4, 5], [0, 2, 6], [0, 6, 4]]  # x = 0, y = 0, z = 0
        x, triangles = self.surface(particles, solid=(corners, walls))
        self.check_volume(x, triangles, particles, 0.02)
        x = x / SPACING
        self.assertGreater(x.min(), 0)
        self.assertLess(np.linalg.norm(x, axis=1).min(), 0.1)
        for axis in range(3):
            others = [a for a in range(3) if a != axis]
            edge = (np.abs(x[:, others]) < 0.05).all(axis=1) & (x[:, axis] < 8)
            self.assertLess(np.diff(np.sort(x[edge, axis])).max(), 1.1)
        line = [x[(x[:, 0] < 0.05) & (np.abs(x[:, 2] - z) < 0.5), 1].max() for z in range(3, 13)]
        self.assertLess(np.ptp(line), 0.05)
        self.assertLess(np.abs(np.mean(line) - 10), 0.4)

    def test_disturbed_water_fills_a_tank(self):
        """In the edges of a tank the mesh has no triangle across from wall to wall, up to the line of the water."""
        particles = lattice(16, 10, 16)
        particles += SPACING * 0.1 * np.random.default_rng(1).normal(size=particles.shape)
        corners = SPACING * np.array([[16 * i, 40 * j, 16 * k] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
        walls = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3], [0, 4, 5],
                 [0, 5, 1]]
        x, triangles = self.surface(particles, solid=(corners, walls))
        corner = x[triangles] / SPACING
        normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]) / 2
        across = np.sort(np.abs(normal), axis=1)[:, 1]  # areas seen along a wall
        self.assertLess(across[corner[:, :, 1].max(axis=1) < 9].max(), 0.01)
        for a in (0, 16):
            for b in (0, 16):
                away = np.abs(x[:, [0, 2]] / SPACING - [a, b]).max(axis=1)
                self.assertGreater(x[away < 0.05, 1].max() / SPACING, 9.4)

    def test_sheet_through_water(self):
        """Water on both sides of a sheet is one closed mesh, and keeps its volume."""
        particles = lattice(14, 12, 14) - SPACING * np.array([7, 6, 7])
        x, triangles = self.surface(particles, sheet=square(0, 30 * SPACING, 15))
        self.check_volume(x, triangles, particles, 0.03)

    def test_formats_agree(self):
        write_run(self.directory, {"water": [ball(4, 0.1)] * 2})
        for form in ("vtk", "ply", "obj"):
            self.assertEqual(mesh(self.directory, "--format", form).returncode, 0)
        x, triangles = read_obj(self.directory / "mesh/water_000001.obj")
        vtk = meshio.read(self.directory / "mesh/water_000001.vtk")
        ply = meshio.read(self.directory / "mesh/water_000001.ply")
        for other in (vtk, ply):
            self.assertTrue((other.points == x.astype(np.float32)).all())
            self.assertTrue((other.cells_dict["triangle"] == triangles).all())
        normal = np.column_stack([ply.point_data[k] for k in ("nx", "ny", "nz")])
        velocity = np.column_stack([ply.point_data[k] for k in ("vx", "vy", "vz")])
        self.assertTrue((vtk.point_data["normal"] == normal).all())
        self.assertTrue((vtk.point_data["velocity"] == velocity).all())
        self.assertLess(np.abs(np.linalg.norm(normal, axis=1) - 1).max(), 1e-5)
        self.assertGreater((normal * x).sum(axis=1).min(), 0, "normals point outwards")
        self.assertLess(np.abs(velocity - [1, 2, 3]).max(), 1e-5)
        series = json.loads((self.directory / "mesh/water.vtk.series").read_text())
        self.assertEqual(series["files"], [{"name": "water_000000.vtk", "time": 0.0},
                                           {"name": "water_000001.vtk", "time": 0.1}])

    def test_any_number_of_threads(self):
        write_run(self.directory, {"water": [ball(7, 0.3)]})
        files = set()
        for threads in ("1", "2", "7"):
            self.assertEqual(mesh(self.directory, "--threads", threads).returncode, 0)
            files.add((self.directory / "mesh/water_000000.vtk").read_bytes())
        self.assertEqual(len(files), 1)

    def test_frames(self):
        write_run(self.directory, {"water": [ball(2)] * 4})
        self.assertEqual(mesh(self.directory, "--frames", "1:2").returncode, 0)
        self.assertEqual({path.name for path in (self.directory / "mesh").iterdir()},
                         {"water.vtk.series", "water_000001.vtk", "water_000002.vtk"})
        series = json.loads((self.directory / "mesh/water.vtk.series").read_text())["files"]
        self.assertEqual([(file["name"], file["time"]) for file in series],
                         [("water_000001.vtk", 0.1), ("water_000002.vtk", 0.2)])

    def test_mistakes(self):
        write_run(self.directory, {"water": [ball(2)]})
        for options, words in ((["--frames", "0:1"], "expected frames up to 0, found 1"),
                               (["--frames", "2"], "expected A:B"), (["--format", "stl"], "expected vtk, ply or obj"),
                               (["--threads", "0"], "from 1 to 1024")):
            done = mesh(self.directory, *options)
            self.assertEqual(done.returncode, 2)
            self.assertIn(words, done.stderr)
        report = json.loads((self.directory / "report.json").read_text())
        for change, words in (({"parameters": []}, 'a body with the constraint "fluid"'),
                              ({"solids": [{"name": "wall", "file": "solids/wall.vtk"}]}, '"moving"'),
                              ({"bodies": [report["bodies"][0] | {"radius_m": 0}]}, "radius_m")):
            (self.directory / "report.json").write_text(json.dumps(report | change))
            done = mesh(self.directory)
            self.assertEqual(done.returncode, 2)
            self.assertIn(words, done.stderr)
        (self.directory / "report.json").write_text(json.dumps(report))
        write_frame(self.directory / "water_000000.vtk", *square(0, 1, 1))
        done = mesh(self.directory)
        self.assertEqual(done.returncode, 2)
        self.assertIn("water_000000.vtk: expected particles", done.stderr)
        (self.directory / "report.json").unlink()
        self.assertIn("report.json", mesh(self.directory).stderr)

    def test_too_far(self):
        write_run(self.directory, {"water": [np.array([[0, 0, 0], [1e6, 0, 0]])]})
        done = mesh(self.directory)
        self.assertEqual(done.returncode, 2)
        self.assertIn("point 1: expected coordinates up to", done.stderr)


if __name__ == "__main__":
    PROJDYN = sys.argv[1]
    unittest.main(argv=sys.argv[:1])
