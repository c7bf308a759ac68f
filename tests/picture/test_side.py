# SPDX-License-Identifier: GPL-2.0-only
"""Two runs beside each other in one movie: one camera, one clock, the same axes and scales."""

from __future__ import annotations

from itertools import pairwise
from types import SimpleNamespace

import imageio_ffmpeg
import numpy as np
import pytest
from mdanim_lammps import Scene, UsageError
from mdanim_lammps.picture.camera import action_of
from mdanim_lammps.picture.palette import colors_beside, object_colors
from mdanim_lammps.picture.render import Painter
from mdanim_lammps.picture.side import _painters, _together, render_side_by_side
from mdanim_lammps.scene.quantities import Asked
from mdanim_lammps.scene.render import Render
from mdanim_lammps.scene.shown import Arrows, NameTag

TEXT = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
object ball { shape sphere 10 cm  position (0, 0, 0.6) m  mass 1 kg  elasticity rigid  velocity (SPEED, 0, 0) m/s }
control { time TIME s  frames FRAMES fps  resolution 10 cm  restitution 0.5 }
"""
RENDER = Render(arrows=(Arrows("velocity"),), plot=(Asked("ball", "speed"),))


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """A slow and short throw, and a fast one with more frames."""
    folder = tmp_path_factory.mktemp("side")
    return [
        Scene.from_text(TEXT.replace("SPEED", v).replace("TIME", t).replace("FRAMES", f), name).run(folder / name)
        for name, v, t, f in (("slow", "0.5", "0.3", "20"), ("fast", "3", "0.5", "30"))
    ]


def test_a_movie_of_both(runs, tmp_path):
    """As long as the longer one, as many pictures as the quicker one has; the shorter one stands still after its end."""
    done, path, folders = [], tmp_path / "both.mp4", [run.folder for run in runs]
    render_side_by_side(*folders, RENDER, path, size=(320, 90), on_progress=lambda n, of: done.append((n, of)))
    movie = imageio_ffmpeg.read_frames(path)
    head = next(movie)
    pictures = [np.frombuffer(frame, np.uint8).reshape(90, 320, 3).astype(int) for frame in movie]
    assert head["size"] == (320, 90) and head["fps"] == 30.0 and len(pictures) == 16 and done[-1] == (16, 16)
    left = [np.abs(a[:, :150] - b[:, :150]).mean() for a, b in pairwise(pictures)]
    right = [np.abs(a[:, 170:] - b[:, 170:]).mean() for a, b in pairwise(pictures)]
    assert max(left[-4:]) < 0.3 < min(right[-4:])


def test_both_have_one_camera_one_axis_and_one_scale(runs):
    """Found from both, whichever stands left; everything of both is seen."""
    trajectories = [run.trajectory for run in runs]
    painters = _painters(trajectories, [run.folder for run in runs], RENDER, (320, 180))
    views = [painter.view(0.1) for painter in painters]
    np.testing.assert_allclose(views[0].eye, views[1].eye)
    np.testing.assert_allclose(views[0].look, views[1].look)
    (first,), (second,) = (painter._overlay._vectors for painter in painters)
    assert first.scale == second.scale
    limits = [painter._overlay._curves._curves[0][0].get_ylim() for painter in painters]
    ends = [painter._overlay._curves._curves[0][0].get_xlim() for painter in painters]
    assert limits[0] == limits[1] and limits[0][1] > 4.0 and ends[0] == ends[1] == (0.0, 0.5)
    assert [painter._name for painter in painters] == ["slow", "fast"]
    alone = Painter(trajectories[0], RENDER, size=(320, 180))
    assert not np.allclose(alone.view(0.1).eye, views[0].eye)
    for painter in (*painters, alone):
        painter.close()


def test_two_actions_are_one(runs):
    """Boxes of all objects of both, the shorter one staying as it ends."""
    a, b = (action_of(run.trajectory) for run in runs)
    both = _together(a, b)
    assert both.low.shape == (len(b.low), 2, 3) and both.free.tolist() == [True, True]
    np.testing.assert_array_equal(both.high[len(a.high) :, 0], np.tile(a.high[-1, 0], (len(b.high) - len(a.high), 1)))
    np.testing.assert_array_equal(both.bounds[1], np.maximum(a.bounds[1], b.bounds[1]))


def test_names_that_one_run_lacks_are_refused(runs, tmp_path):
    """With the way out."""
    other = Scene.from_text(TEXT.replace("ball", "cube").replace("SPEED", "1").replace("TIME", "0.1").replace("FRAMES", "20"))
    other = other.run(tmp_path / "other")
    for render, message in (
        (Render(label=(NameTag("ball", "x"),)), "which render names; take another render block by --scene"),
        (Render(plot=(Asked("ball", "speed"),)), "and ball.speed is to be shown"),
    ):
        with pytest.raises(UsageError, match=f"has no object ball, {message}"):
            render_side_by_side(runs[0].folder, other.folder, render, tmp_path / "x.mp4", size=(320, 90))


def test_names_of_groups_stand_for_their_objects(tmp_path):
    """As in a movie of one run."""
    text = "group pair { object ball { shape sphere 10 cm  position (0, 0, 0.6) m  mass 1 kg  elasticity rigid } }\n"
    text += "place pair as duo { position (0, 0, 0) m }\ncontrol { time 0.1 s  frames 20 fps  resolution 10 cm }\n"
    text += 'render { label duo "x" }\n'
    run = Scene.from_text(text, "duo").run(tmp_path / "duo")
    path = tmp_path / "both.mp4"
    render_side_by_side(run.folder, run.folder, run.scene.record.render, path, size=(320, 90))
    assert imageio_ffmpeg.count_frames_and_secs(path)[0] == 3


def test_objects_of_one_name_have_one_colour():
    """Whatever stands before them in their scene; what the first run does not have goes on where that ends."""
    first = SimpleNamespace(names=("a", "b", "wall"), colors=("", "#ff0000", ""), still=np.array([False, False, True]))
    second = SimpleNamespace(names=("new", "b", "a", "wall"), colors=("",) * 4, still=np.array([False, False, False, True]))
    a, b, wall = object_colors(first.colors, first.still).tolist()
    new, *same = colors_beside(second, first).tolist()
    assert same == [b, a, wall] and new == object_colors(("",) * 3, np.zeros(3, bool)).tolist()[2]
