# SPDX-License-Identifier: GPL-2.0-only
"""The liquid as a mesh, a smooth sheet with side walls or the blocks of its cells; and where it is kept out.

A frame moves vertices only.
"""

from __future__ import annotations

import numpy as np

from ..model.grid import Grid


class LiquidSheet:
    """The surface over the column centres, drawn out to the basin's edges, and its walls down to the floor.

    V vertices: (nx + 2)(ny + 2) of the surface, then top and bottom of each wall. T triangles,
    counter-clockwise seen from outside. Bilinear between its vertices it holds exactly the sum of the heights
    times a column's area.
    """

    def __init__(self, grid: Grid):
        self._floor = grid.low[2]
        self._x, self._y = (_centres_and_ends(grid, axis) for axis in (0, 1))
        index = np.arange(len(self._x) * len(self._y)).reshape(len(self._y), len(self._x))
        # Around the basin, counter-clockwise seen from above: front, right, back, left.
        self._sides = (index[0], index[:, -1], index[-1, ::-1], index[::-1, 0])
        outward = np.array([(0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0)])
        self._outward = np.repeat(outward, [2 * len(side) for side in self._sides], axis=0)
        quads = [np.stack([index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]], axis=-1)]
        first = index.size
        for side in self._sides:
            top = first + np.arange(len(side))
            bottom = top + len(side)
            quads.append(np.stack([bottom[:-1], bottom[1:], top[1:], top[:-1]], axis=-1))
            first += 2 * len(side)
        self.triangle = _halves(np.concatenate([q.reshape(-1, 4) for q in quads]))
        """Vertex indices, int32, shape (T, 3)."""

    def mesh(self, height: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Vertices [m] and outward unit normals, each of shape (V, 3), for heights z [m], shape (ny, nx)."""
        z = np.pad(height, 1, mode="edge")
        x, y = np.meshgrid(self._x, self._y)
        surface = np.stack([x, y, z], axis=-1).reshape(-1, 3)
        walls = []
        for side in self._sides:
            top = surface[side]
            walls += [top, top * [1, 1, 0] + [0, 0, self._floor]]
        slope_y, slope_x = np.gradient(z, self._y, self._x)
        normal = np.stack([-slope_x, -slope_y, np.ones_like(z)], axis=-1).reshape(-1, 3)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        return np.concatenate([surface, *walls]), np.concatenate([normal, self._outward])

    def move_aside(self, points: np.ndarray, by: np.ndarray) -> None:
        """Move vertices of `mesh` over the columns by x and y [m], shape (ny, nx, 2); those on the edges stay on them."""
        by = np.pad(by, [(1, 1), (1, 1), (0, 0)], mode="edge")
        by[:, [0, -1], 0] = by[[0, -1], :, 1] = 0.0
        points[:, :2] += self._on_walls(by.reshape(-1, 2))

    def at_vertices(self, values: np.ndarray) -> np.ndarray:
        """Values of columns, shape (ny, nx), at the vertices of `mesh`, shape (V,)."""
        return self._on_walls(np.pad(values, 1, mode="edge").ravel())

    def _on_walls(self, found: np.ndarray) -> np.ndarray:
        """Values at vertices of the surface, followed by those at the walls below them, shape (V, ...)."""
        return np.concatenate([found, *(np.concatenate([found[side], found[side]]) for side in self._sides)])

    def pond(self, height: np.ndarray, quads: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Vertices and normals as of `mesh`, and triangles of a sheet over some of the quads between columns' middles.

        Args:
            height: z [m], shape (ny, nx).
            quads: which are drawn, bool, shape (ny - 1, nx - 1).
        """
        points, normals = self.mesh(height)
        nx = len(self._x)
        first = (np.arange(1, quads.shape[0] + 1)[:, None] * nx + np.arange(1, quads.shape[1] + 1))[quads]
        return points, normals, _halves(np.stack([first, first + 1, first + nx + 1, first + nx], axis=-1))

    @property
    def rim(self) -> np.ndarray:
        """Vertices along which the surface meets the walls, a closed line, int64, shape (R,)."""
        return np.concatenate([side[:-1] for side in self._sides])


PUDDLE = 16
"""Columns of liquid that lies on a body, at most."""
DRIP = 2
"""The same in the midst of a body, where a hull may hold more."""
PARTS = np.array([0.50, 0.22, 0.13, 0.08, 0.05, 0.02])
"""Parts of a drop, one for each droplet that is drawn of it: single balls of its size look like glass."""
SCATTERED = 0.4
"""Cells from the middle of a drop within which its droplets lie along each axis."""


def droplets(drops: np.ndarray, cell: float) -> np.ndarray:
    """The droplets that are drawn of drops: as much liquid, in balls that lie apart, with the same centre of mass.

    Their places follow from the drop's radius, which does not change while it flies, and differs from drop to drop.

    Args:
        drops: middles and radii [m], shape (D, 4).
        cell: edge of a cell [m].

    Returns:
        middles and radii [m], shape (P D, 4).
    """
    number = drops[:, 3].astype(np.float32).view(np.uint32).astype(np.uint64)[:, None] * np.uint64(64)
    number = (number + np.arange(3 * len(PARTS), dtype=np.uint64)) * np.uint64(0x9E3779B97F4A7C15)
    number = (number ^ (number >> np.uint64(29))) * np.uint64(0xBF58476D1CE4E5B9)
    chance = (number >> np.uint64(40)).reshape(-1, len(PARTS), 3) / 2.0**23 - 1.0
    aside = SCATTERED * cell * (chance - np.einsum("p,dpi->di", PARTS, chance)[:, None])
    rows = np.empty((len(drops), len(PARTS), 4))
    rows[:, :, :3] = drops[:, None, :3] + aside
    rows[:, :, 3] = drops[:, 3:] * np.cbrt(PARTS)
    return rows.reshape(-1, 4)


class Drops:
    """Drops as balls of a few triangles.

    Args:
        most: drops. V vertices: as many for each of them; without a radius they are one point.
        fine: whether a ball has 80 triangles; else 20.
    """

    def __init__(self, most: int, fine: bool = True):
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkFiltersModeling import vtkLinearSubdivisionFilter
        from vtkmodules.vtkFiltersSources import vtkPlatonicSolidSource

        ball, finer = vtkPlatonicSolidSource(), vtkLinearSubdivisionFilter()
        ball.SetSolidTypeToIcosahedron()
        finer.SetInputConnection(ball.GetOutputPort())
        made = finer if fine else ball
        made.Update()
        points = vtk_to_numpy(made.GetOutput().GetPoints().GetData()).astype(float)
        triangle = vtk_to_numpy(made.GetOutput().GetPolys().GetConnectivityArray()).reshape(-1, 3)
        self._ball = points / np.linalg.norm(points, axis=1, keepdims=True)
        self._most = most
        self.triangle = (triangle + len(points) * np.arange(most)[:, None, None]).reshape(-1, 3).astype(np.int32)
        """Vertex indices, int32, shape (T, 3)."""

    def mesh(self, drops: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Vertices [m] and outward unit normals, each of shape (V, 3), for middles and radii of drops [m], shape (D, 4)."""
        rows = np.zeros((self._most, 4))
        rows[: len(drops)] = drops
        points = rows[:, None, :3] + rows[:, None, 3:] * self._ball
        return points.reshape(-1, 3), np.tile(self._ball, (self._most, 1))


class Blocks:
    """Every column as a box up to its raw height; a column that tells nothing, or is kept dry, has none.

    V vertices: four on top of each column, then four of each step between neighbours across x, then across y;
    beyond the basin's edges all is floor. Where a step falls instead of rising, its face turns over.
    """

    def __init__(self, grid: Grid):
        self._floor = grid.low[2]
        x, y = (np.linspace(a, b, n + 1) for a, b, n in zip(grid.low, grid.high, grid.shape[:2]))
        nx, ny, _ = grid.shape
        column = _rings(x, y, (ny, nx), [(0, 0), (1, 0), (1, 1), (0, 1)])
        across_x = _rings(x, y, (ny, nx + 1), [(0, 1), (0, 0), (0, 0), (0, 1)])
        across_y = _rings(x, y, (ny + 1, nx), [(0, 0), (1, 0), (1, 0), (0, 0)])
        self._plan = np.concatenate([column, across_x, across_y])
        self.triangle = _halves(np.arange(len(self._plan)).reshape(-1, 4))
        """Vertex indices, int32, shape (T, 3)."""

    def mesh(self, height: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Vertices [m] and outward unit normals, both (V, 3), for raw heights z [m], shape (ny, nx)."""
        height = np.where(np.isfinite(height), height, np.nan)
        z = np.where(np.isnan(height), self._floor, height)
        beside = np.pad(height, ((0, 0), (1, 1)), constant_values=self._floor)
        behind = np.pad(height, ((1, 1), (0, 0)), constant_values=self._floor)
        steps = [self._step(beside[:, :-1], beside[:, 1:]), self._step(behind[:-1], behind[1:])]
        heights = [np.stack([z] * 4, axis=-1)] + [np.stack([a, a, b, b], axis=-1) for a, b in steps]
        points = np.column_stack([self._plan, np.concatenate([h.ravel() for h in heights])])
        normal = np.zeros_like(points)
        normal[: 4 * z.size, 2] = 1.0
        first = 4 * z.size
        for axis, (a, b) in enumerate(steps):
            normal[first : first + 4 * a.size, axis] = np.repeat(np.where(b > a, -1.0, 1.0), 4)
            first += 4 * a.size
        return points, normal

    def _step(self, before: np.ndarray, behind: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Heights on both sides of the faces between columns; none where a side tells nothing."""
        known = np.where(np.isnan(before), behind, before), np.where(np.isnan(behind), before, behind)
        return tuple(np.where(np.isnan(k), self._floor, k) for k in known)


def kept_dry(raw: np.ndarray) -> np.ndarray:
    """Columns that something keeps dry below the surface, as a hull does its inside; bool, shape (ny, nx).

    Raw heights tell it, z [m], shape (ny, nx): minus infinity. A column that a solid hides goes with the
    nearest one that none hides: a dry place ends in the middle of its planks, and cargo in it is dry.
    """
    dry = np.isneginf(raw)
    if not dry.any():
        return dry
    from scipy.ndimage import distance_transform_edt

    j, i = distance_transform_edt(np.isnan(raw), return_distances=False, return_indices=True)
    return dry[j, i]


def without_puddles(grid: Grid, smooth: np.ndarray, raw: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Heights in which liquid that lies on a body is hidden: the sheet would stand there as a spike.

    Such are columns that hang together, border on hidden ones and are two cells higher than some beside them: at most `PUDDLE`
    that have a fall all around, or at most `DRIP` with hidden columns alone around.

    Args:
        grid: the columns.
        smooth, raw: heights z [m], shape (ny, nx).
    """
    from scipy.ndimage import binary_dilation, distance_transform_edt
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    fall, count = 2.0 * grid.cell[2], smooth.size
    index, height, open_ = np.arange(count).reshape(smooth.shape), smooth.ravel(), np.isfinite(raw).ravel()
    one = np.concatenate([index[:-1].ravel(), index[:, :-1].ravel()])
    other = np.concatenate([index[1:].ravel(), index[:, 1:].ravel()])
    apart = np.abs(height[one] - height[other]) >= fall
    if not (apart & (open_[one] | open_[other])).any():
        return smooth, raw
    link = open_[one] & open_[other] & ~apart
    groups, label = connected_components(coo_matrix((link[link], (one[link], other[link])), (count, count)), directed=False)
    one, other = np.concatenate([one, other]), np.concatenate([other, one])
    both, at_body = open_[one] & open_[other], open_[one] & ~open_[other]
    has = lambda pairs: np.bincount(label[one[pairs]], minlength=groups) > 0
    down = height[one] - height[other] >= fall
    falls, rises = has(both & down), has(both & (height[other] - height[one] >= fall))
    size = np.bincount(label, minlength=groups)
    beside = has(both & (label[one] != label[other]))
    alone = (falls & ~rises & has(at_body) & (size <= PUDDLE)) | (~beside & has(at_body & down) & (size <= DRIP))
    puddle = (alone[label] & open_).reshape(smooth.shape)
    if not puddle.any():
        return smooth, raw
    # Heights of hidden columns around, which lie between those of open ones, have a part of it.
    open_ = open_.reshape(smooth.shape)
    part = puddle | (binary_dilation(puddle, np.ones((3, 3)), iterations=2) & ~open_)
    j, i = distance_transform_edt(part, return_distances=False, return_indices=True)
    lower = np.minimum(smooth, smooth[j, i])
    return np.where(puddle, smooth[j, i], np.where(part, lower, smooth)), np.where(puddle, np.nan, raw)


def undersides(grid: Grid, position: np.ndarray) -> np.ndarray:
    """Lowest point of any object over each column of cells and those around it; the floor if there is none.

    Args:
        grid: the columns.
        position: of particles [m], shape (N, 3); about as dense as the cells, so that a hull has no gaps.

    Returns:
        z [m], shape (ny, nx).
    """
    lowest = -_highest(grid, position * [1.0, 1.0, -1.0])
    return np.where(np.isfinite(lowest), np.maximum(lowest, grid.low[2]), grid.low[2])


def _highest(grid: Grid, position: np.ndarray) -> np.ndarray:
    """Highest z [m] of the particles over each column and those around it, minus infinity where there are none."""
    from scipy.ndimage import maximum_filter

    nx, ny, _ = grid.shape
    column = np.floor((position[:, :2] - grid.low[:2]) / grid.cell[:2]).astype(int)
    within = ((column >= 0) & (column < (nx, ny))).all(axis=1)
    (i, j), z = column[within].T, position[within, 2]
    highest = np.full((ny, nx), -np.inf)
    np.maximum.at(highest, (j, i), z)
    return maximum_filter(highest, 3)


def overhang(grid: Grid, height: np.ndarray, position: np.ndarray) -> np.ndarray:
    """How far the sheet's vertices over the columns are moved aside, x and y [m], shape (ny, nx, 2).

    Liquid that runs over a solid falls off its end. A straight line from the last column over the solid to the first one beside
    it would cut the corner off; half a column farther it passes in front of it.

    Args:
        grid: the columns.
        height: of the sheet, z [m], shape (ny, nx).
        position: of particles [m], shape (N, 3).
    """
    highest, aside = _highest(grid, position), np.zeros((*height.shape, 2))
    on_solid = (highest > grid.low[2]) & (highest < height)
    for axis in (0, 1):
        z = np.pad(height, [(1, 1) if k == 1 - axis else (0, 0) for k in (0, 1)], mode="edge")
        before, after = (np.delete(z, cut, 1 - axis) for cut in ((-2, -1), (0, 1)))
        # Down to where the solid's end is bare: below its top.
        falls = [on_solid & (side < np.minimum(highest, height - grid.cell[2])) for side in (before, after)]
        aside[:, :, axis] = 0.55 * grid.cell[axis] * (falls[1].astype(float) - falls[0])
    return aside


def _centres_and_ends(grid: Grid, axis: int) -> np.ndarray:
    """Both ends of the basin and the centres of its columns between them [m], shape (n + 2,)."""
    low, edge, count = grid.low[axis], grid.cell[axis], grid.shape[axis]
    return np.concatenate([[low], low + (np.arange(count) + 0.5) * edge, [grid.high[axis]]])


def _rings(x: np.ndarray, y: np.ndarray, shape: tuple[int, int], corners) -> np.ndarray:
    """Four plan points of each face: x[i + a], y[j + b] for its corners (a, b) [m], shape (4 * faces, 2)."""
    j, i = np.indices(shape)
    return np.stack([np.stack([x[i + a], y[j + b]], axis=-1) for a, b in corners], axis=2).reshape(-1, 2)


def _halves(quad: np.ndarray) -> np.ndarray:
    """Two triangles for each quad, int32, shape (2 Q, 3)."""
    return np.concatenate([quad[:, [0, 1, 2]], quad[:, [0, 2, 3]]]).astype(np.int32)
