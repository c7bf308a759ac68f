# SPDX-License-Identifier: GPL-2.0-only
"""Starts a run on several executors with mpiexec, follows it, and gives its result as `run.simulate` does."""

from __future__ import annotations

import importlib
import json
import os
import pickle
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from ...errors import ExecutorLost, SetupError
from ...results.checkpoint import Checkpoint
from ...run.loop import STOP, Progress, Result
from ...run.prepare import Prepared
from ..plan.frame_plan import Settings

MPIEXEC = "MDANIM_MPIEXEC"
"""Environment variable with the command that starts ranks, up to ``-n``: ``mpiexec -f hosts`` on a cluster, ``srun``."""
JOB, RESULT = "job", "result"


@dataclass(frozen=True)
class Task:
    """What the supervisor is given."""

    ready: Prepared
    folder: Path
    control: str
    resume: Checkpoint | None
    started: float
    settings: Settings


def simulate_on(
    executors: int,
    control: str,
    ready: Prepared,
    folder: Path,
    *,
    watch: Callable[[Progress], None] | None = None,
    resume: Checkpoint | None = None,
    started: float | None = None,
    settings: Settings | None = None,
) -> Result:
    """`run.simulate` on ``executors`` ranks and a supervising one; the same frames, to the last bit.

    ``control`` is ``central`` or ``peers``. Raises what `run.simulate` does, SetupError without mpiexec,
    ExecutorLost when a rank dies.
    """
    folder = folder.resolve()
    with tempfile.TemporaryDirectory(prefix=".ranks-", dir=folder) as exchange:
        task = Task(ready, folder, control, resume, time.perf_counter() if started is None else started, settings or Settings())
        (Path(exchange) / JOB).write_bytes(pickle.dumps(task, protocol=pickle.HIGHEST_PROTOCOL))
        command = [*launcher(), "-n", str(executors + 1), sys.executable, "-m", "mdanim_lammps.parallel.runtime.ranks", exchange]
        # A session of its own: Ctrl-C is for this process, which asks the supervisor to stop after a frame.
        ranks = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env=_environment(),
            start_new_session=True,
        )
        said: list[str] = []
        hearing = threading.Thread(target=_hear, args=(ranks.stderr, said), daemon=True)
        hearing.start()
        with _Signals(ranks, folder) as signals:
            for line in ranks.stdout:
                signals.remind()
                if watch and line.startswith("{"):
                    watch(Progress(**json.loads(line)))
            ranks.wait()
        hearing.join()
        result = Path(exchange) / RESULT
        if not result.exists():
            raise lost(ranks.returncode, said, folder)
        found = pickle.loads(result.read_bytes())
    if isinstance(found, Result):
        return found
    kind, module, text = found
    raise getattr(importlib.import_module(module), kind)(text)


def launcher() -> list[str]:
    """The command that starts ranks: of MDANIM_MPIEXEC, beside this Python, or on the path. Raises SetupError."""
    if os.environ.get(MPIEXEC):
        return shlex.split(os.environ[MPIEXEC])
    beside = Path(sys.executable).parent / "mpiexec"
    found = str(beside) if beside.exists() else shutil.which("mpiexec")
    if not found:
        raise SetupError(f"there is no mpiexec; it comes with 'pip install mpich', or name one in {MPIEXEC}")
    return [found]


def _hear(stream, said: list[str]) -> None:
    """Pass on what ranks say, but for MPI's own obituaries,
    which are told better by `lost` or by the error that a run has left."""
    mourning = False
    for line in stream:
        said.append(line)
        mourning = mourning or line.startswith(("=====", "Abort("))
        if not mourning:
            sys.stderr.write(line)


def _environment() -> dict[str, str]:
    """That of this process, but with one thread for each rank's linear algebra."""
    return os.environ | dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


def lost(code: int, said: list[str], folder: Path) -> ExecutorLost:
    """The one message for ranks that ended without a result."""
    words = [line.strip() for line in said if line.strip() and not set(line.strip()) <= {"="}]
    tracebacks = [line for line in words if "Error" in line]
    why = next(
        (line.lstrip("= ").rstrip() for line in words if "EXIT CODE" in line or "killed" in line.lower()), f"exit code {code}"
    )
    if tracebacks:
        why = tracebacks[-1]
    kept = (folder / "checkpoint").exists()
    go_on = f"go on with: mdanim-lammps resume {folder}" if kept else "nothing was kept yet; run it again"
    return ExecutorLost(f"an executor was lost ({why}); all others were stopped. {go_on}")


class _Signals:
    """The first Ctrl-C (or SIGTERM) asks for an end after the frame; the second one ends all ranks at once."""

    def __init__(self, ranks: subprocess.Popen, folder: Path):
        self.ranks, self.folder = ranks, folder
        self.old = {}
        self.asked = False

    def __enter__(self) -> _Signals:
        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGINT, signal.SIGTERM):
                self.old[number] = signal.signal(number, self._stop)
        return self

    def _stop(self, *_) -> None:
        if self.asked:
            os.killpg(self.ranks.pid, signal.SIGKILL)
        self.asked = True
        (self.folder / STOP).touch()

    def remind(self) -> None:
        """Ask again: a run that had not begun yet has taken the file for that of a run before it."""
        if self.asked:
            (self.folder / STOP).touch()

    def __exit__(self, *_) -> None:
        for number, handler in self.old.items():
            signal.signal(number, handler)
        if self.ranks.poll() is None:
            os.killpg(self.ranks.pid, signal.SIGKILL)
        elif self.asked:
            (self.folder / STOP).unlink(missing_ok=True)
