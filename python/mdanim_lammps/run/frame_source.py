# SPDX-License-Identifier: GPL-2.0-only
"""Where the frames of a run come from: one instance in this process, or executors on many (parallel/runtime/supervisor.py)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from ..effects.air_drag import LEAPFROG
from ..effects.liquid import CELLS, CELLS_AT_START, LiquidAutomaton
from ..engine.instance import Instance
from ..engine.plan import Plan
from ..engine.state import State
from ..errors import DivergedError
from ..results.checkpoint import Checkpoint
from .energy import energies
from .guard import fastest

COST_SECONDS = 0.25
"""Wall time between two words on what a run has cost so far."""


@dataclass(frozen=True)
class LiquidFrame:
    """The liquid at a frame."""

    heights: tuple[np.ndarray, np.ndarray]
    """As `Instance.liquid_heights`."""
    drops: np.ndarray | None
    """As `Instance.liquid_drops`; None where the liquid sheds none."""
    cells: int
    """Whole cells of liquid now."""
    start: int
    """The same before step 0, and what has come since less what has gone."""


@dataclass(frozen=True)
class Frame:
    """The whole scene at the end of a window."""

    step: int
    x: np.ndarray
    """[m], in tag order, shape (N, 3); valid until the next frame is asked for, as ``v`` is."""
    v: np.ndarray
    """[m/s], shape (N, 3)."""
    energies: dict[str, float]
    """Every term of the ledger [J]; what is lost counts from the start of this run, not from before a resume."""
    penetration: float
    """Deepest that a boundary particle has been below a surface in this run [m]."""
    liquid: LiquidFrame | None = None
    """None without a liquid."""
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
    """Work that is no effect's: moving objects, waiting for others."""

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


class LammpsFailure(Exception):
    """LAMMPS has ended a run by itself; the guard says why."""

    def __init__(self, step: int, error: DivergedError, solid: int | None):
        super().__init__(str(error))
        self.step, self.error = step, error
        self.solid = solid
        """The solid that is fastest for its wave speed; None when LAMMPS has lost particles."""


class FrameSource(Protocol):
    """Gives the frames of a run in order. A context manager."""

    executors: int
    """Processes that simulate."""

    def begin(self, resume: Checkpoint | None) -> Frame | None:
        """Take up the start, and give frame 0; or the state of a checkpoint, and give nothing."""

    def advance(self, frame: int, steps: int) -> Frame:
        """The state so many steps later, which is frame ``frame``. Raises LammpsFailure, DivergedError."""

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

    def __init__(self, plan: Plan):
        self.plan = plan

    def __enter__(self) -> Sequential:
        self.instance = Instance(self.plan)
        return self

    def __exit__(self, *_) -> None:
        self.instance.close()

    def begin(self, resume):
        if resume:
            self.instance.put(resume.step, resume.state)
            return None
        self.instance.setup()
        return self._frame()

    def advance(self, frame, steps):
        run_window(self.instance, steps)
        return self._frame()

    def stop(self, frame):
        return frame

    def state(self):
        return self.instance.state()

    def account(self):
        account = Account()
        add_clocks(account, self.instance)
        return account

    def account_so_far(self):
        return self.account()

    def new_owners(self):
        return []

    def _frame(self) -> Frame:
        instance = self.instance
        return Frame(
            instance.step,
            instance.array("x"),
            instance.array("v"),
            energies(instance),
            penetration(instance),
            liquid_frame(instance),
        )


def run_window(instance: Instance, steps: int) -> None:
    """Run so many steps. Raises LammpsFailure."""
    try:
        instance.run(steps)
    except DivergedError as error:
        raise LammpsFailure(instance.step, error, fastest(instance.plan.system, instance.array("v"))) from error


def penetration(instance: Instance) -> float:
    """Deepest that a boundary particle has been below a surface since the instance was set up [m]."""
    return max([0.0, *(e.penetration(instance) for e in instance.plan.effects)])


def liquid_frame(instance: Instance) -> LiquidFrame | None:
    """The liquid now."""
    if instance.plan.grid is None:
        return None
    cells, start = (int(instance.fix_value(LiquidAutomaton.fix, n)) for n in (CELLS, CELLS_AT_START))
    drops = instance.liquid_drops() if instance.plan.scene.liquid.drops else None
    return LiquidFrame(instance.liquid_heights(), drops, cells, start)


def add_clocks(account: Account, instance: Instance) -> None:
    """Add what an instance has taken since it was made."""
    account.leapfrog += instance.fix_seconds("leapfrog")
    for effect in instance.plan.effects:
        clocks = effect.clocks(instance)
        account.add(effect.name, clocks)
        account.leapfrog -= clocks.get(LEAPFROG, 0.0)
