# SPDX-License-Identifier: GPL-2.0-only
"""Liquid that stands on bodies, apart from all other: in a boat, in a tub, on a table. It has a sheet of its own.

One sheet over all columns would hang down, through the body and below it, to the liquid or the floor beneath.
"""

from __future__ import annotations

import numpy as np

from ..model.grid import Grid
from ..records import dataclass
from .hulls import AROUND, ASIDE, FINER, SHORE, Spots, against_bodies, beside, dry_spots
from .liquid import DRIP, PUDDLE

ON_BODY = 0.9
"""Share of a pond's columns, at least, with a body below."""

HELD = 0.3
"""Share of the columns within `SHORE` of a pond of at most `PUDDLE` columns that are in a body, at least: else it is a film."""
REACH = 1.5
"""Columns over which the drawn level is a mean of the known ones."""
SQUARE = np.ones((3, 3), bool)
"""A column and the eight around it."""


@dataclass(frozen=True)
class Ponds:
    """All ponds of a frame; heights are z [m], shape (ny, nx)."""

    columns: np.ndarray
    """Columns that they stand on, bool, shape (ny, nx)."""
    level: np.ndarray
    """Level of their sheet over their columns and those around."""
    bottom: np.ndarray
    """The body's face below; infinite where no pond is."""
    quads: np.ndarray
    """Between the middles of four columns the sheet is drawn; bool, shape (ny - 1, nx - 1)."""
    hidden: np.ndarray
    """Spots where it is not, beyond the body's outline; bool, shape (FINER ny, FINER nx)."""


def parted(
    grid: Grid, smooth: np.ndarray, raw: np.ndarray, vertices: np.ndarray, triangle: np.ndarray
) -> tuple[np.ndarray, np.ndarray, Ponds | None]:
    """Smooth and raw heights without ponds, and the ponds, None without.

    A pond hangs together, is more than a drip and has a body below: with what runs over the body's edge it is not a pond. A small
    one is drawn only where walls hold it.

    Args:
        grid: the columns.
        smooth, raw: heights z [m], shape (ny, nx).
        vertices, triangle: of the surfaces of all bodies, as for `dry_spots`.
    """
    from scipy.ndimage import binary_dilation, label

    open_ = np.isfinite(raw)
    group, count = label(open_)
    if count < 2:
        return smooth, raw, None
    _, floor = against_bodies(*_middles(grid), np.where(open_, raw, smooth), vertices, triangle)
    size = np.bincount(group.ravel())
    on_body = np.bincount(group[floor > -np.inf], minlength=count + 1)
    is_pond = (on_body >= ON_BODY * size) & (size > DRIP)
    is_pond[0] = False
    pond = is_pond[group]
    rest = open_ & ~pond
    if not pond.any() or not rest.any():
        return smooth, raw, None
    below = np.where(~rest & binary_dilation(pond, iterations=AROUND), drawn_on(smooth, rest), smooth)
    told = np.where(pond, np.where(below > floor, -np.inf, np.nan), raw)
    return below, told, _sheet(grid, raw, group * pond, vertices, triangle)


def one_sheet(
    grid: Grid, smooth: np.ndarray, raw: np.ndarray, vertices: np.ndarray, triangle: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Heights of a sheet with one for each column, z [m], and where it is not drawn, bool, both of shape (ny, nx).

    Between a pond and what is around it hangs a part that is not drawn, within the body. What is below a pond is not there.
    """
    from scipy.ndimage import binary_dilation

    below, told, ponds = parted(grid, smooth, raw, vertices, triangle)
    dry = dry_spots(grid, below, told, vertices, triangle)
    cut = dry.reshape(raw.shape[0], FINER, raw.shape[1], FINER).mean(axis=(1, 3)) > 0.5
    if ponds is None:
        return below, cut
    beside, near, far = (binary_dilation(ponds.columns, SQUARE, iterations=n) & ~np.isfinite(told) for n in (1, 2, 3))
    at_rest = binary_dilation(np.isfinite(told), SQUARE)
    cut = (cut & ~far) | (far & ~beside) | (beside & at_rest)
    return np.where(near, ponds.level, below), cut & ~ponds.columns


def _sheet(grid: Grid, raw: np.ndarray, group: np.ndarray, vertices: np.ndarray, triangle: np.ndarray) -> Ponds | None:
    """The sheet of ponds, as for `parted`; ``group`` is the number of the pond of each column, 0 of none, shape (ny, nx)."""
    from scipy.ndimage import binary_dilation, label, maximum_filter, uniform_filter

    pond = group > 0
    mean = uniform_filter(np.where(pond, raw, 0.0), 3) / np.maximum(uniform_filter(pond.astype(float), 3), 1e-9)
    level = np.where(pond, mean, drawn_on(mean, pond))
    in_body, bottom = against_bodies(*_middles(grid), level, vertices, triangle)
    ring = np.where(pond, 0, maximum_filter(group, 2 * int(SHORE) + 1))
    walls, all_around = (np.bincount(ring[where], minlength=group.max() + 1) for where in (in_body, ring > 0))
    puddle = (np.bincount(group.ravel()) <= PUDDLE) & (walls < HELD * all_around)
    pond &= ~puddle[group]
    if not pond.any():
        return None
    # Where the body is level around a pond, the sheet ends beside the pond's own columns; it runs on into a wall.
    bare = ~pond & ~in_body & (bottom > -np.inf)
    beach = bare & binary_dilation(bare & ~binary_dilation(pond, SQUARE), SQUARE)
    level = np.where(beach, bottom - 0.5 * grid.cell[2], level)
    around = binary_dilation(pond, SQUARE, iterations=int(SHORE))
    quads = around[:-1, :-1] & around[:-1, 1:] & around[1:, :-1] & around[1:, 1:]
    spots = Spots(grid, pond)
    solid, face = spots.against(spots.heights(level), vertices, triangle)
    region, count = label(~solid)
    has = np.bincount(region[spots.of(pond)], minlength=count + 1) > 0
    shown = spots.all(beside(solid, has[region] & (face > -np.inf)))
    return Ponds(pond, level, np.where(around & (bottom > -np.inf), bottom, np.inf), quads, ~shown)


def _middles(grid: Grid) -> tuple[np.ndarray, np.ndarray]:
    """x and y of the columns' middles [m], shape (nx,) and (ny,), moved aside a little as those of spots are."""
    return tuple(low + (np.arange(n) + 0.5 + ASIDE) * c for low, n, c in zip(grid.low[:2], grid.shape[:2], grid.cell[:2]))


def drawn_on(height: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Heights z [m] as they go on smoothly from columns where they are known, all of shape (ny, nx)."""
    from scipy.ndimage import distance_transform_edt, gaussian_filter

    weight = gaussian_filter(known.astype(float), REACH)
    mean = gaussian_filter(np.where(known, height, 0.0).astype(float), REACH) / np.maximum(weight, 1e-9)
    j, i = distance_transform_edt(~known, return_distances=False, return_indices=True)
    return np.where(weight > 1e-3, mean, height[j, i])
