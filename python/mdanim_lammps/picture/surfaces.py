# SPDX-License-Identifier: GPL-2.0-only
"""The surfaces of all objects as one shaded mesh; a frame is two sparse matrix products."""

from __future__ import annotations

import numpy as np

from ..records import dataclass
from ..results.trajectory_metadata import TrajectoryMetadata
from ..results.weights import Weights
from .pieces import cells

CREASE = 45.0
"""Faces that meet at a larger angle [degrees] keep a crisp edge: below the 90 degrees of a box or a cylinder's rim,
above the facets of a round shape."""

ROUNDNESS = 0.15
"""How far a round outline may be cut short, in pixels."""
NEARER = 0.5
"""How much nearer to the eye a layer is drawn, over its spacing, along lines of sight: edges of boxes under it come up to 0.35 of
that through it, between its particles."""
WORTH = 1.8
"""A mesh is made coarser if its edges may grow by this much at least; with less the triangles would only become uneven."""


@dataclass(frozen=True)
class ShadedMesh:
    """V vertices, doubled along creases so that each has one normal; T triangles."""

    carry: Weights
    """Weights of stored particles in vertices, shape (V, N)."""
    triangle: np.ndarray
    """Vertex indices, counter-clockwise seen from outside, int32, shape (T, 3)."""
    gather: Weights
    """Ones where a triangle touches a vertex, shape (V, T)."""
    object_of_vertex: np.ndarray
    """int32, shape (V,)."""
    of_skin: np.ndarray
    """Vertex of the skin that each one was, int64, shape (V,)."""
    coarse: np.ndarray
    """Vertices of objects whose triangles were made fewer, shape (C,)."""
    fine: Weights
    """Weights of stored particles in vertices of the skin, shape (S, N)."""
    tangent: tuple[Weights, ...]
    """Weights of these in two tangents at each of the coarse ones, shape (C, S) each."""
    lift: np.ndarray
    """How much nearer to the eye each vertex is drawn [m], shape (V,): those of layers."""

    def vertices(self, position: np.ndarray, gone: np.ndarray | None = None) -> np.ndarray:
        """Vertex positions [m], shape (V, 3), for stored particle positions [m], shape (N, 3), and the ends of springs that are
        gone (Trajectory.gone)."""
        return self.carry.places(position, gone)

    def seen_from(self, eye: np.ndarray, vertices: np.ndarray) -> np.ndarray:
        """Vertices [m], shape (V, 3), those of layers so much nearer to the eye [m], shape (3,)."""
        if not self.lift.any():
            return vertices
        way = eye - vertices
        far = np.maximum(np.linalg.norm(way, axis=1), np.finfo(float).tiny)
        return vertices + np.minimum(self.lift / far, 0.5)[:, None] * way

    def normals(self, vertices: np.ndarray, position: np.ndarray, gone: np.ndarray | None = None) -> np.ndarray:
        """Outward unit normals, shape (V, 3), of ``vertices`` that were carried by ``position``.

        The mean over a vertex's triangles, weighted by area; where triangles were made fewer, those of the fine surface, so that
        shading does not tell.
        """
        if len(self.coarse) < len(vertices):
            normal = self.gather @ _area_vectors(vertices, self.triangle)
        else:
            normal = np.empty_like(vertices)
        if len(self.coarse):
            fine = self.fine.places(position, gone)
            normal[self.coarse] = np.cross(*(t @ fine for t in self.tangent))
        length = np.linalg.norm(normal, axis=1, keepdims=True)
        return np.divide(normal, length, out=np.zeros_like(normal), where=length > 0.0)


