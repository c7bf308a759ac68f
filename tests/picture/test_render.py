# SPDX-License-Identifier: GPL-2.0-only
"""Pictures mean what the trajectory says: objects where they are, in their colour, with a shadow below."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from mdanim_lammps.features.walls.words import Walls
from mdanim_lammps.picture import light as lighting
from mdanim_lammps.picture.floor import grid_spacing
from mdanim_lammps.picture.framing import whole
from mdanim_lammps.picture.light import nearest_around
from mdanim_lammps.picture.palette import LOW, OBJECTS, STILL, object_colors
from mdanim_lammps.picture.render import Painter
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.scene.render import Camera, Floor, Render
from mdanim_lammps.scene.scene import Control, SceneRecord
from picture_measures import hue_mask
from picture_samples import ball, box, falling, slab_scene, solid, write

SIZE = (320, 180)


def trajectory(tmp_path, models, ground=0.0, colors=None, walls=None, frames=1):
    """Models that fall on the ground; one frame shows them at the start."""
    solids = tuple(solid(m, (0, 0, 0), color) for m, color in zip(models, colors or [None] * len(models)))
    scene = SceneRecord("s", Control(1.0), solids=solids, ground=ground, walls=walls)
    return Trajectory(write(tmp_path / "t.h5", scene, models, falling(models, frames, floor=0.0)))


def picture(t, render=Render(), frame=0, size=SIZE):
    with Painter(t, render, size=size) as painter:
        return painter.frame(frame).astype(float) / 255


def pixel_of(view, point):
    """Column and row of a point in the picture."""
    from picture_measures import project

    (x, y), _ = (a[0] for a in project(view, np.array([point], dtype=float), SIZE[0] / SIZE[1]))
    return (x + 1) / 2 * SIZE[0], (1 - y) / 2 * SIZE[1]


def test_objects_are_seen_where_they_are(tmp_path):
    """A red and a green cube appear at the projections of their centres and nowhere else."""
    models = [box("red", (0.3,) * 3, (2,) * 3, (-0.5, 0, 0.5)), box("green", (0.3,) * 3, (2,) * 3, (0.5, 0, 0.2))]
    with trajectory(tmp_path, models, colors=["#d02020", "#20a020"]) as t:
        with Painter(t, size=SIZE) as painter:
            image, view = painter.frame(0) / 255.0, painter.view(0.0)
        for color, model in zip(["#d02020", "#20a020"], models):
            rows, columns = np.nonzero(hue_mask(image, color))
            column, row = pixel_of(view, model.position.mean(axis=0))
            corners = np.array([pixel_of(view, p) for p in model.position])
            assert columns.mean() == pytest.approx(column, abs=6) and rows.mean() == pytest.approx(row, abs=6)
            # A pixel and a half for the soft edge.
            assert columns.min() > corners[:, 0].min() - 1.5 and columns.max() < corners[:, 0].max() + 1.5
            assert rows.min() > corners[:, 1].min() - 1.5 and rows.max() < corners[:, 1].max() + 1.5
            assert len(rows) > 0.5 * np.ptp(corners[:, 0]) * np.ptp(corners[:, 1])


@pytest.mark.parametrize(("height", "turned"), [(5.0, 1.0), (-5.0, -1.0)])
def test_a_plan_is_seen_from_straight_above(tmp_path, height, turned):
    """And from below, through no floor: y is up, as on a map, and x is to the right, from below to the left."""
    models = [box("red", (0.3,) * 3, (2,) * 3, (-0.5, 0.4, 0.5)), box("green", (0.3,) * 3, (2,) * 3, (0.5, -0.3, 0.5))]
    camera = Render(camera=(Camera((0, 0, height), (0, 0, 0)),), floor=Floor.NONE)
    with trajectory(tmp_path, models, ground=None, colors=["#d02020", "#20a020"]) as t:
        image = picture(t, camera)
    for color, (x, y) in (("#d02020", (-0.5, 0.4)), ("#20a020", (0.5, -0.3))):
        rows, columns = np.nonzero(hue_mask(image, color))
        scale = SIZE[1] / 2 / np.tan(np.radians(15.0)) / (abs(height) - turned * 0.5)  # to the middle of each box
        assert columns.mean() == pytest.approx(SIZE[0] / 2 + turned * scale * x, abs=4)
        assert rows.mean() == pytest.approx(SIZE[1] / 2 - scale * y, abs=4)


def test_a_mesh_file_has_its_colours(tmp_path):
    """A ball painted in halves is seen so, unless its object has a colour; equal ones that are not painted stay apart."""
    models = [ball(name, 0.3, 0.1, (x, 0, 0.3), rings=24) for name, x in (("painted", -0.8), ("chosen", 0.0), ("plain", 0.8))]
    for m in models[:2]:
        skin = m.surface.vertices(m.position)
        color = np.where(skin[:, 2:] > 0.3, np.array([[208, 32, 32]]), np.array([[32, 160, 32]])).astype(np.uint8)
        object.__setattr__(m, "surface", replace(m.surface, color=color))
    with trajectory(tmp_path, models, colors=[None, "#3050d0", "#3050d0"]) as t:
        assert len(t.metadata.surfaces) == 2
        image = picture(t)
    red, green, blue = (np.nonzero(hue_mask(image, c)) for c in ("#d02020", "#20a020", "#3050d0"))
    assert min(len(red[0]), len(green[0])) > 200 and red[0].mean() < green[0].mean() - 8
    # The others are blue, and to the right.
    assert max(red[1].max(), green[1].max()) < 120 and len(blue[0]) > 1.5 * (len(red[0]) + len(green[0]))


def test_picture_has_no_holes(tmp_path):
    """Inside the outline of a box bent upward at its ends every pixel is box: no column has a gap."""
    model = box("box", (0.6, 0.4, 0.4), (6, 4, 4), (0, 0, 0.6))
    bent = model.position.copy()
    bent[:, 2] += 0.3 * bent[:, 0] ** 2
    with trajectory(tmp_path, [replace(model, position=bent)], colors=["#d02020"]) as t:
        mask = hue_mask(picture(t), "#d02020")
    columns = mask.T[mask.any(axis=0)]
    assert len(columns) > 60
    # The outermost ones run along an edge, where pixels are half background.
    for column in columns[1:-1]:
        first, last = np.flatnonzero(column)[[0, -1]]
        assert column[first : last + 1].all()


def test_shadow_lies_on_the_floor_and_on_objects(tmp_path):
    """The point straight down the lamp's ray is darker than the floor beside it, and so is a slab's top."""
    from mdanim_lammps.picture.rays import LAMP

    cube = box("cube", (0.3,) * 3, (2,) * 3, (0, 0, 0.9))
    slab = box("slab", (1.6, 1.6, 0.1), (8, 8, 1), (0, 0, 0.15), held=np.ones(9 * 9 * 2, bool))
    for models, height in (([cube], 0.0), ([slab, cube], 0.2)):
        # Seen from above the camera looks past the cube, which would hide its own shadow.
        render = Render(camera=(Camera((0.0, -4.0, 2.5), (0.0, 0.0, 0.3)),))
        with trajectory(tmp_path, models) as t, Painter(t, render, size=SIZE) as painter:
            image = painter.frame(0).astype(float).sum(axis=2)
            view = painter.view(0.0)
        below = np.array([0, 0, 0.9]) - LAMP * (0.9 - height) / LAMP[2]

        def brightness(point):
            column, row = (round(c) for c in pixel_of(view, point))
            return np.median(image[row - 1 : row + 2, column - 1 : column + 2])

        assert brightness(below) < 0.85 * brightness([-0.55, below[1], height])


def test_nothing_shades_itself(tmp_path):
    """The lit top of a slab is even: no stripes from the lamp's depth picture."""
    slab = box("slab", (1.6, 1.6, 0.1), (8, 8, 1), (0, 0, 0.15))
    with trajectory(tmp_path, [slab]) as t, Painter(t, size=SIZE) as painter:
        image, view = painter.frame(0).astype(float), painter.view(0.0)
    spots = [pixel_of(view, (x, y, 0.2)) for x in np.linspace(-0.6, 0.6, 15) for y in np.linspace(-0.6, 0.6, 15)]
    values = np.array([image[int(row), int(column)].sum() for column, row in spots])
    assert np.ptp(values) < 0.04 * values.mean()


