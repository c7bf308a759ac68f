# SPDX-License-Identifier: GPL-2.0-only
"""The sheet is cut by the faces of hulls, and liquid that stands on bodies has a sheet of its own."""

from __future__ import annotations

import numpy as np
import pytest
from mdanim_lammps.model.grid import Grid
from mdanim_lammps.picture.hulls import FINER, against_bodies, dry_spots
from mdanim_lammps.picture.liquid import PUDDLE, kept_dry
from mdanim_lammps.picture.ponds import one_sheet, parted
from mdanim_lammps.picture.render import Painter
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.scene.render import Camera, Render
from picture_measures import SIZE, dry, spot
from picture_samples import box, column_centres, pool_scene, wet_frames, write

GRID = Grid((-1.5, -1.0, 0.0), (1.5, 1.0, 1.0), (30, 20, 10))
TURN = np.radians(30.0)
QUADS = np.array([(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)])


def boxes(*bounds, turn=TURN):
    """Vertices [m] and triangles of boxes from low to high corners, turned about the z axis."""
    corner = np.array([[[a[k >> axis & 1][axis] for axis in range(3)] for k in range(8)] for a in bounds], float).reshape(-1, 3)
    c, s = np.cos(turn), np.sin(turn)
    corner[:, :2] = corner[:, :2] @ [[c, s], [-s, c]]
    triangle = np.concatenate([QUADS[:, [0, 1, 2]], QUADS[:, [0, 2, 3]]])
    return corner, np.concatenate([triangle + 8 * n for n in range(len(bounds))])


def hull(floor=0.1, bottom=0.0, rim=0.8, plank=0.07):
    """An open box of 1.2 m by 0.8 m, with planks thinner than a column."""
    x, y = 0.6, 0.4
    return boxes(
        ((-x, -y, bottom), (x, y, floor)),
        ((-x, -y, floor), (plank - x, y, rim)), ((x - plank, -y, floor), (x, y, rim)),
        ((-x, -y, floor), (x, plank - y, rim)), ((-x, y - plank, floor), (x, y, rim)),
    )  # fmt: skip


def turned(x, y, half_x, half_y):
    """Which points lie in a rectangle around the origin that is turned."""
    c, s = np.cos(TURN), np.sin(TURN)
    return (np.abs(c * x + s * y) < half_x) & (np.abs(c * y - s * x) < half_y)


def middles(grid=GRID, finer=1):
    """x and y of columns, or of spots [m], each of shape (n, m)."""
    nx, ny, _ = grid.shape
    x, y = ((np.arange(finer * n) + 0.5) * c / finer + a for n, c, a in zip((nx, ny), grid.cell, grid.low))
    return np.meshgrid(x, y)


def told(inside, level=0.5):
    """Raw heights: planks hide columns, and what is in the hull is as told."""
    x, y = middles()
    raw = np.full(x.shape, level)
    raw[turned(x, y, 0.62, 0.42)] = np.nan
    raw[turned(x, y, 0.5, 0.3)] = inside
    return raw


def inside_and_outside():
    """Spots clear of the hull's planks."""
    x, y = middles(finer=FINER)
    return turned(x, y, 0.52, 0.32), ~turned(x, y, 0.61, 0.41)


# --- against bodies ---------------------------------------------------------------------------------------


def test_points_are_in_bodies_or_above_a_face_that_looks_up():
    """Points at two boxes one above the other, which share a part, and beside them."""
    vertices, triangle = boxes(((-0.5, -0.5, 0.0), (0.5, 0.5, 0.4)), ((-0.5, -0.5, 0.3), (0.5, 0.5, 0.6)), turn=0.3)
    x, y = np.array([-0.1, 0.02, 0.9]), np.array([0.03, 0.1])
    for z, is_in, floor in (
        (-0.1, False, -np.inf),
        (0.2, True, -np.inf),
        (0.35, True, -np.inf),
        (0.5, True, 0.4),
        (0.7, False, 0.6),
    ):
        found = against_bodies(x, y, np.full((2, 3), z), vertices, triangle)
        np.testing.assert_array_equal(found[0], [[is_in, is_in, False]] * 2)
        np.testing.assert_allclose(found[1], [[floor, floor, -np.inf]] * 2, atol=1e-12)


# --- dry hulls --------------------------------------------------------------------------------------------


def test_a_dry_hull_is_dry_up_to_its_faces():
    """A hull lies across the columns: all of the inside is dry, nothing outside; columns alone cannot tell that."""
    inside, outside = inside_and_outside()
    raw = told(-np.inf)
    found = dry_spots(GRID, np.full(raw.shape, 0.5), raw, *hull())
    assert found[inside].all() and not found[outside].any()
    columns = np.kron(kept_dry(raw), np.ones((FINER, FINER), bool))
    assert columns[outside].any() or not columns[inside].all()


