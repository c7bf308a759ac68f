# SPDX-License-Identifier: GPL-2.0-only
"""The liquid in pictures: its mesh holds its volume and is closed, and it is seen where it is only."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from mdanim_lammps.model.grid import Grid
from mdanim_lammps.picture import tank
from mdanim_lammps.picture.camera import action_of
from mdanim_lammps.picture.liquid import Blocks, Drops, LiquidSheet, droplets, overhang, without_puddles
from mdanim_lammps.picture.render import Painter
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.scene.render import Camera, Render
from picture_measures import SIZE, dry, hue_mask, project, spot
from picture_samples import box, column_centres, dam, flat, pool_scene, raw_of, splash, wet_frames, with_drops, write

GRID = Grid((-1.0, -0.7, 0.2), (1.0, 0.7, 1.2), (20, 14, 10))
SIDE = Render(camera=(Camera((0.0, -4.5, 0.9), (0.0, 0.0, 0.45)),))
"""Through the front wall."""


def test_a_liquid_looks_the_same_at_any_height(tmp_path):
    """Two metres up, with the camera: the same picture, to rounding."""
    pictures = []
    for up in (0.0, 2.0):
        lift = np.array([0.0, 0.0, up])
        scene, models, grid = pool_scene([box("slab", (0.6, 0.1, 0.8), (6, 1, 8), (0.0, 0.3, 0.45 + up))])
        grid = replace(grid, low=tuple(grid.low + lift), high=tuple(grid.high + lift))
        render = Render(camera=(Camera((0.0, -4.5, 0.9 + up), (0.0, 0.0, 0.45 + up)),))
        raw = raw_of(grid, flat(grid) + up, models)
        path = write(tmp_path / "t.h5", scene, models, wet_frames(models, (flat(grid) + up, raw)), grid)
        with Trajectory(path) as t, Painter(t, render, size=SIZE) as painter:
            pictures.append(painter.frame(0).astype(float) / 255)
    assert (np.abs(pictures[0] - pictures[1]).max(axis=2) > 0.02).mean() < 0.002


def volume_below(points, triangle, floor):
    """Volume between upward triangles and a level [m^3]; walls have no plan area and add nothing."""
    a, b, c = (points[triangle[:, k]] for k in range(3))
    plan = 0.5 * np.cross(b - a, c - a)[:, 2]
    return float((plan * ((a + b + c)[:, 2] / 3 - floor)).sum())


def area_sum(points, triangle):
    """Sum of all area vectors [m^2]: that of a closed surface without its bottom is the bottom's, upwards."""
    a, b, c = (points[triangle[:, k]] for k in range(3))
    return 0.5 * np.cross(b - a, c - a).sum(axis=0)


@pytest.mark.parametrize("heights", [flat, dam, splash, lambda grid: 0.7 + 0.2 * column_centres(grid)[0]])
def test_sheet_holds_the_volume(heights):
    """Below the sheet is the volume of the columns."""
    height = heights(GRID) + GRID.low[2]
    sheet = LiquidSheet(GRID)
    points, _ = sheet.mesh(height)
    expected = (height - GRID.low[2]).sum() * GRID.cell[0] * GRID.cell[1]
    # Bilinear patches hold it exactly; two triangles differ by the twist, which cancels but for this.
    assert volume_below(points, sheet.triangle, GRID.low[2]) == pytest.approx(expected, rel=2e-4)


@pytest.mark.parametrize("heights", [dam, splash])
@pytest.mark.parametrize("form", [LiquidSheet, Blocks])
def test_mesh_is_closed_but_for_its_bottom(form, heights):
    """Walls leave no gap, and every face looks outwards: area vectors add up to the open bottom's."""
    mesh = form(GRID)
    points, _ = mesh.mesh(heights(GRID) + GRID.low[2])
    # Sums of some thousand terms below 1 m^2.
    np.testing.assert_allclose(area_sum(points, mesh.triangle), [0.0, 0.0, 2.0 * 1.4], rtol=0, atol=1e-12)


