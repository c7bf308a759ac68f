# SPDX-License-Identifier: GPL-2.0-only
"""The trajectory file of a liquid: heights come back, after a kill too."""

from __future__ import annotations

import signal
import subprocess
import sys
from dataclasses import replace

import h5py
import numpy as np
import pytest
from mdanim_lammps.effects.fields import Field
from mdanim_lammps.effects.kept import records_of
from mdanim_lammps.errors import OutputError
from mdanim_lammps.features.liquid.kept import MOST_DROPS
from mdanim_lammps.model.grid import Grid
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.results.trajectory_file import trajectory_bytes
from mdanim_lammps.results.trajectory_metadata import kept_fields
from mdanim_lammps.results.trajectory_writer import TrajectoryWriter
from paths import LAB
from picture_samples import KILLED, dam, flat, pool_scene, raw_of, splash, wet_frames, with_drops, write


def pool(spacing=0.1):
    """A pool, its grid, and three frames of a liquid that falls, splashes and lies still."""
    scene, models, grid = pool_scene(spacing=spacing)
    heights = [(h, raw_of(grid, h, models)) for h in (dam(grid), splash(grid), flat(grid))]
    return scene, models, grid, list(wet_frames(models, *heights))


def test_heights_of_a_liquid_come_back(tmp_path):
    """Basin, density and colour come back, and heights to float32, NaN where a column told nothing."""
    scene, models, grid, frames = pool()
    scene = replace(scene, liquid=replace(scene.liquid, color="#204060"))
    with Trajectory(write(tmp_path / "t.h5", scene, models, frames, grid)) as t:
        assert t.liquid.grid == grid and t.liquid.shape == (20, 14, 10)
        assert (t.liquid.name, t.liquid.density, t.liquid.color) == ("water", 1000.0, "#204060")
        for i, (_, _, _, _, heights) in enumerate(frames):
            np.testing.assert_array_equal(t.liquid_height(i), heights["liquid_height"].astype(np.float32))
            np.testing.assert_array_equal(t.liquid_raw(i), heights["liquid_raw"].astype(np.float32))
        assert np.isnan(t.liquid_raw(0)).any() and not np.isnan(t.liquid_raw(0)).all()
        # Means of float32 heights below 1 m: their rounding.
        np.testing.assert_allclose(t.liquid_levels, [f[4]["liquid_height"].mean() for f in frames], rtol=0, atol=6e-8)


def test_heights_are_h5md_observables(tmp_path):
    """Other programs find value, step and time of both heights, and MDAnalysis hands them out with a frame."""
    scene, models, grid, frames = pool()
    path = write(tmp_path / "t.h5", scene, models, frames, grid)
    with h5py.File(path) as file:
        liquid = file["observables/liquid"]
        np.testing.assert_array_equal(liquid.attrs["high"], grid.high)
        for name in ("height", "raw"):
            assert liquid[name]["value"].shape == (3, 14, 20) and liquid[name]["value"].attrs["units"] == "m"
            assert liquid[name]["step"] == file["particles/all/position/step"]
            np.testing.assert_array_equal(liquid[name]["time"][:], [0.0, 0.1, 0.2])
    with Trajectory(path) as t:
        np.testing.assert_array_equal(t.universe.trajectory[1].data["liquid/height"], t.liquid_height(1))


def test_drops_come_back(tmp_path):
    """As many as flew in each frame, to float32; one too many, none at all and three numbers for a drop are refused."""
    scene, models, grid, frames = pool()
    scene = replace(scene, liquid=replace(scene.liquid, drops=0.5))
    random = np.random.default_rng(1)
    drops = [random.uniform(0.1, 1.0, (n, 4)) for n in (0, 7, MOST_DROPS)]
    with Trajectory(write(tmp_path / "t.h5", scene, models, [with_drops(f, d) for f, d in zip(frames, drops)], grid)) as t:
        for n, expected in enumerate(drops):
            np.testing.assert_array_equal(t.liquid_drops(n), expected.astype(np.float32))
            t.check(n)
    with TrajectoryWriter(tmp_path / "u.h5", scene, models, frames=1, dt=0.01, steps_per_frame=10, grid=grid) as out:
        wrong = (frames[0], *(with_drops(frames[0], np.ones(shape)) for shape in ((MOST_DROPS + 1, 4), (2, 3))))
        for frame in wrong:
            with pytest.raises(ValueError, match=r"liquid_drops must have the shape \(2048, 4\) or fewer rows, found"):
                out.write(*frame)
        out.write(*with_drops(frames[0], drops[1]))


def test_a_liquid_without_drops_has_none(tmp_path):
    """Nor room for any: drops are refused."""
    scene, models, grid, frames = pool()
    path = write(tmp_path / "t.h5", scene, models, frames[:1], grid)
    with Trajectory(path) as t:
        assert t.liquid_drops(0).shape == (0, 4)
    with h5py.File(path) as file:
        assert "drops" not in file["observables/liquid"]
    with TrajectoryWriter(tmp_path / "u.h5", scene, models, frames=1, dt=0.01, steps_per_frame=10, grid=grid) as out:
        with pytest.raises(ValueError, match="frames of this trajectory have no liquid_drops"):
            out.write(*with_drops(frames[0], np.ones((1, 4))))
        out.write(*frames[0])


