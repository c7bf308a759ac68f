# SPDX-License-Identifier: GPL-2.0-only
"""Closed surfaces of triangles that hold bodies: slabs of uneven triangles, profiles with creases, bowls, pipes with bends."""

from __future__ import annotations

import numpy as np
import rigid_lab as lab
from scipy.spatial import Delaunay


def slab(size, depth: float, count: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """A slab below z = 0 whose top has some uneven triangles: points [m], shape (N, 3), and triangles, shape (T, 3)."""
    random, half = np.random.default_rng(seed), np.asarray(size, float) / 2
    ends = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * half
    inside = random.uniform(-0.98, 0.98, (count, 2)) * half
    flat = np.concatenate([ends, inside])
    top = Delaunay(flat).simplices
    a, b, c = (flat[top[:, k]] for k in range(3))
    turned = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) < (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    top = np.where(turned[:, None], top[:, ::-1], top)
    points = np.concatenate([np.c_[flat, np.zeros(len(flat))], np.c_[ends, np.full(4, -depth)]])
    low = np.arange(4) + len(flat)
    triangles = [*top.tolist(), [low[0], low[2], low[1]], [low[0], low[3], low[2]]]
    for k in range(4):
        n = (k + 1) % 4
        triangles += [[k, low[k], low[n]], [k, low[n], n]]
    return points, np.array(triangles)


def profile(outline, width: float) -> tuple[np.ndarray, np.ndarray]:
    """A prism along y over an outline (x, z), counter-clockwise seen from y = -infinity, which may be concave."""
    import pyvista

    outline = np.asarray(outline, float)
    n = len(outline)
    flat = pyvista.PolyData(np.c_[outline[:, 0], np.zeros(n), outline[:, 1]], faces=[n, *range(n)]).triangulate()
    front = np.asarray(flat.faces).reshape(-1, 4)[:, 1:]
    points = np.concatenate([np.c_[outline[:, 0], np.full(n, y), outline[:, 1]] for y in (-width / 2, width / 2)])
    a, b, c = (points[front[:, k]] for k in range(3))
    turned = np.cross(b - a, c - a)[:, 1] > 0
    front = np.where(turned[:, None], front[:, ::-1], front)
    k = np.arange(n)
    m = (k + 1) % n
    sides = np.concatenate([np.c_[k, k + n, m + n], np.c_[k, m + n, m]])
    return points, np.concatenate([front, front[:, ::-1] + n, sides])


def prism(sides: int, radius: float, height: float) -> tuple[np.ndarray, np.ndarray]:
    """As lab.prism, about its middle."""
    k = np.arange(sides)
    m, angle = (k + 1) % sides, 2 * np.pi * k / sides
    points = np.concatenate([np.c_[radius * np.cos(angle), radius * np.sin(angle), np.full(sides, z)] for z in (-0.5, 0.5)])
    points[:, 2] *= height
    top = np.c_[np.zeros(sides - 2, int), k[1:-1], k[2:]] + sides
    return points, np.concatenate([top, top[:, ::-1] - sides, np.c_[k, m, m + sides], np.c_[k, m + sides, k + sides]])


def bowl(radius: float, wall: float, up: float, across: int, along: int) -> tuple[np.ndarray, np.ndarray]:
    """A part of a hollow sphere that begins at the origin, up to an angle, with this number of corners around and up."""
    angle, turn = np.linspace(0.0, up, along), 2 * np.pi * np.arange(across) / across
    inner = [(radius * np.sin(a), radius * (1 - np.cos(a))) for a in angle[1:]]
    outer = [((radius + wall) * np.sin(a), radius - (radius + wall) * np.cos(a)) for a in angle[:0:-1]]
    points, triangles = grid(
        np.array([[[r * np.cos(t), r * np.sin(t), z] for t in turn] for r, z in inner + outer]), closed=False
    )
    points[-2:] = (0, 0, 0), (0, 0, -wall)
    return outward(points, triangles)


def pipe(radius, drop, turns, inner, outer, along: int, across: int) -> tuple[np.ndarray, np.ndarray]:
    """A pipe that winds down about z from (radius, 0, 0), by a drop in each turn, with walls from one radius to the other [m]."""
    t, a = np.linspace(0, 2 * np.pi * turns, along), 2 * np.pi * np.arange(across) / across
    middle = np.stack([radius * np.cos(t), radius * np.sin(t), -drop * t / (2 * np.pi)], axis=1)
    out = np.stack([np.cos(t), np.sin(t), 0 * t], axis=1)
    way = np.stack([-radius * np.sin(t), radius * np.cos(t), np.full(along, -drop / (2 * np.pi))], axis=1)
    up = np.cross(out, way / np.linalg.norm(way, axis=1)[:, None])

    def rings(size):
        return middle[:, None] + size * (np.cos(a)[:, None] * out[:, None] + np.sin(a)[:, None] * up[:, None])

    return grid(np.concatenate([rings(outer), rings(inner)[::-1]]))


def grid(rows: np.ndarray, closed: bool = True) -> tuple[np.ndarray, np.ndarray]:
    """A torus of quadrilaterals, rows (M, N, 3) [m], each cut in two; or a tube with ends closed by their middles."""
    m, n = rows.shape[:2]
    at = np.arange(m * n).reshape(m, n)
    low = at if closed else at[:-1]
    high = np.roll(at, -1, axis=0) if closed else at[1:]
    a, b, c, d = low, np.roll(low, -1, axis=1), np.roll(high, -1, axis=1), high
    triangles = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    points = rows.reshape(-1, 3)
    if not closed:
        points = np.concatenate([points, rows[0].mean(axis=0)[None], rows[-1].mean(axis=0)[None]])
        first, last = at[0], at[-1]
        triangles = np.concatenate(
            [
                triangles,
                np.stack([np.roll(first, -1), first, np.full(n, m * n)], -1),
                np.stack([last, np.roll(last, -1), np.full(n, m * n + 1)], -1),
            ]
        )
    return outward(points, triangles)


def outward(points, triangles) -> tuple[np.ndarray, np.ndarray]:
    """With triangles turned so that the volume is above 0."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    volume = np.einsum("td,td->", a, np.cross(b, c))
    return points, triangles if volume > 0 else triangles[:, ::-1]


def solid(points, triangles, thin: float, density=600.0) -> lab.Rigid:
    """A body that moves, along its principal axes and about its centre of mass."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    six = np.einsum("td,td->t", a, np.cross(b, c))
    points = points - (six[:, None] * (a + b + c)).sum(0) / (4 * six.sum())
    a, b, c = (points[triangles[:, k]] for k in range(3))
    ends = np.stack([a, b, c, a + b + c], axis=1)
    second = np.einsum("t,tkd,tke->de", six, ends, ends) / 120
    moments, axes = np.linalg.eigh(density * (np.trace(second) * np.eye(3) - second))
    axes[:, 0] *= np.linalg.det(axes)
    points = points @ axes
    body = lab.mesh(points, triangles, thin)
    return body.put(mass=float(density * six.sum() / 6), moments=moments, held=False, spread=np.abs(points).max(0) / 4)
