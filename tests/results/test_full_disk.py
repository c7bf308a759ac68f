# SPDX-License-Identifier: GPL-2.0-only
"""A disk that becomes full: one message, code 7, and a run that goes on to the same bits where there is room."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from campaign import rounds
from mdanim_lammps.results.compare import compare

SCENE = """
gravity (0, 0, -9.81) m/s^2
ground z 0
object box { shape box (20, 20, 20) cm  position (0, 0, 0.2) m  mass 8 kg  elasticity 100 kPa }
control { time 1 s  frames 200 fps  resolution 2 cm }
"""

FAILING = """
import errno, os
whole, calls = os.pwrite, []
def pwrite(file, data, offset):
    calls.append(1)
    if len(calls) > {calls}:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    return whole(file, data, offset)
os.pwrite = pwrite
"""
"""A disk that is full from some call on; put into sitecustomize.py."""

SMALL = """
import errno, os
whole, room = os.pwrite, {room}
def pwrite(file, data, offset):
    global room
    room -= memoryview(data).nbytes
    if room < 0:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    return whole(file, data, offset)
os.pwrite = pwrite
"""
"""A disk with room for so many bytes of frames; put into sitecustomize.py."""


def command(*arguments, **options) -> subprocess.CompletedProcess:
    """Run the program."""
    arguments = [sys.executable, "-m", "mdanim_lammps", *map(str, arguments), "-q"]
    return subprocess.run(arguments, capture_output=True, text=True, timeout=120, **options)


def ended_well(ended: subprocess.CompletedProcess, cure: str) -> None:
    """One line that names the file, the cause and the cure; no traceback, no signal."""
    assert ended.returncode == 7, ended.stderr
    assert ended.stderr.count("\n") == 1 and "cannot be written: " in ended.stderr and cure in ended.stderr


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The scene's file and a run that had room."""
    place = tmp_path_factory.mktemp("whole")
    (place / "box.txt").write_text(SCENE)
    ended = command(place / "box.txt", "--no-movie")
    assert ended.returncode == 0, ended.stderr
    return place / "box.txt", place / "box.out"


def resumed_elsewhere(folder: Path, place: Path, whole: Path) -> None:
    """Go on in a folder with room: the same bits."""
    shutil.copytree(folder, place)
    ended = command("resume", place, "--no-movie")
    assert ended.returncode == 0, ended.stderr
    assert compare(place, whole).equal


@pytest.mark.parametrize("calls", [30, 200])
def test_a_write_that_fails(whole, tmp_path, calls):
    """Some frame finds no room, from the third on: the state before is kept, and nothing is left of what was begun."""
    scene, folder = whole
    (tmp_path / "sitecustomize.py").write_text(FAILING.format(calls=calls))
    path = os.pathsep.join([str(tmp_path), *filter(None, [os.environ.get("PYTHONPATH")])])
    out = tmp_path / "box.out"
    ended_well(
        command(scene, "--no-movie", "-o", out, env=os.environ | {"PYTHONPATH": path}),
        f"{out / 'trajectory.h5.part'}: cannot be written: No space left on device; make room and resume",
    )
    assert not [name for name in os.listdir(out) if name.startswith(".")]
    resumed_elsewhere(out, tmp_path / "moved.out", folder)


@pytest.mark.soak
@pytest.mark.timeout(3600)
def test_a_disk_that_is_full_at_forty_sizes(whole, tmp_path):
    """Wherever in a run the room ends: one message, nothing left of what was begun, and the bits of the whole run elsewhere, from
    the checkpoint or from the start."""
    scene, folder = whole
    path = os.pathsep.join([str(tmp_path), *filter(None, [os.environ.get("PYTHONPATH")])])
    size, count, full = (folder / "trajectory.h5").stat().st_size, rounds(40), 0
    for k in range(count):
        (tmp_path / "sitecustomize.py").write_text(SMALL.format(room=round(size * (k + 0.5) / count)))
        out = tmp_path / f"{k}.out"
        ended = command(scene, "--no-movie", "-o", out, env=os.environ | {"PYTHONPATH": path})
        if ended.returncode == 0:
            assert compare(out, folder).equal
            continue
        full += 1
        ended_well(ended, "No space left on device; make room and ")
        assert not [name for name in os.listdir(out) if name.startswith(".")], k
        if (out / "checkpoint").exists():
            resumed_elsewhere(out, tmp_path / f"{k}.moved.out", folder)
        else:
            assert "repeat the command" in ended.stderr, (k, ended.stderr)
    assert full > count // 2


@pytest.fixture
def small_disk(tmp_path):
    """Make and mount an ext4 file system of some bytes, all free or only some; needs root and a loop device."""
    image, place = tmp_path / "image", tmp_path / "mounted"

    def make(size: int, free: int = 0) -> Path:
        with image.open("wb") as file:
            file.truncate(size)
        place.mkdir()
        for step in (["mkfs.ext4", "-q", "-m", "0", image], ["mount", "-o", "loop", image, place]):
            if shutil.which(step[0]) is None or subprocess.run(step, capture_output=True).returncode:
                pytest.skip(f"{step[0]} is not possible here")
        if free:
            with (place / "others").open("wb") as file:
                os.posix_fallocate(file.fileno(), 0, shutil.disk_usage(place).free - free)
        return place

    yield make
    if place.is_mount():
        subprocess.run(["umount", place], check=True)


@pytest.mark.skipif(os.geteuid() != 0, reason="only root may mount a small file system")
@pytest.mark.parametrize(("size", "executors"), [(4, 1), pytest.param(6, 2, marks=pytest.mark.mpi)])
def test_a_small_disk(whole, small_disk, tmp_path, size, executors):
    """A file system of 4 MiB that fills up during the run, and one of 6 MiB on two executors."""
    scene, folder = whole
    out = small_disk(size << 20) / "box.out"
    ended_well(command(scene, "--no-movie", "-n", executors, "-o", out), "No space left on device; make room and resume")
    resumed_elsewhere(out, tmp_path / "moved.out", folder)


@pytest.mark.skipif(os.geteuid() != 0, reason="only root may mount a small file system")
@pytest.mark.parametrize("executors", [1, pytest.param(2, marks=pytest.mark.mpi)])
def test_a_disk_that_is_full_before_the_first_frame(whole, small_disk, executors):
    """There is nothing to resume, and the advice is another."""
    scene, _ = whole
    out = small_disk(4 << 20, free=200 << 10) / "box.out"
    ended_well(
        command(scene, "--no-movie", "-n", executors, "-o", out), "No space left on device; make room and repeat the command"
    )
    assert not (out / "checkpoint").exists()
