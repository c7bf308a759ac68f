# SPDX-License-Identifier: GPL-2.0-only
"""Scenes in which every effect is on, also those of features that the scene's author did not know."""

from __future__ import annotations

import re

from mdanim_lammps.features import facets
from mdanim_lammps.scene.keywords import KEYWORDS

ELSEWHERE = {"air", "drives", "inflate", "joint", "pieces", "rigid", "tearing", "yielding"}
"""Effects that cannot be on beside all others: the contact of the paper and the drag of a liquid refuse rigid objects
(tests/effects/test_rigid_at_work.py), what is driven needs a hold (tests/effects/test_drives_at_work.py), a joint and air need
a block (tests/effects/test_joints_at_work.py, test_air_at_work.py), tearing a rope (tests/effects/test_tearing_at_work.py), gas a
closed sheet (tests/effects/test_inflate_at_work.py), pieces a rigid object without liquid or air
(tests/effects/test_pieces_at_work.py); where springs yield there are no passes (test_yielding_at_work.py)."""


def with_every_effect(text: str) -> str:
    """A scene with the word that calls for each effect, by the word's own example where the text has it not: one of objects in
    the first object behind its elasticity, one outside of all blocks in the first line. No line is added."""
    for word in missing(text):
        if word in KEYWORDS["object"]:
            text = re.sub(r"(elasticity \S+( [kM]Pa)?)", rf"\1 {word} {KEYWORDS['object'][word].example}", text, count=1)
        else:
            first, end, rest = text.partition("\n")
            text = f"{first} {word} {KEYWORDS[''][word].example}{end}{rest}"
    return text


def missing(text: str) -> list[str]:
    """Settings that call for effects, and that a text has not."""
    causes = (cause for words in facets("words") for cause in words.SWITCHES.values())
    named = (found[1] for cause in causes if (found := re.search(r"`([a-z-]+)`", cause)))
    known = {*KEYWORDS["object"], *KEYWORDS[""]}
    return [
        word for word in dict.fromkeys(named) if word in known and not re.search(rf"^\s*{word} | {word} ", text, re.MULTILINE)
    ]
