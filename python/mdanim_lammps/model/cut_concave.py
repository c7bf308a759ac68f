# SPDX-License-Identifier: GPL-2.0-only
"""Shapes that are not convex, in pieces: the parts of their surface within Voronoi cells, closed where the cells end.

A part that two walls of a shape have in one cell is two pieces, so there may be more pieces than cells.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from . import mesh, vtk_surface
from .creased import is_clean
from .cut import CommonFace, Piece, common_face, voronoi
from .mesh import MeshError, Triangles
from .triangles import areas, connected, edge_keys, volume_and_centre

TRIES = 8
"""Seeds that are tried."""
ONE_PLACE = 1e-5
"""Distance over the size of the whole below which two corners are one; and twice that, from a plane in which a triangle lies."""
LEAST_AREA = 1e-12
"""Area of a triangle over the square of the size of the whole, below which it is turned over its longest edge."""
ROUNDING, MOST_TURNS = 1e-9, 20
"""Distance over the size of the whole at which corners are one by rounding; passes over triangles without an area."""
SMALL, MOST_AROUND = 1e-2, 1000
"""Size over that of the whole, and corners, of the largest end that may have been left open."""
SAME = 1e-3
"""Distance of the middles of two faces over the size of the whole, and difference of their areas over the larger one, below which
they are one."""
CRUMB = 1e-9
"""Volume over that of the whole below which a part is left out."""
WAY_OUT = "write another seed in control, or take a mesh of some hundred triangles"


def pieces_of(body: Triangles, number: int, seed: str) -> tuple[tuple[Piece, ...], tuple[CommonFace, ...]]:
    """Pieces of what is within a surface, and their faces. Where a plane between two cells leaves a surface that contact does not
    know, other cells are tried. Raises MeshError where none will do."""
    for attempt in range(TRIES):
        try:
            return _pieces(body, number, f"{seed}/{attempt}" if attempt else seed)
        except MeshError:
            if attempt == TRIES - 1:
                raise
    raise AssertionError("TRIES is above 0")


def _pieces(body: Triangles, number: int, seed: str) -> tuple[tuple[Piece, ...], tuple[CommonFace, ...]]:
    low, high = body.points.min(axis=0), body.points.max(axis=0)
    size = float(np.linalg.norm(high - low))
    around = np.concatenate([np.column_stack([np.eye(3), high + size]), np.column_stack([-np.eye(3), size - low])])
    cells = voronoi(low, high, lambda some: mesh.contains(body, some), around, number, seed)
    pieces: list[Piece] = []
    ends: dict[tuple[int, int], list[tuple[int, np.ndarray]]] = {}
    for n, (point, _, faces) in enumerate(cells):
        planes = {other: _between(point, cells[other][0]) for other in faces if other >= 0}
        points, triangles = _clipped(body, planes)
        part = connected(triangles)
        for own in (triangles[part == k] for k in range(part.max(initial=-1) + 1)):
            volume, centre = volume_and_centre(points, own)
            if abs(volume) <= CRUMB * body.volume:
                continue
            if volume < 0.0:
                raise MeshError("a hollow of it lies in one piece alone", "write more pieces")
            used, local = np.unique(own, return_inverse=True)
            thin = min(body.thickness, float(np.cbrt(volume)))
            surface = Triangles(points[used] - centre, local.reshape(-1, 3).astype(np.int32), volume, thin, centre)
            if not is_clean(surface):
                raise MeshError("a piece has triangles too small for contact", WAY_OUT)
            for other, plane in planes.items():
                flat = own[np.abs(points[own] @ plane[:3] - plane[3]).max(axis=1) <= 2.0 * ONE_PLACE * size]
                patch = connected(flat) if len(flat) else np.zeros(0, int)
                for k in range(patch.max(initial=-1) + 1):
                    ends.setdefault((n, other), []).append((len(pieces), points[flat[patch == k]]))
            pieces.append(Piece(surface, None, ()))
    return tuple(pieces), tuple(_met(ends, size))


def _between(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """The plane (n, d) in the middle between two points, with n from the first one to the other."""
    normal = (other - one) / np.linalg.norm(other - one)
    return np.append(normal, normal @ (0.5 * (one + other)))


def _clipped(body: Triangles, planes: dict[int, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Points and triangles of what is within a surface and planes, closed. Raises MeshError where it is not."""
    from vtkmodules.vtkCommonDataModel import vtkPlane, vtkPlaneCollection
    from vtkmodules.vtkFiltersGeneral import vtkClipClosedSurface

    given: Any = vtkPlaneCollection()
    for plane in planes.values():
        one = vtkPlane()
        one.SetNormal(*(-plane[:3]).tolist())
        one.SetOrigin(*(plane[3] * plane[:3]).tolist())
        given.AddItem(one)
    cutter = vtkClipClosedSurface()
    cutter.SetClippingPlanes(given)
    cutter.SetTolerance(1e-6)
    cutter.SetInputData(vtk_surface.surface(body.points, body.triangles))
    cutter.Update()
    points, triangles = vtk_surface.arrays(vtk_surface.triangulated(cutter.GetOutput()))
    size = float(np.linalg.norm(np.ptp(body.points, axis=0)))
    triangles = _merged(points, _closed(points, _merged(points, triangles, ROUNDING * size), SMALL * size), ONE_PLACE * size)
    triangles = _turned(points, triangles, LEAST_AREA * size**2)
    edge = edge_keys(triangles)
    if len(edge) != 2 * len(np.unique(edge)):
        raise MeshError("the surface of a piece does not close", WAY_OUT)
    return points, triangles


