# SPDX-License-Identifier: GPL-2.0-only
"""Closed surfaces of triangles with creases and holes, clean enough for ``fix mdanim/rigid`` (plugin/rigid/triangle_mesh.cpp)."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ..scene.scene import Mesh, PieceShape
from . import mesh
from .polyhedron import hull
from .triangles import areas, edge_keys

MOST_TRIANGLES = 1_000_000
"""Triangles of a mesh up to which its features are found."""
MOST_CORNERS = 1000
"""Corners of a mesh that moves, the same: each of them is looked at where it meets a plane."""
LEAST_AREA = 2e-14
"""Area of a triangle over the square of the size, the diagonal of its box, from which the fix knows its normal."""


@lru_cache(maxsize=256)
def is_known(shape: Mesh) -> bool:
    """Whether the fix takes the triangles of a mesh: each has an area, and each edge has two of them. Raises mesh.MeshError."""
    return is_clean(mesh.load(shape))


def is_clean(body: mesh.Triangles) -> bool:
    """The same of a surface."""
    if len(body.triangles) > MOST_TRIANGLES:
        return False
    size = float(np.linalg.norm(np.ptp(body.points, axis=0)))
    if areas(body.points, body.triangles).min() <= LEAST_AREA * size**2:
        return False
    edge, back = (np.sort(edge_keys(triangles, directed=True)) for triangles in (body.triangles, body.triangles[:, ::-1]))
    return bool((np.diff(edge) > 0).all()) and np.array_equal(edge, back)


@lru_cache(maxsize=256)
def may_move(shape: Mesh) -> bool:
    """The same of a mesh that moves, whose corners also meet planes. Raises mesh.MeshError."""
    few = len(mesh.load(shape).points) <= MOST_CORNERS
    return few and is_known(shape) and (isinstance(shape, PieceShape) or hull(shape) is not None)
