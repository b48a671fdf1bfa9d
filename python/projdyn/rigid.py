"""Rigid bodies: pose, motion, force and moment."""
from __future__ import annotations

from typing import Any

import numpy as np

from ._arrays import address, doubles
from ._fixed import Fixed
from ._handles import Handle
from ._library import lib
from .body import POINTS, Body, has_pose
from .errors import InputError


class Rigid(Body):
    """A rigid body, with all that a body has.

    Its mass and inertia are those of four points of a fourth of the mass each, which follow its n
    vertices in arrays of all particles. Rotations are 3 x 3 matrices.
    """

    is_rigid = True
    _instead = {"pose": "position and rotation are its pose", "move": "set_pose places it at once"}

    def __init__(self, handle: Handle, index: int, state: dict) -> None:
        self._wrench: list[tuple[np.ndarray, np.ndarray]] = []  # one while there is a moment
        super().__init__(handle, index, state)

    @property
    def position(self) -> np.ndarray:
        """3, m: the centre of mass."""
        return self._points("x").mean(0)

    @property
    def rotation(self) -> np.ndarray:
        """3 x 3: from the place in the scene to the present one, x = position + R (rest - c)."""
        rest, now = self.rest - self.rest.mean(0), self.x - self.x.mean(0)
        return np.linalg.lstsq(rest, now, rcond=None)[0].T

    @property
    def velocity(self) -> np.ndarray:
        """3, m/s: of the centre of mass."""
        return self._points("v").mean(0)

    @property
    def inertia(self) -> np.ndarray:
        """3 x 3, kg m^2: inertia tensor about the centre of mass, in the present pose."""
        arms = self._arms()
        return 0.25 * self.total_mass * (np.sum(arms**2) * np.eye(3) - arms.T @ arms)

    @property
    def angular_velocity(self) -> np.ndarray:
        """3, rad/s."""
        moments = np.cross(self._arms(), self._points("v")).sum(0)
        return np.linalg.solve(self.inertia, 0.25 * self.total_mass * moments)

    # ---- between two steps ----------------------------------------------------------------------

    def set_wrench(self, force: Any = (0, 0, 0), moment: Any = (0, 0, 0)) -> None:
        """Sets a force through the centre of mass, N, and a moment about it, N m, which act until
        they are set again, beside the forces on the vertices. Both keep their direction in the
        world. A saved state has the force, but not the moment: set it again after restore, which
        ends the moment that acts."""
        push, turn = doubles(force, (3,), "force"), doubles(moment, (3,), "moment")
        self._wrench[:] = [(push.copy(), turn.copy())] if turn.any() else []
        self._apply(push, turn)

    def set_pose(self, position: Any, rotation: Any = np.eye(3)) -> None:
        """Places the body: its centre of mass, m, and its rotation from the place in the scene.
        InputError: the matrix is no rotation, to 1e-6."""
        turn, place = doubles(rotation, (3, 3), "rotation"), doubles(position, (3,), "position")
        if not np.abs(turn @ turn.T - np.eye(3)).max() <= 1e-6 or np.linalg.det(turn) < 0:
            raise InputError("rotation: expected a rotation matrix R, with R R' = 1 and the "
                             "determinant 1")
        now = self.rotation.T @ (self.x - self.position).T
        self.set_positions((place[:, None] + turn @ now).T)

    def set_motion(self, velocity: Any = (0, 0, 0), angular_velocity: Any = (0, 0, 0)) -> None:
        """Sets the velocity of the centre of mass, m/s, and the angular velocity, rad/s."""
        move = doubles(velocity, (3,), "velocity")
        spin = doubles(angular_velocity, (3,), "angular_velocity")
        self.set_velocities(move + np.cross(spin, self.x - self.position))

    # ---- parts ----------------------------------------------------------------------------------

    _hint = Fixed._hint  # that of Body names the rigid bodies

    def begin_step(self) -> None:
        """A moment is forces on points, which turn with the body: they are set anew."""
        for wrench in self._wrench:
            self._apply(*wrench)

    def end_wrench(self) -> None:
        """The forces of a restored state take the place of those of a moment."""
        self._wrench.clear()

    def _apply(self, push: np.ndarray, turn: np.ndarray) -> None:
        spin = np.linalg.solve(self.inertia, turn)
        forces = 0.25 * (push + self.total_mass * np.cross(spin, self._arms()))
        self._handle.call(lib.pdyn_set_forces, self.particles.stop, POINTS,
                          address(doubles(forces, (POINTS, 3), "forces")))

    def _points(self, name: str) -> np.ndarray:
        return self._all[name][self.particles.stop:self.particles.stop + POINTS]

    def _arms(self) -> np.ndarray:
        return self._points("x") - self.position


def body_of(handle: Handle, index: int, state: dict) -> Body:
    """The body of this index, a Rigid where it is one."""
    return (Rigid if has_pose(handle, index, len(state["mass"])) else Body)(handle, index, state)