@pytest.mark.parametrize("form", [LiquidSheet, Blocks])
def test_normals_look_out_of_the_faces(form):
    """A vertex's normal has unit length and is on the outer side of its triangles, for drawing by side."""
    mesh = form(GRID)
    points, normals = mesh.mesh(splash(GRID, height=0.03))
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, rtol=1e-12)
    a, b, c = (points[mesh.triangle[:, k]] for k in range(3))
    face = np.cross(b - a, c - a)
    size = np.linalg.norm(face, axis=1)
    real = size > 1e-12
    assert real.sum() > 500
    cosine = np.einsum("td,td->t", face[real] / size[real, None], normals[mesh.triangle[real, 0]])
    # Walls and blocks are flat; of the sheet neighbouring slopes differ.
    assert cosine.min() > (0.8 if form is LiquidSheet else 1 - 1e-9)


def test_slope_turns_the_normals():
    """On a slope that rises along x and falls along y normals lean against the rise, out to the edges."""
    x, y = column_centres(GRID)
    _, normals = LiquidSheet(GRID).mesh(0.7 + 0.5 * x - 0.25 * y)
    inner = normals[: 22 * 16].reshape(16, 22, 3)[2:-2, 2:-2]
    expected = np.array([-0.5, 0.25, 1.0]) / np.linalg.norm([-0.5, 0.25, 1.0])
    np.testing.assert_allclose(inner, np.broadcast_to(expected, inner.shape), atol=1e-12)


def test_sheet_reaches_the_edges_and_its_rim_runs_there():
    """The sheet ends at the basin's walls, and so does the bright line on the glass, all around."""
    sheet = LiquidSheet(GRID)
    height = splash(GRID, centre=(0.4, 0.2))
    points, _ = sheet.mesh(height)
    ends = [points.min(axis=0)[:2], points.max(axis=0)[:2]]
    np.testing.assert_allclose(ends, [GRID.low[:2], GRID.high[:2]])
    rim = points[sheet.rim]
    on_wall = (np.abs(rim[:, 0]) == 1.0) | (np.abs(rim[:, 1]) == 0.7)
    assert on_wall.all() and len(np.unique(rim, axis=0)) == len(rim) == 2 * (21 + 15)
    outermost = np.concatenate([height[0], height[-1], height[:, 0], height[:, -1]])
    assert rim[0, 2] == height[0, 0] and rim[:, 2].max() == outermost.max()


def test_blocks_are_raw():
    """Each column has its own level top at its raw height; one that tells nothing has no top and no sides."""
    raw = raw_of(GRID, splash(GRID))
    hole = raw.copy()
    hole[5:8, 6:9] = np.nan
    for height in (raw, hole):
        blocks = Blocks(GRID)
        points, normals = blocks.mesh(height)
        tops = points[normals[:, 2] > 0.5].reshape(14, 20, 4, 3)
        known = ~np.isnan(height)
        np.testing.assert_array_equal(tops[known][:, :, 2], np.repeat(height[known], 4).reshape(-1, 4))
        assert (tops[~known][:, :, 2] == GRID.low[2]).all()
        np.testing.assert_allclose(tops.mean(axis=2)[..., 0], column_centres(GRID)[0], atol=1e-12)
    # Around and in the hole, x -0.4 .. -0.1 and y -0.2 .. 0.1, no face goes down to the floor.
    faces = points.reshape(-1, 4, 3)[np.abs(normals[::4, 2]) < 0.5]
    middle = faces.mean(axis=1)
    around = (np.abs(middle[:, 0] + 0.25) < 0.16) & (np.abs(middle[:, 1] + 0.05) < 0.16)
    assert around.sum() == 24 and (np.ptp(faces[around][:, :, 2], axis=1) == 0).all()


