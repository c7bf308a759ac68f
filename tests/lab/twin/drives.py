# SPDX-License-Identifier: GPL-2.0-only
"""Places of what is driven, by numpy's sines and the curve of cameras."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from mdanim_lammps.picture.camera import hermite_weights


def rotation(angle: np.ndarray) -> np.ndarray:
    """The matrix of a rotation vector [rad], shape (3, 3)."""
    size = np.linalg.norm(angle)
    if size == 0.0:
        return np.eye(3)
    x, y, z = np.asarray(angle) / size
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(size) * cross + (1.0 - np.cos(size)) * cross @ cross


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
            weights = hermite_weights(times, time)
            moved = pivot + weights @ ways + (moved - pivot) @ rotation(weights @ angles).T
        moved = centre + (moved - centre) @ rotation(time * np.asarray(self.turn, float)).T
        for way, frequency, phase in self.oscillations:
            moved = moved + np.asarray(way) * (np.sin(2 * np.pi * (frequency * time + phase)) - np.sin(2 * np.pi * phase))
        return moved + time * np.asarray(self.velocity)


def _row(numbers: Sequence[float]) -> str:
    return " ".join(str(float(x)) for x in numbers)
