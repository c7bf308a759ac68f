# SPDX-License-Identifier: GPL-2.0-only
"""Vectors that change with time: several lines of a setting, each with its time."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from typing import Any

from .formatting import number, whole
from .schema import Codec, Keyword, Vector

MOST_POINTS = 10_000
"""Points of a vector that changes."""


class InTime(Codec):
    """One vector, or several with their times; the record holds that of the start, and all points of several.

    Args:
        word: of the setting, ``[at <T:s>] <(x, y, z):UNIT>``.
        example: text after the word, with a time.
    """

    def __init__(self, word: str, example: str):
        self.word, self.example = word, example

    def read(self, k: Keyword, choice: int, values: tuple) -> tuple[float | None, Vector]:
        """Time and vector."""
        return values

    def gather(self, values: tuple) -> tuple[Vector, tuple]:
        """The vector at the start, and the path."""
        if len(values) == 1:
            return values[0][1], ()
        if len(values) > MOST_POINTS:
            raise ValueError(f"{self.word} is given {whole(len(values))} times", f"the most is {whole(MOST_POINTS)}", MOST_POINTS)
        for n, (time, _) in enumerate(values):
            if time is None:
                cause = f"{self.word} is given several times, and this one has no time"
                raise ValueError(cause, f"write {self.word} {self.example}, or leave it out", n)
            if time < 0.0 or (n and time <= values[n - 1][0]):
                before = f" after {number(values[n - 1][0], 6)} s" if n else ""
                raise ValueError(f"the times of {self.word} must be >= 0 and rise, found {number(time, 6)} s{before}", "", n)
        return vector_at(values, 0.0), values

    def scatter(self, value: tuple[Vector, tuple]) -> tuple:
        """The points, or the one vector."""
        vector, path = value
        return path or ((None, vector),)

    def write(self, k: Keyword, value: Any) -> tuple[int, tuple] | None:
        return 0, value


def vector_at(path: tuple, time: float) -> Vector:
    """The vector at a time [s]: straight between points (T, a), as it is at the ends beyond them, shape (3,)."""
    if time <= path[0][0]:
        return path[0][1]
    for (a, low), (b, high) in pairwise(path):
        if time < b:
            part = (time - a) / (b - a)
            return tuple(x + part * (y - x) for x, y in zip(low, high))
    return path[-1][1]


def integral(path: tuple, times: Iterable[float]) -> list[Vector]:
    """Integrals of `vector_at` from 0 to each of these times [s], which ascend: exact, as it is straight between points."""
    found, last, sums = [], 0.0, (0.0, 0.0, 0.0)
    corners = [t for t, _ in path]
    for time in times:
        for end in (*(t for t in corners if last < t < time), time):
            a, b = vector_at(path, last), vector_at(path, end)
            sums = tuple(s + (end - last) * (x + y) / 2.0 for s, x, y in zip(sums, a, b))
            last = end
        found.append(sums)
    return found
