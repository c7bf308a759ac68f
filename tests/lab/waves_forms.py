# SPDX-License-Identifier: GPL-2.0-only
"""Waves against closed forms: each function makes a basin, lets it go and returns what it found. Cell, g and density are 1."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from arms import inertia_of_arm
from scipy.optimize import brentq
from waves_lab import SOLID, UNIT, Waves

DT = 0.1


def period(signal, dt=DT) -> float:
    """Mean time between rises through the mean; nan where there are fewer than two."""
    s = np.asarray(signal) - np.mean(signal)
    at = np.flatnonzero((s[:-1] < 0) & (s[1:] >= 0))
    times = at + s[at] / (s[at] - s[at + 1])
    return dt * np.diff(times).mean() if len(times) > 1 else np.nan


class Swing(NamedTuple):
    """Period over that of the closed form, and the amplitude that is left."""

    period: float
    left: float


def standing(cells: int, depth: int, mode: int, periods=6, dt=DT, **settings) -> Swing:
    """A standing wave of crest 0.02 depth; the exact period is 2 pi/sqrt(k tanh(k depth)). Left after `periods`."""
    w = Waves((4 * depth, 1, cells), **settings)
    k = mode * np.pi / cells
    shape = np.cos(k * (np.arange(cells) + 0.5))
    crest = 0.02 * depth
    w.pour(depth + crest * shape)
    exact = 2 * np.pi / np.sqrt(k * np.tanh(k * depth))
    signal = []
    for _ in range(int((periods + 1.5) * exact / dt)):
        w.update(dt=dt)
        signal.append(2 * np.mean((w.surface[0] - depth) * shape))
    late = np.abs(signal[int(periods * exact / dt) : int((periods + 1) * exact / dt)])
    return Swing(period(signal, dt) / exact, late.max() / crest)


class Dry(NamedTuple):
    """A broken dam on dry ground: L1 error of the depth, speed of the front over 2 sqrt(D), depth at the dam over D.

    The front is where the depth is 1 % of D; Ritter's depth (2 sqrt(D) - x/t)^2/9 is that at 0.85 of 2 sqrt(D).
    """

    error: float
    front: float
    at_dam: float


def dam_on_dry_ground(depth: int, **settings) -> Dry:
    """Against Ritter's solution, at 3.5 sqrt(depth)."""
    cells = 24 * depth
    x = np.arange(cells) + 0.5 - cells // 2
    w = Waves((2 * depth + 2, 1, cells), **settings)
    w.pour(np.where(x < 0, depth, 0.0))
    time, fronts = 0.0, []
    while time < 3.5 * np.sqrt(depth):
        w.update()
        time += DT
        fronts.append((time, x[w.volume[0] > 0.01 * depth].max() + 0.5))
    half = np.array(fronts[len(fronts) // 2 :])
    exact = np.where(x > 2 * np.sqrt(depth) * time, 0.0, np.clip((2 * np.sqrt(depth) - x / time) ** 2 / 9, 0, depth))
    found = w.volume[0]
    speed = np.polyfit(*half.T, 1)[0]
    at_dam = (found[cells // 2 - 1] + found[cells // 2]) / 2 / depth
    return Dry(np.abs(found - exact).sum() / exact.sum(), speed / 2 / np.sqrt(depth), at_dam)


class Bore(NamedTuple):
    """A broken dam on shallow liquid: the bore's speed, the plateau's height and the highest point over Stoker's."""

    speed: float
    plateau: float
    highest: float


def dam_on_wet_ground(depth: int, share=0.1, **settings) -> Bore:
    """Against Stoker's solution for liquid of `share` of the depth in front of the dam, at 4 sqrt(depth)."""
    cells, shallow = 24 * depth, share * depth

    def bore(middle):
        return np.sqrt(middle * (middle + shallow) / (2 * shallow))

    middle = brentq(lambda m: bore(m) * (1 - shallow / m) + 2 * np.sqrt(m) - 2 * np.sqrt(depth), shallow * 1.001, depth)
    x = np.arange(cells) + 0.5 - cells // 2
    w = Waves((2 * depth, 1, cells), **settings)
    w.pour(np.where(x < 0, depth, shallow))
    time, fronts = 0.0, []
    while time < 4 * np.sqrt(depth):
        w.update()
        time += DT
        head = w.surface[0]
        fronts.append((time, x[head > (middle + shallow) / 2].max()))
    half = np.array(fronts[len(fronts) // 2 :])
    plateau = head[cells // 2 + int(0.4 * bore(middle) * time)]
    return Bore(np.polyfit(*half.T, 1)[0] / bore(middle), plateau / middle, head[cells // 2 :].max() / middle)


def dish(radius: int, depth: int, periods=4, **settings) -> Swing:
    """Thacker's planar slosh in a parabolic dish: the period is 2 pi radius/sqrt(2 depth)."""
    cells, tall = int(2.6 * radius), int(2.2 * depth) + 2
    x = np.arange(cells) + 0.5 - cells / 2
    bed = depth * (x[None, :] ** 2 + x[:, None] ** 2) / radius**2
    w = Waves((tall, cells, cells), **settings)
    w.solids(np.round(np.clip(bed[None] - np.arange(tall)[:, None, None], 0, 1) * SOLID))
    off = 0.3
    w.pour(depth + off * depth * 2 / radius * np.broadcast_to(x, (cells, cells)) - off**2 * depth)
    exact = 2 * np.pi * radius / np.sqrt(2 * depth)
    signal = []
    for _ in range(int(periods * exact / DT)):
        w.update()
        volume = w.volume
        signal.append((volume * x).sum() / volume.sum())
    return Swing(period(signal) / exact, np.abs(signal[-int(exact / DT) :]).max() / (off * radius))


def vessels(arm: int, wall: int, gap: int, depth: int, periods=3, **settings) -> Swing:
    """Two vessels joined through an opening at the floor; the inertia of the liquid there and, by potential flow, in both."""
    cells, tall = 2 * arm + wall, 2 * depth
    solid = np.zeros((tall, 1, cells))
    solid[gap:, :, arm : arm + wall] = SOLID
    w = Waves((tall, 1, cells), **settings)
    w.walls(solid)
    w.solids(solid)
    level = np.full(cells, float(depth))
    level[:arm] += 1.0
    level[arm + wall :] -= 1.0
    w.pour(level)
    inertia = wall / gap + 2 * inertia_of_arm(depth - gap, gap, arm)
    exact = 2 * np.pi * np.sqrt(inertia * arm / 2)
    signal = []
    for _ in range(int((periods + 1.5) * exact / DT)):
        w.update()
        head = w.surface[0]
        signal.append(head[:arm].mean() - head[-arm:].mean())
    late = np.abs(signal[int((periods - 0.2) * exact / DT) : int((periods + 0.2) * exact / DT)])
    return Swing(period(signal) / exact, late.max() / 2)


# --- bodies ---


def box(shape, low, high) -> np.ndarray:
    """Share of each cell (nz, ny, nx) that a box from `low` to `high`, both (x, y, z), fills."""
    along = [
        np.clip(np.minimum(np.arange(n) + 1, h) - np.maximum(np.arange(n), lo), 0, 1) for n, lo, h in zip(shape[::-1], low, high)
    ]
    return along[2][:, None, None] * along[1][None, :, None] * along[0][None, None, :]


def sphere(shape, centre, radius) -> np.ndarray:
    """The same of a sphere, to about a percent of a cell."""
    fine = 2
    axes = [(np.arange(n * fine) + 0.5) / fine for n in shape]
    z, y, x = np.meshgrid(*axes, indexing="ij", sparse=True)
    away = np.sqrt((x - centre[0]) ** 2 + (y - centre[1]) ** 2 + (z - centre[2]) ** 2)
    inside = np.clip((radius - away) * fine + 0.5, 0, 1)
    nz, ny, nx = shape
    return inside.reshape(nz, fine, ny, fine, nx, fine).mean((1, 3, 5))


def parts(share) -> np.ndarray:
    """Shares of cells in 1/4096."""
    return np.round(share * SOLID).astype(np.uint16)


class Body:
    """A rigid box (size: three edges) or sphere (size: the radius) that shifts and does not turn."""

    def __init__(self, size, at, density, velocity=(0, 0, 0), free=(1, 1, 1), drag=0.0):
        self.size, self.x, self.v = np.array(size, float), np.array(at, float), np.array(velocity, float)
        self.free, self.drag, self.density = np.array(free), drag, density
        self.volume = self.size.prod() if self.size.ndim else 4 / 3 * np.pi * size**3
        self.mass = density * self.volume

    def share(self, shape) -> np.ndarray:
        """Filled share of each cell."""
        if self.size.ndim:
            return box(shape, self.x - self.size / 2, self.x + self.size / 2)
        return sphere(shape, self.x, float(self.size))

    def solids(self, w: Waves) -> np.ndarray:
        """Put it into the liquid; its share of each cell."""
        share = self.share(w.shape)
        w.solids(parts(share), parts(share).sum(0) / SOLID * self.density)
        return share

    def move(self, w: Waves, updates: int, each=None) -> np.ndarray:
        """Go on, coupled to the liquid; where it is, (updates, 3)."""
        path = []
        least = self.size[2] / 2 if self.size.ndim else float(self.size)
        for n in range(updates):
            share = self.solids(w)
            w.update()
            force = w.forces(np.where(share > 0, 0, -1), 1)[0]
            change = (force - [0, 0, self.mass] - self.drag * self.volume * self.v) / self.mass * self.free
            self.v += DT * change
            self.x += DT * self.v
            if self.x[2] < least:
                self.x[2], self.v[:] = least, 0.0
            path.append(self.x.copy())
            if each:
                each(n)
        return np.array(path)


class Bobbing(NamedTuple):
    """Four times the time to the first passage of rest and the first period, over 2 pi sqrt(draft); turning points of 1."""

    fall: float
    period: float
    turns: np.ndarray


def swings(z, draft: float, dt=DT) -> Bobbing:
    """Swings of a box let go from above its rest; z over the first height, after each dt."""
    down = np.flatnonzero((z[:-1] > 0) & (z[1:] <= 0))
    times = dt * (down + 1 + z[down] / (z[down] - z[down + 1]))
    turns = [z[n] for n in range(1, len(z) - 1) if (z[n] - z[n - 1]) * (z[n + 1] - z[n]) < 0]
    alone = 2 * np.pi * np.sqrt(draft)
    return Bobbing(4 * times[0] / alone, np.diff(times)[0] / alone, np.array(turns[:4]))


def bobbing(density: float, size=(6, 6, 6), cells=48, depth=12, updates=300, flat=False, above=1.0, **settings) -> Bobbing:
    """A box let go above its draft; where `flat`, endless along y."""
    across = 1 if flat else cells
    w = Waves((32, across, cells), **settings)
    rest = depth + size[2] / 2 - size[2] * density
    body = Body((size[0], 1 if flat else size[1], size[2]), (cells / 2, across / 2, rest + above), density, free=(0, 0, 1))
    body.solids(w)
    w.pour(depth)
    return swings((body.move(w, updates)[:, 2] - rest) / above, size[2] * density)


def draft(density: float, at=(16, 16), side=6, updates=800, **settings) -> float:
    """Draft over side of a cube let go half a cell above its draft, with friction, in the end."""
    w = Waves((32, 32, 32), calm=0.05, **settings)
    body = Body((side,) * 3, (*at, 12 + side / 2 - side * density + 0.5), density, drag=0.3)
    body.solids(w)
    w.pour(12)
    body.move(w, updates)
    return (w.surface[0, 0] - (body.x[2] - side / 2)) / side


class Stone(NamedTuple):
    """The highest crest and the deepest trough of what a stone stirs up, and how far the sum of units is off."""

    crest: float
    trough: float
    lost: int


def stone(cells=80, radius=5, updates=250, **settings) -> Stone:
    """A stone of density 3 falls 12 cells into a pool 20 deep."""
    w = Waves((48, cells, cells), calm=0.005, **settings)
    w.pour(20)
    total = w.total
    body = Body(float(radius), (cells / 2 + 0.2, cells / 2 - 0.1, 37), 3.0, drag=0.45)
    high, low = [], []

    def each(_):
        surface = w.surface
        high.append(surface.max() - 20)
        low.append(surface.min() - 20)

    body.move(w, updates, each)
    return Stone(max(high), min(low), w.total - total)


def hull(updates=400) -> tuple[float, float]:
    """Lift of a dry hull whose bottom is 6 below the surface over that of Archimedes, and the liquid inside."""
    solid = np.zeros((30, 24, 24))
    solid[8:20, 6:18, 6:18] = 1
    solid[10:20, 8:16, 8:16] = 0
    w = Waves(solid.shape)
    w.solids(parts(solid))
    inside = np.zeros((24, 24), bool)
    inside[8:16, 8:16] = True
    w.pour(np.where(inside, 8.0, 14.0))
    w.update(updates)
    spans = w.spans
    within = inside.ravel()[spans.column] & (spans.floor == 10)
    lift = w.forces(np.where(solid > 0, 0, -1), 1)[0, 2]
    return lift / (12 * 12 * 6), spans.content[within].sum() / UNIT


def carried(updates=250) -> tuple[float, float]:
    """How far a bore of 6 over 8 cells carries a float to the right, and aside."""
    w = Waves((40, 16, 96))
    body = Body((5, 5, 5), (48, 8, 8), 0.5, drag=0.3)
    body.solids(w)
    w.pour(np.where(np.arange(96) < 24, 14.0, 8.0))
    path = body.move(w, updates)
    return path[200, 0] - 48, np.abs(path[:, 1] - 8).max()