def test_shallow_air_that_no_column_tells_of_is_dry():
    """A hull with its floor less than two cells below the sheet; with the floor far below it could be liquid between bodies."""
    inside, outside = inside_and_outside()
    raw = told(np.nan)
    found = dry_spots(GRID, np.full(raw.shape, 0.5), raw, *hull(floor=0.42))
    assert found[inside].all() and not found[outside].any()
    assert not dry_spots(GRID, np.full(raw.shape, 0.5), raw, *hull(floor=0.1)).any()


@pytest.mark.parametrize("height", [0.5, 0.2])
def test_a_drip_or_liquid_far_below_the_sheet_leaves_a_hull_dry(height):
    """Two columns at the height of the sheet, or many with liquid three cells below it."""
    inside, outside = inside_and_outside()
    raw = told(-np.inf)
    raw[9:11, 14 if height == 0.5 else slice(12, 18)] = height
    found = dry_spots(GRID, np.full(raw.shape, 0.5), raw, *hull())
    assert found[inside].all() and not found[outside].any()


def test_the_shore_of_liquid_in_a_hull_is_its_face():
    """Dry columns between liquid and planks do not cut the sheet; far from liquid they do."""
    inside, _ = inside_and_outside()
    x, y = middles()
    raw = told(-np.inf)
    raw[turned(x, y, 0.42, 0.24)] = 0.5
    assert not dry_spots(GRID, np.full(raw.shape, 0.5), raw, *hull())[inside].any()
    raw = told(-np.inf)
    raw[turned(x + 0.4, y, 0.2, 0.2) & np.isneginf(raw)] = 0.5
    found = dry_spots(GRID, np.full(raw.shape, 0.5), raw, *hull())
    assert 0.2 < found[inside].mean() < 0.8


def test_without_bodies_nothing_is_dry():
    """Where every column tells a height."""
    raw = np.full((20, 30), 0.5)
    assert not dry_spots(GRID, raw, raw, np.zeros((0, 3)), np.zeros((0, 3), int)).any()


# --- ponds ------------------------------------------------------------------------------------------------


def test_a_pond_in_a_tub_ends_at_its_planks():
    """The other liquid goes on level below the tub; the pond's sheet has the pond's height, and reaches the planks all around."""
    inside, outside = inside_and_outside()
    raw = told(0.6, level=0.1)
    smooth = np.where(np.isnan(raw), 0.3, raw)
    below, rest, ponds = parted(GRID, smooth, raw, *hull(floor=0.4, bottom=0.3))
    np.testing.assert_allclose(below, 0.1)
    assert not np.isfinite(rest[raw == 0.6]).any() and (rest[raw == 0.1] == 0.1).all()
    assert not ponds.hidden[inside].any() and ponds.hidden[outside].all()
    np.testing.assert_allclose(ponds.level[raw == 0.6], 0.6)
    np.testing.assert_allclose(ponds.bottom[raw == 0.6], 0.4)
    shown = np.kron(np.pad(ponds.quads, ((0, 1), (0, 1))) | np.pad(ponds.quads, ((1, 0), (1, 0))), np.ones((FINER, FINER), bool))
    assert shown[inside].all()


def test_around_a_pond_in_a_boat_the_lake_is_cut():
    """The lake is higher than the pond, and none of it is seen in the boat."""
    inside, outside = inside_and_outside()
    raw = told(0.4, level=0.6)
    below, rest, ponds = parted(GRID, np.where(np.isnan(raw), 0.5, raw), raw, *hull())
    assert np.isneginf(rest[raw == 0.4]).all()
    found = dry_spots(GRID, below, rest, *hull())
    assert found[inside].all() and not found[outside].any() and not ponds.hidden[inside].any()


def test_a_pond_on_a_table_ends_on_it():
    """A dome of liquid in the middle of a board: its sheet dives into the board a column beside it."""
    x, y = middles()
    raw = np.full(x.shape, 0.2)
    raw[turned(x, y, 0.62, 0.42)] = np.nan
    raw[turned(x, y, 0.25, 0.25)] = 0.55
    below, _, ponds = parted(GRID, np.where(np.isnan(raw), 0.2, raw), raw, *boxes(((-0.6, -0.4, 0.4), (0.6, 0.4, 0.5))))
    np.testing.assert_allclose(below, 0.2)
    assert (ponds.level[turned(x, y, 0.5, 0.4) & ~turned(x, y, 0.4, 0.4)] < 0.5).all()
    assert (ponds.level[raw == 0.55] > 0.5).all()


def test_one_sheet_hangs_down_within_the_planks_only():
    """With one height for each column the pond and what is around it have theirs, and nothing is drawn between the two."""
    raw = told(0.6, level=0.1)
    smooth = np.where(np.isnan(raw), 0.1, raw)
    height, cut = one_sheet(GRID, smooth, raw, *hull(floor=0.4, bottom=0.3))
    np.testing.assert_allclose(height[np.isfinite(raw)], raw[np.isfinite(raw)])
    assert not cut[np.isfinite(raw)].any()
    for a, b in ((np.s_[:-1], np.s_[1:]), (np.s_[:, :-1], np.s_[:, 1:])):
        steep = np.abs(height[a] - height[b]) > 0.2
        assert steep.any() and (cut[a] | cut[b])[steep].all()