def shaded_mesh(metadata: TrajectoryMetadata, rest: np.ndarray, pixel: np.ndarray | None = None) -> ShadedMesh:
    """Prepare the mesh; where creases run is decided once, on ``rest``, so that no edge flickers.

    Args:
        metadata: objects and their surfaces.
        rest: stored particle positions of undeformed objects, usually frame 0 [m], shape (N, 3).
        pixel: what a pixel covers of each object where it is seen nearest [m], shape (M,): round objects get no more triangles
            than show. None keeps all.
    """
    skin, triangle = metadata.skin, metadata.skin.triangle
    vertices = skin.vertices(rest)
    corner = _split_at_creases(vertices, triangle)
    fewer = np.zeros(0, dtype=np.int64)
    if pixel is not None and corner.size:
        # Colours of vertices stay as fine as they are.
        kept = skin.painted | skin.patched
        pixel = np.where(np.bincount(skin.object_of_vertex, kept, len(pixel)) > 0, 0.0, pixel)
        triangle, corner, fewer = _fewer(vertices, triangle, corner, skin.object_of_vertex, pixel)
    count = int(corner.max()) + 1 if corner.size else 0
    # Any corner that became the new vertex tells which old vertex it was.
    old = np.zeros(count, dtype=np.int64)
    old[corner.ravel()] = triangle.ravel()
    triangles = np.repeat(np.arange(len(corner)), 3)
    gather = Weights.of(corner.ravel(), triangles, np.ones(corner.size))
    coarse = np.flatnonzero(np.isin(skin.object_of_vertex[old], fewer))
    tangent = _tangents(vertices, skin.triangle, old[coarse])
    of = skin.object_of_vertex[old]
    lift = NEARER * _spacings_of_layers(metadata, vertices)[of]
    return ShadedMesh(skin.carry[old], corner, gather, of, old, coarse, skin.carry, tangent, lift)


def _spacings_of_layers(metadata: TrajectoryMetadata, vertices: np.ndarray) -> np.ndarray:
    """Distance of particles of each object that is drawn from both sides, so that its surface encloses nothing [m], shape (M,); 0
    of all others."""
    skin = metadata.skin
    own, count = skin.object_of_triangle, len(metadata.names)
    middle = np.stack([np.bincount(skin.object_of_vertex, vertices[:, k], count) for k in range(3)], axis=1)
    middle = middle / np.maximum(np.bincount(skin.object_of_vertex, minlength=count), 1)[:, None]
    twice = _area_vectors(vertices, skin.triangle)
    arm = vertices[skin.triangle[:, 0]] - middle[own]
    volume = np.bincount(own, np.einsum("td,td->t", arm, twice) / 6.0, count)
    area = 0.25 * np.bincount(own, np.linalg.norm(twice, axis=1), count)  # of one side
    layer = (area > 0.0) & (np.abs(volume) < 1e-9 * area**1.5)
    each = 2.0 / np.sqrt(3.0) * area / np.maximum(np.diff(metadata.first), 1)  # of two triangles with equal sides
    return np.where(layer, np.sqrt(each), 0.0)


def _tangents(vertices: np.ndarray, triangle: np.ndarray, at: np.ndarray) -> tuple[Weights, ...]:
    """Weights of vertices in two tangents at each of some of them, shape (C, V) each.

    With d the edges from a vertex, n its normal and u, w a basis across it, the tangents are sum d (d.u - a d.n) and
    sum d (d.w - b d.n), with a and b such that both are across n: as edges follow a deformation, so does their cross product
    follow the normal.
    """
    edge = np.concatenate([triangle[:, [0, 1]], triangle[:, [1, 2]], triangle[:, [2, 0]]])
    edge = np.concatenate([edge, edge[:, ::-1]]).astype(np.int64)
    row = np.full(len(vertices), -1, dtype=np.int64)
    row[at] = np.arange(len(at))
    first, last = edge[row[edge[:, 0]] >= 0].T
    # Numbers in place of rows: sorted in the same order, in a fraction of the time. With counts no masked arrays are loaded.
    tail, head = np.divmod(np.unique(first * len(vertices) + last, return_counts=True)[0], len(vertices))
    normal = np.zeros_like(vertices)
    for k in range(3):
        np.add.at(normal, triangle[:, k], _area_vectors(vertices, triangle))
    normal = normal[at] / np.maximum(np.linalg.norm(normal[at], axis=1, keepdims=True), np.finfo(float).tiny)
    u = np.cross(normal, np.eye(3)[np.abs(normal).argmin(axis=1)])
    u /= np.maximum(np.linalg.norm(u, axis=1, keepdims=True), np.finfo(float).tiny)
    d, own = vertices[head] - vertices[tail], row[tail]
    rise = np.einsum("ed,ed->e", d, normal[own])
    rises = np.maximum(np.bincount(own, rise**2, len(at)), np.finfo(float).tiny)
    made = []
    for basis in (u, np.cross(normal, u)):
        weight = np.einsum("ed,ed->e", d, basis[own])
        weight -= (np.bincount(own, weight * rise, len(at)) / rises)[own] * rise
        made.append(Weights.of(np.tile(own, 2), np.concatenate([head, tail]), np.concatenate([weight, -weight])))
    return tuple(made)


