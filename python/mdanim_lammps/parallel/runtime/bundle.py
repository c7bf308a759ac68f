# SPDX-License-Identifier: GPL-2.0-only
"""A bundle: islands that run in one LAMMPS instance, on one executor or on a team of them."""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np
from mpi4py import MPI

from ...engine.instance import Instance
from ...engine.state import Records, State, StateRecords
from ...engine.sub_plan import SubPlans
from ...engine.threads import MOST_THREADS, asked_threads, with_threads
from ...model.system import side_by_side
from ...records import dataclass
from ...run.energy import losses
from ...run.frame_source import run_window
from ..plan.frame_plan import FrameAssignment
from .messages import gathered, scatter

LEAST_SHARE_IN_USE = 0.5
"""Least share of an instance's particles that it is kept for; the others are those of objects that it has laid aside."""

LOOKS_PER_WINDOW = 32
"""In a window, as many at least, or after every step: what boxes are widened by meanwhile is a thirtieth of the way that is
reserved."""
MOST_STEPS_BETWEEN_LOOKS = 4
"""Steps from one look at where particles are to the next, at most."""


@dataclass(frozen=True)
class Key:
    """Properties that make two bundles the same."""

    objects: tuple[int, ...]
    """Objects that it moves, and copies of still ones, ascending."""
    grid: bool
    team: tuple[int, ...]
    """Executors that run it, its leader first."""
    by_threads: bool = False
    """Whether its leader runs it alone, with threads for all of them."""

    @property
    def ranks(self) -> tuple[int, ...]:
        """Executors that have its instance."""
        return self.team[:1] if self.by_threads else self.team


@dataclass(frozen=True)
class Wanted:
    """A bundle as a plan wants it."""

    number: int
    """In the plan."""
    key: Key
    members: np.ndarray
    """Objects that it moves, int64, shape (m,); the rest of the key's are guests."""


def wanted_bundles(plan: FrameAssignment, objects: int, executor: int, by_threads: bool = False) -> list[Wanted]:
    """The bundles that an executor has to run, those of teams first; ``objects`` is the number of them, the grid not counted.

    ``by_threads``: leaders of teams run the bundles that are theirs alone.
    """
    team_of = {int(plan.bundle[np.flatnonzero(plan.label == t.island)[0]]): t.members for t in plan.teams}
    mine = (plan.owner == executor) & (plan.bundle >= 0)
    for number, members in team_of.items():
        mine[plan.bundle == number] = executor in (members[:1] if by_threads else members)
    ordered = np.flatnonzero(mine)
    ordered = ordered[np.argsort(plan.bundle[ordered], kind="stable")]
    found = []
    numbers, begin = np.unique(plan.bundle[ordered], return_index=True)
    for number, a, b in zip(numbers.tolist(), begin.tolist(), [*begin[1:].tolist(), len(ordered)]):
        group = ordered[a:b]
        guests = plan.guests[np.isin(plan.guests[:, 0], plan.label[group]), 1].tolist() if len(plan.guests) else ()
        members = group[group < objects]
        team = team_of.get(number, (executor,))
        key = Key(tuple(sorted({*members.tolist(), *guests})), bool(group[-1] == objects), team, by_threads and len(team) > 1)
        found.append((number not in team_of, number, Wanted(number, key, members)))
    return [w for *_, w in sorted(found, key=lambda f: f[:2])]


