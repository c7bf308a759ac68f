# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, replace
from typing import Any, ClassVar

from ...errors import Span
from ...records import dataclass
from ...scene.formatting import number
from ...scene.holding import all_held
from ...scene.schema import Block, OneOf, Vector, setting
from ..drives.words import check_times
from ..joints.words import Flag

SWITCHES = {"hands": "`hands` (as `--hands` says), or a `hand` block"}

LEDGER = {"work": "what hands have brought in so far [J]"}
"""Columns of the ledger."""


@dataclass(frozen=True, slots=True)
class HandKey:
    """A point of the path of a hand."""

    FORMS: ClassVar = ("<T:s> at <(x, y, z):m>",)
    time: float
    """[s]"""
    at: Vector
    """[m]"""


@dataclass(frozen=True, slots=True)
class Hand:
    """A hand that pulls at one point of an object, from its first key to its last."""

    object: str
    at: Vector = setting(
        "<(x, y, z):m>", "The point of the object that it holds, as it is at the start.", "(5, 0, 60) cm")  # fmt: skip
    """[m]"""
    keys: tuple[HandKey, ...] = setting(
        None,
        "Where the hand is at time T; straight on in between. It takes hold at the first key and lets go at the last.",
        "1 s at (5, 0, 80) cm", name="key", many=True, codec=OneOf(HandKey))  # fmt: skip
    spans: Mapping[str, Span] = field(default_factory=dict, compare=False, repr=False)
    """Where each keyword's value stands; ``spans["hand"]`` is that of the name."""

    def moved(self, place: Any) -> Hand:
        """The same of an object in a group that is placed."""
        return replace(self, at=place.point(self.at), keys=tuple(replace(key, at=place.point(key.at)) for key in self.keys))


class HandWords:
    """Settings outside of all blocks."""

    steerable: bool = setting(
        "on",
        "Any object that can move may be pulled at, anywhere and at any time: time step and room of objects are such that a hand "
        "can be added while the run goes on. `--hands` writes it.",
        "on", name="hands", default=False, codec=Flag())  # fmt: skip
    held_by: tuple[Hand, ...] = ()


SCENE = HandWords

BLOCKS = (
    Block(
        "hand",
        Hand,
        "held_by",
        "A hand that pulls at an object with a spring and a damper, from a point of the object to the place of the hand: `hand "
        "ball { at (0, 0, 60) cm  key 1 s at (0, 0, 60) cm  key 2 s at (30, 0, 80) cm }`. Its strength follows from mass, size "
        "and gravity. A run with `--hands` leaves what its hands have done in `hands.txt`, in these words.",
        names=("object",),
        indexed=True,
        of_objects=True,
        many=True,
        in_group=True,
        order=35,
    ),
)


# --- checks: v is the scene/validate.Validator ----------------------------------------------------------------------


def check_hand(v: Any, block: Any, hand: Hand) -> Hand | None:
    """One object; keys whose times rise."""
    found = v.problems.errors
    numbers = v.named.get(block.names[0], ())
    if len(numbers) > 1:
        cause = f"{hand.object} are {len(numbers)} objects, and a hand pulls at one{block.where}"
        v.problem(block.head, cause, f"write hand {hand.object}[0]")
    elif not numbers and not v.out.excused("object"):
        v.problem(block.head, f"{hand.object} is not an object, and nothing else can be pulled at", "write the name of an object")
    if len(hand.keys) < 2 and not block.excused("key"):
        cause = f"hand {hand.object} has fewer than two keys: it takes hold at the first and lets go at the last{block.where}"
        v.problem(block.head, cause, "e.g. key 0 s at (0, 0, 1) m  key 2 s at (0, 0, 2) m")
    check_times(v, block.settings.get("key", ()), hand.keys)
    return replace(hand, object=list(v.names)[numbers[0]]) if v.problems.errors == found and numbers else None


def check(v: Any, top: Mapping, held: Mapping) -> None:
    """Objects that can move; hands that begin before the run ends."""
    solids = {solid.name: solid for solid in held["solids"]}
    for hand in held["held_by"]:
        if (solid := solids.get(hand.object)) is None:
            continue
        if all_held(solid):
            cause = f"{solid.name} is held as a whole, so a hand does not move it"
            v.problem(hand.spans["hand"], cause, "leave the hand out, or hold a part of the object")
        if (control := held["control"]) is not None and hand.keys[0].time >= control.time:
            cause = f"a hand takes hold of {solid.name} at {number(hand.keys[0].time, 6)} s, and the run ends at "
            cause += f"{number(control.time, 6)} s"
            v.problem(hand.spans["key"], cause, "write earlier keys", severity="warning")


CHECKS = {"hand": check_hand}
