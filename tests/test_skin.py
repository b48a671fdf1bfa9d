"""The mesh that `cell` has filled follows its tetrahedra in what `mesh`, `usd` and `replay` write.

Usage: test_skin.py PROJDYN
"""
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
    import meshio
    import numpy as np
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

sys.path.append(str(pathlib.Path(__file__).parent.parent / "blender/projdyn"))
import run_directory  # noqa: E402

PROJDYN = os.path.abspath(sys.argv[1])
TURNS = 3.0  # rad/s
MESH = {"mesh": "ball.obj", "scale": 0.5, "rotate": [10, 20, 30], "cell": 0.05, "density": 1000}
SCENE = {
    "duration": 0.2, "frame_interval": 0.1, "gravity": [0, 0, 0], "solver": {"tolerance": 1e-6},
    "bodies": [{"name": "soft", "volume": {**MESH, "translate": [5, 0, 0]}, "velocity": [0, 0, 1],
                "constraints": [{"type": "tet", "stiffness": 1e4},
                                {"type": "attachment", "to": "box", "vertices": {"vertices": [0, 7, 20]}, "stiffness": 1e-6}]},
               {"name": "rock", "rigid": {**MESH, "angular_velocity": [0, 0, TURNS]}},
               {"name": "box", "rigid": {"box": {"minimum": [9, 0, 0], "maximum": [9.1, 0.1, 0.1]}, "density": 1}}]}


def ball(n=24):
    """Vertices and triangles of a sphere with waves finer than the cells."""
    phi = 2 * np.pi * np.arange(n) / n
    theta = np.pi * np.arange(1, n) / n
    ring = np.array([[np.sin(t) * np.cos(p), np.cos(t), np.sin(t) * np.sin(p)] for t in theta for p in phi])
    x = np.vstack([ring, [[0, 1, 0], [0, -1, 0]]]) * 0.3
    x *= 1 + 0.05 * np.sin(40 * x[:, :1])
    quads = [(r * n + k, r * n + (k + 1) % n, (r + 1) * n + k, (r + 1) * n + (k + 1) % n)
             for r in range(n - 2) for k in range(n)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (b, d, c))]
    last, top, bottom = (n - 2) * n, len(ring), len(ring) + 1
    triangles += [(top, (k + 1) % n, k) for k in range(n)]
    triangles += [(bottom, last + k, last + (k + 1) % n) for k in range(n)]
    return x, np.array(triangles)


def rotation(degrees):
    matrix = np.eye(3)
    for axis, angle in enumerate(np.radians(degrees)):
        c, s = np.cos(angle), np.sin(angle)
        turn = np.eye(3)
        i, j = (axis + 1) % 3, (axis + 2) % 3
        turn[i, i], turn[i, j], turn[j, i], turn[j, j] = c, -s, s, c
        matrix = turn @ matrix
    return matrix


