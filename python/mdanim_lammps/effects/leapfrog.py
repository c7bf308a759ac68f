# SPDX-License-Identifier: GPL-2.0-only
"""Drag that the leap-frog takes, Wcislo 1999, eq. (3.9): what the effects that bring some have in common."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .fields import column
from .readings import LEAPFROG, Readings

if TYPE_CHECKING:
    from .effect import Effect

LAMBDA = column("lambda", "N s/m")
"""The coefficient that the leap-frog takes, of all effects together; at the start `Context.drag`."""
DRAG_LOSS = "drag_loss"
"""Column of the ledger; the leap-frog counts what all drag takes together."""
SLOWING = 0.3
"""Part of the leap-frog's time for a particle that goes to its drag (bench/effects.py shares)."""


def drag_loss(effect: Effect, readings: Readings) -> dict[str, float]:
    """The column of the ledger [J]: the first effect with drag tells what all have taken, others 0."""
    if _first(readings) is not effect:
        return {DRAG_LOSS: 0.0}
    context = readings.context
    others = sum(e.drag_taken(readings) for e in context.resolved.effects if e.acts_on(context))
    return {DRAG_LOSS: readings.fix_scalar("leapfrog") + others}


def drag_seconds(effect: Effect, readings: Readings) -> dict[str, float]:
    """Wall seconds of drag in the leap-frog, told by the first effect with drag: by the particles that feel any now, after a run
    mostly at rest."""
    if _first(readings) is not effect:
        return {}
    free = ~readings.system.held
    more = SLOWING / (1.0 - SLOWING) * np.count_nonzero(readings.array("d_lambda")[free]) / max(1, np.count_nonzero(free))
    return {LEAPFROG: more / (1.0 + more) * readings.fix_seconds("leapfrog")}


def _first(readings: Readings) -> Effect | None:
    context = readings.context
    brings = (e for e in context.resolved.effects if DRAG_LOSS in e.losses(context.scene) and e.acts_on(context))
    return next(brings, None)