class Bundle:
    """A live one; its owner closes its instance."""

    def __init__(self, parts: SubPlans, wanted: Wanted, comm: MPI.Comm | None):
        self.objects = np.array(wanted.key.objects, np.intp)
        """All in its instance, also those that it has laid aside."""
        self.plan = parts.part(wanted.key.objects, wanted.key.grid)
        self.comm = comm
        threads_for = len(wanted.key.team) if wanted.key.by_threads else 1
        with with_threads(None if threads_for == 1 else min(MOST_THREADS, threads_for * (asked_threads() or 1))):
            self.instance = Instance(self.plan, comm)
        self.places = parts.whole.system.stretches(self.objects)
        """Its particles among all."""
        self.first, self.still = parts.whole.system.first, parts.whole.system.still
        self.particles = np.diff(self.plan.system.first) if len(self.objects) else np.zeros(0, np.int64)
        """Number of particles of each object."""
        self.scattered = False
        """Whether the members of its team have, since its last window, each the particles of `stretches` alone."""
        self.aside = np.zeros(len(self.objects), bool)
        """Objects that are others' now."""
        self.lost: dict[str, float] = {}
        self.run_seconds = self.grid_seconds = 0.0
        """Processor time of the last window, and of that the grid's [s]."""
        self._take(wanted)

    def _take(self, wanted: Wanted) -> None:
        self.number, self.key, self.members = wanted.number, wanted.key, wanted.members
        self.moves = self._among(wanted.members)
        """Which of its objects are its members; the others are guests, or laid aside."""
        which = np.flatnonzero(self.moves)
        self.stretches = side_by_side(self.particles[which], self.plan.system.first[which], self.first[self.objects[which]])
        """Where its members' particles are in its instance, and among all; of a team, once it has told, those that this
        executor has."""
        self._rows: np.ndarray | None = None
        """For a team: the particles in its instance that these stretches are for."""

    def write_state(self, **arrays: np.ndarray) -> None:
        """Write what this executor has of ``x``, ``v``, ``f`` now into such arrays of all particles."""
        if self.comm is not None:
            rows = self.instance.particles.rows()
            if rows is not self._rows:
                self._rows, self.stretches = rows, self._stretches_of(rows)
            self.scattered = True
        for name, everything in arrays.items():
            now = self.instance.particles.here(name)
            for here, there in self.stretches:  # five times as fast as row by row
                everything[there] = now[here]

    def share_state(self, *arrays: np.ndarray) -> None:
        """Let all members of its team have in such arrays what each has told. To be called by all of them together."""
        if not self.scattered:
            return
        places = [there for _, there in self.stretches]
        for found, parts in self.comm.allgather((places, gathered(places, *arrays))):
            scatter(found, *zip(arrays, parts))
        self.scattered = False

    def gather_state(self, *arrays: np.ndarray) -> None:
        """Let the leader of its team have in such arrays what each member has told. To be called by all of them together."""
        if self.comm is None:
            return
        places = [there for _, there in self.stretches]
        told = self.comm.gather((places, gathered(places, *arrays)) if self.comm.rank else None)
        for found, parts in (told or ())[1:]:
            scatter(found, *zip(arrays, parts))

    def _stretches_of(self, rows: np.ndarray) -> list[tuple[slice, slice]]:
        """For these particles of its instance, ascending: the places of its members' particles among them, and among all."""
        object_of = self.plan.system.object[rows]
        here = np.flatnonzero(self.moves[object_of])
        shift = self.first[self.objects] - self.plan.system.first[:-1]
        return side_by_side(np.ones(len(here), np.int64), here, (rows + shift[object_of])[here])

    def _among(self, objects: Sequence[int]) -> np.ndarray:
        """Which of its objects are among these, bool, shape (n,)."""
        among = np.zeros(len(self.first), bool)
        among[np.asarray(objects, np.intp)] = True
        return among[self.objects]

    # --- what fixes keep ---------------------------------------------------------------------------------------------

    @property
    def inside(self) -> np.ndarray:
        """Which of all objects are in it and not laid aside, and last whether the whole is: bool, shape (M + 1,)."""
        inside = np.zeros(len(self.first), bool)
        inside[list(self.key.objects)] = True
        inside[-1] = self.key.grid
        return inside

    def records_from(self, records: Records) -> dict[str, StateRecords]:
        """The records, of those of all objects, that its instance is to have, numbered as there."""
        inside = self.inside
        return {fix: found.where(found.of(inside)).take(self.objects, self.key.grid) for fix, found in records.items()}

    def records_to(self, records: Records) -> dict[str, StateRecords]:
        """Records of the objects that its instance moves, numbered as all objects are; of pairs with guests too."""
        inside, moved, result = self.inside, np.append(self.members, len(self.first) - 1), {}
        for fix, found in records.items():
            whole = found.renumbered(self.objects)
            result[fix] = whole.where(whole.of(inside) & np.isin(whole.home(self.still), moved))
        return result

    def records_elsewhere(self, records: Records) -> dict[str, StateRecords]:
        """Records that its instance has nothing to say about, because an object of them is not in it."""
        inside = self.inside
        return {fix: found.where(~found.of(inside)) for fix, found in records.items()}

    # --- what it moves --------------------------------------------------------------------------------------------

    def can_be(self, wanted: Wanted) -> bool:
        """Whether it is this bundle, once it has laid aside the objects that it is to have no more, and most of its work would
        still be for something. Only instances of one executor without a grid lay aside."""
        if wanted.key == self.key:
            return True
        if wanted.number != self.number or wanted.key.grid or self.key.grid or len(wanted.key.team) + len(self.key.team) > 2:
            return False
        if np.count_nonzero(self._among(wanted.key.objects) & ~self.aside) < len(wanted.key.objects):
            return False
        return self.particles[self._among(wanted.members)].sum() >= LEAST_SHARE_IN_USE * self.particles.sum()

    def drop_objects(self, wanted: Wanted) -> None:
        """Lay aside those objects that it does not move any more; a guest that is not needed any more does no harm."""
        if wanted.key == self.key:
            self.number = wanted.number
            return
        out = self.moves & ~self._among(wanted.members)
        if out.any():
            self.instance.lay_aside(np.flatnonzero(out))
            self.aside |= out
        self._take(wanted)

    def start(self, step: int, state: State | None) -> None:
        """Take up a state; None is that of the scene, before step 0."""
        self.ran = False
        if state is None:
            self.instance.setup()
        else:
            if self.aside.any():
                rows = np.repeat(self.aside, self.particles)
                state.x[rows], state.v[rows], state.f[rows] = (self.instance.array(name)[rows] for name in "xvf")
            self.instance.put(step, state)
            self.lost = losses(self.instance)
        self.instance.trace.start()

    def run(self, steps: int) -> None:
        """Run a window. Raises LammpsFailure."""
        begin, before_grid = time.process_time(), self._of_grid()
        self.instance.trace.look_every(min(max(1, steps // LOOKS_PER_WINDOW), MOST_STEPS_BETWEEN_LOOKS))
        run_window(self.instance, steps)
        self.trace = self.instance.trace.boxes()
        self.instance.trace.start()  # of the next window
        self.here = self.instance.trace.boxes()  # of this moment alone
        self.ran = True
        self.run_seconds, self.grid_seconds = time.process_time() - begin, self._of_grid() - before_grid

    def _of_grid(self) -> float:
        """Seconds of what lives in the grid so far, of all threads for a team."""
        if not self.key.grid:
            return 0.0
        return (
            sum(self.instance.fix_seconds(e.fix) for e in self.plan.effects if e.on_grid)
            * len(self.key.team)
            / len(self.key.ranks)
        )

    def escaped(self, low: np.ndarray, high: np.ndarray) -> list[int]:
        """Objects that have been outside of their reserved boxes, those of all objects [m], shape (M, 3), at any step
        of the window."""
        out = ((self.trace[0] < low[self.objects]) | (self.trace[1] > high[self.objects])).any(axis=1)
        return self.objects[out & self.moves].tolist()

    def extent(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Boxes of its members after a window, eq. (3.14) [m], and the speeds of their fastest particles [m/s]: shapes (m, 3),
        (m, 3), (m,)."""
        if not len(self.objects):
            return np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0)
        low, high = (side[self.moves] for side in self.here)
        return low, high, self.instance.trace.top_speeds()[self.moves]

    def costs(self, scale: float) -> np.ndarray:
        """Processor time of each member in the last window, without the grid's, times ``scale``; int64, shape (m,).

        It is told for one executor alone, so that a team counts as what it does.
        """
        particles = self.particles[self.moves]
        total = scale * len(self.key.ranks) * max(0.0, self.run_seconds - self.grid_seconds)
        return (total * particles / max(1, particles.sum())).astype(np.int64)

    def newly_lost(self) -> dict[str, float]:
        """Losses [J], by term of the ledger, since it was asked last."""
        before, self.lost = self.lost, losses(self.instance)
        return {term: e - before.get(term, 0.0) for term, e in self.lost.items()}
