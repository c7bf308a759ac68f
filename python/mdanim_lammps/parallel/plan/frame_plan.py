# SPDX-License-Identifier: GPL-2.0-only
"""The plan of a frame: which executors run which objects, in which bundle. The supervisor (central control) and every executor
(decentralised) call the same `plan` and must get the same fingerprint.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence

import numpy as np

from ...engine.sub_plan import SubPlans
from ...reach.window import window
from ...records import dataclass
from . import islands
from .assign import assign, firsts, total
from .teams import GAIN, GAIN_BY_THREADS, LEAST, LEAST_BY_THREADS, Team

MARGIN = 0.05
"""Part of a spacing, on top of the reach of every object."""
BALANCED = 1.25
"""Largest load over the mean up to which a window is not made shorter."""
ASIDE = 1000.0
"""The pool's box beyond the basin's sides and floor, over its size: the liquid looks at heights alone."""
BUNDLE_PARTICLES = 64000
"""Particles up to which islands of one executor share a LAMMPS instance. `bench/driver.py`, 1000 objects of 120 particles on 2
executors: of a frame the driver takes 13 ms with 32000, 9 with this and with 128000, and LAMMPS the same; but what begins again
with other company takes all of its bundle with it."""
BUNDLES_OVER_ENOUGH = 2
"""Bundles of an executor, over those that would do, from which the thin ones are put together."""
THIN_BELOW = 4
"""Bundles below `BUNDLE_PARTICLES` over this are thin. `python bench/planning.py crowd`, 1000 objects and bundles of 4000: with
4, 9 % of the particles are in new bundles in every frame; with 2, 16 %; 7 % where none are ever put together,
with 1.6 times the bundles."""


@dataclass(frozen=True, slots=True)
class PlannerOptions:
    """Options of the planner for tests and measurements; no setting changes a bit of the result."""

    safety: float = 1.3
    """Reach of objects over a window, over the way of their fastest particles at its start, see `reach.window`."""
    finest: int = 8
    """Most windows to a frame, a power of two."""
    worth: int = 10_000
    """Microseconds of work that each executor must have in a window: below,
    the exchange between windows costs more than it brings."""
    least: int | None = None
    """Particles for each member of a team; None for what is known to pay, see `teams`."""
    by_threads: bool | None = None
    """Whether a team is its leader with threads for all. None: where all executors are on one host."""


@dataclass(frozen=True, slots=True)
class FrameAssignment:
    """Which executors run what in a frame of M objects."""

    owner: np.ndarray
    """Executor of every object, int64, shape (M,); unchanged for objects that never move."""
    label: np.ndarray
    """Island of every object, -1 for what is still, int64, shape (M,)."""
    bundle: np.ndarray
    """Bundle of every object, -1 for what is still, int64, shape (M,). One that keeps its number has the same executors and no
    object that it had not before; a new one has a number above all of the plan before."""
    guests: np.ndarray
    """(island, still object) of all copies needed, sorted, int64, shape (G, 2)."""
    teams: tuple[Team, ...]
    """By island; each island of a team is a bundle of its own."""
    load: np.ndarray
    """Time that each of K executors will need [µs], int64, shape (K,)."""

    def fingerprint(self) -> str:
        """The same for the same plan, and for no other: 32 hexadecimal digits."""
        digest = hashlib.blake2b(digest_size=16)
        teams = [np.array([team.island, *team.members]) for team in self.teams]
        for array in (self.owner, self.label, self.bundle, self.guests, self.load, *teams):
            digest.update(np.array(array.shape, "<i8").tobytes() + array.astype("<i8").tobytes())
        return digest.hexdigest()


def plan(
    low: np.ndarray,
    high: np.ndarray,
    d: np.ndarray,
    cost: np.ndarray,
    owner: np.ndarray,
    executors: int,
    *,
    particles: np.ndarray,
    still: np.ndarray,
    gap: float,
    feels: np.ndarray | None = None,
    joined: np.ndarray | None = None,
    previous: FrameAssignment | None = None,
    gain: int = GAIN,
    least: int = LEAST,
    room: int = BUNDLE_PARTICLES,
) -> FrameAssignment:
    """The plan of a frame, from what all executors have reported. O(M log M + pairs that are near). Raises ValueError for boxes
    that are not finite or turned inside out, a cost below 0, an owner out of range.

    A pool is one more object: its box, never still. After a guard was violated the same call with larger ``d`` gives
    the plan to try again with.

    :param low: boxes of the particles, eq. (3.14) [m], (M, 3), with ``high``
    :param d: what they are widened by, eq. (6.17) [m], shape (M,)
    :param cost: time of every object in a frame [µs], int64, shape (M,)
    :param owner: executor that has its state, -1 for none yet, int64, shape (M,)
    :param particles: of every object, int64, shape (M,)
    :param still: objects held as a whole, bool, shape (M,)
    :param gap: reach of contact [m]
    :param feels: objects that all others feel, bool, shape (M,): without contact, the pool alone; None for all
    :param joined: objects that belong together wherever they are, as pairs, int64, shape (J, 2)
    :param previous: the last plan for which bundles were built
    """
    met = islands.pairs(*islands.boxes(low, high, d), gap)
    if feels is not None:
        met = met[feels[met].any(axis=1)]
    if joined is not None and len(joined):
        met = np.concatenate([met, joined])
    label = islands.components(len(low), met, still)
    order = z_order(low, high)
    given = assign(
        label,
        cost,
        owner,
        executors,
        particles=particles,
        order=order,
        gain=gain,
        least=least,
        teams=previous.teams if previous else (),
    )
    bundle = bundles(label, given.owner, particles, given.teams, order=order, previous=previous, room=room)
    return FrameAssignment(given.owner, label, bundle, islands.guests(met, label, still), given.teams, given.load)


def grid_box(parts: SubPlans) -> tuple[np.ndarray, np.ndarray]:
    """The box within which an object and the liquid can matter to each other [m]."""
    grid = parts.whole.grid
    assert grid is not None, "only asked for where there is a liquid"
    margin = ASIDE * np.max(np.subtract(grid.high, grid.low))
    low, high = np.array(grid.low) - margin, np.array(grid.high) + margin
    high[2] = parts.grid_top
    return low, high


class PlanContext:
    """Data shared by all plans of a scene: its M objects, the pool as one more, and how far they matter to each other."""

    def __init__(self, parts: SubPlans, executors: int, settings: PlannerOptions):
        whole, system = parts.whole, parts.whole.system
        self.whole, self.executors, self.settings = whole, executors, settings
        self.objects = len(system.names)
        """The pool not counted."""
        self.grid = grid_box(parts) if whole.grid is not None else None
        self.count = self.objects + (self.grid is not None)
        self.particles = np.append(np.diff(system.first), [0] * (self.count - self.objects)).astype(np.int64)
        self.still = np.append(system.still, np.zeros(self.count - self.objects, bool))
        self.gap = float(parts.gap.max(initial=0.0))
        self.joined = np.array([pair for e in whole.effects for pair in e.joins(whole.scene)], np.int64).reshape(-1, 2)
        self.feels = None if self.gap else np.arange(self.count) == self.objects
        least, self.gain = (LEAST_BY_THREADS, GAIN_BY_THREADS) if settings.by_threads else (LEAST, GAIN)
        self.least = least if settings.least is None else settings.least

    def guess(self, step: float) -> np.ndarray:
        """Costs before anything is measured [µs], int64, shape (M,), where a particle-step takes ``step`` [µs]."""
        return np.maximum(1, (step * self.whole.certificate.steps_per_frame * self.particles).astype(np.int64))

    def reach(self, speed: np.ndarray, steps: int, doublings: np.ndarray | int = 0) -> np.ndarray:
        """The margin by which boxes are widened in a window of ``steps`` steps, eq. (6.17) [m], shape (M,), the pool's last."""
        d = window(
            speed,
            steps * self.whole.certificate.timestep,
            self.whole.context.reach.acting.strongest_of_any,
            MARGIN * self.whole.spacing,
            self.settings.safety,
        )
        d = d * 2.0**doublings
        d[self.still] = 0.0
        if self.grid is not None:
            d[-1] = 0.0
        return d

    def plan(
        self, low: np.ndarray, high: np.ndarray, d: np.ndarray, cost: np.ndarray, previous: FrameAssignment | None = None
    ) -> FrameAssignment:
        """`plan` for these objects, by the owners of the plan before."""
        owner = previous.owner if previous else np.full(self.count, -1, np.int64)
        return plan(
            low,
            high,
            d,
            cost,
            owner,
            self.executors,
            particles=self.particles,
            still=self.still,
            gap=self.gap,
            feels=self.feels,
            joined=self.joined,
            previous=previous,
            gain=self.gain,
            least=self.least,
        )

    def longest_window(
        self, length: int, left: int, make: Callable[[int], tuple[FrameAssignment, np.ndarray]]
    ) -> tuple[int, FrameAssignment, np.ndarray]:
        """The longest window that leaves the loads in balance: in a shorter one boxes are widened by less, and fewer islands
        merge.

        Windows end at a frame at the latest, ``left`` of its ``length`` steps. Where none is in balance, the one with the
        smallest largest load. ``make`` gives the plan for a number of steps, and the margin of boxes; returned with the steps.
        """
        best, least = None, 0
        for halvings in range(self.settings.finest.bit_length()):
            steps = min(left, -(-length >> halvings))
            found, d = make(steps)
            load, mean = int(found.load.max(initial=0)), int(found.load.sum()) // self.executors
            if best is None or load < least:
                best, least = (steps, found, d), load
            shorter = mean * (steps // 2) // length
            if (
                self.executors == 1
                or steps == 1
                or (load <= BALANCED * mean and not found.teams)
                or shorter < self.settings.worth
            ):
                break
        assert best is not None, "the finest window is 1 at least"
        return best


def z_order(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """A number for every box, int64, shape (M,), along Morton's curve through their middles: near numbers are near in space."""
    middle = np.ascontiguousarray((0.5 * (low + high)).T)
    middle -= middle.min(axis=1)[:, None]
    across = float(middle.max()) or 1.0
    x = np.minimum(middle / across * 2.0**20, 2.0**20 - 1.0).astype(np.int64)
    for shift, mask in (
        (32, 0x1F00000000FFFF),
        (16, 0x1F0000FF0000FF),
        (8, 0x100F00F00F00F00F),
        (4, 0x10C30C30C30C30C3),
        (2, 0x1249249249249249),
    ):
        x = (x | x << shift) & mask
    return x[0] | x[1] << 1 | x[2] << 2


def bundles(
    label: np.ndarray,
    owner: np.ndarray,
    particles: np.ndarray,
    teams: Sequence[Team] = (),
    *,
    order: np.ndarray | None = None,
    previous: FrameAssignment | None = None,
    room: int = BUNDLE_PARTICLES,
) -> np.ndarray:
    """LAMMPS instances that executors run their islands in, int64, shape (M,), -1 for what is still; O(M log M).

    An island stays in its bundle if all of it was there and its executor is the same: objects that join or leave make no other
    object move. The other islands are put together along ``order``, up to ``room`` particles; those larger than half of that,
    and those of a team, are a bundle each. Bundles only ever lose objects. So when an executor has more than
    `BUNDLES_OVER_ENOUGH` times as many as would do, and 2, its thin ones are put together as well.
    """
    moving = np.flatnonzero(label >= 0)
    bundle = np.full(len(label), -1, np.int64)
    if not len(moving):
        return bundle
    isle = label[moving]
    first = moving[firsts(isle)]
    size, runs = total(isle, particles[moving]), owner[first]
    team = np.zeros(len(size), bool)
    team[[t.island for t in teams]] = True
    kept = np.full(len(size), -1, np.int64)
    after = 0
    if previous is not None:
        kept = _kept(isle, moving, first, runs, previous)
        after = int(previous.bundle.max(initial=-1)) + 1
        _leave_teams(kept, first, teams, team, previous)
        _thin_out(kept, size, runs, room)
    out = np.flatnonzero(kept < 0)
    rank = out[np.lexsort(((first if order is None else order[first])[out], (team | (2 * size > room))[out], runs[out]))]
    if len(rank):
        kept[rank] = after + _packed(size[rank], runs[rank], (team | (2 * size > room))[rank], room)
    bundle[moving] = kept[isle]
    return bundle


def _kept(isle, moving, first, runs, previous) -> np.ndarray:
    """The bundle that all of an island was in, with the executor that it has now; else -1."""
    was = previous.bundle[first]
    same = (previous.bundle[moving] == was[isle]) & (previous.owner[moving] == runs[isle])
    whole = np.ones(len(first), bool)
    whole[isle[~same]] = False
    return np.where(whole, was, -1)


def _leave_teams(kept, first, teams, team, previous) -> None:
    """An island of a team keeps its bundle only if it is alone there and the team is the same; what was a team's leaves it."""
    if not teams and not previous.teams:
        return
    before = {int(previous.bundle[np.flatnonzero(previous.label == t.island)[0]]): t.members for t in previous.teams}
    now = {t.island: t.members for t in teams}
    company = np.bincount(kept[kept >= 0])
    for i in np.flatnonzero(team | np.isin(kept, list(before))):
        if kept[i] >= 0 and (company[kept[i]] > 1 or before.get(int(kept[i])) != now.get(int(i))):
            kept[i] = -1


def _thin_out(kept, size, runs, room) -> None:
    """Where an executor has too many bundles, islands of the thin ones leave them."""
    stay = np.flatnonzero(kept >= 0)
    if not len(stay):
        return
    number, of = np.unique(kept[stay], return_inverse=True)
    if len(number) <= BUNDLES_OVER_ENOUGH + 2:
        return
    held, place = total(of, size[stay]), np.empty(len(number), np.int64)
    place[of] = runs[stay]
    enough = -(-total(runs, np.minimum(size, room)) // room)
    many = np.bincount(place, minlength=len(enough)) > BUNDLES_OVER_ENOUGH * enough + 2
    thin = many[place] & (THIN_BELOW * held < room)
    kept[stay[thin[of]]] = -1


def _packed(size, runs, alone, room) -> np.ndarray:
    """Number of the bundle of each island, from 0; they come sorted by executor, with those that are alone last.

    Islands that begin within the same length of the sum of sizes share a bundle; the length is shorter than ``room`` by the
    largest of them, so that no bundle exceeds it.
    """
    small = np.flatnonzero(~alone)
    slot = np.zeros(len(size), np.int64)
    if len(small):
        begin = np.cumsum(size[small]) - size[small]
        begin -= begin[np.searchsorted(runs[small], runs[small])]
        slot[small] = begin // (room - int(size[small].max()) + 1)
    slot[alone] = np.arange(len(size))[alone]
    new = np.concatenate([[True], (np.diff(runs) != 0) | (np.diff(slot) != 0) | (np.diff(alone.astype(np.int8)) != 0)])
    return np.cumsum(new) - 1
