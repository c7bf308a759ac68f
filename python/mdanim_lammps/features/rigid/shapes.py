# SPDX-License-Identifier: GPL-2.0-only
"""Shapes whose features ``fix mdanim/rigid`` knows, and how its file has them (docs/fix_mdanim_rigid.md)."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from ...bodies import all_held, driven
from ...model import creased, mesh
from ...model.cover import hidden_sides
from ...model.polyhedron import hull, polyhedron
from ...scene.formatting import in_full
from ...scene.once import once_for
from ...scene.scene import Box, Cone, Cylinder, Ellipsoid, Mesh, SceneRecord, Shape, Solid, Sphere, Torus
from .words import Rigid

KNOWN = (Box, Sphere, Ellipsoid, Cylinder, Cone, Torus)
"""Shapes with features; meshes have them where they are clean."""


def on_objects(shape: Shape, moves: bool = True) -> bool:
    """Whether the fix knows the features of a shape on others of that kind."""
    return isinstance(shape, KNOWN) or (
        isinstance(shape, Mesh)
        and (polyhedron(shape) is not None or (creased.may_move(shape) if moves else creased.is_known(shape)))
    )


def is_known(solid: Solid) -> bool:
    """Whether the fix knows the features of an object."""
    return on_objects(solid.shape, not all_held(solid))


def on_planes(shape: Shape) -> bool:
    """The same of what moves on planes, which touch of a mesh what its hull touches."""
    return on_objects(shape) or (isinstance(shape, Mesh) and hull(shape) is not None)


def only_balls_move(solids: Sequence[Solid]) -> bool:
    """Whether balls are all that moves and touches objects by features. They meet each surface at one point, whose force turns
    steadily from a side to an edge, so edges in a seam of held cuboids hardly stop them."""
    return all(isinstance(s.shape, Sphere) or all_held(s) or not is_rigid(s) or not is_known(s) for s in solids)


@once_for(lambda scene: scene)
def hidden(scene: SceneRecord) -> dict[str, tuple[int, ...]] | None:
    """Sides of held cuboids that others hide, by the names of objects; None where features would catch at a seam: a side is
    hidden in part, or what is beside another one may move."""
    held = {m: solid for m, solid in enumerate(scene.solids) if all_held(solid) and isinstance(solid.shape, Box)}
    found = hidden_sides(list(held.values()))
    if found is None or (any(found) and not held.keys().isdisjoint(driven(scene))):
        return None
    return {solid.name: sides for solid, sides in zip(held.values(), found) if sides}


def is_rigid(solid: Solid) -> bool:
    """Whether an object has ``elasticity rigid``."""
    return isinstance(solid.elasticity, Rigid)


SIDES = ("-x", "+x", "-y", "+y", "-z", "+z")


def in_file(solid: Solid, hides: Sequence[int] = ()) -> tuple[list[float], str]:
    """Where the origin of a shape is as the file has it [m], and its kind and sizes [m]; ``hides``: sides of a cuboid that others
    hide."""
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
        case Torus():
            kind, sizes = "torus", (shape.major, shape.minor)
        case Mesh() if polyhedron(shape) is None and is_known(solid):
            return place.tolist(), _mesh_words(mesh.load(shape))
        case Mesh() if (body := polyhedron(shape) or hull(shape)) is not None:
            faces = " ".join(f"{len(face)} {' '.join(map(str, face))}" for face in body.faces)
            return place.tolist(), f"polyhedron {len(body.corner)} {in_full(body.corner.ravel())} {len(body.faces)} {faces}"
        case _:
            raise TypeError(f"no features of {shape!r}")
    covered = f" covered {' '.join(SIDES[side] for side in hides)}" if hides else ""
    return place.tolist(), f"{kind} {in_full(sizes)}{covered}"


@lru_cache(maxsize=8)
def _mesh_words(of: mesh.Triangles) -> str:
    """The kind and the sizes [m] of a mesh, which are asked for where objects start, and again for the file."""
    points, corners = in_full(of.points.ravel()), " ".join(map(str, of.triangles.ravel().tolist()))
    return f"mesh {of.thickness!r} {len(of.points)} {points} {len(of.triangles)} {corners}"
