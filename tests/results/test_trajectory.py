# SPDX-License-Identifier: GPL-2.0-only
"""The trajectory file: what is written comes back, to MDAnalysis too, and a killed run loses no frame."""

from __future__ import annotations

import fcntl
import gc
import os
import pickle
import signal
import subprocess
import sys
from dataclasses import replace

import h5py
import numpy as np
import pytest
from MDAnalysis.analysis.rms import RMSD
from mdanim_lammps.api.run import STAY_OPEN, Run
from mdanim_lammps.errors import OutputError
from mdanim_lammps.features.ground.kept import Ground
from mdanim_lammps.features.walls.kept import Room
from mdanim_lammps.features.walls.words import Walls
from mdanim_lammps.model.model import Layer
from mdanim_lammps.results.frame_rows import RowWriter
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.results.trajectory_file import datasets_of_frames, frame_tables, open_trajectory, part_of, trajectory_bytes
from mdanim_lammps.results.trajectory_writer import TrajectoryWriter
from mdanim_lammps.scene.scene import Save
from paths import LAB
from picture_samples import KILLED, ball, falling, slab_scene, write

FRAMES = 6


@pytest.fixture(scope="module")
def slab():
    scene, models = slab_scene()
    return scene, models, list(falling(models, FRAMES))


def stored(scene, **control):
    return replace(scene, control=replace(scene.control, **control))


@pytest.mark.parametrize("single", [False, True])
def test_frames_come_back(slab, tmp_path, single):
    """Read what was written: to the bit in double precision, to float32 in single."""
    scene, models, frames = slab
    with Trajectory(write(tmp_path / "trajectory.h5", stored(scene, single=single), models, frames)) as t:
        assert len(t) == FRAMES and t.names == ("slab", "cube", "ball")
        real = np.float32 if single else np.float64
        for i, (step, time, position, velocity) in enumerate(frames):
            assert (t.steps[i], t.times[i]) == (step, time)
            np.testing.assert_array_equal(t.position(i), position.astype(real))
            np.testing.assert_array_equal(t.velocity(i), velocity.astype(real))


@pytest.mark.parametrize("single", [False, True])
def test_rows_are_as_h5py_puts_them(slab, tmp_path, monkeypatch, single):
    """All tables are the same to the byte when h5py's own assignment puts the rows."""
    scene, models, frames = slab
    scene = stored(scene, single=single)
    ours = write(tmp_path / "ours.h5", scene, models, frames)

    def h5py_puts(writer, value, offset):
        with h5py.File(writer.rows.path, "r+") as file:
            tables = frame_tables(file).items()
            name, table = next((n, t) for n, t in tables if 0 <= offset - t.offset < t.frames * t.stride)
            frame, rest = divmod(offset - table.offset, table.stride)
            rows = value.reshape(-1, *table.shape)
            assert rest == 0
            datasets_of_frames(file)[name][frame : frame + len(rows)] = rows

    monkeypatch.setattr(RowWriter, "_pwrite", h5py_puts)
    theirs = write(tmp_path / "h5py.h5", scene, models, frames)
    with h5py.File(ours) as a, h5py.File(theirs) as b:
        tables = datasets_of_frames(a), datasets_of_frames(b)
        assert len(tables[0]) == 7
        assert [t[:].tobytes() for t in tables[0].values()] == [t[:].tobytes() for t in tables[1].values()]


def test_object_is_its_own_particles(slab, tmp_path):
    """An object's slice holds its particles, its centre is their mass-weighted mean."""
    scene, models, frames = slab
    with Trajectory(write(tmp_path / "trajectory.h5", scene, models, frames)) as t:
        first = len(models[0].position)
        cube, track = models[1], t.objects["cube"]
        assert track.particles == slice(first, first + len(cube.position))
        assert track.mass == pytest.approx(2.0)
        for i, (_, _, position, velocity) in enumerate(frames):
            mine = position[first : first + len(cube.position)]
            np.testing.assert_array_equal(track.position(i), mine)
            # Sums of some hundred terms in another order: a few hundred units in the last place.
            np.testing.assert_allclose(track.center_of_mass[i], cube.mass @ mine / 2.0, rtol=0, atol=1e-13)
            np.testing.assert_allclose(track.velocity[i], velocity[first], rtol=0, atol=1e-12)


