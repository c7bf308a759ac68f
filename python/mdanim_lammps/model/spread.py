# SPDX-License-Identifier: GPL-2.0-only
"""Points spread evenly over the true surface of every shape but the cuboid; body frame, whole arrays."""

from __future__ import annotations

from functools import singledispatch
from math import ceil, isqrt, pi, sqrt
from typing import NamedTuple

import numpy as np

from ..scene.scene import Cone, Cylinder, Ellipsoid, Mesh, Shape, Sphere, Torus
from . import mesh, shapes
from .nearest import Nearest
from .triangles import unit_normals

GOLDEN = (sqrt(5) - 1) / 2
TABLE = 256
"""Rows and columns of the tables of an ellipsoid, and sides of the outline of a torus."""
SAMPLES = 8
"""Samples of a mesh for each point."""
ROUNDS = 3
"""How often points of a mesh move to the middle of their samples; areas then differ by a quarter of their mean, more rounds
change little."""

HAIR = 1e-9
"""Part of a distance that rounding may change."""


class Spread(NamedTuple):
    """P points on a surface."""

    point: np.ndarray
    """[m], shape (P, 3)."""
    normal: np.ndarray
    """Outward, of length 1, shape (P, 3)."""
    area: np.ndarray
    """Part of the surface that a point stands for [m^2], shape (P,)."""


@singledispatch
def spread(shape: Shape, spacing: float) -> Spread:
    """Points about ``spacing`` [m] apart; their areas sum to the area of the shape, and are equal but for a mesh."""
    raise TypeError(f"no points on {shape!r}: register a function for its kind in model/spread.py")


# --- shapes of revolution: a golden spiral ----------------------------------------------------------------------------


def _count(shape: Shape, spacing: float) -> int:
    return ceil(shapes.area(shape) / spacing**2)


def _spiral(outline, n: int, turn: float = GOLDEN) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """n places of equal areas on what an outline (r, z), shape (K + 1, 2), makes when it turns about z.

    From one place to the next the angle grows by ``turn`` turns, the golden section: the lattice is even however the widths of
    rings change. Returns the sides of the outline (n,), how far along them (n,) from 0 to 1, and angles (n,) [rad].
    """
    outline = np.asarray(outline, float)
    r, length = outline[:, 0], np.linalg.norm(np.diff(outline, axis=0), axis=1)
    before = np.concatenate([[0.0], np.cumsum((r[:-1] + r[1:]) * length)])
    area = (np.arange(n) + 0.5) / n * before[-1]
    side = np.searchsorted(before, area, side="right") - 1
    # The area of a frustum from its start on is (2 r0 t + (r1 - r0) t^2) length.
    part = (area - before[side]) / length[side]
    t = part / (r[side] + np.sqrt(r[side] ** 2 + (r[side + 1] - r[side]) * part))
    return side, t, 2 * pi * (turn * np.arange(n) % 1)


def _turn(r: np.ndarray, z: np.ndarray, angle: np.ndarray) -> np.ndarray:
    return np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=1)


def _even(shape: Shape, point: np.ndarray, normal: np.ndarray) -> Spread:
    return Spread(point, normal, np.full(len(point), shapes.area(shape) / len(point)))


def _turned(shape: Shape, outline, spacing: float) -> Spread:
    """Points on the sides of an outline (r, z) [m] that turns about z; the body lies to its left."""
    outline = np.array(outline)
    side, t, angle = _spiral(outline, _count(shape, spacing))
    along = np.diff(outline, axis=0)
    out = along / np.linalg.norm(along, axis=1)[:, None]
    r, z = (outline[side] + t[:, None] * along[side]).T
    return _even(shape, _turn(r, z, angle), _turn(out[side, 1], -out[side, 0], angle))


@spread.register
def _(shape: Cylinder, spacing):
    r, h = shape.radius, shape.height
    return _turned(shape, [(0, -h / 2), (r, -h / 2), (r, h / 2), (0, h / 2)], spacing)


@spread.register
def _(shape: Cone, spacing):
    r, h = shape.radius, shape.height
    found = _turned(shape, [(0, -h / 4), (r, -h / 4), (0, 3 * h / 4)], spacing)
    found.normal[-1] = 0.0, 0.0, 1.0  # around the tip: those of a slim cone would face nothing that lies on it
    return found


@spread.register
def _(shape: Torus, spacing):
    turn = 2 * pi * np.arange(TABLE + 1) / TABLE
    outline = np.stack([shape.major + shape.minor * np.cos(turn), shape.minor * np.sin(turn)], axis=1)
    # Where the outline closes, the lattice does so too: with the number of points, a few more, that needs nearly whole turns.
    least = _count(shape, spacing)
    trial = GOLDEN * (least + np.arange(isqrt(least) + 1))
    n = least + int(abs(trial - trial.round()).argmin())
    side, t, angle = _spiral(outline, n, round(GOLDEN * n) / n)
    tube = 2 * pi * (side + t) / TABLE
    normal = _turn(np.cos(tube), np.sin(tube), angle)
    return _even(shape, shape.minor * normal + shape.major * _turn(np.ones(len(tube)), np.zeros(len(tube)), angle), normal)


# --- balls and ellipsoids: the same spiral through tables -------------------------------------------------------------


