# SPDX-License-Identifier: GPL-2.0-only
"""Processes that share the work of this one."""

from __future__ import annotations

import math
import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from multiprocessing import parent_process
from pathlib import Path
from types import ModuleType


def cores() -> int:
    """Cores that this process may use, at least one: those of its mask, and no more than `quota`."""
    return max(1, int(min(len(affinity()), quota())))


def affinity() -> set[int]:
    """Numbers of the cores that this process may run on."""
    return os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else set(range(os.cpu_count() or 1))


def quota(root: Path = Path("/")) -> float:
    """Cores that the control groups of this process may have the time of, as containers limit it; infinite without a limit."""
    try:
        groups = [line.split(":", 2) for line in (root / "proc/self/cgroup").read_text().splitlines()]
    except OSError:
        return math.inf
    least = math.inf
    for _, controllers, path in (group for group in groups if len(group) == 3):
        mount = "sys/fs/cgroup" if not controllers else "sys/fs/cgroup/cpu" if "cpu" in controllers.split(",") else None
        if mount is None:
            continue
        group = Path(path.lstrip("/"))
        for place in (root / mount / part for part in (group, *group.parents)):  # a limit is for all groups within
            names = ("cpu.cfs_quota_us", "cpu.cfs_period_us") if controllers else ("cpu.max",)
            with suppress(OSError, ValueError):
                most, period = " ".join((place / name).read_text() for name in names).split()
                if most not in ("max", "-1"):
                    least = min(least, float(most) / float(period))
    return least


@contextmanager
def without_main() -> Iterator[None]:
    """Hide the main module from new processes: each would run the user's script again, with all that the script simulates."""
    main, sys.modules["__main__"] = sys.modules["__main__"], ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = main


def begin_worker() -> None:
    """What a process that shares work does first: Ctrl-C is for its parent, and it ends when the parent is killed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=lambda: (parent_process().join(), os._exit(1)), daemon=True).start()
