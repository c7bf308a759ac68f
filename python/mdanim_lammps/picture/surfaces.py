# SPDX-License-Identifier: GPL-2.0-only
"""The surfaces of all objects as one shaded mesh; a frame is two sparse matrix products."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..results.catalogue import Catalogue

CREASE = np.radians(45.0)
"""Faces that meet at a larger angle keep a crisp edge: below the 90 degrees of a box or a cylinder's rim,
above the facets of a round shape."""


@dataclass(frozen=True)
class ShadedMesh:
    """V vertices, doubled along creases so that each has one normal; T triangles."""

    carry: object
    """Weights of stored particles in vertices, ``scipy.sparse.csr_array``, shape (V, N)."""
    triangle: np.ndarray
    """Vertex indices, counter-clockwise seen from outside, int32, shape (T, 3)."""
    gather: object
    """Ones where a triangle touches a vertex, ``scipy.sparse.csr_array``, shape (V, T)."""
    object_of_vertex: np.ndarray
    """int32, shape (V,)."""

    def vertices(self, position: np.ndarray) -> np.ndarray:
        """Vertex positions [m], shape (V, 3), for stored particle positions [m], shape (N, 3)."""
        return self.carry @ np.asarray(position, dtype=np.float64)

    def normals(self, vertices: np.ndarray) -> np.ndarray:
        """Outward unit normals, shape (V, 3): the mean over a vertex's triangles, weighted by area."""
        normal = self.gather @ _area_vectors(vertices, self.triangle)
        length = np.linalg.norm(normal, axis=1, keepdims=True)
        return np.divide(normal, length, out=np.zeros_like(normal), where=length > 0.0)


def shaded_mesh(catalogue: Catalogue, rest: np.ndarray) -> ShadedMesh:
    """Prepare the mesh; where creases run is decided once, on ``rest``, so that no edge flickers.

    Args:
        catalogue: objects and their surfaces.
        rest: stored particle positions of undeformed objects, usually frame 0 [m], shape (N, 3).
    """
    from scipy.sparse import csr_array

    skin = catalogue.skin
    corner = _split_at_creases(skin.vertices(rest), skin.triangle)
    count = int(corner.max()) + 1 if corner.size else 0
    # Any corner that became the new vertex tells which old vertex it was.
    old = np.zeros(count, dtype=np.int64)
    old[corner.ravel()] = skin.triangle.ravel()
    triangles = np.repeat(np.arange(len(corner)), 3)
    gather = csr_array((np.ones(corner.size), (corner.ravel(), triangles)), shape=(count, len(corner)))
    return ShadedMesh(skin.carry[old], corner, gather, skin.object_of_vertex[old])


def _area_vectors(vertices: np.ndarray, triangle: np.ndarray) -> np.ndarray:
    """Outward normals of triangles, twice their area long [m^2], shape (T, 3)."""
    a, b, c = (vertices[triangle[:, k]] for k in range(3))
    return np.cross(b - a, c - a)


def _split_at_creases(vertices: np.ndarray, triangle: np.ndarray) -> np.ndarray:
    """Renumber vertices so that triangles share one only where no crease parts them, int32, shape (T, 3)."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    count = len(triangle)
    normal = _area_vectors(vertices, triangle)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), np.finfo(float).tiny)
    # Directed edge k of a triangle runs from its corner k to its corner k + 1.
    tail = np.arange(3 * count)
    head = 3 * (tail // 3) + (tail + 1) % 3
    ends = np.stack([triangle.ravel()[tail], triangle.ravel()[head]], axis=1)
    order = np.lexsort((ends.max(axis=1), ends.min(axis=1)))
    here, there = order[:-1], order[1:]
    shared = (ends[here].min(axis=1) == ends[there].min(axis=1)) & (
        ends[here].max(axis=1) == ends[there].max(axis=1)
    )
    here, there = here[shared], there[shared]
    smooth = np.einsum("td,td->t", normal[here // 3], normal[there // 3]) > np.cos(CREASE)
    here, there = here[smooth], there[smooth]
    # Neighbours run along their common edge in opposite directions; if they do not, vertices are matched.
    opposite = ends[here, 0] == ends[there, 1]
    a = np.concatenate([tail[here], head[here]])
    b = np.concatenate(
        [np.where(opposite, head[there], tail[there]), np.where(opposite, tail[there], head[there])]
    )
    links = coo_array((np.ones(len(a), dtype=np.int8), (a, b)), shape=(3 * count, 3 * count))
    return connected_components(links, directed=False)[1].reshape(-1, 3).astype(np.int32)
