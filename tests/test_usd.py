"""`projdyn usd`: a reader of the text format, written for this test, finds the frames of the run.

Usage: test_usd.py PROJDYN
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

import devtools

PROJDYN = os.path.abspath(sys.argv[1])
SCENE = {
    "duration": 0.1, "frame_interval": 0.04, "time_step": {"maximum": 0.01},
    "solids": [{"name": "tank", "box": {"minimum": [-0.2, 0, -0.2], "maximum": [0.2, 0.4, 0.2]}, "open": ["+y"]},
               {"name": "paddle", "box": {"minimum": [-0.02, 0.25, -0.1], "maximum": [0.02, 0.35, 0.1]},
                "motion": [{"time": 0}, {"time": 1, "translate": [0, 0.5, 0]}]}],
    "bodies": [{"name": "2-water", "color": "#ff0080",
                "particles": {"radius": 0.02, "fill": [{"box": {"minimum": [-0.2, 0, -0.2], "maximum": [0.2, 0.12, 0.2]}}]},
                "constraints": [{"type": "fluid"}]},
               {"name": "sheet",
                "surface": {"grid": {"size": [0.3, 0.3], "vertices": [5, 5]}, "translate": [0, 0.2, 0], "area_density": 0.5},
                "constraints": [{"type": "spring", "stretching_stiffness": 1000}]}]}


def numbers(text):
    """Rows of the tuples of an array, or its numbers."""
    values = np.array([float(word) for word in re.findall(r"[-+.\de]+", text)])
    return values.reshape(-1, 3) if "(" in text else values


def read_stage(text):
    """Entries of the head; {prim: {"type": ..., "material": path, attribute: array, or {time code: array}}}; materials
    {path: {input: value}}."""
    head, rest = re.fullmatch(r"#usda 1\.0\n\(\n(.*?)\n\)\n\ndef Xform \"run\"\n\{(.*)\}\n", text, re.S).groups()
    rest, looks, scope = re.fullmatch(r"(.*)\n    def Scope \"(\w+)\"\n    \{(.*)    \}\n", rest, re.S).groups()
    prims, found = {}, 0
    for kind, name, body in re.findall(
            r"\n    def (\w+) \"(\w+)\" \(\n        prepend apiSchemas = \[\"MaterialBindingAPI\"\]\n    \)\n    \{\n"
            r"(.*?)\n    \}\n", rest, re.S):
        prim = prims[name] = {"type": kind, "twoSided": "        uniform bool doubleSided = 1\n" in body}
        found += 1
        prim["material"], = re.findall(r"^        rel material:binding = <(.*)>$", body, re.M)
        for key, array in re.findall(r"^        [\w\[\]]+ ([\w:]+) = \[(.*)\]", body, re.M):
            prim[key] = numbers(array)
        for key, samples in re.findall(r"^        [\w\[\]]+ (\w+)\.timeSamples = \{\n(.*?)\n        \}", body, re.M | re.S):
            prim[key] = {float(time): numbers(array)
                         for time, array in re.findall(r"^            (\S+): \[(.*)\],$", samples, re.M)}
    assert found == rest.count("def "), "a prim of another form"
    return dict(line.strip().split(" = ") for line in head.split("\n")), prims, read_materials(looks, scope)


def read_materials(looks, scope):
    """The materials of the prim `looks`, each with one shader."""
    form = (r"\n        def Material \"(\w+)\"\n        \{\n"
            r"            token outputs:surface\.connect = <(/run/\w+/\w+)/surface\.outputs:surface>\n\n"
            r"            def Shader \"surface\"\n            \{\n"
            r"                uniform token info:id = \"UsdPreviewSurface\"\n(.*?)"
            r"                token outputs:surface\n            \}\n        \}\n")
    assert not re.sub(form, "", scope, flags=re.S).strip(), "a material of another form"
    materials = {}
    for name, path, inputs in re.findall(form, scope, re.S):
        assert path == f"/run/{looks}/{name}", path
        materials[path] = {key: numbers(value) for key, value in
                           re.findall(r"^                (?:color3f|float) inputs:(\w+) = (.*)$", inputs, re.M)}
    return materials


class Usd(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.holder = tempfile.TemporaryDirectory()
        cls.directory = pathlib.Path(cls.holder.name)
        (cls.directory / "scene.json").write_text(json.dumps(SCENE))
        cls.program("run", "scene.json", "-o", "run", "--threads", "1", "--quiet")
        cls.program("usd", "run", "-o", "particles.usda")
        cls.program("mesh", "run", "--threads", "1")
        cls.program("usd", "run")
        cls.times = [frame["time"] for frame in json.loads((cls.directory / "run/sheet.vtk.series").read_text())["files"]]

    @classmethod
    def tearDownClass(cls):
        cls.holder.cleanup()

    @classmethod
    def program(cls, *arguments):
        subprocess.run([PROJDYN, *arguments], cwd=cls.directory, check=True, capture_output=True)

    def stage(self, name):
        return read_stage((self.directory / name).read_text())

    def check_samples(self, samples, file, of):
        self.assertEqual(list(samples), [0.0, 1.0, 2.0])
        for k, values in samples.items():
            mesh = meshio.read(self.directory / f"run/{file}_{int(k):06d}.vtk")
            np.testing.assert_allclose(values, of(mesh), rtol=1e-3, atol=1e-6)

    def test_head(self):
        head, _, _ = self.stage("run/run.usda")
        self.assertEqual((head["upAxis"], head["metersPerUnit"], head["endTimeCode"]), ('"Y"', "1", "2"))
        self.assertAlmostEqual(float(head["timeCodesPerSecond"]), 1 / (self.times[1] - self.times[0]))

    def test_z_up(self):
        (self.directory / "z_up.json").write_text(json.dumps({**SCENE, "gravity": [0, 0, -9.81]}))
        self.program("run", "z_up.json", "-o", "z_up", "--time", "0.01", "--quiet")
        self.program("usd", "z_up")
        self.assertEqual(self.stage("z_up/run.usda")[0]["upAxis"], '"Z"')

    def test_uneven_times(self):
        """Frames at any times, as a program writes them: the last one ends the stage."""
        run = self.directory / "uneven"
        shutil.copytree(self.directory / "run", run, ignore=shutil.ignore_patterns("mesh"))
        for path in run.glob("**/*.vtk.series"):
            series = json.loads(path.read_text())
            series["files"][2]["time"] = 10 * series["files"][1]["time"]
            path.write_text(json.dumps(series))
        self.program("usd", "uneven")
        head, prims, _ = self.stage("uneven/run.usda")
        self.assertEqual((list(prims["sheet"]["points"]), head["endTimeCode"]), ([0.0, 1.0, 10.0], "10"))

    def test_long_name(self):
        """A name longer than that of any body has no room as the name of a prim."""
        run = self.directory / "long"
        shutil.copytree(self.directory / "run", run)
        path, name = run / "report.json", 40 * "sheet"
        path.write_text(path.read_text().replace('"sheet"', f'"{name}"'))
        (run / "sheet.vtk.series").rename(run / f"{name}.vtk.series")
        done = subprocess.run([PROJDYN, "usd", "long"], cwd=self.directory, text=True, stderr=subprocess.PIPE)
        self.assertEqual(done.returncode, 2)
        self.assertIn("bodies[1]: expected a \"name\" without '/' of at most 64 bytes", done.stderr)

    def test_no_report(self):
        """Without the report a sheet and water cannot be told apart, and particles have no radius."""
        run = self.directory / "bare"
        shutil.copytree(self.directory / "run", run)
        (run / "report.json").unlink()
        self.program("usd", "bare")  # files.json says the same
        (run / "files.json").unlink()
        done = subprocess.run([PROJDYN, "usd", "bare"], cwd=self.directory, text=True, stderr=subprocess.PIPE)
        self.assertEqual(done.returncode, 2)
        self.assertIn("bare: expected report.json or files.json of a run, found neither", done.stderr)

    def test_surface(self):
        _, prims, _ = self.stage("run/run.usda")
        self.check_samples(prims["sheet"]["points"], "sheet", lambda mesh: mesh.points)
        self.check_samples(prims["sheet"]["velocities"], "sheet", lambda mesh: mesh.point_data["velocity"])
        self.assertEqual(prims["sheet"]["faceVertexCounts"].tolist(), [3] * 32)
        self.assertLess(prims["sheet"]["faceVertexIndices"].max(), 25)

    def test_particles(self):
        _, prims, _ = self.stage("particles.usda")
        water = prims["_2_water_0"]
        self.assertEqual((water["type"], water["widths"].tolist()), ("Points", [0.04]))
        self.check_samples(water["points"], "2-water", lambda mesh: mesh.points)
        np.testing.assert_allclose(water["primvars:displayColor"], [[1, 0, 0.2159]], atol=1e-3)

    def test_materials(self):
        """Every prim has a material; those of water and of a tank are seen through."""
        _, prims, materials = self.stage("run/run.usda")
        self.assertEqual(set(materials), {f"/run/Looks/{name}" for name in prims})
        for name, prim in prims.items():
            material = materials[prim["material"]]
            self.assertEqual(prim["material"], f"/run/Looks/{name}")
            np.testing.assert_allclose(material["diffuseColor"], prim["primvars:displayColor"])
            self.assertEqual(material["opacity"], prim["primvars:displayOpacity"])
        opacity, colour, rough = ({name: materials[f"/run/Looks/{name}"][key] for name in prims}
                                  for key in ("opacity", "diffuseColor", "roughness"))
        self.assertLess(max(opacity["tank"], opacity["_2_water_0"]), 0.5)
        self.assertEqual((opacity["sheet"], opacity["paddle"]), (1, 1))
        self.assertGreater(rough["sheet"], rough["_2_water_0"])
        self.assertGreater(colour["sheet"][0][0], colour["sheet"][0][2] + 0.2)  # the sand of pictures
        self.assertEqual([name for name in prims if prims[name]["twoSided"]], ["sheet", "tank"])
        self.assertEqual(materials[prims["_2_water_0"]["material"]]["ior"], 1.333)

    @unittest.skipUnless(devtools.find(), "no chromium")
    def test_looks_are_those_of_pictures(self):
        """Colours of parts without one, and which boxes are tanks: usd_look.c against the page of a replay."""
        def box(x, y, size, **more):
            return {"box": {"minimum": [x, y, -size / 2], "maximum": [x + size, y + size, size / 2]}, **more}

        def water(x, *constraints):
            return {"particles": {"radius": 0.02, "fill": [box(x, 0, 0.08)]}, "constraints": list(constraints)}

        def sheet(x, **surface):
            return {"surface": {"translate": [x, 0.5, 0], "area_density": 0.1, **surface},
                    "constraints": [{"type": "spring", "stretching_stiffness": 100}]}

        (self.directory / "bag.obj").write_text("v 0 0 0\nv .1 0 0\nv 0 .1 0\nv 0 0 .1\n"
                                                "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
        bodies = [water(0.3 * k, {"type": "fluid"}) for k in range(3)] + [water(0.9), sheet(1.5, mesh="bag.obj")]
        for k in range(5):
            bodies += [sheet(0.3 * k, grid={"size": [0.2, 0.2], "vertices": [3, 3]}), {"rigid": box(0.3 * k, 1, 0.1, density=500)}]
        solids = [box(-1, -1, 4, name="room"), box(-0.5, 0, 0.1, name="cup", open=["+y"]), box(-0.8, 0, 0.1, name="stone")]
        (self.directory / "looks.json").write_text(json.dumps({"duration": 0.01, "bodies": bodies, "solids": solids}))
        self.program("run", "looks.json", "-o", "looks", "--threads", "1", "--quiet")
        self.program("usd", "looks")
        self.program("replay", "looks")
        _, prims, materials = self.stage("looks/run.usda")
        browser = devtools.Browser((self.directory / "looks/replay.html").as_uri(), self.directory, (480, 300))
        try:
            browser.wait("document.body?.classList.contains('ready')")
            drawn = browser.evaluate("renderer.parts.filter((s) => s.part.triangles || !s.solid).map((s) => [s.part.name, s instanceof Glass, s.tint])")
        finally:
            browser.close()
        self.assertEqual(set(prims), {name for name, _, _ in drawn})
        self.assertEqual({name for name, glass, _ in drawn if glass}, {"room", "cup"})
        self.assertEqual({name for name in prims if materials[prims[name]["material"]]["opacity"] == 0.1}, {"room", "cup"})
        for name, glass, tint in drawn:
            value = np.sqrt(tint)  # the gamma of the page is 2
            linear = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
            if not glass:
                np.testing.assert_allclose(prims[name]["primvars:displayColor"], [linear], atol=1e-3, err_msg=name)

    def test_particles_are_opaque(self):
        _, prims, materials = self.stage("particles.usda")
        self.assertEqual(materials[prims["_2_water_0"]["material"]]["opacity"], 1)

    def test_body_with_the_name_of_the_materials(self):
        sheet = dict(SCENE["bodies"][1], name="Looks")
        (self.directory / "looks.json").write_text(json.dumps({"duration": 0.01, "bodies": [sheet]}))
        self.program("run", "looks.json", "-o", "looks", "--threads", "1", "--quiet")
        self.program("usd", "looks")
        _, prims, materials = self.stage("looks/run.usda")
        self.assertEqual((prims["Looks"]["material"], list(materials)), ("/run/Looks_/Looks", ["/run/Looks_/Looks"]))

    def test_surface_of_a_fluid(self):
        _, prims, _ = self.stage("run/run.usda")
        water = prims["_2_water_0"]
        self.assertEqual(water["type"], "Mesh")
        self.check_samples(water["points"], "mesh/2-water", lambda mesh: mesh.points)
        self.check_samples(water["normals"], "mesh/2-water", lambda mesh: mesh.point_data["normal"])
        self.check_samples({k: v.reshape(-1, 3) for k, v in water["faceVertexIndices"].items()}, "mesh/2-water",
                           lambda mesh: mesh.cells_dict["triangle"])

    def check_refused(self, *found):
        """`projdyn usd run` names the meshes, what it found there and what to do."""
        done = subprocess.run([PROJDYN, "usd", "run", "-o", "refused.usda"], cwd=self.directory, text=True,
                              stderr=subprocess.PIPE)
        self.assertEqual(done.returncode, 2)
        for word in ("run/mesh/2-water", "projdyn mesh run", *found):
            self.assertIn(word, done.stderr)
        self.assertFalse((self.directory / "refused.usda").exists())

    def test_refused_endings(self):
        for name in ("run.usdc", "run.abc", "usda"):
            done = subprocess.run([PROJDYN, "usd", "run", "-o", name], cwd=self.directory, text=True,
                                  stderr=subprocess.PIPE)
            self.assertEqual(done.returncode, 2)
            self.assertIn("expected a file ending with .usda or .usd", done.stderr)
            self.assertFalse((self.directory / name).exists())

    def test_surface_without_some_frames(self):
        series = self.directory / "run/mesh/2-water.vtk.series"
        whole = series.read_text()
        self.addCleanup(series.write_text, whole)
        self.program("mesh", "run", "--threads", "1", "--frames", "0:1")
        self.check_refused(".vtk.series: expected the 3 frames", "found 2")

    def test_surface_of_another_format(self):
        series = self.directory / "run/mesh/2-water.vtk.series"
        whole = series.read_text()
        self.addCleanup(series.write_text, whole)
        self.program("mesh", "run", "--threads", "1", "--format", "ply")
        series.unlink()
        self.check_refused("2-water_000000.ply: expected a mesh with --format vtk")

    def test_surface_without_particles(self):
        disc = {"disc": {"center": [0, 0.2, 0], "radius": 0.06}, "direction": [0, -1, 0], "speed": 1, "start": 0.05}
        water = {"name": "water", "particles": {"radius": 0.02, "inlets": [disc]}, "constraints": [{"type": "fluid"}]}
        (self.directory / "jet.json").write_text(json.dumps({"duration": 0.1, "frame_interval": 0.05, "bodies": [water]}))
        self.program("run", "jet.json", "-o", "jet", "--threads", "1", "--quiet")
        self.program("mesh", "jet", "--threads", "1")
        self.program("usd", "jet")
        points = read_stage((self.directory / "jet/run.usda").read_text())[1]["water"]["points"]
        self.assertEqual([len(points[time]) > 0 for time in sorted(points)], [False, True, True])

    def test_surface_of_other_times(self):
        series = self.directory / "run/mesh/2-water.vtk.series"
        whole = series.read_text()
        self.addCleanup(series.write_text, whole)
        changed = json.loads(whole)
        changed["files"][2]["time"] += 0.01
        series.write_text(json.dumps(changed))
        self.check_refused("expected the 3 frames", "other times")

    def test_solids(self):
        _, prims, _ = self.stage("run/run.usda")
        self.assertEqual(prims["tank"]["points"].shape, (8, 3))
        paddle = prims["paddle"]["points"]
        for k, time in enumerate(self.times):
            self.assertAlmostEqual(paddle[k][:, 1].max(), 0.35 + 0.5 * time, 5)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
