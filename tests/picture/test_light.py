# SPDX-License-Identifier: GPL-2.0-only
"""``light``, ``shadows``, ``floor`` and ``quality`` of a render block, and where a shadow begins."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from mdanim_lammps.errors import UsageError
from mdanim_lammps.picture.rays import LAMP, direction
from mdanim_lammps.picture.render import Painter
from mdanim_lammps.picture.window import fewer_pixels
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.scene.render import Camera, Floor, Quality, Render
from mdanim_lammps.scene.scene import Control, SceneRecord
from picture_measures import hue_mask, project
from picture_samples import ball, box, falling, flat, pool_scene, raw_of, solid, wet_frames, write

SIZE = (640, 360)
ABOVE = (Camera((0.0, -4.0, 3.0), (0.0, 0.0, 0.3)),)


def trajectory(tmp_path, models, ground=0.0, colors=None):
    """Models as they stand."""
    solids = tuple(solid(m, (0, 0, 0), color) for m, color in zip(models, colors or [None] * len(models)))
    scene = SceneRecord("s", Control(1.0), solids=solids, ground=ground)
    return Trajectory(write(tmp_path / "t.h5", scene, models, falling(models, 1, floor=0.0)))


def picture(t, render, size=SIZE):
    with Painter(t, render, size=size) as painter:
        return painter.frame(0).astype(float) / 255, painter.view(0.0)


def at(image, view, points):
    """Mean of the colour channels at points of space, shape (P,)."""
    height, width, _ = image.shape
    seen, _ = project(view, np.array(points, dtype=float), width / height)
    column, row = ((seen[:, 0] + 1) / 2 * width).astype(int), ((1 - seen[:, 1]) / 2 * height).astype(int)
    return image[row, column].mean(axis=1)


def standing(name="stands", position=(0.0, 0.0, 0.3), size=(0.3, 0.3, 0.6)):
    return box(name, size, (3, 3, 6), position)


@pytest.mark.parametrize("light", [(1.0, -1.0, 2.0), (-1.0, -0.2, 1.0), tuple(LAMP)])
def test_a_shadow_falls_away_from_the_lamp(tmp_path, light):
    """The floor is dark where a ray towards the lamp meets the box, and only there."""
    with trajectory(tmp_path, [box("box", (0.3,) * 3, (2,) * 3, (0, 0, 0.9))]) as t:
        image, view = picture(t, Render(camera=ABOVE, light=light, floor=Floor.PLAIN))
    foot = {other: np.array([0, 0, 0.9]) - direction(other) * 0.9 / direction(other)[2] for other in {light, (-1.0, 0.8, 1.0)}}
    dark, bright = (at(image, view, [foot[other]])[0] for other in (light, (-1.0, 0.8, 1.0)))
    assert dark < 0.8 * bright


def test_shadows_are_as_dark_as_asked_for(tmp_path):
    """Half of the darkness is half way, and 0 leaves no shadow at all."""
    below = np.array([0, 0, 0.9]) - LAMP * 0.9 / LAMP[2]
    found = []
    with trajectory(tmp_path, [box("box", (0.3,) * 3, (2,) * 3, (0, 0, 0.9))]) as t:
        for shadows in (0.0, 0.5, 1.0):
            image, view = picture(t, Render(camera=ABOVE, shadows=shadows, floor=Floor.PLAIN))
            found.append(at(image, view, [below, [-0.8, below[1], 0.0]]))
    (none, beside), half, full = found
    assert none == pytest.approx(beside, abs=0.01) and full[0] < 0.75 * beside
    assert half[0] == pytest.approx((none + full[0]) / 2, abs=0.01)


@pytest.mark.parametrize("quality", Quality)
def test_a_shadow_begins_where_a_box_stands(tmp_path, quality):
    """From its foot on the floor in the shadow of a box is dark: no bright line lets it seem to float."""
    camera = (Camera((1.6, 0.3, 0.7), (0.15, 0.05, 0.0)),)
    # The second one makes the scene larger, and so the pixels of the lamp's picture coarser.
    models = [standing(), standing("far", (-3.0, 2.0, 0.3))]
    with trajectory(tmp_path, models) as t:
        image, view = picture(t, Render(camera=camera, quality=quality, floor=Floor.PLAIN), (1280, 720))
    away = np.linspace(0.004, 0.1, 60)
    line = at(image, view, np.column_stack([0.15 + away, 0.08 + 0 * away, 0 * away]))
    deep, lit = line[-10:].mean(), at(image, view, [(0.5, -0.4, 0.0)])[0]
    assert deep < 0.8 * lit
    assert line.max() < deep + 0.1 * (lit - deep)


def test_words_of_the_language_are_taken_from_python():
    """Quality and floor by their words, and a message for others."""
    assert Render(quality="final", floor="none") == Render(quality=Quality.FINAL, floor=Floor.NONE)
    with pytest.raises(UsageError, match="draft, final"):
        Render(quality="best")


@pytest.mark.parametrize("quality", Quality)
def test_a_shadow_begins_at_the_foot_of_a_step(tmp_path, quality):
    """Beside a higher box that stands on the same ground the top of a lower one is dark from the foot on: no light line."""
    models = [
        box("high", (0.4, 0.8, 0.6), (4, 8, 6), (-0.2, 0.0, 0.3)),
        box("low", (0.4, 0.8, 0.3), (4, 8, 3), (0.2, 0.0, 0.15)),
        standing("far", (-3.0, 2.0, 0.3)),
    ]
    render = Render(
        camera=(Camera((1.6, 0.3, 1.4), (0.05, 0.05, 0.3)),), quality=quality, floor=Floor.PLAIN, light=(-1.0, -0.3, 1.5)
    )
    with trajectory(tmp_path, models) as t:
        image, view = picture(t, render, (1280, 720))
    away = np.linspace(0.003, 0.1, 80)
    line = at(image, view, np.column_stack([away, 0.08 + 0 * away, 0.3 + 0 * away]))
    deep, lit = line[-10:].mean(), at(image, view, [(0.3, 0.08, 0.3)])[0]
    assert deep < 0.8 * lit
    assert line.max() < deep + 0.1 * (lit - deep)


def test_floor_is_drawn_as_asked_for(tmp_path):
    """Lines, nothing, squares of two shades, or sky where there is no floor."""
    render = Render(camera=(Camera((0.0, -4.0, 1.5), (0.0, 0.0, 0.3)),))
    row = {}
    with trajectory(tmp_path, [box("box", (0.3,) * 3, (2,) * 3, (0, 0, 0.15))]) as t:
        for floor in Floor:
            row[floor] = picture(t, replace(render, floor=floor))[0][300].mean(axis=1)
        assert np.abs(np.diff(row[Floor.PLAIN])).max() < 0.01
        assert (np.diff(row[Floor.GRID]) < -0.01).sum() >= 3
        dark = row[Floor.CHECKER] < row[Floor.CHECKER].mean()
        assert 0.25 < dark.mean() < 0.75 and 4 <= np.abs(np.diff(dark.astype(int))).sum() < 20
        # Without a floor there is nothing for a shadow to fall on.
        shade = [at(*picture(t, replace(render, floor=f)), [(0.19, 0.0, 0.0)])[0] for f in (Floor.PLAIN, Floor.NONE)]
        assert np.ptp(row[Floor.NONE]) < 0.005 and shade[0] < shade[1] - 0.1


# --- quality ----------------------------------------------------------------------------------------------


def test_final_is_darker_where_less_of_the_sky_is_seen(tmp_path):
    """On the lit side of a box the floor grows darker towards its foot; far from it it is as in a draft."""
    with trajectory(tmp_path, [standing()]) as t:
        draft, final = (picture(t, Render(camera=ABOVE, quality=q, floor=Floor.PLAIN)) for q in Quality)
    for x in (-0.05, 0.05):
        places = [(x, -0.17, 0), (x, -0.3, 0), (x, -0.9, 0)]
        near, middle, far = at(*final, places) - at(*draft, places)
        assert near < middle - 0.02 < -0.02 and abs(far) < 0.012


def test_a_ball_alone_hides_no_sky_from_itself(tmp_path):
    """Round and convex: its final picture is that of the draft, without stains."""
    with trajectory(tmp_path, [ball("ball", 0.5, 0.125, (0, 0, 1.5), rings=48)], ground=None) as t:
        draft, final = (picture(t, Render(quality=q, floor=Floor.NONE))[0] for q in Quality)
    inside = np.abs(draft - draft[5, 5]).max(axis=2) > 0.1
    inside[310:] = False  # the time is written below
    rows, columns = np.nonzero(inside)
    disc = np.hypot(*(np.indices(inside.shape) - np.array([rows.mean(), columns.mean()])[:, None, None])) < 0.45 * np.ptp(rows)
    assert disc.sum() > 5000 and np.abs(final - draft)[disc].max() < 0.05


def test_final_has_smoother_edges(tmp_path):
    """It is nearer than a draft to a picture with sixteen times as many pixels."""
    models = [box("red", (0.5, 0.3, 0.4), (2,) * 3, (0, 0, 0.5))]
    render = Render(floor=Floor.NONE, shadows=0.0)
    with trajectory(tmp_path, models, colors=["#d02020"]) as t:
        draft, final = (picture(t, replace(render, quality=q))[0] for q in Quality)
        with Painter(t, render, size=(4 * SIZE[0], 4 * SIZE[1])) as painter:
            ideal = fewer_pixels(painter.frame(0), 4) / 255
    outline = np.abs(ideal - draft).max(axis=2) > 1e-3
    outline[300:] = False  # the time is written below
    error = [np.abs(p - ideal)[outline].mean() for p in (draft, final)]
    assert outline.sum() > 300 and error[1] < 0.6 * error[0]


def test_final_pictures_are_the_same_again(tmp_path):
    """On another painter, after another frame."""
    models = [standing(), ball("ball", 0.2, 0.08, (0.5, 0, 0.2))]
    scene = SceneRecord("s", Control(1.0), solids=tuple(solid(m, (0, 0, 0)) for m in models), ground=0.0)
    with Trajectory(write(tmp_path / "t.h5", scene, models, falling(models, 3, floor=-1.0))) as t:
        with Painter(t, Render(quality=Quality.FINAL), size=SIZE) as painter:
            painter.frame(0)
            again = painter.frame(1)
        with Painter(t, Render(quality=Quality.FINAL), size=SIZE) as painter:
            np.testing.assert_array_equal(painter.frame(1), again)


def test_liquid_is_as_clear_in_a_final_picture(tmp_path):
    """Under water a white block keeps its tint, and water keeps its colour, to a few shades."""
    slab = [box("slab", (0.6, 0.1, 0.8), (6, 1, 8), (0.0, 0.3, 0.45))]
    scene, models, grid = pool_scene(slab)
    side = Render(camera=(Camera((0.0, -4.5, 0.9), (0.0, 0.0, 0.45)),))
    frames = wet_frames(models, (flat(grid), raw_of(grid, flat(grid), models)))
    with Trajectory(write(tmp_path / "t.h5", scene, models, frames, grid)) as t:
        (draft, view), (final, _) = (picture(t, replace(side, quality=q)) for q in Quality)
    places = [(-0.1, 0.25, 0.7), (0.1, 0.25, 0.3), (0.8, -0.69, 0.25), (-0.8, 0.0, 0.5)]
    np.testing.assert_allclose(at(final, view, places), at(draft, view, places), atol=0.03)
    assert hue_mask(final, "#2a8fb8").sum() == pytest.approx(hue_mask(draft, "#2a8fb8").sum(), rel=0.02)


def test_a_final_picture_has_a_largest_size(tmp_path):
    """Four times as many pixels as are shown must be drawn; a draft may be larger."""
    with trajectory(tmp_path, [standing()]) as t, pytest.raises(UsageError, match=r"9000 x 10 .* at most 8192, or quality draft"):
        Painter(t, Render(quality=Quality.FINAL), size=(9000, 10))
