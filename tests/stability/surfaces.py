# SPDX-License-Identifier: GPL-2.0-only
"""The hard cases in which something touches, with ``contact-model surface``: the same scenes, and limits but for those here."""

from __future__ import annotations

from dataclasses import replace

import contacts
import solids
from case import Case

TOUCHING = [*contacts.CASES, *(c for c in solids.CASES if c.name.startswith("weight")), solids.ROTATED]
CHANGED: dict[str, tuple[dict[str, float], str]] = {
    "impact at 0.2 c": ({"overlap of the surfaces / h": 0.25}, "a surface is softer at first than the full reach of a barrier"),
    "impact at 0.5 c": (
        {"energy drift": 2e-3},
        "all points of two equal faces meet in one step; leap-frog follows so sudden a force to 2e-3",
    ),
    "touching at t = 0": (
        {"parting speed / c": 1e-12, "still within reach / h": 0.6 + 1e-9},
        "objects that touch at the start have no stress, and stay",
    ),
    "corner on corner at 0.2 c": (
        {"energy drift": 1.5e-2, "not handed over": 0.25},
        "corners that are exactly on one line press their own cells flat; the energy of the released "
        "contacts is reported (`let_go`), but lost to the motion. The energy is 9e-3 off at this step, 5e-3 off at half of it",
    ),
    "weight of 0.05 E on its foot": (
        {"below the ground / h": 0.08},
        "ground gives way by load times h and by the onset of 0.025 h",
    ),
    "weight of 0.5 E on its foot": (
        {"below the ground / h": 2.5},
        "beyond 0.2 E a lattice is crushed, and deeper here; `check` warns",
    ),
}
"""Other limits, and why."""
FRICTION = ("tower of 3",)
"""Cases that need friction: cubes that slide do not stand on each other."""
STANDING = {"overlap of the surfaces / h": 0.05}
HEAVY = "1000 times as dense, at rest, 0.02 E"
HEAVY_BOTTOM = 3.93
"""Height of its bottom on the surface, which is not that over a barrier."""


def at_surfaces(case: Case) -> Case:
    """The case with the other law of contact."""
    words = "contact-model surface friction 0.5" if case.name.startswith(FRICTION) else "contact-model surface"
    most, why = CHANGED.get(case.name, ({}, case.why))
    if case.name.startswith(FRICTION):
        most, why = STANDING, "friction holds it; surfaces touch"
    return replace(case, scene=case.scene.replace("contact-model paper", words), most={**case.most, **most}, why=why)


CASES = [at_surfaces(contacts.heavy_on_slab(0.02, HEAVY_BOTTOM) if case.name == HEAVY else case) for case in TOUCHING]
