# SPDX-License-Identifier: GPL-2.0-only
"""Names of pieces."""

from __future__ import annotations


def piece_name(whole: str, number: int) -> str:
    """``glass.piece[3]`` of piece 2, from 0."""
    return f"{whole}.piece[{number + 1}]"
