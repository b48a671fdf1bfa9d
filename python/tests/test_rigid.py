"""Rigid bodies from Python: pose, motion, force and moment."""
import tempfile
import unittest

import numpy as np

import projdyn


def turned(angle):
    """A rotation about y, rad."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])


def load(**more):
    """A box of 0.2 x 0.1 x 0.4 m, 8 kg, without gravity."""
    scene = projdyn.Scene(duration=10, threads=1)
    scene["gravity"], scene["frame_interval"] = [0, 0, 0], 1
    scene["time_step"] = {"fixed": 0.01}
    scene.add_cloth(grid={"size": [1, 1], "vertices": [3, 3]}, translate=[0, 5, 0], name="sheet",
                    area_density=0.1, spring={"stretching_stiffness": 10})
    scene.add_rigid(box=([0.9, -0.05, -0.2], [1.1, 0.05, 0.2]), density=1000, name="box", **more)
    return scene.load()


class Rigid(unittest.TestCase):
    def test_wrench_keeps_its_direction(self):
        scene = projdyn.Scene(gravity=[0, 0, 0], duration=1)
        scene.add_rigid(box=([0, 0, 0], [0.1, 0.1, 0.1]), density=2000, name="box")
        sim = scene.load()
        box = sim.bodies["box"]
        box.set_wrench([0, 0, 0], [0, 0, 0.01])
        for _ in sim.run():
            pass
        np.testing.assert_allclose(box.angular_velocity, [0, 0, 3 * sim.time], atol=0.01)

    def test_state(self):
        sim = load(velocity=[1, 2, 3], angular_velocity=[0, 2, 0])
        box = sim.bodies["box"]
        self.assertTrue(box.is_rigid and not sim.bodies["sheet"].is_rigid)
        self.assertIsInstance(box, projdyn.Rigid)
        self.assertAlmostEqual(box.total_mass, 8)
        np.testing.assert_allclose(box.position, [1, 0, 0], atol=1e-12)
        np.testing.assert_allclose(box.rotation, np.eye(3), atol=1e-12)
        np.testing.assert_allclose(box.velocity, [1, 2, 3], atol=1e-12)
        np.testing.assert_allclose(box.angular_velocity, [0, 2, 0], atol=1e-12)
        squares = np.array([0.2, 0.1, 0.4]) ** 2 * 8 / 12
        np.testing.assert_allclose(box.inertia, np.diag(squares.sum() - squares), atol=1e-12)
        for _ in range(50):
            sim.step()
        np.testing.assert_allclose(box.position, [1.5, 1, 1.5], atol=1e-9)
        np.testing.assert_allclose(box.rotation, turned(1), atol=1e-3)
        np.testing.assert_allclose(box.angular_velocity, [0, 2, 0], atol=1e-9)

    def test_wrench(self):
        sim = load()
        box = sim.bodies["box"]
        for _ in range(20):
            box.set_wrench([0, 16, 0], [0, 0.5, 0])
            sim.step()
        inertia = (0.2**2 + 0.4**2) * 8 / 12
        np.testing.assert_allclose(box.velocity, [0, 0.4, 0], atol=1e-9)
        np.testing.assert_allclose(box.angular_velocity, [0, 0.1 / inertia, 0], rtol=1e-3, atol=1e-9)
        box.set_wrench()
        for _ in range(20):
            sim.step()
        np.testing.assert_allclose(box.velocity, [0, 0.41, 0], atol=1e-9)  # bdf2 looks two steps back

    def test_wrench_and_saved_states(self):
        """A state has the force of a wrench. A moment must be set again, and is then the same."""
        for moment, again, same in (([0, 0, 0], False, True), ([0, 0.5, 0], False, False),
                                    ([0, 0.5, 0], True, True)):
            first, second = load(), load()
            first.bodies["box"].set_wrench([0, 16, 0], moment)
            for _ in range(50):
                first.step()
            second.restore(first.state())
            if again:
                second.bodies["box"].set_wrench([0, 16, 0], moment)
            for sim in (first, second):
                for _ in range(50):
                    sim.step()
            self.assertEqual(first.hash == second.hash, same, (moment, again))

    def test_a_restored_state_ends_a_wrench(self):
        """That acts since: the simulation goes on as a new one does from this state."""
        with tempfile.TemporaryDirectory() as folder:
            for moment in ([0, 0, 0], [0, 0.5, 0]):
                sim, new = load(), load()
                sim.step()
                with sim.write(folder):
                    pass  # saves the state
                start = sim.state()
                new.restore(start)
                new.step()
                for restore in (lambda: sim.restore(start), lambda: sim.write(folder, resume=True)):
                    sim.bodies["box"].set_wrench([0, 16, 0], moment)
                    sim.step()
                    restore()
                    sim.step()
                    self.assertEqual(sim.hash, new.hash)

    def test_placed(self):
        sim = load()
        box = sim.bodies["box"]
        box.set_pose([0, 0, 3], turned(0.7))
        box.set_motion([1, 0, 0], [0, 0, 4])
        np.testing.assert_allclose(box.position, [0, 0, 3], atol=1e-12)
        np.testing.assert_allclose(box.rotation, turned(0.7), atol=1e-12)
        np.testing.assert_allclose(box.velocity, [1, 0, 0], atol=1e-12)
        np.testing.assert_allclose(box.angular_velocity, [0, 0, 4], atol=1e-9)
        box.set_pose([0, 0, 3])
        np.testing.assert_allclose(box.rotation, np.eye(3), atol=1e-12)
        with self.assertRaisesRegex(projdyn.InputError, "rotation: expected the shape 3 x 3"):
            box.set_pose([0, 0, 0], [1, 0, 0])
        for wrong in (np.zeros((3, 3)), 2 * np.eye(3), -np.eye(3), np.diag([1, 1, -1]), np.full((3, 3), np.nan),
                      np.eye(3) + np.diag([1e-4, 0], 1)):
            with self.assertRaisesRegex(projdyn.InputError, "rotation: expected a rotation matrix"):
                box.set_pose([0, 0, 5], wrong)
        np.testing.assert_allclose(box.position, [0, 0, 3], atol=1e-12)
        box.set_pose([0, 0, 3], turned(0.7) + 1e-8)

    def test_other_bodies_have_no_pose(self):
        sim = load()
        sheet, box = sim.bodies["sheet"], sim.bodies["box"]
        for name, instead in (("set_pose", "set_positions"), ("set_motion", "set_velocities"),
                              ("set_wrench", "set_forces"), ("position", "x"), ("velocity", "v")):
            with self.assertRaisesRegex(AttributeError, f"<body sheet of .*> has no {name}: {instead} .*; "
                                        f"rigid bodies have {name}: box$"):
                getattr(sheet, name)
            self.assertTrue(hasattr(box, name) and hasattr(sheet, instead))
        for name in ("pose", "move"):
            with self.assertRaisesRegex(AttributeError, f"has no {name}: .*(position|set_pose)"):
                getattr(box, name)
        with self.assertRaisesRegex(AttributeError, "velocity of .* cannot be assigned: .*set_motion"):
            box.velocity = [1, 0, 0]
        with self.assertRaisesRegex(AttributeError, "^'Body' object has no attribute 'place'$"):
            sheet.place
        scene = projdyn.Scene(threads=1)
        scene.add_fluid(box=([0, 0, 0], [1, 1, 1]), radius=0.25, name="water", fluid={})
        scene.add_solid(name="tank", box=([0, 0, 0], [1, 1, 1]))
        sim = scene.load()
        with self.assertRaisesRegex(AttributeError, "rigid bodies have set_pose: none here$"):
            sim.bodies["water"].set_pose
        for name, instead in (("set_pose", "move"), ("set_motion", "move"), ("position", "pose"),
                              ("rotation", "pose")):
            with self.assertRaisesRegex(AttributeError, f"<solid tank> has no {name}: {instead}"):
                getattr(sim.solids["tank"], name)


if __name__ == "__main__":
    unittest.main()
