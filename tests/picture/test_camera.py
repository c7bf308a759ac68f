# SPDX-License-Identifier: GPL-2.0-only
"""Cameras: the automatic one holds the whole action and no more, paths are smooth."""

from __future__ import annotations

import numpy as np
import pytest
from mdanim_lammps.export.usd import camera_matrix
from mdanim_lammps.picture.camera import CameraPath, action_of, automatic_view, corners, hermite_weights
from mdanim_lammps.picture.lens import MARGIN, Reserved, View, fit_view
from mdanim_lammps.picture.standpoints import camera_of
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.scene.render import Camera
from mdanim_lammps.scene.scene import Control, SceneRecord
from picture_measures import project
from picture_samples import box, falling, slab_scene, solid, write


def moving(tmp_path, models, frames, dt=0.1, ground=0.0):
    """A trajectory in which model i is where frames[k][i] says, as a shift from its start."""
    scene = SceneRecord("s", Control(1.0), solids=tuple(solid(m, (0, 0, 0)) for m in models), ground=ground)
    rows = []
    for k, shifts in enumerate(frames):
        position = np.concatenate([m.position + np.array(s) for m, s in zip(models, shifts)])
        rows.append((k, k * dt, position, np.zeros_like(position)))
    return Trajectory(write(tmp_path / "t.h5", scene, models, rows))


@pytest.mark.parametrize("aspect", [16 / 9, 1.0, 9 / 16])
def test_fit_is_tight(aspect):
    """All points are inside the margin, and one of them on it."""
    points = np.random.default_rng(1).normal(size=(200, 3)) * [3.0, 1.0, 0.5] + [10.0, -4.0, 2.0]
    forward = np.array([0.5, 0.7, -0.4])
    view = fit_view(points, forward / np.linalg.norm(forward), aspect)
    seen, depth = project(view, points, aspect)
    assert (depth > 0).all()
    assert np.abs(seen).max() == pytest.approx(MARGIN, abs=1e-9)
    np.testing.assert_allclose(
        seen.max(axis=0)[np.abs(seen).max(axis=0).argmax()], -seen.min(axis=0)[np.abs(seen).max(axis=0).argmax()], atol=1e-9
    )


@pytest.mark.parametrize("size", [(4.0, 0.2, 0.2), (0.2, 0.2, 4.0), (0.2, 4.0, 0.2)])
def test_wide_and_tall_scenes_fit(tmp_path, size):
    """Every surface point of every frame is in the picture, whatever the shape of the scene."""
    models = [box("a", size, (2, 2, 2), (0, 0, size[2] / 2)), box("b", (0.3, 0.3, 0.3), (1, 1, 1), (0.5, 0.5, 1))]
    frames = [((0, 0, 0), (0.3 * k, 0.1 * k, 0.02 * k**2)) for k in range(8)]
    with moving(tmp_path, models, frames) as t:
        view = automatic_view(action_of(t), 16 / 9)
        for i in range(len(t)):
            seen, depth = project(view, t.metadata.skin.vertices(t.position(i)), 16 / 9)
            assert (depth > 0).all() and np.abs(seen).max() < 1.0
        largest = max(
            np.ptp(project(view, t.metadata.skin.vertices(t.position(i)), 16 / 9)[0], axis=0).max() for i in range(len(t))
        )
        assert largest > 0.6  # of 2: the action fills the picture


def test_a_start_is_seen_above_its_ground(tmp_path):
    """The ground below a single frame is seen, as in the movie that follows; without a ground the objects fill the picture."""
    models = [box("a", (0.2, 0.2, 0.2), (1, 1, 1), (0, 0, 0.6))]
    size = {}
    for ground in (0.0, None):
        with moving(tmp_path, models, [((0, 0, 0),)], ground=ground) as t:
            view = automatic_view(action_of(t), 16 / 9)
            below, _ = project(view, np.array([(0.0, 0.0, 0.0)]), 16 / 9)
            assert (np.abs(below).max() < 1.0) == (ground is not None)
            seen, _ = project(view, t.metadata.skin.vertices(t.position(0)), 16 / 9)
            size[ground] = np.ptp(seen, axis=0).max()
    assert size[None] == pytest.approx(2.0 * MARGIN, rel=0.01) and size[0.0] < 0.5 * size[None]


