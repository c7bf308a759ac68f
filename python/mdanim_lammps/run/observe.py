# SPDX-License-Identifier: GPL-2.0-only
"""Observation of the particles of a frame: a few numbers of each object, so that the process that has an object reads them."""

from __future__ import annotations

from collections.abc import Sequence
from types import MappingProxyType

import numpy as np

from ..effects.fields import GONE, Fields
from ..effects.measured import Glance
from ..engine.geometry import INVERTED, NOT_FINITE, Geometry
from ..engine.plan import Plan
from ..model.model import Model
from ..model.patches import Members
from ..model.system import System, centers
from ..records import dataclass
from ..results.quantities import recorded
from .folds import Folds


@dataclass(frozen=True)
class Observation:
    """Observed values of m objects at a frame."""

    objects: np.ndarray
    """These objects, from 0 and ascending, int64, shape (m,)."""
    center: np.ndarray
    """Centres of mass [m], shape (m, 3)."""
    center_velocity: np.ndarray
    """[m/s], shape (m, 3)."""
    reach: np.ndarray
    """How far each object reaches along x, y, z, -x, -y and -z [m], shape (m, 6); nothing of use where a number is not finite."""
    speed: np.ndarray
    """Largest component of the velocities of each object's particles, without its sign [m/s], shape (m,)."""
    not_finite: int | None
    """First particle whose position or velocity is NaN or infinite; None where all are finite."""
    inverted: np.ndarray
    """Lattice cells of the scene that are inside out, ascending, int64, shape (c,)."""
    sunk: tuple[int, int] | None
    """As `Geometry.sunk`."""
    folded: np.ndarray
    """Particles of each object that lie among others of it (folds.py), int64, shape (m,)."""
    fold: np.ndarray
    """Their mean place [m], shape (m, 3)."""
    recorded: dict[str, float]
    """Quantities that a scene asks for and that need every frame, by their columns of the ledger."""


def recorded_models(models: Sequence[Model], plan: Plan) -> tuple[Model, ...]:
    """Models that an `Observer` of a plan needs."""
    wanted = {name for name, _ in recorded(plan.scene.asked).values()}
    return tuple(model for model in models if model.name in wanted)


class Torn:
    """Cells and objects of which springs are gone: they tell nothing of a body any more."""

    def __init__(self, system: System, gone: np.ndarray):
        self._system, self._ends = system, system.spring[gone]
        self.apart = np.flatnonzero(np.bincount(system.object[self._ends[:, 0]]))
        """Objects that are torn, ascending, int64, shape (m,)."""

    def cells(self) -> np.ndarray:
        """Cells of the system with a spring that is gone, bool, shape (C,)."""
        corner = self._system.hexahedron
        found = np.zeros(len(corner), bool)
        own = np.flatnonzero(np.isin(self._system.object[corner[:, 0]], self.apart))
        if len(own):
            found[own] = Members(corner[own].reshape(-1), np.repeat(np.arange(len(own)), 8)).broken(self._ends)
        return found


class Observer:
    """Looks at the particles of some objects of a plan.

    Args:
        plan: of the whole scene.
        models: `recorded_models` at least.
    """

    def __init__(self, plan: Plan, models: Sequence[Model]):
        self.context, self.system = plan.context, plan.system
        self.geometry, self.folds = Geometry(plan.system, plan.context.passing), Folds(plan.system)
        self.apart = any(effect.keeps_apart for effect in plan.effects)
        model_of, number = {model.name: model for model in models}, {name: m for m, name in enumerate(plan.system.names)}
        wanted = recorded(plan.scene.asked)
        self.recorded = [(number[name], quantity.look, column) for column, (name, quantity) in wanted.items()]
        self.models = {number[name]: model_of[name] for name, _ in wanted.values()}

    def observe(
        self, objects: np.ndarray, near: np.ndarray, x: np.ndarray, v: np.ndarray, fields: Fields = MappingProxyType({})
    ) -> Observation:
        """Look at some objects.

        Args:
            objects: from 0 and ascending, int64, shape (m,).
            near: these and all others that may touch them, ascending, int64.
            x: positions of all particles, of which only those of ``near`` are read [m], shape (N, 3).
            v: velocities, of which only those of ``objects`` are read [m/s], shape (N, 3).
            fields: what effects tell of the frame; nothing where these objects are out of their reach.
        """
        found, reach = self.geometry.glance(x, v, objects)
        sound, torn = found != NOT_FINITE, self._torn(fields)
        return Observation(
            objects,
            *self._centers(objects, x, v),
            reach,
            self.geometry.largest_components(v, objects),
            None if sound else self._not_finite(objects, x, v),
            np.flatnonzero(self.geometry.inverted(x, objects) & ~torn.cells()) if found == INVERTED else np.zeros(0, np.int64),
            self.geometry.sunk(x, np.setdiff1d(near, torn.apart)) if self.apart and sound else None,
            *self.folds.find(objects, x if sound else self.system.position, torn.apart),
            self._recorded(objects, x, v, fields) if sound else {},
        )

    def _recorded(self, objects: np.ndarray, x: np.ndarray, v: np.ndarray, fields: Fields) -> dict[str, float]:
        glances = {m: Glance(self.context, m, model, x, v, fields) for m, model in self.models.items() if m in objects}
        return {column: look(glances[m]) for m, look, column in self.recorded if m in glances}

    def _torn(self, fields: Fields) -> Torn:
        return Torn(self.system, np.flatnonzero(fields[GONE]) if GONE in fields else np.zeros(0, np.int64))

    def _centers(self, objects: np.ndarray, *vectors: np.ndarray) -> list[np.ndarray]:
        places = self.system.stretches(objects)
        if not places:
            return [np.zeros((0, 3)) for _ in vectors]
        every = (self.system.mass, *vectors)
        mass, *vectors = (a[places[0]] if len(places) == 1 else np.concatenate([a[p] for p in places]) for a in every)
        size = np.diff(self.system.first)[objects]
        with np.errstate(invalid="ignore", over="ignore"):  # numbers that are not finite are told of
            return [centers(mass, np.cumsum(size) - size, vector) for vector in vectors]

    def _not_finite(self, objects: np.ndarray, x: np.ndarray, v: np.ndarray) -> int:
        found = ((place.start, self.geometry.not_finite(x[place], v[place])) for place in self.system.stretches(objects))
        return next(begin + first for begin, first in found if first is not None)


def join(parts: Sequence[Observation]) -> Observation:
    """Joins observations of parts of a scene; no object is in two of them."""
    objects = np.concatenate([part.objects for part in parts])
    order = np.argsort(objects)
    arrays = ("objects", "center", "center_velocity", "reach", "speed")
    return Observation(
        *(np.concatenate([getattr(part, name) for part in parts])[order] for name in arrays),
        min((part.not_finite for part in parts if part.not_finite is not None), default=None),
        np.sort(np.concatenate([part.inverted for part in parts])),
        min((part.sunk for part in parts if part.sunk), default=None),
        *(np.concatenate([getattr(part, name) for part in parts])[order] for name in ("folded", "fold")),
        {column: value for part in parts for column, value in part.recorded.items()},
    )
