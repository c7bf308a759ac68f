# SPDX-License-Identifier: GPL-2.0-only
"""Surfaces of what may tear: patches that hang together by springs, drawn in place of the whole surface once one is gone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from .model import Model, Surface

WHOLE = -1
"""Patch of the vertices that are drawn while no spring of the object is gone."""
FACES = np.array([(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (3, 7, 6, 2), (0, 4, 7, 3), (1, 2, 6, 5)])
"""Corners of the faces of a cell, in VTK order, counter-clockwise seen from outside."""


def with_patches(model: Model) -> Surface:
    """The surface of a model and behind it that of its patches, which share no vertex: both sides of the triangles of a layer,
    the faces of the cells of a solid."""
    from .model import Surface

    surface = model.surface
    if model.frame.dimensions == 2:
        corner = np.asarray(model.frame.triangle)
        corner = np.concatenate([corner, corner[:, ::-1]])
        patch = np.tile(np.arange(len(corner) // 2), 2)
    else:
        corner = np.asarray(model.hexahedron)[:, FACES].reshape(-1, 4)
        patch = np.repeat(np.arange(len(model.hexahedron)), len(FACES))
    many, sides = corner.shape
    number = len(surface.index) + np.arange(corner.size).reshape(many, sides)
    triangle = np.concatenate([number[:, [0, k, k + 1]] for k in range(1, sides - 1)])
    index, weight = (np.zeros((corner.size, surface.index.shape[1]), array.dtype) for array in (surface.index, surface.weight))
    index[:, 0], weight[:, 0] = corner.reshape(-1), 1.0
    grey = None
    if surface.color is not None:
        mean = surface.color.mean(axis=0).round().astype(np.uint8)
        grey = np.concatenate([surface.color, np.tile(mean, (corner.size, 1))])
    return Surface(
        triangle=np.concatenate([surface.triangle, triangle]).astype(np.int32),
        index=np.concatenate([surface.index, index]),
        weight=np.concatenate([surface.weight, weight]),
        color=grey,
        patch=np.concatenate([np.full(len(surface.index), WHOLE), np.repeat(patch, sides)]).astype(np.int32),
    )


class Patches:
    """The vertices of some surfaces with patches that are not drawn in a frame, and where these are put."""

    def __init__(self, surfaces: Sequence[tuple[slice, int, Surface]]):
        """
        Args:
            surfaces: of each its particles, its first vertex, and the surface, whose ``index`` counts from the first of these.
        """
        self._parts = [(particles, first, s, _members(s)) for particles, first, s in surfaces]

    def hide(self, position: np.ndarray, gone: np.ndarray, place: np.ndarray, drawn: np.ndarray) -> None:
        """Sets which vertices are ``drawn``, bool, shape (V,), and puts all others of a surface at one ``place`` of it [m], shape
        (V, 3), for particle positions [m], shape (N, 3), and the ends of springs that are gone, shape (G, 2)."""
        for particles, first, surface, members in self._parts:
            own = gone[(gone[:, 0] >= particles.start) & (gone[:, 0] < particles.stop)] - particles.start
            patch, rows = surface.patch, slice(first, first + len(surface.index))
            whole = patch == WHOLE
            shown = whole
            if len(own):
                alive = ~members.broken(own)
                shown = ~whole & alive[np.where(whole, 0, patch)]
            drawn[rows] = shown
            at = surface.index[int(shown.argmax()), 0]
            place[rows] = position[particles.start + at]


def _members(surface: Surface) -> Members:
    patch = np.asarray(surface.patch)
    rows = np.flatnonzero(patch != WHOLE)
    return Members(surface.index[rows, 0], patch[rows])


class Members:
    """Particles of patches, or of cells."""

    def __init__(self, particle: np.ndarray, patch: np.ndarray):
        """
        Args:
            particle: some particle, shape (E,), which may stand several times.
            patch: a patch that it is of, from 0, shape (E,).
        """
        self.count = int(patch.max(initial=-1)) + 1
        pairs = np.unique(np.stack([particle, patch], axis=1).astype(np.int64), axis=0)
        self.patch = pairs[:, 1]
        particles = int(pairs[:, 0].max(initial=-1)) + 1
        self.first = np.searchsorted(pairs[:, 0], np.arange(particles + 1))

    def broken(self, gone: np.ndarray) -> np.ndarray:
        """Patches of which both ends of some spring are members, bool, shape (P,); springs by their ends, shape (G, 2)."""
        found, size = np.zeros(self.count, bool), np.diff(self.first)
        one, other = gone[(gone < len(size)).all(axis=1)].T
        for k in range(int(size.max(initial=0))):
            here = size[one] > k
            mine = self.patch[self.first[one[here]] + k]
            for j in range(int(size.max(initial=0))):
                both = size[other[here]] > j
                match = self.patch[self.first[other[here][both]] + j] == mine[both]
                found[mine[both][match]] = True
        return found