def test_a_mistyped_object_is_suggested(slab, tmp_path):
    """A name that no object has is a KeyError with the nearest name."""
    scene, models, frames = slab
    with (
        Trajectory(write(tmp_path / "trajectory.h5", scene, models, frames)) as t,
        pytest.raises(KeyError, match=r"no object is called 'bal'; did you mean 'ball'"),
    ):
        t.objects["bal"]


def test_boundary_only_keeps_surface_and_centre(tmp_path):
    """With ``save boundary`` the surface and the centre of mass are those of the whole object."""
    scene, models = slab_scene()
    # A fine ball, so that it has an inside worth leaving out.
    models = [models[0], models[1], ball("ball", 0.2, 0.03, (0.35, 0, 1.0))]
    frames = list(falling(models, 3))
    whole = Trajectory(write(tmp_path / "all.h5", scene, models, frames))
    part = Trajectory(write(tmp_path / "boundary.h5", stored(scene, save=Save.BOUNDARY), models, frames))
    with whole, part:
        assert len(part.position(0)) < 0.8 * len(whole.position(0))
        assert part.metadata.save is Save.BOUNDARY
        boundary = np.concatenate([m.layer for m in models]) >= Layer.BOUNDARY
        assert set(np.flatnonzero(boundary) + 1) <= set(part.metadata.id)
        np.testing.assert_array_equal(part.position(2), whole.position(2)[part.metadata.id - 1])
        np.testing.assert_array_equal(part.centers, whole.centers)
        np.testing.assert_allclose(part.surface(2).points, whole.surface(2).points, rtol=0, atol=1e-15)


def test_file_alone_is_enough(slab, tmp_path):
    """Title, colours, ground, walls, masses and the scene's text come back from the file."""
    scene, models, _ = slab
    scene = replace(
        scene,
        walls=Walls((-1.0, -2.0, 0.0), (1.0, 2.0, 3.0)),
        solids=(replace(scene.solids[0], color="#102030"), *scene.solids[1:]),
    )
    text = 'title "A cube — and a ball"\n' * 3000
    with TrajectoryWriter(tmp_path / "t.h5", scene, models, frames=1, dt=0.01, steps_per_frame=10, scene_text=text) as out:
        out.write(0, 0.0, *falling_frame(models))
    with Trajectory(tmp_path / "t.h5") as t:
        c = t.metadata
        assert (c.title, c.scene_text) == (scene.title, text)
        assert c.kept == {"ground": Ground(0.0), "walls": Room(((-1, -2, 0), (1, 2, 3)))}
        assert c.colors == ("#102030", "", "") and c.still.tolist() == [True, False, False]
        assert (t.dt, t.steps_per_frame) == (0.01, 10)
        np.testing.assert_array_equal(c.held, np.concatenate([m.held for m in models]))
        for m, kind in zip(models, c.surface_of):
            np.testing.assert_array_equal(c.surfaces[kind].triangle, m.surface.triangle)
        np.testing.assert_array_equal(t.surface(0).cell_data["color"][0], [0x10, 0x20, 0x30])


def falling_frame(models):
    return next(iter(falling(models, 1)))[2:]


