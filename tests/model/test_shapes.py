# SPDX-License-Identifier: GPL-2.0-only
"""Shapes as geometry: volumes, thickness, inside or not, surfaces."""

from math import acos, pi, sqrt
from typing import get_args

import numpy as np
import pytest
from mdanim_lammps.model import shapes
from mdanim_lammps.model.distance import distance, grid_distance
from mdanim_lammps.model.spread import spread
from mdanim_lammps.scene.scene import Box, Cone, Cylinder, Ellipsoid, Mesh, PieceShape, Rope, Shape, Sheet, Shell, Sphere, Torus
from model_samples import MESHES, ROPE, SHAPES, SHEET, SHELL, assert_closed, enclosed_volume, shape_id

every_shape = pytest.mark.parametrize("shape", SHAPES, ids=shape_id)


@pytest.mark.parametrize(
    ("shape", "volume", "thickness"),
    [
        pytest.param(Box((1, 2, 3)), 6, 1, id="box"),
        pytest.param(Sphere(2), 4 / 3 * pi * 8, 4, id="sphere"),
        pytest.param(Ellipsoid((3, 2, 1)), 8 * pi, 2, id="ellipsoid"),
        pytest.param(Cylinder(2, 3), 12 * pi, 3, id="disc: its height"),
        pytest.param(Cylinder(1, 3), 3 * pi, 2, id="rod: its diameter"),
        pytest.param(Cone(3, 4), 12 * pi, 3, id="cone: 3-4-5 triangle, inscribed ball of radius 12/8"),
        pytest.param(Torus(3, 1), 6 * pi**2, 2, id="torus"),
        pytest.param(Mesh(MESHES / "cuboid.obj", 0.5), 3, 1, id="mesh: 4 x 3 x 2, half size"),
    ],
)
def test_volume_and_thickness(shape, volume, thickness):
    """Know volumes exactly, and the thickness of the thinnest part."""
    assert shapes.volume(shape) == pytest.approx(volume, rel=1e-12)
    assert shapes.thickness(shape) == pytest.approx(thickness, rel=1e-5)


@every_shape
def test_origin_is_the_centre_of_mass(shape):
    """Put the origin where the mean of a million cells inside is."""
    inside, edge = cells_inside(shape, 100)
    assert np.abs(inside.mean(axis=0)).max() < 0.1 * edge


@every_shape
def test_volume_is_that_of_the_points_inside(shape):
    """Agree on volume and inside: count cells (the error of such a count is well below 1 % here)."""
    inside, edge = cells_inside(shape, 100)
    assert len(inside) * edge**3 == pytest.approx(shapes.volume(shape), rel=0.01)


def cells_inside(shape, across):
    """Centres (N, 3) of cubic cells inside, with this many along the longest side, and their edge."""
    low, high = shapes.extent(shape)
    edge = (high - low).max() / across
    axes = [np.arange(a + edge / 2, b, edge) for a, b in zip(low, high)]
    z, y, x = np.nonzero(shapes.fill(shape, *axes))
    return np.stack([axes[0][x], axes[1][y], axes[2][z]], axis=1), edge


@every_shape
def test_surface_is_closed_and_faces_outward(shape):
    """Draw a closed surface with nearly the shape's volume and exactly its extent."""
    points, triangles = shapes.surface(shape, 0.3 * shapes.thickness(shape))
    assert_closed(triangles)
    assert len(np.unique(triangles)) == len(points)
    # 48 facets around: 1 - sin(7.5 deg)/7.5 deg = 0.3 % less in a plane, 1.2 % for a ring of 24.
    assert enclosed_volume(points, triangles) == pytest.approx(shapes.volume(shape), rel=0.015)
    low, high = shapes.extent(shape)
    found = [points.min(axis=0), points.max(axis=0)]
    np.testing.assert_allclose(found, [low, high], atol=1e-6 * (high - low).max())


@every_shape
def test_surface_lies_between_inside_and_outside(shape):
    """Step a little in and out from the middle of every facet."""
    points, triangles = shapes.surface(shape, 0.3 * shapes.thickness(shape))
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    # A chord over 1/24 of a turn of the tube lies 1 - cos(7.5 deg) = 0.9 % of a radius below it.
    step = 0.02 * shapes.thickness(shape) * normal
    middle = (a + b + c) / 3
    assert shapes.contains(shape, middle - step).mean() > 0.995
    assert shapes.contains(shape, middle + step).mean() < 0.005


@every_shape
def test_contains_fill_and_depth_agree(shape):
    """Give one answer to the same question asked in three ways."""
    low, high = shapes.extent(shape)
    axes = [np.linspace(1.1 * a, 1.1 * b, n) for a, b, n in zip(low, high, (11, 12, 13))]
    z, y, x = np.meshgrid(*axes[::-1], indexing="ij")
    points = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    inside = shapes.contains(shape, points)
    assert 0.05 < inside.mean() < 0.95
    np.testing.assert_array_equal(shapes.fill(shape, *axes).ravel(), inside)
    np.testing.assert_array_equal(shapes.depth(shape, points) > 0, inside)


