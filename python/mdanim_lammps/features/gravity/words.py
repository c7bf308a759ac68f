# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

from ...scene.formatting import number, whole
from ...scene.schema import Codec, Keyword, Vector, setting

SWITCHES = {"gravity": "a gravity vector that is not zero"}

MOST_POINTS = 10_000
"""Points of a gravity that changes."""


class Points(Codec):
    """One acceleration, or several with their times; the record holds that of the start, and all points of several."""

    def read(self, k: Keyword, choice: int, values: tuple) -> tuple[float | None, Vector]:
        """Time and acceleration."""
        return values

    def gather(self, values: tuple) -> tuple[Vector, tuple]:
        """The acceleration at the start, and the path."""
        if len(values) == 1:
            return values[0][1], ()
        if len(values) > MOST_POINTS:
            raise ValueError(f"gravity is given {whole(len(values))} times", f"the most is {whole(MOST_POINTS)}", MOST_POINTS)
        for n, (time, _) in enumerate(values):
            if time is None:
                cause = "gravity is given several times, and this one has no time"
                raise ValueError(cause, "write gravity at 1 s (0, 0, -9.81) m/s^2, or leave it out", n)
            if time < 0.0 or (n and time <= values[n - 1][0]):
                before = f" after {number(values[n - 1][0], 6)} s" if n else ""
                raise ValueError(f"the times of gravity must be >= 0 and rise, found {number(time, 6)} s{before}", "", n)
        return acceleration_at(values, 0.0), values

    def scatter(self, value: tuple[Vector, tuple]) -> tuple:
        """The points, or the one acceleration."""
        vector, path = value
        return path or ((None, vector),)

    def write(self, k: Keyword, value: Any) -> tuple[int, tuple]:
        return 0, value


def acceleration_at(path: tuple, time: float) -> Vector:
    """The acceleration at a time [s]: straight between points (T, g), as it is at the ends beyond them [m/s^2], shape (3,)."""
    if time <= path[0][0]:
        return path[0][1]
    for (a, low), (b, high) in pairwise(path):
        if time < b:
            part = (time - a) / (b - a)
            return tuple(x + part * (y - x) for x, y in zip(low, high))
    return path[-1][1]


class GravityWords:
    """Settings outside of all blocks."""

    gravity: Vector = setting(
        "[at <T:s>] <(gx, gy, gz):m/s^2>",
        "Acceleration of free fall. Absent or zero: no gravity effect at all. With a liquid it must point along -z. Several "
        "lines with times T make it change: straight from each to the next, and as it was given first and last before and "
        "after; not with a liquid.",
        "(0, 0, -9.81) m/s^2", default=(0.0, 0.0, 0.0), many=True, also=("gravity_path",),
        codec=Points())  # fmt: skip
    """The acceleration at the start [m/s^2]."""
    gravity_path: tuple[tuple[float, Vector], ...] = ()
    """Points (T, g) between which it changes [s, m/s^2]; empty where it does not."""


SCENE = GravityWords
