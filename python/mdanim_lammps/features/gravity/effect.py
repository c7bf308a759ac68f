# SPDX-License-Identifier: GPL-2.0-only
"""Gravity: m g on every particle, Wcislo 1999, eq. (3.8); g may change with time."""

from __future__ import annotations

import numpy as np

from ...effects.context import Verdict
from ...effects.effect import Effect
from ...effects.facets import StandardSteps
from ...scene.in_time import integral, vector_at


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

    def of(self, scene):
        return ChangingGravity() if scene.gravity_path else self

    def called_for(self, scene, reach):
        span = scene.spans.get("gravity")
        if any(any(g) for _, g in scene.gravity_path):
            return Verdict(self.name, True, f"gravity changes, through {len(scene.gravity_path)} points", span)
        if any(scene.gravity):
            return Verdict(self.name, True, "the gravity vector is not zero", span)
        return Verdict(self.name, False, "no gravity in the scene", span)

    def commands(self, context):
        x, y, z = context.scene.gravity
        return [f"fix gravity {context.pushed} mdanim/gravity {x!r} {y!r} {z!r}"]

    def acceleration(self, scene):
        return np.array(scene.gravity, float)

    def impulses(self, scene, mass, times, center):
        return mass[:, None] * (times[:, None] * np.array(scene.gravity, float))[:, None]

    def weighed(self, scene, system):
        return float((system.mass * np.abs(system.position @ np.array(scene.gravity))).sum())

    def potential(self, scene, mass, x):
        # No matrix product: the threads that it may start cost more than it. Axis by axis einsum is four times as fast.
        return -float(sum(g * np.einsum("i,i->", mass, x[:, d]) for d, g in enumerate(scene.gravity) if g))


GRAVITY_WORK = "gravity_work"
"""Column of the ledger: work that a gravity that changes has done."""


class ChangingGravity(StandardSteps, Gravity):
    """The same with g(t), straight from point to point of a path [m/s^2].

    A field that changes has no energy that is conserved: its work, the integral of sum m g(t) v dt, is counted step by step and
    comes from outside, W = sum_n dt (g_n + g_{n+1})/2 P^{n+1/2} with P = sum m v (plugin/gravity/law.h).
    """

    ledger = ""
    has_potential = False

    def of(self, scene):
        return self

    def commands(self, context):
        points = " ".join(f"{t!r} {x!r} {y!r} {z!r}" for t, (x, y, z) in context.scene.gravity_path)
        return [f"fix gravity {context.pushed} mdanim/gravity path {points}"]

    def accelerations(self, scene):
        end = scene.control.time
        points = [g for t, g in scene.gravity_path if 0.0 < t < end]
        points += [vector_at(scene.gravity_path, t) for t in (0.0, end)]
        return np.min(points, axis=0), np.max(points, axis=0)

    def swing(self, scene):
        times = np.array([0.0, *(t for t, _ in scene.gravity_path if 0.0 < t < scene.control.time), scene.control.time])
        g = np.array([vector_at(scene.gravity_path, t) for t in times])
        g[:, 2] = np.maximum(g[:, 2], 0.0)  # falls are counted by their heights
        gained = np.cumsum(0.5 * (g[1:] + g[:-1]) * np.diff(times)[:, None], axis=0)
        return float(np.linalg.norm(np.ptp(np.concatenate([np.zeros((1, 3)), gained]), axis=0)))

    def impulses(self, scene, mass, times, center):
        return mass[:, None] * np.array(integral(scene.gravity_path, times))[:, None]

    def weighed(self, scene, system):
        low, high = self.accelerations(scene)
        return float((system.mass * (np.abs(system.position) @ np.maximum(np.abs(low), np.abs(high)))).sum())

    def sources(self, scene):
        return (GRAVITY_WORK,)

    def lost(self, readings):
        return {GRAVITY_WORK: readings.fix_value(self.fix, "work")}


EFFECTS = (Gravity(),)
