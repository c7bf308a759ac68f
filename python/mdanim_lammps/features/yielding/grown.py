# SPDX-License-Identifier: GPL-2.0-only
"""By how much springs have grown, by the fields of a frame."""

from __future__ import annotations

import numpy as np

from ...effects.context import Context
from ...effects.fields import GROWN, Fields
from ...effects.readings import Readings
from ...model.system import System
from .words import yields

EFFECT, FIX = "yielding", "yield"
"""The effect that tells of it, and its fix."""
NAME = GROWN
"""Field of springs that has the growth of rest lengths."""


def grown_of(system: System, solid: int, fields: Fields) -> np.ndarray:
    """Growth of the rest lengths of an object in a frame [m], in the order of ``system.spring``; 0 where no field tells."""
    own, found = system.springs_of(solid), fields.get(NAME)
    return np.zeros(own.stop - own.start) if found is None else np.asarray(found)[own]


def acts(context: Context) -> bool:
    """Whether springs of what is simulated may yield."""
    return context.resolved.on(EFFECT) and any(map(yields, context.solids))


def energy_of_growth(readings: Readings) -> float:
    """Energy of springs beyond that which they would have with their first rest lengths [J]."""
    return readings.fix_scalar(FIX) if acts(readings.context) else 0.0
