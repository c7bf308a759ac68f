# SPDX-License-Identifier: GPL-2.0-only
"""Rigid bodies on a floor, described once for all programs: nine dominoes with the ball that pushes them, a heap of boxes."""

from dataclasses import dataclass

import numpy as np

FRICTION = 0.5


@dataclass(frozen=True)
class Body:
    """A box with its edges, or a ball with its radius alone, in `size` [m]."""

    name: str
    size: tuple[float, ...]
    position: np.ndarray
    """Place of its centre [m], shape (3,)."""
    density: float
    """[kg/m^3]"""
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    angle: float = 0.0
    """Rotation about `axis` [rad]."""
    speed: float = 0.0
    """Along x, at the start [m/s]."""

    @property
    def volume(self) -> float:
        return float(np.prod(self.size)) if len(self.size) == 3 else 4.0 / 3.0 * np.pi * self.size[0] ** 3


def dominoes(case: dict) -> tuple[list[Body], float | None]:
    """Bodies, and the distance of four walls from the middle [m], here none."""
    stones = [Body(f"d{i}", (0.06, 0.2, 0.4), np.array((0.2 * i, 0.0, 0.2)), 600.0) for i in range(9)]
    return [*stones, Body("ball", (0.08,), np.array((-0.35, 0.0, 0.36)), 800.0, speed=3.0)], None


def heap(case: dict) -> tuple[list[Body], float]:
    """The same for boxes of 10 cm, turned at random, that fall in layers between four walls."""
    number, rng = case["bodies"], np.random.default_rng(1)
    side = max(2, round((number / 2.5) ** (1.0 / 3.0)))
    bodies = []
    for n in range(number):
        place = np.array((n % side, n // side % side, n // side // side), float)
        aside = np.append(0.02 * rng.random(2), 0.0)
        position = np.array((0.2, 0.2, 0.18)) * (place - ((side - 1) / 2, (side - 1) / 2, 0)) + aside + (0.0, 0.0, 0.12)
        axis = tuple((rng.random(3) - 0.5).tolist())
        bodies.append(Body(f"b{n}", (0.1, 0.1, 0.1), position, 600.0, axis, 3.0 * rng.random()))
    return bodies, 0.1 * side + 0.1


SCENES = {"dominoes": dominoes, "heap": heap}


def rotations(axis: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Rotations about axes, shape (N, 3), by angles [rad], shape (N,), as matrices of shape (N, 3, 3)."""
    x, y, z = (axis / np.linalg.norm(axis, axis=1)[:, None]).T
    zero = np.zeros_like(x)
    cross = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=1).reshape(-1, 3, 3)
    s, c = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
    return np.eye(3) + s * cross + (1.0 - c) * cross @ cross


def deepest(bodies: list[Body], wall: float | None, position: np.ndarray, rotation: np.ndarray) -> float:
    """Largest overlap of any two of these bodies, or of one with floor or walls, over their smallest size [-].

    Of two boxes the least overlap along the 15 axes of the separating axis theorem. Positions [m] have the shape (N, 3),
    rotations (N, 3, 3).
    """
    half = np.array([b.size if len(b.size) == 3 else b.size * 3 for b in bodies]) * np.where(
        [[len(b.size) == 3] for b in bodies], 0.5, 1.0
    )
    ball = np.array([len(b.size) == 1 for b in bodies])
    thin = 2.0 * half.min(axis=1)
    reach = lambda n, of: np.where(
        ball[of], half[of, 0], (np.abs(np.einsum("nij,ni->nj", rotation[of], n)) * half[of]).sum(axis=1)
    )
    everyone = np.arange(len(bodies))
    planes = [((0.0, 0.0, 1.0), 0.0)] + (
        [] if wall is None else [((s * x, s * y, 0.0), -wall) for x, y in ((1, 0), (0, 1)) for s in (1, -1)]
    )
    worst = 0.0
    for normal, at in planes:
        n = np.broadcast_to(normal, position.shape)
        worst = max(worst, float(((at - position @ normal + reach(n, everyone)) / thin).max()))
    radius = np.where(ball, half[:, 0], np.linalg.norm(half, axis=1))
    i, j = np.triu_indices(len(bodies), 1)
    near = np.linalg.norm(position[i] - position[j], axis=1) < radius[i] + radius[j]
    i, j = i[near], j[near]
    if not len(i):
        return worst
    apart = position[j] - position[i]
    to_corner = lambda b, of: _nearest_in_box(position[of], position[b], rotation[b], half[b]) - position[of]
    axes = [rotation[i][:, :, k] for k in range(3)] + [rotation[j][:, :, k] for k in range(3)]
    axes += [np.cross(rotation[i][:, :, a], rotation[j][:, :, b]) for a in range(3) for b in range(3)]
    axes += [apart, to_corner(i, j), to_corner(j, i)]
    least, round_one = np.full(len(i), np.inf), ball[i] | ball[j]
    for k, axis in enumerate(axes):
        length = np.linalg.norm(axis, axis=1)
        n = axis / np.where(length > 1e-9, length, 1.0)[:, None]
        overlap = reach(n, i) + reach(n, j) - np.abs(np.einsum("ni,ni->n", apart, n))
        # A ball's normal is along the line to the nearest point of the other; axes of edges and faces bound it all the same.
        counts = (length > 1e-9) & ((k < 15) | round_one)
        least = np.where(counts, np.minimum(least, overlap), least)
    return max(worst, float((least / np.minimum(thin[i], thin[j])).max()))


def _nearest_in_box(point: np.ndarray, centre: np.ndarray, rotation: np.ndarray, half: np.ndarray) -> np.ndarray:
    """Points of boxes that are nearest to these points, all of shape (N, 3)."""
    own = np.einsum("nij,ni->nj", rotation, point - centre)
    return centre + np.einsum("nij,nj->ni", rotation, np.clip(own, -half, half))
