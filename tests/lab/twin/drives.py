# SPDX-License-Identifier: GPL-2.0-only
"""Places of what is driven, by numpy's sines and Bezier curves between keys."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np


def rotation(angle: np.ndarray) -> np.ndarray:
    """The matrix of a rotation vector [rad], shape (3, 3)."""
    size = np.linalg.norm(angle)
    if size == 0.0:
        return np.eye(3)
    x, y, z = np.asarray(angle) / size
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(size) * cross + (1.0 - np.cos(size)) * cross @ cross


def through(times: np.ndarray, points: np.ndarray, time: float) -> np.ndarray:
    """The point at a time of a path through points of shape (K, 3): Bezier curves that leave no box around two of them."""
    if time <= times[0] or time >= times[-1]:
        return points[0 if time <= times[0] else -1]
    mean = np.diff(points, axis=0) / np.diff(times)[:, None]
    across = (points[2:] - points[:-2]) / (times[2:] - times[:-2])[:, None]
    slope = np.zeros_like(points)
    alike = mean[:-1] * mean[1:] > 0.0
    least = 3.0 * np.minimum(np.abs(mean[:-1]), np.abs(mean[1:]))
    slope[1:-1] = np.where(alike, np.clip(across, -least, least), 0.0)
    k = int(np.searchsorted(times, time, side="right")) - 1
    h = times[k + 1] - times[k]
    s = (time - times[k]) / h
    line = [points[k], points[k] + h / 3.0 * slope[k], points[k + 1] - h / 3.0 * slope[k + 1], points[k + 1]]
    while len(line) > 1:
        line = [(1.0 - s) * a + s * b for a, b in pairwise(line)]
    return line[0]


@dataclass
class Motion:
    """All that fix mdanim/drive may do at once."""

    velocity: Sequence[float] = (0.0, 0.0, 0.0)
    turn: Sequence[float] = (0.0, 0.0, 0.0)
    about: Sequence[float] = (0.0, 0.0, 0.0)
    oscillations: Sequence[tuple] = ()
    """Way, frequency and phase in turns of each."""
    pivot: Sequence[float] = (0.0, 0.0, 0.0)
    keys: Sequence[tuple] = field(default_factory=list)
    """Time, displacement and rotation vector of each."""

    def words(self) -> str:
        """As the fix takes it."""
        found = [f"velocity {_row(self.velocity)}", f"turn {_row(self.turn)} {_row(self.about)}", f"pivot {_row(self.pivot)}"]
        found += [f"oscillation {_row(way)} {f} {phase}" for way, f, phase in self.oscillations]
        return " ".join([*found, *(f"key {t} {_row(way)} {_row(angle)}" for t, way, angle in self.keys)])

    def places(self, start: np.ndarray, time: float) -> np.ndarray:
        """Places of points with these places at the start, shape (N, 3)."""
        moved, centre, pivot = np.asarray(start, float), np.asarray(self.about, float), np.asarray(self.pivot, float)
        if self.keys:
            times, ways, angles = (np.array([key[k] for key in self.keys], float) for k in range(3))
            moved = pivot + through(times, ways, time) + (moved - pivot) @ rotation(through(times, angles, time)).T
        moved = centre + (moved - centre) @ rotation(time * np.asarray(self.turn, float)).T
        for way, frequency, phase in self.oscillations:
            moved = moved + np.asarray(way) * (np.sin(2 * np.pi * (frequency * time + phase)) - np.sin(2 * np.pi * phase))
        return moved + time * np.asarray(self.velocity)


def _row(numbers: Sequence[float]) -> str:
    return " ".join(str(float(x)) for x in numbers)
