# SPDX-License-Identifier: GPL-2.0-only
"""Restitution as damping: the speed after a blow of two rigid bodies over the speed before it.

The dashpot of a contact, beta times critical damping, follows force F and energy U of its spring as F/sqrt(2 U)
(plugin/rigid/touch.cpp). Over s = sqrt(2 U/m) the speed in a blow then is that of a linear spring, s'' = -s - 2 beta s' in its
own unit of time, whatever the force: as much is left of slow blows as of fast ones. Contacts do not pull, so the blow ends where
s'' = 0:

    e = exp(-beta (pi - 2 asin(beta)) / sqrt(1 - beta^2)),    exp(-2) at beta = 1
"""

from __future__ import annotations

import math

MOST = 1.0
"""Largest share of critical damping, which leaves 0.135: beyond it steps of 0.35/Omega scatter what is left."""


def left_after(damping: float) -> float:
    """Restitution [-] of a contact with this share of critical damping, from 0 to 1."""
    if damping >= MOST:
        return math.exp(-2.0)
    return math.exp(-damping * (math.pi - 2.0 * math.asin(damping)) / math.sqrt(1.0 - damping * damping))


def damping_for(restitution: float) -> float:
    """Share of critical damping of a contact [-], at most MOST, for a coefficient of restitution from 0 to 1."""
    low, high = 0.0, MOST
    if restitution >= 1.0 or restitution <= left_after(high):
        return low if restitution >= 1.0 else high
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if left_after(middle) > restitution else (low, middle)
    return 0.5 * (low + high)