def test_action_counts_every_frame(tmp_path):
    """A single frame between the sampled ones is not forgotten."""
    models = [box("a", (0.2, 0.2, 0.2), (1, 1, 1), (0, 0, 0.1))]
    frames = [((0.7 if k == 55 else 0.0, 0, 0),) for k in range(100)]
    with moving(tmp_path, models, frames) as t:
        assert action_of(t, samples=3).bounds[1][0] == pytest.approx(0.8)


def test_long_runs_are_looked_at_in_stretches(tmp_path, monkeypatch):
    """With too many boxes to keep, those of several frames are one, and the bounds are the same."""
    models = [box("a", (0.2, 0.2, 0.2), (1, 1, 1), (0, 0, 0.1))]
    with moving(tmp_path, models, [((0.1 * k * (-1) ** k, 0.02 * k, 0),) for k in range(20)]) as t:
        every = action_of(t)
        monkeypatch.setattr("mdanim_lammps.picture.camera._BOXES", 3)
        some = action_of(t)
        assert (len(every.low), len(some.low)) == (20, 3)
        np.testing.assert_allclose(some.bounds, every.bounds, atol=1e-12)


def test_what_falls_out_does_not_shrink_the_rest(tmp_path):
    """Without ground, an object that drops away for good is followed only a little way."""
    models = [box("stays", (1, 1, 0.2), (2, 2, 1), (0, 0, 0)), box("falls", (0.2, 0.2, 0.2), (1, 1, 1), (0, 0, 1))]
    frames = [((0, 0, 0), (0.05 * k, 0, -0.05 * k**2)) for k in range(30)]
    with moving(tmp_path, models, frames, ground=None) as t:
        action = action_of(t)
        assert action.escaped
        assert action.bounds[0][2] > -0.8 and action.bounds[1][0] < 0.8
    with moving(tmp_path, models, frames[:2], ground=None) as t:
        assert not action_of(t).escaped


def test_path_passes_through_its_points():
    """At the times of the points the path is there; between them it has no corner."""
    times = np.array([0.0, 1.0, 1.5, 4.0])
    for i, t in enumerate(times):
        np.testing.assert_allclose(hermite_weights(times, t), np.eye(4)[i], atol=1e-12)
    value = np.array([0.0, 2.0, 1.0, 5.0])
    h = 1e-5
    for t in times[1:-1]:
        before = value @ (hermite_weights(times, t) - hermite_weights(times, t - h)) / h
        after = value @ (hermite_weights(times, t + h) - hermite_weights(times, t)) / h
        assert before == pytest.approx(after, abs=1e-3)  # curvature times h
    for t in np.linspace(-1, 5, 25):
        assert hermite_weights(times, t).sum() == pytest.approx(1.0)
    np.testing.assert_array_equal(hermite_weights(times, 9.0), [0, 0, 0, 1])


@pytest.mark.parametrize(
    ("eye", "up", "upright"),
    [
        pytest.param((0, 0, 5), (0, 0, 1), (0, 1, 0), id="from above"),
        pytest.param((0, 0, -5), (0, 0, 1), (0, 1, 0), id="from below"),
        pytest.param((1e-8, 0, 5), (0, 0, 1), (0, 1, 0), id="as good as from above"),
        pytest.param((0, 0, 5), (1, 0, 0), (1, 0, 0), id="from above, x up"),
        pytest.param((0, -0.01, 5), (0, 0, 1), (0, 0, 1), id="nearly from above"),
        pytest.param((0, 5, 0), (0, -2, 0), (0, 0, 1), id="along y, y up"),
        pytest.param((3, 3, 3), (1, 1, 1), (0, 0, 1), id="askew"),
    ],
)
def test_something_is_up_in_every_picture(eye, up, upright):
    """A view along its own up has the axes of a camera all the same: none of them is NaN, and they are at right angles."""
    view = View(*(np.array(v, float) for v in (eye, (0, 0, 0), up)))
    np.testing.assert_array_equal(view.upright, upright)
    axes = camera_matrix(view)[:3, :3]
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-9)
    assert axes[1] @ np.array(upright, float) > 0.0


