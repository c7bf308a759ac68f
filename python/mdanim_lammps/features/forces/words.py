# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, ClassVar

from ...records import dataclass
from ...scene.formatting import number
from ...scene.holding import all_held
from ...scene.schema import OneOf, Vector, setting
from ...scene.shapes import Rope

SWITCHES = {"forces": "an object's `force` or `torque`"}

LEDGER = {"work": "what forces and torques have done so far [J]"}
"""Columns of the ledger."""


@dataclass(frozen=True, slots=True)
class Push:
    """A force on an object as a whole."""

    FORMS: ClassVar = ("<(fx, fy, fz):N> [from <T:s>] [to <T:s>]",)
    vector: Vector
    """[N]"""
    begin: float | None = None
    """[s]; None is the start."""
    end: float | None = None
    """[s]; None is the end."""

    def moved(self, place: Any) -> Push:
        """The same of an object in a group that is placed."""
        return replace(self, vector=place.turn(self.vector))


@dataclass(frozen=True, slots=True)
class Twist(Push):
    """A torque on an object as a whole."""

    FORMS: ClassVar = ("<(tx, ty, tz):N*m> [from <T:s>] [to <T:s>]",)
    vector: Vector
    """[N*m]"""


class ForceWords:
    """Settings of an object."""

    force: tuple[Push, ...] = setting(
        None,
        "Pushes it as a whole, in proportion to mass, from one time to another. Absent: from the start, and to the end. Several "
        "add up.",
        "(0.2, 0, 0) N", default=(), many=True, codec=OneOf(Push), after="hold")  # fmt: skip
    torque: tuple[Twist, ...] = setting(
        None,
        "Turns it as a whole about its centre of mass, as a body that does not deform would share the torque, from one time to "
        "another. Several add up.",
        "(0, 0, 0.01) N*m", default=(), many=True, codec=OneOf(Twist), after="force")  # fmt: skip


OBJECT = ForceWords


# --- checks: v is the scene/validate.Validator ----------------------------------------------------------------------


def check_object(v: Any, block: Any, solid: Any) -> Any:
    """Forces on what can move, in windows that end after they begin."""
    for word in ("force", "torque"):
        for s, one in zip(block.settings.get(word, ()), getattr(solid, word)):
            _check(v, s, word, one, solid)
    return solid


def _check(v: Any, s: Any, word: str, one: Push, solid: Any) -> None:
    if all_held(solid):
        cause = f"{solid.name} is held as a whole, so a {word} does not move it"
        v.problem(s.span(), cause, f"leave the {word} out, or write drive velocity (0.5, 0, 0) m/s, or hold a part of it")
    if word == "torque" and isinstance(solid.shape, Rope):
        cause = f"{solid.name} is a line of particles, which nothing turns about itself"
        v.problem(s.span(), cause, "write force, or turn what it is tied to")
    begin = 0.0 if one.begin is None else one.begin
    if begin < 0.0:
        v.problem(s.span(1), f"a {word} begins at 0 s or later, found {number(begin, 6)} s", "the run begins at 0 s")
    elif one.end is not None and one.end <= begin:
        cause = f"a {word} ends after it begins, found to {number(one.end, 6)} s and from {number(begin, 6)} s"
        v.problem(s.span(2), cause, "write the earlier time behind from")


def check(v: Any, top: Mapping, held: Mapping) -> None:
    """Forces that begin when the run has ended."""
    if (control := held["control"]) is None:
        return
    for solid in held["solids"]:
        for word in ("force", "torque"):
            for one in getattr(solid, word):
                if one.begin is not None and one.begin >= control.time:
                    cause = f"a {word} on {solid.name} begins at {number(one.begin, 6)} s, and the run ends at "
                    cause += f"{number(control.time, 6)} s"
                    v.problem(solid.spans[word], cause, "write an earlier time behind from", severity="warning")


CHECKS = {"object": check_object}
