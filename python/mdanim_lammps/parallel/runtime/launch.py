# SPDX-License-Identifier: GPL-2.0-only
"""Starts a run on several executors with mpiexec, follows it, and gives its result as `run.simulate` does."""

from __future__ import annotations

import base64
import json
import os
import pickle
import secrets
import shlex
import shutil
import signal
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from ...children import DEVNULL, PIPE, Child, start
from ...children import command as child_command
from ...engine.plugin import files_too_small, has_descriptors
from ...errors import ExecutorLost, MdanimError, OutputError, SetupError
from ...interrupts import Interrupts
from ...records import dataclass
from ...results.checkpoint import Checkpoint
from ...results.files import CHECKPOINT, JOB, STOP, SUMMARY, claims, disk_errors
from ...run.loop import Progress
from ...run.prepare import Prepared
from ...run.result import Result
from ..limits import MPIEXEC
from ..plan.frame_plan import PlannerOptions

RESULT_SIGN = "result:"
"""Start of the line on stdout in which the supervisor gives the result; mpiexec's own words begin with "=" or "YOUR"."""
DESCRIPTORS = 32
"""Files and sockets that a rank opens before it can tell that it has too few."""
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
"""Environment of ranks: one thread for each rank's linear algebra."""


@dataclass(frozen=True)
class Task:
    """The task of the supervisor."""

    ready: Prepared
    folder: Path
    control: str
    resume: Checkpoint | None
    started: float
    settings: PlannerOptions


def simulate_on(
    executors: int,
    control: str,
    ready: Prepared,
    folder: Path,
    *,
    on_progress: Callable[[Progress], None] | None = None,
    resume: Checkpoint | None = None,
    started: float | None = None,
    settings: PlannerOptions | None = None,
) -> Result:
    """`run.simulate` on ``executors`` ranks and a supervising one; the same frames, to the last bit.

    ``control`` is ``central`` or ``peers``. Raises what `run.simulate` does, SetupError without mpiexec,
    ExecutorLost when a rank dies.
    """
    folder = folder.resolve()
    job = folder / f"{JOB}{secrets.token_hex(4)}"
    task = Task(ready, folder, control, resume, time.perf_counter() if started is None else started, settings or PlannerOptions())
    command = [*launcher(), "-n", str(executors + 1), *child_command("mdanim_lammps.parallel.runtime.ranks", job)]
    said: list[str] = []
    found = None
    try:
        with disk_errors(job), open(job, "xb", opener=lambda path, flags: os.open(path, flags, 0o600)) as file:
            pickle.dump(task, file, protocol=pickle.HIGHEST_PROTOCOL)
        with _Signals(folder) as signals:
            ranks = signals.ranks = _started(command)
            hearing = threading.Thread(target=_hear, args=(ranks.stderr, said), daemon=True)
            hearing.start()
            for line in ranks.stdout:
                if line.startswith(RESULT_SIGN):
                    found = pickle.loads(base64.b64decode(line[len(RESULT_SIGN) :]))
                    job.unlink(missing_ok=True)
                elif on_progress and line.startswith("{"):
                    on_progress(Progress(**json.loads(line)))
            ranks.wait()
        hearing.join()
        if not folder.exists():
            raise OutputError(f"{folder} was deleted while the run wrote to it; run the scene again")
        if found is None:
            raise lost(_cause(ranks.returncode, said), folder)
    finally:
        job.unlink(missing_ok=True)
    if isinstance(found, MdanimError):
        raise found
    return found


def launcher() -> list[str]:
    """The command that starts ranks: of MDANIM_MPIEXEC, beside this Python, or on the path. Raises SetupError."""
    if os.environ.get(MPIEXEC):
        try:
            return shlex.split(os.environ[MPIEXEC]) or [""]
        except ValueError as error:
            raise SetupError(f"{MPIEXEC}={os.environ[MPIEXEC]}: {error}; write it as a shell would take it") from error
    beside = Path(sys.executable).parent / "mpiexec"
    found = str(beside) if beside.exists() else shutil.which("mpiexec")
    if not found:
        raise SetupError(f"there is no mpiexec; it comes with 'pip install mpich', or name one in {MPIEXEC}")
    return [found]


def _started(command: list[str]) -> Child:
    """The process that starts all ranks, in a session of its own: Ctrl-C is for this process. Raises SetupError."""
    if not has_descriptors(DESCRIPTORS):
        raise SetupError(
            f"executors cannot start: MPI needs {DESCRIPTORS} more open files than the limit allows; raise it: ulimit -n 1024"
        )
    if too_small := files_too_small():
        raise SetupError(f"executors cannot start: {too_small}")
    try:
        return start(command, more=ONE_THREAD, stdin=DEVNULL, stdout=PIPE, stderr=PIPE, start_new_session=True, pass_fds=claims)
    except OSError as error:
        named = f"{MPIEXEC}={os.environ[MPIEXEC]}" if os.environ.get(MPIEXEC) else command[0]
        raise SetupError(f"{named}: {command[0] or 'an empty command'} cannot be started: {error.strerror}") from error


def _hear(stream, said: list[str]) -> None:
    """Pass on what ranks say, but for MPI's own report of an abort: `lost`, or the error that a run has left, says more."""
    aborted = False
    for line in stream:
        said.append(line)
        aborted = aborted or line.startswith(("=====", "Abort("))
        if not aborted:
            sys.stderr.write(line)


def _cause(code: int, said: list[str]) -> str:
    """Why ranks have ended without a result, from mpiexec's exit code and what was said on stderr."""
    words = [line.strip() for line in said if line.strip() and not set(line.strip()) <= {"="}]
    errors = [line for line in words if "Error" in line]
    reports = [line.lstrip("= ").rstrip() for line in words if "EXIT CODE" in line or "killed" in line.lower()]
    return (errors[-1:] or reports or [f"exit code {code}"])[0]


def lost(why: str, folder: Path) -> ExecutorLost:
    """The one message for ranks that gave no result."""
    place = shlex.quote(str(folder))
    if (folder / SUMMARY).exists():
        return ExecutorLost(
            f"mpiexec was lost ({why}) as the run ended, and the run is complete; draw it with: mdanim-lammps render {place}"
        )
    kept = (folder / CHECKPOINT).exists()
    go_on = f"go on with: mdanim-lammps resume {place}" if kept else "nothing was kept yet; run it again"
    return ExecutorLost(f"an executor was lost ({why}); all others were stopped. {go_on}")


class _Signals(Interrupts):
    """The first Ctrl-C (or SIGTERM) asks for an end after the frame; the second one ends all ranks at once."""

    def __init__(self, folder: Path):
        super().__init__(self._stop, self._end)
        self.folder = folder
        self.ranks: Child | None = None
        """To be set once there are some."""

    def _stop(self) -> None:
        with suppress(OSError):  # the folder may have been deleted, which ends the run by itself
            (self.folder / STOP).touch()

    def _end(self) -> None:
        if self.ranks and self.ranks.poll() is None:
            os.killpg(self.ranks.pid, signal.SIGKILL)

    def __exit__(self, *_) -> None:
        super().__exit__()
        self._end()
        if self.asked:
            (self.folder / STOP).unlink(missing_ok=True)
