# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from ...scene.schema import Observable

SWITCHES = {"springs": "an object that is not all held"}

QUANTITIES = {
    ("NAME", "strain.max"): Observable("1", "largest relative change of length of a spring"),
    ("NAME", "elastic"): Observable("J", "energy of the springs of an object"),
    ("NAME", "stress.max"): Observable("Pa", "largest stress of a particle of an object, that of von Mises"),
    **{
        ("NAME", f"stress.{axis}"): Observable(
            "Pa", f"mean stress of an object along {axis}, by its springs; pressure is below 0"
        )
        for axis in "xyz"
    },
}

MARGINS = {
    "amplitude": "the speed of a hit over the wave speed of the object; above about 0.2 a soft object stays crumpled",
    "load": "the pressure at the foot of what stands at the start, beside the strength 0.2 E at which it is crushed",
    "thinnest part": "cells across the thinnest part; one cell is 1.9 times too stiff in bending, two are not",
}
