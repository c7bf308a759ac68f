# SPDX-License-Identifier: GPL-2.0-only
"""Quantities of yielding that ``expect`` can ask for."""

from __future__ import annotations

import numpy as np

from ...effects.measured import Glance, Measured, Recorded
from .grown import grown_of


def share(g: Glance) -> float:
    """Largest growth of a rest length of an object, either way, over the first one [-]."""
    system = g.context.system
    rest = system.rest[system.springs_of(g.solid)]
    return float(np.abs(grown_of(system, g.solid, g.fields) / rest).max(initial=0.0))


MEASURES = {("NAME", "yielded"): Recorded("yielded", share, Measured.largest)}
