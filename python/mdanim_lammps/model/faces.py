# SPDX-License-Identifier: GPL-2.0-only
"""Flat faces inside of which a convex rigid body is for certain, in the one cell around it."""

from __future__ import annotations

import numpy as np

from ..scene.scene import Box, Mesh, Shape, Torus
from .contact_body import BodyFrame
from .polyhedron import polyhedron
from .shapes import thickness
from .spread import spread
from .system import System

ACROSS = 12
"""Points on a round surface across its thinnest part: sides of their hull are 0.8 % of the radius of a ball below its surface at
most, and what is deeper in it than that is found."""


def faces_of_solids(system: System, first_cell: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rows of faces that each solid has, begin and end, int64, shape (M, 2), and the faces, shape (F, 4), as `faces_in_cell` has
    them. Solids of one shape have the same rows; cuboids, which fill their cell, concave bodies and solids of other than one cell
    have none.

    ``first_cell`` is the first cell of each solid, and C at the end, shape (M + 1,).
    """
    rows, found, count = np.zeros((len(system.names), 2), np.int64), [np.zeros((0, 4))], 0
    known: dict[int, tuple[int, int]] = {}
    for m in np.flatnonzero(system.rigid & (np.diff(first_cell) == 1)).tolist():
        kind = int(system.contact_kind[m])
        if not _has_faces(system.frames[kind].shape):
            continue
        if kind not in known:
            found.append(faces_in_cell(system.frames[kind]))
            known[kind] = count, count + len(found[-1])
            count += len(found[-1])
        rows[m] = known[kind]
    return rows, np.concatenate(found)


def _has_faces(shape: Shape) -> bool:
    """Whether a shape is convex, and does not fill its cell."""
    return polyhedron(shape) is not None if isinstance(shape, Mesh) else not isinstance(shape, Box | Torus)


def faces_in_cell(frame: BodyFrame) -> np.ndarray:
    """Faces of the hull of a convex body whose particles are the corners of a box: outward normals n and levels c, shape (F, 4).
    Inside, n s <= c; s runs from -1/2 to 1/2 along each edge of the box. Raises mesh.MeshError."""
    from scipy.spatial import ConvexHull

    shape, cells = frame.shape, frame.cells
    points = polyhedron(shape).corner if isinstance(shape, Mesh) else spread(shape, thickness(shape) / ACROSS).point
    at = (points - cells.low) / cells.edge
    low, high = (np.zeros(3), cells.count) if frame.corners is None else (frame.corners.min(axis=0), frame.corners.max(axis=0))
    found = ConvexHull((at - low) / (high - low) - 0.5).equations
    return np.concatenate([found[:, :3], -found[:, 3:]], axis=1)
