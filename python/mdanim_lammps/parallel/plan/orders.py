# SPDX-License-Identifier: GPL-2.0-only
"""Reports to a planner after a window, and its orders."""

from __future__ import annotations

import numpy as np

from ...records import dataclass
from .frame_plan import FrameAssignment


@dataclass(frozen=True)
class Report:
    """The report of an executor on its objects at the end of a window."""

    objects: np.ndarray
    """Whole numbers, int64, shape (m,)."""
    low: np.ndarray
    """Corners of their boxes, eq. (3.14) [m], shape (m, 3)."""
    high: np.ndarray
    speed: np.ndarray
    """Speed of the fastest particle of each object [m/s], shape (m,)."""
    cost: np.ndarray
    """Processor time for a frame of each [us], int64, shape (m,)."""
    grid_cost: int | None = None
    """The same of the liquid, from the executor that has it."""
    escaped: tuple[int, ...] = ()
    """Objects that have left their reserved boxes: the window must be done again."""
    fingerprint: str = ""
    """Fingerprint of the plan that was followed: all executors must have followed the same."""


@dataclass(frozen=True)
class Order:
    """The next thing to do."""

    plan: FrameAssignment
    low: np.ndarray
    """Corners of the boxes that are reserved for objects, eq. (6.17), the pool's last [m], shape (M, 3)."""
    high: np.ndarray
    steps: int
    """Steps of the next window."""
    commit: bool
    """Whether the window is done; if not it starts again, from its beginning, with these wider boxes."""
