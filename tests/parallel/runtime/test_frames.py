# SPDX-License-Identifier: GPL-2.0-only
"""Executors write their own rows of frames: the file is that of the sequential program, whatever is stored or goes wrong."""

import re
import time
from pathlib import Path

import pytest
from distribution_lab import MEASURED, SEQUENTIAL, matrix, readied, same_file, ways
from mdanim_lammps.errors import DivergedError, ExecutorLost, OutputError
from mdanim_lammps.parallel.plan.frame_plan import PlannerOptions
from mdanim_lammps.parallel.runtime.launch import simulate_on
from mdanim_lammps.results.checkpoint import Checkpoint
from mdanim_lammps.results.ledger import Ledger
from mdanim_lammps.results.timeline import Timeline
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.run.loop import simulate
from mpi import scenes as films
from ranks_lab import environment

pytestmark = pytest.mark.mpi


def stored(text: str, how: str) -> str:
    """A scene that stores its frames so."""
    return text.replace("control {", f"control {{ save {how} ", 1)


FLYING = films.FLYING.split("expect")[0].replace("time 0.2 s", "time 0.1 s")
TEAM = {"least": 50}
RANKS = TEAM | {"by_threads": False}
FORMS = {
    "flying": (FLYING, matrix((2,), ["central"]) | matrix((3,), ["peers"], "all move ", rotate=True)),
    "still ones, boundary": (stored(films.MIXED, "boundary"), matrix((1, 4), ["central"])),
    "still ones, single": (stored(films.MIXED, "all single"), matrix((3,), ["peers"])),
    "a team, boundary single": (stored(films.HEAVY, "boundary single"), matrix((3,), ["peers"], settings=TEAM)),
    "liquid": (films.POOL + MEASURED, matrix((3,), ["central"])),
}


@pytest.mark.parametrize("name", FORMS)
def test_the_file_is_that_of_the_sequential_program(scene, name):
    """To the byte, with whatever is stored; test_distribution.py compares files that have all particles."""
    text, cases = FORMS[name]
    text = text if "gravity" in text else films.GRAVITY + text
    found = ways(scene(text), cases)
    for way in cases:
        same_file(found["sequential"], found[way])
    if "team" in name:
        assert all(Timeline.read(found[way]).teams for way in cases)


def test_a_file_that_several_numbers_of_executors_have_written(scene):
    """Stopped, and resumed with more, with a team, and with none."""
    cases = {
        "a": {"executors": 3, "control": "central", "stop": 3},
        "a more": {"executors": 4, "control": "peers", "resume": True, "in": "a", "stop": 6},
        "a alone": SEQUENTIAL | {"resume": True, "in": "a"},
        "b": SEQUENTIAL | {"stop": 3},
        "b team": {"executors": 2, "control": "central", "resume": True, "in": "b", "settings": {"least": 50}},
    }
    found = ways(scene(stored(films.MIXED, "boundary")), cases)
    for way in ("a", "b"):
        same_file(found["sequential"], found[way])


# --- on single ranks --------------------------------------------------------------------------------------------------


ON_RANK = 'import os\nif os.environ.get("PMI_RANK") == "2":\n'


def on_executor_1(place: Path, monkeypatch, code: str) -> None:
    """Run this code at the start of every process that is executor 1."""
    (place / "sitecustomize.py").write_text(ON_RANK + "".join(f"    {line}\n" for line in code.splitlines()))
    monkeypatch.setenv("PYTHONPATH", environment(place)["PYTHONPATH"])


def goes_on_to_the_end(place: Path, ready, executors: int) -> None:
    """Resume without the fault, and find the bits of a run without one."""
    (place / "sitecustomize.py").unlink()
    simulate_on(executors, "central", ready, place / "film.out", resume=Checkpoint.read(place / "film.out" / "checkpoint"))
    (place / "whole").mkdir()
    simulate(ready, place / "whole")
    same_file(place / "whole", place / "film.out")


