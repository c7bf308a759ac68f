# SPDX-License-Identifier: GPL-2.0-only
"""The solid that a surface with faults means: one with gaps, doubled triangles, parts that cross, or faces turned inside out."""

from __future__ import annotations

import numpy as np

from .orientation import FLAT, MeshError, outward, parts_outward
from .triangles import edges, surface_of
from .winding import enclosing

KEPT = 0.1
"""Part of the triangles of a surface made anew that is kept: cells lie on flat faces by hundreds. The volume changes by 1e-3."""


def solid(points: np.ndarray, triangles: np.ndarray, name: str) -> tuple[np.ndarray, np.ndarray, str]:
    """Points (V, 3) and triangles (T, 3) around all that the given ones enclose, and what was done to them, "" if nothing was.

    The surface stays where it encloses a solid as it is or with its gaps filled; else it is made anew.
    Raises MeshError where it encloses nothing.
    """
    try:
        return points, outward(points, triangles, name), ""
    except MeshError:
        triangles = facing_one_way(points, once(triangles))
    gaps = _gaps(triangles)
    told = f"{gaps} {'gaps are' if gaps > 1 else 'gap is'} closed" if gaps else "what is doubled or crosses is united"
    try:
        filled, around = _filled(points, triangles)
        return filled, outward(filled, around, name), told
    except MeshError:
        points, around = enclosing(points, parts_outward(points, triangles))
    if not len(around):
        raise MeshError(f"mesh {name}: encloses no volume", FLAT)
    told += ", its surface is made anew"
    try:
        fewer = _fewer(points, around)
        return fewer[0], outward(*fewer, name), told
    except MeshError:  # all of them may do
        pass
    try:
        return points, outward(points, around, name), told
    except MeshError as error:
        cause = str(error).removeprefix(f"mesh {name}: ")
        raise MeshError(f"mesh {name}: encloses no solid, not even with its surface made anew: {cause}", FLAT) from error


def once(triangles: np.ndarray) -> np.ndarray:
    """The first of all triangles with the same corners."""
    first = np.unique(np.sort(triangles, axis=1), axis=0, return_index=True)[1]
    return triangles[np.sort(first)]


def facing_one_way(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """The triangles of each part turned as its first one."""
    import pyvista

    surface = pyvista.PolyData.from_regular_faces(points, triangles)
    return surface_of(
        surface.compute_normals(
            consistent_normals=True, auto_orient_normals=False, split_vertices=False, non_manifold_traversal=False
        )
    )[1]


def _filled(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The surface with triangles in its gaps, none of which is too wide."""
    import pyvista

    surface = pyvista.PolyData.from_regular_faces(points, triangles)
    return surface_of(surface.fill_holes(np.finfo(np.float32).max).triangulate().clean(tolerance=1e-7, absolute=False))


def _fewer(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The surface with fewer triangles, by quadrics; now and then it is not closed any more."""
    import pyvista

    return surface_of(pyvista.PolyData.from_regular_faces(points, triangles).decimate(1.0 - KEPT))


def _gaps(triangles: np.ndarray) -> int:
    """How many there are: edges of one triangle only that hang together are the rim of one."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    edge, uses = np.unique(np.sort(edges(triangles), axis=1), axis=0, return_counts=True)
    rim = edge[uses == 1]
    if not len(rim):
        return 0
    ends, of = np.unique(rim, return_inverse=True)
    joined = coo_array((np.ones(len(rim), bool), of.reshape(-1, 2).T), shape=(len(ends),) * 2)
    return connected_components(joined, directed=False)[0]
