# SPDX-License-Identifier: GPL-2.0-only
"""What every MPI rank of a distributed run executes: ``mpiexec -n K+1 python -m mdanim_lammps.parallel.runtime.ranks FOLDER``.

Rank 0 is the supervisor: it takes the job that parallel/runtime/launch.py has left in the folder and leaves the result there; progress goes
to its standard output, a line of JSON for every frame. All others are executors.
"""

from __future__ import annotations

import json
import pickle
import sys
import time
import traceback
from dataclasses import asdict
from pathlib import Path

from ...errors import MdanimError, OutputError
from .launch import JOB, RESULT, Task, lost

FAREWELL = 60.0
"""Seconds that an executor waits for its end."""


def main() -> None:
    """Be the supervisor, or an executor."""
    from mpi4py import MPI

    from .messages import SUPERVISOR

    world = MPI.COMM_WORLD
    if world.rank != SUPERVISOR:
        from .executor import serve

        if not serve(world):
            time.sleep(FAREWELL)  # the supervisor is to tell what has happened before it ends all ranks, this one too
        return
    _supervise(world, Path(sys.argv[1]))


def _supervise(world, exchange: Path) -> None:
    from mpi4py import MPI

    from ...results.timeline import Timeline
    from ...run.loop import Result, simulate
    from .supervisor import Distributed

    task: Task = pickle.loads((exchange / JOB).read_bytes())
    source = Distributed(task.ready, world, task.control, task.settings)
    try:
        source.before = Timeline.left_in(task.folder) if task.resume else None
        result = simulate(
            task.ready,
            task.folder,
            resume=task.resume,
            started=task.started,
            source=source,
            watch=lambda p: print(json.dumps(asdict(p)), flush=True),
        )
    except MdanimError as error:
        result = _told(error)
    except BaseException as error:  # executors would wait for ever
        if not isinstance(error, MPI.Exception):  # else somebody has died, and mpiexec has the better word
            traceback.print_exc()
            # What stands on stderr may be lost: an abort ends those who pass it on too.
            _leave(exchange, _told(lost(1, [f"{type(error).__name__}: {error}"], task.folder)))
        sys.stderr.flush()
        world.Abort(1)
        raise
    try:
        if source.timeline.frames or not task.resume:  # else the log that is there stands
            source.timeline.write(task.folder)
    except OutputError as error:
        result = _told(error) if isinstance(result, Result) else result
    _leave(exchange, result)
    if not source.clean:
        world.Abort(1)  # executors may wait for ever for what never comes


def _leave(exchange: Path, result) -> None:
    """Let the process that has started all ranks find a result, whole."""
    part = exchange / (RESULT + ".part")
    part.write_bytes(pickle.dumps(result))
    part.rename(exchange / RESULT)


def _told(error: MdanimError) -> tuple[str, str, str]:
    """What `launch.simulate_on` raises again: kind, module, text."""
    return type(error).__name__, type(error).__module__, str(error)


if __name__ == "__main__":
    main()