@pytest.mark.parametrize(
    "heights",
    [
        {},
        {"liquid_height": np.zeros((14, 20))},
        {"liquid_height": np.zeros((20, 14)), "liquid_raw": np.zeros((20, 14))},
        {"liquid_height": np.zeros((14, 20)), "liquid_raw": np.zeros((14, 19))},
    ],
)
def test_heights_must_fit_the_basin(tmp_path, heights):
    """Missing heights, one of two, and x for y are refused before anything is written."""
    scene, models, grid, frames = pool()
    with TrajectoryWriter(tmp_path / "t.h5", scene, models, frames=1, dt=0.01, steps_per_frame=10, grid=grid) as out:
        with pytest.raises(ValueError, match=r"liquid_(height|raw) must have the shape \(14, 20\)"):
            out.write(*frames[0][:4], heights)
        out.write(*frames[0])
    with Trajectory(tmp_path / "t.h5") as t:
        assert len(t) == 1


WET = (
    KILLED.replace("falling, slab_scene", "pool_scene, splash, wet_frames")
    .replace("models = slab_scene()", "models, grid = pool_scene(spacing=0.1)")
    .replace("steps_per_frame=10", "steps_per_frame=10, grid=grid")
    .replace("falling(models, 1000)", "wet_frames(models, *[(splash(grid, level=0.1 + 0.01 * k),) * 2 for k in range(50)])")
)


def test_heights_survive_a_kill_and_a_resume(tmp_path):
    """Kill -9 a writer with a liquid, go on from an earlier frame: kept frames keep their heights, new ones follow."""
    code = WET + "os.kill(os.getpid(), signal.SIGKILL)\n"
    died = subprocess.run([sys.executable, "-c", code, str(LAB), str(tmp_path)], capture_output=True)
    assert died.returncode == -signal.SIGKILL
    scene, models, grid, frames = pool()
    with Trajectory(tmp_path) as t:
        assert len(t) == 48
    out = TrajectoryWriter.append(tmp_path / "trajectory.h5", scene, models, after_step=20, grid=grid)
    _, _, x, v, heights = frames[0]
    out.write(30, 0.3, x, v, heights)
    out.close(finished=False)
    with Trajectory(tmp_path) as t:
        assert t.steps.tolist() == [0, 10, 20, 30] and t.liquid.grid == grid
        for k in range(3):
            expected = splash(grid, level=0.1 + 0.01 * k).astype(np.float32)
            np.testing.assert_array_equal(t.liquid_height(k), expected)
            np.testing.assert_array_equal(t.liquid_raw(k), expected)
        np.testing.assert_array_equal(t.liquid_raw(3), heights["liquid_raw"].astype(np.float32))


@pytest.mark.parametrize("other", [None, Grid((-1.0, -0.7, 0.0), (1.0, 0.7, 1.0), (10, 7, 5))])
def test_append_refuses_another_basin(tmp_path, other):
    """Frames of a liquid go on only in the same cells."""
    scene, models, grid, frames = pool()
    path = write(tmp_path / "trajectory.h5", scene, models, frames, grid)
    with pytest.raises(OutputError, match=r"holds a liquid in 20 x 14 x 10 cells, this scene (no|a) liquid"):
        TrajectoryWriter.append(path, scene, models, after_step=0, grid=other)


def test_size_with_a_liquid_is_known_before(tmp_path):
    """Heights are counted: the estimate is what the disk then says, to a tenth, and mostly heights here."""
    scene, models, grid = pool_scene(spacing=0.02)
    heights = splash(grid)
    path = write(tmp_path / "t.h5", scene, models, wet_frames(models, *[(heights, heights)] * 60), grid)
    said = trajectory_bytes(models, 60, fields=kept_fields(records_of(scene, grid), (), models, scene.control.save))
    assert said == pytest.approx(path.stat().st_size, rel=0.1)
    assert said > 2 * trajectory_bytes(models, 60)


def test_compare_sees_the_liquid(tmp_path):
    """Runs whose objects agree differ where a height does, from its first frame on, and by how much."""
    from mdanim_lammps.results.compare import compare

    scene, models, grid, frames = pool()
    a = write(tmp_path / "a.h5", scene, models, frames, grid)
    assert compare(a, write(tmp_path / "b.h5", scene, models, frames, grid)).equal
    step, time, x, v, heights = frames[1]
    raised = heights["liquid_height"].copy()
    raised[3, 4] += 0.25
    b = write(
        tmp_path / "c.h5", scene, models, [frames[0], (step, time, x, v, heights | {"liquid_height": raised}), frames[2]], grid
    )
    found = compare(a, b)
    assert (found.frame, found.object) == (1, "water")
    # Heights below 1 m in float32.
    assert found.distance == pytest.approx(0.25, abs=1e-7)


def test_fields_of_objects_beside_drops(tmp_path):
    """Each has its own checksum, whatever else a frame has."""
    scene, models, grid, frames = pool()
    scene, force = replace(scene, liquid=replace(scene.liquid, drops=0.5)), np.arange(len(models) * 3.0).reshape(-1, 3)
    path = tmp_path / "t.h5"
    fields = (Field("push", "N", per="object", shape=(3,)),)
    with TrajectoryWriter(path, scene, models, frames=1, dt=0.01, steps_per_frame=10, grid=grid, fields=fields) as out:
        *rest, told = with_drops(frames[0], np.ones((2, 4)))
        out.write(*rest, told | {"push": force})
    with Trajectory(path) as t:
        t.check(0)
        np.testing.assert_array_equal(t.field("push", 0), force)
        assert len(t.liquid_drops(0)) == 2
