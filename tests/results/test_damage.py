# SPDX-License-Identifier: GPL-2.0-only
"""Damaged results: whatever happens to the files of a run, reading and resuming give the right bits or say what is damaged."""

from __future__ import annotations

import multiprocessing
import os
import random
import shutil
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from campaign import rounds
from mdanim_lammps.errors import OutputError
from mdanim_lammps.parallel.frames import run_frames
from mdanim_lammps.results.checkpoint import Checkpoint
from mdanim_lammps.results.files import STOP
from mdanim_lammps.results.ledger import Ledger
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.results.trajectory_file import NOT_WRITTEN, frame_tables, open_trajectory
from mdanim_lammps.run.folder import open_run
from mdanim_lammps.run.loop import Interrupted
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import load_scene

SCENE = """
gravity (0, 0, -9.81) m/s^2
ground z 0
liquid water { basin from (-0.3, -0.3, 0) m to (0.3, 0.3, 0.5) m  density 1000 kg/m^3  level 0.2 m }
object cork { shape sphere 6 cm  position (-0.12, -0.12, 0.4) m  density 300 kg/m^3  elasticity 100 kPa }
object box { shape box (12, 12, 12) cm  position (0.12, 0.12, 0.4) m  density 300 kg/m^3  elasticity 100 kPa }
control { time 0.2 s  frames 50 fps  resolution 4 cm }
"""
HALF = 5
"""Frame at which the cut run was stopped."""
SECONDS = 10.0
"""Limit for reading or resuming such a small run [s]."""


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """The prepared scene, a whole run, and the same run as it was after frame 5: made in processes of their own."""
    place = tmp_path_factory.mktemp("damage")
    (place / "pond.txt").write_text(SCENE)
    ready = prepare(load_scene(place / "pond.txt"))
    for name in ("whole", "cut"):
        child = multiprocessing.get_context("fork").Process(target=make, args=(ready, place / name, name == "cut"))
        child.start()
        child.join()
        assert child.exitcode == 0
    assert Checkpoint.read(place / "cut" / "checkpoint").frame == HALF
    return ready, place / "whole", place / "cut"


def make(ready, folder: Path, cut: bool) -> None:
    """Run a scene; stop it at a frame if asked to."""

    def stop(progress):
        if cut and progress.frame == HALF:
            (folder / STOP).touch()

    with open_run(ready, folder, force=False):
        try:
            run_frames(ready, folder, on_progress=stop)
        except Interrupted:
            assert cut


def harm(path: Path, chance: random.Random) -> str:
    """Damage a file; says how."""
    data = bytearray(path.read_bytes())
    # Most of a file is frames; its head and its end hold what everything else hangs on.
    low, high = chance.choice([(0, len(data)), (0, min(len(data), 4096)), (max(0, len(data) - 4096), len(data))])
    where = chance.randrange(low, high)
    kind = chance.choice(["flip", "flip", "flip", "bytes", "zeros", "cut", "empty", "longer"])
    match kind:
        case "flip":
            data[where] ^= 1 << chance.randrange(8)
        case "bytes":
            for i in range(where, min(where + 64, len(data))):
                data[i] = chance.randrange(256)
        case "zeros":
            data[where : where + 4096] = bytes(len(data[where : where + 4096]))
        case "cut":
            del data[where:]
        case "empty":
            data.clear()
        case "longer":
            data += chance.randbytes(1000)
    path.write_bytes(data)
    return f"{kind} at {where} of {path.name}"


def frames_of(trajectory: Trajectory) -> list[bytes]:
    """All that pictures and MDAnalysis can ask for, as bytes."""
    t = trajectory
    found = [t.steps, t.times, t.centers, t.center_velocities, t.metadata.mass, t.metadata.bond, t.metadata.object_of]
    found += [getattr(s, name) for s in t.metadata.surfaces for name in ("triangle", "index", "weight")]
    for i in range(len(t)):
        found += [t.position(i), t.velocity(i), t.liquid_height(i), t.liquid_raw(i)]
    return [array.tobytes() for array in found] + [str((t.names, t.metadata.title, t.metadata.scene_text, t.liquid)).encode()]


