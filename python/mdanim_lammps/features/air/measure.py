# SPDX-License-Identifier: GPL-2.0-only
"""How the force of the air is measured for ``expect``."""

from __future__ import annotations

import numpy as np

from ...effects.measured import Measurable, Measured, Of
from .effect import FORCE


def force(m: Measured, of: Of) -> np.ndarray:
    """[N], shape (F,)."""
    n = m.solid(of.subject)
    return np.array([float(np.linalg.norm(m.trajectory.field(FORCE, frame)[n])) for frame in range(len(m.times))])


MEASURES = {("NAME", "air.force"): Measurable(force)}
