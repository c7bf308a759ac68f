# SPDX-License-Identifier: GPL-2.0-only
"""Cores that this process may use."""

from __future__ import annotations

import math
import os
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
