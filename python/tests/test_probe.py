"""Forces, energies and pressures at the end of a step."""
import unittest

import numpy as np

import projdyn
from scenes import hanging_sheet, tank_of_water


class Probes(unittest.TestCase):
    def test_constraints_of_a_sheet(self):
        sim = hanging_sheet(solver={"tolerance": 1e-6, "outer_iterations": 100}).load()
        spring, pin = sim.constraints["sheet", "spring"], sim.constraints["sheet", "pin"]
        self.assertEqual(np.abs(spring.forces()).max(), 0)
        for info in sim.run(until=0.1):
            pass
        self.assertEqual(spring.energies().shape, (spring.elements,))
        self.assertAlmostEqual(spring.energies().sum(), spring.energy)
        sheet = sim.bodies["sheet"]
        ends, rest = sheet.x[sheet.edges], sheet.rest[sheet.edges]
        length, at_rest = (np.linalg.norm(x[:, 1] - x[:, 0], axis=1) for x in (ends, rest))
        np.testing.assert_allclose(spring.distances(), np.abs(length - at_rest), atol=1e-12)
        np.testing.assert_allclose(spring.forces().sum(0), 0, atol=1e-9)
        force, moment = pin.load()
        np.testing.assert_allclose(force, pin.forces().sum(0), atol=1e-9)
        np.testing.assert_allclose(force, info.pin_reaction, atol=1e-3)
        np.testing.assert_allclose(moment, np.cross(sim.x, pin.forces()).sum(0), atol=1e-9)
        self.assertEqual(sim.contact_forces().shape, (81, 3))

    def test_elements_that_change(self):
        """Viscosity has an element for each pair of neighbours, of another number after each step."""
        scene = projdyn.Scene(duration=1, threads=1)
        scene.add_fluid(box=([0, 0, 0], [0.2, 0.2, 0.2]), radius=0.02, name="water", fluid={},
                        viscosity={"viscosity": 1})
        sim = scene.load()
        viscosity = sim.constraints["water", "viscosity"]
        before = viscosity.elements
        sim.step()
        self.assertNotEqual(viscosity.elements, before)
        self.assertEqual(viscosity.energies().shape, (viscosity.elements,))

    def test_loads_by_source(self):
        """A sheet falls onto the floor of a tank without water: all of its load is contact."""
        scene = projdyn.Scene(duration=1, threads=1, contact={"thickness": 0.01})
        scene.add_cloth(grid={"size": [0.4, 0.4], "vertices": [5, 5]}, translate=[0, 0.011, 0],
                        name="sheet", area_density=1, spring={"stretching_stiffness": 500})
        scene.add_solid(name="floor", box=([-1, -1, -1], [1, 0, 1]))
        sim = scene.load()
        for _ in sim.run(until=0.2):
            pass
        floor, sheet = sim.solids["floor"], sim.bodies["sheet"]
        self.assertLess(floor.load("contact").force[1], -1)
        np.testing.assert_array_equal(floor.load("contact").force, floor.load().force)
        np.testing.assert_array_equal(floor.load("fluid").force, 0)
        np.testing.assert_allclose(sheet.load("contact").force, -floor.load().force, atol=1e-9)
        np.testing.assert_allclose(sheet.load().force, -floor.load().force, atol=1e-9)
        np.testing.assert_array_equal(sheet.load("fluid").moment, 0)
        with self.assertRaisesRegex(projdyn.InputError, 'expected "fluid", "contact" or None'):
            floor.load("water")

    def test_tension(self):
        """A ball hangs on a line; its probe has the forces of the line on the ball alone."""
        scene = projdyn.Scene(duration=1, threads=1, probes=[
            {"name": "line", "body": "ball", "constraint": "attachment"}])
        scene.add_rigid(box=([-0.02, 0.5, -0.02], [0.02, 0.54, 0.02]), name="anchor", density=1000,
                        pin={"vertices": {"all": True}})
        scene.add_rigid(sphere={"center": [0, 0, 0], "radius": 0.05}, name="ball", mass=2, attachment={
            "to": "anchor", "stiffness": 2000, "damping": 0.05, "tension_only": True,
            "vertices": {"sphere": {"center": [0, 0.05, 0], "radius": 0.001}}})
        sim = scene.load()
        for _ in sim.run(until=1):
            pass
        line, ball = sim.constraints["ball", "attachment"], sim.bodies["ball"]
        self.assertAlmostEqual(sim.probes["line"]["force_y_N"] / (2 * 9.81), 1, delta=0.01)
        np.testing.assert_allclose([sim.probes["line"][f"force_{axis}_N"] for axis in "xyz"],
                                   line.forces()[ball.particles].sum(0), atol=1e-9)
        np.testing.assert_allclose(line.load().force, 0, atol=1e-9)

    def test_water(self):
        sim = tank_of_water(probes=[{"name": "deep", "point": [0.12, 0.05, 0.12]},
                                    {"name": "walls", "solid": "tank"}]).load()
        for _ in sim.run(until=0.4):
            pass
        pressure, velocity = sim.fluid_at([[0.12, y, 0.12] for y in (0.05, 0.12, 0.38)])
        self.assertAlmostEqual((pressure[0] - pressure[1]) / (1000 * 9.81 * 0.07), 1, delta=0.15)
        self.assertEqual(pressure[2], 0)
        self.assertLess(np.abs(velocity).max(), 0.1)
        force, moment = sim.solids["tank"].load()
        weight = 9.81 * sim.mass.sum()
        self.assertAlmostEqual(-force[1] / weight, 1, delta=0.1)
        self.assertEqual(moment.shape, (3,))
        deep, walls = sim.probes["deep"], sim.probes["walls"]
        self.assertEqual(deep["pressure_Pa"], pressure[0])
        self.assertEqual(deep.columns[0], "deep.pressure_Pa")
        self.assertEqual(walls["walls.force_y_N"], force[1])
        with self.assertRaisesRegex(KeyError, "deep.pressure_Pa"):
            deep["presure"]
        sim.step()
        self.assertNotEqual(deep["pressure_Pa"], pressure[0])


if __name__ == "__main__":
    unittest.main()
