# SPDX-License-Identifier: GPL-2.0-only
"""The region that every solid can reach until the end of a scene, and whether any two come within reach of each other.

From the scene alone, and never too small: a false "can meet" costs time, a false "cannot" lets objects pass through each
other. The bounds are derived in docs/cost.md.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ..bodies import all_held, kind_of
from ..model import shapes
from ..model.boxes import box_pairs
from ..model.springs import equivalent_modulus
from ..records import dataclass
from ..scene.scene import Box, HoldFaces, SceneRecord, Solid
from .acting import Acting

STRETCH = 1.5
"""Largest growth of a body, over its size and over (largest speed inside it) / (wave speed): all of that energy in one uniform
strain gives sqrt(1.2) along a line; 1.5 for bodies that are not uniform."""
SLACK = 1.1
"""Size of a body over that of its shape."""
REACH = 2.5
"""Distance of a surface beyond the shape, over the spacing: half the reach of a barrier (0.8 of a cell), corners of cells that
stand out (0.87 of a cell), cells up to 1.2 spacings long, and a fifth more."""
SAG = 2.0
"""Margin on the deflection of a clamped bar."""


@dataclass(frozen=True, slots=True)
class Sweeps:
    """A box for each of M solids that holds it, and half the reach of contact around it, at all times."""

    low: np.ndarray
    """[m], shape (M, 3)."""
    high: np.ndarray
    """[m], shape (M, 3)."""
    fixed: np.ndarray
    """Solids that are held entirely, bool, shape (M,): two of them never are in contact."""
    passing: frozenset[tuple[int, int]] = frozenset()
    """Pairs i < j that never are in contact, whatever moves."""
    bare: np.ndarray | None = None
    """Solids that are lines or sheets of particles, bool, shape (M,): two of them never are in contact. None for none."""
    body: np.ndarray | None = None
    """Number of the first solid of the rigid body that each solid is a part of, shape (M,): parts of one never are in contact.
    None where each is its own."""

    @property
    def any_pair(self) -> bool:
        """Whether there are two solids that may be in contact wherever they are."""
        i, j = np.array(sorted(self.passing), int).reshape(-1, 2).T
        apart = int(self.may_touch(i, j, of_passing=True).sum())
        in_bodies = 0 if self.body is None else self._pairs_within(self.body)
        return self._pairs_within(np.zeros(len(self.fixed), int)) - in_bodies > apart

    def may_touch(self, i: np.ndarray, j: np.ndarray, *, of_passing: bool = False) -> np.ndarray:
        """Pairs of solids that contact may act between wherever they are, bool, of the shape of ``i`` and ``j``;
        ``of_passing``: but for `passing`."""
        found = ~(self.fixed[i] & self.fixed[j]) & ~(self._bare[i] & self._bare[j])
        if self.body is not None:
            found &= self.body[i] != self.body[j]
        if self.passing and not of_passing:
            pairs = zip(np.minimum(i, j).tolist(), np.maximum(i, j).tolist())
            found &= np.array([pair not in self.passing for pair in pairs], bool)
        return found

    def _pairs_within(self, group: np.ndarray) -> int:
        """Pairs of solids of one group, by the numbers of groups, shape (M,), of which neither both are fixed nor both bare."""

        def pairs(these: np.ndarray) -> int:
            count = np.bincount(group[these])
            return int((count * (count - 1) // 2).sum())

        everyone, fixed, bare = np.ones(len(group), bool), self.fixed, self._bare
        return pairs(everyone) - pairs(fixed) - pairs(bare) + pairs(fixed & bare)

    @property
    def _bare(self) -> np.ndarray:
        return np.zeros(len(self.fixed), bool) if self.bare is None else self.bare


def closest(scene: SceneRecord, swept: Sweeps) -> tuple[Solid, Solid, float]:
    """Two solids of which one can move, and the least distance that remains between their boxes, along one axis [m].

    The first two found whose boxes overlap, with 0.0; where there are none, those whose boxes come nearest. Raises ValueError
    where no solid can meet another: one solid, all held, all joined, or all ropes.
    """
    if not swept.any_pair:
        raise ValueError("two solids are needed, of which one can move")
    if (pairs := next(_overlaps(swept), None)) is not None:
        i, j = pairs[0]
        return scene.solids[i], scene.solids[j], 0.0
    grown = 0.1 * float((swept.high - swept.low).mean())
    while not (pairs := list(_overlaps(replace(swept, low=swept.low - grown)))):
        grown *= 2.0
    i, j = np.concatenate(pairs).T
    apart = np.maximum(swept.low[i] - swept.high[j], swept.low[j] - swept.high[i]).max(axis=1)
    k = int(np.argmin(apart))
    return scene.solids[i[k]], scene.solids[j[k]], float(apart[k])


# --- boxes --------------------------------------------------------------------------------------------------


def sweeps(acting: Acting, h: np.ndarray, body: np.ndarray | None = None) -> Sweeps:
    """The region that every solid can reach, for the actions on them and their particle spacings h [m], shape
    (M,). ``body`` as `Sweeps` has it.

    Along an axis on which nothing but gravity and drag of air acts, the centre of mass moves on its parabola. Along one on which
    a wall, the ground or a liquid may act, it gets no farther than at the largest speed that energy allows; so does what is
    joined or pushed everywhere. A plane acts along its own axis, one with friction along all of them.
    Raises SceneError for a mesh that is not a body.
    """
    scene, (limit_low, limit_high), (near_low, near_high) = acting.scene, acting.limits, acting.touched
    if not scene.solids:
        return Sweeps(np.empty((0, 3)), np.empty((0, 3)), np.empty(0, bool))
    bodies = _Movers(acting, h)
    low, high = _flight(acting, bodies)
    calm = bodies.size(bodies.tip)  # the largest size by its own spin
    wild = bodies.size(bodies.speed)
    wet_below = acting.wet_below

    def touched(radius):
        reached = (low - radius[:, None] <= near_low) | (high + radius[:, None] >= near_high)
        wet = (low - radius[:, None])[:, 2] <= wet_below
        return reached | wet[:, None], wet

    hit = touched(calm)[0].any(axis=1) | acting.acted_on
    radius = np.where(hit, wild, calm)
    by_axis, _ = touched(radius)
    by_axis[~hit] = False
    by_axis |= acting.acted_on[:, None]
    by_axis |= (acting.rough & by_axis.any(axis=1))[:, None]  # friction acts along the other axes
    far = bodies.speed * scene.control.time
    # A body that has bounced may fall into a liquid that its parabola misses.
    bounced = hit & (bodies.position[:, 2] - far - radius <= wet_below)
    by_axis |= bounced[:, None]
    low = np.where(by_axis, np.maximum(bodies.position - far[:, None], limit_low - radius[:, None]), low)
    high = np.where(by_axis, np.minimum(bodies.position + far[:, None], limit_high + radius[:, None]), high)
    room_low, room_high = acting.room
    low, high = np.maximum(low, room_low), np.minimum(high, room_high)
    low, high = np.minimum(low, bodies.position), np.maximum(high, bodies.position)

    half = np.repeat(radius[:, None], 3, axis=1)
    held, reach = bodies.clamped | bodies.fixed, REACH * bodies.h[:, None]
    low[held] = high[held] = bodies.middle[held]
    half[bodies.fixed] = bodies.half[bodies.fixed] + reach[bodies.fixed]
    half[bodies.clamped] = _clamped(scene, bodies)[bodies.clamped] + reach[bodies.clamped]
    for m, drive in acting.drives.items():
        low[m], high[m] = low[m] + drive.low, high[m] + drive.high
    bare = np.array([not kind_of(solid).fills for solid in scene.solids], bool)
    return Sweeps(low - half, high + half, bodies.fixed, acting.passing, bare, body)


class _Movers:
    """Data of every solid that the bounds need."""

    def __init__(self, acting: Acting, h: np.ndarray):
        scene = acting.scene
        solids = scene.solids
        self.h = h
        self.position = np.array([s.position for s in solids], float)
        self.velocity = np.array([s.velocity for s in solids], float)
        self.slowed = acting.slowed
        self.radius = np.array([shapes.radius(s.shape) for s in solids])
        self.fixed = np.array([all_held(s) for s in solids])
        self.clamped = np.array([bool(s.hold) for s in solids]) & ~self.fixed & acting.bound
        extents = [shapes.extent(s.shape) for s in solids]
        rotation = np.array([s.rotation for s in solids], float)
        centre, half = (np.array([0.5 * (b + sign * a) for a, b in extents]) for sign in (1.0, -1.0))
        self.middle = self.position + np.einsum("mij,mj->mi", rotation, centre)
        self.half = np.einsum("mij,mj->mi", np.abs(rotation), half)
        self.density = np.array([s.density if s.density is not None else s.mass / shapes.volume(s.shape) for s in solids])
        self.mass = self.density * np.array([shapes.volume(s.shape) for s in solids])
        young = np.array([equivalent_modulus(np.full(3, own), s.elasticity) for s, own in zip(solids, self.h)])
        self.wave = np.sqrt(1.2 * young / self.density)
        self.tip = np.linalg.norm([s.spin for s in solids], axis=1) * self.radius
        """Speed of the outermost point around the centre of mass [m/s]."""
        bound = acting.bound | ~np.array([kind_of(s).deforms for s in solids], bool)
        self.loose = np.where(bound, 0.0, self.tip * scene.control.time)
        self.pull = acting.most_pull(self)
        self.speed = _speed(acting, self) + acting.thrown_at
        self.speed = _shared(acting, self.mass, self.speed) + acting.given if acting.leashes or acting.stirred else self.speed
        if acting.joined.any():  # nothing is known of what pulls: what is faster than waves is refused
            waves = np.where(np.isfinite(self.wave), self.wave, 0.0)
            self.speed = np.where(acting.joined, np.maximum(self.speed, waves), self.speed)
        self.driven_at = acting.driven_at
        self.thrown = acting.thrown_by

    def size(self, speed: np.ndarray) -> np.ndarray:
        """Radius of a body when this speed [m/s] is converted into deformation [m], shape (M,)."""
        return self.radius * (SLACK + STRETCH * speed / self.wave) + REACH * self.h + self.loose


def _shared(acting: Acting, mass: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """Largest speed of each solid [m/s], shape (M,), where all energy of those that it hangs together with may come to it."""
    pairs = np.array([pair for e in acting.effects for pair in e.joins(acting.scene)], int).reshape(-1, 2)
    if not len(pairs):
        return speed
    from scipy.sparse import coo_array  # takes 0.2 s
    from scipy.sparse.csgraph import connected_components

    joined = coo_array((np.ones(len(pairs), bool), tuple(pairs.T)), shape=(len(mass), len(mass)))
    part = connected_components(joined, directed=False)[1]
    energy = np.bincount(part, mass * speed**2)[part]
    return np.where(np.bincount(part)[part] > 1, np.sqrt(energy / mass), speed)


def _speed(acting: Acting, bodies: _Movers) -> np.ndarray:
    """Largest speed that energy allows [m/s], shape (M,): v^2 = v0^2 + (spin) + 2 * pull * way.

    The way is the height above the highest floor where gravity alone pulls, down; else it is v * time at most.
    """
    start = (bodies.velocity**2).sum(axis=1) + bodies.tip**2
    gained = bodies.pull * acting.scene.control.time
    most = gained + np.sqrt(gained**2 + start)
    g, floor = acting.acceleration, acting.limits[0][2]
    if acting.changes or np.isfinite(acting.wet_below) or g[0] or g[1] or g[2] > 0.0 or not np.isfinite(floor):
        return most
    lift = np.zeros(len(bodies.position))
    for m, drive in acting.drives.items():
        lift[m] = drive.high[2]
    way = np.maximum(0.0, bodies.position[:, 2] + lift - floor) + bodies.radius
    return np.minimum(most, np.sqrt(start + 2.0 * bodies.pull * way))


def _flight(acting: Acting, bodies: _Movers) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest point of every centre of mass in free flight along each axis [m], each of shape (M, 3)."""
    v, g, time = bodies.velocity, acting.acceleration, acting.scene.control.time
    if acting.changes:  # at most straight on, and pulled one way or the other all the time
        least, most = acting.accelerations
        low = np.minimum(v, 0.0) * time + 0.5 * np.minimum(least, 0.0) * time**2
        high = np.maximum(v, 0.0) * time + 0.5 * np.maximum(most, 0.0) * time**2
        return bodies.position + low, bodies.position + high
    end = v * time + 0.5 * g * time**2
    with np.errstate(divide="ignore", invalid="ignore"):
        turns = -v / g  # when the velocity along this axis is 0
        apex = np.where((turns > 0.0) & (turns < time), -0.5 * v**2 / g, 0.0)
    apex = np.nan_to_num(apex)
    low, high = np.minimum(np.minimum(end, apex), 0.0), np.maximum(np.maximum(end, apex), 0.0)
    # Drag of air reduces both parts of the displacement, so each part is at most that without drag.
    coasts, falls = np.where(apex != 0.0, apex, v * time), np.broadcast_to(0.5 * g * time**2, v.shape)
    slowed = bodies.slowed[:, None]
    low = np.where(slowed, np.minimum(coasts, 0.0) + np.minimum(falls, 0.0), low)
    high = np.where(slowed, np.maximum(coasts, 0.0) + np.maximum(falls, 0.0), high)
    return bodies.position + low, bodies.position + high


