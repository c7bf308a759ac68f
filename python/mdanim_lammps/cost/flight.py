# SPDX-License-Identifier: GPL-2.0-only
"""Where objects are when each flies by itself: what forecasts look at. Neither MPI nor LAMMPS."""

from __future__ import annotations

import numpy as np

from ..model.basin import liquid_level
from ..run.prepare import Prepared

FLIGHT = 0.005
"""Step of the flights [s]."""


class Flight:
    """Boxes of objects that fly by themselves and bounce back from ground and walls; what comes to a liquid stays where it is."""

    def __init__(self, ready: Prepared):
        scene, system = ready.scene, ready.system
        on = {e.name for e in ready.plan.effects}
        held = np.logical_or.reduceat(system.held, system.first[:-1])
        self.low, self.high = system.bounds(system.position)
        self.velocity = np.where(held[:, None], 0.0, [s.velocity for s in scene.solids])
        apart = np.linalg.norm(system.velocity - self.velocity[system.object], axis=1)
        self.around = np.maximum.reduceat(apart, system.first[:-1])
        """Speed of the fastest particle relative to its object, by its spin [m/s], shape (M,)."""
        self.gravity = np.where(held[:, None], 0.0, np.array(scene.gravity) * ("gravity" in on))
        self.floor, self.ceiling = np.full(3, -np.inf), np.full(3, np.inf)
        if "walls" in on:
            self.floor, self.ceiling = np.array(scene.walls.low, float), np.array(scene.walls.high, float)
        if "ground" in on:
            self.floor[2] = max(self.floor[2], scene.ground)
        self.surface = liquid_level(scene.liquid) if "liquid" in on else -np.inf
        self.time = 0.0

    def to(self, time: float) -> None:
        """Fly on to this time [s]."""
        while self.time < time - 1e-9:
            dt = min(FLIGHT, time - self.time)
            self.velocity = np.where((self.low[:, 2] < self.surface)[:, None], 0.0, self.velocity + dt * self.gravity)
            for side, sign in ((self.low < self.floor, 1.0), (self.high > self.ceiling, -1.0)):
                self.velocity = np.where(side, sign * np.abs(self.velocity), self.velocity)
            self.low, self.high = self.low + dt * self.velocity, self.high + dt * self.velocity
            self.time += dt

    def boxes(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Corners (M, 3) [m], and the speed of the fastest particle of each (M,) [m/s]."""
        return self.low, self.high, np.linalg.norm(self.velocity, axis=1) + self.around
