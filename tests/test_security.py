# SPDX-License-Identifier: GPL-2.0-only
"""A scene, a mesh or an output folder of a stranger does no harm (docs/security.md).

Commands run on crafted folders. Each ends soon with a documented code and a message, and no file outside of the folder changes.
"""

import io
import json
import os
import shutil
import zlib

import h5py
import numpy as np
import pytest
from mdanim_lammps import cli
from mdanim_lammps.results.checkpoint import Checkpoint
from mdanim_lammps.results.timeline import Timeline
from mdanim_lammps.results.trajectory import Trajectory
from scene_texts import POOL

SECRET = b"not to be touched"
pytestmark = pytest.mark.timeout(120)


def run(*arguments) -> int:
    """Exit code of a command, run in this process."""
    with pytest.raises(SystemExit) as end:  # noqa: PT012 -- some commands return, others exit
        cli.main([str(a) for a in arguments])
        raise SystemExit(0)
    return int(end.value.code)


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """A folder with a complete run of a pool, and one of a run that was stopped half way."""
    from mdanim_lammps import Scene

    folder = tmp_path_factory.mktemp("runs")
    (folder / "pool.txt").write_text(POOL)
    scene = Scene.load(folder / "pool.txt")
    scene.run(folder / "whole.out")
    stopped = folder / "stopped.out"
    with pytest.raises(Exception, match="interrupted"):
        scene.run(stopped, on_progress=lambda p: (stopped / "stop").touch())
    timeline = Timeline(2, "central", ("cube",))
    for frame in (0, 1):
        timeline.add(frame, [np.array([0]), np.zeros(0, int)], 0, 0)
    timeline.spans.append((0, "simulating", 1, 0.0, 1.0))
    timeline.write(folder / "whole.out")
    return folder


@pytest.fixture
def outside(tmp_path):
    """A file and an empty folder that no command may touch."""
    place = tmp_path / "outside"
    (place / "empty").mkdir(parents=True)
    (place / "secret").write_bytes(SECRET)
    yield place
    assert (place / "secret").read_bytes() == SECRET
    assert sorted(p.name for p in place.rglob("*")) == ["empty", "secret"]


@pytest.fixture
def whole(runs, tmp_path):
    """A copy of the complete run."""
    return shutil.copytree(runs / "whole.out", tmp_path / "whole.out")


@pytest.fixture
def stopped(runs, tmp_path):
    """A copy of the run that was stopped."""
    return shutil.copytree(runs / "stopped.out", tmp_path / "stopped.out")


def replace(path, make) -> None:
    """Put something else in the place of a file or folder."""
    if path.is_dir():
        shutil.rmtree(path)
    path.unlink(missing_ok=True)
    make(path)


def test_unchanged_folders_are_accepted(whole, stopped, capsys):
    """Draw, compare and resume what was not changed."""
    assert run("render", whole, "--size", 64, 48, "-q") == 0
    assert run("timeline", whole) == 0
    assert run("compare", whole, whole) == 0
    assert run("resume", stopped, "--no-movie", "-q") == 0
    assert run("compare", whole, stopped) == 0


NAMES = ["movie.mp4", "trajectory.h5", "trajectory.h5.part", "checkpoint", "ledger.csv", "summary.json", "trace.json",
         "timeline.json", "scene.lock.txt", "manifest.json", "frames", "stop", "study"]  # fmt: skip


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("target", ["secret", "empty", "new"])
def test_links_are_refused(whole, stopped, outside, capsys, name, target):
    """Neither read nor write through a link in an output folder."""
    for folder in (whole, stopped):
        replace(folder / name, lambda path: path.symlink_to(outside / target))
    commands = [("render", whole, "--frames", "--size", 64, 48), ("timeline", whole), ("compare", whole, whole),
                ("resume", stopped), ("render", stopped, "--size", 64, 48)]  # fmt: skip
    for command in commands:
        assert run(*command) == 7, command
        assert "Traceback" not in (message := capsys.readouterr().err) and name in message, command


def test_a_run_does_not_write_through_links(runs, whole, outside, capsys, tmp_path):
    """Refuse to simulate into a folder with a link, and into one that is a link beside the scene."""
    (whole / "study").symlink_to(outside / "empty")
    assert run(runs / "pool.txt", "-o", whole, "--force", "--no-movie") == 7
    assert run("study", runs / "pool.txt", "-o", whole, "--budget", "1 s") == 7
    assert "study is a link" in capsys.readouterr().err
    shutil.copy(runs / "pool.txt", tmp_path / "pool.txt")
    (tmp_path / "pool.out").symlink_to(outside / "empty")
    for command in ((tmp_path / "pool.txt", "--no-movie"), ("build", tmp_path / "pool.txt"), ("study", tmp_path / "pool.txt")):
        assert run(*command) == 7
        assert "pool.out is a link" in capsys.readouterr().err