def test_equal_surfaces_are_stored_once(tmp_path):
    """A crowd of equal balls costs one surface, and every ball is drawn where it is."""
    models = [ball(f"ball[{i}]", 0.2, 0.1, (i, 0, 0)) for i in range(5)]
    scene, _ = slab_scene()
    solids = tuple(replace(scene.solids[0], name=m.name) for m in models)
    path = tmp_path / "crowd.h5"
    with TrajectoryWriter(path, replace(scene, solids=solids), models, frames=1, dt=1.0, steps_per_frame=1) as out:
        out.write(0, 0.0, np.concatenate([m.position for m in models]), np.concatenate([m.velocity for m in models]))
    with Trajectory(path) as t:
        assert len(t.metadata.surfaces) == 1
        mesh = t.surface(0)
        expected = np.concatenate([m.surface.vertices(m.position) for m in models])
        np.testing.assert_allclose(mesh.points, expected, rtol=0, atol=1e-6)  # pyvista may keep float32
        assert np.bincount(mesh.cell_data["object"]).tolist() == [len(m.surface.triangle) for m in models]


def test_mdanalysis_reads_it(slab, tmp_path):
    """MDAnalysis gives positions and velocities in metres and seconds, to float32."""
    scene, models, frames = slab
    with Trajectory(write(tmp_path / "trajectory.h5", scene, models, frames)) as t:
        universe = t.universe
        assert universe.trajectory.n_frames == FRAMES
        for ts, (step, time, position, velocity) in zip(universe.trajectory, frames):
            assert (ts.data["step"], ts.time, ts.dimensions) == (step, time, None)
            np.testing.assert_array_equal(ts.positions, position.astype(np.float32))
            np.testing.assert_array_equal(ts.velocities, velocity.astype(np.float32))
            cube = universe.select_atoms("resname cube")
            # Centre from float32 positions of about 1 m: their rounding, 6e-8.
            np.testing.assert_allclose(cube.center_of_mass(), t.objects["cube"].center_of_mass[ts.frame], atol=2e-7)
        assert len(universe.bonds) == sum(len(m.spring) for m in models)
        assert universe.trajectory.dt == pytest.approx(0.1)


def test_it_goes_to_other_processes(slab, tmp_path):
    """As MDAnalysis's backend "multiprocessing" sends a Universe: pickled, and opened anew there."""
    scene, models, frames = slab
    with Trajectory(write(tmp_path / "trajectory.h5", scene, models, frames)) as t:
        universe = pickle.loads(pickle.dumps(t.universe))
        for ts, (_, time, position, _) in zip(universe.trajectory, frames, strict=True):
            assert ts.time == time
            np.testing.assert_array_equal(ts.positions, position.astype(np.float32))
        assert list(universe.residues.resnames) == list(t.names)
        rmsd = RMSD(t.universe)
        together = RMSD(t.universe).run(backend="multiprocessing", n_workers=2)
        np.testing.assert_array_equal(together.results.rmsd, rmsd.run().results.rmsd)
        np.testing.assert_array_equal(pickle.loads(pickle.dumps(t)).position(1), t.position(1))


def test_no_lock_is_needed_to_read(slab, tmp_path):
    """A file that something else has locked, or on a file system without locks, is read: by us, and by MDAnalysis."""
    scene, models, frames = slab
    path = write(tmp_path / "trajectory.h5", scene, models, frames)
    with open(path, "rb") as other:
        fcntl.flock(other, fcntl.LOCK_EX)
        with Trajectory(path) as t:
            np.testing.assert_array_equal(t.position(1), frames[1][2])
            np.testing.assert_array_equal(t.universe.trajectory[1].positions, frames[1][2].astype(np.float32))


def test_others_open_what_we_hold(slab, tmp_path):
    """HDF5 opens a file twice in one process with the same flags of locking only: what we hold since it was locked elsewhere is
    no hindrance to others, and the other way round."""
    scene, models, frames = slab
    path = write(tmp_path / "trajectory.h5", scene, models, frames)
    with open(path, "rb") as other:
        fcntl.flock(other, fcntl.LOCK_EX)
        ours = open_trajectory(path)
    with ours, h5py.File(path, "r") as theirs:
        assert list(ours) == list(theirs)
    with h5py.File(path, "r", locking=False) as theirs, open_trajectory(path) as ours:
        assert list(ours) == list(theirs)


