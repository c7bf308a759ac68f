# SPDX-License-Identifier: GPL-2.0-only
"""Surfaces of liquids over time, as cases read them."""

from __future__ import annotations

import numpy as np
from mdanim_lammps import Run


def along_x(run: Run, crests: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Middles of columns of cells along x, shape (nx,), and heights above the floor there, the mean over y, shape (F, nx) [m].

    Heights are those that solids feel, which are the pressure at the floor, or with ``crests`` those of the surface itself.
    """
    t, liquid = run.trajectory, run.trajectory.liquid
    read = t.liquid_raw if crests else t.liquid_height
    heights = np.array([read(frame).astype(float).mean(0) for frame in range(len(t.times))]) - liquid.low[2]
    columns = heights.shape[1]
    return liquid.low[0] + (np.arange(columns) + 0.5) * (liquid.high[0] - liquid.low[0]) / columns, heights


def crossings(times: np.ndarray, values: np.ndarray) -> np.ndarray:
    """When values change their sign, between frames on a straight line [s]."""
    at = np.flatnonzero(values[:-1] * values[1:] < 0.0)
    return times[at] - values[at] * (times[at + 1] - times[at]) / (values[at + 1] - values[at])


def extremes(times: np.ndarray, values: np.ndarray) -> list[tuple[float, float]]:
    """Time and value where values turn back, each by a parabola through three frames."""
    found = []
    for n in range(1, len(values) - 1):
        before, here, after = values[n - 1 : n + 2]
        if (here - before) * (after - here) < 0.0:
            bend, slope = after - 2.0 * here + before, (after - before) / 2.0
            found.append((times[n] - slope / bend * (times[n + 1] - times[n]), here - slope**2 / (2.0 * bend)))
    return found
