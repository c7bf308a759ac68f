# SPDX-License-Identifier: GPL-2.0-only
"""In final quality what lies under the liquid is seen aside where the surface slopes, by Snell's law, and nothing else moves."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from mdanim_lammps.picture import skin
from mdanim_lammps.picture.render import Painter
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.scene.render import Camera, Floor, Quality, Render
from picture_measures import hue_mask, project
from picture_samples import box, column_centres, flat, pool_scene, raw_of, wet_frames, write

SIZE = (720, 406)
ABOVE = Render(camera=(Camera((0.0, -0.01, 5.0), (0.0, 0.0, 0.0)),), quality=Quality.FINAL, floor=Floor.PLAIN, shadows=0.0)
LEVEL = 0.5


def picture(path, models, slope, render=ABOVE, size=SIZE):
    """A pool whose surface rises along x, as floats from 0 to 1, and the view."""
    scene, models, grid = pool_scene(models)
    height = LEVEL + slope * column_centres(grid)[0]
    path = write(path, scene, models, wet_frames(models, (height, raw_of(grid, height, models))), grid)
    with Trajectory(path) as t, Painter(t, render, size=size) as painter:
        return painter.frame(0).astype(float) / 255, painter.view(0.0)


def plate(height=0.011):
    """A thin plate on the right half of the floor, or above it; its left edge is at x = 0."""
    return [box("plate", (0.8, 1.0, 0.02), (8, 10, 1), (0.4, 0.0, height))]


def edge_of(image):
    """Where along the middle row the plate begins [pixels]: where its colour, orange, is half way there."""
    row = image[SIZE[1] // 2 - 3 : SIZE[1] // 2 + 4].mean(axis=0)
    orange = row[:, 0] - row[:, 2]
    left, right = orange[SIZE[0] // 2 - 60], orange[SIZE[0] // 2 + 60]
    passed = (orange - left) / (right - left) > 0.5
    k = int(passed[SIZE[0] // 2 - 60 : SIZE[0] // 2 + 60].argmax()) + SIZE[0] // 2 - 60
    before, after = ((orange[i] - left) / (right - left) for i in (k - 1, k))
    return k - 1 + (0.5 - before) / (after - before)


@pytest.fixture(scope="module")
def straight(tmp_path_factory):
    """The edge of the plate at a height below a level surface."""
    return cache(lambda height: edge_of(picture(tmp_path_factory.mktemp("level") / "l.h5", plate(height), 0.0)[0]))


@pytest.mark.parametrize(("slope", "height"), [(0.3, 0.011), (-0.3, 0.011), (0.15, 0.011), (0.3, 0.3), (-0.3, 0.3)])
def test_a_slope_shifts_what_is_below_by_snells_law(tmp_path, straight, slope, height):
    """Straight from above a ray turns by a - asin(sin a / n) on a slope of tangent a; at the depth of the plate it is aside by
    depth times the tangent of that, whatever lies deeper beside it."""
    shifted, view = picture(tmp_path / "s.h5", plate(height), slope)
    a, top = np.arctan(slope), height + 0.01
    aside = (LEVEL - top) * np.tan(a - np.arcsin(np.sin(a) / 1.33))
    (x0, x1), _ = project(view, np.array([[0.0, 0.0, top], [aside, 0.0, top]]), SIZE[0] / SIZE[1])
    pixels = (x1[0] - x0[0]) / 2 * SIZE[0]
    assert abs(pixels) > 1
    assert edge_of(shifted) - straight(height) == pytest.approx(-pixels, abs=0.12 * abs(pixels) + 0.2)


def test_an_outline_leaves_no_trace_beside_it(tmp_path):
    """Rays that pass below a block to where it hides them from the eye show what is beside it, without a share of its colour."""
    block = [box("block", (0.4, 1.0, 0.2), (4, 10, 2), (0.2, 0.0, 0.3))]
    bent, level = (picture(tmp_path / f"{slope}.h5", block, slope)[0] for slope in (0.3, 0.0))
    row = [image[SIZE[1] // 2 - 20 : SIZE[1] // 2 + 20] for image in (bent, level)]
    orange = [(image[:, :, 0] - image[:, :, 2]).mean(axis=0) for image in row]
    left = SIZE[0] // 2 - 20, SIZE[0] // 2 - 3
    assert np.abs(orange[0] - orange[1])[left[0] : left[1]].max() < 0.03


def test_a_level_surface_and_the_glass_shift_nothing(tmp_path, monkeypatch):
    """The same picture whatever the liquid's refractive index, to the bit."""
    side = replace(ABOVE, camera=(Camera((1.5, -4.0, 1.4), (0.0, 0.0, 0.4)),))
    bent, _ = picture(tmp_path / "b.h5", plate(), 0.0, side)
    monkeypatch.setattr(skin, "REFRACTIVE_INDEX", 1.0)
    straight, _ = picture(tmp_path / "s.h5", plate(), 0.0, side)
    np.testing.assert_array_equal(bent, straight)


