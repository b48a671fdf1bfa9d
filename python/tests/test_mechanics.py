"""Motions and forces beside exact solutions, as docs/results/mechanics.md has them."""
import unittest

import numpy as np

import projdyn

G = 9.81  # m/s^2


def strip(points, width):
    """Vertices and triangles of a strip along a line in the plane z = 0: n points on each side."""
    n = len(points)
    k = np.arange(n - 1)
    vertices = np.vstack([np.column_stack([points, np.full(n, z)]) for z in (-width / 2, width / 2)])
    return vertices, np.vstack([np.column_stack([k, k + 1, k + n]), np.column_stack([k + 1, k + n + 1, k + n])])


def folded(length, segments, gap=0.04):
    """Points of a chain that hangs in a fold: both ends at y = 0, gap apart."""
    s, bend = np.linspace(0, length, segments + 1), np.pi * gap / 2
    leg = (length - bend) / 2
    turn = np.clip((s - leg) / (gap / 2), 0, np.pi)
    return np.column_stack([gap / 2 * (1 - np.cos(turn)),
                            -np.where(s < leg, s, np.where(s > leg + bend, length - s, leg + gap / 2 * np.sin(turn)))])


def time_of_fall(length, way):
    """Of the free end of a folded chain: v^2 = 2 g x (1 - x/2L) / (1 - x/L), faster than free fall."""
    x = way * ((np.arange(4000) + 0.5) / 4000) ** 2  # midpoints in sqrt(x): dt is singular at 0
    dx = way * np.diff((np.arange(4001) / 4000) ** 2)
    return np.sum(dx * np.sqrt((1 - x / length) / (2 * G * x * (1 - x / (2 * length)))))


def wrapped(radius, segments, end=0.1):
    """Points of a line over the upper half of a circle, with straight ends that hang down."""
    s = np.linspace(-1, 1, segments + 1) * (np.pi * radius / 2 + end)
    turn = np.clip(s / radius, -np.pi / 2, np.pi / 2)
    return np.column_stack([radius * np.sin(turn), radius * np.cos(turn) - np.maximum(0, np.abs(s) - np.pi * radius / 2)])


def bar(length, angle, width=0.04):
    """A bar that hangs from the origin at an angle to the vertical, rad: vertices 4 and 10 are the
    ends of the upper axle, 5 and 11 of the lower one."""
    a = width / 2
    outline = np.array([[-a, a], [a, a], [a, -length - a], [-a, -length - a], [0, 0], [0, -length]])
    c, s = np.cos(angle), np.sin(angle)
    vertices = np.vstack([np.column_stack([outline @ [[c, s], [-s, c]], np.full(6, z)]) for z in (-a, a)])
    face = np.array([[0, 1, 4], [1, 2, 4], [4, 2, 5], [2, 3, 5], [3, 0, 4], [3, 4, 5]])
    sides = [[[p, p + 6, q], [q, p + 6, q + 6]] for p, q in ((0, 1), (1, 2), (2, 3), (3, 0))]
    return vertices, np.vstack([face, face[:, ::-1] + 6, *sides])


def double_pendulum(angles, mass, inertia, length, time, steps=4000):
    """Angles of two equal bars, rad, at `time`, by Runge-Kutta of order 4."""
    l = length / 2

    def rate(y):
        (p, q, v, w), c, s = y, np.cos(y[0] - y[1]), np.sin(y[0] - y[1])
        matrix = [[inertia + mass * (l * l + length * length), mass * length * l * c],
                  [mass * length * l * c, inertia + mass * l * l]]
        force = [-mass * (length * l * s * w * w + (l + length) * G * np.sin(p)),
                 mass * (length * l * s * v * v - G * l * np.sin(q))]
        return np.array([v, w, *np.linalg.solve(matrix, force)])

    y, h = np.array([*angles, 0, 0]), time / steps
    for _ in range(steps):
        k1 = rate(y)
        k2 = rate(y + h / 2 * k1)
        k3 = rate(y + h / 2 * k2)
        y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(y + h * k3))
    return y[:2]


def bowed(half, length):
    """The c of y = c cosh(x / c), whose arc between -half and half has this length."""
    low, high = 0.1 * half, 100 * half
    for _ in range(100):
        c = (low + high) / 2
        low, high = (c, high) if 2 * c * np.sinh(half / c) > length else (low, c)
    return c


