# SPDX-License-Identifier: GPL-2.0-only
"""Frames are read as soon as they are written, and only where they are whole."""

import os
from contextlib import nullcontext
from pathlib import Path

import h5py
import numpy as np
import pytest
from mdanim_lammps import Trajectory
from mdanim_lammps.errors import OutputError
from mdanim_lammps.results.trajectory_file import FrameTable, part_of
from mdanim_lammps.results.trajectory_writer import TrajectoryWriter
from mdanim_lammps.results.untrusted import check_frames
from mdanim_lammps.view.feed import Feed
from picture_samples import flat, pool_scene, raw_of, wet_frames, write

FRAMES = 4


@pytest.fixture(scope="module")
def pool():
    """A scene with a liquid, its models, frames and grid."""
    scene, models, grid = pool_scene()
    levels = [flat(grid, 0.4 + 0.05 * k) for k in range(FRAMES)]
    return scene, models, list(wet_frames(models, *((level, raw_of(grid, level, models)) for level in levels))), grid


def test_frames_are_read_before_they_are_on_the_disk(tmp_path, pool):
    """A frame that is written and not flushed is there to the bit, also once the file is renamed; others are refused."""
    scene, models, frames, grid = pool
    path = tmp_path / "trajectory.h5"
    with TrajectoryWriter(path, scene, models, frames=FRAMES, dt=0.01, steps_per_frame=10, grid=grid) as out:
        out.write(*frames[0])
        out.write(*frames[1])
        early = Trajectory(tmp_path).frames
        assert early.total == FRAMES and early.on_disk() == 0
        seen = [{name: early.value(name, n) for name in ("position", "velocity", "center_of_mass", "liquid/raw")} for n in (0, 1)]
        assert early.time(1) == frames[1][1]
        with pytest.raises(OutputError, match="frame 2 is damaged or not there"):
            early.value("position", 2)
        for bad in (-1, FRAMES):
            with pytest.raises(IndexError):
                early.value("position", bad)
        out.write(*frames[2])
        out.write(*frames[3])
    assert early.is_at(path) and not early.is_at(part_of(path)) and early.on_disk() == FRAMES
    with Trajectory(path) as whole:
        for n in (0, 1):
            np.testing.assert_array_equal(seen[n]["position"], whole.position(n))
            np.testing.assert_array_equal(seen[n]["velocity"], whole.velocity(n))
            np.testing.assert_array_equal(seen[n]["center_of_mass"], whole.centers[n])
            np.testing.assert_array_equal(seen[n]["liquid/raw"], whole.liquid_raw(n))
        np.testing.assert_array_equal(early.value("position", 3), whole.position(3))


def test_a_damaged_frame_is_refused(tmp_path, pool):
    """One bit that has changed on the disk is noticed; other frames are read."""
    scene, models, frames, grid = pool
    path = write(tmp_path / "trajectory.h5", scene, models, frames, grid)
    with h5py.File(path) as file:
        value = file["particles/all/position/value"]
        place = value.id.get_offset() + 2 * value[0].nbytes + 5
    with open(path, "r+b") as file:
        byte = os.pread(file.fileno(), 1, place)[0]
        os.pwrite(file.fileno(), bytes([byte ^ 1]), place)
    with Trajectory(tmp_path) as whole:
        found = whole.frames
        with pytest.raises(OutputError, match=r"frame 2 .* position"):
            found.value("position", 2)
        found.value("position", 1)
        found.value("velocity", 2)


def test_older_formats_are_refused(tmp_path, pool):
    """A file without checksums is named, with a way out."""
    scene, models, frames, grid = pool
    with h5py.File(write(tmp_path / "trajectory.h5", scene, models, frames, grid), "r+") as file:
        del file["parameters/mdanim/checksum"]
        file["parameters/mdanim"].attrs["format"] = 2
    with pytest.raises(OutputError, match="mdanim-lammps render"):
        Feed(tmp_path)


def test_tables_of_older_formats_do_not_lie_in_one_piece(tmp_path, pool):
    """Formats 1 and 2 were written in chunks, without checksums: they are read, only not while their run goes on."""
    scene, models, frames, grid = pool
    path = write(tmp_path / "trajectory.h5", scene, models, frames, grid)
    with h5py.File(path, "r+") as file:
        names = []
        file.visititems(lambda name, found: names.append(name) if name.endswith("/value") else None)
        for name in names:
            values, units = file[name][:], dict(file[name].attrs)
            del file[name]
            file.create_dataset(name, data=values, chunks=(1, *values.shape[1:])).attrs.update(units)
        del file["parameters/mdanim/checksum"]
        file["parameters/mdanim"].attrs["format"] = 2
    with Trajectory(path) as whole:
        assert len(whole) == FRAMES
        for n in (0, 3):
            np.testing.assert_array_equal(whole.position(n), frames[n][2])
            np.testing.assert_array_equal(whole.objects[whole.names[-1]].position(n), whole.position(n)[-len(models[-1].mass) :])
            assert np.isfinite(whole.liquid_height(n)).all()
        assert whole.centers.shape == (FRAMES, len(models), 3)
        np.testing.assert_array_equal(whole.universe.trajectory[2].positions, frames[2][2].astype(np.float32))


def test_a_closed_file_is_not_read(tmp_path, pool):
    """Its number may be that of another file by then."""
    scene, models, frames, grid = pool
    whole = Trajectory(write(tmp_path / "trajectory.h5", scene, models, frames, grid))
    whole.position(0)
    whole.close()
    with open(tmp_path / "other", "wb+") as other:
        other.truncate(1 << 20)
        with pytest.raises(OutputError, match="was closed"):
            whole.objects[whole.names[0]].position(0)


def test_what_is_read_may_be_changed(tmp_path, pool):
    """Arrays are the caller's own."""
    scene, models, frames, grid = pool
    with Trajectory(write(tmp_path / "trajectory.h5", scene, models, frames, grid)) as whole:
        whole.position(1)[:] = 0.0
        np.testing.assert_array_equal(whole.position(1), frames[1][2])
        np.testing.assert_array_equal(
            whole.objects[whole.names[-1]].position(1), frames[1][2][whole.objects[whole.names[-1]].particles]
        )


@pytest.mark.parametrize(
    ("name", "dtype", "damaged"), [("fields/hits", "i4", False), ("fields/hits", "S3", True), ("position", "i4", True)]
)
def test_fields_of_effects_may_be_whole_numbers(name, dtype, damaged):
    """Positions and the like are floats; a field may hold any kind of number."""
    table = FrameTable(1, np.dtype(dtype), (2,), 3)
    with pytest.raises(OutputError, match=f"damaged: {name} holds") if damaged else nullcontext():
        check_frames(Path("x"), {name: (2,)}, {name: table}, np.arange(3), np.arange(3.0))
