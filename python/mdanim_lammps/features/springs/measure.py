# SPDX-License-Identifier: GPL-2.0-only
"""Quantities of springs that ``expect`` can ask for."""

from __future__ import annotations

import numpy as np

from ...effects.measured import Glance, Measured, Recorded
from ...model.system import System
from ..tearing.gone import gone_of


def largest_strain(system: System, solid: int, position: np.ndarray, gone: np.ndarray | None = None) -> float:
    """Largest |r/r0 - 1| of the springs of a solid [-], for particle positions [m], shape (N, 3); r0 is the length in the body
    without load. Those that are ``gone`` do not count, bool, in the order of the solid's springs."""
    low, high = np.searchsorted(system.spring[:, 0], system.first[solid : solid + 2])
    kept = np.arange(low, high) if gone is None else np.arange(low, high)[~gone]
    if not len(kept):
        return 0.0
    i, j = system.spring[kept].T
    r = np.linalg.norm(position[i] - position[j], axis=1)
    return float(np.abs(r / system.unloaded[kept] - 1.0).max())


def _look(g: Glance) -> float:
    return largest_strain(g.context.system, g.solid, g.position, gone_of(g.context.system, g.solid, g.fields))


RECORDED = {"strain.max": Recorded("strain", _look, Measured.largest)}
