# SPDX-License-Identifier: GPL-2.0-only
"""Maps from lattice coordinates of a cuboid to space, and back by Newton's method to the end."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np


def linear(X, cell, nodes: int = 2):
    """First node, weights (P, nodes), their slopes and the slopes of these along one axis: those of a third node are 0."""
    u, zero = X - cell, np.zeros_like(X)
    slope = np.stack([zero - 1.0, zero + 1.0, zero][:nodes], -1)
    return cell, np.stack([1.0 - u, u, zero][:nodes], -1), slope, np.zeros_like(slope)


def smooth(X, cells: int):
    """The same of quadratic B-splines, linear within half a cell of an end and beyond it."""
    middle = np.floor(X + 0.5)
    u = X - middle
    w = np.stack([(0.5 - u) ** 2 / 2.0, 0.75 - u**2, (0.5 + u) ** 2 / 2.0], -1)
    slope = np.stack([u - 0.5, -2.0 * u, u + 0.5], -1)
    bend = np.tile([1.0, -2.0, 1.0], (len(X), 1))
    end = np.where((X < 0.5) | (cells == 1), 0.0, cells - 1.0)
    first, straight, straight_slope, straight_bend = linear(X, end, 3)
    is_straight = (X < 0.5) | (cells == 1) | (X - (cells - 0.5) >= 0.0)
    pick = is_straight[:, None]
    of_axis = ((straight, w), (straight_slope, slope), (straight_bend, bend))
    return np.where(is_straight, first, middle - 1.0), *(np.where(pick, a, b) for a, b in of_axis)


@dataclass
class Spot:
    """Where points X are: place (P, 3), J = dx/dX (P, 3, 3), dJ/dX (P, 3, 3, 3), nodes (P, 8 or 27), their weights and the
    gradients of these by X."""

    x: np.ndarray
    J: np.ndarray
    dJ: np.ndarray
    nodes: np.ndarray
    N: np.ndarray
    dN: np.ndarray

    def to_material(self, way):
        """A change of place as one of X."""
        return np.einsum("pac,pc->pa", self.K, way)

    def gradient(self, slope):
        """A gradient by X as one in space."""
        return np.einsum("pac,pa->pc", self.K, slope)

    def take(self, rows) -> Spot:
        """Some of the points."""
        return Spot(*(getattr(self, part.name)[rows] for part in fields(self)))

    @cached_property
    def K(self):
        """dX/dx."""
        return np.linalg.inv(self.J)


def evaluate(x, count, axes) -> Spot:
    """The map with these weights along the axes; ``x`` are the particles of a cuboid, x fastest."""
    (first_x, wx, sx, bx), (first_y, wy, sy, by), (first_z, wz, sz, bz) = axes
    n = wx.shape[1]
    i, j, k = (np.minimum(first[:, None].astype(int) + np.arange(n), c) for first, c in zip((first_x, first_y, first_z), count))
    product = lambda a, b, c: (c[:, :, None, None] * b[:, None, :, None] * a[:, None, None, :]).reshape(len(a), n**3)
    nx, ny = count[0] + 1, count[1] + 1
    nodes = (i[:, None, None, :] + nx * (j[:, None, :, None] + ny * k[:, :, None, None])).reshape(len(i), n**3)
    N = product(wx, wy, wz)
    dN = np.stack([product(sx, wy, wz), product(wx, sy, wz), product(wx, wy, sz)], -1)
    xy, xz, yz = product(sx, sy, wz), product(sx, wy, sz), product(wx, sy, sz)
    ddN = np.stack([product(bx, wy, wz), xy, xz, xy, product(wx, by, wz), yz, xz, yz, product(wx, wy, bz)], -1)
    at = x[nodes]
    dJ = (at.transpose(0, 2, 1) @ ddN).reshape(-1, 3, 3, 3)
    return Spot((N[:, None, :] @ at)[:, 0], at.transpose(0, 2, 1) @ dN, dJ, nodes, N, dN)


def trilinear_spot(x, count, X, cell, nodes: int = 2) -> Spot:
    """By the cells given."""
    return evaluate(x, count, [linear(X[:, a], cell[:, a].astype(float), nodes) for a in range(3)])


def smooth_spot(x, count, X) -> Spot:
    """By B-splines."""
    return evaluate(x, count, [smooth(X[:, a], int(count[a])) for a in range(3)])


def newton(place, X, spot_of):
    """X of these places, to the last bit that it reaches; NaN where a cell is turned inside out on the way."""
    for _ in range(60):
        spot = spot_of(np.nan_to_num(X))
        X = np.where((np.linalg.det(spot.J) > 0.0)[:, None], X, np.nan)
        if not np.isfinite(X).all():
            spot.J[~np.isfinite(X).all(1)] = np.eye(3)
        change = spot.to_material(place - spot.x)
        length = np.linalg.norm(change, axis=1, keepdims=True)
        X = X + change / np.maximum(1.0, 2.0 * length)
        if length[np.isfinite(X).all(1)].max(initial=0.0) < 1e-7:  # the next step would be its square
            return X
    return np.where(length < 1e-7, X, np.nan)


def inverse(x, count, place, X, is_smooth):
    """X and cell of these places; ``X`` is where to begin. X is NaN where it is not found."""
    for _ in range(20):
        cell = np.clip(np.floor(np.nan_to_num(X)), 0, count - 1)
        X = newton(place, X, lambda at, cell=cell: trilinear_spot(x, count, at, cell))
        if (np.clip(np.floor(np.nan_to_num(X) + 1e-9), 0, count - 1) == cell).all():
            break
    X[is_smooth] = newton(place[is_smooth], X[is_smooth], lambda at: smooth_spot(x, count, at))
    at = np.nan_to_num(X)
    spot, sharp = trilinear_spot(x, count, at, cell, 3), smooth_spot(x, count, at[is_smooth])
    for part in fields(Spot):
        getattr(spot, part.name)[is_smooth] = getattr(sharp, part.name)
    return X, cell.astype(int), spot
