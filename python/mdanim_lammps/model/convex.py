# SPDX-License-Identifier: GPL-2.0-only
"""Convex shapes: their places, the exact boxes around them, and how deep two of them are in each other."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ..records import dataclass
from ..scene.scene import Box, Cone, Cylinder, Ellipsoid, Mesh, Solid, Sphere, Torus
from . import mesh
from .polyhedron import Polyhedron, polyhedron


@dataclass(frozen=True, slots=True, eq=False)
class Placed:
    """A convex body in space: all points within ``radius`` of a polyhedron, which has one corner alone in a ball."""

    corner: np.ndarray
    """[m], shape (N, 3)."""
    normal: np.ndarray
    """Outward normals of the faces, shape (F, 3)."""
    edge: np.ndarray
    """Directions of the edges, shape (E, 3)."""
    triangle: np.ndarray
    """Corners of the triangles of the faces, shape (T, 3)."""
    radius: float
    """[m]"""

    def box(self) -> tuple[np.ndarray, np.ndarray]:
        """Low and high corner of the box around it [m]."""
        return self.corner.min(axis=0) - self.radius, self.corner.max(axis=0) + self.radius


def placed(solid: Solid) -> Placed | None:
    """The body of a solid; None where its shape is neither a cuboid, a ball nor a `polyhedron`."""
    shape, turn, place = solid.shape, np.array(solid.rotation), np.array(solid.position, float)
    if isinstance(shape, Sphere):
        none = np.zeros((0, 3))
        return Placed(place[None], none, none, none.astype(int), shape.radius)
    if isinstance(shape, Box):
        body, size = _CUBE, np.array(shape.size)
    elif isinstance(shape, Mesh) and (found := polyhedron(shape)) is not None:
        body, size = found, np.ones(3)
    else:
        return None
    corner = (body.corner * size) @ turn.T + place
    a, b, c = (corner[[face[k] for face in body.faces]] for k in range(3))
    sides = {(min(pair), max(pair)) for face in body.faces for pair in zip(face, (*face[1:], face[0]))}
    first, second = np.array(sorted(sides)).T
    fans = [(face[0], face[k], face[k + 1]) for face in body.faces for k in range(1, len(face) - 1)]
    return Placed(corner, _units(np.cross(b - a, c - b)), _units(corner[second] - corner[first]), np.array(fans), 0.0)


_CUBE = Polyhedron(
    np.array([(x, y, z) for z in (-0.5, 0.5) for y in (-0.5, 0.5) for x in (-0.5, 0.5)]),
    ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)),
)
"""A cube with the edge 1."""


def _units(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def bounds(solid: Solid) -> tuple[np.ndarray, np.ndarray] | None:
    """Exact low and high corner of the box around an ellipsoid, a cylinder, a cone, a torus or a mesh [m]; None of other shapes.

    Raises mesh.MeshError.
    """
    shape, turn, place = solid.shape, np.array(solid.rotation), np.array(solid.position, float)
    along = turn[:, 2]
    if isinstance(shape, Ellipsoid):
        half = np.linalg.norm(turn * np.array(shape.radii), axis=1)
        return place - half, place + half
    if isinstance(shape, Cylinder | Cone):
        disc = shape.radius * np.sqrt(np.maximum(0.0, 1.0 - along**2))
        base, top = (place + (sign * shape.height / 2.0 + _CENTRES[type(shape)] * shape.height) * along for sign in (-1, 1))
        tip = disc if isinstance(shape, Cylinder) else 0.0
        return np.minimum(base - disc, top - tip), np.maximum(base + disc, top + tip)
    if isinstance(shape, Torus):
        half = shape.major * np.sqrt(np.maximum(0.0, 1.0 - along**2)) + shape.minor
        return place - half, place + half
    if isinstance(shape, Mesh):
        corner = mesh.load(shape).points @ turn.T + place
        return corner.min(axis=0), corner.max(axis=0)
    return None


_CENTRES: dict[type, float] = {Cylinder: 0.0, Cone: 0.25}
"""Where the middle of the height is above the centre of mass, over the height."""


def overlap(first: Placed, second: Placed) -> Callable[[np.ndarray], float]:
    """Depth of the second body in the first one when it is moved by a vector [m]: the length of the shortest move that frees it,
    0 where they are apart. By separating axes, or by the nearest point of a polyhedron to the centre of a ball."""
    if len(first.corner) == 1 or len(second.corner) == 1:
        ball, other, sign = (first, second, -1.0) if len(first.corner) == 1 else (second, first, 1.0)
        around = ball.radius + other.radius
        return lambda moved: max(0.0, around + _inside(other, ball.corner[0] + sign * moved))
    crossed = np.cross(first.edge[:, None], second.edge[None]).reshape(-1, 3)
    length = np.linalg.norm(crossed, axis=1)
    crossed = crossed[length > _PARALLEL] / length[length > _PARALLEL, None]
    axes = np.concatenate([first.normal, second.normal, crossed, -crossed])  # separating axes: no others are needed
    axes = np.concatenate([axes, -axes[: len(first.normal) + len(second.normal)]])
    apart = (first.corner @ axes.T).max(axis=0) - (second.corner @ axes.T).min(axis=0)
    return lambda moved: max(0.0, float((apart - axes @ moved).min()))


def support(solid: Solid) -> Callable[[np.ndarray], np.ndarray] | None:
    """The farthest point of a convex solid along a direction of length 1 [m]; None of tori and meshes with creases."""
    shape, turn, place = solid.shape, np.array(solid.rotation), np.array(solid.position, float)
    if (body := placed(solid)) is not None:
        return lambda n: body.corner[(body.corner @ n).argmax()] + body.radius * n
    if isinstance(shape, Ellipsoid):
        half = turn * np.array(shape.radii)
        return lambda n: place + half @ (n @ half) / np.linalg.norm(n @ half)
    if not isinstance(shape, Cylinder | Cone):
        return None
    along, middle = turn[:, 2], place + _CENTRES[type(shape)] * shape.height * turn[:, 2]
    top, base = middle + 0.5 * shape.height * along, middle - 0.5 * shape.height * along

    def farthest(n: np.ndarray) -> np.ndarray:
        across = n - (n @ along) * along
        size = float(np.linalg.norm(across))
        rim = shape.radius / size * across if size > _LEVEL else 0.0 * across
        ends = np.array([base + rim, top if isinstance(shape, Cone) else top + rim])
        return ends[(ends @ n).argmax()]

    return farthest


def depth_by_supports(first: Callable[[np.ndarray], np.ndarray], second: Callable[[np.ndarray], np.ndarray]) -> float:
    """How deep two convex bodies are in each other [m], by their `support`: the shortest move that frees one, 0 where they are
    apart.

    That is the least height of a tangent plane of A - B over the origin. A polytope inside of A - B grows where its faces are
    lowest (G. van den Bergen, "Proximity queries and penetration depth computation on 3D game objects", 2001).
    """
    from scipy.spatial import ConvexHull  # takes half a second

    def farthest(n: np.ndarray) -> np.ndarray:
        return first(n) - second(-n)

    ways = _units(np.array([(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if x or y or z], float))
    points = np.array([farthest(n) for n in ways])
    least = float((points * ways).sum(axis=1).min())
    enough = _ENOUGH * float(np.ptp(points, axis=0).max())
    for _ in range(_MOST_FACES):
        faces = ConvexHull(points).equations
        lowest = faces[faces[:, 3].argmax()]
        point = farthest(lowest[:3])
        least = min(least, float(lowest[:3] @ point))
        if least <= 0.0 or least + lowest[3] < enough:
            break
        points = np.concatenate([points, point[None]])
    return max(0.0, least)


_ENOUGH, _MOST_FACES = 1e-6, 1000
"""Error of a depth over the size of both bodies that ends the search, and steps that it may take."""
_LEVEL = 1e-12
"""Sine of the angle to the axis below which a direction has no side."""

_PARALLEL = 1e-6
"""Sine of the angle between two edges below which their cross product is rounding."""


def _inside(body: Placed, point: np.ndarray) -> float:
    """Depth of a point in the polyhedron of a body, or less its distance outside [m]."""
    if not len(body.normal):
        return -float(np.linalg.norm(point - body.corner[0]))
    first = body.corner[body.triangle]
    normal = _units(np.cross(first[:, 1] - first[:, 0], first[:, 2] - first[:, 1]))
    depth = ((first[:, 0] - point) * normal).sum(axis=1)
    if depth.min() >= 0.0:
        return float(depth.min())
    return -math.sqrt(min(_to_triangles(first, normal, depth, point), _to_edges(first, point)))


def _to_triangles(triangle: np.ndarray, normal: np.ndarray, depth: np.ndarray, point: np.ndarray) -> float:
    """Smallest squared distance to the triangles over or under which a point is [m^2]; infinite where there are none."""
    side = np.roll(triangle, -1, axis=1) - triangle
    over = (np.cross(side, point - triangle) * normal[:, None]).sum(axis=-1) >= 0.0
    return float(np.min(depth[over.all(axis=1)] ** 2, initial=math.inf))


def _to_edges(triangle: np.ndarray, point: np.ndarray) -> float:
    """Smallest squared distance of a point to the sides of triangles [m^2]."""
    start = triangle.reshape(-1, 3)
    side = np.roll(triangle, -1, axis=1).reshape(-1, 3) - start
    part = np.clip(((point - start) * side).sum(axis=1) / (side**2).sum(axis=1), 0.0, 1.0)
    return float(np.square(point - start - part[:, None] * side).sum(axis=1).min())
