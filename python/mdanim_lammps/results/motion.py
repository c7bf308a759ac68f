# SPDX-License-Identifier: GPL-2.0-only
"""How whole objects move: spin and kinetic energy from their particles, and the table of all objects and frames."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..scene.scene import Save

if TYPE_CHECKING:
    from .trajectory import Trajectory


def spin(mass: np.ndarray, first: np.ndarray, position: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Angular velocity of each object [rad/s], shape (O, 3): its angular momentum about its centre of mass over its inertia.

    Args:
        mass: of N particles [kg], shape (N,).
        first: first particle of each object, shape (O,).
        position, velocity: [m], [m/s], shape (N, 3).
    """
    count = np.diff(first, append=len(mass))
    mean = lambda value: np.add.reduceat(mass[:, None] * value, first) / np.add.reduceat(mass, first)[:, None]
    arm, speed = position - np.repeat(mean(position), count, axis=0), velocity - np.repeat(mean(velocity), count, axis=0)
    momentum = np.add.reduceat(mass[:, None] * np.cross(arm, speed), first)
    square = np.einsum("nd,nd->n", arm, arm)
    inertia = np.add.reduceat(
        mass[:, None, None] * (square[:, None, None] * np.eye(3) - arm[:, :, None] * arm[:, None, :]), first
    )
    # A line of particles has no inertia about itself: there the spin is zero.
    return np.einsum("oij,oj->oi", np.linalg.pinv(inertia, hermitian=True), momentum)


def kinetic(mass: np.ndarray, first: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Kinetic energy of each object [J], shape (O,): of its flight, its spin and its vibrations."""
    return np.add.reduceat(0.5 * mass * np.einsum("nd,nd->n", velocity, velocity), first)


class MotionTable:
    """A table with a row for each object and frame: frame, time [s], object, centre of mass [m], its velocity [m/s]; where all
    particles are stored also spin [rad/s] and kinetic energy [J].

    Args:
        trajectory: of the run.
        objects: indices into ``trajectory.names``, ascending, shape (O,).
    """

    def __init__(self, trajectory: Trajectory, objects: np.ndarray):
        self.trajectory, self.objects, m = trajectory, objects, trajectory.metadata
        self.columns = ["frame", "time", "object", "x", "y", "z", "vx", "vy", "vz"]
        self.whole = m.save is Save.ALL
        """Whether all particles are stored."""
        if self.whole:
            self.columns += ["wx", "wy", "wz", "kinetic"]

    def numbers(self, frame: int) -> np.ndarray:
        """What stands behind frame, time and object in the rows of a frame, shape (O, columns - 3). Raises OutputError."""
        t, m = self.trajectory, self.trajectory.metadata
        found = [t.centers[frame], t.center_velocities[frame]]
        if self.whole:
            x, v = t.position(frame), t.velocity(frame)
            found += [spin(m.mass, m.first[:-1], x, v), kinetic(m.mass, m.first[:-1], v)[:, None]]
        return np.hstack(found)[self.objects]
