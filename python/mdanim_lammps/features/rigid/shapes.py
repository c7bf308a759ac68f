# SPDX-License-Identifier: GPL-2.0-only
"""Shapes whose features ``fix mdanim/rigid`` knows, and how its file has them (docs/fix_mdanim_rigid.md)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ...model import mesh
from ...scene.scene import Box, Cone, Cylinder, Ellipsoid, Mesh, Shape, Solid, Sphere

ROUND = (Cylinder, Cone, Ellipsoid)
"""Known on planes alone."""
MOST_CORNERS = 60
"""Corners of a mesh up to which its features are found quickly."""
FLAT = 1e-9
"""Part of the size of a mesh, or of its volume, that is rounding."""


@dataclass(frozen=True, slots=True, eq=False)
class Polyhedron:
    """A convex body with flat faces."""

    corner: np.ndarray
    """About the centre of mass [m], shape (N, 3)."""
    faces: tuple[tuple[int, ...], ...]
    """Corners of each face, counter-clockwise seen from outside; no two faces are in one plane."""


def on_objects(shape: Shape) -> bool:
    """Whether the fix knows the features of a shape on others of that kind."""
    return isinstance(shape, Box | Sphere) or (isinstance(shape, Mesh) and polyhedron(shape) is not None)


def on_planes(shape: Shape) -> bool:
    """The same on planes."""
    return isinstance(shape, ROUND) or on_objects(shape)


@lru_cache(maxsize=256)
def polyhedron(shape: Mesh) -> Polyhedron | None:
    """The corners and faces of a mesh; None where it is not convex, or has more than MOST_CORNERS. Raises mesh.MeshError."""
    from scipy.spatial import ConvexHull

    body = mesh.load(shape)
    hull = ConvexHull(body.points)
    if len(hull.vertices) > 4 * MOST_CORNERS or hull.volume > (1.0 + FLAT) * body.volume:
        return None
    near = FLAT * float(np.ptp(body.points, axis=0).max())
    left, faces = list(range(len(hull.equations))), []
    while left:
        plane = hull.equations[left[0]]
        same = [k for k in left if np.abs(hull.points[hull.simplices[k]] @ plane[:3] + plane[3]).max() <= near]
        left = [k for k in left if k not in same]
        faces.append(_around(hull.points, np.unique(hull.simplices[same]), plane[:3]))
    used = np.unique(np.concatenate(faces))
    if len(used) > MOST_CORNERS:
        return None
    number = {int(old): new for new, old in enumerate(used)}
    return Polyhedron(hull.points[used], tuple(tuple(number[int(k)] for k in face) for face in faces))


def _around(points: np.ndarray, corners: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """The corners of a face in order, without those on its straight edges."""
    from scipy.spatial import ConvexHull

    first = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    first /= np.linalg.norm(first)
    flat = points[corners] @ np.stack([first, np.cross(normal, first)], axis=1)
    return corners[ConvexHull(flat).vertices]  # counter-clockwise in the plane


def in_file(solid: Solid) -> tuple[list[float], str]:
    """Where the origin of a shape is as the file has it [m], and its kind and sizes [m]."""
    shape, place = solid.shape, np.array(solid.position, float)
    match shape:
        case Box():
            kind, sizes = "box", shape.size
        case Sphere():
            kind, sizes = "ball", (shape.radius,)
        case Ellipsoid():
            kind, sizes = "ellipsoid", shape.radii
        case Cylinder():
            kind, sizes = "cylinder", (shape.radius, shape.height)
        case Cone():  # the centre of mass is a quarter of the height above the base, the origin in the middle
            kind, sizes = "cone", (shape.radius, shape.height)
            place = place + np.array(solid.rotation) @ (0.0, 0.0, 0.25 * shape.height)
        case Mesh() if (body := polyhedron(shape)) is not None:
            faces = " ".join(f"{len(face)} {' '.join(map(str, face))}" for face in body.faces)
            return place.tolist(), f"polyhedron {len(body.corner)} {digits(body.corner.ravel())} {len(body.faces)} {faces}"
        case _:
            raise TypeError(f"no features of {shape!r}")
    return place.tolist(), f"{kind} {digits(sizes)}"


def digits(numbers) -> str:
    """Numbers with all their bits, as text."""
    return " ".join(repr(float(number)) for number in numbers)
