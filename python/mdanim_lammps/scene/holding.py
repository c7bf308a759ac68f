# SPDX-License-Identifier: GPL-2.0-only
"""Which objects are held, and for how long."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any

from ..features import facets
from .shapes import holds_all


def lets_go(solid: Any) -> bool:
    """Whether what is held of an object moves by forces later on: a module ``words`` may have a function `lets_go` that says
    so."""
    return any(asked(solid) for asked in _asked())


def all_held(solid: Any) -> bool:
    """Whether no particle of an object ever moves by forces."""
    return holds_all(solid.hold) and not lets_go(solid)


@lru_cache(maxsize=1)
def _asked() -> tuple[Callable[[Any], bool], ...]:
    return tuple(words.lets_go for words in facets("words") if hasattr(words, "lets_go"))
