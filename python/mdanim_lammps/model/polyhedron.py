# SPDX-License-Identifier: GPL-2.0-only
"""Corners and faces of convex meshes, clean enough for ``fix mdanim/rigid`` (plugin/rigid/polyhedron.cpp)."""

from __future__ import annotations

import math
from collections import Counter
from functools import lru_cache
from typing import Any

import numpy as np

from ..records import dataclass
from ..scene.scene import Mesh, PieceShape
from . import mesh

MOST_CORNERS = 60
"""Corners of a mesh up to which its features are found quickly."""
MOST_ON_PLANES = 1000
"""Corners of the hull of a mesh up to which those on a plane are found quickly."""
NEAR = 1e-6
"""Distance over the size of a mesh, the diagonal of its box, below which corners are one, or a corner lies in a plane: what the
fix lets a face be uneven by, and about what six digits of coordinates are rounded by."""
ONE_PLANE = 1e-4
"""Angle below which two faces with a common edge are one [rad]; the fix refuses those below 4.5e-5."""
LEAST_AREA = 1e-9
"""Area of a face over the square of the size from which the fix knows its normal."""


@dataclass(frozen=True, slots=True, eq=False)
class Polyhedron:
    """A convex body with flat faces."""

    corner: np.ndarray
    """About the centre of mass [m], shape (N, 3)."""
    faces: tuple[tuple[int, ...], ...]
    """Corners of each face, counter-clockwise seen from outside; no two faces are in one plane."""


def polyhedron(shape: Mesh) -> Polyhedron | None:
    """The corners and faces of a mesh; None where it is not convex, has more than MOST_CORNERS, or has edges or faces too small
    for `fix mdanim/rigid`. Raises mesh.MeshError."""
    if isinstance(shape, PieceShape):
        from .cut import piece

        return piece(shape).polyhedron
    return _of_file(shape)


@lru_cache(maxsize=256)
def _of_file(shape: Mesh) -> Polyhedron | None:
    whole, body = _around_all(shape), mesh.load(shape)
    if len(whole.vertices) > 4 * MOST_CORNERS or whole.volume - body.volume > _near(body.points) * whole.area:
        return None
    found = hull(shape)
    return found if found is not None and len(found.corner) <= MOST_CORNERS else None


@lru_cache(maxsize=256)
def hull(shape: Mesh) -> Polyhedron | None:
    """The corners and faces of the hull of a mesh, all of it that a plane can touch; None where it has more than MOST_ON_PLANES
    corners, or edges or faces too small for `fix mdanim/rigid`. Raises mesh.MeshError."""
    from scipy.spatial import ConvexHull

    found, points = _around_all(shape), mesh.load(shape).points
    if len(found.vertices) > 4 * MOST_ON_PLANES:
        return None
    near = _near(points)
    kept = _apart(points[found.vertices], near)
    if len(kept) < len(found.vertices):
        if len(kept) < 4:
            return None
        found = ConvexHull(points[found.vertices[kept]])
    body = _merged(found, near)
    if body is None or len(body.corner) > MOST_ON_PLANES:
        return None
    return body if is_clean(body, near) else None


@lru_cache(maxsize=8)
def _around_all(shape: Mesh) -> Any:
    """The hull of a mesh as SciPy finds it."""
    from scipy.spatial import ConvexHull

    return ConvexHull(mesh.load(shape).points)


def _near(points: np.ndarray) -> float:
    """The distance from which on points of a mesh are two [m]."""
    return NEAR * float(np.linalg.norm(np.ptp(points, axis=0)))


def _apart(points: np.ndarray, near: float) -> list[int]:
    """Numbers of points, without those that are near one that stays."""
    kept: list[int] = []
    for k, point in enumerate(points):
        if not kept or np.linalg.norm(points[kept] - point, axis=1).min() > near:
            kept.append(k)
    return kept


