# SPDX-License-Identifier: GPL-2.0-only
"""The frames of a run, in this process or on executors."""

from __future__ import annotations

from pathlib import Path

from ..engine.threads import with_threads
from ..errors import UsageError
from ..results.checkpoint import Checkpoint
from ..results.files import HANDS
from ..run.loop import simulate
from ..run.prepare import Prepared
from ..run.result import Result
from ..scene.lammps_lines import check_alone
from .limits import check_executors


def run_frames(
    ready: Prepared,
    folder: Path,
    *,
    executors: int = 1,
    threads: int | None = None,
    control: str | None = None,
    resume: Checkpoint | None = None,
    hands: bool = False,
    **options,
) -> Result:
    """Simulate in this process, or on executors of their own when there is more than one or a ``control`` is named, each with so
    many threads; None: as many as pay, of all cores divided by executors.

    ``hands`` and ``options`` are those of `run.loop.simulate`. Raises what that does, and UsageError for less than one executor
    or thread, for more than this machine can hold, and for executors that would go on with a run with hands.
    """
    check_executors(executors, ready.system.particles)
    check_alone(ready.scene, executors, control)
    with with_threads(threads):
        if executors == 1 and control is None:
            return simulate(ready, folder, resume=resume, hands=hands, **options)
        if hands or (resume and (folder / HANDS).exists()):
            way_out = "leave out -n; a scene with the lines of its hands.txt runs on any number of them"
            raise UsageError(f"a run with hands goes on in one process, not on executors: {way_out}")
        from .runtime.launch import simulate_on

        return simulate_on(executors, control or "central", ready, folder, resume=resume, **options)