@pytest.mark.parametrize("name", [*NAMES[:-3], "manifest.json"])
def test_pipes_do_not_hang(whole, stopped, runs, capsys, name):
    """End where a file is a pipe that nothing is written to."""
    for folder in (whole, stopped):
        replace(folder / name, os.mkfifo)
    for command in (("render", whole), ("timeline", whole), ("compare", whole, whole), ("resume", stopped),
                    (runs / "pool.txt", "-o", whole, "--force")):  # fmt: skip
        assert run(*command) == 7, command
    assert "Traceback" not in capsys.readouterr().err


@pytest.mark.parametrize(
    "text",
    [
        pytest.param("[]", id="a list"),
        pytest.param("[" * 100_000, id="deep"),
        pytest.param("{", id="cut off"),
        pytest.param("\udcff", id="no UTF-8"),
    ],
)
@pytest.mark.parametrize("name", ["manifest.json", "timeline.json"])
def test_damaged_json(whole, capsys, name, text):
    """A JSON file that is none, or not one of ours, is named."""
    (whole / name).write_text(text, errors="surrogateescape")
    assert run("timeline", whole) == 7
    assert f"{name} cannot be read" in capsys.readouterr().err


@pytest.mark.parametrize(
    "change",
    [
        {"executors": 10**12},
        {"executors": "two"},
        {"executors": -1},
        {"names": 5},
        {"names": ["cube"] * 3, "owners": [[0, 7, 0]]},
        {"owners": [[0, 0, 99]]},
        {"owners": "abc"},
        {"spans": [[0, "sleeping", 1, 0.0, 1.0]]},
        {"spans": [[0, "simulating", 1, 0.0, 1e400]]},
        {"spans": [[99, "simulating", 1, 0.0, 1.0]]},
        {"frames": [1, 0]},
        {"frames": [10**30, 10**31]},
        {"unknown": 1},
        {"teams": 3},
    ],
    ids=str,
)
def test_a_crafted_timeline(whole, capsys, change):
    """Numbers that name what is not there are refused, and none of them is a size of memory."""
    data = json.loads((whole / "timeline.json").read_text())
    (whole / "timeline.json").write_text(json.dumps(data | change))
    assert run("timeline", whole) == 7
    said = "cannot be read (Infinity is not a number of JSON)" if "Infinity" in json.dumps(change) else "is damaged"
    assert f"timeline.json {said}" in capsys.readouterr().err


def crafted(folder, change) -> None:
    """Change the trajectory of a folder; checksums are left out, as a stranger could make them fit."""
    with h5py.File(folder / "trajectory.h5", "r+") as file:
        file["parameters/mdanim"].attrs["format"] = 2
        del file["parameters/mdanim/checksum"]
        change(file)


def put(name, data, **options):
    """A change of a file: other data in the place of a table."""

    def change(file):
        del file[name]
        file.create_dataset(name, data=data, **options)

    return change


def larger(name, shape, dtype):
    """A change of a file: a table without data of a huge size."""

    def change(file):
        del file[name]
        file.create_dataset(name, shape, dtype, chunks=tuple(min(n, 1000) for n in shape), compression="gzip")

    return change


def linked(name, target):
    """A change of a file: a link to a table of another file."""

    def change(file):
        del file[name]
        file[name] = h5py.ExternalLink(target, "/a")

    return change


def edited(name, edit):
    """A change of a file: some numbers of a table."""

    def change(file):
        data = file[name][()]
        edit(data)
        put(name, data)(file)

    return change


def setitem(where, value):
    return lambda data: data.__setitem__(where, value)


def virtual(file):
    layout = h5py.VirtualLayout((3,), np.int64)
    layout[:] = h5py.VirtualSource("other.h5", "a", (3,))
    del file["particles/all/id"]
    file.create_virtual_dataset("particles/all/id", layout)


OWN = "parameters/mdanim/"


def painted(colors):
    """A change of a file: all surfaces are said to have colours."""

    def change(file):
        surfaces = file[OWN + "surface"]
        surfaces["painted"] = np.ones(len(surfaces["shape"]), np.uint8)
        surfaces["color"] = colors

    return change


