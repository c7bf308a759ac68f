# SPDX-License-Identifier: GPL-2.0-only
"""Gravity: m g on every particle, Wcislo 1999, eq. (3.8)."""

from __future__ import annotations

import numpy as np

from .effect import Effect, Verdict


class Gravity(Effect):
    name = "gravity"
    ledger = "gravity"
    lost = "nothing falls"

    def called_for(self, scene):
        span = scene.spans.get("gravity")
        if any(scene.gravity):
            return Verdict(self.name, True, "the gravity vector is not zero", span)
        return Verdict(self.name, False, "no gravity in the scene", span)

    def commands(self, scene, system):
        g = np.array(scene.gravity)
        x, y, z = scene.gravity
        return [f"fix gravity mobile gravity {float(np.linalg.norm(g))!r} vector {x!r} {y!r} {z!r}"]

    def energy(self, instance, scene, system):
        return -float(system.mass @ (instance.array("x") @ np.array(scene.gravity)))
