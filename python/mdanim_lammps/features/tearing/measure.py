# SPDX-License-Identifier: GPL-2.0-only
"""Quantities of tearing that ``expect`` can ask for."""

from __future__ import annotations

import numpy as np

from ...effects.measured import Glance, Recorded
from .gone import gone_of


def share(g: Glance) -> float:
    """Share of the springs of an object that are gone [-]."""
    gone = gone_of(g.context.system, g.solid, g.fields)
    return float(gone.mean()) if len(gone) else 0.0


def pieces(g: Glance) -> int:
    """Parts of an object that springs hold together; particles without any are parts, too."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    system, first = g.context.system, g.context.system.first
    kept = system.spring[system.springs_of(g.solid)][~gone_of(system, g.solid, g.fields)] - first[g.solid]
    size = int(first[g.solid + 1] - first[g.solid])
    joined = coo_matrix((np.ones(len(kept)), tuple(kept.T)), shape=(size, size))
    return int(connected_components(joined, directed=False)[0])


MEASURES = {("NAME", "torn"): Recorded("torn", share), ("NAME", "pieces"): Recorded("pieces", pieces)}