class Skin(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.holder = tempfile.TemporaryDirectory()
        cls.directory = pathlib.Path(cls.holder.name)
        x, triangles = ball()
        with open(cls.directory / "ball.obj", "w") as file:
            file.writelines(f"v {p[0]:.17g} {p[1]:.17g} {p[2]:.17g}\n" for p in x)
            file.writelines("f %d %d %d\n" % tuple(t[::-1] + 1) for t in triangles)  # facing inwards
        cls.placed = 0.5 * x @ rotation(MESH["rotate"]).T
        cls.triangles = len(triangles)
        (cls.directory / "scene.json").write_text(json.dumps(SCENE))
        cls.program("run", "scene.json", "-o", "run", "--threads", "1", "--quiet")
        os.remove(cls.directory / "ball.obj")  # the run is complete without it
        cls.program("mesh", "run", "--threads", "1")

    @classmethod
    def tearDownClass(cls):
        cls.holder.cleanup()

    @classmethod
    def program(cls, *arguments):
        done = subprocess.run([PROJDYN, *arguments], cwd=cls.directory, capture_output=True, text=True)
        assert not done.returncode, done.stderr
        return done

    def frame(self, name, k):
        mesh = meshio.read(self.directory / f"run/mesh/{name}_{k:06d}.vtk")
        self.assertEqual(len(mesh.cells_dict["triangle"]), self.triangles)
        return mesh

    def test_at_rest_it_is_the_mesh_of_the_scene(self):
        np.testing.assert_allclose(self.frame("rock", 0).points, self.placed, atol=1e-7)
        np.testing.assert_allclose(self.frame("soft", 0).points, self.placed + [5, 0, 0], atol=1e-6)

    def test_a_rigid_body_turns_it(self):
        first, last = self.frame("rock", 0), self.frame("rock", 2)
        turned = first.points @ rotation([0, 0, np.degrees(0.2 * TURNS)]).T
        move = (last.points - turned).mean(axis=0)  # the centre of mass is not the origin
        self.assertLess(np.linalg.norm(move), 0.01)
        np.testing.assert_allclose(last.points, turned + move, atol=2e-4)  # of the time integration
        x = last.points - last.points.mean(axis=0)
        np.testing.assert_allclose(np.linalg.norm(x, axis=1),
                                   np.linalg.norm(first.points - first.points.mean(axis=0), axis=1), atol=1e-6)
        speed = np.linalg.norm(last.point_data["velocity"], axis=1)
        np.testing.assert_allclose(speed, TURNS * np.linalg.norm(x[:, :2], axis=1), atol=0.02)

    def test_a_soft_body_moves_it(self):
        moved = self.frame("soft", 2).points - self.frame("soft", 0).points
        np.testing.assert_allclose(moved, np.tile([0, 0, 0.2], (len(moved), 1)), atol=1e-5)

    def test_normals_face_outwards(self):
        mesh = self.frame("rock", 0)
        self.assertGreater(np.einsum("ij,ij->i", mesh.points, mesh.point_data["normal"]).min(), 0)

    def test_other_commands_draw_it(self):
        self.program("usd", "run")
        stage = (self.directory / "run/run.usda").read_text()
        counts = [text.count(",") + 1 for text in re.findall(r"faceVertexCounts = \[(.*?)\]", stage)]
        self.assertEqual(counts, [self.triangles, self.triangles, 12])
        self.program("replay", "run", "-o", "page.html")
        page = (self.directory / "page.html").read_text()
        ends = json.loads(re.search(r'"strings": ?(\[.*?\}\])', page)[1])[0]["ends"]
        mesh, hull = self.frame("soft", 0), meshio.read(self.directory / "run/soft_000000.vtk")
        stored = json.loads((self.directory / "run/report.json").read_text())["strings"][0]["ends"]
        self.assertEqual(len(ends), len(stored))
        for (vertex, *corners), (own, *of_other) in zip(ends, stored):  # springs end near their vertices
            self.assertLess(np.linalg.norm(mesh.points[vertex] - hull.points[own]), 0.03)
            self.assertEqual(corners[:3], of_other[:3])

    def test_blender_and_paraview_show_it(self):
        for use_mesh, folder in ((True, "run/mesh"), (False, "run")):
            parts = run_directory.read_run(self.directory / "run", use_mesh)
            self.assertEqual([str(part.file.relative_to(self.directory)) for part in parts],
                             [f"{folder}/soft.vtk.series", f"{folder}/rock.vtk.series", "run/box.vtk.series"])
            self.assertEqual([part.role for part in parts], ["soft", "cloth", "cloth"])
            self.assertEqual([part.uv is None for part in parts], [use_mesh, use_mesh, False])

    def test_the_next_run_removes_it(self):
        shutil.copytree(self.directory / "run", self.directory / "again")
        scene = {**SCENE, "bodies": SCENE["bodies"][2:]}
        (self.directory / "box.json").write_text(json.dumps(scene))
        self.assertTrue((self.directory / "again/soft.skin.vtk").exists())
        self.program("run", "box.json", "-o", "again", "--threads", "1", "--quiet")
        self.assertEqual(list((self.directory / "again").glob("*.skin.vtk")), [])

    def test_a_skin_of_another_body_is_refused(self):
        shutil.copytree(self.directory / "run", self.directory / "wrong")
        shutil.copy(self.directory / "wrong/soft.skin.vtk", self.directory / "wrong/box.skin.vtk")
        done = subprocess.run([PROJDYN, "usd", "wrong"], cwd=self.directory, capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("expected the body of its .skin.vtk", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
