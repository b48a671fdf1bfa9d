"""Small scenes of the tests. Messages of the library are not printed."""
import logging

import numpy as np

import projdyn

logging.getLogger("projdyn").addHandler(logging.NullHandler())


def hanging_sheet(n=9, **keys):
    """A sheet of n x n vertices that hangs by two corners."""
    scene = projdyn.Scene(**{"duration": 1, "threads": 1, **keys})
    scene.add_cloth(grid={"size": [1, 1], "vertices": [n, n]}, name="sheet", area_density=0.2,
                    spring={"stretching_stiffness": 500}, bending={"bending_rigidity": 1e-3},
                    pin={"vertices": {"vertices": [0, n - 1]}})
    return scene


def tank_of_water(**keys):
    """Water, 0.2 m deep, in a tank of 0.24 m x 0.24 m."""
    scene = projdyn.Scene(**{"duration": 1, "threads": 1, **keys})
    scene.add_fluid(box=([0, 0, 0], [0.24, 0.2, 0.24]), radius=0.02, name="water",
                    fluid={"compression": 0.001, "viscosity": 0.5})
    scene.add_solid(name="tank", box=([0, 0, 0], [0.24, 0.4, 0.24]), open=["+y"])
    return scene


def square():
    """Vertices and triangles of a unit square in the plane y = 0."""
    return np.array([[0, 0, 0], [1, 0, 0], [0, 0, 1], [1, 0, 1]], float), [[0, 2, 3], [0, 3, 1]]
