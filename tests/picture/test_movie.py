# SPDX-License-Identifier: GPL-2.0-only
"""Movies: every frame once, as long as the simulated time, whole or not there."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mdanim_lammps.children import Workers
from mdanim_lammps.errors import OutputError, SetupError, UsageError
from mdanim_lammps.picture import movie
from mdanim_lammps.picture.movie import movie_frames, render_movie, render_still
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.results.trajectory_writer import TrajectoryWriter
from mdanim_lammps.scene.render import Camera, Quality, Render
from picture_samples import falling, read_png, slab_scene, write

SMALL = Render(size=(160, 90))


@pytest.fixture
def short(tmp_path):
    """Six frames, ten a second."""
    scene, models = slab_scene()
    (tmp_path / "run").mkdir()
    with Trajectory(write(tmp_path / "run" / "trajectory.h5", scene, models, falling(models, 6))) as t:
        yield t


def read_movie(path, size):
    """Pictures of a movie, uint8, shape (F, height, width, 3), and its pictures per second."""
    import imageio_ffmpeg

    reader = imageio_ffmpeg.read_frames(str(path))
    about = next(reader)
    assert tuple(about["size"]) == size and about["codec"] == "h264" and "yuv420p" in about["pix_fmt"]
    return np.array([np.frombuffer(f, np.uint8).reshape(size[1], size[0], 3) for f in reader]), about["fps"]


@pytest.mark.parametrize(("processes", "quality"), [(1, Quality.DRAFT), (2, Quality.FINAL)])
def test_movie_shows_every_frame_in_turn(short, tmp_path, processes, quality):
    """Frames of the movie are the stills of the trajectory, in order, at its rate, on one process or two."""
    seen, render = [], replace(SMALL, quality=quality)
    path = render_movie(
        short,
        render,
        tmp_path / "movie.mp4",
        processes=processes,
        frames=tmp_path / "frames",
        on_progress=lambda done, total: seen.append((done, total)),
    )
    pictures, fps = read_movie(path, (160, 90))
    assert len(pictures) == 6 and fps == 10
    assert seen == [(k, 6) for k in range(1, 7)]
    assert sorted(os.listdir(tmp_path / "frames")) == [f"frame-{k:05d}.png" for k in range(6)]
    stills = [read_png(tmp_path / "frames" / f"frame-{k:05d}.png") for k in range(6)]
    distance = [[np.abs(p.astype(float) - s).mean() for s in stills] for p in pictures]
    assert np.argmin(distance, axis=1).tolist() == list(range(6))
    assert np.diag(distance).max() < 3.0  # of 255: what the coding loses
    np.testing.assert_array_equal(stills[4], read_png(render_still(short, 4, tmp_path / "s.png", render)))


@pytest.mark.parametrize(
    ("speed", "fps", "frames", "rate"),
    [
        pytest.param(0.5, None, [0, 1, 2, 3, 4, 5], 5, id="slow motion has every frame"),
        pytest.param(0.5, 10.0, [0, 0, 1, 2, 2, 2, 3, 4, 4, 4, 5], 10, id="the nearest at another rate"),
        pytest.param(20.0, None, [0, 3], 60, id="a time lapse leaves frames out"),
    ],
)
def test_frames_of_another_speed(short, speed, fps, frames, rate):
    """Slow motion shows frames longer, a time lapse has no more pictures a second than a film needs."""
    shown, found = movie_frames(short, fps, speed)
    assert (shown.tolist(), found) == (frames, rate)


def test_lasts_as_long_as_it_shows(short, tmp_path):
    """Another rate shows more or fewer pictures in the same time."""
    for fps, expected in ((20.0, 11), (4.0, 3)):
        render_movie(short, SMALL, tmp_path / "movie.mp4", fps=fps)
        pictures, rate = read_movie(tmp_path / "movie.mp4", (160, 90))
        assert (len(pictures), rate) == (expected, fps)


@pytest.mark.parametrize(
    ("fps", "frames"),
    [
        pytest.param(None, [0, 1, 2, 3, 4, 5], id="all"),
        pytest.param(10.0, [0, 1, 2, 3, 4, 5], id="its own rate"),
        pytest.param(5.0, [0, 2, 4], id="every other; the end is not a multiple"),
        pytest.param(6.0, [0, 2, 3, 5], id="the nearest"),
        pytest.param(2.0, [0, 5], id="the last one, in spite of rounding"),
    ],
)
def test_frames_of_another_rate(short, fps, frames):
    """The frames nearest in time are shown."""
    assert movie_frames(short, fps)[0].tolist() == frames


def test_odd_sizes_become_even(short, tmp_path):
    """H.264 wants even sizes; an odd one grows by one."""
    render_movie(short, SMALL, tmp_path / "movie.mp4", size=(161, 91), fps=2.0)
    assert len(read_movie(tmp_path / "movie.mp4", (162, 92))[0]) == 2


def test_folder_is_enough(short, tmp_path):
    """A run's folder may stand for its trajectory."""
    render_movie(tmp_path / "run", SMALL, tmp_path / "movie.mp4", fps=2.0)
    assert (tmp_path / "movie.mp4").stat().st_size > 500


