# SPDX-License-Identifier: GPL-2.0-only
"""The quantities that a scene asks for: which of them a run has to look at while it goes on, and their values at all frames."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache

import numpy as np

from ..effects.measured import Measurable, Measured, Of, Recorded
from ..errors import Problem
from ..features import facets
from ..scene.scene import SceneRecord


@lru_cache(maxsize=1)
def _catalogue() -> dict[tuple[str, str], Measurable]:
    own = {("energy", "residual"): Measurable(lambda m, of: m.ledger("residual"), Measured.largest)}
    return own | {of: found for facet in facets("measure") for of, found in getattr(facet, "MEASURES", {}).items()}


def quantity_of(of: Of) -> Measurable:
    """How a quantity is found."""
    return _catalogue()[of.key]


def series(of: Of, measured: Measured) -> np.ndarray:
    """Its values at all frames, in SI units, shape (F,); NaN where there is none."""
    return np.asarray(quantity_of(of).series(measured, of), float)


def recorded(asked: Iterable[Of]) -> dict[str, tuple[str, Recorded]]:
    """Quantities that a run has to look at in every frame, once each: their columns of the ledger, with the objects."""
    found = ((of, quantity_of(of)) for of in asked)
    return {quantity.column_of(of): (of.subject, quantity) for of, quantity in found if isinstance(quantity, Recorded)}


def unmeasured(scene: SceneRecord, asked: Iterable[Of]) -> list[Problem]:
    """A problem for each quantity that frames do not tell."""
    asked = list(asked)
    return [one for facet in facets("measure") if hasattr(facet, "unmeasured") for one in facet.unmeasured(scene, asked)]
