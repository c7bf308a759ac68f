# SPDX-License-Identifier: GPL-2.0-only
"""A bundle: islands that run in one LAMMPS instance, on one executor or on a team of them."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from ..engine.instance import Instance, State
from ..engine.part import Parts
from ..results.ledger import LOSS
from .energy import energies
from .planning import FramePlan
from .source import run_window


@dataclass(frozen=True)
class Key:
    """What makes two bundles the same."""

    objects: tuple[int, ...]
    """Those that it moves, and copies of still ones, ascending."""
    liquid: bool
    team: tuple[int, ...]
    """Executors that run it, its leader first."""


@dataclass(frozen=True)
class Wanted:
    """A bundle as a plan wants it."""

    key: Key
    members: np.ndarray
    """Objects that it moves, int64, shape (m,); the rest of the key's are guests."""


def wanted_bundles(plan: FramePlan, objects: int, executor: int) -> list[Wanted]:
    """What an executor has to run, those of teams first; ``objects`` is the number of them, the pool not counted."""
    team_of = {int(plan.bundle[np.flatnonzero(plan.label == t.island)[0]]): t.members for t in plan.teams}
    mine = np.isin(plan.bundle, [b for b, members in team_of.items() if executor in members])
    mine |= (plan.owner == executor) & (plan.bundle >= 0) & ~np.isin(plan.bundle, list(team_of))
    who = np.flatnonzero(mine)
    who = who[np.argsort(plan.bundle[who], kind="stable")]
    found = []
    for group in np.split(who, np.flatnonzero(np.diff(plan.bundle[who])) + 1) if len(who) else []:
        number = int(plan.bundle[group[0]])
        guests = plan.guests[np.isin(plan.guests[:, 0], plan.label[group]), 1]
        members = group[group < objects]
        key = Key(tuple(np.union1d(members, guests).tolist()), bool(group[-1] == objects), team_of.get(number, (executor,)))
        found.append((number not in team_of, number, Wanted(key, members)))
    return [w for *_, w in sorted(found, key=lambda f: f[:2])]


class Bundle:
    """A live one. A context of its own: `close` ends it."""

    def __init__(self, parts: Parts, wanted: Wanted, comm: MPI.Comm | None):
        self.key, self.members = wanted.key, wanted.members
        self.plan = parts.part(self.key.objects, self.key.liquid)
        self.instance = Instance(self.plan, comm)
        self.rows = parts.whole.system.rows(self.key.objects)
        """Its particles among all."""
        self.guest = np.repeat(~np.isin(self.key.objects, self.members), np.diff(self.plan.system.first)) if self.key.objects \
            else np.zeros(0, bool)
        """Particles of still objects that others have too, bool, shape (n,)."""
        self.lost: dict[str, float] = {}
        self.run_seconds = self.liquid_seconds = 0.0
        """Processor time of the last window, and of that the liquid's [s]."""

    def close(self) -> None:
        self.instance.close()

    def start(self, step: int, state: State | None) -> None:
        """Take up a state; None is that of the scene, before step 0."""
        if state is None:
            self.instance.setup()
            self.before = self.instance.array("f").copy()
        else:
            self.instance.put(step, state)

    def run(self, steps: int) -> None:
        """Run a window. Raises Broken."""
        begin, soaked = time.process_time(), self._soaked()
        self.instance.start_trace()
        self.before = run_window(self.instance, steps)
        self.trace = self.instance.trace()
        self.instance.start_trace()
        self.here = self.instance.trace()  # of this moment alone
        self.run_seconds, self.liquid_seconds = time.process_time() - begin, self._soaked() - soaked

    def _soaked(self) -> float:
        """Seconds of the liquid so far."""
        return self.instance.fix_seconds("liquid") if self.key.liquid else 0.0

    def escaped(self, low: np.ndarray, high: np.ndarray) -> list[int]:
        """Objects that have been outside of their reserved boxes, those of all objects [m], shape (M, 3), at any step of the window."""
        who = np.array(self.key.objects, np.intp)
        out = ((self.trace[0] < low[who]) | (self.trace[1] > high[who])).any(axis=1)
        return np.intersect1d(who[out], self.members).tolist()

    def extent(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Boxes of its members after a window, eq. (3.14) [m], and the speeds of their fastest particles [m/s]: shapes (m, 3), (m, 3),
        (m,)."""
        if not self.key.objects:
            return np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0)
        which = np.isin(self.key.objects, self.members)
        low, high = (side[which] for side in self.here)
        return low, high, self.plan.system.top_speed(self.instance.array("v"))[which]

    def costs(self, scale: float) -> np.ndarray:
        """Processor time of each member in the last window, without the liquid's, times ``scale``; int64, shape (m,).

        It is told for one executor alone, so that a team counts as what it does.
        """
        particles = np.diff(self.plan.system.first)[np.isin(self.key.objects, self.members)]
        total = scale * len(self.key.team) * max(0.0, self.run_seconds - self.liquid_seconds)
        return (total * particles / max(1, particles.sum())).astype(np.int64)

    def energies(self) -> dict[str, float]:
        """Terms of the ledger [J], of what it moves; losses are those since it was asked last."""
        plan = self.plan
        found = energies(self.instance, self.before)
        if self.guest.any():
            x, mass = self.instance.array("x")[self.guest], plan.system.mass[self.guest]
            for effect in plan.effects:
                if effect.ledger:
                    found[effect.ledger] -= effect.potential(plan.scene, mass, x)
        lost = {term: e for term, e in found.items() if term.endswith(LOSS)}
        found |= {term: e - self.lost.get(term, 0.0) for term, e in lost.items()}
        self.lost = lost
        return found
