# SPDX-License-Identifier: GPL-2.0-only
"""Naive twin of level.h and surface.h of plugin/liquid/automaton/: whole arrays (nz, ny, nx), bodies by scipy."""

from collections import deque
from math import ceil

import numpy as np
from scipy import ndimage

U64 = (1 << 64) - 1
LEVEL = 3  # number of Phase::LEVEL
FACES = [(0, 0, 1), (0, 0, -1), (0, 1, 0), (0, -1, 0), (1, 0, 0), (-1, 0, 0)]


def mix64(x):
    """The finaliser of splitmix64."""
    x = (x + 0x9E3779B97F4A7C15) & U64
    x = ((x ^ (x >> 30)) * 0xBF58476D1CE4E5B9) & U64
    x = ((x ^ (x >> 27)) * 0x94D049BB133111EB) & U64
    return x ^ (x >> 31)


def draw(seed, when, cell):
    """The draw of a cell for the level rule."""
    return mix64(mix64(mix64(mix64(seed) + when & U64) + LEVEL & U64) ^ mix64(cell))


def neighbour(a, step):
    """Value of the neighbour of every cell at (dz, dy, dx); False outside the grid."""
    padded = np.pad(a, 1)
    return padded[tuple(slice(1 + d, 1 + d + n) for d, n in zip(step, a.shape))]


def bodies(content, solid):
    """Every body as (cells, exposed cells, cells beside it), bool arrays, first cells from the top down."""
    empty = (content == 0) & (solid == 0)
    labels, count = ndimage.label(content > 0)
    first = [min((-z, y, x) for z, y, x in np.argwhere(labels == n)) for n in range(1, count + 1)]
    for n in sorted(range(count), key=first.__getitem__):
        cells = labels == n + 1
        beside = empty & np.any([neighbour(cells, step) for step in FACES], axis=0)
        yield cells, cells & ~neighbour(~empty, (1, 0, 0)), beside  # above the grid nothing covers


def is_level(content, cells, exposed, beside):
    """No excess, and no exposed cell above one beside the body."""
    if (content[cells] > 1).any():
        return False
    if not (exposed.any() and beside.any()):
        return True
    return np.nonzero(exposed)[0].max() <= np.nonzero(beside)[0].min()


def move(content, solid, seed, when, rate, at_least):
    """The cells after one call, and units moved: source k goes to target k (docs/physics-liquid.md)."""
    after = content.copy()
    moved = 0
    lot = lambda cell: draw(seed, when, int(np.ravel_multi_index(cell, content.shape)))
    order = lambda mask, sign: sorted(map(tuple, np.argwhere(mask)), key=lambda c: (sign * c[0], lot(c)))
    for cells, exposed, beside in list(bodies(content, solid)):
        excess = [c for c in order(cells & (content > 1), -1) for _ in range(content[c] - 1)]
        sources = [(c, True) for c in excess] + [(c, False) for c in order(exposed, -1)]
        targets = [c for c in order(beside, 1) if after[c] == 0]
        most = max(1, ceil(rate * exposed.sum()), at_least)
        for (source, any_height), target in list(zip(sources, targets))[:most]:
            if not any_height and source[0] - target[0] < 1:
                break
            after[source] -= 1
            after[target] += 1
            moved += 1
    return after, moved


UNEVEN = -1.0
"""A height that is still to be counted."""


def heights(content, solid):
    """Heights (ny, nx) and whether all is level."""
    nz, ny, nx = content.shape
    told = np.full((nz, ny, nx), np.nan)  # by the exposed cell in which a column ends
    every = True
    for cells, exposed, beside in bodies(content, solid):
        level = is_level(content, cells, exposed, beside)
        every &= level
        on_liquid = exposed & neighbour(cells, (-1, 0, 0))
        z = np.nonzero(exposed)[0]
        if len(z) == 0 or not (on_liquid.any() or exposed[0].any()):
            continue
        told[exposed] = UNEVEN
        if level:
            full = on_liquid[z.max()].sum()
            part = exposed[z.max() - 1].sum() if z.max() > 0 else 0
            if full + part > 0:
                told[exposed] = z.max() + full / (full + part)
    height = np.zeros((ny, nx))
    for y in range(ny):
        for x in range(nx):
            wet = np.flatnonzero(content[:, y, x])
            if len(wet):
                height[y, x] = told[wet[-1], y, x]
                if height[y, x] == UNEVEN:
                    below = np.flatnonzero(solid[: wet[-1], y, x])
                    bed = below[-1] + 1 if len(below) else 0
                    height[y, x] = min(nz, bed + content[bed : wet[-1] + 1, y, x].astype(int).sum())
            elif solid[:, y, x].any():
                height[y, x] = np.nan
    return height, every


def energy(content):
    """Sum of layer numbers of all units."""
    return int((np.arange(len(content))[:, None, None] * content.astype(int)).sum())


def smooth(height, blocked, steps=10, mix=0.2):
    """The filter as a matrix of one step applied to weights and weighted heights, then rings of means."""
    ny, nx = height.shape
    free = ~np.asarray(blocked, bool)
    step = np.eye(ny * nx)
    inside = lambda y, x: 0 <= y < ny and 0 <= x < nx
    around = lambda y, x: [c for c in ((y, x + 1), (y, x - 1), (y + 1, x), (y - 1, x)) if inside(*c)]
    for y in range(ny):
        for x in range(nx):
            for v, u in around(y, x):
                if free[y, x] and free[v, u]:
                    step[y * nx + x, v * nx + u] += mix
                    step[y * nx + x, y * nx + x] -= mix
    tells = free & ~np.isnan(height)
    spread = np.linalg.matrix_power(step, steps)
    weight = spread @ tells.ravel()
    value = spread @ np.where(tells, height, 0.0).ravel()
    known = (weight > 1e-14).reshape(ny, nx)  # the least weight that can come along is 0.2^10 = 1e-7
    result = np.where(known, (value / np.where(weight > 1e-14, weight, 1.0)).reshape(ny, nx), 0.0)
    for within in (free, np.ones_like(free)):
        while True:
            ring = deque()
            for y, x in np.argwhere(within & ~known):
                values = [result[c] for c in around(y, x) if known[c]]
                if values:
                    ring.append((y, x, np.mean(values)))
            if not ring:
                break
            for y, x, mean in ring:
                result[y, x], known[y, x] = mean, True
    return result
