# SPDX-License-Identifier: GPL-2.0-only
"""Which springs are gone, by the fields of a frame."""

from __future__ import annotations

import numpy as np

from ...effects.context import Context
from ...effects.fields import GONE, Fields
from ...effects.readings import Readings
from ...model.system import System
from .words import tears

EFFECT, FIX = "tearing", "tear"
"""The effect that tells of it, and its fix."""
NAME = GONE
"""Field of springs that has 1 for one that is gone."""


def gone_of(system: System, solid: int, fields: Fields) -> np.ndarray:
    """Which springs of an object are gone in a frame, bool, in the order of ``system.spring``; none where no field tells."""
    own, found = system.springs_of(solid), fields.get(NAME)
    return np.zeros(own.stop - own.start, bool) if found is None else np.asarray(found)[own] > 0.0


def acts(context: Context) -> bool:
    """Whether springs of what is simulated may break."""
    return context.resolved.on(EFFECT) and any(map(tears, context.solids))


def change_of_energy(readings: Readings) -> float:
    """Energy that bodies without load have less since springs are gone, and energy of what remains of these, together [J]."""
    if not acts(readings.context):
        return 0.0
    return float(readings.column(NAME) @ readings.system.preload_energy) + readings.fix_scalar(FIX)
