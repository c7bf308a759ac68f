# SPDX-License-Identifier: GPL-2.0-only
"""Quantities of contact."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ... import features
from ...effects import acting
from ...effects.balance import untold
from ...effects.measured import Mean, Measurable, Measured, Of, of_vector
from ...errors import Problem
from ...scene.once import once_for
from ...scene.scene import SceneRecord
from ..motion.measure import balance
from .between import Touching
from .words import WORLD


def _force(m: Measured, of: Of) -> np.ndarray:
    """Force of contact on an object, of all or with one thing alone, mean since the frame before [N], shape (F, 3)."""
    if of.argument is not None:
        return _touching(m).force(m.solid(of.subject), of.argument)
    return balance(m).contact[:, m.solid(of.subject)]


@once_for(lambda m: m)
def _touching(m: Measured) -> Touching:
    return Touching(m, balance(m))


def _on_world(m: Measured, of: Of) -> np.ndarray:
    """The same on ground, walls and all that is held together, shape (F, 3)."""
    return balance(m).on_world


def unmeasured(scene: SceneRecord, asked: Iterable[Of]) -> list[Problem]:
    """A problem for each force of contact that frames do not tell."""
    wanted = [of for of in asked if of.quantity.partition(".")[0] == "contact"]
    if not wanted:
        return []
    effects, numbers = acting(features.effects(), scene), {s.name: m for m, s in enumerate(scene.solids)}
    own, in_sum = untold(scene, effects), untold(scene, effects, in_sum=True)
    free = next((m for m in in_sum if not scene.solids[m].hold), None)
    found = []
    for of in wanted:
        m, reasons = (free, in_sum) if of.subject == WORLD else (numbers[of.subject], own)
        other = numbers.get(str(of.argument))
        if other is not None and other not in own:
            m = other  # it gets the opposite
        if m in reasons:
            on = "" if of.subject != WORLD else f", nor that on {scene.solids[m].name}"
            cause = f"the force of contact on {of.subject} is not known{on}: {reasons[m]}"
            known = any(k not in own for k, solid in enumerate(scene.solids) if not solid.hold)
            way_out = (
                "ask for that on another object, one that moves freely" if known else "take the line out: no object here has it"
            )
            found.append(Problem(of.span, cause, way_out))
    return list(dict.fromkeys(found))  # the components of an arrow have one problem


MEASURES = {
    ("penetration", "max"): Measurable(lambda m, of: np.full(len(m.times), m.penetration)),
    **of_vector("NAME", "contact", _force, Mean),
    **of_vector(WORLD, "contact", _on_world, Mean),
}
