# SPDX-License-Identifier: GPL-2.0-only
"""Where the frames of a run come from: one instance in this process, or executors on many (parallel/runtime/supervisor.py)."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from contextlib import contextmanager
from dataclasses import field
from typing import Protocol

import numpy as np

from ..effects.fields import Fields
from ..effects.readings import LEAPFROG
from ..engine.instance import Instance
from ..engine.plan import Plan
from ..engine.state import State
from ..errors import DivergedError
from ..model.model import Model
from ..records import dataclass
from ..results.checkpoint import Checkpoint
from ..results.frame_rows import FrameRows, RowWriter
from .energy import energies, tell, whole_fields
from .guard import fastest
from .observe import Observation, Observer

COST_SECONDS = 0.25
"""Wall time between two words on what a run has cost so far."""
PIECE_SECONDS = 1.0
"""Wall time for which LAMMPS is left alone: a second Ctrl-C is heard after it."""
PER_PARTICLE = 1e-6
"""More seconds than a step takes for a particle."""


@dataclass(frozen=True)
class Frame:
    """The whole scene at the end of a window."""

    step: int
    seen: Observation
    """Observation of all objects."""
    checksums: np.ndarray
    """Checksums of all positions and of all velocities, as the trajectory file has them, uint32, shape (2,)."""
    energies: dict[str, float]
    """Every term of the ledger [J]; what is lost counts from the start of this run, not from before a resume."""
    penetration: float
    """Deepest that a boundary particle has been below a surface in this run [m]."""
    fields: Fields = field(default_factory=dict)
    """Values of effects, by the names of energy.frame_fields."""
    kept: bool = True
    """Whether `FrameSource.state` can be asked for."""


@dataclass
class Account:
    """Where the time of a simulation went [s], so far."""

    effects: dict[str, dict[str, float]] = field(default_factory=dict)
    """Clocks of each effect, by its name."""
    leapfrog: float = 0.0
    """The integrator without what effects take of it."""
    other: dict[str, float] = field(default_factory=dict)
    """Work that is not an effect's: moving objects, waiting for others."""

    def add(self, effect: str, clocks: Mapping[str, float], share: float = 1.0) -> None:
        """Add a share of what an effect's clocks say."""
        mine = self.effects.setdefault(effect, {})
        for clock, seconds in clocks.items():
            mine[clock] = mine.get(clock, 0.0) + share * seconds

    def add_all(self, other: Account, share: float = 1.0) -> None:
        """Add a share of all that another account says."""
        self.leapfrog += share * other.leapfrog
        for effect, clocks in other.effects.items():
            self.add(effect, clocks, share)
        for kind, seconds in other.other.items():
            self.other[kind] = self.other.get(kind, 0.0) + share * seconds

    def clock(self, kind: str):
        """Add the wall seconds of a ``with`` block to other work."""
        return clock(self.other, kind)


@contextmanager
def clock(seconds: dict[str, float], what: str):
    """Add the wall seconds of a ``with`` block to an account, also of one that fails."""
    begin = time.perf_counter()
    try:
        yield
    finally:
        seconds[what] = seconds.get(what, 0.0) + time.perf_counter() - begin


class LammpsFailure(Exception):
    """LAMMPS has ended a run by itself; the guard says why."""

    def __init__(self, step: int, error: DivergedError, solid: int | None):
        super().__init__(str(error))
        self.step, self.error = step, error
        self.solid = solid
        """The solid that is fastest for its wave speed; None when LAMMPS has lost particles."""