def read_all(ready, folder: Path, whole: Path) -> None:
    """Read a finished trajectory to the last bit."""
    with Trajectory(folder) as t, Trajectory(whole) as w:
        assert frames_of(t) == frames_of(w)


def resume(ready, folder: Path, whole: Path) -> None:
    """Go on from a checkpoint; the result is that of the whole run."""
    run_frames(ready, folder, resume=Checkpoint.read(folder / "checkpoint"))
    read_all(ready, folder, whole)
    assert Ledger.read(folder / "ledger.csv").rows == Ledger.read(whole / "ledger.csv").rows


def outcome(task, ready, folder: Path, whole: Path, said) -> None:
    """In a process of its own: "right", or the message of an OutputError. All else is an error that ends the process."""
    try:
        task(ready, folder, whole)
    except OutputError as error:
        said.put(str(error))
    else:
        said.put("right")


def tried(task, ready, folder: Path, whole: Path) -> str:
    """End of a task on a damaged folder; a crash, a traceback and a hang fail."""
    fork = multiprocessing.get_context("fork")
    said = fork.SimpleQueue()
    child = fork.Process(target=outcome, args=(task, ready, folder, whole, said))
    child.start()
    child.join(SECONDS)
    if child.is_alive():
        child.kill()
        pytest.fail(f"still at work after {SECONDS} s")
    assert child.exitcode == 0
    return said.get()


def damaged(runs, place: Path, seed: int) -> tuple[str, str]:
    """Damage one file of a copy of a run, use it; says how it was damaged and how that ended."""
    ready, whole, cut = runs
    chance = random.Random(seed)
    file = chance.choice(
        ["checkpoint", "trajectory.h5.part", "trajectory.h5.part", "ledger.csv", "trajectory.h5", "trajectory.h5"]
    )
    finished = file == "trajectory.h5"
    folder = place / f"{seed}"
    shutil.copytree(whole if finished else cut, folder)
    how = harm(folder / file, chance)
    said = tried(read_all if finished else resume, ready, folder, whole)
    assert said == "right" or str(folder / file) in said, how
    shutil.rmtree(folder)
    return how, said


@pytest.mark.parametrize("seed", range(12))
def test_damage_is_harmless_or_named(runs, tmp_path, seed):
    """Flips, cuts and zeros: every result is right to the bit, or an error names the file."""
    damaged(runs, tmp_path, seed)


@pytest.mark.soak
@pytest.mark.timeout(1800)
def test_much_damage_is_harmless_or_named(runs, tmp_path):
    """Five hundred more; most are seen."""
    count = rounds(500)
    found = [damaged(runs, tmp_path, seed) for seed in range(100, 100 + count)]
    assert sum(said != "right" for _, said in found) > 0.6 * count - 5


def test_undamaged_runs_are_right(runs, tmp_path):
    """The check itself: without damage both ways end with the bits of the whole run."""
    ready, whole, cut = runs
    shutil.copytree(cut, tmp_path / "cut")
    assert tried(resume, ready, tmp_path / "cut", whole) == "right"
    assert tried(read_all, ready, whole, whole) == "right"


