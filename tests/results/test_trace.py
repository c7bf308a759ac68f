# SPDX-License-Identifier: GPL-2.0-only
"""The log of a run on executors, the trace that viewers open, and the command that writes it."""

import json
from itertools import pairwise

import numpy as np
import pytest
from command_line import GOOD, call, run
from mdanim_lammps.errors import OutputError
from mdanim_lammps.results.timeline import KINDS, Timeline
from mdanim_lammps.results.trace import write_trace


def log(executors=2, objects=3, frames=4):
    """A run in which object 0 is held, object 1 stays with executor 0, and the others go to the next executor in every frame."""
    timeline = Timeline(executors, "central", tuple(f"o[{m}]" for m in range(objects)))
    for frame in range(frames + 1):
        of = np.where(np.arange(objects) == 1, 0, (np.arange(objects) + frame) % executors)
        timeline.add(frame, [np.flatnonzero((of == e) & (np.arange(objects) > 0)) for e in range(executors)], 1, int(frame == 2))
        for e in range(executors if frame else 0):
            timeline.spans += [
                (e, "moving", frame, frame - 1.0, frame - 0.9),
                (e, "simulating", frame, frame - 0.9, frame - 0.4),
                (e, "frozen" if frame == 2 else "waiting", frame, frame - 0.4, frame - 0.1 * e),
            ]
    return timeline


def test_owners_are_those_of_every_frame(tmp_path):
    """Give the owner of every object in every frame, also after the log was written and read."""
    timeline = log()
    timeline.write(tmp_path)
    for t in (timeline, Timeline.read(tmp_path)):
        assert t.owner().tolist() == [[-1, 0, 0], [-1, 0, 1], [-1, 0, 0], [-1, 0, 1], [-1, 0, 0]]
        assert t.cpu == [0.0, 0.0] and t.seconds == 4.0


def test_time_is_shared_out():
    """Every executor's time by kind, how busy it was, and when each frame ended."""
    timeline = log()
    spent = dict(zip(KINDS, timeline.spent().T))
    assert spent["simulating"] == pytest.approx([2.0, 2.0]) and spent["moving"] == pytest.approx([0.4, 0.4])
    assert spent["waiting"] == pytest.approx([1.2, 0.9]) and spent["frozen"] == pytest.approx([0.4, 0.3])
    assert timeline.busy() == pytest.approx([0.5, 0.5])
    assert timeline.frame_ends() == pytest.approx({1: 1.0, 2: 2.0, 3: 3.0, 4: 4.0})


def told(timeline, place):
    """Events of the trace by what they are."""
    write_trace(timeline, place, "Which of them float?")
    trace = json.loads(place.read_text())
    found = {}
    for event in trace["traceEvents"]:
        found.setdefault(event["ph"], []).append(event)
    return trace, found


def test_spans_of_executors(tmp_path):
    """Each as long as in the log, with its frame; those of one executor follow each other."""
    timeline = log()
    trace, events = told(timeline, tmp_path / "trace.json")
    assert trace["otherData"] | {"software": ""} == {
        "title": "Which of them float?",
        "executors": 2,
        "control": "central",
        "software": "",
    }
    names = {(e["pid"], e["tid"]): e["args"]["name"] for e in events["M"] if e["name"] == "thread_name"}
    assert names == {(1, 0): "executor 0: simulating 50 %", (1, 1): "executor 1: simulating 50 %", (2, 1): "o[1]", (2, 2): "o[2]"}
    for executor in (0, 1):
        spans = [e for e in events["X"] if (e["pid"], e["tid"]) == (1, executor)]
        assert [e["args"]["frame"] for e in spans] == [1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4]
        assert all(a["ts"] + a["dur"] <= b["ts"] for a, b in pairwise(spans))
        for kind, seconds in zip(KINDS, timeline.spent()[executor]):
            assert 1e-6 * sum(e["dur"] for e in spans if e["name"] == kind) == pytest.approx(seconds)


def test_owners_and_counts(tmp_path):
    """An object is an executor's from the end of one frame to that of another; counts stand at the ends of frames."""
    _, events = told(log(), tmp_path / "trace.json")
    owned = [(e["tid"], e["name"], 1e-6 * e["ts"], 1e-6 * e["dur"]) for e in events["X"] if e["pid"] == 2]
    assert owned[0] == (1, "executor 0", 0.0, 4.0)
    assert [row[:2] for row in owned[1:]] == [(2, f"executor {frame % 2}") for frame in range(5)]
    assert np.array([row[2:] for row in owned[1:]]) == pytest.approx(np.array([[0, 1], [1, 1], [2, 1], [3, 1], [4, 0]]))
    assert [e["name"] for e in events["i"]] == [f"end of frame {frame}" for frame in range(5)]
    assert [1e-6 * e["ts"] for e in events["i"]] == pytest.approx([0.0, 1.0, 2.0, 3.0, 4.0])
    again = [e["args"]["windows begun again"] for e in events["C"] if e["name"] == "windows begun again"]
    assert again == [0, 0, 1, 0, 0]


def test_a_log_without_spans(tmp_path):
    """Executors that were stopped at once have none; without a frame there is nothing to show."""
    timeline = Timeline(2, "central", ("a",))
    timeline.add(0, [np.array([0]), np.zeros(0, int)], 0, 0)
    _, events = told(timeline, tmp_path / "trace.json")
    assert len(events["X"]) == 1 and events["X"][0]["dur"] == 0
    with pytest.raises(OutputError, match="before its first frame"):
        write_trace(Timeline(2, "central", ("a",)), tmp_path / "none.json")


def test_the_command_line_tells_and_traces(tmp_path):
    """A run on executors says how many there are, what they did, and how to see it; one process has no timeline."""
    (tmp_path / "cube.txt").write_text(GOOD)
    done = run("cube.txt", "-n", "2", "--no-movie", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    lines = [line for line in done.stdout.splitlines() if line.startswith("spread")]
    assert lines[0].startswith("spread   over 2 executors and a supervisor; the supervisor decides")
    assert lines[1].startswith("spread   2 executors, central: 0 objects moved, 0 windows begun again, busy ")
    assert lines[1].endswith(f"mdanim-lammps timeline {tmp_path / 'cube.out'}")
    drawn = call("timeline", "cube.out", cwd=tmp_path)
    assert drawn.stdout.startswith("trace    cube.out/trace.json "), drawn.stderr
    assert json.loads((tmp_path / "cube.out" / "trace.json").read_text())["otherData"]["executors"] == 2
    assert call("timeline", "cube.out", cwd=tmp_path).returncode == 0, "what this program has made is made again"

    assert "spread" not in call("cube.txt", "--force", "--no-movie", cwd=tmp_path).stdout
    refused = call("timeline", "cube.out", cwd=tmp_path)
    assert refused.returncode == 4 and "by one process" in refused.stderr and "-n" in refused.stderr
    assert call("timeline", "nowhere", cwd=tmp_path).returncode == 7
