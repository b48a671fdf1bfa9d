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

    def test_types(self):
        for draw in (projdyn.plot, projdyn.plot_sweep):
            with self.assertRaisesRegex(TypeError, ": expected a path, found dict"):
                draw({})
        with self.assertRaisesRegex(TypeError, "columns: expected a text, found list"):
            projdyn.plot(self.run_path, ["kinetic_J"])

    def test_units(self):
        """One diagram for each unit; columns of probes; a file."""
        file = pathlib.Path(self.folder.name, "forces.png")
        figure = projdyn.plot(self.run_path, "hold.force_y_N", "hold.moment_z_Nm", "ms_global",
                              "outer_iterations", "pin_reaction_y_N", file=file)
        self.assertEqual([axes.get_ylabel() for axes in figure.axes], ["N", "N m", "ms", ""])
        self.assertEqual(len(figure.axes[0].get_lines()), 2)
        self.assertGreater(file.stat().st_size, 1000)

    def test_pattern(self):
        names = ["energy_sheet.spring_J", "energy_sheet.bending_J", "energy_sheet.pin_J"]
        lines = self.lines(projdyn.plot(self.run_path, "energy_*", "energy_sheet.pin_J"))
        self.assertEqual(sorted(lines), sorted(names))
        self.assertGreater(lines["energy_sheet.spring_J"][-1, 1], 0)

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

    def test_empty_cell(self):
        """A number that is not finite has an empty cell, and is no point."""
        run = pathlib.Path(self.folder.name, "not_finite")
        run.mkdir()
        (run / "metrics.csv").write_text("time_s,kinetic_J\n0.1,2\n0.2,\n")
        np.testing.assert_array_equal(self.lines(projdyn.plot(run, "kinetic_J"))["kinetic_J"][:, 1], [2, np.nan])


@unittest.skipUnless(matplotlib, "no matplotlib")
class PlotSweep(unittest.TestCase):
    ROWS = """solver.type,stiffness,status,cpu_s,max_step_residual,mean_x_J
cg,10,good,1,0.1,5
cg,1000,good,2,0.1,6
cholesky,10,good,3,0.1,
cholesky,1000,killed,,,
"""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.sweep = pathlib.Path(folder.name)

    def draw(self, rows, *columns):
        from matplotlib import pyplot
        self.addCleanup(pyplot.close, "all")
        (self.sweep / "sweep.csv").write_text(rows)
        return projdyn.plot_sweep(self.sweep, *columns, file=self.sweep / "sweep.png")

    def test_lines(self):
        """The horizontal axis has the numbers; the solvers are lines; a killed run is no point."""
        above, below = self.draw(self.ROWS, "mean_*", "cpu_s").axes
        self.assertEqual([above.get_title("left"), below.get_title("left")], ["mean_x_J", "cpu_s"])
        self.assertEqual((below.get_xlabel(), below.get_xscale()), ("stiffness", "log"))
        lines = {line.get_label(): line.get_xydata().tolist() for line in below.get_lines()}
        self.assertEqual(lines, {"solver.type=cg": [[10, 1], [1000, 2]], "solver.type=cholesky": [[10, 3]]})
        self.assertTrue(np.isnan(above.get_lines()[1].get_ydata()[0]))
        self.assertGreater((self.sweep / "sweep.png").stat().st_size, 1000)

    def test_order(self):
        """Lines go from left to right, whatever the order of the values."""
        head, *rows = self.ROWS.splitlines()
        axes, = self.draw("\n".join([head, *reversed(rows)]), "cpu_s").axes
        lines = {line.get_label(): line.get_xydata().tolist() for line in axes.get_lines()}
        self.assertEqual(lines["solver.type=cg"], [[10, 1], [1000, 2]])

    def test_words(self):
        axes, = self.draw(self.ROWS.replace("1000,good", "10,good"), "cpu_s").axes
        self.assertEqual(axes.get_xlabel(), "solver.type")

    def test_errors(self):
        with self.assertRaisesRegex(projdyn.InputError, "expected the directory of a sweep"):
            projdyn.plot_sweep(self.sweep)
        with self.assertRaisesRegex(projdyn.InputError, 'unknown column "cpu"; did you mean "cpu_s"'):
            self.draw(self.ROWS, "cpu")
        with self.assertRaisesRegex(projdyn.InputError, "expected a run that is good"):
            self.draw(self.ROWS.replace("good", "failed"), "cpu_s")


if __name__ == "__main__":
    unittest.main()
