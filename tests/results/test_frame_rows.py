# SPDX-License-Identifier: GPL-2.0-only
"""Rows that several processes write make the file that one would have written."""

import os
from dataclasses import replace

import numpy as np
import pytest
from mdanim_lammps.errors import OutputError
from mdanim_lammps.model.system import centers
from mdanim_lammps.results.frame_rows import RowWriter
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.results.trajectory_writer import TrajectoryWriter
from mdanim_lammps.scene.scene import Save
from picture_samples import falling, slab_scene, write

FRAMES = 4


@pytest.fixture(scope="module")
def slab():
    scene, models = slab_scene()
    return scene, models, list(falling(models, FRAMES))


def begun(path, scene, models):
    return TrajectoryWriter(path, scene, models, frames=FRAMES, dt=0.01, steps_per_frame=10)


def means(models, values):
    size = np.array([len(m.position) for m in models])
    return centers(np.concatenate([m.mass for m in models]), np.cumsum(size) - size, values)


def add(out, models, frame, checksums) -> None:
    step, time, position, velocity = frame
    out.add(step, time, checksums, means(models, position), means(models, velocity))


@pytest.mark.parametrize("save", list(Save))
@pytest.mark.parametrize("single", [False, True])
@pytest.mark.parametrize("writers", [1, 2, 5])
def test_rows_of_several_writers(slab, tmp_path, save, single, writers):
    """Each writes stretches that no object's borders matter to, others in every frame, and none reads what is not its own."""
    scene, models, frames = slab
    scene = replace(scene, control=replace(scene.control, save=save, single=single))
    whole = write(tmp_path / "whole.h5", scene, models, frames)
    rng, total = np.random.default_rng(writers), len(frames[0][2])
    with begun(tmp_path / "parts.h5", scene, models) as out:
        rows = [RowWriter(out.rows) for _ in range(writers)]
        for n, frame in enumerate(frames):
            edges = [0, *np.sort(rng.integers(0, total + 1, 9)).tolist(), total]
            owner = rng.integers(0, writers, 10)
            checksums = np.zeros(2, np.uint32)
            for w in rng.permutation(writers).tolist():
                places = [slice(a, b) for a, b, o in zip(edges, edges[1:], owner) if o == w][::-1]
                mine = [np.full_like(values, np.nan) for values in frame[2:]]
                for values, own in zip(frame[2:], mine):
                    for place in places:
                        own[place] = values[place]
                checksums ^= rows[w].write(n, places, *mine)
            add(out, models, frame, checksums)
        out.flush()
        for writer in rows:
            writer.close()
            writer.close()
        parts = out.close()
    assert parts.read_bytes() == whole.read_bytes()
    with Trajectory(parts) as t:
        for n in range(FRAMES):
            t.check(n)


def test_rows_that_are_missing_are_damage(slab, tmp_path):
    """A frame of which a writer has written too little is not taken for a whole one."""
    scene, models, frames = slab
    out = begun(tmp_path / "t.h5", scene, models)
    writer, total = RowWriter(out.rows), len(frames[0][2])
    add(out, models, frames[0], writer.write(0, [slice(0, total - 1)], *frames[0][2:]))
    writer.close()
    out.close(finished=False)
    with Trajectory(tmp_path / "t.h5") as t, pytest.raises(OutputError, match="frame 0 is damaged"):
        t.check(0)


def test_a_frame_that_is_given_up_does_no_harm(slab, tmp_path):
    """Rows without a step: the file ends before them, and the frame is written again by the one that goes on."""
    scene, models, frames = slab
    path = tmp_path / "t.h5"
    out = begun(path, scene, models)
    out.write(*frames[0])
    out.write(*frames[1])
    ahead = RowWriter(out.rows)
    ahead.write(2, [slice(0, len(frames[0][2]))], -frames[2][2], frames[2][3])
    ahead.close()
    out.close(finished=False)
    with Trajectory(path) as t:
        assert len(t) == 2
    with TrajectoryWriter.append(path, scene, models, after_step=frames[1][0]) as out:
        for frame in frames[2:]:
            out.write(*frame)
        out.flush()
    assert path.read_bytes() == write(tmp_path / "whole.h5", scene, models, frames).read_bytes()


def test_a_file_that_is_not_there(slab, tmp_path):
    """On a host that does not see the output folder, the message says what is wanted."""
    scene, models, _ = slab
    out = begun(tmp_path / "t.h5", scene, models)
    with pytest.raises(OutputError, match=r"elsewhere/t.h5.part: cannot be opened on .*file system that all hosts share"):
        RowWriter(replace(out.rows, path=tmp_path / "elsewhere" / "t.h5.part"))
    (tmp_path / "local").mkdir()
    (tmp_path / "local" / "t.h5.part").write_bytes(out.rows.path.read_bytes())
    with pytest.raises(OutputError, match=r"another file than on the first host.*file system that all hosts share"):
        RowWriter(replace(out.rows, path=tmp_path / "local" / "t.h5.part"))
    out.close(finished=False)


def test_a_disk_takes_little_at_a_time(slab, tmp_path, monkeypatch):
    """Writes that end early are continued."""
    scene, models, frames = slab
    whole = write(tmp_path / "whole.h5", scene, models, frames)
    pwrite = os.pwrite
    monkeypatch.setattr(os, "pwrite", lambda file, data, offset: pwrite(file, data[:1000], offset))
    assert write(tmp_path / "pieces.h5", scene, models, frames).read_bytes() == whole.read_bytes()