@pytest.mark.parametrize("radius", [0.08, 0.2])
def test_a_puddle_on_a_body_is_hidden(radius):
    """On the end of a body in a pool it takes the pool's height and tells nothing; all else stays."""
    x, y = column_centres(GRID)
    puddle, body = np.hypot(x, y) < radius, (x < 0.0) & (np.abs(y) < 0.3)
    smooth = np.where(puddle, 1.0, 0.5)
    raw = np.where(body & ~puddle, np.nan, smooth)
    found, told = without_puddles(GRID, smooth, raw)
    assert puddle.sum() in (4, 12) and (found == 0.5).all()
    np.testing.assert_array_equal(told, np.where(puddle, np.nan, raw))


@pytest.mark.parametrize("columns", [1, 2, 3])
def test_a_drip_on_a_pillar_is_hidden(columns):
    """One or two columns with the pillar's alone around, and what heights of those have of it; more may be what a hull holds."""
    x, y = column_centres(GRID)
    pillar, drip = np.hypot(x, y) < 0.36, np.zeros(x.shape, bool)
    drip[7, 9 : 9 + columns] = True
    near = np.zeros(x.shape, bool)
    near[6:9, 8 : 10 + columns] = True
    smooth = np.where(drip, 1.0, np.where(near, 0.7, 0.5))
    raw = np.where(pillar & ~drip, np.nan, smooth)
    found, told = without_puddles(GRID, smooth, raw)
    if columns < 3:
        assert (found == 0.5).all() and np.array_equal(np.isnan(told), pillar)
    else:
        assert (found == smooth).all() and np.array_equal(told, raw, equal_nan=True)


def test_jets_wells_and_rivers_are_no_puddles():
    """A jet in open liquid, liquid in a tube, many columns above a weir, and a cavity beside a body stay as they are."""
    x, y = column_centres(GRID)
    r = np.hypot(x, y)
    jet = np.where(r < 0.2, 1.0, 0.5)
    river = np.where(x < 0.0, 1.0, 0.5)
    cavity = np.where(r < 0.2, 0.25, 0.5)
    block = (x < 0.0) & (np.abs(y) < 0.3) & (r > 0.2)
    hidden = {"jet": r > 9, "tube": (r >= 0.2) & (r < 0.4), "river": (np.abs(x + 0.5) < 0.1) & (y > 0.0), "cavity": block}
    for name, height in {"jet": jet, "tube": jet, "river": river, "cavity": cavity}.items():
        raw = np.where(hidden[name], np.nan, height)
        found, told = without_puddles(GRID, height, raw)
        assert (found == height).all() and np.array_equal(told, raw, equal_nan=True), name


def test_what_falls_off_a_solid_passes_in_front_of_it():
    """Over a block that ends between two columns the sheet's last point stands half a column farther, clear of its side; nothing
    moves elsewhere, nor where liquid on both sides is as high."""
    x, _ = column_centres(GRID)
    block = np.array([(a, b, c) for a in np.arange(-0.4, 0.01, 0.05) for b in np.arange(-0.7, 0.71, 0.05) for c in (0.2, 0.5)])
    height = np.where(x < 0.0, 0.6, 0.25)
    aside = overhang(GRID, height, block)
    crest = np.isclose(x, -0.05)
    np.testing.assert_allclose(aside[crest], np.broadcast_to([0.055, 0.0], (14, 2)))
    assert not aside[~crest].any() and not overhang(GRID, np.full_like(height, 0.6), block).any()
    assert not overhang(GRID, height, block[:0]).any()
    sheet = LiquidSheet(GRID)
    points, _ = sheet.mesh(height)
    before = points.copy()
    sheet.move_aside(points, aside)
    moved = (points != before).any(axis=1)
    assert (points[moved][:, 0] > 0.0).all() and (points[:, 1:] == before[:, 1:]).all()
    assert moved.sum() == 16 + 4 and np.ptp(points[:, 0]) == 2.0  # of the sheet, and of the walls before and behind
    sheet.move_aside(points, np.full((14, 20, 2), 0.01))
    for end in (np.min, np.max):
        np.testing.assert_array_equal(end(points[:, :2], axis=0), end(before[:, :2], axis=0))


