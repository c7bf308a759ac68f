# SPDX-License-Identifier: GPL-2.0-only
"""The drawable surface of a body, tied to its particles."""

from __future__ import annotations

from dataclasses import replace
from math import inf

import numpy as np

from ..scene.scene import Box, Mesh, PieceShape, Shape
from . import mesh, shapes
from .lattice import CORNERS, Lattice
from .model import Surface
from .nearest import Nearest, blocks

FACES = np.array([(0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7)])
"""Corners of the faces -x, +x, -y, +y, -z, +z of a VTK hexahedron, counter-clockwise seen from outside."""


def make_surface(shape: Shape, lattice: Lattice, grain: float = 0.0) -> Surface:
    """Draw a cuboid by its boundary particles, any other shape by its true surface, embedded in the cells, with facets of their
    size, or of ``grain`` [m] where that is more."""
    if isinstance(shape, Box):
        return _faces(lattice)
    bare = isinstance(shape, PieceShape) and lattice.cells.filled.size == 1
    points, triangles = shapes.surface(shape, inf if bare else max(float(lattice.cells.edge.min()), grain))
    color = mesh.colors_at(mesh.load(shape), points) if isinstance(shape, Mesh) else None
    return replace(_embedded(points, triangles, lattice), color=color)


def _faces(lattice: Lattice) -> Surface:
    """Two triangles for every face of a cell that has no filled cell behind it (Wcislo 1999, sec. 5.2)."""
    filled = lattice.cells.filled
    padded = np.pad(filled, 1)
    nz, ny, nx = filled.shape
    quads = []
    for face, (x, y, z) in zip(FACES, ((0, 1, 1), (2, 1, 1), (1, 0, 1), (1, 2, 1), (1, 1, 0), (1, 1, 2))):
        behind = padded[z : z + nz, y : y + ny, x : x + nx][filled]
        quads.append(lattice.hexahedron[~behind][:, face])
    quads = np.concatenate(quads)
    used = np.zeros(len(lattice.position), bool)
    used[quads] = True
    vertex = (np.cumsum(used) - 1).astype(np.int32)[quads]
    triangle = np.concatenate([vertex[:, [0, 1, 2]], vertex[:, [0, 2, 3]]])
    index = np.flatnonzero(used).astype(np.int32)[:, None]
    return Surface(triangle, index, np.ones((len(index), 1)))


def _embedded(points: np.ndarray, triangles: np.ndarray, lattice: Lattice) -> Surface:
    """Tie each point (V, 3) to the eight corners of the nearest filled cell, with trilinear weights.

    At rest the weighted sums are the points themselves. Points up to about a cell outside are extrapolated.
    """
    outer = np.flatnonzero((lattice.share[lattice.hexahedron] < 1).any(axis=1))
    near, t = nearest_cell(points, lattice.position[lattice.hexahedron[outer, 0]], lattice.cells.edge)
    weight = np.empty((len(t), len(CORNERS)))
    for rows in blocks(len(t)):
        (x, far_x), (y, far_y), (z, far_z) = ((1 - at, at) for at in t[rows].T)
        for c, (i, j, k) in enumerate(CORNERS.tolist()):
            weight[rows, c] = (far_x if i else x) * (far_y if j else y) * (far_z if k else z)
    return Surface(np.asarray(triangles, np.int32), lattice.hexahedron[outer[near]], weight)


def nearest_cell(points: np.ndarray, low: np.ndarray, edge: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The cell with the nearest centre to each point [m], shape (V, 3), and the place in it, in cell edges, shape (V, 3).

    ``low`` are the lower corners of the cells [m], shape (C, 3): those on the outside of the lattice do for points of the true
    surface.
    """
    _, near = Nearest(low + edge / 2)(points)
    return near, (points - low[near]) / edge