def _clamped(scene: SceneRecord, bodies: _Movers) -> np.ndarray:
    """Half edges of the box that a partly held solid stays in [m], shape (M, 3).

    A solid that is held in one place may swing around that place like a pendulum. A cuboid held at whole faces bends by twice
    the deflection of a cantilever, 1.5 rho g L^4 / (E t^2), and by its own velocity, 1.7 v L^2 / (c t).
    """
    pull = bodies.pull + bodies.thrown
    speed = np.sqrt((bodies.velocity**2).sum(axis=1) + bodies.tip**2 + 4.0 * pull * bodies.radius) + bodies.driven_at
    pendulum = 3.0 * bodies.radius * (SLACK + STRETCH * speed / bodies.wave)
    half = np.repeat(pendulum[:, None], 3, axis=1)
    for k in np.flatnonzero(bodies.clamped):
        solid = scene.solids[k]
        if not (isinstance(solid.shape, Box) and any(isinstance(h, HoldFaces) for h in solid.hold)):
            continue
        length, thin, c = 2.0 * bodies.radius[k], min(solid.shape.size), bodies.wave[k]
        moving = np.linalg.norm(solid.velocity) + bodies.tip[k] + bodies.driven_at[k]
        sag = 2.0 * 1.8 * pull[k] * length**4 / (c * thin) ** 2 + 1.7 * moving * length**2 / (c * thin)
        half[k] = np.minimum(half[k], SLACK * bodies.half[k] + SAG * sag)
    return half


# --- pairs --------------------------------------------------------------------------------------------------


def _overlaps(swept: Sweeps) -> Iterator[np.ndarray]:
    """Pairs of solids whose boxes overlap and of which one can move, in blocks of shape (P, 2)."""
    for i, j in box_pairs(swept.low, swept.high):
        may = swept.may_touch(i, j)
        pairs = np.sort(np.column_stack([i[may], j[may]]), axis=1)
        if len(pairs):
            yield pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]
