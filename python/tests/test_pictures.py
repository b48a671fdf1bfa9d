"""projdyn.render, mesh and usd: files of a run by the program."""
import os
import pathlib
import re
import shutil
import tempfile
import unittest
from unittest import mock

import numpy as np

import projdyn
from scenes import hanging_sheet, tank_of_water

BROWSERS = ("chromium", "chromium-browser", "google-chrome")  # as in app/render/browser.c
SIZE = (64, 48)


def write(scene, directory, until):
    sim = scene.load()
    with sim.write(directory) as writer:
        for info in sim.run(until=until):
            writer.step(info)


class Files(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name)
        write(hanging_sheet(frame_interval=0.05), cls.path / "sheet", 0.1)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()


class Pictures(Files):
    def setUp(self):
        if not any(map(shutil.which, BROWSERS)):
            self.skipTest("no chromium")

    def render(self, file, **options):
        return projdyn.render(self.path / "sheet", self.path / file, size=SIZE, **options)

    def test_picture(self):
        picture = self.render("last.png")
        png = picture._repr_png_()
        self.assertEqual(png, (self.path / "last.png").read_bytes())
        self.assertEqual(tuple(int.from_bytes(png[k:k + 4], "big") for k in (16, 20)), SIZE)
        self.assertIsNone(picture._repr_html_())
        self.assertEqual(self.render("again.png", frame=2)._repr_png_(), png)
        self.assertNotEqual(self.render("first.png", time=0.01)._repr_png_(), png)
        turned = self.render("turned.png", camera=[{"time": 0, "yaw": 90}], view="surface=checker")
        self.assertNotEqual(turned._repr_png_(), png)

    def test_note(self):
        """What the program notes goes to the logger."""
        with self.assertLogs("projdyn", "WARNING") as log:
            self.render("late.png", time=9)
        self.assertIn("the run ends at 0.1 s", log.output[0])

    def test_numbered_pictures(self):
        pictures = self.render("sheet_%04d.png", frames=np.array([1, 2]))
        self.assertEqual([path.name for path in sorted(self.path.glob("sheet_*.png"))],
                         ["sheet_0001.png", "sheet_0002.png"])
        self.assertIsNone(pictures._repr_png_())
        self.assertIsNone(pictures._repr_html_())

    @unittest.skipUnless(shutil.which("ffmpeg"), "no ffmpeg")
    def test_films(self):
        self.assertIn('<video src="data:video/mp4;base64,', self.render("sheet.mp4", fps=10)._repr_html_())
        self.assertIn('<img src="data:image/gif;base64,', self.render("sheet.gif", turntable=0.2)._repr_html_())

    @unittest.skipUnless(shutil.which("ffmpeg"), "no ffmpeg")
    def test_a_fast_gif_keeps_its_length(self):
        """Programs show pictures of a GIF that are shorter than 2/100 s for 10/100 s."""
        film = self.render("fast.gif", turntable=0.2, fps=100).path.read_bytes()
        times = [int.from_bytes(film[k.end() + 1:k.end() + 3], "little") for k in re.finditer(b"\x21\xf9\x04", film)]
        self.assertGreaterEqual(min(times), 2)
        self.assertAlmostEqual(sum(times), 20, delta=2)


class Errors(Files):
    def test_options(self):
        for options, words in (({"file": "x.jpg"}, "expected a name that ends with .png"),
                               ({"time": "soon"}, "--time soon: expected a number"),
                               ({"size": (3, 3)}, "--size 3x3: expected WIDTHxHEIGHT, even numbers"),
                               ({"frame": 7}, "--frame 7: expected at most 2"),
                               ({"camera": [{"yaw": np.int64(0)}]}, '--camera .* missing key "time"')):
            with self.subTest(words), self.assertRaisesRegex(projdyn.InputError, f"^render: .*{words}"):
                projdyn.render(self.path / "sheet", **{"file": "x.png", **options})

    def test_no_run(self):
        for call in (lambda: projdyn.render("no_such", "x.png"), lambda: projdyn.mesh("no_such"),
                     lambda: projdyn.usd("no_such")):
            with self.assertRaisesRegex(projdyn.InputError, "^no_such: cannot read the directory"):
                call()

    def test_no_program(self):
        with mock.patch.dict(os.environ, {"PATH": "", "PROJDYN_PROGRAM": ""}), \
                mock.patch("projdyn._program.installed_file", return_value=None), \
                self.assertRaisesRegex(projdyn.Error, "set PROJDYN_PROGRAM to that of a build"):
            projdyn.usd(self.path / "sheet")
        with mock.patch.dict(os.environ, {"PROJDYN_PROGRAM": "/no/such"}), \
                self.assertRaisesRegex(projdyn.Error, "PROJDYN_PROGRAM: /no/such: there is no such program"):
            projdyn.usd(self.path / "sheet")

    def test_failure(self):
        """A failure that is not one of the arguments."""
        with self.assertRaisesRegex(projdyn.Error, "writing failed") as caught:
            projdyn.usd(self.path / "sheet", self.path / "no_such" / "sheet.usda")
        self.assertNotIsInstance(caught.exception, projdyn.InputError)


class Exports(Files):
    def test_usd(self):
        self.assertIn("#usda", projdyn.usd(self.path / "sheet").read_text())
        self.assertEqual(projdyn.usd(self.path / "sheet", self.path / "other.usda"), self.path / "other.usda")
        self.assertTrue(os.path.getsize(self.path / "other.usda"))

    def test_mesh(self):
        write(tank_of_water(frame_interval=0.01), self.path / "tank", 0.01)
        folder = projdyn.mesh(self.path / "tank", format="obj", frames=(1, 1), threads=1)
        self.assertEqual([path.name for path in folder.glob("*.obj")], ["water_000001.obj"])


if __name__ == "__main__":
    unittest.main()