CRAFTED = {
    "external link": linked("particles/all/mass", "/etc/passwd"),
    "external data": put("particles/all/mass", None, shape=(9,), dtype="u1", external=[("/etc/passwd", 0, 9)]),
    "virtual data": virtual,
    "many particles": larger("particles/all/id", (10**13,), np.int64),
    "many springs": larger("connectivity/bonds", (10**12, 2), np.int32),
    "a wide frame": larger("particles/all/position/value", (2, 10**12, 3), np.float64),
    "a high vertex": edited(OWN + "surface/triangle", setitem(0, 2**30)),
    "a vertex below 0": edited(OWN + "surface/triangle", setitem(0, -7)),
    "a high particle": edited(OWN + "surface/index", setitem(0, 2**30)),
    "a particle below 0": edited(OWN + "surface/index", setitem(0, -1)),
    "no weight": edited(OWN + "surface/weight", setitem(0, np.nan)),
    "few colours": painted(np.zeros(6, np.uint8)),
    "parts of colours": painted(np.zeros(7, np.uint8)),
    "colours that are none": painted(np.full(10**5, np.nan)),
    "a surface that is not there": edited(OWN + "surface_of", setitem(0, 5)),
    "particles of others": edited(OWN + "first", setitem(1, 10**9)),
    "a spring to nowhere": edited("connectivity/bonds", setitem((0, 0), 2**30)),
    "more names": put(OWN + "name", np.array([b"a", b"b"])),
    "no objects": put(OWN + "name", np.zeros(0, "S1")),
    "words for masses": put("particles/all/mass", np.array([b"x"] * 27)),
    "a mass that is none": edited("particles/all/mass", setitem(0, np.inf)),
    "steps that fall": edited("particles/all/position/step", setitem(3, 0)),
    "endless time": edited("particles/all/position/time", setitem(-1, np.inf)),
    "nowhere": edited("particles/all/position/value", setitem((2, 0), np.nan)),
    "far away": edited("observables/center_of_mass/value", setitem((2, 0), np.inf)),
    "basin without size": lambda file: file["observables/liquid"].attrs.__setitem__("shape", np.array([0, -1, 10**9])),
    "basin of NaN": lambda file: file["observables/liquid"].attrs.__setitem__("low", np.full(3, np.nan)),
    "many tags": lambda file: file["parameters/mdanim"].attrs.__setitem__("total", 10**17),
    "a title that is not text": lambda file: file["parameters/mdanim"].attrs.__setitem__("title", np.ones(3)),
}


@pytest.mark.parametrize("name", CRAFTED)
def test_a_crafted_trajectory(whole, capsys, name):
    """Refuse data in other files, sizes that do not fit in memory, and numbers that name what is not there."""
    crafted(whole, CRAFTED[name])
    assert run("render", whole, "--size", 64, 48, "-q") == 7
    message = capsys.readouterr().err
    assert "trajectory.h5" in message and "Traceback" not in message, message


@pytest.mark.parametrize("table", ["particles/all/position", "observables/center_of_mass", "observables/liquid/height"])
def test_a_damaged_frame_is_not_drawn(whole, capsys, table):
    """One number that differs from what was written ends the movie with the frame's number, and no movie is left."""
    with h5py.File(whole / "trajectory.h5", "r+") as file:
        values = file[f"{table}/value"][3]
        values.flat[0] += 1e-6
        file[f"{table}/value"][3] = values
    assert run("render", whole, "--size", 64, 48, "-q") == 7
    assert "frame 3 is damaged" in capsys.readouterr().err
    assert not (whole / "movie.mp4").exists()


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 0.9])
def test_a_cut_off_trajectory_is_not_drawn(whole, capsys, share):
    """A file that is cut off is named as damaged."""
    os.truncate(whole / "trajectory.h5", int(share * (whole / "trajectory.h5").stat().st_size))
    assert run("render", whole, "--size", 64, 48, "-q") == 7
    assert "trajectory.h5" in (message := capsys.readouterr().err) and "Traceback" not in message


def test_times_do_not_make_a_movie_endless(whole, capsys):
    """Refuse a rate at which a movie would have more pictures than can be drawn."""
    crafted(whole, edited("particles/all/position/time", setitem(-1, 1e30)))
    assert run("render", whole, "--fps", 30, "-q") == 2
    assert "too many" in capsys.readouterr().err


def checkpoint(folder, **change) -> None:
    """Change entries of a checkpoint."""
    with np.load(folder / "checkpoint", allow_pickle=False) as data:
        entries = {name: data[name] for name in data.files}
    with open(folder / "checkpoint", "wb") as file:
        np.savez(file, **entries | change)


