# SPDX-License-Identifier: GPL-2.0-only
"""Where the sheet of a liquid ends at a hull that is dry inside: within its planks, cut by the faces that are drawn."""

from __future__ import annotations

import numpy as np

from ..model.grid import Grid
from .liquid import DRIP

FINER = 4
"""Spots along each side of a column; of each it is told whether the sheet is drawn."""
AROUND = 4
"""Columns around those that solids hide or keep dry, which tell of the liquid beside."""
SHALLOW = 2.0
"""Cells of air that a hull holds at least where its columns tell that they are dry."""
SHORE = 2.0
"""Columns from liquid in a hull to where its floor has come out of the sheet, at most."""
ASIDE = 1e-3
"""By how much of its size the middle of a spot is moved, so that it lies on no edge of a symmetrical body."""


class Spots:
    """Spots of the columns around some, n along y and m along x.

    Args:
        grid: the columns.
        columns: some, at least one, bool, shape (ny, nx).
    """

    def __init__(self, grid: Grid, columns: np.ndarray):
        self._grid, self._shape = grid, columns.shape
        self._near = tuple(slice(max(k.min() - AROUND, 0), k.max() + AROUND + 1) for k in np.nonzero(columns))
        self._place = tuple(slice(FINER * near.start, FINER * near.stop) for near in self._near)
        self._y, self._x = (
            grid.low[axis] + (np.arange(FINER * count)[place] + 0.5 + ASIDE) * grid.cell[axis] / FINER
            for axis, count, place in zip((1, 0), columns.shape, self._place)
        )

    def of(self, columns: np.ndarray) -> np.ndarray:
        """Values of columns, shape (ny, nx), at each spot, shape (n, m)."""
        return np.kron(columns[self._near], np.ones((FINER, FINER), columns.dtype))

    def heights(self, z: np.ndarray) -> np.ndarray:
        """Heights of a sheet [m], shape (n, m), linear between those over the columns' middles, shape (ny, nx)."""
        from scipy.ndimage import map_coordinates

        grid = self._grid
        j, i = (self._y - grid.low[1]) / grid.cell[1] - 0.5, (self._x - grid.low[0]) / grid.cell[0] - 0.5
        return map_coordinates(z.astype(float), np.meshgrid(j, i, indexing="ij"), order=1, mode="nearest")

    def against(self, z: np.ndarray, vertices: np.ndarray, triangle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """`against_bodies` for heights of the spots [m], shape (n, m)."""
        return against_bodies(self._x, self._y, z, vertices, triangle)

    def all(self, told: np.ndarray) -> np.ndarray:
        """Values of the spots, bool, among all spots, shape (FINER ny, FINER nx); false elsewhere."""
        whole = np.zeros([FINER * count for count in self._shape], bool)
        whole[self._place] = told
        return whole


def dry_spots(grid: Grid, smooth: np.ndarray, raw: np.ndarray, vertices: np.ndarray, triangle: np.ndarray) -> np.ndarray:
    """Spots of the sheet that something keeps dry, as a hull does its inside; bool, shape (FINER ny, FINER nx).

    Bodies cut the sheet into regions, and its columns tell whether a region is dry. It is also where none tells anything and the
    floor of a hull lies close below: air less than `SHALLOW` is not told. In a region with liquid, dry columns within `SHORE` of
    it are those over which the hull's floor rises, so the sheet runs on, under the floor. Within bodies all goes with the
    nearest region: a dry one ends in the middle of its planks, out of sight.

    Args:
        grid: the columns.
        smooth, raw: heights z [m], shape (ny, nx); raw ones are minus infinity in a dry column, NaN in one that a solid hides.
        vertices: of the surfaces of all bodies [m], shape (V, 3).
        triangle: their corners, counter-clockwise seen from outside, shape (T, 3).
    """
    from scipy.ndimage import distance_transform_edt, label

    if np.isfinite(raw).all():
        return np.zeros((FINER * raw.shape[0], FINER * raw.shape[1]), bool)
    spots = Spots(grid, ~np.isfinite(raw))
    z, told = spots.heights(smooth), spots.of(raw)
    solid, floor = spots.against(z, vertices, triangle)
    region, count = label(~solid)
    bare, wet = np.isneginf(told) & ~solid, np.isfinite(told) & (told > z - grid.cell[2]) & ~solid
    pool, _ = label(wet)
    wet &= np.bincount(pool.ravel())[pool] > DRIP * FINER**2
    some = lambda where: np.bincount(region[where], minlength=count + 1) > 0
    has_bare, has_wet, deep = some(bare), some(wet), some(z - floor > SHALLOW * grid.cell[2])
    found = (~has_wet & (has_bare | ~deep))[region]
    for n in np.flatnonzero(has_wet & has_bare):
        to_bare, to_wet = (distance_transform_edt(~(state & (region == n))) for state in (bare, wet))
        found |= (region == n) & (to_bare + SHORE * FINER <= to_wet)
    return spots.all(beside(solid, found))


def beside(solid: np.ndarray, told: np.ndarray) -> np.ndarray:
    """Values at spots; at those in a solid, the value at the nearest spot that is in none; (n, m) each."""
    from scipy.ndimage import distance_transform_edt

    j, i = distance_transform_edt(solid, return_distances=False, return_indices=True)
    return told[j, i]


def against_bodies(
    x: np.ndarray, y: np.ndarray, z: np.ndarray, vertices: np.ndarray, triangle: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Whether points are in bodies, bool; the highest face below each that looks up, z [m], minus infinity without; (n, m) each.

    More faces above a point look up than down if it is in a body.

    Args:
        x, y: ascending coordinates of the points [m], shape (m,) and (n,).
        z: their heights [m], shape (n, m).
        vertices, triangle: as for `dry_spots`.
    """
    corner = vertices[triangle]
    one, other = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    double_area = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]
    # The points in each triangle's bounds.
    low, high = corner.min(axis=1), corner.max(axis=1)
    (i, right), (j, back) = (
        (np.searchsorted(along, low[:, axis]), np.searchsorted(along, high[:, axis])) for axis, along in ((0, x), (1, y))
    )
    across = right - i
    count = np.where(double_area != 0.0, across * (back - j), 0)
    face = np.repeat(np.arange(len(corner)), count)
    step = np.arange(len(face)) - np.repeat(np.cumsum(count) - count, count)
    i, j = i[face] + step % across[face], j[face] + step // across[face]
    to_x, to_y = x[i] - corner[face, 0, 0], y[j] - corner[face, 0, 1]
    u = (to_x * other[face, 1] - to_y * other[face, 0]) / double_area[face]
    v = (one[face, 0] * to_y - one[face, 1] * to_x) / double_area[face]
    height = corner[face, 0, 2] + u * one[face, 2] + v * other[face, 2]
    covers = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0)
    above, below = covers & (height > z[j, i]), covers & (height <= z[j, i]) & (double_area[face] > 0.0)
    up_less_down = np.bincount(j[above] * len(x) + i[above], np.sign(double_area[face[above]]), z.size)
    floor = np.full(z.shape, -np.inf)
    np.maximum.at(floor, (j[below], i[below]), height[below])
    return up_less_down.reshape(z.shape) > 0.5, floor
