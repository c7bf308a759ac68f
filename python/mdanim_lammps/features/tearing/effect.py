# SPDX-License-Identifier: GPL-2.0-only
"""Springs that break, by ``fix mdanim/tear`` (docs/physics-ropes.md, "Tearing")."""

from __future__ import annotations

import random

import numpy as np

from ...effects.context import Verdict
from ...effects.effect import Effect
from ...effects.fields import column
from .gone import EFFECT, FIX, NAME, acts
from .words import tears

LIMIT = column("tear_limit", "m", per="bond")
"""Length at which a spring is gone, or of a spring over two links, the first of these; 0 for never."""
SECOND = column("tear_second", "m", per="bond")
"""Length of the second link at which a spring over two links is gone; 0 of other springs."""
STORED = column("tear_stored", "J", per="bond")
"""Energy of a spring in the body without load."""
REST = column("tear_rest", "1", per="bond", shape=(3,))
"""Remainder along a link of a spring over it and one that is gone: constant [N/m], length [m], energy in the body without
load [J]; zeros of other springs."""
TORN = column(NAME, "1", per="bond", state=True)
"""1 for a spring that is gone."""
MORE = 1.25
"""Strain that links bear over that of the weakest one. Links that were all alike broke together: a cord of 100 links from which a
ball fell came apart in 52 pieces."""
LOST = "torn"
"""Column of the ledger: energy of springs that broke."""


class Tearing(Effect):
    """A spring is gone from the step on in which r^2 > (1 + e)^2 r0^2 (docs/physics-ropes.md, "Tearing")."""

    styles = (("fix", "mdanim/tear"),)
    name, fix = EFFECT, FIX
    order = 11
    needs = ("springs",)
    if_off = "ropes never tear"

    def called_for(self, scene, reach):
        for solid in scene.solids:
            if tears(solid):
                return Verdict(self.name, True, f"{solid.name} has a tear-strain", solid.spans.get("tear-strain"))
        return Verdict(self.name, False, "no object has a tear-strain")

    def acts_on(self, context):
        return acts(context)

    def columns(self, context):
        system, springs = context.system, len(context.system.spring)
        found = {field: np.zeros((springs, *field.shape)) for field in (LIMIT, SECOND, REST, TORN)}
        for m, solid in enumerate(context.solids):
            if tears(solid):
                own = slice(*np.searchsorted(system.spring[:, 0], system.first[m : m + 2]))
                i, j = system.spring[own].T - system.first[m]
                link, length = j - i == 1, system.unloaded[own]
                limit = limits(solid, context.scene.control.seed, length[link])
                found[LIMIT][own], found[SECOND][own] = limit[i], np.where(link, 0.0, limit[j - 1])
                if not link.all():
                    k, r0 = constants(system, own, ~link)
                    stored = 0.5 * k * (length[link] - r0) ** 2
                    found[REST][own][link] = np.stack([np.full(len(stored), k), np.full(len(stored), r0), stored], axis=1)
        return {**found, STORED: system.preload_energy}

    def commands(self, context):
        words = " ".join(
            f"{w} d2_{c.name}"
            for w, c in (("limit", LIMIT), ("second", SECOND), ("stored", STORED), ("rest", REST), ("torn", TORN))
        )
        return [f"fix {self.fix} all mdanim/tear {words}"]

    def losses(self, scene):
        return (LOST,)

    def lost(self, readings):
        return {LOST: readings.fix_value(self.fix, "energy")}

    def clocks(self, readings):
        return {self.name: readings.fix_seconds(self.fix)}


def constants(system, own: slice, over: np.ndarray) -> tuple[float, float]:
    """Constant [N/m] and length [m] of what remains along a link of a spring over two links: twice that of the spring, and half
    of its length; those ``over`` two links are all alike in a rope."""
    k, r0 = system.stiffness[own][over], system.rest[own][over]
    return 2.0 * float(k[0]), 0.5 * float(r0[0])


def limits(solid, seed: int, length: np.ndarray) -> np.ndarray:
    """Lengths at which the links of a rope are gone [m], from those without load, shape (L,): one link, which the seed and the
    name of the rope choose, bears e, and the others MORE e. As no rope is alike everywhere, it tears in one place."""
    strain = np.full(len(length), MORE * solid.tear_strain)
    strain[random.Random(f"{seed} {solid.name}").randrange(len(length))] = solid.tear_strain
    return (1.0 + strain) * length


EFFECTS = (Tearing(),)
