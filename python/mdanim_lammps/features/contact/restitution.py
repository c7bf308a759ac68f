# SPDX-License-Identifier: GPL-2.0-only
"""Restitution as damping: the speed after a blow of two rigid bodies over the speed before it.

A contact is a spring with a dashpot, the share beta of critical damping. Half a period after it began the speed is

    e = exp(-pi beta / sqrt(1 - beta^2)),    so    beta = -ln e / sqrt(pi^2 + ln^2 e).

Contacts do not pull, so a blow ends sooner, and dashpots lag behind by a step: docs/physics-rigid.md, "Restitution", has what
comes out.
"""

from __future__ import annotations

import math


def damping_for(restitution: float) -> float:
    """Share of critical damping of a contact [-] for a coefficient of restitution from 0 to 1."""
    if restitution == 0.0:
        return 1.0
    return -math.log(restitution) / math.hypot(math.pi, math.log(restitution)) + 0.0  # not -0
