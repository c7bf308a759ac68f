# SPDX-License-Identifier: GPL-2.0-only
"""The lulls of the wind, for studies."""

from dataclasses import replace

from mdanim_lammps.effects.varied import Varied


class Lulls(Varied):
    """``lulls``: how many times the wind is looked up."""

    name, letter, order, color = "lulls", "w", 30, "#000000"
    usual, word = 1, "lulls"

    def of(self, scene):
        return scene.lulls

    def put(self, scene, value):
        return replace(scene, lulls=value)

    def said(self, scene):
        return scene.lulls != 1

    def why_not(self, context):
        return "" if context.on("wind") else "no wind"

    def ladder(self, value):
        return (1, 2, 4)

    def size(self, value):
        return 1.0 / value


VARIED = (Lulls(),)
