# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from ...scene.schema import Observable

SWITCHES = {
    "basin": "the basin of a liquid and an object that can move",
    "liquid": "`liquid`",
    "buoyancy": "a liquid that an object can reach",
    "liquid-drag": "a liquid that an object can reach",
}

QUANTITIES = {
    ("NAME", "draft"): Observable("m", "immersed depth of an object, from the surface to its lowest point", "liquid"),
    ("NAME", "immersed"): Observable("1", "share of an object's volume below the surface", "liquid"),
    ("liquid", "volume"): Observable("m^3", "volume of the liquid", "liquid"),
    ("liquid", "residual"): Observable("1", "cells gained or lost, to the unit", "liquid"),
    ("liquid", "level"): Observable("m", "mean height of the surface", "liquid"),
    ("liquid", "crest"): Observable("m", "highest point of the liquid at any frame, without drops", "liquid"),
    ("liquid", "waves"): Observable(
        "J", "energy of waves, of height and motion, since the start; 0 without `model waves`", "liquid"
    ),
}

MARGINS = {
    "sweeps": "how often the liquid is swept while an object travels one cell; below 4 it is pushed up before it can flow away"
}


def touched(scene) -> bool:
    """Whether it brings something into a scene that objects may touch."""
    return scene.liquid is not None


def width(scene) -> tuple[float, str] | None:
    """What a scene without objects goes by: an eighth of the basin's narrower side [m], so that a balanced basin is 32 cells,
    and its name."""
    if scene.liquid is None:
        return None
    return min(b - a for a, b in zip(scene.liquid.low[:2], scene.liquid.high[:2])) / 8, scene.liquid.name