@pytest.mark.parametrize(("rim", "drawn"), [(0.8, True), (0.45, False)])
def test_a_small_pond_is_drawn_only_within_walls(rim, drawn):
    """Ponds of nine columns, in a cup and on a block; neither hangs down to the floor."""
    x, y = middles()
    cup = boxes(
        ((-0.3, -0.3, 0.3), (0.3, 0.3, 0.4)),
        ((-0.3, -0.3, 0.3), (-0.18, 0.3, rim)), ((0.18, -0.3, 0.3), (0.3, 0.3, rim)),
        ((-0.3, -0.3, 0.3), (0.3, -0.18, rim)), ((-0.3, 0.18, 0.3), (0.3, 0.3, rim)),
    )  # fmt: skip
    raw = np.full(x.shape, 0.1)
    raw[turned(x, y, 0.32, 0.32)] = np.nan
    raw[turned(x, y, 0.16, 0.16)] = 0.6
    assert 3 <= (raw == 0.6).sum() <= PUDDLE
    below, rest, ponds = parted(GRID, np.where(np.isnan(raw), 0.1, raw), raw, *cup)
    np.testing.assert_allclose(below, 0.1)
    assert np.isnan(rest[raw == 0.6]).all() and (ponds is not None) == drawn


def test_what_runs_over_or_is_under_one_surface_is_no_pond():
    """Liquid over a body that hangs together with liquid beside it, a drip, and a basin without bodies."""
    board = boxes(((-0.6, -0.4, 0.3), (0.6, 0.4, 0.4)))
    x, y = middles()
    over = np.where(turned(x, y, 0.6, 0.4), 0.5, 0.2)
    drip = np.full(x.shape, 0.2)
    drip[turned(x, y, 0.62, 0.42)] = np.nan
    drip[9:11, 14] = 0.5
    for raw in (over, drip, np.full(x.shape, 0.5)):
        smooth = np.where(np.isnan(raw), 0.2, raw)
        below, rest, ponds = parted(GRID, smooth, raw, *board)
        assert ponds is None and below is smooth and rest is raw


# --- pixels -----------------------------------------------------------------------------------------------

FRONT = Render(camera=(Camera((0.0, -4.5, 1.1), (0.0, 0.0, 0.45)),))
ABOVE = Render(camera=(Camera((0.0, -1.2, 3.5), (0.0, 0.0, 0.4)),))


def tub(path, inside, render):
    """A picture of a tub that hangs in an empty basin, with raw heights in it as told, and its view."""
    low, high, plank = np.array([-0.6, -0.4, 0.3]), np.array([0.6, 0.4, 0.7]), 0.1
    x, y, z = np.diag(high - low - plank)
    bounds = [(low, high - z), (low, high - x), (low + x, high), (low, high - y), (low + y, high)]
    models = [
        box(f"part{n}", tuple(b - a), tuple(np.rint((b - a) / 0.05).astype(int)), tuple((a + b) / 2))
        for n, (a, b) in enumerate(bounds)
    ]
    scene, models, grid = pool_scene(models)
    x, y = column_centres(grid)
    raw = dry(grid)
    raw[(np.abs(x) < 0.6) & (np.abs(y) < 0.4)] = np.nan
    raw[(np.abs(x) < 0.5) & (np.abs(y) < 0.3)] = inside
    path = write(path, scene, models, wet_frames(models, (np.where(np.isnan(raw), grid.low[2], raw), raw)), grid)
    with Trajectory(path) as t, Painter(t, render, size=SIZE) as painter:
        return painter.frame(0) / 255.0, painter.view(0.0)


def test_liquid_in_a_tub_is_seen_in_it_and_not_below(tmp_path):
    """Below the tub all looks as with a dry one; the tub's floor takes the liquid's colour."""
    (full, view), (empty, _) = (tub(tmp_path / f"{n}.h5", inside, FRONT) for n, inside in enumerate((0.6, np.nan)))
    for point in ((0.0, -0.2, 0.15), (0.4, 0.0, 0.1), (-0.5, 0.3, 0.15), (0.65, -0.4, 0.2), (0.0, -0.4, 0.5)):
        np.testing.assert_allclose(spot(full, view, point), spot(empty, view, point), atol=0.01)
    (full, view), (empty, _) = (tub(tmp_path / f"a{n}.h5", inside, ABOVE) for n, inside in enumerate((0.6, np.nan)))
    for point in ((0.0, 0.0, 0.6), (0.45, 0.2, 0.6), (-0.45, -0.1, 0.6)):
        assert np.abs(spot(full, view, point) - spot(empty, view, point)).max() > 0.1
    for point in ((0.55, 0.0, 0.7), (0.0, 0.35, 0.7)):
        np.testing.assert_allclose(spot(full, view, point), spot(empty, view, point), atol=0.01)
