# SPDX-License-Identifier: GPL-2.0-only
"""Where objects are when each flies by itself: what forecasts look at. Neither MPI nor LAMMPS."""

from __future__ import annotations

import numpy as np

from ..model.system import System
from .acting import Acting

FLIGHT = 0.005
"""Step of the flights [s]."""


class Flight:
    """Boxes of objects that fly by themselves and bounce back from planes; an object that comes to a liquid stays where it is,
    and so does one that something holds in a place."""

    def __init__(self, acting: Acting, system: System):
        held = np.logical_or.reduceat(system.held, system.first[:-1]) | np.isfinite(acting.room[0]).all(axis=1)
        self.low, self.high = system.bounds(system.position)
        self.velocity = np.where(held[:, None], 0.0, np.reshape([s.velocity for s in acting.scene.solids], (-1, 3)))
        apart = np.linalg.norm(system.velocity - self.velocity[system.object], axis=1)
        self.around = np.maximum.reduceat(apart, system.first[:-1])
        """Speed of the fastest particle relative to its object, by its spin [m/s], shape (M,)."""
        self.acceleration = np.where(held[:, None], 0.0, acting.acceleration)
        self.floor, self.ceiling = acting.limits
        self.surface = -np.inf if acting.surface is None else acting.surface
        self.time = 0.0

    def to(self, time: float) -> None:
        """Fly on to this time [s]."""
        while self.time < time - 1e-9:
            dt = min(FLIGHT, time - self.time)
            self.velocity = np.where((self.low[:, 2] < self.surface)[:, None], 0.0, self.velocity + dt * self.acceleration)
            for side, sign in ((self.low < self.floor, 1.0), (self.high > self.ceiling, -1.0)):
                self.velocity = np.where(side, sign * np.abs(self.velocity), self.velocity)
            self.low, self.high = self.low + dt * self.velocity, self.high + dt * self.velocity
            self.time += dt

    def swept(self, time: float) -> tuple[np.ndarray, np.ndarray]:
        """Fly on to this time [s]; corners (M, 3) [m] of boxes around the way there."""
        low, high = self.low, self.high
        while self.time < time - 1e-9:
            self.to(min(self.time + FLIGHT, time))
            low, high = np.minimum(low, self.low), np.maximum(high, self.high)
        return low, high

    def boxes(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Corners (M, 3) [m], and the speed of the fastest particle of each (M,) [m/s]."""
        return self.low, self.high, np.linalg.norm(self.velocity, axis=1) + self.around
