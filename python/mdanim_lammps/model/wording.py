# SPDX-License-Identifier: GPL-2.0-only
"""Numbers with a unit for messages, as they may be written in a scene."""

from __future__ import annotations


def length(metres: float) -> str:
    """``0.034`` becomes ``3.4 cm``; three digits."""
    size = abs(metres)
    unit, factor = ("m", 1.0) if size >= 1 else ("cm", 100.0) if size >= 0.01 else ("mm", 1000.0)
    return f"{metres * factor:.3g} {unit}"