# --- pixels -----------------------------------------------------------------------------------------------


def picture(path, heights, models=None, render=SIDE, raw=None, size=SIZE):
    """A pool with these heights, as floats from 0 to 1, and the view."""
    scene, models, grid = pool_scene(models)
    smooth = heights(grid)
    frames = wet_frames(models, (smooth, raw(grid) if raw else raw_of(grid, smooth, models)))
    with Trajectory(write(path, scene, models, frames, grid)) as t, Painter(t, render, size=size) as painter:
        return painter.frame(0).astype(float) / 255, painter.view(0.0)


def slab(z, y=0.3):
    """A tall white block in the pool."""
    return [box("slab", (0.6, 0.1, 0.8), (6, 1, 8), (0.0, y, z))]


def test_liquid_in_front_tints_what_is_behind(tmp_path):
    """Below the surface a block takes the liquid's colour and is still seen; above it is as it was."""
    wet, view = picture(tmp_path / "wet.h5", flat, slab(0.45))
    bare, _ = picture(tmp_path / "dry.h5", dry, slab(0.45))
    for x in (-0.2, 0.2):
        above, below = (x, 0.25, 0.7), (x, 0.25, 0.2)
        np.testing.assert_allclose(spot(wet, view, above), spot(bare, view, above), atol=0.02)
        tint = spot(wet, view, below) - spot(bare, view, below)
        assert tint[2] - tint[0] > 0.15
        # Seen still: the block's orange against the blue beside it.
        assert spot(wet, view, below)[0] > spot(wet, view, (0.8, 0.25, 0.2))[0] + 0.08


def test_deeper_is_bluer(tmp_path):
    """A block at the back wall is tinted more than one at the front wall."""
    shares = []
    for y in (-0.6, 0.6):
        image, view = picture(tmp_path / "t.h5", flat, slab(0.45, y))
        color = spot(image, view, (0.0, y - 0.05, 0.25))
        shares.append(color[2] / color[0])
    assert shares[1] > 1.5 * shares[0]


def test_waterline_is_crisp(tmp_path):
    """Down the middle of a block the colour changes within three pixels, at the height of the liquid."""
    image, view = picture(tmp_path / "t.h5", flat, slab(0.45, y=-0.62))
    ends = np.array([[0.0, -0.67, 0.8], [0.0, -0.67, 0.2]])
    (x, top), (_, low) = project(view, ends, SIZE[0] / SIZE[1])[0]
    column = round((x + 1) / 2 * SIZE[0])
    rows = [round((1 - y) / 2 * SIZE[1]) for y in (top, low)]
    red = image[rows[0] : rows[1], column, 0]
    line = int(np.abs(np.diff(red)).argmax())
    expected = (1 - project(view, np.array([[0.0, -0.67, 0.5]]), SIZE[0] / SIZE[1])[0][0][1]) / 2 * SIZE[1]
    assert rows[0] + line == pytest.approx(expected, abs=2.5)
    assert red[line - 3] - red[line + 4] > 0.1


@pytest.mark.parametrize("look", ["smooth", "cells"])
def test_nothing_is_drawn_where_it_is_dry(tmp_path, look):
    """A dam's dry side looks like the empty basin, its wet side does not."""
    models = [box("mark", (0.1, 0.1, 0.1), (1, 1, 1), (0.9, 0.6, 0.05))]
    render = replace(SIDE, liquid=look)

    def half(grid):
        return np.where(column_centres(grid)[0] < -0.4, 0.6, 0.0)

    wet, view = picture(tmp_path / "wet.h5", half, models, render)
    bare, _ = picture(tmp_path / "dry.h5", dry, models, render)
    for point in ((0.3, -0.6, 0.0), (0.6, 0.0, 0.0), (0.3, -0.7, 0.3)):
        np.testing.assert_allclose(spot(wet, view, point), spot(bare, view, point), atol=0.01)
    # Both are seen through the front wall where the dam stands.
    for point in ((-0.8, -0.7, 0.3), (-0.8, -0.5, 0.0)):
        assert np.abs(spot(wet, view, point) - spot(bare, view, point)).max() > 0.1


