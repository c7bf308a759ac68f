# SPDX-License-Identifier: GPL-2.0-only
"""How much of a campaign is run: ``MDANIM_CAMPAIGN=0.1`` is a tenth of its long form, 10 is ten times as much."""

from __future__ import annotations

import os

SCALE = "MDANIM_CAMPAIGN"


def rounds(most: int) -> int:
    """How many rounds of a campaign that has ``most`` in `make soak`."""
    return max(1, round(most * float(os.environ.get(SCALE, "1"))))
