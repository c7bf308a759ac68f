# SPDX-License-Identifier: GPL-2.0-only
"""Foam lies where a surface breaks, fades after, and is none on waves that keep their shape."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from mdanim_lammps.model.grid import Grid
from mdanim_lammps.picture.foam import BREAKING, FADE, MOST, Foam, breaking, looked_at, spread, ways
from mdanim_lammps.picture.light import Light
from mdanim_lammps.picture.render import Painter
from mdanim_lammps.picture.skin import LiquidSkin
from mdanim_lammps.picture.tank import Tank
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.scene.render import Camera, Render
from picture_measures import SIZE, spot
from picture_samples import box, column_centres, flat, pool_scene, raw_of, wet_frames, write

GRID = Grid((-1.0, -0.7, 0.2), (1.0, 0.7, 1.2), (50, 35, 25))
CELL = 0.04
NO_DROPS = np.zeros((0, 4))


def foam(smooth, raw=None, drops=NO_DROPS):
    """Foam of a liquid of GRID."""
    return breaking(GRID, smooth, smooth if raw is None else raw, drops)


def bore(height, front=0.0, width=0.1):
    """A step from 0.7 m down to its foot at a place, of the same slope over its width [m]."""
    x, _ = column_centres(GRID)
    return 0.7 - height * np.clip(1.0 + (x - front) / width, 0.0, 1.0)


@pytest.mark.parametrize("length", [0.16, 0.25, 0.5, 1.0, 2.0])
def test_no_wave_below_breaking_makes_foam(length):
    """Sines up to a k = 0.44, the steepness of the highest wave there is, of any length, along and across."""
    k = 2.0 * np.pi / length
    x, y = column_centres(GRID)
    for phase in (k * x, k * y, k * (x + y) / 2**0.5, k * np.hypot(x, y)):
        assert not foam(0.7 + 0.44 / k * np.cos(phase)).any()


def test_level_liquid_makes_none():
    """At any height, dry too."""
    for height in (0.2, 0.21, 1.2):
        assert not foam(np.full((35, 50), height)).any()


def test_a_bore_is_white_by_the_slope_that_ends_at_its_foot():
    """Half white half way from the first slope to the second, at the foot alone: neither on the slope nor at the crest."""
    x, _ = column_centres(GRID)
    foot = np.isclose(x, 0.02)
    for slope, white in (
        (0.95 * BREAKING[0], 0.0),
        (sum(BREAKING) / 2, 0.5),
        (BREAKING[1], 1.0),
        (2 * BREAKING[1], 3.0),
        (9 * BREAKING[1], MOST),
    ):
        found = foam(bore(slope * 0.2, front=0.02, width=0.2))
        assert found[foot] == pytest.approx(white, abs=1e-5), slope
        assert not found[~foot].any()


def test_a_step_behind_a_solid_is_none():
    """Liquid that stands at two heights on both sides of a wall does not break there, whatever is told for the wall's columns."""
    step = bore(0.4, front=0.02, width=CELL)
    x, _ = column_centres(GRID)
    assert foam(step).max() == MOST
    assert not foam(step, np.where(np.abs(x) < 1.5 * CELL, np.nan, step)).any()


def test_drops_whiten_what_they_fall_on():
    """Just above the surface the column there, as much as the drop holds; higher drops do not."""
    level = np.full((35, 50), 0.7)
    low, high, small = ([[0.02, 0.0, z, r]] for z, r in ((0.72, 0.01), (0.82, 0.01), (0.72, 0.005)))
    assert not foam(level, drops=np.array(high)).any()
    found, less = foam(level, drops=np.array(low)), foam(level, drops=np.array(small))
    assert found.argmax() == np.ravel_multi_index((17, 25), found.shape) and 0.1 < found.max() <= 1.0
    assert (found > 0).sum() == 1 and less.sum() == pytest.approx(found.sum() / 8)
    assert foam(level, drops=np.repeat(low, 500, axis=0)).max() == MOST
    assert foam(level, drops=np.array([[-1.0, 0.7, 0.7, 0.01], [1.0, -0.7, 0.7, 0.01]])).sum() > 0.0


