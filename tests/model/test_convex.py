# SPDX-License-Identifier: GPL-2.0-only
"""Convex shapes in each other: depths in closed form, and moves that free; boxes around round shapes."""

import numpy as np
import pytest
from mdanim_lammps.model import shapes
from mdanim_lammps.model.convex import bounds, depth_by_supports, overlap, placed, support
from mdanim_lammps.scene.scene import Box, Cone, Cylinder, Ellipsoid, Mesh, Sphere, Torus
from model_samples import MESHES, rotation, shape_id, solid

CUBE, BALL = Box((0.2, 0.2, 0.2)), Sphere(0.1)
ON_EDGE, ON_CORNER = rotation(np.pi / 4, 0, 0), rotation(np.pi / 4, np.arctan(np.sqrt(0.5)), 0)
STILL = np.zeros(3)


def depth(first, second, place, turn=None):
    """Depth of the second shape in the first one."""
    turned = {} if turn is None else {"rotation": turn}
    return overlap(placed(solid(first)), placed(solid(second, position=place, **turned)))(STILL)


@pytest.mark.parametrize(
    ("first", "second", "place", "turn", "deep"),
    [
        pytest.param(CUBE, CUBE, (0.02, 0, 0.19), None, 0.01, id="face on face"),
        pytest.param(CUBE, CUBE, (0.02, 0, 0.13), None, 0.07, id="deep"),
        pytest.param(CUBE, CUBE, (0, 0, 0), None, 0.2, id="the same place"),
        pytest.param(CUBE, CUBE, (0, 0, 0.2), None, 0.0, id="touching"),
        pytest.param(CUBE, CUBE, (0.01, 0, 0.1 + 0.1 * np.sqrt(2) - 0.004), ON_EDGE, 0.004, id="edge on face"),
        pytest.param(CUBE, CUBE, (0.01, 0.02, 0.1 + 0.1 * np.sqrt(3) - 0.003), ON_CORNER, 0.003, id="corner on face"),
        pytest.param(Box((3, 0.3, 0.3)), Box((0.3, 0.3, 3)), (0.02, 0.03, 0.01), None, 0.27, id="bars that cross"),
        pytest.param(BALL, BALL, (0.12, 0, 0.15), None, 0.2 - np.hypot(0.12, 0.15), id="two balls"),
        pytest.param(CUBE, BALL, (0.03, 0, 0.19), None, 0.01, id="ball on a face"),
        pytest.param(CUBE, BALL, (0.16, 0, 0.16), None, 0.1 - 0.06 * np.sqrt(2), id="ball on an edge"),
        pytest.param(CUBE, BALL, (0.15, 0.15, 0.15), None, 0.1 - 0.05 * np.sqrt(3), id="ball on a corner"),
        pytest.param(CUBE, BALL, (0.16, 0.16, 0.16), None, 0.0, id="ball off a corner"),
        pytest.param(CUBE, BALL, (0.0, 0.0, 0.04), None, 0.16, id="centre of the ball inside"),
    ],
)
def test_depths_in_closed_form(first, second, place, turn, deep):
    """Tell the length of the shortest move that frees, whichever body comes first."""
    assert depth(first, second, place, turn) == pytest.approx(deep, abs=1e-12)
    turned = {} if turn is None else {"rotation": turn}
    back = overlap(placed(solid(second, position=place, **turned)), placed(solid(first)))
    assert back(STILL) == pytest.approx(deep, abs=1e-12)


def test_two_edges_that_cross():
    """Two cubes on their edges, one across the other: the separating axis is the cross product of the edges."""
    below = placed(solid(CUBE, rotation=rotation(np.pi / 4, 0, 0)))
    above = placed(solid(CUBE, position=(0, 0, 0.2 * np.sqrt(2) - 0.005), rotation=rotation(0, np.pi / 4, 0)))
    assert overlap(below, above)(STILL) == pytest.approx(0.005, abs=1e-12)


