# SPDX-License-Identifier: GPL-2.0-only
"""Cores and memory that this process may use: of the machine, its control groups (containers, batch systems) and its shell."""

from __future__ import annotations

import math
import os
import resource
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path


def cores() -> int:
    """Cores that this process may use, at least one: those of its mask, and no more than `quota`."""
    return max(1, int(min(len(affinity()), quota())))


def affinity() -> set[int]:
    """Numbers of the cores that this process may run on."""
    return os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else set(range(os.cpu_count() or 1))


def quota(root: Path = Path("/")) -> float:
    """Cores that the control groups of this process may have the time of, as containers limit it; infinite without a limit."""
    least = math.inf
    for place, old in _groups(root, "cpu"):
        with suppress(OSError, ValueError):
            most, period = _words(place, *(("cpu.cfs_quota_us", "cpu.cfs_period_us") if old else ("cpu.max",)))
            if most not in ("max", "-1"):
                least = min(least, float(most) / float(period))
    return least


def available_memory(root: Path = Path("/")) -> float:
    """Memory free for this process [bytes]: of the machine, or of a control group or a limit of the shell where that has less."""
    free = [float(os.sysconf("SC_PHYS_PAGES")) * os.sysconf("SC_PAGE_SIZE"), address_space() - LIBRARIES]
    with suppress(OSError):  # not Linux
        lines = (root / "proc/meminfo").read_text().splitlines()
        free += [1024.0 * int(line.split()[1]) for line in lines if line.startswith("MemAvailable")]
    for place, old in _groups(root, "memory"):
        with suppress(OSError, ValueError):
            most, used = _words(place, *(f"memory.{name}" for name in (V1_MEMORY if old else V2_MEMORY)))
            if most != "max":
                free.append(float(most) - float(used) + _idle_files(place))
    return max(0.0, min(free))


V1_MEMORY, V2_MEMORY = ("limit_in_bytes", "usage_in_bytes"), ("max", "current")
LIBRARIES = 0.3e9
"""Address space of the libraries that a run loads after its scene is read [bytes]."""


def limited() -> bool:
    """Whether the address space of this process is limited, as ``ulimit -v`` does: libraries in C++ then end the process."""
    return resource.getrlimit(resource.RLIMIT_AS)[0] != resource.RLIM_INFINITY


def address_space() -> float:
    """Address space that is left [bytes]; infinite without a limit."""
    if not limited():
        return math.inf
    with suppress(OSError):
        used = int(Path("/proc/self/statm").read_text().split()[0]) * os.sysconf("SC_PAGE_SIZE")
        return resource.getrlimit(resource.RLIMIT_AS)[0] - used
    return math.inf


def _groups(root: Path, controller: str) -> Iterator[tuple[Path, bool]]:
    """Folders of the control groups that this process is in, from its own to the root, as a limit is for all groups within, and
    whether they are of version 1."""
    try:
        groups = [line.split(":", 2) for line in (root / "proc/self/cgroup").read_text().splitlines()]
    except OSError:
        return
    for _, controllers, path in (group for group in groups if len(group) == 3):
        old = controller in controllers.split(",")
        if controllers and not old:
            continue
        group = Path(path.lstrip("/"))
        for part in (group, *group.parents):
            yield root / "sys/fs/cgroup" / (controller if old else "") / part, old


def _words(place: Path, *names: str) -> list[str]:
    """All words of some files."""
    return " ".join((place / name).read_text() for name in names).split()


def _idle_files(place: Path) -> float:
    """Bytes of files that a group keeps in memory and gives up when it needs room."""
    with suppress(OSError, ValueError):
        lines = (place / "memory.stat").read_text().splitlines()
        return sum(float(line.split()[1]) for line in lines if line.startswith(("inactive_file ", "total_inactive_file ")))
    return 0.0
