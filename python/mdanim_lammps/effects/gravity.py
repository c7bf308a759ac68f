# SPDX-License-Identifier: GPL-2.0-only
"""Gravity: m g on every particle, Wcislo 1999, eq. (3.8)."""

from __future__ import annotations

import numpy as np

from .effect import Effect, Verdict


class Gravity(Effect):
    name = fix = "gravity"
    ledger = "gravity"
    has_potential = True
    if_off = "nothing falls"

    def called_for(self, scene, planes=None):
        span = scene.spans.get("gravity")
        if any(scene.gravity):
            return Verdict(self.name, True, "the gravity vector is not zero", span)
        return Verdict(self.name, False, "no gravity in the scene", span)

    def commands(self, scene, system):
        x, y, z = scene.gravity
        return [f"fix gravity mobile mdanim/gravity {x!r} {y!r} {z!r}"]

    def pull(self, scene):
        return max(0.0, -scene.gravity[2])

    def potential(self, scene, mass, x):
        # No matrix product: the threads that it may start cost more than it. Axis by axis einsum is four times as fast.
        return -float(sum(g * np.einsum("i,i->", mass, x[:, d]) for d, g in enumerate(scene.gravity) if g))
