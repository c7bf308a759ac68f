# SPDX-License-Identifier: GPL-2.0-only
"""The program of every MPI rank of a distributed run: `main`, with the argument JOB.

Rank 0 is the supervisor: it takes the job that launch.py has left in this file. Progress goes to its standard output, a line of
JSON for every frame, and at the end the result. All others are executors.
"""

from __future__ import annotations

import base64
import json
import os
import pickle
import sys
import threading
import time
import traceback
from dataclasses import asdict, replace
from pathlib import Path

from ...engine.threads import THREADS, share_of_cores
from ...errors import MdanimError, OutputError
from .launch import RESULT_SIGN, Task, lost

PATIENCE = 30.0
"""Seconds for which an executor that has failed waits for the supervisor to end all ranks, until it does so itself."""


WATCH = 0.5
"""Seconds between two looks whether the launcher is alive."""


def main() -> None:
    """Be the supervisor, or an executor."""
    threading.Thread(target=_end_with, args=(os.getppid(),), daemon=True).start()
    from mpi4py import MPI

    from .messages import SUPERVISOR

    world, done = MPI.COMM_WORLD, False
    try:
        share_out_cores(world)
        one_host = are_on_one_host(world)
        if world.rank == SUPERVISOR:
            _supervise(world, Path(sys.argv[1]), one_host)
            done = True
        else:
            from .executor import serve

            done = serve(world)
            if not done:
                time.sleep(PATIENCE)
    except BaseException:
        traceback.print_exc()
        raise
    finally:
        if not done:  # MPI's own end would wait for all other ranks, which may wait for this one
            sys.stderr.flush()
            world.Abort(1)


def _end_with(launcher: int) -> None:
    """End this rank when the process that has started it has ended: without it ranks neither give a result nor end each other."""
    while os.getppid() == launcher:
        time.sleep(WATCH)
    os._exit(1)


def share_out_cores(world) -> None:
    """Unless a number of threads was asked for, an executor has those of its host's cores that the others there leave; the
    supervisor mostly waits."""
    from .messages import SUPERVISOR

    executors = _executors_among(world)
    if world.rank != SUPERVISOR:
        os.environ.setdefault(THREADS, str(share_of_cores(executors)))


def are_on_one_host(world) -> bool:
    """Whether all executors share memory; all ranks call this together."""
    from mpi4py import MPI

    executors = _executors_among(world)
    alone = executors.Split_type(MPI.COMM_TYPE_SHARED).size == executors.size
    return bool(world.allreduce(alone, MPI.LAND))


def _executors_among(world):
    """Their communicator; for the supervisor one of its own."""
    from .messages import SUPERVISOR

    return world.Split(world.rank == SUPERVISOR)


def _supervise(world, job: Path, one_host: bool) -> None:
    from mpi4py import MPI

    from ...results.timeline import Timeline
    from ...run.loop import simulate
    from ...run.result import Result
    from .executor import ABORT_SECONDS
    from .supervisor import Distributed

    task: Task = pickle.loads(job.read_bytes())
    os.truncate(job, 0)
    settings = task.settings if task.settings.by_threads is not None else replace(task.settings, by_threads=one_host)
    source = Distributed(task.ready, world, task.control, settings)
    try:
        source.before = Timeline.left_in(task.folder) if task.resume else None
        result = simulate(
            task.ready,
            task.folder,
            resume=task.resume,
            started=task.started,
            source=source,
            on_progress=lambda p: print(json.dumps(asdict(p)), flush=True),
        )
    except MdanimError as error:
        result = error
    except BaseException as error:
        if isinstance(error, MPI.Exception):  # where another rank has died, mpiexec ends this one now, and tells the better cause
            time.sleep(ABORT_SECONDS)
        _hand_over(lost(f"{type(error).__name__}: {error}", task.folder), job)
        raise
    try:
        if source.timeline.frames or not task.resume:  # else the log that is there stands
            source.timeline.write(task.folder)
    except OutputError as error:
        result = error if isinstance(result, Result) else result
    if source.clean:
        _hand_over(result)
    else:
        _hand_over(result, job)
        sys.stderr.flush()
        world.Abort(1)  # executors may wait for ever for what never comes


def _hand_over(result, job: Path | None = None) -> None:
    """Tell the process that has started all ranks the result, or the error that it is to raise.

    With a job, before an abort of all ranks, wait until that process has deleted it, which it does when it has the result: an
    abort may end the processes that pass on what stands on stdout.
    """
    print(RESULT_SIGN + base64.b64encode(pickle.dumps(result)).decode(), flush=True)
    deadline = time.monotonic() + PATIENCE
    while job and job.exists() and time.monotonic() < deadline:
        time.sleep(0.02)
