# SPDX-License-Identifier: GPL-2.0-only
"""Quantities of yielding that ``expect`` can ask for."""

from __future__ import annotations

import numpy as np

from ...effects.measured import Glance, Measured, Recorded
from .bends import strain
from .grown import grown_of


def share(g: Glance) -> float:
    """Largest growth of a length of an object, either way, over the first one, or strain of its faces by what is bent [-]."""
    system = g.context.system
    first = system.unloaded[system.springs_of(g.solid)]
    grown = float(np.abs(grown_of(system, g.solid, g.fields) / first).max(initial=0.0))
    return max(grown, strain(g.context, g.solid, g.fields))


MEASURES = {("NAME", "yielded"): Recorded("yielded", share, Measured.largest)}