def test_unfinished_movie_leaves_nothing(short, tmp_path):
    """Interrupted in the middle: no movie, no part of one, and an older movie is still there."""
    (tmp_path / "movie.mp4").write_text("older")

    def interrupt(done, total):
        if done == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        render_movie(short, SMALL, tmp_path / "movie.mp4", processes=2, on_progress=interrupt)
    assert sorted(os.listdir(tmp_path)) == ["movie.mp4", "run"]
    assert (tmp_path / "movie.mp4").read_text() == "older"


def test_where_it_cannot_be_written(short, tmp_path):
    """A file in the place of a folder is an OutputError that names it."""
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match=r"file/movie\.mp4"):
        render_movie(short, SMALL, tmp_path / "file" / "movie.mp4")
    with pytest.raises(OutputError, match=r"file/still\.png"):
        render_still(short, 0, tmp_path / "file" / "still.png", SMALL)
    with pytest.raises(OutputError, match="6 frames, there is no frame 6"):
        render_still(short, 6, tmp_path / "still.png", SMALL)


def test_failing_encoder_is_named(short, tmp_path, monkeypatch):
    """The message of ffmpeg is the cause; without ffmpeg the cure is printed."""
    fake = tmp_path / "ffmpeg"
    fake.write_text("#!/bin/sh\necho 'No space left on device' >&2\nexit 1\n")
    fake.chmod(0o755)
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", str(fake))
    with pytest.raises(OutputError, match="No space left on device; make room"):
        render_movie(short, SMALL, tmp_path / "movie.mp4")
    assert not list(Path(tmp_path).glob("movie*"))

    def missing():
        raise RuntimeError("no ffmpeg exe")

    monkeypatch.setattr("imageio_ffmpeg.get_ffmpeg_exe", missing)
    with pytest.raises(SetupError, match="pip install imageio-ffmpeg"):
        render_movie(short, SMALL, tmp_path / "movie.mp4")


def test_killed_process_is_named(short, tmp_path, monkeypatch):
    """A process that draws and is killed ends the movie with an error, and nothing is left of it."""
    drawing = []

    class Watched(Workers):
        def __init__(self, *args, **kwargs):
            super().__init__(*args, **kwargs)
            drawing.extend(self.children)

    monkeypatch.setattr(movie, "Workers", Watched)

    def kill(done, total):
        for child in drawing:
            child.kill()

    with pytest.raises(SetupError, match=r"a process that draws pictures was killed.*render again"):
        render_movie(short, SMALL, tmp_path / "movie.mp4", processes=2, fps=1000.0, on_progress=kill)
    assert sorted(os.listdir(tmp_path)) == ["run"]


def test_a_failing_painter_is_named(short, tmp_path, monkeypatch):
    """An error of a process that draws is reported as by one process."""
    with pytest.raises(UsageError, match="looks at 'nobody'"):
        render_movie(short, Render(camera=(Camera((0, 0, 1), "nobody"),), size=(160, 90)), tmp_path / "movie.mp4", processes=2)


def test_a_script_without_a_guard_may_draw(short, tmp_path):
    """Processes that draw do not run the user's script again, which would simulate again."""
    script = tmp_path / "draw.py"
    script.write_text(
        "print('begun', flush=True)\n"
        "from mdanim_lammps.picture.movie import render_movie\n"
        "from mdanim_lammps.scene.render import Render\n"
        f"render_movie({str(tmp_path / 'run')!r}, Render(size=(160, 90)), {str(tmp_path / 'movie.mp4')!r}, processes=2)\n"
    )
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=100)
    assert (done.returncode, done.stdout) == (0, "begun\n"), done.stderr
    assert (tmp_path / "movie.mp4").exists()


@pytest.mark.parametrize("fps", [0.0004, 1e-5, 29.97, 30.0])
def test_slow_movies_have_a_rate(fps):
    """No rate is rounded to 0, nor by more than a thousandth."""
    assert float(movie.movie_rate(fps)) == pytest.approx(fps, rel=1e-3)


def test_no_frames_no_movie(tmp_path):
    """A run that ended before its first frame has nothing to show."""
    scene, models = slab_scene()
    TrajectoryWriter(tmp_path / "trajectory.h5", scene, models, frames=1, dt=0.01, steps_per_frame=10).close(finished=False)
    with pytest.raises(OutputError, match="holds no frame"):
        render_movie(tmp_path, SMALL, tmp_path / "movie.mp4")
