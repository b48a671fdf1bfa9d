"""Steps, views of the state, lifetimes, saved states and output."""
import concurrent.futures
import copy
import gc
import json
import logging
import pathlib
import pickle
import subprocess
import tempfile
import threading
import unittest
import warnings
from unittest import mock

import numpy as np

import projdyn
from projdyn._handles import Handle
from projdyn._library import lib, open_library
from projdyn._program import program_path
from scenes import hanging_sheet, tank_of_water


class Steps(unittest.TestCase):
    def test_run(self):
        sim = hanging_sheet(duration=0.1, frame_interval=0.01, time_step={"fixed": 0.01}).load()
        infos = list(sim.run(until=0.05))
        self.assertEqual([round(100 * info.time) for info in infos], [1, 2, 3, 4, 5])
        self.assertEqual(len(list(sim.run())), 5)
        self.assertEqual(infos[-1].h, 0.01)
        self.assertEqual(infos[0].pin_reaction, tuple(infos[0].pin_reaction))
        self.assertLess(abs(infos[0].momentum[0]), 1e-9)
        self.assertIn("step to 0.01 s", repr(infos[0]))

    def test_a_step_as_a_dictionary(self):
        info = hanging_sheet().load().step()
        row = info.to_dict()
        self.assertEqual((row["time"], row["momentum"]), (info.time, info.momentum))
        self.assertIn("ms_cpu", row)

    def test_run_without_a_loop(self):
        sim = hanging_sheet(duration=0.1, frame_interval=0.01, time_step={"fixed": 0.01}).load()
        with self.assertWarnsRegex(RuntimeWarning, "for info in sim.run") as caught:
            sim.run()
        self.assertEqual(pathlib.Path(caught.filename).name, "test_simulation.py")
        self.assertEqual(sim.time, 0)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            for info in sim.run():
                break
            run = sim.run(until=0.05)
            next(run)
            run = None
            self.assertEqual(len(list(sim.run())), 8)
            self.assertEqual(list(sim.run(until=0.1)), [])
        with self.assertWarnsRegex(RuntimeWarning, "reached its duration, 0.1 s: no steps") as caught:
            self.assertEqual(list(sim.run()), [])
        self.assertEqual(pathlib.Path(caught.filename).name, "test_simulation.py")
        run = sim.run(until=1)
        next(run)
        self.assertIn("for info in sim.run()", repr(run))

    def test_run_until_the_past(self):
        sim = hanging_sheet(duration=0.1, frame_interval=0.01, time_step={"fixed": 0.01}).load()
        for wrong in (-1, -1e-9, float("nan")):
            with self.assertRaisesRegex(projdyn.InputError, "until: expected a time after the present one, 0 s"):
                sim.run(until=wrong)
        list(sim.run())
        with self.assertRaisesRegex(projdyn.InputError, "until: .* present one, 0.1 s, found 0.05 s"):
            sim.run(until=0.05)
        self.assertEqual(list(sim.run(until=0.095)), [])  # a loop whose times are closer than steps

    def test_wrong_types(self):
        sim = hanging_sheet().load()
        for text, call in [("until: expected numbers, found str", lambda: sim.run(until="1")),
                           ("h: expected numbers, found dict", lambda: sim.step({})),
                           ("path: expected a path, found int", lambda: sim.save(3)),
                           ("state: expected bytes or a path, found NoneType", lambda: sim.restore(None)),
                           ("directory: expected a path, found int", lambda: sim.write(3)),
                           ("points: expected numbers, found list with NoneType$", lambda: sim.fluid_at([[0, 0, None]]))]:
            with self.assertRaisesRegex(TypeError, text):
                call()
        with tempfile.TemporaryDirectory() as directory, sim.write(directory) as writer:
            with self.assertRaisesRegex(TypeError, "info: expected the result of a step, found float"):
                writer.step(0.1)

    def test_finished(self):
        """49 steps of 1/49 s: their sum is less than 1 s by rounding."""
        sim = hanging_sheet(n=2, frame_interval=1 / 49, time_step={"fixed": 1 / 49}).load()
        steps = 0
        while not sim.is_finished:
            sim.step()
            steps += 1
        self.assertEqual((steps, len(list(sim.run(until=sim.duration)))), (49, 0))

    def test_step_of_a_given_length(self):
        sim = hanging_sheet().load()
        self.assertEqual(sim.step(h=0.0123).h, 0.0123)
        self.assertEqual(sim.time, 0.0123)
        with self.assertRaises(projdyn.Error):
            sim.step(h=-1)
        with self.assertWarnsRegex(RuntimeWarning, r"step\(2\) is one step of 2 s, not 2 steps"):
            sim.step(2)

    def test_a_failed_step(self):
        sim = hanging_sheet(solver={"retries": 0}, gravity=[0, -1e6, 0], duration=1000,
                            time_step={"fixed": 100}, frame_interval=100).load()
        sim.constraints["sheet", "pin"].enabled = False
        with self.assertRaisesRegex(projdyn.StepError, "beyond"):
            sim.step()
        for _ in range(2):
            with self.assertRaisesRegex(projdyn.Error, "the simulation has failed before"):
                sim.step()

    def test_the_text_of_a_bad_call(self):
        """Each call once: its text is not that of the error before, nor of another simulation."""
        sim, other = hanging_sheet().load(), hanging_sheet().load()
        for name, arguments, text in ((lib.pdyn_set_forces, (-1, 1, None), "first -1, count 1"),
                                      (lib.pdyn_hold, (0, 1.0, None), "target is NULL"),
                                      (lib.pdyn_enable, (99, True), "constraint: expected 0 to")):
            with self.assertRaisesRegex(projdyn.Error, f"^{name.__name__}: {text}"):
                sim._handle.call(name, *arguments)
            with self.assertRaisesRegex(projdyn.Error, "path is NULL"):
                other._handle.call(lib.pdyn_save, None)
        with self.assertRaisesRegex(projdyn.InputError, "threads: expected 0 to 1024, found -1"):
            projdyn.Scene(threads=-1)

    def test_threads_have_their_own_texts(self):
        def fails_with_its_text(k):
            sim = hanging_sheet().load()
            for count in range(200):
                with self.assertRaisesRegex(projdyn.Error, f"first {k}, count {-count - 1}:"):
                    sim._handle.call(lib.pdyn_set_forces, k, -count - 1, None)

        with concurrent.futures.ThreadPoolExecutor(4) as pool:
            list(pool.map(fails_with_its_text, range(4)))

    def test_a_restored_state_revives_a_failed_simulation(self):
        scene = hanging_sheet()
        sim, new = scene.load(), scene.load()
        sim.step()
        start = sim.state()
        sim.bodies["sheet"].set_forces([0, 1e15, 0])
        with self.assertRaises(projdyn.StepError):
            sim.step()
        sim.restore(start)
        new.restore(start)
        for _ in range(3):
            sim.step()
            new.step()
        self.assertEqual(sim.state(), new.state())


