# SPDX-License-Identifier: GPL-2.0-only
"""Quantities of springs that ``expect`` can ask for."""

from __future__ import annotations

import numpy as np

from ...effects.measured import Measured, Recorded
from ...model.system import System


def largest_strain(system: System, solid: int, position: np.ndarray) -> float:
    """Largest |r/r0 - 1| of the springs of a solid [-], for particle positions [m], shape (N, 3); r0 is the length in the body
    without load."""
    low, high = np.searchsorted(system.spring[:, 0], system.first[solid : solid + 2])
    i, j = system.spring[low:high].T
    if not len(i):
        return 0.0
    r = np.linalg.norm(position[i] - position[j], axis=1)
    return float(np.abs(r / system.unloaded[low:high] - 1.0).max())


RECORDED = {"strain.max": Recorded("strain", lambda g: largest_strain(g.context.system, g.solid, g.position), Measured.largest)}
