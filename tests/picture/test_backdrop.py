# SPDX-License-Identifier: GPL-2.0-only
"""Floor and background are drawn by themselves, and of all else only the part of a picture in which it is."""

from __future__ import annotations

import numpy as np
import pytest
from mdanim_lammps.picture import backdrop, render
from mdanim_lammps.picture.floor import FloorShade
from mdanim_lammps.picture.framing import part_around, whole
from mdanim_lammps.picture.render import Painter
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.scene.render import Camera, Render
from mdanim_lammps.scene.scene import Control, SceneRecord
from picture_measures import hue_mask
from picture_samples import ball, box, falling, solid, write

SIZE = (320, 180)
ABOVE = Render(camera=(Camera((1.5, -2.5, 1.2), (0.0, 0.0, 0.2)),))


def run(tmp_path, models, frames=1, colors=None):
    solids = tuple(solid(m, (0, 0, 0), color) for m, color in zip(models, colors or [None] * len(models)))
    scene = SceneRecord("s", Control(1.0), solids=solids, ground=0.0)
    return Trajectory(write(tmp_path / "t.h5", scene, models, falling(models, frames, floor=-1.0)))


MOVING = Render(camera=(*ABOVE.camera, Camera((1.0, -3.0, 1.0), (0.0, 0.0, 0.2), 1.0)))


@pytest.mark.parametrize("look", [Render(), ABOVE, MOVING], ids=["chosen", "still", "moving"])
def test_a_part_has_the_pixels_of_the_whole(tmp_path, monkeypatch, look):
    """Drawn in a window of its own size, to the last bit of a colour but for what rounding moves across an edge."""
    models = [box("b", (0.3, 0.4, 0.5), (2,) * 3, (0.2, 0, 0.6)), ball("o", 0.2, 0.1, (-0.4, 0.1, 0.3))]
    with run(tmp_path, models, frames=3) as t:
        with Painter(t, look, size=SIZE) as painter:
            parts = [painter.frame(k).astype(int) for k in (2, 0, 1)]
        for module in (backdrop, render):
            monkeypatch.setattr(module, "part_around", lambda view, size, points: whole(size))
        with Painter(t, look, size=SIZE) as painter:
            wholes = [painter.frame(k).astype(int) for k in (2, 0, 1)]
    for part, all_of_it in zip(parts, wholes):
        off = abs(part - all_of_it).max(axis=2)
        assert np.ptp(all_of_it) > 100 and np.count_nonzero(off > 1) < 10


@pytest.mark.parametrize(("height", "seen"), [(-0.25, 0.0), (0.0, 0.6), (0.3, 1.0)])
def test_the_floor_hides_what_is_below_it(tmp_path, height, seen):
    """A cube of which all, half or nothing is below the ground, which is drawn in another window."""
    cube = box("c", (0.4,) * 3, (2,) * 3, (0, 0, height))
    above = box("c", (0.4,) * 3, (2,) * 3, (0, 0, 0.3))
    counts = []
    for model in (cube, above):
        with run(tmp_path, [model], colors=["#d02020"]) as t, Painter(t, ABOVE, size=SIZE) as painter:
            counts.append(np.count_nonzero(hue_mask(painter.frame(0) / 255.0, "#d02020")))
    # Sides and top have about the same share of what is seen of a cube, and half of the sides is hidden.
    assert counts[0] / counts[1] == pytest.approx(seen, abs=0.05 if 0.0 < seen < 1.0 else 0.01)


def test_light_on_a_floor_is_the_mean_over_four_pixels():
    """Each number is the share of free pixels from two before it on; what lies below the floor shades nothing."""
    random, pixels, block = np.random.default_rng(3), 64, 16
    matrix = np.eye(4)
    matrix[2] = [0.1, 0.2, -0.5, 0.8]  # depth falls with the height
    shade = FloorShade(0.4)
    depth = np.where(random.random((pixels, pixels)) < 0.1, random.uniform(0.4, 1.0, (pixels, pixels)), 1.0).astype(np.float32)
    depth[:, :20] = 1.0
    nearest = depth.reshape(4, block, 4, block).min(axis=(1, 3))
    nearest = np.array([[nearest[max(0, i - 1) : i + 2, max(0, j - 1) : j + 2].min() for j in range(4)] for i in range(4)])
    y, x = (np.indices(depth.shape) + 0.5) / pixels
    hides = (depth < 1.0) & (depth <= 0.1 * x + 0.2 * y - 0.5 * 0.4 + 0.8)
    wide = np.pad(hides, 2)
    share = np.mean([wide[i : i + pixels, j : j + pixels] for i in range(4) for j in range(4)], axis=0)
    for _ in range(2):  # twice: what the first call left is gone
        shade.cast(depth, nearest, matrix)
        inside = (slice(2, -2), slice(2, -2))
        np.testing.assert_array_equal(shade._seen[inside], np.rint(255 * (1 - share)).astype(np.uint8)[inside])
    assert hides.any() and (depth < 1.0).sum() > hides.sum()
    shade.cast(np.ones_like(depth), np.ones_like(nearest), matrix)
    assert (shade._seen == 255).all() and not len(shade.corners)


def test_a_part_is_around_what_is_seen(tmp_path):
    """Places beside the picture are cut off, one behind the eye asks for all of it, none for nothing."""
    with run(tmp_path, [box("c", (0.4,) * 3, (2,) * 3, (0, 0, 0.3))]) as t, Painter(t, ABOVE, size=SIZE) as painter:
        view = painter.view(0.0)
    middle = part_around(view, SIZE, view.look[None], around=0)
    assert abs(np.array([middle.left, middle.bottom, middle.right, middle.top]) - [160, 90, 160, 90]).max() <= 1
    assert part_around(view, SIZE, np.array([view.look, 2 * view.eye - view.look])) == whole(SIZE)
    assert part_around(view, SIZE, np.zeros((0, 3))).size == (0, 0)
    away = part_around(view, SIZE, view.look + [[50.0, 50.0, 0.0]])
    assert 0 in away.size