class Views(unittest.TestCase):
    def test_unknown_names(self):
        sim = hanging_sheet().load()
        with self.assertRaisesRegex(KeyError, "'shet': the simulation has 'sheet'"):
            sim.bodies["shet"]
        with self.assertRaisesRegex(KeyError, r"has \('sheet', 'spring'\)"):
            sim.constraints["sheet", "sprng"]
        with self.assertRaisesRegex(KeyError, "'tank': the simulation has none"):
            sim.solids["tank"]
        self.assertIsNone(sim.bodies.get("shet"))
        with self.assertRaisesRegex(AttributeError, 'sheet: parts are items'):
            sim.bodies.sheet
        with self.assertRaisesRegex(AttributeError, "reset: restore"):
            sim.reset()

    def test_views_follow_the_steps(self):
        sim = hanging_sheet().load()
        sheet = sim.bodies["sheet"]
        x = sheet.x
        before = x.copy()
        sim.step()
        self.assertLess(x[:, 1].min(), before[:, 1].min())
        self.assertIs(sheet.x, x)
        np.testing.assert_array_equal(sheet.rest, before)
        self.assertEqual(len(sheet), 81)
        self.assertTrue(sheet.live.all())
        self.assertAlmostEqual(float(sheet.mass.sum()), 0.2)

    def test_views_are_read_only(self):
        sim = hanging_sheet().load()
        sheet = sim.bodies["sheet"]
        for array in (sheet.x, sheet.v, sheet.mass, sheet.rest, sheet.triangles, sheet.live):
            with self.assertRaises(ValueError):
                array[0] = 1
            with self.assertRaises(ValueError):
                array.flags.writeable = True

    def test_a_view_keeps_its_memory(self):
        sim = hanging_sheet().load()
        sim.step()
        x, expected = sim.bodies["sheet"].x[3:], sim.bodies["sheet"].x[3:].copy()
        handle = sim._handle.finalize
        del sim
        gc.collect()
        self.assertTrue(handle.alive)
        np.testing.assert_array_equal(x, expected)
        np.testing.assert_array_equal(pickle.loads(pickle.dumps(x)), expected)
        del x
        gc.collect()
        self.assertFalse(handle.alive)

    def test_the_garbage_collector_frees_in_order(self):
        freed = []
        parent = Handle(1, freed.append)
        child = Handle(2, freed.append, parent)
        parent.cycle, child.cycle = parent, child
        del parent, child
        gc.collect()
        gc.collect()
        self.assertEqual(freed, [2, 1])

    def test_simulations_come_from_load(self):
        with self.assertRaisesRegex(TypeError, "projdyn.load"):
            projdyn.Simulation("scene.json")

    def test_nothing_is_copied_or_pickled(self):
        scene = hanging_sheet()
        sim = scene.load()
        for thing in (scene, sim, sim.bodies["sheet"], sim.constraints["sheet", "spring"]):
            for copying in (pickle.dumps, copy.copy, copy.deepcopy):
                with self.assertRaisesRegex(TypeError, "Scene.write"):
                    copying(thing)

    def test_steps_of_two_threads_wait_for_each_other(self):
        sim, alone = (hanging_sheet(n=60).load() for _ in range(2))
        steps = threading.Barrier(2)

        def run():
            steps.wait()
            for _ in range(20):
                sim.step()

        threads = [threading.Thread(target=run) for _ in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for _ in range(40):
            alone.step()
        self.assertEqual(sim.hash, alone.hash)

    def test_a_reader_waits_for_the_end_of_a_step(self):
        sim = hanging_sheet(n=60).load()
        after, read = {sim.hash}, set()

        def run():
            for _ in range(20):
                sim.step()
                after.add(sim.hash)

        thread = threading.Thread(target=run)
        thread.start()
        while thread.is_alive():
            read.add(sim.hash)
        thread.join()
        self.assertLessEqual(read, after)

    def test_readers_wait_for_another_thread(self):
        """A step changes texts of warnings and the list of constraints, and a change of a path ends
        the memory of the old one."""
        sim = hanging_sheet().load()
        pin = sim.constraints["sheet", "pin"]
        for read in (lambda: sim.hash, lambda: sim.warnings, lambda: sim.gravity, lambda: sim.solver,
                     lambda: pin["stiffness"], lambda: pin.parameters, lambda: pin.energy, lambda: pin.enabled):
            with sim._handle.lock:
                thread = threading.Thread(target=read)
                thread.start()
                thread.join(0.05)
                self.assertTrue(thread.is_alive())
            thread.join()

    def test_no_step_comes_between_the_number_of_elements_and_their_values(self):
        """The values would be written behind the end of the array."""
        sim = hanging_sheet().load()
        thread = threading.Thread(target=sim.step)
        count, waits = type(sim.constraints["sheet", "spring"]).elements.fget, []

        def elements(constraint):
            thread.start()
            thread.join(0.05)
            waits.append(thread.is_alive())
            return count(constraint)

        with mock.patch.object(type(sim.constraints["sheet", "spring"]), "elements", property(elements)):
            sim.constraints["sheet", "spring"].energies()
        thread.join()
        self.assertEqual(waits, [True])

    def test_fluid(self):
        sim = tank_of_water().load()
        water = sim.bodies["water"]
        for _ in sim.run(until=0.2):
            pass
        self.assertEqual(water.radius, 0.02)
        self.assertAlmostEqual(water.density.mean() / water.rest_density, 1, delta=0.05)
        deep = water.x[:, 1] < 0.04
        self.assertAlmostEqual(water.pressure[deep].mean(), 1000 * 9.81 * 0.18, delta=250)
        self.assertEqual(water.triangles.shape, (0, 3))


class Files(unittest.TestCase):
    def test_saved_state(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "state.pdyn")
            scene = hanging_sheet()
            sim, other = scene.load(), scene.load()
            sim.step()
            sim.save(path)
            sim.step()
            other.restore(path)
            other.step()
            self.assertEqual(sim.hash, other.hash)
            self.assertEqual(sim.time, other.time)
            with self.assertRaises(projdyn.Error):
                tank_of_water().load().restore(path)

    def test_a_state_in_memory_has_the_bytes_of_the_file(self):
        sim = hanging_sheet().load()
        sim.step()
        state = sim.state()
        with tempfile.TemporaryDirectory() as folder:
            sim.save(f"{folder}/state")
            self.assertEqual(pathlib.Path(folder, "state").read_bytes(), state)
        hashes = [sim.step() and sim.hash for _ in range(3)]
        for _ in range(2):
            sim.restore(state)
            self.assertEqual([sim.step() and sim.hash for _ in range(3)], hashes)
        for other in (bytearray(state), memoryview(state)):  # as of a pipe or a shared memory
            sim.restore(other)
            self.assertEqual(sim.state(), state)
        with self.assertRaisesRegex(projdyn.InputError, "the state in memory: "):
            sim.restore(state[:-1])

    def test_writer_writes_what_the_program_writes(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = hanging_sheet(duration=0.1)
            scene.write(pathlib.Path(folder, "scene.json"))
            subprocess.run([program_path(), "run", f"{folder}/scene.json", "-o", f"{folder}/program",
                            "--quiet"], check=True)
            sim = scene.load()
            with sim.write(f"{folder}/package") as writer:
                for info in sim.run():
                    writer.step(info)
            for frame in pathlib.Path(folder, "program").glob("*.vtk*"):
                self.assertEqual(frame.read_bytes(),
                                 pathlib.Path(folder, "package", frame.name).read_bytes())
            report = json.loads(pathlib.Path(folder, "package/report.json").read_text())
            self.assertEqual(report["steps"], len(list(scene.load().run())))
            with self.assertRaisesRegex(projdyn.Error, "closed"):
                writer.frame()
            page = projdyn.replay(f"{folder}/package")._repr_html_()
            self.assertIn("<iframe srcdoc=", page)
            self.assertNotIn('<script', page)  # escaped

    def test_a_writer_without_steps_warns(self):
        with tempfile.TemporaryDirectory() as folder:
            sim = hanging_sheet().load()
            with self.assertWarnsRegex(RuntimeWarning, r"call writer\.step\(info\)"), sim.write(folder):
                sim.step()
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                with sim.write(folder):  # a picture of the start
                    pass
                with sim.write(folder) as writer:
                    sim.step()
                    writer.frame()
                with self.assertRaises(KeyError), sim.write(folder):
                    sim.step()
                    raise KeyError

    def test_two_writers_of_a_program(self):
        """As when a cell of a notebook runs again: the process to wait for is this one."""
        with tempfile.TemporaryDirectory() as folder:
            sim = hanging_sheet().load()
            writer = sim.write(folder)
            with self.assertRaisesRegex(projdyn.InputError, "another writer of this program .*: close it first"):
                sim.write(folder)
            for _ in range(2):  # the second call does nothing, as of a file
                writer.close()
            sim.write(folder).close()

    def test_nothing_to_resume(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in (folder, f"{folder}/none"):
                with self.assertRaisesRegex(projdyn.Error, "state.pdyn: .*; expected the directory of a run"):
                    hanging_sheet().load().write(name, resume=True)
            self.assertEqual(list(pathlib.Path(folder).iterdir()), [])

    def test_written_run_goes_on_after_an_interrupt(self):
        for place in ("before the row", "after the row", "after the frame"):
            self._expect_resumed(place)

    def _expect_resumed(self, place):
        def write_row_and_raise(function, *arguments):  # Python raises Ctrl-C at the end of a call
            del writer._handle.call
            writer._handle.call(function, *arguments)
            raise KeyboardInterrupt

        with tempfile.TemporaryDirectory() as folder:
            scene = hanging_sheet(duration=0.1)
            whole = scene.load()
            steps = len(list(whole.run()))
            sim = scene.load()
            with self.assertRaises(KeyboardInterrupt), sim.write(folder) as writer:
                for info in sim.run():
                    last = info.frame and sim.time > 0.04
                    if last and place == "after the row":
                        writer._handle.call = write_row_and_raise
                    if not last or place != "before the row":
                        writer.step(info)
                    if last:
                        raise KeyboardInterrupt
            report = json.loads(pathlib.Path(folder, "report.json").read_text())
            self.assertEqual((report["failed"], report["interrupted"]), (None, True))
            sim = scene.load()
            with sim.write(folder, resume=True) as writer:
                for info in sim.run():
                    writer.step(info)
            self.assertEqual(sim.hash, whole.hash)
            self.assertEqual(len(pathlib.Path(folder, "metrics.csv").read_text().splitlines()), steps + 1)
            frames = json.loads(pathlib.Path(folder, "sheet.vtk.series").read_text())["files"]
            self.assertEqual(len(frames), round(0.1 / sim.frame_interval) + 1)
            report = json.loads(pathlib.Path(folder, "report.json").read_text())
            self.assertEqual(report["steps"], steps)
            self.assertIsNone(report["failed"])
            with self.assertRaisesRegex(projdyn.Error, "nowhere"):
                sim.write(f"{folder}/nowhere", resume=True)

    def test_steps_are_written_one_by_one(self):
        """Probes, energies and frames of an earlier step are gone."""
        sim = hanging_sheet(duration=0.1).load()
        with tempfile.TemporaryDirectory() as folder, sim.write(folder) as writer:
            infos = list(sim.run())
            with self.assertRaisesRegex(projdyn.Error, "info: expected that of the last step, to 0.1 s, found"):
                writer.step(infos[0])
            writer.step(infos[-1])
            self.assertEqual(len(pathlib.Path(folder, "metrics.csv").read_text().splitlines()), 2)

    def test_frames_at_any_time(self):
        """A frame replaces those of its time and later: of a step that wrote one, and after a restore."""
        def write(folder, more):
            sim = hanging_sheet(duration=0.1).load()
            start = sim.state()
            with sim.write(folder) as writer:
                for info in sim.run(0.05):
                    writer.step(info)
                if more:
                    writer.frame()
                    sim.restore(start)
                    writer.frame()
                    for info in sim.run(0.05):
                        writer.step(info)
            return {path.name: path.read_bytes() for path in pathlib.Path(folder).glob("*.vtk*")}
        with tempfile.TemporaryDirectory() as folder:
            again, once = write(f"{folder}/again", True), write(f"{folder}/once", False)
            self.assertEqual({name: again[name] for name in once}, once)
            projdyn.replay(f"{folder}/again")

    def test_replay_of_nothing(self):
        with self.assertRaisesRegex(projdyn.Error, "no_such"):
            projdyn.replay("no_such")


class Messages(unittest.TestCase):
    def test_warnings(self):
        scene = hanging_sheet(solver={"outer_iterations": 1, "tolerance": 1e-9})
        with self.assertLogs("projdyn", logging.WARNING) as log:
            sim = scene.load()
            for _ in range(3):
                sim.step()
        self.assertIn("unsolved", [warning.code for warning in sim.warnings])
        self.assertIn("unsolved", log.output[0])

    def test_interrupt_during_a_message(self):
        class Interrupt(logging.Handler):
            def emit(self, record):
                raise KeyboardInterrupt

        handler = Interrupt()
        logging.getLogger("projdyn").addHandler(handler)
        try:
            sim = hanging_sheet(solver={"outer_iterations": 1, "tolerance": 1e-9}).load()
            with self.assertRaises(KeyboardInterrupt):
                sim.step()
        finally:
            logging.getLogger("projdyn").removeHandler(handler)
        sim.step()

    def test_version(self):
        self.assertRegex(projdyn.version(), r"^\d+\.\d+\.\d+$")
        self.assertEqual(projdyn.__version__, projdyn.version())

    def test_no_library(self):
        with self.assertRaisesRegex(ImportError, "nowhere.so: cannot open.*PROJDYN_LIBRARY"):
            open_library("/nowhere.so")


if __name__ == "__main__":
    unittest.main()
