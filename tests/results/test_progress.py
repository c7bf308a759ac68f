# SPDX-License-Identifier: GPL-2.0-only
"""progress.jsonl: what is written is read, whatever has happened to the file."""

import json

import pytest
from mdanim_lammps import Scene
from mdanim_lammps.errors import OutputError
from mdanim_lammps.results.ledger import Ledger
from mdanim_lammps.results.progress import PROGRESS, ProgressLog, ProgressTail
from mdanim_lammps.run.loop import Interrupted
from scene_texts import FALL

COLUMNS = ("time", "kinetic", "residual")


def log(folder, **more) -> ProgressLog:
    """A log of a run of ten frames."""
    return ProgressLog(folder, columns=COLUMNS, energies=1, frames=10, executors=2, **more)


def row(frame: int) -> dict[str, float]:
    """The ledger's row of a frame, in another order than the columns."""
    return {"residual": 0.5, "time": 0.1 * frame, "kinetic": 2.0**-frame}


def read(folder) -> ProgressTail:
    """All that a folder's file says."""
    tail = ProgressTail(folder)
    tail.read()
    tail.close()
    return tail


def test_what_is_written_is_read(tmp_path):
    """Rows in the order of the columns, owners, cost and states."""
    with log(tmp_path) as out:
        out.frame(0, row(0), 0.0, [(0, 1), (1, 0)])
        out.frame(1, row(1), 0.25)
        out.cost({"springs": 0.2})
        out.state("paused")
        found = read(tmp_path)
    assert (found.columns, found.energies, found.total, found.executors) == (list(COLUMNS), 1, 10, 2)
    assert found.rows.tolist() == [0.0, 1.0, 0.5, 0.1, 0.5, 0.5] and found.count == 2 and found.seconds == 0.25
    assert found.owners == [(0, 0, 1), (0, 1, 0)] and found.cost == {"springs": 0.2} and found.state == "paused"
    assert read(tmp_path).state == "done"


@pytest.mark.parametrize(("error", "state"), [(Interrupted("by a test"), "stopped"), (OutputError("no room"), "failed")])
def test_the_end_says_why(tmp_path, error, state):
    """A run that is stopped, and one that fails, leave the message."""
    with pytest.raises(type(error)), log(tmp_path):
        raise error
    assert (read(tmp_path).state, read(tmp_path).message) == (state, str(error))


def test_a_resumed_run_takes_back_what_came_after(tmp_path):
    """Frames after the checkpoint, and half a line of a killed run, count no more; frames before it stay."""
    with log(tmp_path) as out:
        for frame in range(4):
            out.frame(frame, row(frame), 0.0, [(0, frame % 2)])
    with open(tmp_path / PROGRESS, "a") as file:
        file.write('{"frame": 4, "row": [0.4, 0.06')
    tail = ProgressTail(tmp_path)
    tail.read()
    assert tail.count == 4 and tail.lives == 1
    out = log(tmp_path, resumed=1)
    out.frame(2, row(9), 0.0)
    assert not tail.read()
    assert (tail.count, tail.keep, tail.lives, tail.state) == (3, 2, 2, "running")
    assert tail.rows[-3:].tolist() == [row(9)[column] for column in COLUMNS]
    assert tail.owners == [(0, 0, 0), (1, 0, 1)]
    assert read(tmp_path).rows == tail.rows


def test_a_run_begun_anew_is_noticed(tmp_path):
    """Another file of the same name: all that was known is forgotten."""
    with log(tmp_path) as out:
        out.frame(0, row(0), 0.0)
    tail = ProgressTail(tmp_path)
    tail.read()
    (tmp_path / PROGRESS).unlink()
    assert not tail.read() and tail.count == 1
    with log(tmp_path):
        assert tail.read() and tail.count == 0 and tail.state == "running"


@pytest.mark.parametrize(
    "line",
    ["[]", "17", "{", "\x00\xff", '{"frame": 1, "row": [1]}', '{"frame": 7, "row": [1, 2, 3], "seconds": 0}', "[" * 100_000,
     '{"frame": 1, "row": ["x", 2, 3], "seconds": 0}', '{"cost": 3}', '{"frame": 1, "row": [1, NaN, 3], "seconds": 0}'],
)  # fmt: skip
def test_lines_of_a_stranger_are_left_out(tmp_path, line):
    """Lines that no run writes neither end the reader nor count."""
    with log(tmp_path) as out:
        out.frame(0, row(0), 0.0)
        (tmp_path / PROGRESS).open("a", encoding="latin-1").write(line + "\n")
        out.frame(1, row(1), 0.0)
    found = read(tmp_path)
    assert found.count == 2 and found.state == "done" and len(found.rows) == 6


def test_links_are_not_followed(tmp_path):
    """Neither to write nor to read."""
    (tmp_path / "secret").write_text("{}\n")
    (tmp_path / PROGRESS).symlink_to(tmp_path / "secret")
    with pytest.raises(OutputError, match=PROGRESS):
        log(tmp_path)
    with pytest.raises(OSError, match="symbolic"):
        read(tmp_path)
    assert (tmp_path / "secret").read_text() == "{}\n"


def test_a_run_tells_its_ledger(tmp_path):
    """Every frame of a run has its row, as ledger.csv has it."""
    (tmp_path / "fall.txt").write_text(FALL)
    Scene.load(tmp_path / "fall.txt").run(tmp_path / "out")
    found, ledger = read(tmp_path / "out"), Ledger.read(tmp_path / "out" / "ledger.csv")
    assert found.columns == list(ledger.columns) and found.state == "done" and found.count == found.total == 16
    assert found.rows.tolist() == [r[column] for r in ledger.rows for column in ledger.columns]
    first = json.loads((tmp_path / "out" / PROGRESS).read_text().splitlines()[0])
    assert first["executors"] == 1 and first["energies"] == len(ledger.terms)
