# SPDX-License-Identifier: GPL-2.0-only
"""Pictures that are done with leave nothing: windows, meshes and textures go with the painter, also in one process for hours."""

from __future__ import annotations

import gc
import os
import subprocess
import sys
import weakref

import pytest
from mdanim_lammps import Scene, cli
from mdanim_lammps.picture.render import Painter
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.scene.render import Quality, Render
from mdanim_lammps.view.feed import Feed
from picture_samples import flat, pool_scene, raw_of, wet_frames, write
from scene_texts import POOL


@pytest.fixture
def run(tmp_path):
    """A folder with a trajectory of a liquid, which uses all parts of a picture."""
    scene, models, grid = pool_scene()
    write(tmp_path / "trajectory.h5", scene, models, wet_frames(models, (flat(grid), raw_of(grid, flat(grid), models))), grid)
    return tmp_path


@pytest.fixture
def uncollected():
    """The garbage collector does not run: what refers to itself stays."""
    gc.collect()
    gc.disable()
    yield
    gc.enable()


@pytest.mark.parametrize("quality", Quality)
@pytest.mark.parametrize("liquid", ["smooth", "cells"])
def test_a_painter_is_gone_when_it_is_let_go(run, uncollected, quality, liquid):
    """No part refers to what holds it, so that VTK frees its memory at once, not when Python looks for garbage."""
    with Trajectory(run) as t:
        with Painter(t, Render(quality=quality, liquid=liquid), size=(64, 48)) as painter:
            painter.frame(0)
        parts = {name: weakref.ref(part) for name, part in vars(painter).items() if type(part).__weakrefoffset__}
        assert len(parts) > 8
        del painter
        assert not [name for name, part in parts.items() if part() is not None and name != "trajectory"]
    trajectory = weakref.ref(t)
    del t
    assert trajectory() is None


def test_what_feeds_a_page_is_gone_when_it_is_let_go(run, uncollected):
    """With its open file."""
    feed = Feed(run)
    feed.frame(0, 3)
    feed.close()
    feed = weakref.ref(feed)
    assert feed() is None


def test_garbage_of_a_command_can_be_collected():
    """A program that calls the command line again and again keeps its collector as it was: nothing is set aside for ever."""
    before = gc.get_freeze_count(), gc.get_threshold()
    with pytest.raises(SystemExit):
        cli.main(["explain", "box"])
    assert (gc.get_freeze_count(), gc.get_threshold()) == before


CYCLES = """
import os, sys
from pathlib import Path
from mdanim_lammps import cli
run, cycles, formats = sys.argv[1], int(sys.argv[2]), sys.argv[3:]
commands = [("render", run, "--size", "64", "48", "-q", "--force")]
commands += [("report", run, "--force")] * bool(formats)
commands += [("export", run, "--to", to, "-q", "--force") for to in formats]
resident = []
for _ in range(cycles):
    for command in commands:
        try:
            cli.main(list(command))
        except SystemExit as end:
            assert end.code in (0, None), end.code
    resident.append(int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE"))
print(*resident)
"""


# One drawing thread and one heap that gives back at once: else buffers of the drawing library come and go by 8 to 25 MB.
SETTLED = {"LP_NUM_THREADS": "0", "MALLOC_ARENA_MAX": "1", "MALLOC_TRIM_THRESHOLD_": "0"}


def growth_of(run, cycles: int, warm: int, *formats: str) -> float:
    """Memory [bytes] by which a process grows that draws a run, and exports it, again and again, after the first few times."""
    command = [sys.executable, "-c", CYCLES, run, str(cycles), *formats]
    ended = subprocess.run(command, capture_output=True, text=True, env=os.environ | SETTLED)
    assert ended.returncode == 0, ended.stderr[-2000:]
    resident = [int(word) for word in ended.stdout.split()[-cycles:]]
    return resident[-1] - resident[warm - 1]


@pytest.fixture(scope="module")
def pool(tmp_path_factory):
    """A run of a pool."""
    folder = tmp_path_factory.mktemp("pool")
    (folder / "pool.txt").write_text(POOL)
    return Scene.load(folder / "pool.txt").run(folder / "pool.out").folder


def test_memory_of_a_few_cycles(pool):
    """Windows that are kept take 6 to 8 MB each; three more take over 18, and a heap that settles less than 3."""
    assert growth_of(pool, 7, 4) < 9e6


@pytest.mark.soak
@pytest.mark.timeout(3600)
def test_memory_of_two_hundred_cycles(pool):
    """No more than a few."""
    assert growth_of(pool, 200, 10, "usd", "vtk") < 40e6