def _merged(hull: Any, near: float) -> Polyhedron | None:
    """The faces of a hull, each of all its triangles that are in one plane, and the corners at which three or more of them meet;
    None where those of a face span no area."""
    from scipy.spatial import QhullError

    groups, seeds = _groups(hull, near)
    at: list[set[int]] = [set() for _ in hull.points]
    for group, triangle in zip(groups.tolist(), hull.simplices):
        for k in triangle.tolist():
            at[k].add(group)
    is_corner = np.array([len(meet) >= 3 for meet in at])
    faces = []
    for group in dict.fromkeys(groups.tolist()):
        own = np.unique(hull.simplices[groups == group])
        own = own[is_corner[own]]
        if len(own) < 3:
            return None
        normals = hull.equations[groups == group, :3]
        first = int(np.argmax(normals @ hull.equations[seeds[group], :3] > 1.0 - 0.5 * ONE_PLANE**2))
        try:
            faces.append(_around(hull.points, own, normals[first]))
        except QhullError:
            return None
    used = np.unique(np.concatenate(faces))
    number = {int(old): new for new, old in enumerate(used)}
    return Polyhedron(hull.points[used], tuple(tuple(number[int(k)] for k in face) for face in faces))


def _groups(hull: Any, near: float) -> tuple[np.ndarray, dict[int, int]]:
    """The face that each triangle of a hull belongs to, shape (T,), and the largest triangle of each face.

    A face takes the triangles that are near the plane of its largest one, and then neighbours at an angle below ONE_PLANE. The
    plane of a narrow triangle is rounding, so large ones begin.
    """
    corner = hull.points[hull.simplices]
    area = np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1)
    groups, seeds = np.full(len(area), -1), {}
    for seed in np.argsort(-area, kind="stable").tolist():
        if groups[seed] < 0:
            plane = hull.equations[seed]
            groups[(groups < 0) & (np.abs(corner @ plane[:3] + plane[3]).max(axis=1) <= near)] = seed
            groups[seed] = seed
            seeds[seed] = seed
    normal = hull.equations[:, :3].tolist()
    for k, neighbours in enumerate(hull.neighbors.tolist()):
        for n in neighbours:
            one, two = sorted((int(groups[k]), int(groups[n])), key=lambda g: -area[g])
            if one != two and _sine(normal[one], normal[two]) < ONE_PLANE:
                groups[groups == two] = one
    return groups, seeds


def _around(points: np.ndarray, corners: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """The corners of a face in order, without those on its straight edges."""
    from scipy.spatial import ConvexHull

    first = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    first /= np.linalg.norm(first)
    flat = points[corners] @ np.stack([first, np.cross(normal, first)], axis=1)
    return corners[ConvexHull(flat).vertices]  # counter-clockwise in the plane


def is_clean(body: Polyhedron, near: float) -> bool:
    """Whether the fix takes a body: each edge has two faces, at an angle; faces are flat and have an area; no corner is before
    one; three edges meet in each corner, and no two corners are near."""
    if len(_apart(body.corner, near)) < len(body.corner):
        return False
    normal: dict[tuple[int, int], list[float]] = {}
    for face in body.faces:
        corner = body.corner[list(face)]
        (x, y, z), (u, v, w) = (corner - corner[0]).T, (np.concatenate([corner[1:], corner[:1]]) - corner[0]).T
        spread = np.array([y @ w - z @ v, z @ u - x @ w, x @ v - y @ u])
        length = float(np.linalg.norm(spread))
        if length <= LEAST_AREA * (near / NEAR) ** 2:
            return False
        out = spread / length
        level = float((corner @ out).mean())
        if np.abs(corner @ out - level).max() > 0.5 * near or (body.corner @ out).max() - level > 0.5 * near:
            return False  # half, as the fix's size is from one corner to the farthest, half of the diagonal or more
        normal.update(((a, b), out.tolist()) for a, b in zip(face, (*face[1:], face[0])))
    if len(normal) != sum(map(len, body.faces)) or any((b, a) not in normal for a, b in normal):
        return False
    ways = Counter(a for a, _ in normal)
    return min(ways[k] for k in range(len(body.corner))) >= 3 and all(
        _sine(out, normal[b, a]) >= 0.5 * ONE_PLANE for (a, b), out in normal.items()
    )


def _sine(a: list[float], b: list[float]) -> float:
    """Sine of the angle between two unit vectors: NumPy's functions take longer for three numbers."""
    return math.hypot(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
