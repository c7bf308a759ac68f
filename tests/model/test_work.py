# SPDX-License-Identifier: GPL-2.0-only
"""Forecasts of modelling: what costs is counted beforehand, to a third. `bench/modelling.py forecast` compares seconds."""

import pytest
from mdanim_lammps.bodies import kind_of
from mdanim_lammps.model import shapes, work
from mdanim_lammps.model.build import build_models
from mdanim_lammps.scene.scene import Box, Cone, Cylinder, Ellipsoid, Mesh, Sphere, Torus
from model_samples import MESHES, scene, solid

CASES = [
    (Sphere(0.5), 0.05),
    (Sphere(0.5), 0.02),
    (Ellipsoid((0.6, 0.4, 0.2)), 0.04),
    (Cylinder(0.1, 5.0), 0.05),
    (Cylinder(0.5, 0.1), 0.04),
    (Cone(0.1, 5.0), 0.05),
    (Torus(1.0, 0.1), 0.05),
    (Mesh(MESHES / "knot.ply", 0.01), 0.05),
]


@pytest.mark.parametrize(("shape", "h"), CASES, ids=lambda x: type(x).__name__ if not isinstance(x, float) else str(x))
def test_counts_are_near(shape, h):
    """Vertices of the drawn surface and points of contact, which cost a needle more than its particles do."""
    (model,) = build_models(scene(solid(shape), resolution=h))
    if not isinstance(shape, Mesh):  # which is drawn by its own triangles, where these are fine enough
        assert shapes.vertices(shape, h) == pytest.approx(len(model.surface.index), rel=0.35)
    assert work._points(shape, h) == pytest.approx(len(model.frame.contact.at), rel=0.35)


def test_surfaces_count_once_for_equal_objects_and_only_where_something_touches():
    """One of 10 balls costs what one does; alone in the world it has no points of contact."""
    one, ten = scene(solid(Sphere(0.5))), scene(*(solid(Sphere(0.5), f"b{k}") for k in range(10)))
    none, crowd = (0,), (0,) * 10
    alone, together = work.seconds(one, 0.02, none), work.seconds(ten, 0.02, crowd)
    assert 0 < alone < together < 20 * alone
    more = work.seconds(ten, 0.02, (10**5,) * 10) - together
    assert more == pytest.approx(1e6 * kind_of(ten.solids[0]).particle_seconds)
    assert work.memory(one, 0.02, none) < work.memory(ten, 0.02, crowd)
    two = scene(*(solid(Sphere(0.5), f"b{k}") for k in range(2)))
    for told in (work.memory, work.seconds):
        assert told(two, 0.02, (0, 0)) == told(ten, 0.02, crowd)
    assert work.seconds(scene(solid(Box((1.0, 1.0, 1.0)))), 0.02, none) == 0.0


def test_points_of_a_mesh_cost_more_than_those_of_a_shape():
    """They are found among samples, and their distances to triangles are searched: a ball with as many takes a quarter."""
    knot, ball, floor = Mesh(MESHES / "knot.ply", 0.01), Sphere(0.5), solid(Box((1.0, 1.0, 1.0)), "floor")
    h = 0.05 * (work._points(ball, 0.05) / work._points(knot, 0.05)) ** 0.5
    assert work._points(ball, h) == pytest.approx(work._points(knot, 0.05))
    none = (0, 0)
    assert work.seconds(scene(solid(knot), floor), 0.05, none) > 4.0 * work.seconds(scene(solid(ball), floor), h, none)


def test_a_needle_is_told_by_its_surface():
    """550 000 particles took 12 s of a processor and 2.3 GB, most of these for its surface of 400 000 cells."""
    needle = scene(solid(Cone(0.01, 300.0)), solid(Box((1.0, 1.0, 1.0)), "floor"))
    assert work.seconds(needle, 0.005, (550_000, 0)) == pytest.approx(12, rel=0.5)
    assert work.memory(needle, 0.005, (550_000, 0)) == pytest.approx(2.3e9, rel=0.5)
