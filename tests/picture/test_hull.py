# SPDX-License-Identifier: GPL-2.0-only
"""A hull is dry inside: fix mdanim/liquid tells it, and pictures show no liquid there, but under the hull."""

from __future__ import annotations

import ctypes

import numpy as np
import plugin_lab as lab
import pytest
from liquid_lab import call
from mdanim_lammps.model.grid import Grid
from mdanim_lammps.picture.liquid import Blocks, kept_dry, undersides
from mdanim_lammps.picture.render import Painter
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.scene.render import Camera, Render
from picture_measures import SIZE, dry, spot
from picture_samples import box, column_centres, flat, pool_scene, raw_of, wet_frames, write

# --- what the fix tells -----------------------------------------------------------------------------------


def heights(lmp, shape):
    """Smooth and raw heights of the columns, each of shape (ny, nx)."""
    smooth, raw = np.empty(shape), np.empty(shape)
    pointers = [a.ctypes.data_as(ctypes.c_void_p) for a in (smooth, raw)]
    call("liquid_heights", lmp, *pointers)
    return smooth, raw


def hull_in_pool(tmp_path, floor):
    """Raw heights around an open box of particles, one to a cell; which columns are its walls, its inside.

    Its floor is layer ``floor``; outside liquid reaches z = 8. Inside, a ledge leaves one layer of air.
    """
    z, y, x = np.indices((16, 20, 20))
    inside = (np.abs(x - 9.5) < 4) & (np.abs(y - 9.5) < 4)
    hull = (np.abs(x - 9.5) < 5) & (np.abs(y - 9.5) < 5) & (z >= floor) & (z < 12) & ~(inside & (z > floor))
    ledge = inside & (x < 8) & (z > floor) & (z < 7)
    place = np.argwhere(hull | ledge)[:, ::-1] + [-9.5, -9.5, 0.5]
    lmp = lab.load(
        lab.particles(place), tmp_path,
        ["region basin block -10 10 -10 10 0 16", f"region outside block -4 4 -4 4 {floor + 1} 16 side out",
         "fix water all mdanim/liquid basin 1.0 grid 20 20 16 level 8 fill outside gravity 0.01", "run 0"],
    )  # fmt: skip
    smooth, raw = heights(lmp, (20, 20))
    lmp.close()
    assert (smooth == 8.0).all()
    return raw, hull[8], inside[8]


@pytest.mark.parametrize("floor", [4, 5])
def test_inside_of_a_hull_is_told_as_dry(tmp_path, floor):
    """Minus infinity inside, over a ledge too; NaN in the walls, the level around."""
    raw, wall, inside = hull_in_pool(tmp_path, floor)
    assert np.isneginf(raw[inside]).all() and inside.sum() == 64
    assert np.isnan(raw[wall]).all() and wall.sum() == 36
    assert (raw[~wall & ~inside] == 8.0).all()


def test_one_cell_of_air_is_not_dry(tmp_path):
    """Over a body that has just gone under liquid is late by a cell: that is not a hull."""
    raw, wall, inside = hull_in_pool(tmp_path, 6)
    assert np.isnan(raw[inside | wall]).all()


def test_the_foot_of_a_dam_is_not_dry(tmp_path):
    """Where liquid stands on one side only the surface runs out over columns that tell they are empty."""
    lmp = lab.load(
        lab.particles([[5.5, 0.5, 12.5]]), tmp_path,
        ["region basin block -10 10 -10 10 0 16", "region left block -10 0 -10 10 0 16",
         "fix water all mdanim/liquid basin 1.0 grid 20 20 16 level 8 fill left gravity 0.01", "run 0"],
    )  # fmt: skip
    smooth, raw = heights(lmp, (20, 20))
    lmp.close()
    assert (smooth[:, 10] > 3.0).all() and (raw[:, 10:] == 0.0).sum() == 199 and np.isnan(raw).sum() == 1


# --- columns ----------------------------------------------------------------------------------------------

GRID = Grid((-1.0, -0.7, 0.2), (1.0, 0.7, 1.2), (20, 14, 10))


def test_dry_place_ends_within_the_planks():
    """Hidden columns go with the nearest one that is not: cargo is dry, planks halved, other bodies wet."""
    raw = np.full((20, 30), 0.5)
    raw[2:14, 2:18] = np.nan
    raw[6:10, 6:14] = -np.inf
    raw[7:9, 8:10] = np.nan
    raw[4:9, 23:28] = np.nan
    expected = np.zeros(raw.shape, bool)
    # Planks are four columns thick: two on each side.
    expected[4:12, 4:16] = True
    np.testing.assert_array_equal(kept_dry(raw), expected)
    assert not kept_dry(np.where(np.isneginf(raw), np.nan, raw)).any()


