# SPDX-License-Identifier: GPL-2.0-only
"""Quantities of contact."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ... import features
from ...effects import acting
from ...effects.balance import untold
from ...effects.measured import Mean, Measurable, Measured, Of
from ...errors import Problem
from ...scene.scene import SceneRecord
from ..motion.measure import balance


def _force(m: Measured, of: Of) -> np.ndarray:
    """Force of all contact on an object, mean since the frame before [N], shape (F, 3)."""
    return balance(m).contact[:, m.solid(of.subject)]


def unmeasured(scene: SceneRecord, asked: Iterable[Of]) -> list[Problem]:
    """A problem for each force of contact that frames do not tell."""
    wanted = [of for of in asked if of.quantity.partition(".")[0] == "contact"]
    if not wanted:
        return []
    reasons, numbers = untold(scene, acting(features.effects(), scene)), {s.name: m for m, s in enumerate(scene.solids)}
    return [
        Problem(of.span, f"the force of contact on {of.subject} is not known: {reasons[m]}", "ask for that of what touches it")
        for of in wanted
        if (m := numbers[of.subject]) in reasons
    ]


MEASURES = {
    ("penetration", "max"): Measurable(lambda m, of: np.full(len(m.times), m.penetration)),
    ("NAME", "contact"): Mean(lambda m, of: np.linalg.norm(_force(m, of), axis=1)),
    **{("NAME", f"contact.{letter}"): Mean(lambda m, of, axis=axis: _force(m, of)[:, axis]) for axis, letter in enumerate("xyz")},
}