def test_it_agrees_with_points_inside():
    """Random turned bodies: where a fine cloud of points of one is inside the other there is a depth, no less than theirs; where
    there is a depth, a move by it along some axis frees."""
    rng = np.random.default_rng(4)
    cuboid = Mesh(MESHES / "cuboid.obj", 0.2)
    for shape in (CUBE, BALL, cuboid, Box((0.5, 0.1, 0.05))) * 10:
        host = solid(Box((0.3, 0.2, 0.1)), rotation=rotation(*rng.uniform(-3, 3, 3)))
        guest = solid(shape, position=tuple(rng.uniform(-0.25, 0.25, 3)), rotation=rotation(*rng.uniform(-3, 3, 3)))
        found = overlap(placed(host), placed(guest))(STILL)
        cloud = shapes.surface(shape, 0.02)[0] @ np.array(guest.rotation).T + guest.position
        inside = cloud @ np.array(host.rotation)
        within = shapes.contains(host.shape, inside)
        deepest = float(shapes.depth(host.shape, inside[within]).max()) if within.any() else 0.0
        assert found >= deepest - 1e-9
        way = np.array(guest.position) / np.linalg.norm(guest.position)
        assert overlap(placed(host), placed(guest))(2.0 * way) == 0.0


@pytest.mark.parametrize("shape", [Ellipsoid((0.3, 0.2, 0.05)), Cylinder(0.1, 0.3), Cone(0.2, 0.3)], ids=shape_id)
def test_boxes_around_round_shapes(shape):
    """Contain the drawn surface, within the error of its facets."""
    body = solid(shape, position=(0.1, 0.2, 0.3), rotation=rotation(0.5, -1.1, 2.0))
    points = shapes.surface(shape, 0.004)[0] @ np.array(body.rotation).T + body.position
    low, high = bounds(body)
    assert low == pytest.approx(points.min(axis=0), abs=1e-3) and high == pytest.approx(points.max(axis=0), abs=1e-3)
    assert (low <= points.min(axis=0) + 1e-12).all() and (high >= points.max(axis=0) - 1e-12).all()


LYING = rotation(np.pi / 2, 0, 0)
ROD, TIP = Cylinder(0.1, 0.6), Cone(0.1, 0.4)


@pytest.mark.parametrize(
    ("first", "second", "place", "turn", "deep"),
    [
        pytest.param(ROD, ROD, (0.19, 0.02, 0.03), LYING, 0.01, id="rods that cross"),
        pytest.param(ROD, ROD, (0.01, 0.02, 0.59), None, 0.01, id="ends"),
        pytest.param(ROD, CUBE, (0.19, 0.01, 0.05), None, 0.01, id="a side on a face"),
        pytest.param(CUBE, TIP, (0.02, 0.01, -0.39), None, 0.01, id="a tip in a face"),
        pytest.param(Ellipsoid((0.3, 0.2, 0.1)), Ellipsoid((0.1, 0.2, 0.3)), (0, 0, 0.395), None, 0.005, id="eggs"),
        pytest.param(ROD, BALL, (0.0, 0.0, 0.38), None, 0.02, id="a ball on an end"),
        pytest.param(ROD, BALL, (0.2, 0.1, 0.1), None, 0.0, id="apart"),
        pytest.param(CUBE, ROD, (0.0, 0.0, 0.4), None, 0.0, id="touching"),
    ],
)
def test_depths_of_round_shapes(first, second, place, turn, deep):
    """By their farthest points alone; both ways around."""
    turned = {} if turn is None else {"rotation": turn}
    one, other = support(solid(first)), support(solid(second, position=place, **turned))
    assert depth_by_supports(one, other) == pytest.approx(deep, abs=1e-6)
    assert depth_by_supports(other, one) == pytest.approx(deep, abs=1e-6)


def test_rings_are_not_convex():
    """So they have no farthest points that tell all."""
    assert support(solid(Torus(0.2, 0.05))) is None
