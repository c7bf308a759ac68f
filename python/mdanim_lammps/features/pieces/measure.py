# SPDX-License-Identifier: GPL-2.0-only
"""Quantities of pieces that ``expect`` can ask for."""

from __future__ import annotations

import numpy as np

from ...effects.measured import Measurable, Measured, Of
from ...scene.naming import objects_by_name
from .effect import BORE, WHOLE


def parts(m: Measured, of: Of) -> np.ndarray:
    """Parts of an object with pieces that hang together, at all frames, shape (F,)."""
    own = objects_by_name(m.names)[of.subject]
    return np.array([float(len(np.unique(m.trajectory.field(WHOLE, frame)[own]))) for frame in range(len(m.times))])


def stress(m: Measured, of: Of) -> np.ndarray:
    """Largest stress that glue of an object bore so far, at all frames [Pa], shape (F,)."""
    own = objects_by_name(m.names)[of.subject]
    return np.array([float(m.trajectory.field(BORE, frame)[own].max()) for frame in range(len(m.times))])


MEASURES = {("NAMES", "pieces"): Measurable(parts), ("NAMES", "stress.max"): Measurable(stress)}
