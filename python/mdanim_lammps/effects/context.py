# SPDX-License-Identifier: GPL-2.0-only
"""The context of every effect: data of a scene once its effects are decided on and its solids are made."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ..errors import Problem, Span
from ..model.grid import Grid
from ..model.model import Model
from ..model.spacing import Spacing
from ..model.system import System
from ..reach import Reach
from ..records import dataclass
from ..scene.scene import SceneRecord, Solid

if TYPE_CHECKING:
    from .effect import Effect


@dataclass(frozen=True, slots=True)
class Verdict:
    """Whether an effect is on, and why; shown by ``check`` with the scene line."""

    name: str
    on: bool
    reason: str
    span: Span | None = None


@dataclass(frozen=True)
class Resolved:
    """The verdicts of a scene, worked out once."""

    scene: SceneRecord
    verdicts: dict[str, Verdict]
    """Verdicts on all effects, by their names."""
    effects: tuple[Effect, ...]
    """Effects that are on, in the order in which their forces are summed."""
    warnings: tuple[Problem, ...]
    """About effects that the scene calls for and switches off."""

    def on(self, name: str) -> bool:
        """Whether there is an effect of this name, and it is on."""
        return name in self.verdicts and self.verdicts[name].on


@dataclass(frozen=True)
class Context:
    """A scene with all that follows from it, each found once (run/prepare.py); that of a part of a scene has the system and the
    grid of the part, and the rest of the whole (engine/sub_plan.py)."""

    resolved: Resolved
    system: System
    """The solids as particles."""
    models: tuple[Model, ...]
    """The solids one by one, with their surfaces."""
    spacing: Spacing
    """Spacing that the scene is resolved with."""
    reach: Reach
    """Where solids can be, until when, and how fast."""
    grid: Grid | None
    """Cells of the liquid; None where none of the effects that are on has any."""

    @property
    def scene(self) -> SceneRecord:
        return self.resolved.scene

    @cached_property
    def solids(self) -> tuple[Solid, ...]:
        """The solids of the system in the scene, in its order."""
        by_name = {solid.name: solid for solid in self.scene.solids}
        return tuple(by_name[name] for name in self.system.names)

    @cached_property
    def system_models(self) -> tuple[Model, ...]:
        """The models of the system, in its order."""
        by_name = {model.name: model for model in self.models}
        return tuple(by_name[name] for name in self.system.names)

    @cached_property
    def damping_ratio(self) -> np.ndarray:
        """`Effect.damping_ratio` of all effects that are on together [-], shape (M,)."""
        told = (ratio for e in self.resolved.effects if (ratio := e.damping_ratio(self)) is not None)
        return sum(told, np.zeros(len(self.system.names)))

    @cached_property
    def drag(self) -> np.ndarray | None:
        """`Effect.drag` of all effects that are on together [N*s/m], shape (N,); None where none brings any."""
        told = [drag for e in self.resolved.effects if (drag := e.drag(self)) is not None]
        return sum(told[1:], told[0]) if told else None

    @property
    def pushed(self) -> str:
        """LAMMPS's group of all particles on which forces between things count: those that move by forces, and those that are
        driven, for the work that they do."""
        return "mobile" if self.system.moved is None else "moving"

    @cached_property
    def passing(self) -> list[tuple[int, int]]:
        """Pairs i < j of solids of the system that may be in each other, ascending: no contact acts between them."""
        told = self.reach.acting.passing
        if not told:
            return []
        number = {name: m for m, name in enumerate(self.system.names)}
        named = ((self.scene.solids[i].name, self.scene.solids[j].name) for i, j in told)
        return sorted((number[a], number[b]) for a, b in named if a in number and b in number)

    def on(self, name: str) -> bool:
        """Whether an effect of this name is on."""
        return self.resolved.on(name)
