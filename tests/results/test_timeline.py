# SPDX-License-Identifier: GPL-2.0-only
"""The log of a distributed run: which executor owned what, read as it was written."""

import json

import numpy as np
import pytest
from mdanim_lammps.errors import OutputError
from mdanim_lammps.results.timeline import TIMELINE, Timeline


def log() -> Timeline:
    """Four objects on two executors: the second never moves, the last two change places, one has none for a frame."""
    timeline = Timeline(2, "central", ("a", "stone", "b", "c"))
    timeline.add(5, [np.array([0, 2]), np.array([3])], 0, 0)
    timeline.add(6, [np.array([0, 2]), np.array([3])], 0, 2)
    timeline.add(7, [np.array([0, 3]), np.array([2])], 2, 0, [(1, 0)])
    timeline.add(8, [np.array([0]), np.array([2])], 0, 1)
    timeline.spans += [(0, "simulating", 5, 0.0, 0.25), (1, "frozen", 6, 0.25, 0.5)]
    return timeline


def test_owners_of_every_frame():
    """Only changes are kept; the table has every frame, also of a run that began at a later one."""
    timeline = log()
    assert timeline.owners == [(5, 0, 0), (5, 2, 0), (5, 3, 1), (7, 2, 1), (7, 3, 0), (8, 3, -1)]
    assert timeline.owner().tolist() == [[0, -1, 0, 1], [0, -1, 0, 1], [0, -1, 1, 0], [0, -1, 1, -1]]
    assert (timeline.frames, timeline.moves, timeline.retries) == ([5, 6, 7, 8], [0, 0, 2, 0], [0, 2, 0, 1])
    assert timeline.teams == [(7, (1, 0))]


def test_a_resume_goes_on_with_the_log(tmp_path):
    """Three executors after two, from frame 6 on: what was done beyond is left out, times go on,
    only changes of owners are told."""
    before, now = log(), Timeline(3, "peers", ("a", "stone", "b", "c"))
    before.spans.append((0, "simulating", 7, 0.5, 9.0))
    before.cpu, before.supervisor_cpu = [2.0, 1.0], 0.5
    now.add(7, [np.array([0]), np.array([3]), np.array([2])], 1, 3, [(2, 1)])
    now.add(8, [np.array([0]), np.array([3]), np.array([2])], 0, 0)
    now.spans.append((2, "moving", 7, 0.125, 0.25))
    now.cpu, now.supervisor_cpu = [4.0, 5.0, 6.0], 0.25
    both = now.after(before, 6)
    assert both.frames == [5, 6, 7, 8] and both.moves == [0, 0, 1, 0] and both.retries == [0, 2, 3, 0]
    assert both.owners == [(5, 0, 0), (5, 2, 0), (5, 3, 1), (7, 2, 2)] and both.teams == [(7, (2, 1))]
    assert both.owner().tolist() == [[0, -1, 0, 1]] * 2 + [[0, -1, 2, 1]] * 2
    assert both.spans == [*log().spans, (2, "moving", 7, 0.625, 0.75)]
    assert (both.executors, both.control, both.cpu, both.supervisor_cpu) == (3, "peers", [6.0, 6.0, 6.0], 0.75)
    both.write(tmp_path)
    assert Timeline.left_in(tmp_path) == both


def test_the_log_of_a_resume_that_came_to_no_frame():
    """It is the log before, up to the checkpoint."""
    both = Timeline(1, "central", log().names).after(log(), 7)
    assert both.frames == [5, 6, 7] and both.owners == log().owners[:5] and both.teams == log().teams
    assert (both.executors, both.cpu) == (2, [0.0, 0.0])


def test_what_is_read_is_what_was_written(tmp_path):
    """Field by field, and plain JSON."""
    timeline = log()
    timeline.write(tmp_path)
    assert Timeline.read(tmp_path) == timeline
    assert np.array_equal(Timeline.read(tmp_path).owner(), timeline.owner())
    assert json.loads((tmp_path / TIMELINE).read_text())["control"] == "central"


def test_a_missing_timeline_is_told(tmp_path):
    """A sequential run leaves none."""
    with pytest.raises(OutputError, match=r"timeline\.json cannot be read"):
        Timeline.read(tmp_path)
    assert Timeline.left_in(tmp_path) is None
