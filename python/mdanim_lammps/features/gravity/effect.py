# SPDX-License-Identifier: GPL-2.0-only
"""Gravity: m g on every particle, Wcislo 1999, eq. (3.8)."""

from __future__ import annotations

import numpy as np

from ...effects.context import Verdict
from ...effects.effect import Effect


class Gravity(Effect):
    """A uniform field: F = m g on every particle [N], Wcislo 1999, eq. (3.8).

    It has the potential U = -m g x [J], so all bodies fall alike, and it takes no part in the bound on the time step.
    """

    styles = (("fix", "mdanim/gravity"),)
    name = fix = "gravity"
    order = 30
    ledger = "gravity"
    has_potential = True
    if_off = "nothing falls"

    def called_for(self, scene, reach):
        span = scene.spans.get("gravity")
        if any(scene.gravity):
            return Verdict(self.name, True, "the gravity vector is not zero", span)
        return Verdict(self.name, False, "no gravity in the scene", span)

    def commands(self, context):
        x, y, z = context.scene.gravity
        return [f"fix gravity {context.pushed} mdanim/gravity {x!r} {y!r} {z!r}"]

    def acceleration(self, scene):
        return np.array(scene.gravity, float)

    def weighed(self, scene, system):
        return float((system.mass * np.abs(system.position @ np.array(scene.gravity))).sum())

    def potential(self, scene, mass, x):
        # No matrix product: the threads that it may start cost more than it. Axis by axis einsum is four times as fast.
        return -float(sum(g * np.einsum("i,i->", mass, x[:, d]) for d, g in enumerate(scene.gravity) if g))


EFFECTS = (Gravity(),)
