# SPDX-License-Identifier: GPL-2.0-only
"""Names of pieces."""

from __future__ import annotations

from typing import Any

from ...scene.naming import PIECE


def seed_of(v: Any, name: str) -> str:
    """Gives the seed that the pieces of an object follow from; v is the scene/validate.Validator."""
    control = v.blocks("control")
    return f"{control[0].value('seed', 1):.0f} {name}" if control else f"1 {name}"


def piece_name(whole: str, number: int) -> str:
    """``glass.piece[3]`` of piece 2, from 0."""
    return f"{whole}{PIECE}{number + 1}]"