def _fewer(vertices: np.ndarray, triangle: np.ndarray, corner: np.ndarray, of: np.ndarray, pixel: np.ndarray):
    """Merge vertices of round objects that are nearer to each other than the picture can show.

    An outline of radius r that is drawn with edges e is cut short by e^2/8r, which is to be ROUNDNESS pixels.

    Args:
        vertices: [m], shape (V, 3).
        triangle: vertex indices, shape (T, 3).
        corner: the same after vertices were doubled along creases, shape (T, 3).
        of: object of each vertex, shape (V,).
        pixel: of each object [m], shape (M,).

    Returns:
        ``triangle`` and ``corner`` of what is left, and the objects that have fewer; those with creases keep all.
    """
    count, objects = len(vertices), len(pixel)
    single = np.full(count, -1, dtype=np.int64)
    single[triangle.ravel()] = corner.ravel()
    creased = np.zeros(objects, dtype=bool)
    creased[of[triangle.ravel()[single[triangle.ravel()] != corner.ravel()]]] = True
    low, high = np.full((objects, 3), np.inf), np.full((objects, 3), -np.inf)
    np.minimum.at(low, of, vertices)
    np.maximum.at(high, of, vertices)
    wanted = np.sqrt(8.0 * 0.5 * (high - low).min(axis=1) * ROUNDNESS * pixel)
    home = of[triangle[:, 0]]
    length = np.linalg.norm(vertices[triangle[:, 1]] - vertices[triangle[:, 0]], axis=1)
    present = np.bincount(home, length, objects) / np.maximum(1, np.bincount(home, minlength=objects))
    coarse = ~creased & (wanted > WORTH * present)
    if not coarse.any():
        return triangle, corner, np.flatnonzero(coarse)

    # One vertex for each cube of space that holds any: the one nearest to their mean.
    edge = np.where(coarse, wanted, 1.0)
    cell = np.floor((vertices - low[of]) / edge[of, None]).astype(np.int64)
    alone = np.flatnonzero(~coarse[of])
    cell[alone] = np.stack([alone, alone, alone], axis=1)
    _, place = np.unique(np.column_stack([of, cell]), axis=0, return_inverse=True)
    place = place.reshape(-1)
    mean = np.stack([np.bincount(place, vertices[:, d]) for d in range(3)], axis=1) / np.bincount(place)[:, None]
    order = np.lexsort((np.linalg.norm(vertices - mean[place], axis=1), place))
    chosen = order[np.searchsorted(place[order], np.arange(len(mean)))]
    merged = chosen[place[triangle]]
    left = (merged[:, 0] != merged[:, 1]) & (merged[:, 1] != merged[:, 2]) & (merged[:, 2] != merged[:, 0])
    corner = np.where(coarse[home][:, None], single[merged], corner)[left]
    return merged[left], np.unique(corner, return_inverse=True)[1].reshape(-1, 3).astype(np.int32), np.flatnonzero(coarse)


def _area_vectors(vertices: np.ndarray, triangle: np.ndarray) -> np.ndarray:
    """Outward normals of triangles, twice their area long [m^2], shape (T, 3)."""
    a, b, c = (vertices[triangle[:, k]] for k in range(3))
    return np.cross(b - a, c - a)


def _split_at_creases(vertices: np.ndarray, triangle: np.ndarray) -> np.ndarray:
    """Renumber vertices so that triangles share one only where no crease parts them, int32, shape (T, 3)."""
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkPolyData
    from vtkmodules.vtkFiltersCore import vtkPolyDataNormals

    if not len(triangle):
        return np.zeros((0, 3), dtype=np.int32)
    points, mesh, splitter = vtkPoints(), vtkPolyData(), vtkPolyDataNormals()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(vertices, dtype=np.float64), deep=1))
    mesh.SetPoints(points)
    mesh.SetPolys(cells(triangle))
    splitter.SetInputData(mesh)
    splitter.SetFeatureAngle(CREASE)
    splitter.ConsistencyOff()
    splitter.Update()
    return vtk_to_numpy(splitter.GetOutput().GetPolys().GetConnectivityArray()).reshape(-1, 3).astype(np.int32)