def test_what_is_above_the_liquid_stays_where_it_is(tmp_path, monkeypatch):
    """A cube that hovers over a slope has the same outline, and none of its colour is seen beside it in the liquid."""
    cube = [box("cube", (0.3, 0.3, 0.3), (3, 3, 3), (0.0, 0.0, 1.2))]
    bent, _ = picture(tmp_path / "b.h5", cube, 0.4)
    monkeypatch.setattr(skin, "REFRACTIVE_INDEX", 1.0)
    straight, _ = picture(tmp_path / "s.h5", cube, 0.4)
    masks = [hue_mask(image, "#e8743b") for image in (bent, straight)]
    assert masks[1].sum() > 500 and (masks[0] != masks[1]).sum() <= 4


def test_draft_quality_shifts_nothing(tmp_path, monkeypatch):
    """A draft is as fast as it was: it draws everything where it is."""
    draft = replace(ABOVE, quality=Quality.DRAFT)
    image, _ = picture(tmp_path / "d.h5", plate(), 0.3, draft)
    monkeypatch.setattr(skin, "REFRACTIVE_INDEX", 1.0)
    np.testing.assert_array_equal(image, picture(tmp_path / "e.h5", plate(), 0.3, draft)[0])


def test_the_same_frame_is_the_same_picture(tmp_path):
    """After other frames, with what was drawn before their surfaces, and alone."""
    scene, models, grid = pool_scene(plate())
    x, _ = column_centres(grid)
    heights = [LEVEL + 0.05 * np.sin(8.0 * x), flat(grid), LEVEL - 0.3 * x]
    frames = wet_frames(models, *[(h, raw_of(grid, h, models)) for h in heights])
    with Trajectory(write(tmp_path / "t.h5", scene, models, frames, grid)) as t:
        with Painter(t, ABOVE, size=SIZE) as painter:
            _, _, after = (painter.frame(n) for n in (1, 2, 0))
        with Painter(t, ABOVE, size=SIZE) as painter:
            np.testing.assert_array_equal(painter.frame(0), after)


@pytest.mark.soak
def test_the_surface_mirrors_what_stands_above_it(tmp_path):
    """In a low view the image of a plate over level water is as far below the surface as the plate is above it; water beside the
    image is as without the plate."""
    low = replace(ABOVE, camera=(Camera((0.0, -4.0, 1.3), (0.0, 0.0, 0.5)),))
    size = (180, 102)
    wet, view = picture(tmp_path / "w.h5", [box("plate", (0.3, 0.05, 0.3), (3, 1, 3), (0.0, 0.2, 0.68))], 0.0, low, size)
    bare, _ = picture(tmp_path / "b.h5", [box("plate", (0.3, 0.05, 0.3), (3, 1, 3), (0.0, 0.2, 9.0))], 0.0, low, size)
    below = np.array([[0.0, 0.175, 2 * LEVEL - 0.6], [0.35, 0.175, 2 * LEVEL - 0.6]])
    seen = (project(view, below, size[0] / size[1])[0] * [0.5, -0.5] + 0.5) * size
    more = (wet - bare)[..., 0] - (wet - bare)[..., 2]
    image, beside = (more[int(y) - 1 : int(y) + 2, int(x) - 1 : int(x) + 2].mean() for x, y in seen)
    assert image > 0.02 and abs(beside) < 0.005
