"""projdyn.plot: columns of a run as a figure."""
import pathlib
import sys
import tempfile
import unittest
from unittest import mock

import numpy as np

import projdyn
from scenes import hanging_sheet

try:
    import matplotlib
    matplotlib.use("agg")
except ImportError:
    matplotlib = None


class WithoutMatplotlib(unittest.TestCase):
    def test_message(self):
        with mock.patch.dict(sys.modules, {"matplotlib": None}):
            with self.assertRaisesRegex(ImportError, "needs matplotlib: pip install matplotlib"):
                projdyn.plot("run")


@unittest.skipUnless(matplotlib, "no matplotlib")
class Plot(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.run_path = pathlib.Path(cls.folder.name, "run")
        sim = hanging_sheet(probes=[{"name": "hold", "pins": "sheet"}]).load()
        with sim.write(cls.run_path) as writer:
            cls.infos = []
            for info in sim.run(until=0.05):
                writer.step(info)
                cls.infos.append((info.time, info.kinetic_energy))

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def tearDown(self):
        from matplotlib import pyplot
        pyplot.close("all")

    def lines(self, figure):
        return {line.get_label(): line.get_xydata() for axes in figure.axes for line in axes.get_lines()}

    def test_energies(self):
        figure = projdyn.plot(self.run_path)
        lines = self.lines(figure)
        self.assertEqual(list(lines), ["kinetic_J", "potential_J", "constraint_J"])
        self.assertEqual(len(figure.axes), 1)
        self.assertEqual(figure.axes[0].get_ylabel(), "J")
        np.testing.assert_allclose(lines["kinetic_J"], self.infos, rtol=1e-6)

    def test_units(self):
        """One diagram for each unit; columns of probes; a file."""
        file = pathlib.Path(self.folder.name, "forces.png")
        figure = projdyn.plot(self.run_path, "hold.force_y_N", "hold.moment_z_Nm", "ms_global",
                              "outer_iterations", "pin_reaction_y_N", file=file)
        self.assertEqual([axes.get_ylabel() for axes in figure.axes], ["N", "N m", "ms", ""])
        self.assertEqual(len(figure.axes[0].get_lines()), 2)
        self.assertGreater(file.stat().st_size, 1000)

    def test_running(self):
        """The last row of a run that goes on may be incomplete."""
        going = pathlib.Path(self.folder.name, "going")
        going.mkdir()
        text = (self.run_path / "metrics.csv").read_text()
        (going / "metrics.csv").write_text(text[:-20])
        lines = self.lines(projdyn.plot(going))
        self.assertEqual(len(lines["kinetic_J"]), len(self.infos) - 1)

    def test_errors(self):
        with self.assertRaisesRegex(projdyn.InputError, 'unknown column "kinetic_j"; did you mean "kinetic_J"'):
            projdyn.plot(self.run_path, "kinetic_j")
        with self.assertRaisesRegex(projdyn.InputError, "nowhere: expected the directory of a run"):
            projdyn.plot("nowhere")
        empty = pathlib.Path(self.folder.name, "empty")
        empty.mkdir()
        (empty / "metrics.csv").write_text("time_s,kinetic_J\n")
        with self.assertRaisesRegex(projdyn.InputError, "and a step in it"):
            projdyn.plot(empty)


if __name__ == "__main__":
    unittest.main()
