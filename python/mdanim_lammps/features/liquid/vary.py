# SPDX-License-Identifier: GPL-2.0-only
"""The sweeps of the automaton, for studies."""

from __future__ import annotations

from dataclasses import replace

from ...effects.varied import Varied
from .frames import is_wavy


class SweepCount(Varied):
    """Sweeps of the automaton per update."""

    name, letter, order, color = "sweeps", "s", 10, "#2ca02c"
    usual, word = None, "sweeps"

    def of(self, scene):
        return scene.liquid.sweeps if scene.liquid else None

    def put(self, scene, value):
        return replace(scene, liquid=replace(scene.liquid, sweeps=value)) if scene.liquid else scene

    def said(self, scene):
        return self.of(scene) is not None

    def why_not(self, context):
        return "no automaton" if context.grid is None or is_wavy(context.scene) else ""

    def ladder(self, value):
        return (1, 2, 4, 8, 16)

    def size(self, value):
        return 1.0 / value

    def told(self, value, number=str):
        return "" if value is None else f", {value} sweep{'' if value == 1 else 's'}"


VARIED = (SweepCount(),)