@pytest.mark.parametrize(
    ("shape", "point", "depth"),
    [
        (Box((2, 4, 6)), (0.5, 0, 0), 0.5),
        (Sphere(2), (0, 1.5, 0), 0.5),
        (Ellipsoid((3, 2, 1)), (0, 0, 0.75), 0.25),
        (Cylinder(1, 4), (0, 0.5, 1.8), 0.2),
        (Cone(3, 4), (0, 0, -0.75), 0.25),
        (Cone(3, 4), (0, 0, 2), 0.6),
        (Torus(3, 1), (0, 3.5, 0), 0.5),
        (Mesh(MESHES / "cuboid.obj"), (1.5, 0, 0), 0.5),
    ],
    ids=lambda v: shape_id(v) if not isinstance(v, (tuple, float, int)) else None,
)
def test_depth_is_the_distance_to_the_surface(shape, point, depth):
    """Measure how deep a point lies; hand-made numbers (cone: 1 m below the tip, times sin of 3-4-5)."""
    assert shapes.depth(shape, np.array([point])) == pytest.approx([depth], rel=1e-6)


@pytest.mark.parametrize("shape", SHAPES, ids=shape_id)
def test_area_is_that_of_the_drawn_triangles(shape):
    """Closed forms agree with the triangles that are drawn, which are up to 1 % short of a round surface."""
    points, triangles = shapes.surface(shape, shapes.thickness(shape))
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    drawn = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    assert 0.99 * shapes.area(shape) < drawn <= shapes.area(shape) * (1 + 1e-9)


@pytest.mark.parametrize(
    ("shape", "area"),
    [
        (Sphere(1.0), 4 * pi),
        (Cylinder(1.0, 2.0), 6 * pi),
        (Torus(2.0, 0.5), 4 * pi**2),
        (Cone(3.0, 4.0), 24 * pi),
        (Ellipsoid((1.0, 1.0, 2.0)), 2 * pi * (1 + 4 / sqrt(3) * acos(0.5))),
    ],
    ids=lambda v: shape_id(v) if not isinstance(v, float) else None,
)
def test_area_is_the_true_one(shape, area):
    """Textbook areas, of a prolate ellipsoid too."""
    assert shapes.area(shape) == pytest.approx(area, rel=1e-12)


def test_cone_slant():
    """Count the base and the slanted side of a cone as its border."""
    cone = Cone(1.0, 1.0)
    points = np.array([(0, 0, -0.2), (0, 0, -0.3), (0.9, 0, -0.2), (0.9, 0, -0.1), (0.2, 0, 0.5)])
    assert shapes.contains(cone, points).tolist() == [True, False, True, False, True]
    assert shapes.thickness(cone) == pytest.approx(2 / (1 + sqrt(2)))


def test_radius():
    """Reach the corner of a cuboid, the rim of a cylinder, the outside of a ring."""
    assert shapes.radius(Box((2.0, 4.0, 4.0))) == pytest.approx(3.0)
    assert shapes.radius(Cylinder(3.0, 8.0)) == pytest.approx(5.0)
    assert shapes.radius(Torus(2.0, 0.5)) == 2.5


@every_shape
def test_no_point_is_farther_than_the_radius(shape):
    """None of the surface; one is nearly as far, or as far as the corner of the box around."""
    points, _ = shapes.surface(shape, shapes.thickness(shape) / 4)
    farthest = np.linalg.norm(points, axis=1).max()
    assert farthest <= shapes.radius(shape) * (1 + 1e-12) and shapes.radius(shape) < 1.3 * farthest


def test_every_kind_of_shape_has_all_that_is_asked_of_it(monkeypatch):
    """A kind without a formula is found when the package is imported, one without points or distances here."""
    kinds = get_args(Shape)
    distances = distance.registry.keys() | grid_distance.registry.keys()
    assert spread.registry.keys() - {object} == set(kinds) - {Box, Rope, Sheet, Shell}  # these have their particles
    assert distances - {object} == set(kinds) - {Box}
    a_mesh = {PieceShape}  # no word of the language makes one
    assert set(shapes.LAWS) - a_mesh == {type(shape) for shape in (*SHAPES, ROPE, SHEET, SHELL)} == set(kinds)
    lacking = type("lacking", (), {name: None for name in shapes.FORMULAS if name not in ("vertices", "rolls")})
    monkeypatch.setitem(shapes.LAWS, Torus, lacking)
    with pytest.raises(TypeError, match="Torus lacks vertices, rolls in LAWS"):
        shapes.check_laws()