def test_what_falls_is_whole_beside_a_dry_place(tmp_path):
    """A column that is kept dry cuts the sheet there, and not where liquid falls off a block elsewhere."""
    block = [box("weir", (0.4, 1.4, 0.5), (4, 14, 5), (-0.2, 0.0, 0.25))]
    from_below = Render(camera=(Camera((3.0, -1.5, 1.5), (0.2, 0.0, 0.3)),))

    def fall(grid):
        return np.where(column_centres(grid)[0] < 0.0, 0.6, 0.25)

    def beside(grid):
        x, y = column_centres(grid)
        return np.where((x > 0.8) & (y > 0.5), -np.inf, fall(grid))

    wet, view = picture(tmp_path / "wet.h5", fall, block, from_below, raw=fall)
    dry, _ = picture(tmp_path / "dry.h5", fall, block, from_below, raw=beside)
    change = np.abs(wet - dry)
    assert change.max() > 0.02  # at the dry place
    for z in (0.3, 0.4, 0.5, 0.55):
        for y in (-0.5, -0.2, 0.1):
            assert spot(change, view, (0.05, y, z)).max() < 0.005, (y, z)


@pytest.mark.parametrize("look", ["smooth", "cells"])
def test_less_than_a_film_is_not_drawn(tmp_path, look):
    """A twentieth of a cell, as the filter leaves around a puddle, has no skin, whatever its colour."""
    images = []
    for color in ("#d02020", "#20d020"):
        scene, models, grid = pool_scene(color=color)
        film = dry(grid) + 0.05 * grid.cell[2]
        path = write(tmp_path / f"{color[1:]}.h5", scene, models, wet_frames(models, (film, film)), grid)
        with Trajectory(path) as t, Painter(t, Render(liquid=look), size=SIZE) as painter:
            images.append(painter.frame(0).astype(int))
    # Seen through 6 mm of liquid in a tank of 2 m: a 200th of the way that takes two thirds of the light.
    assert np.abs(images[0] - images[1]).max() <= 3


def test_cells_show_steps_and_the_sheet_does_not(tmp_path):
    """With ``liquid cells`` raw heights are drawn: a step between levels, a hole where nothing is told."""
    models = [box("mark", (0.1, 0.1, 0.1), (1, 1, 1), (0.9, 0.6, 0.95))]

    def step(grid):
        return np.where(column_centres(grid)[0] < 0, 0.6, 0.4)

    above = Render(camera=(Camera((0.0, -2.5, 3.5), (0.0, 0.0, 0.3)),))
    cells, view = picture(tmp_path / "c.h5", flat, models, replace(above, liquid="cells"), raw=step)
    level, _ = picture(tmp_path / "l.h5", flat, models, replace(above, liquid="cells"), raw=flat)
    smooth, _ = picture(tmp_path / "s.h5", flat, models, above, raw=step)
    other, _ = picture(tmp_path / "o.h5", flat, models, above, raw=flat)
    np.testing.assert_array_equal(smooth, other)
    assert (np.abs(cells - level).max(axis=2) > 0.02).mean() > 0.02

    def hole(grid):
        x, y = column_centres(grid)
        return np.where((abs(x) < 0.3) & (abs(y) < 0.3), np.nan, 0.5)

    holed, _ = picture(tmp_path / "h.h5", flat, models, replace(above, liquid="cells"), raw=hole)
    change = np.abs(holed - level)
    assert spot(change, view, (0, 0, 0.5)).max() > 0.02 and spot(change, view, (0.7, 0, 0.5)).max() == 0.0