def test_shadows_are_the_same_without_the_short_cut(tmp_path, monkeypatch):
    """Where nothing is near between a point and the lamp no shadow is counted out; that changes no pixel."""
    scene, models = slab_scene()
    with Trajectory(write(tmp_path / "t.h5", scene, models, falling(models, 2))) as t:
        quick = picture(t, frame=1)
        always = lambda depth, block: np.zeros((depth.shape[0] // block, depth.shape[1] // block))
        monkeypatch.setattr(lighting, "nearest_around", always)
        np.testing.assert_array_equal(picture(t, frame=1), quick)
        # All of the lamp's picture, where only the part with something in it is drawn.
        monkeypatch.setattr(lighting.Light, "_part", lambda light, points: whole((light._pixels, light._pixels)))
        assert abs(picture(t, frame=1).astype(int) - quick).max() <= 2


def test_nearest_around_is_that_of_nine_blocks():
    """The least depth of a block and its neighbours, at the edges of those that there are."""
    depth = np.ones((64, 48))
    depth[17, 40], depth[63, 0], depth[31, 15] = 0.5, 0.2, 0.7
    expected = np.ones((4, 3))
    expected[0:3, 0:2] = 0.7
    expected[0:3, 1:3] = 0.5
    expected[2:4, 0:2] = 0.2
    np.testing.assert_array_equal(nearest_around(depth, 16), expected)


def test_a_ball_darkens_evenly(tmp_path):
    """From where the lamp stands overhead to where it grazes, a ball grows darker without stripes."""
    from mdanim_lammps.picture.rays import LAMP

    models = [ball("ball", 0.5, 0.125, (0, 0, 0.5), rings=48)]
    with trajectory(tmp_path, models) as t, Painter(t, size=SIZE) as painter:
        image, view = painter.frame(0).astype(float).sum(axis=2), painter.view(0.0)
    toward = (view.eye - [0, 0, 0.5]) / np.linalg.norm(view.eye - [0, 0, 0.5])
    across = np.cross(LAMP, toward)
    across = np.cross(across / np.linalg.norm(across), LAMP)
    angles = np.radians(np.arange(50.0, 86.0, 1.0))
    line = [pixel_of(view, [0, 0, 0.5] + 0.5 * (np.cos(a) * LAMP + np.sin(a) * across)) for a in angles]
    values = np.array([image[int(row), int(column)] for column, row in line])
    # Three channels, each rounded: two levels up are rounding, more are stripes.
    assert np.diff(values).max() < 6 and values[0] > values[-1] + 60


@pytest.mark.parametrize("ground", [0.0, None])
def test_floor_has_a_grid(tmp_path, ground):
    """With or without ground there is a floor with lines, so that depth reads."""
    with trajectory(tmp_path, [box("box", (0.3,) * 3, (2,) * 3, (0, 0, 0.15))], ground=ground) as t:
        image = picture(t)
    # A strip beside the box and its shadow: lines cross it, and nothing else does.
    row = image[110, :80].mean(axis=1)
    assert (np.diff(row) < -0.01).sum() >= 3 and row.max() - row.min() < 0.3


def test_walls_are_drawn(tmp_path):
    """Walls appear as faint edges."""
    model = box("box", (0.3,) * 3, (2,) * 3, (0, 0, 0.3))
    render = Render(camera=(Camera((0.0, -4.0, 2.0), (0.0, 0.0, 0.4)),))
    with trajectory(tmp_path, [model]) as t:
        without = picture(t, render)
    with trajectory(tmp_path, [model], walls=Walls((-0.5, -0.5, 0.0), (0.5, 0.5, 1.0))) as t:
        changed = np.abs(picture(t, render) - without).max(axis=2) > 0.05
    # Twelve thin edges: more than their length in pixels, far less than an area.
    assert 200 < changed.sum() < 0.06 * changed.size


def test_background_can_be_chosen(tmp_path):
    """The sky takes the scene's colour, and writing on a dark one is light."""
    models = [box("box", (0.3,) * 3, (2,) * 3, (0, 0, 0.3))]
    with trajectory(tmp_path, models) as t:
        dark, light = picture(t, Render(background="#101820")), picture(t)
    assert dark[2].mean() < 0.2 and light[2].mean() > 0.9
    stamp = np.s_[165:178, 270:315]
    assert dark[stamp].max() > 0.5 and light[stamp].min() < 0.6


def test_same_frame_same_picture(tmp_path):
    """A frame looks the same whatever was drawn before it, on another painter too: no flicker at joins."""
    scene, models = slab_scene()
    with Trajectory(write(tmp_path / "t.h5", scene, models, falling(models, 4))) as t:
        with Painter(t, size=SIZE) as painter:
            first = painter.frame(2)
            painter.frame(3)
            again = painter.frame(2)
        with Painter(t, size=SIZE) as other:
            fresh = other.frame(2)
        assert (first != painter.trajectory.position(0).sum()).any()
        np.testing.assert_array_equal(first, again)
        np.testing.assert_array_equal(first, fresh)


def test_frames_differ_where_things_move(tmp_path):
    """A falling cube changes the picture."""
    scene, models = slab_scene()
    with Trajectory(write(tmp_path / "t.h5", scene, models, falling(models, 4))) as t, Painter(t, size=SIZE) as painter:
        change = np.abs(painter.frame(0).astype(int) - painter.frame(3)).max(axis=2)
    assert (change > 40).mean() > 0.02


def test_colours_are_settled_by_index():
    """Held objects are grey, chosen colours stay, the others take the palette in turn."""
    colors = object_colors(["", "", "#010203", ""], np.array([True, False, False, False]))
    assert colors.tolist() == [[int(c[i : i + 2], 16) for i in (1, 3, 5)] for c in (STILL, OBJECTS[0], "#010203", OBJECTS[2])]
    assert len({*OBJECTS, STILL, LOW}) == len(OBJECTS) + 2


@pytest.mark.parametrize(("size", "spacing"), [(12.0, 1.0), (1.2, 0.1), (20.0, 2.0), (70.0, 5.0), (110.0, 10.0)])
def test_grid_spacing_is_a_round_number(size, spacing):
    """1, 2 or 5 times a power of ten."""
    assert grid_spacing(size) == pytest.approx(spacing)
