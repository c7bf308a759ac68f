# SPDX-License-Identifier: GPL-2.0-only
"""Quantities of a run: their values at all frames, and single numbers of these."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ..model.grid import Grid
from ..model.model import Model
from ..records import dataclass
from ..scene.scene import Asked, Expect, SceneRecord
from .context import Context
from .fields import Fields


@dataclass(frozen=True)
class Measured:
    """Data of a run from which quantities are measured; F frames of M solids."""

    scene: SceneRecord
    names: tuple[str, ...]
    """Names of the objects, in the order of the scene."""
    grid: Grid | None
    """Cells of the scene; None where it has none."""
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
    has: Callable[[str], bool] = lambda column: True
    """Whether the ledger has a column."""

    def solid(self, name: str) -> int:
        """Number of an object, from 0."""
        return self.names.index(name)

    def until(self, values: np.ndarray, time: float | None) -> np.ndarray:
        """Values of frames up to a time, or of the whole run."""
        return values if time is None else values[self.times <= time * (1 + 1e-9)]

    def largest(self, values: np.ndarray, time: float | None) -> float:
        """Largest magnitude up to a time, or in the whole run."""
        return float(np.abs(self.until(values, time)).max())

    def highest(self, values: np.ndarray, time: float | None) -> float:
        """Largest value up to a time, or in the whole run."""
        return float(self.until(values, time).max())

    def at(self, values: np.ndarray, time: float | None) -> float:
        """The value at a time, linear between frames; without a time at the end."""
        return float(values[-1] if time is None else np.interp(time, self.times, values))

    def lasting(self, values: np.ndarray, time: float | None) -> float:
        """The value at a time of what a frame has the mean of since the frame before."""
        if time is None:
            return float(values[-1])
        return float(values[min(max(1, int(np.searchsorted(self.times, time * (1 - 1e-9)))), len(values) - 1)])


Of = Asked | Expect
"""Lines that ask for a quantity: with its subject, and the argument if it has one."""


class Measurable:
    """A quantity that ``expect``, ``record``, ``plot`` and ``arrows`` may ask for.

    Args:
        series: gives its values at all frames, shape (F,), NaN where there is none.
        single: one number of them, at a time [s], or in the whole run.
        between: the same without the series, of what is known better between frames than on a straight line.
    """

    since = False
    """Whether the value of a frame is the mean since the frame before."""

    def __init__(
        self,
        series: Callable[[Measured, Of], np.ndarray],
        single: Callable[[Measured, np.ndarray, float | None], float] = Measured.at,
        between: Callable[[Measured, Of, float], float] | None = None,
    ):
        self.series, self.single, self.between = series, single, between

    def value(self, m: Measured, of: Of, time: float | None) -> float:
        """One number, at a time [s], or in the whole run."""
        if self.between is not None and time is not None:
            return self.between(m, of, time)
        return self.single(m, self.series(m, of), time)

    def within(self, m: Measured, of: Of, begin: float, end: float) -> tuple[np.ndarray, np.ndarray]:
        """Times [s] and values of the frames in a window, and of its ends."""
        inside = (m.times > begin * (1 + 1e-9)) & (m.times < end * (1 - 1e-9))
        ends = [self.at(m, of, time) for time in (begin, end)]
        return np.array([begin, *m.times[inside], end]), np.array([ends[0], *self.series(m, of)[inside], ends[1]])

    def at(self, m: Measured, of: Of, time: float) -> float:
        """Its value at a time [s], also of what is asked for as the largest so far."""
        return self.between(m, of, time) if self.between is not None else m.at(self.series(m, of), time)

    def mean(self, m: Measured, of: Of, begin: float, end: float) -> float:
        """Mean over a window [s], with straight lines between frames."""
        times, values = self.within(m, of, begin, end)
        return float(np.trapezoid(values, times) / (end - begin)) if end > begin else float(values[0])


class Mean(Measurable):
    """A quantity of which a frame has the mean since the frame before; the first frame has none, NaN."""

    since = True

    def __init__(self, series: Callable[[Measured, Of], np.ndarray]):
        super().__init__(series, Measured.lasting)

    def at(self, m, of, time):
        return m.lasting(self.series(m, of), time)

    def mean(self, m, of, begin, end):
        """Mean over a window, by the part of each frame's time that is in it."""
        edges = np.clip(m.times, begin, end)
        weight = np.diff(edges)
        return float((self.series(m, of)[1:] * weight).sum() / weight.sum()) if weight.sum() else self.at(m, of, begin)


Measure = Callable[[Measured, Of], np.ndarray]
"""Finds the values of a quantity at all frames, shape (F,); of a vector shape (F, 3)."""


def of_vector(subject: str, word: str, vector: Measure, kind: type[Measurable] = Measurable) -> dict[tuple[str, str], Measurable]:
    """Size and components of a vector, by subject and word: ``weight``, ``weight.x``, ..."""
    found = {(subject, word): kind(lambda m, of: np.linalg.norm(vector(m, of), axis=1))}
    axes = {f"{word}.{letter}": axis for axis, letter in enumerate("xyz")}
    return found | {(subject, part): kind(lambda m, of, axis=axis: vector(m, of)[:, axis]) for part, axis in axes.items()}


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
    def mine(self) -> slice:
        """Its own particles among all."""
        first = self.context.system.first
        return slice(int(first[self.solid]), int(first[self.solid + 1]))

    @property
    def own(self) -> np.ndarray:
        """Positions of its own particles [m], shape (n, 3)."""
        return self.position[self.mine]


class Recorded(Measurable):
    """A quantity of an object that needs all its particles at every frame: it is a column of the ledger, ``COLUMN.OBJECT``.

    Args:
        column: the first part of its name.
        look: finds it at a frame.
        single: as of `Measurable`.
        follow: makes the series of what was found at all frames, shape (F,).
    """

    def __init__(
        self,
        column: str,
        look: Callable[[Glance], float],
        single: Callable[[Measured, np.ndarray, float | None], float] = Measured.at,
        follow: Callable[[np.ndarray], np.ndarray] = np.asarray,
    ):
        super().__init__(lambda m, of: follow(m.ledger(self.column_of(of))), single)
        self.column, self.look = column, look

    def column_of(self, of: Of) -> str:
        """Its column of the ledger."""
        return f"{self.column}.{of.subject}"
