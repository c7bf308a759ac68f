# SPDX-License-Identifier: GPL-2.0-only
"""Pale copies that what moves leaves behind in a picture."""

from __future__ import annotations

import numpy as np

from ..errors import UsageError
from ..results.trajectory import Trajectory
from ..scene.limits import MOST_COPIES, copies
from .surfaces import ShadedMesh

PALE = 0.55
"""Part of white in the colour of a copy."""
APART = 0.1
"""A copy that is nearer than this to the object itself, or to the copy before it, over its size, is left out."""


class Ghosts:
    """Copies of the objects that move, at times in equal distances, with their points in one array.

    Args:
        trajectory: what is drawn.
        mesh: the surfaces.
        color: of its vertices, uint8, shape (V, 3).
        every: time between two copies [s].

    Raises UsageError for more than MOST_COPIES copies.
    """

    def __init__(self, trajectory: Trajectory, mesh: ShadedMesh, color: np.ndarray, every: float):
        self._trajectory, self._mesh = trajectory, mesh
        times, moves = trajectory.times, ~np.asarray(trajectory.metadata.still)
        count = copies(times[-1] - times[0], every)
        if count > MOST_COPIES:
            raise UsageError(f"freeze: {count} copies of everything would cover the picture; {MOST_COPIES} are the most")
        wanted = times[0] + every * np.arange(count)
        self._frames = np.unique(np.abs(times[None] - wanted[:, None]).argmin(axis=1))
        self._own = np.flatnonzero(moves[mesh.object_of_vertex])
        self._object = mesh.object_of_vertex[self._own]
        number = np.full(len(mesh.object_of_vertex), -1)
        number[self._own] = np.arange(len(self._own))
        chosen = moves[mesh.object_of_vertex[mesh.triangle[:, 0]]] if len(mesh.triangle) else np.zeros(0, bool)
        triangle = number[mesh.triangle[chosen]]
        shifts = np.arange(len(self._frames)) * len(self._own)
        self.triangle = np.concatenate([np.zeros((0, 3), np.int64), *(triangle + shift for shift in shifts)])
        """Triangles of all copies, shape (T, 3)."""
        pale = np.round((1.0 - PALE) * color[self._own] + PALE * 255.0).astype(np.uint8)
        self.color = np.tile(pale, (len(self._frames), 1))
        """Colours of their points, shape (P, 3)."""
        vertices = mesh.vertices(trajectory.position(0))
        self._size = np.array([np.linalg.norm(np.ptp(vertices[mesh.object_of_vertex == m], axis=0)) for m in range(len(moves))])
        self._kept = self._apart()
        self._known: dict[int, tuple[np.ndarray, np.ndarray]] = {}

    def _apart(self) -> np.ndarray:
        """Which copies of which objects there are, bool, shape (G, O)."""
        centers = self._trajectory.centers[self._frames]
        kept, last = np.ones(centers.shape[:2], bool), centers[0].copy()
        for n in range(1, len(centers)):
            kept[n] = np.linalg.norm(centers[n] - last, axis=1) > APART * self._size
            last[kept[n]] = centers[n][kept[n]]
        return kept

    def show(self, index: int) -> tuple[np.ndarray, np.ndarray]:
        """Points [m] and normals of all copies in a frame, each of shape (P, 3): those of later times are in one place."""
        now = self._trajectory.centers[index]
        points, normals = np.zeros((2, len(self._frames), len(self._own), 3))
        for n, frame in enumerate(self._frames):
            if frame >= index:
                points[n] = points[n - 1, :1] if n else self._trajectory.centers[0][0]
                continue
            points[n], normals[n] = self._copy(int(frame))
            away = np.linalg.norm(self._trajectory.centers[frame] - now, axis=1) > APART * self._size
            hidden = ~(self._kept[n] & away)[self._object]
            points[n, hidden] = self._trajectory.centers[frame][self._object[hidden]]
        return points.reshape(-1, 3), normals.reshape(-1, 3)

    def _copy(self, frame: int) -> tuple[np.ndarray, np.ndarray]:
        if frame not in self._known:
            position, gone = self._trajectory.position(frame), self._trajectory.gone(frame)
            vertices = self._mesh.vertices(position, gone)
            self._known[frame] = vertices[self._own], self._mesh.normals(vertices, position, gone)[self._own]
        return self._known[frame]
