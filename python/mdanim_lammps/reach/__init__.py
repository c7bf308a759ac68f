# SPDX-License-Identifier: GPL-2.0-only
"""Where solids can be, until when, and how fast."""

from .acting import Acting, Bodies, Drive, Hung, Leash, Motion, Throw, by, thrower_of, thrown_within
from .reach import Reach, largest_of_others, wave_speed

__all__ = [
    "Acting",
    "Bodies",
    "Drive",
    "Hung",
    "Leash",
    "Motion",
    "Reach",
    "Throw",
    "by",
    "largest_of_others",
    "thrower_of",
    "thrown_within",
    "wave_speed",
]
