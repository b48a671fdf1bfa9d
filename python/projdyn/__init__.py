"""Projective Dynamics for fluids, cloth and solids in one solve.

Build a scene from arrays or open one, load it, step it, read and change its state:

    import projdyn

    scene = projdyn.Scene(duration=1)
    scene.add_cloth(grid={"size": [1, 1], "vertices": [50, 50]}, name="sheet", area_density=0.2,
                    spring={"stretching_stiffness": 500}, pin={"vertices": {"vertices": [0, 49]}})
    sim = scene.load()
    for info in sim.run():
        print(info.time, sim.bodies["sheet"].x[:, 1].min())

Quantities are in SI units: metres, kilograms, seconds, newtons, pascals; angles are in degrees.
Messages of the library go to the logger "projdyn" of the module logging.
"""
from ._library import version
from ._structs import StepInfo
from .body import Body
from .constraint import Constraint, Parameter
from .errors import Error, InputError, StepError
from .inlet import Inlet
from .notebook import replay
from .pictures import Picture, mesh, render, usd
from .plots import plot, plot_sweep
from .probe import Probe
from .rigid import Rigid
from .scene import Scene, load
from .simulation import Simulation, Warning
from .solid import Load, Pose, Solid
from .writer import Writer

__version__ = version()

__all__ = ["Body", "Constraint", "Error", "Inlet", "InputError", "Load", "Parameter", "Picture", "Pose",
           "Probe", "Rigid", "Scene", "Simulation", "Solid", "StepError", "StepInfo", "Warning", "Writer",
           "load", "mesh", "plot", "plot_sweep", "render", "replay", "usd", "version"]