def test_rim_is_drawn_where_liquid_meets_the_glass(tmp_path, monkeypatch):
    """The bright line runs along the front wall, but not before a block at the glass, nor on a dry floor."""
    block = [box("block", (0.4, 1.4, 0.9), (4, 14, 9), (0.0, 0.0, 0.5))]

    def half(grid):
        return np.where(column_centres(grid)[0] < 0.0, 0.5, 0.0)

    # Seen aslant, part of a line that lies behind a face by less than its own width comes out of it.
    aslant = Render(camera=(Camera((2.5, -3.5, 1.5), (0.0, 0.0, 0.45)),))
    image, view = picture(tmp_path / "t.h5", half, block, aslant)
    monkeypatch.setattr(tank, "RIM", 0.0)
    line = np.abs(image - picture(tmp_path / "t.h5", half, block, aslant)[0]).max(axis=2)

    def seen(low, high):
        """Brightest of the line in a rectangle of the front wall."""
        x, z = np.meshgrid(np.linspace(low[0], high[0], 100), np.linspace(low[1], high[1], 100))
        places, _ = project(view, np.stack([x, 0 * x - 0.7, z], axis=-1).reshape(-1, 3), SIZE[0] / SIZE[1])
        column, row = ((places * [1, -1] + 1) / 2 * SIZE).astype(int).T
        return line[row, column].max()

    assert seen((-0.9, 0.48), (-0.3, 0.52)) > 0.1
    # The step between both levels lies in the block.
    assert seen((-0.19, 0.06), (0.19, 0.94)) == 0.0
    assert seen((0.25, -0.02), (0.95, 0.1)) == 0.0


def test_objects_above_the_liquid_hide_it(tmp_path):
    """A block before the front wall, seen from the front, shows no trace of the liquid behind it."""
    front = [box("block", (0.4, 0.1, 0.4), (4, 1, 4), (0.0, -1.0, 0.25))]
    wet, _ = picture(tmp_path / "wet.h5", flat, front)
    bare, view = picture(tmp_path / "dry.h5", dry, front)
    middle = (0, -1.05, 0.25)
    np.testing.assert_allclose(spot(wet, view, middle), spot(bare, view, middle), atol=0.01)
    assert hue_mask(wet, "#e8743b").sum() > 500


def test_liquid_takes_the_scenes_colour(tmp_path):
    """Green liquid is green."""
    scene, models, grid = pool_scene(color="#208030")
    frames = wet_frames(models, (flat(grid), flat(grid)))
    path = write(tmp_path / "t.h5", scene, models, frames, grid)
    with Trajectory(path) as t, Painter(t, SIDE, size=SIZE) as painter:
        color = spot(painter.frame(0) / 255.0, painter.view(0.0), (-0.7, -0.7, 0.25))
    assert color[1] > color[0] + 0.1 and color[1] > color[2] + 0.05


def test_drops_are_balls():
    """As closed as a ball is, with outward normals, and as large to a few hundredths; those that do not fly have no size."""
    drops = Drops(5)
    rows = np.array([(0.1, 0.2, 0.3, 0.05), (1.0, -2.0, 3.0, 0.01)])
    points, normals = drops.mesh(rows)
    apart = points.reshape(5, -1, 3) - np.pad(rows, ((0, 3), (0, 0)))[:, None, :3]
    assert np.linalg.norm(apart, axis=2) == pytest.approx(np.array([0.05, 0.01, 0, 0, 0])[:, None].repeat(apart.shape[1], 1))
    assert (apart[:2] * normals.reshape(5, -1, 3)[:2]).sum(axis=2).min() > 0.0
    corners = points[drops.triangle.reshape(5, -1, 3)]
    volume = np.einsum("dti,dti->d", corners[:, :, 0], np.cross(corners[:, :, 1], corners[:, :, 2])) / 6.0
    assert volume == pytest.approx(4.0 / 3.0 * np.pi * np.array([0.05, 0.01, 0, 0, 0]) ** 3, rel=0.15)


