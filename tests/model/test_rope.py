# SPDX-License-Identifier: GPL-2.0-only
"""Ropes as shapes, and the tubes that are drawn around their particles."""

import math

import numpy as np
import pytest
from mdanim_lammps.model import shapes
from mdanim_lammps.model.build import build_models
from mdanim_lammps.model.inertia import tensor
from mdanim_lammps.model.tube import Tubes, frames, make_tube
from mdanim_lammps.picture.surfaces import shaded_mesh
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.results.trajectory_metadata import metadata_of
from mdanim_lammps.scene.curve import hanging
from mdanim_lammps.scene.parse import parse_scene
from mdanim_lammps.scene.rollers import Roller, taut
from mdanim_lammps.scene.scene import Rope
from model_samples import assert_closed, enclosed_volume
from scipy.integrate import quad

STRAIGHT = Rope((0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 0.1, 2.0)
SLACK = Rope((0.0, 0.0, 1.0), (1.0, 0.5, 1.3), 0.05, 1.6)
TWO = """
object line { shape rope from (0, 0, 1) m to (1, 0.5, 1.3) m thickness 5 cm length 1.6 m  density 1000  elasticity 1 MPa }
object box { shape box (20, 20, 20) cm  position (3, 0, 0.1) m  density 500  elasticity 1 MPa }
object chain { shape chain from (0, 0, 2) m to (1, 0, 2) m thickness 4 cm  density 1000  elasticity 1 MPa }
control { time 0.1 s }
"""


def test_formulas_of_a_straight_rope_are_those_of_a_thin_cylinder():
    """Moments by tensor(), depth by the distance from its axis."""
    assert shapes.volume(STRAIGHT) == pytest.approx(math.pi * 0.05**2 * 2)
    found = tensor(STRAIGHT, 3.0, np.eye(3))
    np.testing.assert_allclose(np.diag(found)[1:], 3.0 * (2.0**2 / 12 + 0.05**2 / 4), rtol=0.01)
    points = np.array([[0.0, 0.0, 0.0], [0.3, 0.03, 0.0], [0.3, 0.0, 0.2], [1.5, 0.0, 0.0]])
    np.testing.assert_allclose(shapes.depth(STRAIGHT, points), [0.05, 0.02, -0.15, -0.45], atol=1e-12)
    low, high = shapes.extent(STRAIGHT)
    assert low == pytest.approx((-1.05, -0.05, -0.05)) and high == pytest.approx((1.05, 0.05, 0.05))


def wheel(x: float, z: float, radius: float, is_over: bool) -> Roller:
    return Roller("wheel", (x, 0.0, z), (0.0, 1.0, 0.0), 0.05, radius, is_over)


def test_a_line_around_rollers_is_the_shortest():
    """Half a circle between plumb lines; an open and a crossed belt of two circles have their closed lengths."""
    half = taut((-0.1, 0.0, 0.6), (0.1, 0.0, 0.7), (wheel(0.0, 1.0, 0.1, True),))
    assert half.length == pytest.approx(0.4 + 0.3 + math.pi * 0.1, rel=1e-12)
    r, big, apart = 0.1, 0.3, 1.0
    for crossed, lean in ((False, math.asin((big - r) / apart)), (True, math.asin((big + r) / apart))):
        pair = (wheel(0.0, 0.0, r, True), wheel(apart, 0.0, big, not crossed))
        _, first, second, _ = taut((-1.0, 0.0, -0.5), (3.0, 0.0, 0.0), pair).bends
        assert math.dist(first.point(first.turn), second.point(0.0)) == pytest.approx(apart * math.cos(lean), rel=1e-9)


@pytest.mark.parametrize(("before", "after", "is_over"), [(-1.0, 3.0, True), (3.0, -1.0, True), (1.0, -3.0, False)])
def test_a_straight_line_beside_a_roller_does_not_go_around_it(before, after, is_over):
    """Whether it rises or falls as it passes: a turn of 355 degrees around the other side would touch, too."""
    with pytest.raises(ValueError, match="does not touch it"):
        taut((-10.0, 0.0, before), (10.0, 0.0, after), (wheel(0.0, 0.0, 0.5, is_over),))


def test_particles_around_a_roller_lie_on_it_with_equal_links():
    """Under one and over the other: no link is longer or shorter, no particle in a roller, and those on it are at its radius."""
    pair = (wheel(0.0, 0.5, 0.083, False), wheel(0.2, 1.0, 0.083, True))
    line = taut((-0.083, 0.0, 1.1), (0.283, 0.0, 0.6), pair)
    points = np.array(line.points(300))
    links = np.linalg.norm(np.diff(points, axis=0), axis=1)
    np.testing.assert_allclose(links, line.length / 300, rtol=3e-4)  # those at the ends of an arc: (h/r)^2/24
    for r in pair:
        away = np.hypot(points[:, 0] - r.centre[0], points[:, 2] - r.centre[2])
        half = 0.5 * line.length / 300 / r.radius  # chords as long as the arc lie so far out
        assert r.radius < away.min() <= (1.0 + 1e-9) * r.radius * half / math.sin(half)
    assert line.middle()[1] == 0.0 and points[-1] == pytest.approx(line.end)


def test_the_curve_of_a_slack_rope_is_a_catenary_of_its_length():
    """Between its ends, with its length, lowest in between, and its centre in its middle."""
    curve = hanging(SLACK.start, SLACK.end, SLACK.length)
    points = np.array(curve.points(2000))
    assert np.linalg.norm(np.diff(points, axis=0), axis=1).sum() == pytest.approx(1.6, rel=1e-6)
    assert points[-1] == pytest.approx(SLACK.end) and curve(1.6) == pytest.approx(SLACK.end)
    # y'' of the height over the horizontal way: z''  = sqrt(1 + z'^2)/a
    way = np.linalg.norm(points[:, :2], axis=1)
    slope = np.gradient(points[:, 2], way)
    bend = np.gradient(slope, way)[10:-10]
    np.testing.assert_allclose(bend, np.sqrt(1 + slope[10:-10] ** 2) / curve.a, rtol=1e-3)
    height = quad(lambda s: curve(s)[2], 0.0, 1.6)[0] / 1.6
    assert curve.middle()[2] == pytest.approx(height, rel=1e-5)
    np.testing.assert_allclose(
        shapes.depth(SLACK, points - curve.middle()), 0.025, atol=3e-4
    )  # the curve is cut into straight parts


def test_frames_turn_as_little_as_they_can():
    """They are orthonormal, and along a plane curve the axis across that plane stays."""
    angle = np.linspace(0.0, 5.0, 40)
    along = np.stack([np.cos(angle), np.sin(angle), np.zeros(40)], axis=1)
    found = frames(along)
    np.testing.assert_allclose(np.einsum("pad,pbd->pab", found, found), np.tile(np.eye(3), (40, 1, 1)), atol=1e-12)
    np.testing.assert_allclose(found[:, :2] @ (0, 0, 1), found[0, :2] @ (0, 0, 1) * np.ones((40, 2)), atol=1e-12)


@pytest.mark.parametrize("links", [3, 40, 400])
def test_a_tube_is_closed_and_has_the_volume_of_the_rope(links):
    """Also where the rope is bent; with round ends."""
    triangle, index, weight, vertex = make_tube(links, 0.02)
    angle = np.linspace(0.0, 2.0, links + 1)
    x = 0.5 * np.stack([np.cos(angle), np.sin(angle), 0.1 * angle], axis=1)
    drawn = np.einsum("vk,vkd->vd", weight, x[index]) + Tubes([(slice(0, links + 1), vertex)]).around(x)
    assert_closed(triangle)
    length = np.linalg.norm(np.diff(x, axis=0), axis=1).sum()
    full = math.pi * 0.02**2 * length + 4 / 3 * math.pi * 0.02**3
    assert full * 0.9 < enclosed_volume(drawn, triangle) < full * (1.05 if links > 3 else 1.2)


def test_pictures_and_trajectories_have_tubes():
    """The skin of a scene, of which ropes are a part, has the vertices of each model's surface; the same for what was doubled
    along creases."""
    scene = parse_scene(TWO)
    models = build_models(scene)
    metadata = metadata_of(scene, models)
    x = np.concatenate([m.position for m in models])
    x += 0.002 * np.random.default_rng(1).standard_normal(x.shape)
    first = np.cumsum([0, *(len(m.position) for m in models)])
    expected = np.concatenate([m.surface.vertices(x[a:b]) for m, a, b in zip(models, first, first[1:])])
    np.testing.assert_allclose(metadata.skin.vertices(x), expected, atol=1e-14)
    mesh = shaded_mesh(metadata, x)
    np.testing.assert_allclose(mesh.vertices(x), expected[mesh.of_skin], atol=1e-14)
    out = mesh.vertices(x) - (mesh.carry @ x)
    normal = mesh.normals(mesh.vertices(x), x)
    on_line = (np.linalg.norm(out, axis=1) > 0.01) & (mesh.object_of_vertex == 0)
    assert on_line.sum() > 200 and (np.einsum("vd,vd->v", out, normal)[on_line] > 0).all()


def test_a_trajectory_keeps_tubes(tmp_path):
    """They are read back to the last bit."""
    from mdanim_lammps import Scene

    (tmp_path / "two.txt").write_text(TWO)
    run = Scene.load(tmp_path / "two.txt").run(tmp_path / "out")
    with Trajectory(run.folder) as trajectory:
        kept = trajectory.metadata.surfaces
        models = build_models(parse_scene(TWO))
        for n, model in enumerate(models):
            tube = kept[trajectory.metadata.surface_of[n]].tube
            assert (tube is None) == (model.surface.tube is None)
            assert tube is None or np.array_equal(tube, model.surface.tube)
