# SPDX-License-Identifier: GPL-2.0-only
"""How many threads take the steps of an instance. The number changes no bit of a run."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

from ..errors import UsageError

THREADS = "MDANIM_THREADS"
"""Environment variable with the number of threads of an instance: the processes of executors inherit it."""
MOST_THREADS = 32
"""Team::MOST_TASKS of plugin/engine/team.h."""


def check_threads(threads: int | str) -> int:
    """The number of threads. Raises UsageError for one that cannot be."""
    try:
        number = int(threads)
    except ValueError:
        number = 0
    if not 1 <= number <= MOST_THREADS:
        raise UsageError(f"the number of threads is a whole number from 1 to {MOST_THREADS}, not {threads}")
    return number


def threads_of_instance() -> int:
    """What the environment says, else 1. Raises UsageError."""
    return check_threads(os.environ.get(THREADS) or 1)


@contextmanager
def with_threads(threads: int | None) -> Iterator[None]:
    """Within it, instances of this process and of those that it starts have so many threads; None changes nothing."""
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