def test_droplets_are_the_drop():
    """As much liquid, the same centre of mass, none a cell away; those of a drop move with it, those of others lie otherwise."""
    rows = np.array([(0.1, 0.2, 0.3, 0.005), (0.0, 0.1, 0.5, 0.006)], np.float32)
    found, moved = (droplets(r, 0.04).reshape(2, -1, 4) for r in (rows, rows + np.float32([0.5, 0.0, -0.25, 0.0])))
    assert (found[:, :, 3] ** 3).sum(axis=1) == pytest.approx(rows[:, 3].astype(float) ** 3)
    centre = np.einsum("dp,dpi->di", found[:, :, 3] ** 3, found[:, :, :3]) / (found[:, :, 3] ** 3).sum(axis=1)[:, None]
    np.testing.assert_allclose(centre, rows[:, :3], atol=1e-9)
    apart = found[:, :, :3] - rows[:, None, :3]
    assert 0.01 < np.abs(apart).max() < 0.04 and np.abs(apart[0] - apart[1]).max() > 0.01
    np.testing.assert_allclose(moved[:, :, :3] - found[:, :, :3], np.broadcast_to([0.5, 0.0, -0.25], apart.shape), atol=1e-6)
    assert droplets(rows[:0], 0.04).shape == (0, 4)


def test_drops_are_seen_where_they_fly(tmp_path):
    """One large drop over the pool: other pixels there, the same elsewhere; the next frame has none."""
    scene, models, grid = pool_scene()
    scene = replace(scene, liquid=replace(scene.liquid, drops=1.0))
    place = np.array([0.0, -0.5, 0.8])
    drops = [np.zeros((0, 4)), np.array([[*place, 0.04]]), np.zeros((0, 4))]
    frames = wet_frames(models, *[(flat(grid), raw_of(grid, flat(grid), models))] * 3)
    path = write(tmp_path / "t.h5", scene, models, map(with_drops, frames, drops), grid)
    with Trajectory(path) as t, Painter(t, SIDE, size=SIZE) as painter:
        without, one, after = (painter.frame(n)[:-30].astype(float) / 255 for n in range(3))  # the time stands below
        (x, y), _ = (a[0] for a in project(painter.view(1), place[None], SIZE[0] / SIZE[1]))
    changed = np.abs(one - without).max(axis=2) > 0.02
    rows, columns = np.nonzero(changed)
    assert len(rows) > 10 and np.array_equal(without, after)
    assert abs(columns.mean() - (x + 1) / 2 * SIZE[0]) < 2 and abs(rows.mean() - (1 - y) / 2 * SIZE[1]) < 2
    assert max(np.ptp(rows), np.ptp(columns)) < 12


def test_camera_holds_the_basin(tmp_path):
    """Without a camera line the whole basin is in the picture, seen from above its water."""
    scene, models, grid = pool_scene([box("crumb", (0.05,) * 3, (1,) * 3, (0.1, 0.1, 0.5))])
    frames = wet_frames(models, (flat(grid), flat(grid)))
    path = write(tmp_path / "t.h5", scene, models, frames, grid)
    with Trajectory(path) as t, Painter(t, size=SIZE) as painter:
        view = painter.view(0.0)
    corners = np.array([[(grid.low, grid.high)[k >> a & 1][a] for a in range(3)] for k in range(8)])
    places, depth = project(view, corners, SIZE[0] / SIZE[1])
    assert (depth > 0).all() and np.abs(places).max() == pytest.approx(0.88, abs=0.01)
    assert view.eye[2] > grid.high[2] * 0.9