@spread.register
def _(shape: Sphere, spacing):
    return _ellipsoid(shape, np.full(3, shape.radius), spacing)


@spread.register
def _(shape: Ellipsoid, spacing):
    return _ellipsoid(shape, np.array(shape.radii), spacing)


def _ellipsoid(shape: Shape, radii: np.ndarray, spacing: float) -> Spread:
    """Turn about the axis that leaves the roundest equator; heights and angles by tables of the area up to them."""
    from scipy.ndimage import map_coordinates

    low, middle, high = np.argsort(radii, kind="stable")
    pole = high if radii[middle] * radii[middle] <= radii[low] * radii[high] else low
    order = [(pole + 1) % 3, (pole + 2) % 3, pole]
    a, b, c = radii[order]
    n = _count(shape, spacing)
    # On the unit ball dz dphi is the area; this is the factor from there to the ellipsoid.
    z = (np.arange(TABLE) + 0.5) / TABLE * 2 - 1
    phi = (np.arange(TABLE) + 0.5) / TABLE * 2 * pi
    rho = np.sqrt(1 - z**2)[:, None]
    factor = np.sqrt((rho * b * c * np.cos(phi)) ** 2 + (rho * a * c * np.sin(phi)) ** 2 + (a * b * z[:, None]) ** 2)
    share = np.arange(TABLE + 1) / TABLE
    height = np.interp((np.arange(n) + 0.5) / n, _up_to(factor.sum(axis=1)), 2 * share - 1)
    angle_of = np.stack([np.interp(share, _up_to(row), 2 * pi * share) for row in factor])
    row = (height + 1) / 2 * TABLE - 0.5
    angle = map_coordinates(angle_of, [row, GOLDEN * np.arange(n) % 1 * TABLE], order=1, mode="nearest")
    unit = _turn(np.sqrt(1 - height**2), height, angle)[:, np.argsort(order)]
    normal = unit / radii
    return _even(shape, unit * radii, normal / np.linalg.norm(normal, axis=1)[:, None])


def _up_to(part: np.ndarray) -> np.ndarray:
    """Share of the sum that lies before each part, and 1 at the end."""
    total = np.concatenate([[0.0], np.cumsum(part)])
    return total / total[-1]


# --- meshes: middles of samples ---------------------------------------------------------------------------------------


@spread.register
def _(shape: Mesh, spacing):
    """Each point is the sample nearest to the middle of those that are nearer to it than to others (Lloyd)."""
    body = mesh.load(shape)
    found = mesh.scatter(body, spacing / sqrt(SAMPLES))
    has_area = found[2] > 0
    sample, triangle, area = (rows[has_area] for rows in found)
    normal = unit_normals(body.points, body.triangles)[triangle]
    # With the normals as three more coordinates the two sides of a sheet and of an edge stay apart.
    place = np.concatenate([sample, spacing * normal], axis=1)
    before = np.cumsum(area)
    n = _count(shape, spacing)
    point = place[np.unique(np.searchsorted(before, (np.arange(n) + 0.5) / n * before[-1]).clip(max=len(place) - 1))]
    owner = Nearest(point)(place)[1]
    for last in range(ROUNDS - 1, -1, -1):
        owner = _without_gaps(owner, len(point))
        point, total = _means(place, area, owner)
        if last:
            owner = _nearest_again(point, place, owner)
    away = ((place - point[owner]) ** 2).sum(axis=1)
    out = point[:, 3:] / np.linalg.norm(point[:, 3:], axis=1)[:, None]
    return Spread(sample[_nearest_of(owner, away, len(point))], out, total)


def _without_gaps(owner: np.ndarray, count: int) -> np.ndarray:
    """Owners, numbers below ``count``, numbered anew without those that own nothing, in their order."""
    some = np.zeros(count, bool)
    some[owner] = True
    return (np.cumsum(some) - 1)[owner]


def _nearest_again(point: np.ndarray, place: np.ndarray, owner: np.ndarray) -> np.ndarray:
    """The point nearest to each place, shape (K,), where ``owner``, shape (K,), was so before points moved.

    What is nearer to its point than half way to any other point stays with it: half of all places.
    """
    nearest = Nearest(point)
    half = 0.5 * (1.0 - HAIR) * nearest(point, 2)[0][:, 1]
    away = np.sqrt(((place - point[owner]) ** 2).sum(axis=1))
    open_ = np.flatnonzero(away >= half[owner])
    found = owner.copy()
    found[open_] = nearest(place[open_])[1]
    return found


def _nearest_of(owner: np.ndarray, away: np.ndarray, count: int) -> np.ndarray:
    """The place of each owner that is least far away, the first of equal ones; shape (count,)."""
    order = np.argsort(owner, kind="stable")
    first = np.searchsorted(owner[order], np.arange(count))
    least = np.minimum.reduceat(away[order], first)
    hit = np.flatnonzero(away[order] == least[owner[order]])
    return order[hit[np.searchsorted(owner[order][hit], np.arange(count))]]


def _means(place: np.ndarray, area: np.ndarray, owner: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Means of the places of each owner, weighed by area, and sums of its areas."""
    total = np.bincount(owner, area)
    return np.stack([np.bincount(owner, area * column) for column in place.T], axis=1) / total[:, None], total
