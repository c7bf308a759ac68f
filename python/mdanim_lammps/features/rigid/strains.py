# SPDX-License-Identifier: GPL-2.0-only
"""How far elastic objects have been from rigid ones in a run: strains of springs, and distances from the best rigid motion."""

from __future__ import annotations

from typing import Any

import numpy as np

FRAMES = 60
"""Frames after the first that are looked at, at most, evenly spread."""


class Strains:
    """Looks at some objects of a trajectory; M of them, with P particles and S springs in all.

    Args:
        trajectory: results.trajectory.Trajectory; strains are those of the springs that it has, against its first frame.
        chosen: numbers of these objects, ascending, int64, shape (M,).
    """

    def __init__(self, trajectory: Any, chosen: np.ndarray):
        self.trajectory, meta = trajectory, trajectory.metadata
        first = np.asarray(meta.first)
        size = np.diff(first)[chosen]
        self.begin = np.concatenate([[0], np.cumsum(size)[:-1]])
        self.number = size
        self.particles = np.concatenate([np.arange(*first[m : m + 2]) for m in chosen.tolist()])
        place = np.full(first[-1], -1)
        place[self.particles] = np.arange(len(self.particles))
        bonds = place[np.searchsorted(meta.id, np.asarray(meta.bond))]
        self.bonds = bonds[(bonds >= 0).all(axis=1)]
        self.object = np.repeat(np.arange(len(chosen)), size)
        self.start = self._from_centres(0)
        self.rest = self._lengths(self.start)

    def largest(self) -> np.ndarray:
        """Largest \\|r/r0 - 1\\| of a spring of each object in any frame [-], shape (M,)."""
        found = np.zeros(len(self.begin))
        for frame in self._frames():
            strain = np.abs(self._lengths(self._from_centres(frame)) / self.rest - 1.0)
            np.maximum.at(found, self.object[self.bonds[:, 0]], strain)
        return found

    def strays(self) -> np.ndarray:
        """Distance of the particles of each object from their places in the rigid motion that is nearest in each frame, the root
        mean square over particles and frames [m], shape (M,).

        With the covariance C = sum x0 x^T of places before and now from the centre, the sum of squares is
        sum x0^2 + sum x^2 - 2 (s1 + s2 +- s3) with the singular values of C; minus where det C < 0 (Kabsch 1976).
        """
        total, frames = np.zeros(len(self.begin)), self._frames()
        before = self._sums((self.start**2).sum(axis=1))
        for frame in frames:
            now = self._from_centres(frame)
            covariance = self._sums(self.start[:, :, None] * now[:, None, :])
            values = np.linalg.svd(covariance, compute_uv=False)
            values[:, 2] *= np.sign(np.linalg.det(covariance))
            total += np.maximum(before + self._sums((now**2).sum(axis=1)) - 2.0 * values.sum(axis=1), 0.0) / self.number
        return np.sqrt(total / len(frames))

    def _frames(self) -> list[int]:
        last = len(self.trajectory) - 1
        return sorted({max(1, round(k * last / FRAMES)) for k in range(1, FRAMES + 1)})

    def _from_centres(self, frame: int) -> np.ndarray:
        """Places from the middle of the particles of each object [m], shape (P, 3)."""
        x = np.asarray(self.trajectory.position(frame), float)[self.particles]
        return x - (self._sums(x) / self.number[:, None])[self.object]

    def _sums(self, values: np.ndarray) -> np.ndarray:
        return np.add.reduceat(values, self.begin)

    def _lengths(self, x: np.ndarray) -> np.ndarray:
        i, j = self.bonds.T
        return np.linalg.norm(x[i] - x[j], axis=1)
