# SPDX-License-Identifier: GPL-2.0-only
"""How many threads take the steps of an instance. The number changes no bit of a run."""

from __future__ import annotations

import math
import os
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction
from typing import TYPE_CHECKING

from ..errors import UsageError
from ..processes import affinity, cores, quota
from ..records import dataclass

if TYPE_CHECKING:
    from .plan import Plan

THREADS = "MDANIM_THREADS"
"""Environment variable with the number of threads of an instance: the processes of executors inherit it."""
LEAST = "MDANIM_LEAST_TASK"
"""Environment variable with the least that a thread is asked for [ns]; the plugin reads it too."""
LEAST_TASK = 4000.0
"""The same where the environment says nothing, as plugin/threads/team.cpp has it."""
PASS, DAMPED_PASS = 30.0, 40.0
"""Nanoseconds that a thread takes for a particle's step in a pass, without and with dashpots, as plugin/passes/range_cut.h has
them."""
MOST_THREADS = 32
"""Team::MOST_TASKS of plugin/threads/team.h."""


def check_threads(threads: int | str) -> int:
    """The number of threads. Raises UsageError for one that cannot be."""
    try:
        number = int(threads)
    except ValueError:
        number = 0
    if not 1 <= number <= MOST_THREADS:
        raise UsageError(f"the number of threads is a whole number from 1 to {MOST_THREADS}, not {threads}")
    return number


def asked_threads() -> int | None:
    """The number of threads in the environment; None where it gives none. Raises UsageError."""
    return check_threads(os.environ[THREADS]) if os.environ.get(THREADS) else None


@dataclass(frozen=True)
class ThreadChoice:
    """How many threads take the steps of an instance, and why."""

    threads: int
    asked: bool
    """By ``--threads`` or the environment: nothing else counts then."""
    cores: int
    """For this process."""
    particles: int
    step: float
    """Nanoseconds that one thread takes for a pass over all particles, about."""
    pays_from: int
    """Particles for each thread below which it costs more than it brings."""
    standard: tuple[str, ...] = ()
    """Effects that make LAMMPS take its standard steps: of these threads share springs, contact and liquid alone."""


def choose_threads(plan: Plan, most: int) -> ThreadChoice:
    """The number that is asked for, or else one thread for each of ``most`` cores, where each has enough to do. Raises
    UsageError."""
    asked, particles = asked_threads(), plan.system.particles
    of_particle = DAMPED_PASS if plan.damped else PASS
    pays_from = math.ceil(least_task() / of_particle)
    threads = asked or max(1, min(most, MOST_THREADS, particles // pays_from))
    standard = tuple(e.name for e in plan.effects if not e.in_passes)
    return ThreadChoice(threads, asked is not None, most, particles, particles * of_particle, pays_from, standard)


def asked_choice(plan: Plan, threads: int | None) -> ThreadChoice | None:
    """The choice of a run for which so many ``threads`` are asked, here or by the environment; None without. Raises
    UsageError."""
    with with_threads(threads):
        return choose_threads(plan, cores()) if asked_threads() else None


def least_task() -> float:
    """The least that a thread is asked for [ns]. Raises UsageError for what is not a time."""
    told = os.environ.get(LEAST, "")
    try:
        least = float(told) if told else LEAST_TASK
    except ValueError:
        least = 0.0
    if not 0.0 < least < math.inf:
        raise UsageError(f"{LEAST} is a time in nanoseconds, more than 0, not {told}")
    return least


def share_of_cores(comm) -> int:
    """Cores for this rank of an mpi4py communicator, at least one: ranks on a host that may use the same cores share them. All
    cores where there is none."""
    if comm is None:
        return cores()
    from mpi4py import MPI

    node = comm.Split_type(MPI.COMM_TYPE_SHARED)
    masks = node.allgather(affinity())
    node.Free()
    ranks_of = Counter(core for mask in masks for core in mask)
    own = sum(Fraction(1, ranks_of[core]) for core in affinity())
    return max(1, min(int(own), int(quota() // len(masks)) if quota() < math.inf else int(own)))


@contextmanager
def with_threads(threads: int | None) -> Iterator[None]:
    """Within it, instances of this process and of those that it starts have ``threads`` threads; None changes nothing."""
    before = os.environ.get(THREADS)
    if threads is not None:
        os.environ[THREADS] = str(check_threads(threads))
    try:
        yield
    finally:
        if threads is not None:
            if before is None:
                del os.environ[THREADS]
            else:
                os.environ[THREADS] = before
