# SPDX-License-Identifier: GPL-2.0-only
"""Small solids and scenes for the tests of modelling."""

import numpy as np
from mdanim_lammps.errors import Span
from mdanim_lammps.model.build import build_models
from mdanim_lammps.scene.scene import (
    Box,
    Cone,
    Control,
    Cylinder,
    Ellipsoid,
    Mesh,
    Rope,
    SceneRecord,
    Sheet,
    Shell,
    Solid,
    Sphere,
    Torus,
    Young,
)
from paths import MESHES

UPRIGHT = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
SHAPES = [
    Box((1.0, 0.6, 0.4)),
    Sphere(0.5),
    Ellipsoid((0.6, 0.4, 0.3)),
    Cylinder(0.4, 1.0),
    Cone(0.5, 1.2),
    Torus(1.0, 0.3),
    Mesh(MESHES / "knot.ply", 0.01),
]
"""One of each that a lattice fills."""
ROPE = Rope((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), 0.1, 1.0)
"""A line."""
SHEET = Sheet((1.0, 0.8), 0.01)
"""A layer."""
SHELL = Shell(Sphere(0.5), 0.01)
"""A closed one."""


def shape_id(shape) -> str:
    """Name of a shape for test ids."""
    return type(shape).__name__.lower()


def solid(shape, name="body", **rest) -> Solid:
    """A solid with a place for every keyword."""
    words = ("object", "shape", "position", "hold")
    spans = {word: Span("test.txt", line, 3) for line, word in enumerate(words, 1)}
    given = dict(position=(0.0, 0.0, 0.0), rotation=UPRIGHT, elasticity=Young(1.0), mass=1.0, spans=spans)
    return Solid(name=name, shape=shape, **{**given, **rest})


def scene(*solids, ground=None, walls=None, liquid=None, **control) -> SceneRecord:
    """A scene of these solids."""
    spans = {"resolution": Span("test.txt", 9, 3)}
    return SceneRecord(
        name="test", control=Control(time=1.0, spans=spans, **control), solids=solids, ground=ground, walls=walls, liquid=liquid
    )


def model(shape, h, **rest):
    """The model of one solid at spacing h."""
    return build_models(scene(solid(shape, **rest), resolution=h))[0]


def rotation(rx, ry, rz) -> tuple:
    """Rotation about x, then y, then z [rad]."""
    (sx, sy, sz), (cx, cy, cz) = np.sin((rx, ry, rz)), np.cos((rx, ry, rz))
    about_x = np.array([(1, 0, 0), (0, cx, -sx), (0, sx, cx)])
    about_y = np.array([(cy, 0, sy), (0, 1, 0), (-sy, 0, cy)])
    about_z = np.array([(cz, -sz, 0), (sz, cz, 0), (0, 0, 1)])
    return tuple(map(tuple, (about_z @ about_y @ about_x).tolist()))


def assert_closed(triangles) -> None:
    """Every edge belongs to two triangles, which run along it in opposite directions."""
    edges = np.asarray(triangles)[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    _, uses = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)
    assert (uses == 2).all()
    assert len(np.unique(edges, axis=0)) == len(edges)


def enclosed_volume(points, triangles) -> float:
    """Volume inside a closed surface, positive where it faces outward."""
    a, b, c = np.moveaxis(np.asarray(points)[triangles], 1, 0)
    return float(np.einsum("td,td->", a, np.cross(b, c)) / 6)
