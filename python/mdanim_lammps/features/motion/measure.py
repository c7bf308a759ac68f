# SPDX-License-Identifier: GPL-2.0-only
"""Quantities of the motion of objects that ``expect`` can ask for."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...effects.measured import Glance, Measured, Recorded
from ...model.spin import spin
from ...scene.scene import Expect


def _place(m: Measured, e: Expect) -> np.ndarray:
    return motion(m, m.solid(e.subject), e.time)[0]


def _velocity(m: Measured, e: Expect) -> np.ndarray:
    return motion(m, m.solid(e.subject), e.time)[1]


def _distance(m: Measured, e: Expect) -> float:
    return float(np.linalg.norm(_place(m, e) - motion(m, m.solid(e.argument), e.time)[0]))


def _along(vector: Callable[[Measured, Expect], np.ndarray], axis: int) -> Callable[[Measured, Expect], float]:
    return lambda m, e: float(vector(m, e)[axis])


MEASURES = {
    **{
        ("NAME", f"{word}.{letter}"): _along(vector, axis)
        for word, vector in (("position", _place), ("velocity", _velocity))
        for axis, letter in enumerate("xyz")
    },
    ("NAME", "speed"): lambda m, e: float(np.linalg.norm(_velocity(m, e))),
    ("NAME", "distance"): _distance,
}


def _spin(g: Glance) -> np.ndarray:
    first = g.context.system.first
    own = slice(first[g.solid], first[g.solid + 1])
    return spin(g.context.system.mass[own], np.zeros(1, int), g.position[own], g.velocity[own])[0]


RECORDED = {
    "spin": Recorded("spin", lambda g: float(np.linalg.norm(_spin(g))), Measured.at),
    **{
        f"spin.{letter}": Recorded(f"spin.{letter}", lambda g, axis=axis: float(_spin(g)[axis]), Measured.at)
        for axis, letter in enumerate("xyz")
    },
}


def motion(m: Measured, solid: int, time: float | None) -> tuple[np.ndarray, np.ndarray]:
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
    position = (
        (1 + 2 * s) * (1 - s) ** 2 * x[before]
        + s * (1 - s) ** 2 * dt * v[before]
        + s * s * (3 - 2 * s) * x[after]
        + s * s * (s - 1) * dt * v[after]
    )
    velocity = (
        6 * s * (1 - s) * (x[after] - x[before]) / dt + (1 - 4 * s + 3 * s * s) * v[before] + (3 * s * s - 2 * s) * v[after]
    )
    return position, velocity