class FrameSource(Protocol):
    """Gives the frames of a run in order, their rows of particles being in the trajectory file. A context manager."""

    executors: int
    """Processes that simulate."""

    def begin(self, resume: Checkpoint | None, rows: FrameRows) -> Frame | None:
        """Take up the start, and give frame 0; or the state of a checkpoint, and give nothing. ``rows`` is where rows of
        particles go. Raises OutputError."""

    def advance(self, frame: int, steps: int) -> Frame:
        """The state ``steps`` steps later, which is frame ``frame``. Raises LammpsFailure, DivergedError, OutputError."""

    def stop(self, frame: int) -> int:
        """Make an end soon after frame ``frame``; returns the last frame that will come, which is a kept one."""

    def state(self) -> State:
        """All that later steps depend on, at the last frame."""

    def account(self) -> Account:
        """Where the time went, at the end."""

    def account_so_far(self) -> Account | None:
        """Where the time went up to about now; None where that is not known yet. Does not wait."""

    def new_owners(self) -> list[tuple[int, int]]:
        """(object, executor) of objects that belong to another executor than at the frame before the last one."""


class Sequential:
    """All objects in one LAMMPS instance in this process: Wcislo 1999, fig. 11."""

    executors = 1

    def __init__(self, plan: Plan, models: Sequence[Model] = ()):
        """``models`` as for an `Observer`."""
        self.plan, self.observer = plan, Observer(plan, models)
        self.objects = np.arange(len(plan.system.names))
        self.spent = Account()
        """On what is not an effect's."""
        self.of_step = PER_PARTICLE * max(1, plan.system.particles)
        """Time of a step [s]: a guess, until the first ones have been measured."""

    def __enter__(self) -> Sequential:
        self.instance = Instance(self.plan)
        self.rows: RowWriter | None = None
        return self

    def __exit__(self, *_) -> None:
        self.instance.close()
        if self.rows:
            self.rows.close()

    def begin(self, resume, rows):
        self.rows = RowWriter(rows)
        if resume:
            self.instance.put(resume.step, resume.state)
            return None
        self.instance.setup()
        return self._frame(0)

    def advance(self, frame, steps):
        # In pieces, as no signal is heard while LAMMPS is at work. Their lengths change no bit.
        while steps:
            piece, begin = min(steps, max(1, int(PIECE_SECONDS / self.of_step))), time.perf_counter()
            run_window(self.instance, piece)
            self.of_step = max((time.perf_counter() - begin) / piece, 1e-9)
            steps -= piece
        return self._frame(frame)

    def steer(self, command: str) -> None:
        """See `run.hands.TakesCommands`."""
        self.instance.lammps.command(command)

    def places(self, rows: np.ndarray) -> np.ndarray:
        """See `run.hands.TakesCommands`."""
        return self.instance.array("x")[rows].copy()

    def stop(self, frame):
        return frame

    def state(self):
        return self.instance.state()

    def account(self):
        account = Account()
        account.add_all(self.spent)
        add_clocks(account, self.instance)
        return account

    def account_so_far(self):
        return self.account()

    def new_owners(self):
        return []

    def _frame(self, frame: int) -> Frame:
        instance = self.instance
        x, v = instance.array("x"), instance.array("v")
        fields = whole_fields(self.plan, [(self.objects, tell(instance))])
        with self.spent.clock("guard"):
            seen = self.observer.observe(self.objects, self.objects, x, v, fields)
        with self.spent.clock("output"):
            checksums = self.rows.write(frame, [slice(0, self.plan.system.particles)], x, v)
        return Frame(instance.step, seen, checksums, energies(instance, seen.center), penetration(instance), fields)


def run_window(instance: Instance, steps: int) -> None:
    """Run ``steps`` steps. Raises LammpsFailure."""
    try:
        instance.run(steps)
    except DivergedError as error:
        raise LammpsFailure(instance.step, error, fastest(instance.plan.system, instance.array("v"))) from error


def penetration(instance: Instance) -> float:
    """Deepest that a boundary particle has been below a surface since the instance was set up [m]."""
    return max([0.0, *(e.penetration(instance) for e in instance.plan.effects)])


def add_clocks(account: Account, instance: Instance) -> None:
    """Add what an instance has taken since it was made."""
    account.leapfrog += instance.fix_seconds("leapfrog")
    for effect in instance.plan.effects:
        clocks = effect.clocks(instance)
        account.add(effect.name, clocks)
        account.leapfrog -= clocks.get(LEAPFROG, 0.0)
