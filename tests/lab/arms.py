# SPDX-License-Identifier: GPL-2.0-only
"""Arms of vessels that a duct joins, by potential flow."""

from __future__ import annotations

import numpy as np


def inertia_of_arm(above: float, opening: float, wide: float, terms: int = 4000) -> float:
    """Inertia of the liquid in an arm over its density, for a flux of 1 per depth that comes in below a wall.

    The duct is `opening` high and at the floor, liquid stands `above` its roof, and the arm is `wide`; flow through the mouth is
    even. The potential is 0 at the surface: a sum of cos(k z) cosh(k x), k = (n + 1/2) pi over the depth.
    """
    depth = above + opening
    k = (np.arange(terms) + 0.5) * np.pi / depth
    return float((2.0 * (np.sin(k * opening) / (k * opening)) ** 2 / np.tanh(k * wide) / (depth * k)).sum())
