# SPDX-License-Identifier: GPL-2.0-only
"""The liquid as a mesh, a smooth sheet with side walls or the blocks of its cells; and where it is kept out.

A frame moves vertices only.
"""

from __future__ import annotations

import numpy as np

from ..model.basin import Grid


class Sheet:
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

    @property
    def rim(self) -> np.ndarray:
        """Vertices along which the surface meets the walls, a closed line, int64, shape (R,)."""
        return np.concatenate([side[:-1] for side in self._sides])


class Drops:
    """Drops as balls of a few triangles.

    Args:
        most: drops. V vertices: as many for each of them; without a radius they are one point.
    """

    def __init__(self, most: int):
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkFiltersModeling import vtkLinearSubdivisionFilter
        from vtkmodules.vtkFiltersSources import vtkPlatonicSolidSource

        ball, fine = vtkPlatonicSolidSource(), vtkLinearSubdivisionFilter()
        ball.SetSolidTypeToIcosahedron()
        fine.SetInputConnection(ball.GetOutputPort())
        fine.Update()
        points = vtk_to_numpy(fine.GetOutput().GetPoints().GetData()).astype(float)
        triangle = vtk_to_numpy(fine.GetOutput().GetPolys().GetConnectivityArray()).reshape(-1, 3)
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


def undersides(grid: Grid, position: np.ndarray) -> np.ndarray:
    """Lowest point of any object over each column of cells and those around it; the floor if there is none.

    Args:
        grid: the columns.
        position: of particles [m], shape (N, 3); about as dense as the cells, so that a hull has no gaps.

    Returns:
        z [m], shape (ny, nx).
    """
    from scipy.ndimage import minimum_filter

    nx, ny, _ = grid.shape
    column = np.floor((position[:, :2] - grid.low[:2]) / grid.cell[:2]).astype(int)
    within = ((column >= 0) & (column < (nx, ny))).all(axis=1)
    (i, j), z = column[within].T, position[within, 2]
    lowest = np.full((ny, nx), np.inf)
    np.minimum.at(lowest, (j, i), z)
    lowest = minimum_filter(lowest, 3)
    return np.where(np.isfinite(lowest), np.maximum(lowest, grid.low[2]), grid.low[2])


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
