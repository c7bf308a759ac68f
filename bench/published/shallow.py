# SPDX-License-Identifier: GPL-2.0-only
"""Dams by shallow water alone: finite volumes, first order, fluxes of Harten, Lax and van Leer.

``python bench/published/shallow.py`` prints the force on the column while the flood is even and at its least, as the case has
them, on a dry floor and on one with a centimetre of water, and places of the front of a dam that is twice as high as wide. Half
of the tank of the column is computed, as both halves are mirror images.
"""

from __future__ import annotations

import numpy as np

G, DRY = 9.81, 1e-6
LONG, WIDE, GATE, DEEP = 1.6, 0.305, 0.4, 0.3
MIDDLE, HALF = 0.96, 0.06
"""Place of the column and half of its width [m]."""


def _flux(left: np.ndarray, right: np.ndarray, along: int) -> np.ndarray:
    """Flux of depth and momenta through faces across an axis, 1 or 2, shape (3, ...)."""
    h, u, v = ([], [], [])
    for q in (left, right):
        h.append(q[0])
        u.append(np.where(q[0] > DRY, q[along] / np.maximum(q[0], DRY), 0.0))
        v.append(np.where(q[0] > DRY, q[3 - along] / np.maximum(q[0], DRY), 0.0))
    c = [np.sqrt(G * depth) for depth in h]
    slow = np.where(h[0] > DRY, np.minimum(u[0] - c[0], np.where(h[1] > DRY, u[1] - c[1], np.inf)), u[1] - 2.0 * c[1])
    fast = np.where(h[1] > DRY, np.maximum(u[1] + c[1], np.where(h[0] > DRY, u[0] + c[0], -np.inf)), u[0] + 2.0 * c[0])
    slow, fast = np.minimum(slow, 0.0), np.maximum(fast, 0.0)
    span = np.maximum(fast - slow, 1e-9)

    def between(f: list, q: list) -> np.ndarray:
        return (fast * f[0] - slow * f[1] + slow * fast * (q[1] - q[0])) / span

    found = np.empty_like(left)
    found[0] = between([h[k] * u[k] for k in (0, 1)], h)
    found[along] = between([h[k] * u[k] ** 2 + 0.5 * G * h[k] ** 2 for k in (0, 1)], [h[k] * u[k] for k in (0, 1)])
    found[3 - along] = found[0] * np.where(found[0] > 0.0, v[0], v[1])
    return found


def force(cell: float, wet: float, time: float = 1.9) -> np.ndarray:
    """Times and force on the column [s], [N], shape (2, steps), with this depth of water on the floor [m]."""
    x, y = ((np.arange(round(side / cell)) + 0.5) * cell for side in (LONG, WIDE))
    solid = (np.abs(x - MIDDLE) < HALF) & (y[:, None] < HALF)
    ahead, behind = np.flatnonzero(np.abs(x - MIDDLE) < HALF)[[0, -1]]
    q = np.zeros((3, len(y), len(x)))
    q[0] = np.where(solid, 0.0, np.where(x < GATE, DEEP, wet))
    now, found = 0.0, []
    while now < time:
        speed = (np.abs(q[1]) + np.abs(q[2])) / np.maximum(q[0], 1e-4) + np.sqrt(G * q[0])
        step = 0.4 * cell / speed.max()
        change = np.zeros_like(q)
        for along, axis in ((1, 2), (2, 1)):
            many = q.shape[axis]
            ends = [(0, 0)] * 3
            ends[axis] = (1, 1)
            cells, shut = np.pad(q, ends, mode="edge"), np.pad(solid, ends[1:], constant_values=True)
            left, right = (np.take(cells, np.arange(many + 1) + k, axis=axis) for k in (0, 1))
            shut_left, shut_right = (np.take(shut, np.arange(many + 1) + k, axis=axis - 1) for k in (0, 1))
            mirror = np.array([-1.0 if k == along else 1.0 for k in range(3)])[:, None, None]
            left, right = np.where(shut_left, mirror * right, left), np.where(shut_right, mirror * left, right)
            flux = np.where(shut_left & shut_right, 0.0, _flux(left, right, along))
            change -= np.diff(flux, axis=axis) * step / cell
            if along == 1:
                push = 2000.0 * cell * (flux[1][y < HALF, ahead] - flux[1][y < HALF, behind + 1]).sum()
        q = np.where(solid, 0.0, q + change)
        q[0] = np.maximum(q[0], 0.0)
        now += step
        found.append((now, push))
    return np.array(found).T


def front(cells: int, last: float = 9.0, thin: float = 0.01) -> np.ndarray:
    """Times over √(a/2g) and places over a of the front of a dam of the width a and the height 2a, shape (2, steps): where the
    depth is over `thin` of the dam's height, with so many cells in its width."""
    cell, now, found = 1.0 / cells, 0.0, []
    x = (np.arange(round((2.0 + 2.0 * last) * cells)) + 0.5) * cell
    q = np.zeros((3, 1, len(x)))
    q[0] = np.where(x < 1.0, 2.0, 0.0)
    mirror = np.array([1.0, -1.0, 1.0])[:, None, None]
    while now < last:
        speed = np.abs(q[1]) / np.maximum(q[0], 1e-4) + np.sqrt(G * q[0])
        step = 0.4 * cell / speed.max()
        cells_in = np.concatenate([mirror * q[:, :, :1], q, q[:, :, -1:]], axis=2)
        q = q - np.diff(_flux(cells_in[:, :, :-1], cells_in[:, :, 1:], 1), axis=2) * step / cell
        q[0] = np.maximum(q[0], 0.0)
        now += step * np.sqrt(2.0 * G)
        found.append((now, x[q[0, 0] > 2.0 * thin].max() + 0.5 * cell))
    return np.array(found).T


if __name__ == "__main__":
    for cell, wet in ((0.015, 0.0), (0.0075, 0.0), (0.0075, 0.01)):
        times, pushes = force(cell, wet)
        since = times - times[np.argmax(pushes > 5.0)]
        even = np.interp(np.linspace(0.15, 0.35, 50), since, pushes).mean()
        told = f"cells of {1e3 * cell:g} mm, {1e3 * wet:g} mm of water"
        print(f"{told}: {even:.3g} N even, {pushes[since > 0.8].min():.3g} N at least")
    for cells in (16, 64, 128):
        places = np.interp((2.0, 3.0, 5.0, 7.0, 9.0), *front(cells))
        print(
            f"front of a dam at 2, 3, 5, 7 and 9 √(a/2g), {cells} cells in its width: {', '.join(f'{x:.3g}' for x in places)} a"
        )
