# SPDX-License-Identifier: GPL-2.0-only
"""A scene at its time step, before the first step: the values that are compared with limits."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cached_property

import numpy as np

from ..errors import Span
from ..model.shapes import thickness
from ..scene.formatting import say
from .context import Context
from .margin import Margin


class Envelope:
    """Bounds that a scene may reach at a time step, before the first step."""

    def __init__(self, context: Context, rates: Mapping[str, np.ndarray], timestep: float):
        self.context, self.scene, self.system, self.reach = context, context.scene, context.system, context.reach
        self.on, self.planes = context.resolved.effects, context.reach.acting.planes
        self.rates, self.dt = rates, timestep
        """``rates`` are the shares of effects in the bound, by name [1/s^2], each of shape (N,)."""

    def own_step(self, name: str, rate: np.ndarray) -> list[Margin]:
        """Margin of the time step that a single effect would bear, by its share in the bound [1/s^2], shape (N,)."""
        free = np.where(self.system.held, 0.0, rate)
        if not free.any():
            return []
        i = int(np.argmax(free))
        m = int(self.system.object[i])
        alone = 2.0 / math.sqrt(free[i])
        return [
            Margin(
                name,
                self.system.names[m],
                self.dt,
                alone,
                "s",
                f"{name} alone would bear a time step of {say(alone, 's')} at {self.system.names[m]}",
                self.place(m, "elasticity"),
                "refused" if self.dt > alone * (1.0 + 1e-12) else "ok",
                hint="write 'timestep auto'",
            )
        ]

    def place(self, m: int, *keywords: str) -> Span | None:
        """Place of the first of these keywords of a solid; its name where there is none."""
        spans = self.scene.solids[m].spans
        return next((spans[k] for k in (*keywords, "object") if k in spans), None)

    @cached_property
    def cells(self) -> np.ndarray:
        """Cells across the thinnest part of each solid [-], shape (M,)."""
        system, known = self.system, {}
        thin = np.array(
            [known[s.shape] if s.shape in known else known.setdefault(s.shape, thickness(s.shape)) for s in self.scene.solids]
        )
        return thin / np.cbrt(system.cell_volume)