def test_look_follows_an_object(tmp_path):
    """``look NAME`` is the object's centre of mass, between frames too."""
    scene, models = slab_scene()
    with Trajectory(write(tmp_path / "t.h5", scene, models, falling(models, 4))) as t:
        path = CameraPath((Camera((3, -3, 2), "cube"),), t)
        centre = t.objects["cube"].center_of_mass
        np.testing.assert_allclose(path.at(0.2).look, centre[2], atol=1e-12)
        np.testing.assert_allclose(path.at(0.15).look, (centre[1] + centre[2]) / 2, atol=1e-12)
        np.testing.assert_array_equal(path.at(0.15).eye, [3, -3, 2])
        two = CameraPath((Camera((3, -3, 2), (0, 0, 0), 0.3), Camera((1, -3, 2), "cube", 0.0)), t)
        np.testing.assert_allclose(two.at(0.0).eye, [1, -3, 2])
        np.testing.assert_allclose(two.at(0.3).look, [0, 0, 0], atol=1e-12)


@pytest.mark.parametrize(("count", "followed"), [pytest.param(4, True, id="few"), pytest.param(40, False, id="crowd")])
def test_a_crowd_is_not_ruled_by_a_runaway(tmp_path, count, followed):
    """The camera holds an object that runs off, unless it is one of a crowd."""
    models = [box(f"b[{i}]", (0.1, 0.1, 0.1), (1, 1, 1), (2.0 * i / count, 0, 0.05)) for i in range(count)]
    frames = [tuple((4.0 * k if i == 0 else 0.0, 0, 0) for i in range(count)) for k in range(2)]
    with moving(tmp_path, models, frames) as t:
        assert action_of(t).bounds[1][0] == pytest.approx(4.05 if followed else models[-1].position[:, 0].max())


def row_with_a_flier(tmp_path, flight, frames=60):
    """Eight boxes stand in a row; ``flight`` says where the ninth is in each frame."""
    models = [box(f"b[{i}]", (0.1, 0.2, 0.4), (1, 1, 1), (0.3 * i, 0, 0.2)) for i in range(8)]
    models.append(box("flier", (0.1, 0.1, 0.1), (1, 1, 1), (0, 0, 0)))
    return moving(tmp_path, models, [((0, 0, 0),) * 8 + (flight(k),) for k in range(frames)])


def inside(t, view):
    """Whether each object is wholly in the picture in each frame, bool, shape (F, O)."""
    return np.array([inside_at(t, n, view) for n in range(len(t))])


def inside_at(t, n, view):
    """The same in one frame, shape (O,)."""
    skin = t.metadata.skin
    seen, depth = project(view, skin.vertices(t.position(n)), 16 / 9)
    out = (np.abs(seen).max(axis=1) > 1.0) | (depth <= 0.0)
    return np.bincount(skin.object_of_vertex, out) == 0


def test_a_last_flier_does_not_shrink_the_rest(tmp_path):
    """One of nine flies off at the end of the run: the row is seen nearly as large as without it, and always whole.
    A view from a side that the scene names shows the whole run."""
    with row_with_a_flier(tmp_path, lambda k: (2.5 + 0.2 * max(0, k - 45), 0, 0.5)) as t:
        view = automatic_view(action_of(t), 16 / 9)
        seen = inside(t, view)
        assert inside(t, automatic_view(action_of(t), 16 / 9, forward=np.array([0.0, 1.0, 0.0]))).all()
    with row_with_a_flier(tmp_path, lambda k: (2.5, 0, 0.5)) as t:
        near = automatic_view(action_of(t), 16 / 9)
    assert seen[:, :8].all() and seen[:46].all() and not seen[-1, 8]
    assert view.eye[1] > 1.4 * near.eye[1]  # the eye is on the negative side: 1.4 times as far away


def test_what_comes_is_seen_before_it_arrives(tmp_path):
    """A ball that flies in from afar is not followed from the start, but for a moment before it is there."""
    with row_with_a_flier(tmp_path, lambda k: (-0.2 - 0.3 * max(0, 15 - k), 0, 0.3)) as t:
        seen = inside(t, automatic_view(action_of(t), 16 / 9))
    assert seen[:, :8].all() and not seen[0, 8] and seen[13:, 8].all()


def test_what_comes_to_hit_is_seen_from_the_start(tmp_path):
    """A ball that swings at a row from afar is in the picture all the way, as nothing else moves; the same ball that ends beside
    the row is not followed."""
    for stops, followed in ((0.0, True), (0.2, False)):
        with row_with_a_flier(tmp_path, lambda k, s=stops: (-s - 0.3 * max(0, 15 - k), 0, 0.3 + 0.1 * max(0, 15 - k))) as t:
            seen = inside(t, automatic_view(action_of(t), 16 / 9))
        assert seen[:, :8].all() and seen[0, 8] == followed