def test_undersides_are_the_lowest_points_around():
    """A particle is the underside of its column and the eight around it, other columns have the floor."""
    particles = [[0.05, 0.05, 0.6], [0.05, 0.05, 0.9], [0.25, 0.05, 0.1], [5.0, 0.0, 0.5]]
    lowest = undersides(GRID, np.array(particles))
    expected = np.full((14, 20), 0.2)
    expected[6:9, 9:11] = 0.6
    # The lower one of two counts, and nothing is below the floor.
    expected[6:9, 11:14] = 0.2
    np.testing.assert_array_equal(lowest, expected)


def test_blocks_leave_a_dry_column_out():
    """A column that is kept dry has no block, like one that a solid hides."""
    raw = np.full((14, 20), 0.7)
    blocks, kept = Blocks(GRID), raw.copy()
    raw[5:8, 6:9] = np.nan
    kept[5:8, 6:9] = -np.inf
    for expected, found in zip(blocks.mesh(raw), blocks.mesh(kept)):
        np.testing.assert_array_equal(found, expected)


# --- pixels -----------------------------------------------------------------------------------------------

LOW, HIGH, PLANK = np.array([-0.6, -0.4, 0.2]), np.array([0.6, 0.4, 0.6]), 0.1
ABOVE = Render(camera=(Camera((0.0, -1.2, 3.5), (0.0, 0.0, 0.4)),))
FRONT = Render(camera=(Camera((0.0, -4.5, 0.9), (0.0, 0.0, 0.45)),))


def hull():
    """An open box of five, with a crate in it."""
    size, middle = HIGH - LOW, (LOW + HIGH) / 2

    def part(name, low, high):
        cells = np.maximum(1, np.rint((high - low) / 0.05)).astype(int)
        return box(name, tuple(high - low), tuple(cells), tuple((low + high) / 2))

    x, y, z = np.diag(size - PLANK)
    return [
        part("floor", LOW, HIGH - z),
        part("left", LOW, HIGH - x), part("right", LOW + x, HIGH),
        part("front", LOW, HIGH - y), part("back", LOW + y, HIGH),
        part("crate", middle - [0.1, 0.1, 0.1], middle + [0.1, 0.1, 0.15]),
    ]  # fmt: skip


def picture(path, told, level, render):
    """The hull in a pool, raw heights inside as told, from 0 to 1, and the view."""
    scene, models, grid = pool_scene(hull())
    smooth = level(grid)
    raw = raw_of(grid, smooth, models)
    x, y = column_centres(grid)
    inside = (np.abs(x) < 0.5) & (np.abs(y) < 0.3) & ~((np.abs(x) < 0.1) & (np.abs(y) < 0.1))
    raw[inside] = told
    path = write(path, scene, models, wet_frames(models, (smooth, raw)), grid)
    with Trajectory(path) as t, Painter(t, render, size=SIZE) as painter:
        return painter.frame(0) / 255.0, painter.view(0.0)


def test_inside_of_a_hull_is_dry(tmp_path):
    """Planks and cargo look as in an empty basin, no sheet over them; around the hull nothing changes."""
    kept, view = picture(tmp_path / "k.h5", -np.inf, flat, ABOVE)
    bare, _ = picture(tmp_path / "b.h5", np.nan, dry, ABOVE)
    under, _ = picture(tmp_path / "u.h5", np.nan, flat, ABOVE)
    for point in ((-0.3, 0.0, 0.3), (0.4, 0.15, 0.3), (0.0, -0.1, 0.4), (0.3, 0.3, 0.4)):
        np.testing.assert_allclose(spot(kept, view, point), spot(bare, view, point), atol=0.01)
        assert np.abs(spot(under, view, point) - spot(bare, view, point)).max() > 0.05
    for point in ((0.8, 0.0, 0.5), (0.0, 0.55, 0.5)):
        np.testing.assert_array_equal(spot(kept, view, point), spot(under, view, point))


def test_under_a_hull_is_liquid(tmp_path):
    """Through the front wall the hull's outside and the floor below it have the liquid's colour as ever."""
    kept, view = picture(tmp_path / "k.h5", -np.inf, flat, FRONT)
    under, _ = picture(tmp_path / "u.h5", np.nan, flat, FRONT)
    bare, _ = picture(tmp_path / "b.h5", np.nan, dry, FRONT)
    for point in ((0.0, -0.4, 0.3), (0.0, 0.0, 0.0), (0.3, -0.2, 0.0), (0.0, 0.6, 0.1)):
        np.testing.assert_allclose(spot(kept, view, point), spot(under, view, point), atol=0.02)
        assert np.abs(spot(kept, view, point) - spot(bare, view, point)).max() > 0.1