def test_many_runs_hold_few_files(slab, tmp_path):
    """Trajectories of more runs than a process may have files; one that is held stays what it is."""
    scene, models, frames = slab
    write(tmp_path / "trajectory.h5", scene, models, frames)
    (tmp_path / "manifest.json").write_text("{}")
    results = [Run(tmp_path) for _ in range(3 * STAY_OPEN)]
    held = results[0].trajectory
    before = len(os.listdir("/proc/self/fd"))
    assert sum(len(result.trajectory) for result in results) == len(results) * FRAMES
    assert results[0].trajectory is held and results[-1].trajectory is results[-1].trajectory
    gc.collect()
    assert len(os.listdir("/proc/self/fd")) <= before + STAY_OPEN + 1
    assert pickle.loads(pickle.dumps(results[0])).trajectory.names == held.names


def test_bonds_are_tags_of_springs(slab, tmp_path):
    """Pairs in the file are 1-based tags, as H5MD asks where particles have an id."""
    scene, models, frames = slab
    path = write(tmp_path / "trajectory.h5", scene, models, frames[:1])
    with h5py.File(path) as file:
        assert file["h5md"].attrs["version"].tolist() == [1, 1]
        offsets = np.cumsum([0] + [len(m.position) for m in models])
        expected = np.concatenate([m.spring + o + 1 for m, o in zip(models, offsets)])
        np.testing.assert_array_equal(file["connectivity/bonds"][:], expected)
        assert file[file["connectivity/bonds"].attrs["particles_group"]].name == "/particles/all"


def test_name_appears_when_whole(slab, tmp_path):
    """Nothing is called ``trajectory.h5`` before it is finished; an unfinished one is still readable."""
    scene, models, frames = slab
    path = tmp_path / "trajectory.h5"
    writer = TrajectoryWriter(path, scene, models, frames=FRAMES, dt=0.01, steps_per_frame=10)
    writer.write(*frames[0])
    writer.flush()
    writer.write(*frames[1])
    assert not path.exists()
    with Trajectory(tmp_path) as live:
        assert len(live) == 1
    assert writer.close(finished=False) == part_of(path) and not path.exists()
    with Trajectory(tmp_path) as ended:
        assert len(ended) == 2


def test_step_vouches_for_data(slab, tmp_path, monkeypatch):
    """The data of a frame are on the disk before its step is written, and ``flush`` returns when the step is there too."""
    scene, models, frames = slab
    done = []
    put, sync = TrajectoryWriter._put, os.fdatasync
    monkeypatch.setattr(TrajectoryWriter, "_put", lambda self, name, *what: (done.append(name), put(self, name, *what)))
    monkeypatch.setattr(os, "fdatasync", lambda file: (done.append("sync"), sync(file)))
    with TrajectoryWriter(tmp_path / "t.h5", scene, models, frames=2, dt=0.01, steps_per_frame=10) as writer:
        writer.write(*frames[0])
        writer.write(*frames[1])
        assert not {"step", "sync"} & set(done)
        writer.flush()
        assert done[-3:] == ["sync", "step", "sync"]
        with Trajectory(tmp_path / "t.h5") as live:
            assert len(live) == 2