def test_the_camera_goes_back_for_what_moves_most(tmp_path):
    """One of nine flies off last: it is seen at any time, from farther and farther away, smoothly; before that the row is as
    large as without it. What goes too far is left, and the row is large again. Beside another run the camera stands still."""
    with row_with_a_flier(tmp_path, lambda k: (2.5 + 0.2 * max(0, k - 45), 0, 0.5)) as t:
        action = action_of(t)
        camera, base = camera_of((), t, action, 16 / 9), automatic_view(action, 16 / 9)
        views = [camera.at(time) for time in t.times]
        assert not camera.still and all(inside_at(t, n, view).all() for n, view in enumerate(views))
        np.testing.assert_allclose(views[0].eye, base.eye, atol=1e-9)
        gone = np.linalg.norm(np.diff([view.eye for view in views], axis=0), axis=1)
        total = np.linalg.norm(views[-1].eye - views[0].eye)
        assert 0.3 * np.linalg.norm(base.eye) < total and np.abs(np.diff(gone)).max() < 0.06 * total
        assert camera_of((), t, action, 16 / 9, fixed=True).still
    with row_with_a_flier(tmp_path, lambda k: (2.5 + 2.0 * max(0, k - 15), 0, 0.5)) as t:
        action = action_of(t)
        camera, base = camera_of((), t, action, 16 / 9), automatic_view(action, 16 / 9)
        away = [np.linalg.norm(camera.at(time).eye - base.eye) for time in t.times]
        assert 10 < np.argmax(away) < 30 and away[-1] < 1e-9


def test_most_of_what_moves_is_seen_at_any_time(tmp_path):
    """Half of the objects come from afar: the picture holds them all, however large it would be without them."""
    models = [box(f"b[{i}]", (0.1, 0.1, 0.1), (1, 1, 1), (0.2 * i, 0, 0.05)) for i in range(4)]
    frames = [tuple((max(0, 5 - k) * (i % 2), 0, 0) for i in range(4)) for k in range(100)]
    with moving(tmp_path, models, frames) as t:
        assert inside(t, automatic_view(action_of(t), 16 / 9)).all()


def test_words_have_room_below():
    """Points that are fitted to a part of the height end above the rest of it; to the left of panels, too."""
    from mdanim_lammps.picture.framing import seen_at

    points = np.random.default_rng(5).uniform(-1.0, 1.0, (50, 3))
    forward, size, below, right = np.array([0.6, 0.64, -0.48]), np.array([1600, 900]), 0.2, 0.3
    view = fit_view(points, forward, 16 / 9, Reserved(right=right, below=below))
    low, high = (edge(seen_at(view, size, points)[0] / size, axis=0) for edge in (np.min, np.max))
    room = (1.0 - MARGIN) / 2
    assert low[1] >= below + room * (1.0 - below) - 1e-9 and high[1] <= 1.0 - room * (1.0 - below) + 1e-9
    assert low[0] >= room * (1.0 - right) - 1e-9 and high[0] <= (1.0 - right) * (1.0 - room) + 1e-9


@pytest.mark.parametrize(("size", "nearer"), [((4.0, 0.3, 0.3), 1.2), ((0.3, 0.3, 4.0), 0.95)], ids=["wide", "tall"])
def test_what_is_wide_is_seen_below_a_corner_too(size, nearer):
    """Not left of it alone, where it would be small; it touches a line that cuts the corner off."""
    from mdanim_lammps.picture.framing import seen_at

    points, forward, corner = corners(-0.5 * np.array([size]), 0.5 * np.array([size])), np.array([0.0, 0.96, -0.28]), (0.38, 0.4)
    view = fit_view(points, forward, 16 / 9, Reserved(corner=corner))
    beside = fit_view(points, forward, 16 / 9, Reserved(right=corner[0]))
    assert np.linalg.norm(beside.eye - beside.look) > nearer * np.linalg.norm(view.eye - view.look)
    share = seen_at(view, np.array([1600, 900]), points)[0] / (1600, 900)
    assert (share > 0.0).all() and (share < 1.0).all() and (share < 1.0 - np.array(corner)).any(axis=1).all()