def _turned(points: np.ndarray, triangles: np.ndarray, least: float) -> np.ndarray:
    """With the longest edges of triangles that have no area the other way: a corner lies on the edge."""
    triangles = triangles.copy()
    for _ in range(MOST_TURNS):
        thin = np.flatnonzero(areas(points, triangles) <= least)
        if not len(thin):
            break
        left = {(int(t[k]), int(t[(k + 1) % 3])): n for n, t in enumerate(triangles) for k in range(3)}
        changed: set[int] = set()
        for n in thin.tolist():
            own = triangles[n]
            long = int(np.linalg.norm(points[own] - points[np.roll(own, -1)], axis=1).argmax())
            a, b, corner = (int(own[(long + k) % 3]) for k in range(3))
            other = left.get((b, a))
            if other is None or changed & {n, other}:
                continue
            (far,) = set(triangles[other].tolist()) - {a, b}
            if far == corner or (corner, far) in left or (far, corner) in left:
                continue
            triangles[n], triangles[other] = (corner, a, far), (far, b, corner)
            changed |= {n, other}
        if not changed:
            break
    return triangles


def _closed(points: np.ndarray, triangles: np.ndarray, small: float) -> np.ndarray:
    """With the smallest ends, which VTK leaves open. Raises MeshError where it is open all the same."""
    edge = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).tolist()
    there = set(map(tuple, edge))
    after = {b: a for a, b in there if (b, a) not in there}  # around each hole
    more = []
    while len(there) == len(edge) and after:
        first, place = after.popitem()
        loop = [first]
        while place in after and len(loop) < MOST_AROUND:
            loop.append(place)
            place = after.pop(place)
        if place != first or np.ptp(points[loop], axis=0).max() > small:
            break
        more += [(first, b, c) for b, c in pairwise(loop[1:])]
    if len(there) < len(edge) or after:
        raise MeshError("the surface of a piece does not close", WAY_OUT)
    return np.concatenate([triangles, np.array(more, int).reshape(-1, 3)])


def _merged(points: np.ndarray, triangles: np.ndarray, near: float) -> np.ndarray:
    """With points as one that are nearer than this, and without triangles that thus have no area."""
    from scipy.spatial import cKDTree

    number = np.arange(len(points))
    for a, b in sorted(cKDTree(points).query_pairs(near)):
        number[b] = min(number[b], number[a])
    triangles = number[triangles]
    triangles = triangles[(triangles != np.roll(triangles, 1, axis=1)).all(axis=1)]
    _, which, times = np.unique(np.sort(triangles, axis=1), axis=0, return_inverse=True, return_counts=True)
    return triangles[times[which.reshape(-1)] == 1]  # two with the same corners lie on each other


def _met(ends: dict[tuple[int, int], list[tuple[int, np.ndarray]]], size: float) -> list[CommonFace]:
    """Faces that two pieces have in common, from the flat ends of pieces towards other cells, triangles (T, 3, 3) [m]. Raises
    MeshError where an end meets none: no glue would hold it."""
    found: list[CommonFace] = []
    for (cell, other), own in sorted(ends.items(), key=lambda item: item[0]):
        if cell > other:
            continue
        for a, one in own:
            for b, two in ends.get((other, cell), []):
                (area, at), (area_b, at_b) = (_area_and_middle(corners) for corners in (one, two))
                if np.linalg.norm(at - at_b) <= SAME * size and abs(area - area_b) <= SAME * max(area, area_b):
                    found.append(common_face(a, b, -1, -1, one))
    total = sum(_area_and_middle(corners)[0] for own in ends.values() for _, corners in own)
    if 2.0 * sum(face.area for face in found) < (1.0 - SAME) * total:
        raise MeshError("the ends of two pieces are not alike", WAY_OUT)
    return found


def _area_and_middle(corners: np.ndarray) -> tuple[float, np.ndarray]:
    """Area [m^2] and middle [m] of triangles, shape (T, 3, 3)."""
    own = areas(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
    return float(own.sum()), own @ corners.mean(axis=1) / own.sum()