@pytest.mark.parametrize("after", [3, 60])
def test_killed_writer_loses_no_flushed_frame(slab, tmp_path, after):
    """Kill -9 a writer at no particular moment: all frames it had flushed are there and right."""
    _, models, _ = slab
    writer = subprocess.Popen([sys.executable, "-c", KILLED, str(LAB), str(tmp_path)], stdout=subprocess.PIPE, text=True)
    for line in writer.stdout:
        if int(line) >= after:
            break
    os.kill(writer.pid, signal.SIGKILL)
    said = [int(line) for line in writer.stdout.read().split()]
    writer.wait()
    with Trajectory(tmp_path) as t:
        # One more flush may have ended between its last write and the line that says so.
        assert len(t) in (max([after, *said]), max([after, *said]) + 3)
        for i, (step, time, position, velocity) in enumerate(falling(models, len(t))):
            assert (t.steps[i], t.times[i]) == (step, time)
            np.testing.assert_array_equal(t.position(i), position)
            np.testing.assert_array_equal(t.velocity(i), velocity)
        assert t.universe.trajectory.n_frames >= len(t)


def test_append_goes_on_after_a_kill(slab, tmp_path):
    """Resume from step 20 of a killed run: later frames are cut and written anew, and the end is whole."""
    scene, models, frames = slab
    path = tmp_path / "trajectory.h5"
    code = (
        KILLED.replace("frames=1000", "frames=6").replace("models, 1000", "models, 5").replace("i % 3 == 2", "True")
        + "os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    died = subprocess.run([sys.executable, "-c", code, str(LAB), str(tmp_path)], capture_output=True)
    assert died.returncode == -signal.SIGKILL
    with TrajectoryWriter.append(path, scene, models, after_step=20) as out:
        with pytest.raises(ValueError, match="found 20"):
            out.write(*frames[2])
        for frame in frames[3:]:
            out.write(*frame)
    assert sorted(os.listdir(tmp_path)) == ["trajectory.h5"]
    whole = write(tmp_path / "whole.h5", scene, models, frames)
    with Trajectory(path) as t, Trajectory(whole) as w:
        np.testing.assert_array_equal(t.steps, w.steps)
        np.testing.assert_array_equal(t.times, w.times)
        np.testing.assert_array_equal(t.centers, w.centers)
        for i in range(FRAMES):
            np.testing.assert_array_equal(t.position(i), w.position(i))


def test_append_refuses_another_scene(slab, tmp_path):
    """Frames of other objects are never mixed in."""
    scene, models, frames = slab
    path = write(tmp_path / "trajectory.h5", scene, models, frames[:1])
    with pytest.raises(OutputError, match="not this scene's"):
        TrajectoryWriter.append(path, scene, models[:2], after_step=0)


@pytest.mark.parametrize(("save", "single"), [(Save.ALL, False), (Save.BOUNDARY, True)])
def test_size_is_known_before(slab, tmp_path, save, single):
    """The estimate is what the disk then says, to a tenth."""
    scene, models, _ = slab
    frames = list(falling(models, 60))
    path = write(tmp_path / "t.h5", stored(scene, save=save, single=single), models, frames)
    assert trajectory_bytes(models, 60, save, single) == pytest.approx(path.stat().st_size, rel=0.15)


def test_full_disk_is_an_output_error(slab, tmp_path):
    """A file that may not grow gives the cause and the way out, and what was flushed stays readable."""
    code = KILLED.replace(
        "flushed = 0",
        "flushed = 0\nimport resource\nlast = writer._tables['center_of_mass_velocity']\n"
        "limit = last.offset + 20 * last.stride\nresource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))",
    ).replace("1000", "30")
    died = subprocess.run([sys.executable, "-c", code, str(LAB), str(tmp_path)], capture_output=True, text=True, timeout=60)
    assert died.returncode == 1
    assert (
        "OutputError" in died.stderr
        and "File too large; raise the limit of the size of files (ulimit -f) or make room" in died.stderr
    )
    with Trajectory(tmp_path) as t:
        assert len(t) == int(died.stdout.split()[-1]) == 18


def test_a_size_that_is_not_allowed_is_refused_at_once(tmp_path):
    """The file has its whole size from the start: what the user's limits or the file system refuse is told before any frame."""
    code = KILLED.replace("writer =", "import resource\nresource.setrlimit(resource.RLIMIT_FSIZE, (800_000, 800_000))\nwriter =")
    died = subprocess.run([sys.executable, "-c", code, str(LAB), str(tmp_path)], capture_output=True, text=True, timeout=60)
    assert died.returncode == 1 and died.stdout == ""
    assert died.stderr.splitlines()[-1].endswith(
        "trajectory.h5.part: cannot be written: File too large; raise the limit of the size of files (ulimit -f) or make room "
        "and repeat the command, with force=True if it made this folder"
    )
    assert not os.listdir(tmp_path)


def test_a_resumed_run_goes_on_in_its_file(slab, tmp_path):
    """Resume needs no room for frames that are there; frames that are dropped do not count, also when it is killed at once."""
    scene, models, frames = slab
    path = tmp_path / "trajectory.h5"
    writer = TrajectoryWriter(path, scene, models, frames=FRAMES, dt=0.01, steps_per_frame=10)
    for frame in frames[:5]:
        writer.write(*frame)
    part = writer.close(finished=False)
    before = part.stat()
    TrajectoryWriter.append(path, scene, models, after_step=20)
    assert os.listdir(tmp_path) == [part.name]
    assert (part.stat().st_ino, part.stat().st_blocks) == (before.st_ino, before.st_blocks)
    with Trajectory(path) as t:
        assert t.steps.tolist() == [0, 10, 20]


def test_a_trajectory_that_lacks_frames_is_not_finished(slab, tmp_path):
    """It keeps the name of one that is being written."""
    scene, models, frames = slab
    writer = TrajectoryWriter(tmp_path / "t.h5", scene, models, frames=2, dt=0.01, steps_per_frame=10)
    writer.write(*frames[0])
    with pytest.raises(ValueError, match="1 of 2 frames are written"):
        writer.close()
    assert os.listdir(tmp_path) == ["t.h5.part"]
    with TrajectoryWriter.append(tmp_path / "t.h5", scene, models, after_step=0) as writer:
        writer.write(*frames[1])
        with pytest.raises(ValueError, match="all 2 frames of the file are written"):
            writer.write(*frames[2])


@pytest.mark.parametrize("make", [lambda p: None, lambda p: (p / "trajectory.h5").write_text("not HDF5")])
def test_no_trajectory_there(tmp_path, make):
    """A folder without one, or a file that is none, is an error with its path."""
    make(tmp_path)
    with pytest.raises(OutputError, match=r"trajectory\.h5"):
        Trajectory(tmp_path)


def test_frame_number_out_of_range(slab, tmp_path):
    """Frames count from 0, or from the end with a minus; any other is an IndexError."""
    scene, models, frames = slab
    with Trajectory(write(tmp_path / "t.h5", scene, models, frames)) as t:
        np.testing.assert_array_equal(t.position(-1), t.position(FRAMES - 1))
        with pytest.raises(IndexError, match="6 frames"):
            t.position(FRAMES)


def test_no_liquid_no_heights(slab, tmp_path):
    """A run without liquid has none, and says so when asked for its height."""
    scene, models, frames = slab
    with Trajectory(write(tmp_path / "t.h5", scene, models, frames[:1])) as t:
        assert t.liquid is None
        with pytest.raises(OutputError, match="no liquid in this run"):
            t.liquid_height(0)


def test_files_of_version_1_are_read(slab, tmp_path):
    """A file from before there was liquid opens, one from a newer program does not."""
    scene, models, frames = slab
    path = write(tmp_path / "t.h5", scene, models, frames[:2])
    with h5py.File(path, "r+") as file:
        file["parameters/mdanim"].attrs["format"] = 1
    with Trajectory(path) as t:
        assert len(t) == 2 and t.liquid is None
    with h5py.File(path, "r+") as file:
        file["parameters/mdanim"].attrs["format"] = 4
    with pytest.raises(OutputError, match="format 4, newer than 3"):
        Trajectory(path)