@pytest.mark.parametrize(
    "table", ["step", "time", "checksum", "position", "velocity", "center_of_mass", "center_of_mass_velocity", "liquid/height"]
)
def test_one_flipped_bit_of_a_frame_is_found(runs, tmp_path, table):
    """In any table of a frame before the checkpoint: reading and resuming name the frame."""
    ready, whole, cut = runs
    shutil.copytree(cut, tmp_path / "cut")
    part = tmp_path / "cut" / "trajectory.h5.part"
    with open_trajectory(part) as file:
        place = frame_tables(file)[table]
    with part.open("r+b") as file:
        file.seek(place.offset + 3 * place.stride + place.stride // 2)
        byte = file.read(1)[0]
        file.seek(-1, os.SEEK_CUR)
        file.write(bytes([byte ^ 1]))
    for task in (resume, read_all):
        assert f"{part}: frame 3 is damaged" in tried(task, ready, tmp_path / "cut", whole)


@pytest.mark.parametrize(
    ("table", "change"),
    [
        ("checksum", lambda sums: sums[:4]),
        ("checksum", lambda sums: sums[:, :1]),
        ("checksum", lambda sums: sums[:, 0]),
        ("step", lambda steps: steps[:4]),
        ("step", lambda steps: np.array([b"x"] * len(steps))),
        ("time", lambda times: times[:4]),
    ],
)
def test_tables_of_frames_that_do_not_fit_together_are_refused(runs, tmp_path, table, change):
    """One that is shorter, narrower or of another kind than the others: no value could be compared with its checksum."""
    _, whole, _ = runs
    path = tmp_path / "trajectory.h5"
    shutil.copy(whole / "trajectory.h5", path)
    with h5py.File(path, "r+") as file:
        name = "parameters/mdanim/checksum" if table == "checksum" else f"particles/all/position/{table}"
        changed = change(file[name][:])
        del file[name]
        file[name] = changed
    with pytest.raises(OutputError, match=r"trajectory\.h5.* damaged"):
        Trajectory(path)


def test_a_trajectory_older_than_the_checkpoint_is_not_resumed(runs, tmp_path):
    """As after a backup of one file alone: the run would have a hole, and not come to an end."""
    ready, whole, cut = runs
    shutil.copytree(cut, tmp_path / "cut")
    part = tmp_path / "cut" / "trajectory.h5.part"
    with open_trajectory(part) as file:
        place = frame_tables(file)["step"]
    with part.open("r+b") as file:
        file.seek(place.offset + HALF * place.stride)
        file.write(np.int64(NOT_WRITTEN).tobytes() * (place.frames - HALF))
    assert f"{part}: has no frame of step" in tried(resume, ready, tmp_path / "cut", whole)


@pytest.mark.parametrize(("line", "change"), [(0, ("kinetic", "kinetIc")), (3, (".", "1.")), (HALF + 1, (",", ",1")), (2, None)])
def test_a_damaged_ledger_is_not_resumed(runs, tmp_path, line, change):
    """A header that names another column, a changed digit, a row that is gone: what the checkpoint vouches for must be there."""
    ready, whole, cut = runs
    shutil.copytree(cut, tmp_path / "cut")
    path = tmp_path / "cut" / "ledger.csv"
    lines = path.read_text().splitlines(keepends=True)
    lines[line] = lines[line].replace(*change, 1) if change else ""
    path.write_text("".join(lines))
    assert f"{path} is damaged" in tried(resume, ready, tmp_path / "cut", whole)


def test_rendering_names_the_damage(runs, tmp_path):
    """The command ends with code 7 and one line."""
    _, whole, _ = runs
    shutil.copytree(whole, tmp_path / "whole")
    path = tmp_path / "whole" / "trajectory.h5"
    with Trajectory(path) as t:
        place = t.position(7).tobytes()
    data = bytearray(path.read_bytes())
    data[data.index(place) + 5] ^= 16
    path.write_bytes(data)
    ended = subprocess.run(
        [sys.executable, "-m", "mdanim_lammps", "render", tmp_path / "whole", "--size", "64", "48", "-q"],
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert ended.returncode == 7, ended.stderr
    assert f"{path}: frame 7 is damaged: its position differs" in ended.stderr
    assert "Traceback" not in ended.stderr
    assert not (tmp_path / "whole" / "movie.mp4").exists()


def test_mdanalysis_gives_no_damaged_frame(runs, tmp_path):
    """Frames before the damage are given, the damaged one is an error."""
    _, whole, _ = runs
    path = tmp_path / "trajectory.h5"
    shutil.copy(whole / "trajectory.h5", path)
    with open_trajectory(path) as file:
        place = frame_tables(file)["velocity"]
    with path.open("r+b") as file:
        file.seek(place.offset + 4 * place.stride)
        file.write(b"\0\1\2\3")
    with Trajectory(path) as t:
        frames = t.universe.trajectory
        assert np.isfinite(frames[3].positions).all()
        with pytest.raises(OutputError, match="frame 4 is damaged: its velocity"):
            frames[4]
