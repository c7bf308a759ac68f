# SPDX-License-Identifier: GPL-2.0-only
"""Where a liquid is white with foam: where its surface breaks, where drops fly low over it, and for a while after.

Frames hold no foam. It is computed from the frame that is drawn and the few before it, so any process draws the same picture.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ..model.grid import Grid

BREAKING = (0.6, 1.2)
"""By how much the slope of the surface grows within a column where foam begins, and where all is white: at the foot of a bore, of
a fall, of a cavity. A smooth slope has none however steep, nor has a crest. A sine as steep as the highest wave there is, of
a k = 0.44, stays below the first number while four columns or more make a wave."""
MOST = 3.0
"""Foam that a column has at most, where 1 is white: the higher a fall, the longer and farther its foam is seen."""
FADE = 0.4
"""Seconds within which foam falls to 1/e; it is looked for in frames of four times that."""
LEAST = 0.02
"""Foam that is left after that of a white column; with less there is none."""
APART = 1.0 / 30.0
"""Seconds, about, between the earlier frames that are looked at: foam behind a front has no gaps."""
LOW = 1.5
"""Cells above the surface up to which drops whiten it."""
WHITE = 12.0
"""Columns that drops whiten which would fill one cell."""
KEPT = 64
"""Frames of which is known what foam they make: pictures that follow look at the same ones."""

Liquid = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Smooth and raw heights [m], shape (ny, nx), and middles and radii of drops [m], shape (D, 4), of a frame."""


class Foam:
    """The foam of the frames of one run.

    Args:
        grid: the columns.
        frame_time: between two frames [s].
    """

    def __init__(self, grid: Grid, frame_time: float):
        self._grid, self._frame_time = grid, frame_time
        self._made: dict[int, tuple[np.ndarray | None, np.ndarray, np.ndarray]] = {}

    def at(self, frame: int, read: Callable[[int], Liquid]) -> np.ndarray:
        """How white each column is, 0 to 1, shape (ny, nx); none where a solid hides the liquid. ``read`` is called for frames
        that have not been looked at."""
        foam, before = None, 0
        for n in looked_at(frame, self._frame_time):
            made, comes, open_ = self._look(n, read)
            if foam is not None and foam.any():
                # Where there is foam, and two columns around.
                some = (np.flatnonzero(foam.any(axis=k)) for k in (1, 0))
                near = tuple(slice(max(0, k[0] - 2), k[-1] + 3) for k in some)
                left = math.exp(-(n - before) * self._frame_time / FADE)
                foam[near] = left * spread(foam[near], comes[(..., *near)], open_[near])
                foam[foam < LEAST] = 0.0
            if made is not None:
                foam = made.copy() if foam is None else np.maximum(foam, made)
            before = n
        return np.zeros(self._grid.shape[1::-1], np.float32) if foam is None else np.minimum(foam, 1.0)

    def _look(self, frame: int, read: Callable[[int], Liquid]) -> tuple[np.ndarray | None, np.ndarray, np.ndarray]:
        """The foam that a frame makes, None for none, and its `ways`."""
        if frame not in self._made:
            smooth, raw, drops = read(frame)
            made = breaking(self._grid, smooth, raw, drops)
            self._made[frame] = made if made.any() else None, *ways(smooth, raw, self._grid.cell[2])
            if len(self._made) > KEPT:
                del self._made[next(iter(self._made))]
        return self._made[frame]


def looked_at(frame: int, frame_time: float) -> range:
    """Frames whose foam is still seen in a frame, that one last. The first frame of a run has none: nothing has moved."""
    stride = max(1, round(APART / frame_time))
    steps = int(4.0 * FADE / (stride * frame_time))
    return range(max(frame - steps * stride, 1 + (frame - 1) % stride), frame + 1, stride)


def breaking(grid: Grid, smooth: np.ndarray, raw: np.ndarray, drops: np.ndarray) -> np.ndarray:
    """How much foam the liquid makes in each column, 0 to MOST, float32, shape (ny, nx).

    Args:
        grid: the columns.
        smooth, raw: heights z [m], shape (ny, nx); beside a column whose liquid a solid hides no slope counts.
        drops: middles and radii [m], shape (D, 4).
    """
    dx, dy, dz = grid.cell
    low, high = BREAKING
    made = np.zeros(smooth.shape)
    # A calm liquid is told by its slopes alone.
    if any((2.0 * np.abs(np.diff(smooth, axis=axis)) > low * width).any() for axis, width in ((0, dy), (1, dx))):
        open_ = np.isfinite(raw)
        for (before, after), known, width in zip(_pairs(smooth), _pairs(open_), (dy, dx)):
            growth = np.where(open_ & known.all(axis=0), (before + after - 2.0 * smooth) / width, 0.0)
            made = np.maximum(made, (growth - low) / (high - low))
    if len(drops):
        nx, ny, _ = grid.shape
        i, j = np.clip(((drops[:, :2] - grid.low[:2]) / (dx, dy)).astype(int), 0, (nx - 1, ny - 1)).T
        near = drops[:, 2] - smooth[j, i] < LOW * dz
        cells = 4.0 / 3.0 * np.pi * drops[near, 3].astype(float) ** 3 / grid.cell_volume
        made += np.bincount((j * nx + i)[near], WHITE * cells, nx * ny).reshape(ny, nx) * np.isfinite(raw)
    return np.minimum(made, MOST).astype(np.float32)


def ways(smooth: np.ndarray, raw: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Where foam can go, found once for a frame: whether it comes to each column from those before and after it, along y and
    along x, bool, shape (2, 2, ny, nx), which is not up a step, and whether no solid hides its liquid, shape (ny, nx).

    Args:
        smooth, raw: heights z [m], shape (ny, nx).
        step: [m].
    """
    open_ = np.isfinite(raw)
    return (_pairs(smooth) > smooth - step) & open_, open_


def spread(foam: np.ndarray, comes: np.ndarray, open_: np.ndarray) -> np.ndarray:
    """Twice half of the foam of each column goes to those around it.

    Args:
        foam: of each column, float32, shape (ny, nx).
        comes, open_: `ways` of the same columns.
    """
    for _ in range(2):
        foam = 0.5 * foam + 0.125 * np.where(comes, _pairs(foam), np.float32(0.0)).sum(axis=(0, 1))
    return np.where(open_, foam, np.float32(0.0))


def _pairs(field: np.ndarray) -> np.ndarray:
    """Values of the columns before and after each column, along y and along x, shape (2, 2, ny, nx); beyond the edge its own."""
    found = np.empty((2, 2, *field.shape), field.dtype)
    found[0, 0, 0], found[0, 0, 1:] = field[0], field[:-1]
    found[0, 1, -1], found[0, 1, :-1] = field[-1], field[1:]
    found[1, 0, :, 0], found[1, 0, :, 1:] = field[:, 0], field[:, :-1]
    found[1, 1, :, -1], found[1, 1, :, :-1] = field[:, -1], field[:, 1:]
    return found