def cone(radius, height, tilt, parts=32):
    """A cone on its tip, vertex 0, in the origin; its axis leans towards z by `tilt`, rad."""
    a, k = 2 * np.pi * np.arange(parts) / parts, np.arange(parts)
    rim = np.column_stack([radius * np.cos(a), np.full(parts, height), radius * np.sin(a)])
    c, s, after = np.cos(tilt), np.sin(tilt), (k + 1) % parts
    sides = np.column_stack([np.zeros_like(k), 2 + k, 2 + after])
    return np.vstack([[0, 0, 0], [0, height, 0], rim]) @ [[1, 0, 0], [0, c, s], [0, -s, c]], \
        np.vstack([sides, sides[:, ::-1] + (sides[:, ::-1] == 0)])


class Mechanics(unittest.TestCase):
    def test_folded_chain_falls_faster_than_free(self):
        vertices, triangles = strip(folded(1, 100), 0.02)
        scene = projdyn.Scene(duration=0.5, frame_interval=0.5, threads=1, time_step={"fixed": 0.001},
                              solver={"tolerance": 0.01})
        scene.add_cloth(vertices, triangles, name="chain", area_density=1,
                        triangle={"stretching_stiffness": 2e4}, pin={"vertices": {"vertices": [0, 101]}})
        sim = scene.load()
        before = 0.0
        for way in (0.5, 0.8, 0.9):
            while (fallen := -sim.bodies["chain"].x[100, 1]) < way:
                before, h = fallen, sim.step().h
            time, due = sim.time - h * (fallen - way) / (fallen - before), time_of_fall(1, way)
            print(f"folded chain: {way} m in {time:.4f} s, exact {due:.4f} s, free fall {np.sqrt(2 * way / G):.4f} s")
            self.assertLess(abs(time / due - 1), 0.008)

    def test_double_pendulum(self):
        length, angles, end = 0.5, np.radians([60, 20]), 2
        scene = projdyn.Scene(duration=end, frame_interval=end, threads=1, time_step={"fixed": 0.005},
                              solver={"tolerance": 0.01})
        scene.add_rigid(*bar(length, angles[0]), name="upper", density=1000, pin={"vertices": {"vertices": [4, 10]}})
        vertices, triangles = bar(length, angles[1])
        scene.add_rigid(vertices + length * np.array([np.sin(angles[0]), -np.cos(angles[0]), 0]), triangles,
                        name="lower", density=1000, attachment={"to": "upper", "vertices": {"vertices": [4, 10]},
                                                                "stiffness": 1e6, "length": 0})
        sim = scene.load()
        upper, lower = sim.bodies["upper"], sim.bodies["lower"]
        for _ in sim.run():
            pass
        due = double_pendulum(angles, upper.total_mass, upper.inertia[2, 2], length, sim.time)
        ways = np.array([upper.position, lower.position - 2 * upper.position])
        found = np.arctan2(ways[:, 0], -ways[:, 1])
        print(f"double pendulum after {sim.time} s: {found} rad, exact {due} rad")
        np.testing.assert_allclose(found, due, rtol=0, atol=0.02)

    def test_belt_friction(self):
        thickness, friction, segments = 0.002, 0.3, 40
        vertices, triangles = strip(wrapped(0.1 + 0.9 * thickness, segments), 0.02)
        n = segments + 1
        scene = projdyn.Scene(duration=2, frame_interval=2, threads=1, gravity=[0, 0, 0],
                              contact={"thickness": thickness, "friction": friction},
                              time_step={"fixed": 0.02, "integrator": "euler"}, solver={"tolerance": 0.01})
        scene.add_solid(name="drum", capsule={"from": [0, 0, -0.3], "to": [0, 0, 0.3], "radius": 0.1})
        scene.add_cloth(vertices, triangles, name="belt", area_density=1,
                        triangle={"stretching_stiffness": 2e4, "damping": 0.01},
                        pin=[{"vertices": {"vertices": [0, n]}},
                             {"vertices": {"vertices": [n - 1, 2 * n - 1]}, "path": [[0, 0, 0, 0], [1, 0, -0.03, 0]]}])
        sim = scene.load()
        for _ in sim.run():
            pass
        force = sim.constraints["belt", "triangle"].forces()[sim.bodies["belt"].particles, 1]
        held, pulled = force[0] + force[n], force[n - 1] + force[2 * n - 1]
        print(f"belt over a half drum: {pulled:.2f} N against {held:.2f} N, ratio {pulled / held:.3f}, "
              f"exact {np.exp(friction * np.pi):.3f}")
        self.assertLess(abs(pulled / held / np.exp(friction * np.pi) - 1), 0.05)

    def test_sail_is_a_catenary(self):
        """Wind presses with q cos^2 of the angle between sail and span: T dtheta/ds = q cos^2 theta (Bernoulli)."""
        half, speed, n = 0.5, 10, 41
        angle, radius = 1.25 * np.linspace(-1, 1, n), half / np.sin(1.25)  # an arc of a circle at the start
        start = np.column_stack([radius * np.sin(angle), radius * (np.cos(angle) - np.cos(1.25))])
        scene = projdyn.Scene(duration=10, frame_interval=10, threads=1, gravity=[0, 0, 0],
                              time_step={"fixed": 0.05, "integrator": "euler"}, solver={"tolerance": 1e-3})
        vertices, triangles = strip(start, 0.1)
        scene.add_cloth(vertices, triangles, name="sail", area_density=0.2, triangle={"stretching_stiffness": 1e6},
                        wind={"velocity": [0, speed, 0]}, pin={"vertices": {"vertices": [0, n - 1, n, 2 * n - 1]}})
        length = np.linalg.norm(np.diff(start, axis=0), axis=1).sum()
        sim = scene.load()
        for _ in sim.run():
            pass
        c, pressure = bowed(half, length), 1.2 * 1.2 * speed ** 2 / 2
        depth, exact = sim.bodies["sail"].x[:, 1].max(), c * (np.cosh(half / c) - 1)
        force = sim.constraints["sail", "triangle"].forces()[sim.bodies["sail"].particles]
        tension = np.linalg.norm(force[0] + force[n]) / 0.1
        print(f"sail: depth {depth:.5f} m, exact {exact:.5f} m; "
              f"tension {tension:.3f} N/m, exact {pressure * c:.3f} N/m")
        self.assertLess(abs(depth / exact - 1), 5e-4)
        self.assertLess(abs(tension / (pressure * c) - 1), 5e-4)

    def test_top_precesses(self):
        """A cone on its tip that spins with s about its axis: A W^2 cos(tilt) - C s W + m g l = 0."""
        tilt, spin = np.radians(30), 250
        vertices, triangles = cone(0.05, 0.1, tilt)
        scene = projdyn.Scene(duration=1, frame_interval=1, threads=1, time_step={"fixed": 0.002})
        scene.add_rigid(vertices, triangles, name="top", density=1000,
                        pin={"vertices": {"vertices": [0]}, "stiffness": 1e6})
        sim = scene.load()
        top, axis, up = sim.bodies["top"], vertices[1] / 0.1, np.array([0, 1, 0])
        l = np.linalg.norm(top.position)
        about_axis, about_tip = axis @ top.inertia @ axis, top.inertia[0, 0] + top.total_mass * l * l
        moment = top.total_mass * G * l
        rate = (about_axis * spin - np.sqrt((about_axis * spin) ** 2 - 4 * about_tip * moment * np.cos(tilt))) / \
            (2 * about_tip * np.cos(tilt))
        turn = axis * spin + rate * (up - axis * (up @ axis))
        top.set_motion(np.cross(turn, axis * l), turn)
        angles, leans = [], []
        for _ in sim.run():
            angles.append(np.arctan2(top.position[0], top.position[2]))
            leans.append(np.degrees(np.arccos(top.position[1] / np.linalg.norm(top.position))))
        found = (np.unwrap(angles)[-1] - angles[0]) / (sim.time - 0.002)
        print(f"top: precession {found:.4f} rad/s, exact {rate:.4f} rad/s, "
              f"leans by {min(leans):.2f} to {max(leans):.2f} degrees")
        self.assertLess(abs(found / rate - 1), 0.005)
        self.assertLess(max(abs(np.array(leans) - 30)), 0.2)


if __name__ == "__main__":
    unittest.main()
