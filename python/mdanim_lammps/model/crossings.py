# SPDX-License-Identifier: GPL-2.0-only
"""Where vertical lines meet triangles: points [m] (V, 3), triangles (T, 3)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np


def crossings(
    points: np.ndarray, triangles: np.ndarray, lines: np.ndarray, batch: int = 2_000_000
) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Where vertical lines at (x, y) [m], shape (L, 2), meet triangles: line numbers, heights [m], and whether the
    way up comes to the side where the triangle is counter-clockwise, in batches.

    A line through a common edge counts for exactly one of its two triangles: both ask on which side of the
    edge it passes, in the same arithmetic.
    """
    if not len(lines):
        return
    low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    # Slightly displaced, so that a line does not hit a vertex on a lattice of round numbers.
    lines = lines + 1e-9 * np.array([0.5772156649, 0.3819660113]) * (high - low)
    low, high = np.maximum(low, lines.min(axis=0)), np.minimum(high, lines.max(axis=0))
    a, b, c = (points[corner, :2] for corner in triangles.T)
    least, most = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
    near = np.flatnonzero(((least <= high) & (most >= low)).all(axis=1))
    if not len(near):
        return
    bins = int(np.clip(np.sqrt(len(lines)), 1, 1024))
    to_bin = bins / np.maximum(high - low, np.finfo(float).tiny)
    column, row = (((lines - low) * to_bin).clip(0, bins - 1).astype(np.int64)).T
    order = np.argsort(row * bins + column, kind="stable")
    first = np.searchsorted((row * bins + column)[order], np.arange(bins * bins + 1))

    c0, r0 = ((least[near] - low) * to_bin).clip(0, bins - 1).astype(np.int64).T
    c1, r1 = ((most[near] - low) * to_bin).clip(0, bins - 1).astype(np.int64).T
    # The bins of one row that a triangle may touch are one stretch of the sorted lines.
    triangle, row = _ranges(r0, r1 + 1)
    start, stop = first[row * bins + c0[triangle]], first[row * bins + c1[triangle] + 1]
    pairs = np.cumsum(stop - start)
    cuts = np.searchsorted(pairs, np.arange(0, pairs[-1], batch))
    for a, b in zip(cuts, np.append(cuts[1:], len(pairs))):
        stretch, at = _ranges(start[a:b], stop[a:b])
        yield _hits(points, triangles, lines, order[at], near[triangle[a:b][stretch]])


def _ranges(start: np.ndarray, stop: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Write out the ranges start[k] .. stop[k] - 1: the number k of each element, and the element."""
    length = stop - start
    owner = np.repeat(np.arange(len(start)), length)
    return owner, np.arange(len(owner)) - np.repeat(np.cumsum(length) - length - start, length)


def _hits(points: np.ndarray, triangles: np.ndarray, lines: np.ndarray, line: np.ndarray, triangle: np.ndarray):
    """Pairs (line, triangle) that intersect: line numbers, heights [m] and sides."""
    px, py = lines[line].T
    leaves, meets = None, np.arange(len(line))
    for i, j in ((0, 1), (1, 2), (2, 0)):  # most pairs miss the first side or the second
        a, b = triangles[:, i], triangles[:, j]
        u, v = points[np.minimum(a, b), :2].T, points[np.maximum(a, b), :2].T
        # Once for each triangle: its number, not those of its corners, is looked up for a pair.
        ux, uy, dx, dy = (row[triangle[meets]] for row in (*u, *(v - u)))
        left = dx * (py[meets] - uy) >= dy * (px[meets] - ux)
        side = left == (a < b)[triangle[meets]]
        keep = slice(None) if leaves is None else side == leaves
        leaves, meets = side[keep], meets[keep]
    line, corner, px, py = line[meets], triangles[triangle[meets]], px[meets], py[meets]
    a, b, c = np.moveaxis(points[corner], 1, 0)
    n = np.cross(b - a, c - a)
    with np.errstate(divide="ignore", invalid="ignore"):
        z = a[:, 2] - (n[:, 0] * (px - a[:, 0]) + n[:, 1] * (py - a[:, 1])) / n[:, 2]
    lowest = np.minimum(np.minimum(a[:, 2], b[:, 2]), c[:, 2])
    highest = np.maximum(np.maximum(a[:, 2], b[:, 2]), c[:, 2])
    # An almost vertical triangle has no exact height; any height between its corners is valid.
    return line, np.where(np.isfinite(z), z, a[:, 2]).clip(lowest, highest), leaves
