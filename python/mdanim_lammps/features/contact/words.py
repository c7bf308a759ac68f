# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from ...scene.schema import Observable

SWITCHES = {"contact": "two objects that can meet"}

QUANTITIES = {("penetration", "max"): Observable("m", "deepest overlap of two objects", bound=True)}

MARGINS = {
    "contact": "the time step that contact alone would bear, by its largest curvature over a plane (an estimate)",
    "wall": "the time step that ground, walls and basin alone would bear",
    "closing speed": "how fast objects may meet so that nothing passes through; softer or thinner objects bear less",
}