def test_what_sinks_has_not_fallen_out_of_the_scene(tmp_path):
    """Without ground an object that goes to the basin's floor is followed, one that falls past it is not."""
    scene, models, grid = pool_scene([box("stone", (0.2,) * 3, (2,) * 3, (0.1, 0.1, 0.9))])
    for drop, escaped in ((0.8, False), (3.0, True)):
        frames = []
        for i in range(5):
            x = models[0].position - [0.0, 0.0, drop * i / 4]
            heights = {"liquid_height": flat(grid), "liquid_raw": flat(grid)}
            frames.append((10 * i, 0.1 * i, x, np.zeros_like(x), heights))
        with Trajectory(write(tmp_path / f"{drop}.h5", scene, models, frames, grid)) as t:
            assert action_of(t).escaped is escaped


def test_sky_is_seen_through_liquid_too(tmp_path):
    """From below the level the sky behind the tank has the liquid's colour, like the floor."""
    scene, models, grid = pool_scene([box("crumb", (0.05,) * 3, (1,) * 3, (0.9, 0.6, 0.05))])
    heights = flat(grid, 0.9)
    low = Render(camera=(Camera((0.0, -4.5, 0.3), (0.0, 0.0, 0.45)),))
    path = write(tmp_path / "t.h5", scene, models, wet_frames(models, (heights, heights)), grid)
    with Trajectory(path) as t, Painter(t, low, size=SIZE) as painter:
        image, view = painter.frame(0) / 255.0, painter.view(0.0)
    sky, floor = (spot(image, view, (0.3, -0.7, z)) for z in (0.6, 0.15))
    for color in (sky, floor):
        assert color[2] - color[0] > 0.25
    # Once tinted they differ by what lies behind, a tenth; a floor tinted twice by 0.17.
    np.testing.assert_allclose(sky, floor, atol=0.13)


def test_ground_does_not_hide_a_sunken_basin(tmp_path):
    """Where the ground would lie above the basin's floor it is drawn below it."""
    scene, models, grid = pool_scene()
    frames = list(wet_frames(models, (flat(grid), flat(grid))))
    images = []
    for ground in (0.0, 0.5):
        path = write(tmp_path / f"{ground}.h5", replace(scene, ground=ground), models, frames, grid)
        with Trajectory(path) as t, Painter(t, SIDE, size=SIZE) as painter:
            images.append(painter.frame(0))
    np.testing.assert_array_equal(*images)


def test_same_frame_same_picture_with_liquid(tmp_path):
    """Going to another frame and back gives the same pixels: only vertices move, and all of them."""
    scene, models, grid = pool_scene()
    frames = wet_frames(models, *[(h, raw_of(grid, h, models)) for h in (flat(grid), dam(grid))])
    with Trajectory(write(tmp_path / "t.h5", scene, models, frames, grid)) as t:
        for look in ("smooth", "cells"):
            with Painter(t, Render(liquid=look), size=SIZE) as painter:
                first, other, again = (painter.frame(i) for i in (0, 1, 0))
            np.testing.assert_array_equal(first, again)
            assert (np.abs(first.astype(int) - other).max(axis=2) > 10).mean() > 0.1


def test_movie_workers_draw_the_liquid(tmp_path):
    """Pictures from processes of their own are those drawn here, heights and all."""
    from mdanim_lammps.picture.movie import _draw_apart, _draw_here

    scene, models, grid = pool_scene(spacing=0.1)
    heights = (flat(grid), splash(grid), dam(grid))
    frames = wet_frames(models, *[(h, raw_of(grid, h, models)) for h in heights])
    with Trajectory(write(tmp_path / "t.h5", scene, models, frames, grid)) as t:
        task = (t, Render(), (160, 90), [0, 1, 2], 2)
        for here, apart in zip(_draw_here(*task), _draw_apart(*task), strict=True):
            np.testing.assert_array_equal(here, apart)
