# SPDX-License-Identifier: GPL-2.0-only
"""Limits of a scene: one name each, in one table, checked before the first step (docs/security.md)."""

from __future__ import annotations

from ..records import dataclass

# --- the text ---------------------------------------------------------------------------------------------

MOST_BYTES = 64 * 2**20
"""Bytes of a scene file, and of all its includes together."""
MOST_BYTES_OF_LOCK = 2**30
"""Bytes of a scene.lock.txt, which this program wrote: enough for MOST_OBJECTS."""
MOST_BYTES_OF_MESH = 2**28
"""Bytes of a mesh file: five million triangles of a binary STL."""
MOST_FILES = 1000
"""Includes of one scene."""
DEEPEST_INCLUDE = 16
DEEPEST_REPEAT = 16
DEEPEST_GROUP = 8
"""Groups that are placed inside each other."""
DEEPEST_BRACKET = 60
DEEPEST_EXPRESSION = 150
"""Steps of an expression that depend on each other."""
MOST_OBJECTS = 10**6
MOST_ROUNDS = 2 * 10**6
"""Rounds of all repeats together."""
MOST_PLACES = 10**5
"""Placed groups, those in each other counted each."""
MOST_PROBLEMS = 50
"""Problems that are shown; the rest is counted."""

# --- values -----------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Limit:
    """The values that a number of a scene may have."""

    what: str
    most: float
    """Largest magnitude, SI."""
    least: float = 0.0
    """Smallest value, SI, where a value must be positive."""
    way_out: str = "check the unit and the power of ten"


LIMITS = {
    "m": Limit("a length", 1e9, 1e-9),
    "s": Limit("a time", 1e9, 1e-15),
    "kg": Limit("a mass", 1e18, 1e-18),
    "m/s": Limit("a speed", 1e9),
    "m/s^2": Limit("an acceleration", 1e9),
    "kg/m^3": Limit("a density", 1e9, 1e-9),
    "Pa": Limit("a pressure", 1e15, 1e-9),
    "N/m": Limit("a spring constant", 1e15, 1e-9),
    "N*s/m": Limit("a drag coefficient", 1e15),
    "m^3": Limit("a volume", 1e27, 1e-27),
    "m^3/s": Limit("a flow", 1e18, 1e-18),
    "rad": Limit("an angle", 1e6),
    "rad/s": Limit("an angular speed", 1e9),
    "1/s": Limit("a rate", 1e9, 1e-9),
    "1": Limit("a plain number", 2.0**53, 1e-9),
}
"""By SI unit: what any value of that unit may be."""
MOST_PIECES = Limit("the number of pieces", 1e5, way_out="cut the object into fewer pieces")
OTHER_UNIT = Limit("a value of this unit", 1e18, 1e-18)
"""For a setting of a feature whose unit is none of these, and that says no limit of its own."""

SPEED = Limit("speed", 1e4, 1e-4, "speed 0.1 shows a second of the scene in ten seconds, speed 10 ten seconds in one")
SHADOWS = Limit("shadows", 1.0, way_out="1 is the darkest: nothing of the lamp is left in a shadow")
PIXELS = Limit("the size of a picture", 16384, way_out="the most is 16384 along a side")
MOST_COPIES = 200
"""Copies that ``freeze`` leaves behind: more would cover the picture."""
MOST_FRAMES = 10**7
"""Frames of a run: every frame has a row of the ledger in memory."""


def copies(time: float, every: float) -> int:
    """Copies that ``freeze`` leaves behind in this time, one so often [s]: the first one at once."""
    return int(time / every + 1e-9) + 1
