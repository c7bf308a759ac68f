# SPDX-License-Identifier: GPL-2.0-only
"""Surfaces of shapes as sheets: triangles about the middle of their area, closed or open."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ..records import dataclass
from ..scene.scene import Mesh
from . import mesh
from .orientation import MeshError, outward
from .solid import facing_one_way, once
from .triangles import areas, edge_keys, spread_of


@dataclass(frozen=True, slots=True, eq=False)
class ShellSurface:
    """A surface in metres, the middle of its area at the origin."""

    points: np.ndarray
    """[m], shape (V, 3)."""
    triangles: np.ndarray
    """All turned one way, outward where it is closed, int32, shape (T, 3)."""
    area: float
    """[m^2]"""
    moments: np.ndarray
    """Integral of x x' over the surface by its area [m^2], shape (3, 3)."""
    centre: np.ndarray
    """The middle of its area in the frame of the shape, or of the file at its scale [m], shape (3,)."""
    closed: bool
    """Whether it has no border."""


def of_file(shape: Mesh) -> ShellSurface:
    """The surface in the file of a mesh. Raises MeshError."""
    path, stamp = mesh.stamped(shape)
    return _of_file(path, shape.part, shape.scale, shape.mended, stamp.st_mtime_ns, stamp.st_size)


@lru_cache(maxsize=64)
def _of_file(path, part, scale: float, mended: bool, changed: int, size: int) -> ShellSurface:
    if mended:
        raise MeshError(f"mesh {path.name}: a sheet has no inside to be mended", "write mesh in place of solid")
    points, triangles, *_ = mesh.read_file(path, part)
    name = path.name
    triangles = once(triangles)
    _, uses = np.unique(edge_keys(triangles), return_counts=True)
    if (uses > 2).any():
        raise MeshError(
            f"mesh {name}: {np.count_nonzero(uses > 2)} edges belong to more than two triangles, which a sheet cannot have",
            "remove inner faces in a mesh editor, or write an object for each part",
        )
    closed = not (uses == 1).any()
    triangles = outward(points, triangles, name) if closed else facing_one_way(points, triangles)
    directed = edge_keys(triangles, directed=True)
    if len(np.unique(directed)) != len(directed):
        raise MeshError(f"mesh {name}: has one side only", "cut it open: a sheet has two sides")
    mesh.check_size(points, scale, name)
    used, number = np.unique(triangles, return_inverse=True)
    return about_middle(points[used] * scale, number.reshape(-1, 3).astype(np.int32), closed)


def about_middle(points: np.ndarray, triangles: np.ndarray, closed: bool) -> ShellSurface:
    """The surface of points [m], shape (V, 3), and triangles, shape (T, 3)."""
    area = areas(points, triangles)
    centre = area @ points[triangles].mean(axis=1) / area.sum()
    points = points - centre
    return ShellSurface(points, triangles, float(area.sum()), spread_of(points, triangles), centre, closed)
