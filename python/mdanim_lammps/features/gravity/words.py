# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from __future__ import annotations

from ...scene.in_time import InTime
from ...scene.schema import Observable, Vector, setting

SWITCHES = {"gravity": "a gravity vector that is not zero"}

QUANTITIES = {
    ("NAME", "weight"): Observable("N", "magnitude of the weight of an object"),
    ("NAME", "potential"): Observable("J", "potential energy of an object in gravity, 0 at the start"),
    **{("NAME", f"weight.{axis}"): Observable("N", f"weight of an object, mass times gravity, {axis}") for axis in "xyz"},
}


class GravityWords:
    """Settings outside of all blocks."""

    gravity: Vector = setting(
        "[at <T:s>] <(gx, gy, gz):m/s^2>",
        "Acceleration of free fall. Absent or zero: no gravity effect at all. With a liquid it must point along -z. Several "
        "lines with times T make it change: straight from each to the next, and as it was given first and last before and "
        "after; not with a liquid.",
        "(0, 0, -9.81) m/s^2", default=(0.0, 0.0, 0.0), many=True, also=("gravity_path",),
        codec=InTime("gravity", "at 1 s (0, 0, -9.81) m/s^2"))  # fmt: skip
    """The acceleration at the start [m/s^2]."""
    gravity_path: tuple[tuple[float, Vector], ...] = ()
    """Points (T, g) between which it changes [s, m/s^2]; empty where it does not."""


SCENE = GravityWords
