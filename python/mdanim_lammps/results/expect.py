# SPDX-License-Identifier: GPL-2.0-only
"""The scene's own checks: every ``expect`` line, measured after the run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..model.system import System
from ..scene.scene import Expect


@dataclass(frozen=True, slots=True)
class Outcome:
    """What an ``expect`` line asked for and what was found."""

    expect: Expect
    found: float

    @property
    def met(self) -> bool:
        # A NaN is never met; the last digit of a value read from text is forgiven.
        e = self.expect
        return abs(self.found - e.value) <= e.tolerance + 1e-12 * max(abs(e.value), e.tolerance)

    def __str__(self) -> str:
        e = self.expect
        when = "" if e.time is None else f" at {e.time:g} s"
        verdict = "met" if self.met else "MISSED"
        place = f"{e.span}: " if e.span else ""
        return (f"{place}expect {e.subject}.{e.quantity}{when} = {e.value:g} +- {e.tolerance:g}: "
                f"found {self.found:.6g}, {verdict}")


@dataclass(frozen=True)
class Measured:
    """What a run has left to be measured; F frames of M solids."""

    names: tuple[str, ...]
    times: np.ndarray
    """[s], shape (F,)."""
    center: np.ndarray
    """Centres of mass [m], shape (F, M, 3)."""
    velocity: np.ndarray
    """Their velocities [m/s], shape (F, M, 3)."""
    residual: np.ndarray
    """Energy residual at each frame, shape (F,)."""
    strain: Mapping[str, np.ndarray]
    """Largest |r/r0 - 1| of the solids that an ``expect`` asks about, at each frame, shape (F,)."""
    penetration: float
    """Deepest penetration of the run [m]."""


def evaluate(expects: tuple[Expect, ...], measured: Measured) -> list[Outcome]:
    """Measure every expectation. Quantities of a liquid are refused before the run, so none is left here."""
    return [Outcome(e, _measure(e, measured)) for e in expects]


def strained(expects: tuple[Expect, ...]) -> tuple[str, ...]:
    """Solids whose strain has to be recorded during the run, in order and once."""
    return tuple(dict.fromkeys(e.subject for e in expects if e.quantity == "strain.max"))


def largest_strain(system: System, solid: int, position: np.ndarray) -> float:
    """Largest |r/r0 - 1| of the springs of a solid [-], for particle positions [m], shape (N, 3)."""
    low, high = np.searchsorted(system.spring[:, 0], system.first[solid:solid + 2])
    i, j = system.spring[low:high].T
    if not len(i):
        return 0.0
    r = np.linalg.norm(position[i] - position[j], axis=1)
    return float(np.abs(r / system.rest[low:high] - 1.0).max())


def _measure(expect: Expect, m: Measured) -> float:
    match expect.subject, expect.quantity:
        case "energy", "residual":
            return _largest(m, m.residual, expect.time)
        case "penetration", "max":
            return m.penetration
        case name, "strain.max":
            return _largest(m, m.strain[name], expect.time)
        case name, quantity:
            kind, axis = quantity.split(".")
            position, velocity = _motion(m, m.names.index(name), expect.time)
            return float((position if kind == "position" else velocity)["xyz".index(axis)])


def _largest(m: Measured, values: np.ndarray, time: float | None) -> float:
    """Largest magnitude up to a time, or in the whole run."""
    upto = values if time is None else values[m.times <= time * (1 + 1e-9)]
    return float(np.abs(upto).max())


def _motion(m: Measured, solid: int, time: float | None) -> tuple[np.ndarray, np.ndarray]:
    """Centre of mass and its velocity; between two frames by the cubic that meets both positions and velocities."""
    x, v = m.center[:, solid], m.velocity[:, solid]
    if time is None:
        return x[-1], v[-1]
    after = min(int(np.searchsorted(m.times, time * (1 - 1e-9))), len(m.times) - 1)
    if after == 0 or abs(m.times[after] - time) <= 1e-9 * time:
        return x[after], v[after]
    before = after - 1
    dt = m.times[after] - m.times[before]
    s = (time - m.times[before]) / dt
    position = ((1 + 2 * s) * (1 - s) ** 2 * x[before] + s * (1 - s) ** 2 * dt * v[before]
                + s * s * (3 - 2 * s) * x[after] + s * s * (s - 1) * dt * v[after])
    velocity = (6 * s * (1 - s) * (x[after] - x[before]) / dt
                + (1 - 4 * s + 3 * s * s) * v[before] + (3 * s * s - 2 * s) * v[after])
    return position, velocity
