# SPDX-License-Identifier: GPL-2.0-only
"""Sources of the quantities of ``expect``: a run that has ended, and objects at a frame."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..model.model import Model
from ..scene.scene import Expect
from .context import Context
from .fields import Fields


@dataclass(frozen=True)
class Measured:
    """Data of a run from which quantities are measured; F frames of M solids."""

    context: Context
    times: np.ndarray
    """[s], shape (F,)."""
    center: np.ndarray
    """Centres of mass [m], shape (F, M, 3)."""
    velocity: np.ndarray
    """Their velocities [m/s], shape (F, M, 3)."""
    penetration: float
    """Deepest penetration of the run [m]."""
    ledger: Callable[[str], np.ndarray]
    """Gives a column of the ledger, shape (F,)."""
    trajectory: Any
    """results.trajectory.Trajectory: for quantities that need all frames."""

    def solid(self, name: str) -> int:
        """Number of an object, from 0."""
        return self.context.system.names.index(name)

    def until(self, values: np.ndarray, time: float | None) -> np.ndarray:
        """Values of frames up to a time, or of the whole run."""
        return values if time is None else values[self.times <= time * (1 + 1e-9)]

    def largest(self, values: np.ndarray, time: float | None) -> float:
        """Largest magnitude up to a time, or in the whole run."""
        return float(np.abs(self.until(values, time)).max())

    def at(self, values: np.ndarray, time: float | None) -> float:
        """The value at a time, linear between frames; without a time at the end."""
        return float(values[-1] if time is None else np.interp(time, self.times, values))


Measure = Callable[[Measured, Expect], float]
"""Finds what an ``expect`` asks for."""


@dataclass(frozen=True)
class Glance:
    """An object at a frame."""

    context: Context
    solid: int
    """Its number, from 0."""
    model: Model
    position: np.ndarray
    """Positions of all particles [m], shape (N, 3)."""
    velocity: np.ndarray
    """Velocities of all particles [m/s], shape (N, 3); only those of the object itself are sure to be those of the frame."""
    fields: Fields
    """Fields of effects in the frame; empty where the object is out of their reach."""

    @property
    def own(self) -> np.ndarray:
        """Positions of its own particles [m], shape (n, 3)."""
        first = self.context.system.first
        return self.position[first[self.solid] : first[self.solid + 1]]


@dataclass(frozen=True)
class Recorded:
    """A quantity of an object that needs all its particles at every frame: it is a column of the ledger, ``COLUMN.OBJECT``."""

    column: str
    look: Callable[[Glance], float]
    """Finds it at a frame."""
    measure: Callable[[Measured, np.ndarray, float | None], float]
    """Finds what is asked for in its values at all frames, shape (F,), at or until a time."""