@pytest.mark.parametrize("frame_time", [1 / 10, 1 / 30, 1 / 60, 1 / 500])
def test_frames_that_are_looked_at(frame_time):
    """Back for as long as foam lasts, in steps of about a thirtieth of a second, however many frames there are; not frame 0."""
    seen = np.array(looked_at(5000, frame_time))
    gap = np.diff(seen) * frame_time
    assert seen[-1] == 5000 and len(seen) <= 70 and gap.max() <= max(frame_time, 0.05) and (gap == gap[0]).all()
    assert 4.0 * FADE - gap[0] < (5000 - seen[0]) * frame_time <= 4.0 * FADE + 1e-9
    assert list(looked_at(0, frame_time)) == [] and list(looked_at(1, frame_time)) == [1]
    assert looked_at(40, frame_time)[0] > 0


def test_foam_spreads_over_a_level_liquid_and_is_not_lost():
    """Twice half stays and an eighth goes to each side; at the edge what would go out stays."""
    level, one = np.full((35, 50), 0.7), np.zeros((35, 50), np.float32)
    one[10, 20] = one[0, 0] = 1.0
    found = spread(one, *ways(level, level, CELL))
    row = [1 / 64, 1 / 8, 5 / 16, 1 / 8, 1 / 64]
    assert (
        found[10, 18:23] == pytest.approx(row) and found[8:13, 20] == pytest.approx(row) and found[9, 19] == pytest.approx(1 / 32)
    )
    assert found.sum() == pytest.approx(2.0) and found[0, 0] > 0.5


def test_foam_goes_down_a_fall_but_not_up_nor_under_a_solid():
    """Over a step of more than a cell only the lower side receives; a hidden column has none."""
    x, _ = column_centres(GRID)
    fall = np.where(x < 0.0, 0.7, 0.6)
    all_over = np.ones((35, 50), np.float32)
    found = spread(all_over, *ways(fall, fall, CELL))[17]
    assert found[24] < found[23] < 0.99 and found[25] > 0.98 and found[10] == 1.0
    hidden = np.where(np.abs(x - 0.5) < 0.1, np.nan, fall)
    assert not spread(all_over, *ways(fall, hidden, CELL))[np.isnan(hidden)].any()


def test_a_front_leaves_foam_behind():
    """White where the front is, less where it was; the same from any frame to start with; gone when all is level for long."""
    heights = [bore(0.15, -0.5 + 0.04 * n) if n < 20 else np.full((35, 50), 0.6) for n in range(100)]
    read = lambda n: (heights[n], heights[n], NO_DROPS)
    in_order, alone = Foam(GRID, 1 / 30), Foam(GRID, 1 / 30)
    found = [in_order.at(n, read) for n in range(100)]
    np.testing.assert_array_equal(alone.at(15, read), found[15])
    row = found[15][17]
    front = int(np.abs(column_centres(GRID)[0][0] - 0.1).argmin())
    assert row[front] == 1.0 and row[front - 2] > row[front - 6] > 0.0 and not row[front + 5 :].any()
    assert (
        found[20].any() and found[30].max() < found[20].max() and not found[21 + int(4 * 30 * FADE)].any() and not found[0].any()
    )


# --- pixels -----------------------------------------------------------------------------------------------

ABOVE = Render(camera=(Camera((0.0, -2.5, 3.5), (0.0, 0.0, 0.3)),))