AT_FRAME_8 = """
import errno
from mdanim_lammps.results.frame_rows import RowWriter
pwrite, write = os.pwrite, RowWriter.write
def late(self, frame, *what):
    if frame == 8:
        os.pwrite = broken
    return write(self, frame, *what)
RowWriter.write = late
def broken(file, data, offset):
    {what}
"""
FULL = AT_FRAME_8.format(what="raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))")
KILLED = AT_FRAME_8.format(what="pwrite(file, data[: len(data) // 2], offset); os.kill(os.getpid(), 9)")
SHORT = films.FLYING.split("expect")[0].replace("time 0.2 s", "time 0.16 s")


@pytest.mark.parametrize("settings", [{}, RANKS, {"least": 50}], ids=["alone", "in a team by ranks", "in a team"])
def test_a_disk_that_is_full_for_an_executor(tmp_path, monkeypatch, settings):
    """The frame that it cannot write does not count, those before it do; the run ends with its message, and can go on."""
    ready, folder = readied(tmp_path, SHORT)
    on_executor_1(tmp_path, monkeypatch, FULL)
    with pytest.raises(
        OutputError, match=r"trajectory\.h5\.part: cannot be written: No space left on device; make room and resume"
    ):
        simulate_on(2, "central", ready, folder, settings=PlannerOptions(**settings))
    with Trajectory(folder) as film:
        assert 0 < len(film) <= 8
        for frame in range(len(film)):
            film.check(frame)
        assert len(Ledger.read(folder / "ledger.csv").rows) == len(film)
    goes_on_to_the_end(tmp_path, ready, 3)


def test_a_sync_that_fails_for_an_executor(tmp_path, monkeypatch):
    """A frame that may not be on the disk has no checkpoint."""
    ready, folder = readied(tmp_path, SHORT)
    code = "import errno\ndef fdatasync(file):\n    raise OSError(errno.EIO, os.strerror(errno.EIO))\nos.fdatasync = fdatasync"
    on_executor_1(tmp_path, monkeypatch, code)
    with pytest.raises(OutputError, match=r"trajectory\.h5\.part: cannot be written: Input/output error"):
        simulate_on(2, "peers", ready, folder)
    assert not (folder / "checkpoint").exists()
    with Trajectory(folder) as film:
        assert len(film) == 0


def test_an_executor_that_does_not_see_the_folder(tmp_path, monkeypatch):
    """As on a host that does not share it."""
    ready, folder = readied(tmp_path, SHORT)
    code = """
from errno import ENOENT
whole = os.open
def elsewhere(path, *more, **options):
    if str(path).endswith("trajectory.h5.part"):
        raise FileNotFoundError(ENOENT, os.strerror(ENOENT))
    return whole(path, *more, **options)
os.open = elsewhere
"""
    on_executor_1(tmp_path, monkeypatch, code)
    begin = time.monotonic()
    with pytest.raises(OutputError, match=r"cannot be opened on .*No such file.*all ranks write into the output folder"):
        simulate_on(2, "central", ready, folder)
    assert time.monotonic() - begin < 60.0


TOLD = """
import pickle
from mdanim_lammps.parallel.runtime.messages import Mail
send = Mail.send
def told(self, to, tag, message, comm=None):
    with open(os.environ["TOLD"], "a") as file:
        file.write(f"{type(message).__name__} {len(pickle.dumps(message))}\\n")
    return send(self, to, tag, message, comm)
Mail.send = told
sync = os.fdatasync
def synced(file):
    sync(file)
    with open(os.environ["TOLD"], "a") as log:
        log.write("sync 0\\n")
os.fdatasync = synced
"""


def told(place: Path, monkeypatch, text: str) -> list[tuple[str, int]]:
    """Kind and size of every message of executor 1, and when it made its rows durable."""
    place.mkdir()
    ready, folder = readied(place, text)
    monkeypatch.setenv("TOLD", str(place / "told"))
    on_executor_1(place, monkeypatch, TOLD)
    simulate_on(2, "central", ready, folder)
    (place / "sitecustomize.py").unlink()
    return [(name, int(size)) for name, size in re.findall(r"(\w+) (\d+)", (place / "told").read_text())]


