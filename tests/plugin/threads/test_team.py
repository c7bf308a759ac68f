# SPDX-License-Identifier: GPL-2.0-only
"""Threads that share tasks: plugin/threads/team.h, without LAMMPS."""

import os
import subprocess
import sys
import threading

import numpy as np
import pytest
from engine_lab import functions


def counts(threads: int, tasks: int, calls: int, task_us: int = 0) -> list[int]:
    """How often each task was done."""
    count = np.zeros(tasks, np.int32)
    functions().mdanim_team_count(threads, tasks, calls, task_us, count)
    return count.tolist()


@pytest.mark.parametrize("threads", [1, 3, 40])
@pytest.mark.parametrize("tasks", [0, 1, 2, 7, 32])
def test_each_task_is_done_once(threads, tasks):
    """In every call, by fewer or more threads than tasks, more threads than processors among them."""
    assert counts(threads, tasks, 40) == [40] * tasks


def test_sleeping_threads_take_their_share():
    """They are woken, and round as the caller does. Tasks leave the processor free: one processor is enough to see it."""
    found = np.zeros(2, np.int32)
    functions().mdanim_team_wakes(3, 12, 50_000, 50_000, found)
    threads, other_modes = found
    assert threads == 3 and other_modes == 0


def test_others_do_the_tasks_of_a_caller_that_rests():
    """MDANIM_CALLER_RESTS is read once in a process."""
    code = (
        "import numpy as np; from engine_lab import functions; found = np.zeros(2, np.int32); "
        "functions().mdanim_team_wakes(3, 4, 10_000, 20_000, found); print(found[0])"
    )
    rests = {**os.environ, "MDANIM_CALLER_RESTS": "1", "PYTHONPATH": os.pathsep.join(sys.path)}
    done = subprocess.run([sys.executable, "-c", code], env=rests, capture_output=True, text=True)
    assert done.stdout == "2\n", done.stderr


@pytest.mark.parametrize("threads", [1, 3])
def test_what_a_task_throws_is_thrown_by_the_call(threads):
    """When all tasks are done, in each of many calls; the team goes on."""
    calls = 200
    assert functions().mdanim_team_throws(threads, 1 if threads == 1 else 6, calls) == calls
    assert counts(threads, 4, 10) == [10] * 4


def test_callers_at_once_do_not_mix():
    """Two threads of a program that call at the same time each get their own tasks done, once."""
    found = []
    callers = [threading.Thread(target=lambda n=n: found.append((n, counts(3, n, 400, task_us=1)))) for n in (5, 6, 7)]
    for caller in callers:
        caller.start()
    for caller in callers:
        caller.join()
    assert sorted(found) == [(n, [400] * n) for n in (5, 6, 7)]


def test_a_forked_process_does_its_tasks_alone():
    """A fork has no threads of its parent's team: what it calls still ends."""
    assert counts(3, 4, 10) == [10] * 4
    child = os.fork()
    if child == 0:
        os._exit(0 if counts(3, 4, 10) == [10] * 4 else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


def test_threads_end_with_their_team():
    """After the last owner nothing runs on."""
    before = len(os.listdir("/proc/self/task"))
    counts(6, 6, 3)
    assert len(os.listdir("/proc/self/task")) == before