def test_a_breaking_front_is_drawn_white(tmp_path):
    """The front is whiter than the same front in the first frame, where nothing has moved, but no slab; what lies level looks the
    same."""
    scene, models, grid = pool_scene([box("mark", (0.1, 0.1, 0.1), (1, 1, 1), (0.9, 0.6, 0.95))])
    x, _ = column_centres(grid)
    front = np.where(x < 0.0, 0.6, 0.3)
    frames = list(wet_frames(models, *[(front, raw_of(grid, front, models))] * 2))
    with Trajectory(write(tmp_path / "t.h5", scene, models, frames, grid)) as t, Painter(t, ABOVE, size=SIZE) as painter:
        still, white = (painter.frame(n) / 255.0 for n in (0, 1))
        view = painter.view(0.0)
    foot = [(0.03, y, 0.3) for y in np.linspace(-0.5, 0.5, 41)]
    found, before = (np.array([spot(image, view, point) for point in foot]) for image in (white, still))
    assert np.median(found.min(axis=1)) > 0.78 and np.ptp(found, axis=1).mean() < 0.6 * np.ptp(before, axis=1).mean()
    # In specks: between them the liquid is seen, and they are not all as bright.
    assert found[:, 0].std() > 0.02
    for point in ((-0.5, 0.0, 0.6), (0.5, 0.0, 0.3)):
        np.testing.assert_array_equal(spot(white, view, point), spot(still, view, point))


@pytest.mark.soak
def test_parts_of_the_surface_that_need_less_look_as_all_do(tmp_path, monkeypatch):
    """Each triangle drawn by a shader that does for it, and all by that with foam, shadows and holes: the same to rounding."""
    scene, models, grid = pool_scene([box("cube", (0.4, 0.4, 0.2), (4, 4, 2), (0.4, 0.0, 1.3))])
    x, _ = column_centres(grid)
    smooth = [0.7 - 0.3 * np.clip(1.0 + 10.0 * (x - front), 0.0, 1.0) for front in (-0.5, -0.4, -0.3)]
    frames = wet_frames(models, *((z, raw_of(grid, z, models)) for z in smooth))
    render = Render(camera=(Camera((0.0, -3.5, 2.4), (0.0, 0.0, 0.45)),))
    everything = lambda light, points, triangle: np.ones(len(triangle), bool)
    take, found, parts = LiquidSkin.take, [], []
    with Trajectory(write(tmp_path / "t.h5", scene, models, frames, grid)) as t:
        for all_ in (False, True):
            if all_:
                monkeypatch.setattr(Light, "may_shade", everything)
                monkeypatch.setattr(LiquidSkin, "take", lambda skin, *args: take(skin, *args[:2], whole=False))
                monkeypatch.setattr(Tank, "_foamy", lambda tank: np.ones(tank._mesh.data.GetNumberOfPoints(), bool))
            with Painter(t, render, size=SIZE) as painter:
                found.append(painter.frame(2).astype(int))
                parts.append([actor.GetVisibility() for actor in painter._tank.outer[:8]])
    assert sum(parts[0]) > 1 and parts[1] == [0, 0, 0, 0, 0, 0, 0, 1]
    assert abs(found[0] - found[1]).max() <= 2


def test_cells_have_no_foam(tmp_path):
    """With ``liquid cells`` the columns are drawn as they are."""
    scene, models, grid = pool_scene()
    x, _ = column_centres(grid)
    front = np.where(x < 0.0, 0.6, 0.3)
    frames = list(wet_frames(models, *[(front, raw_of(grid, front, models))] * 2))
    path, render = write(tmp_path / "t.h5", scene, models, frames, grid), replace(ABOVE, liquid="cells")
    with Trajectory(path) as t, Painter(t, render, size=SIZE) as painter:
        still, moved = (painter.frame(n)[:-30] for n in (0, 1))
    np.testing.assert_array_equal(still, moved)


def test_a_level_liquid_is_drawn_as_ever(tmp_path):
    """A frame without foam is the first frame's picture."""
    scene, models, grid = pool_scene()
    frames = list(wet_frames(models, *[(flat(grid), raw_of(grid, flat(grid), models))] * 2))
    with Trajectory(write(tmp_path / "t.h5", scene, models, frames, grid)) as t, Painter(t, ABOVE, size=SIZE) as painter:
        first, second = (painter.frame(n)[:-30] for n in (0, 1))
    np.testing.assert_array_equal(first, second)
