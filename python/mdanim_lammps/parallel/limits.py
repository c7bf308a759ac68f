# SPDX-License-Identifier: GPL-2.0-only
"""How many executors a run may ask for."""

from __future__ import annotations

import os

from ..errors import UsageError
from ..processes import available_memory

MPIEXEC = "MDANIM_MPIEXEC"
"""Environment variable with the command that starts ranks, up to ``-n``: ``mpiexec -f hosts`` on a cluster, ``srun``."""
PER_CORE, ALWAYS = 4, 16
"""Executors for each core of this machine that are taken, and those that are taken on any."""
RANK_BYTES, PARTICLE_BYTES = 60e6, 240.0
"""Memory of a rank without a scene, and for each particle of the scene, of which every executor holds the plan and the state."""


def check_executors(executors: int, particles: int = 0) -> None:
    """Raise UsageError for a number of executors that cannot be, or that this machine has neither cores nor memory for.

    Where `MPIEXEC` names a launcher, ranks may run on other machines, and only the number itself is checked.
    """
    if not isinstance(executors, int):
        raise UsageError(f"-n {executors}: expected a whole number of executors")
    if executors < 1:
        raise UsageError(f"-n {executors}: at least one executor is needed")
    if executors == 1 or os.environ.get(MPIEXEC):
        return
    cores = os.cpu_count() or 1
    most = max(ALWAYS, PER_CORE * cores)
    elsewhere = f"name other machines in {MPIEXEC} (docs/command-line.md)"
    if executors > most:
        raise UsageError(
            f"-n {executors}: this machine has {cores} cores, and more than {most} executors would only wait for each other; "
            f"write -n {cores} or {elsewhere}"
        )
    needed, free = (executors + 1) * (RANK_BYTES + PARTICLE_BYTES * particles), available_memory()
    if needed > free:
        fit = max(1, int(free / (RANK_BYTES + PARTICLE_BYTES * particles)) - 1)
        raise UsageError(
            f"-n {executors}: the processes need {needed * 1e-9:.1f} GB, {free * 1e-9:.1f} GB are free; "
            f"write -n {fit} or {elsewhere}"
        )