def test_what_a_frame_takes_of_the_supervisor_does_not_grow_with_particles(tmp_path, monkeypatch):
    """A share is as large for many times as many particles; and rows are durable before an executor says so."""
    text = films.APART.replace("0.1 s", "0.05 s")
    few, many = (told(tmp_path / r, monkeypatch, text.replace("2.5 cm", f"{r} cm")) for r in ("2.5", "1.25"))
    sizes = [[size for name, size in lines if name == "Share"] for lines in (few, many)]
    kept = [[size for name, size in lines if name == "Kept"] for lines in (few, many)]
    assert len(sizes[0]) == len(sizes[1]) == 6
    # Some have an account, of 420 bytes; positions and velocities of the fewer particles alone would be 5 kB.
    assert max(sizes[1]) < min(sizes[0]) + 1000
    # At the start, before measured times have given an executor other objects.
    assert kept[1][0] > 4 * kept[0][0], "there are more particles"
    for lines in (few, many):
        names = [name for name, _ in lines]
        assert names.count("Kept") >= 2
        assert all(names[k - 1] == "sync" for k, name in enumerate(names) if name == "Kept")


def test_every_frame_before_the_end_of_a_killed_run_is_whole(tmp_path, monkeypatch):
    """Killed in the middle of a write of an executor, the run goes on from its checkpoint to the same bits."""
    ready, folder = readied(tmp_path, SHORT)
    on_executor_1(tmp_path, monkeypatch, KILLED)
    with pytest.raises(ExecutorLost):
        simulate_on(2, "peers", ready, folder)
    with Trajectory(folder) as film:
        assert 0 < len(film) <= 8
        for frame in range(len(film)):
            film.check(frame)
    goes_on_to_the_end(tmp_path, ready, 1)


BALL = (
    "object ball {{ shape box (10, 10, 10) cm  position (0, 0, 30) cm  density 1000  elasticity {}  velocity (0, 0, -{}) {} }}\n"
)
BLOCK = "object block { shape box (30, 30, 30) cm  position (0, 0, 5) cm  density 1000  elasticity 2 kPa  hold all }\n"
OTHER = "object other { shape box (10, 10, 10) cm  position (3, 0, 30) m  density 1000  elasticity 1 MPa }\n"
END = "control { time 1 s  frames 100 fps  resolution 2.5 cm }\n"
STOPS = {
    "inside a still one": (BALL.format("2 kPa", 6, "") + BLOCK + OTHER + END, "ball: it is inside block"),
    "gone": ("ground z 0\n" + OTHER + BALL.format("1 kPa", 20, "") + END, "ball: it has left the ground"),
    "crumpled": (
        "ground z 0\n" + OTHER + BALL.format("20 kPa", 3, "orientation euler (10, 20, 30) deg") + END,
        "cells have been inside out since step",
    ),
}


@pytest.mark.parametrize("settings", [{}, RANKS, {"least": 50}], ids=["alone", "in a team by ranks", "in a team"])
@pytest.mark.parametrize("name", STOPS)
def test_the_guard_stops_what_it_stops_in_one_process(tmp_path, name, settings):
    """At the same step, with the same words, also where what it looks at is on several executors."""
    text, expected = STOPS[name]
    ready, folder = readied(tmp_path, text)
    (tmp_path / "one").mkdir()
    told = []
    for run in (
        lambda: simulate(ready, tmp_path / "one"),
        lambda: simulate_on(2, "central", ready, folder, settings=PlannerOptions(**settings)),
    ):
        with pytest.raises(DivergedError) as caught:
            run()
        told.append(str(caught.value).split("\n"))
    assert expected in told[0][0] and told[0][:-1] == told[1][:-1]
    with Trajectory(folder) as together, Trajectory(tmp_path / "one") as alone:
        assert len(together) == len(alone) > 0