class Pickled:
    """Runs a command when it is unpickled."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return os.remove, (str(self.path),)


@pytest.mark.parametrize(
    "change",
    [
        {"x": np.zeros((5, 3))},
        {"v": np.zeros((27, 4))},
        {"f": np.zeros((27, 3), complex)},
        {"step": 10**15},
        {"step": -1},
        {"frame": 10**9},
        {"frame": -3},
        {"data0": np.frombuffer(zlib.compress(b"\0" * 100), np.uint8)},
        {"data0": np.frombuffer(zlib.compress(b"\0" * 100), np.uint8), "first0": np.array([0, 100])},
        {"data0": np.arange(9, dtype=np.uint8)},
        {"first0": np.array([0, 2**60])},
        {"first0": np.array([-5, 100])},
        {"keys0": np.array([[7, 0]], np.int32)},
        {"keys0": np.array([[0, -9]], np.int32)},
        {"fixes": np.array(["another"])},
        {"run": "another"},
        {"ledger": 5},
        {"keys": np.array(["x"]), "values": np.array(["y"])},
    ],
    ids=lambda change: f"{next(iter(change))} {np.shape(next(iter(change.values())))} {str(next(iter(change.values())))[:12]}",
)
def test_a_crafted_checkpoint(stopped, capsys, change):
    """Refuse a state that is not one of this run."""
    checkpoint(stopped, **change)
    assert run("resume", stopped, "-q", "--no-movie") in (5, 7)
    assert "Traceback" not in capsys.readouterr().err


def test_nothing_is_unpickled(stopped, outside, capsys):
    """A checkpoint with a pickled command is refused, and the command does not run."""
    checkpoint(stopped, x=np.array([Pickled(outside / "secret")], dtype=object))
    assert run("resume", stopped) == 7
    assert "Traceback" not in capsys.readouterr().err


def test_a_packed_checkpoint_is_bounded(stopped, capsys, monkeypatch):
    """Refuse a checkpoint that unpacks to more than half of the free memory, before it is unpacked."""
    x = io.BytesIO()
    np.savez_compressed(x, x=np.zeros((10**6, 3)))
    (stopped / "checkpoint").write_bytes(x.getvalue())
    monkeypatch.setattr("mdanim_lammps.results.untrusted.available_memory", lambda: 1e6)
    monkeypatch.setattr(np, "load", lambda *_, **__: pytest.fail("unpacked"))
    assert run("resume", stopped) == 7
    assert "would take" in capsys.readouterr().err


@pytest.mark.parametrize("line", ['render { movie "/outside.mp4" }', 'render { movie "../outside.mp4" }', 'include "/dev/zero"',
                                  'include "/proc/kmsg"', "render { size (100000, 100000) }"])  # fmt: skip
def test_a_crafted_lock(whole, tmp_path, capsys, line):
    """The scene in an output folder is held to what other scenes are held to."""
    with (whole / "scene.lock.txt").open("a") as file:
        file.write(line + "\n")
    before = sorted(tmp_path.rglob("*"))
    assert run("render", whole, "--size", 64, 48) == 3
    assert sorted(tmp_path.rglob("*")) == before and "Traceback" not in capsys.readouterr().err


def test_a_stored_study_names_no_files(runs, tmp_path, outside, capsys):
    """Settings of a stored study that are not numbers do not become names of files."""
    from mdanim_lammps.scene.parse import load_scene
    from mdanim_lammps.study.setting import scene_hash

    study = tmp_path / "x.out" / "study"
    study.mkdir(parents=True)
    setting = {"cells": 2.0, "fraction": 0.5, "sweeps": "/../../outside/new", "contact": 1.0}
    runs_of = {name: [] for name in ("seconds", "wall", "drift", "penetration", "found")}
    point = {"setting": setting, "timestep": 1.0, "steps": 1, "particles": 1, "problem": "", "runs": runs_of}
    data = {"hash": scene_hash(load_scene(runs / "pool.txt")), "points": [point]}
    (study / "study.json").write_text(json.dumps(data))
    assert run("study", runs / "pool.txt", "-o", tmp_path / "x.out", "--budget", "1 s") == 7
    assert "setting.sweeps must be a whole number" in capsys.readouterr().err


def test_the_crafted_data_are_those_of_a_run(whole, stopped):
    """The tests above change what is there."""
    with Trajectory(whole) as t:
        assert len(t) == 9 and len(t.metadata.mass) == 27 and t.liquid
    records = Checkpoint.read(stopped / "checkpoint").records
    assert {fix: len(r) for fix, r in records.items() if len(r)} == {"liquid": 2}  # of the whole, and of its one object
