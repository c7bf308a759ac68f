# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to air."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field

from ...errors import Span
from ...records import dataclass
from ...scene.in_time import InTime
from ...scene.schema import Block, Observable, Rule, Vector, setting

SWITCHES = {"air": "an `air` block"}

QUANTITIES = {("NAME", "air.force"): Observable("N", "size of the force of the air on an object, by drag, wind and lift", "air")}

LEDGER = {
    "air_loss": "what the air has taken so far: its force times the velocity of the air relative to each surface [J]",
    "work": "what the wind has brought in so far: its velocity times the force of the air [J]",
}
"""Columns of the ledger."""


@dataclass(frozen=True, slots=True)
class AirBlock:
    """The air of a scene."""

    density: float = setting(
        "<rho:kg/m^3>", "Density of the air.", "1.2 kg/m^3", Rule.POSITIVE, default=1.2)  # fmt: skip
    """[kg/m^3]"""
    wind: Vector = setting(
        "[at <T:s>] <(wx, wy, wz):m/s>",
        "Velocity of the air. Absent: it is at rest. Several lines with times T make it change: straight from each to the next, "
        "and as it was given first and last before and after.",
        "(5, 0, 0) m/s", default=(0.0, 0.0, 0.0), many=True, also=("wind_path",),
        codec=InTime("wind", "at 1 s (5, 0, 0) m/s"))  # fmt: skip
    """Velocity at the start [m/s]."""
    wind_path: tuple[tuple[float, Vector], ...] = ()
    """Points (T, w) between which it changes [s, m/s]; empty where it does not."""
    coefficient: float = setting(
        "<C>",
        "Pressure on a surface that faces the stream, over density speed^2/2. A flat plate has 1.2, the default; a ball then "
        "has half of it, 0.6.",
        "1.2", Rule.POSITIVE, default=1.2)  # fmt: skip
    spans: Mapping[str, Span] = field(default_factory=dict, compare=False, repr=False)
    """Where each keyword's value stands; ``spans["air"]`` is that of the block."""


BLOCKS = (
    Block(
        "air",
        AirBlock,
        "air",
        "Air that pushes at the drawn surfaces of all objects: quadratic drag, wind, lift of plates; "
        "[how](physics-air.md). There is at most one. Without the block there is no air, and `drag` of an object slows it.",
        order=20,
    ),
)


class AirWords:
    """The air in a scene."""

    air: AirBlock | None = None


SCENE = AirWords
