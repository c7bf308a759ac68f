# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature: what a rope cannot have."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, ClassVar

from ...records import dataclass
from ...scene.formatting import number, say
from ...scene.rollers import Roller
from ...scene.schema import OneOf, setting
from ...scene.shapes import Cylinder, HoldEnds, HoldFaces, Rope, Young

SWITCHES: dict[str, str] = {}


@dataclass(frozen=True, slots=True)
class Past:
    """A cylinder that a rope runs over, or under."""

    FORMS: ClassVar = ("over <NAME>", "under <NAME>")

    side: str
    name: str

    @classmethod
    def read(cls, form: int, values: tuple) -> Past:
        """From one of FORMS and its values."""
        return cls(cls.FORMS[form].split()[0], *values)

    def write(self) -> tuple[int, tuple]:
        """The number of one of FORMS, and its values."""
        return ("over", "under").index(self.side), (self.name,)


class RopeWords:
    """Settings of an object."""

    runs: tuple[Past, ...] = setting(
        None,
        "Of a rope: a cylinder that it runs over or under to begin with, from its start to its end; several lines for several "
        "cylinders, in turn. It is pulled straight between them, and as long as its way unless a shorter `length` is given.",
        "over wheel", default=(), many=True, codec=OneOf(Past), after="shape")  # fmt: skip


OBJECT = RopeWords


def is_rope(solid: Any) -> bool:
    """Whether an object is a line of particles."""
    return isinstance(solid.shape, Rope)


def check_object(v: Any, block: Any, solid: Any) -> Any:
    """Settings that make no sense in a rope, and those that ropes alone have."""
    spans = solid.spans
    if not is_rope(solid):
        if solid.runs:
            cause = f"{solid.name} is not a rope, and runs over nothing"
            v.problem(spans["runs"], cause, "leave runs out, or take shape rope from (0, 0, 1) m to (1, 0, 1) m thickness 1 cm")
        if any(isinstance(h, HoldEnds) for h in solid.hold):
            cause = f"{solid.name} is not a rope and has no start and no end"
            v.problem(spans["hold"], cause, "write hold faces x, hold face -x, hold all, or a box")
        return solid
    rope = solid.shape
    names = [(s, v.meant(block, one.name)) for s, one in zip(block.settings.get("runs", ()), solid.runs)]
    unknown = [name for s, name in names if not v.known_object(name, s.span(0))]  # each is told
    if names and not unknown:
        solid = replace(solid, runs=tuple(replace(one, name=name) for one, (_, name) in zip(solid.runs, names)))
    if not isinstance(solid.elasticity, Young):
        cause = f"{solid.name} is a {kind(rope)}: its springs follow from Young's modulus and its thickness"
        v.problem(spans["elasticity"], cause, "write elasticity 100 MPa, or whatever its material has")
    if any(isinstance(h, HoldFaces) for h in solid.hold):
        v.problem(
            spans["hold"], f"{solid.name} is a {kind(rope)} and has no faces", "write hold ends, hold start or hold end, or a box"
        )
    if solid.restitution is not None and isinstance(solid.elasticity, Young):
        cause = f"{solid.name} is a {kind(rope)}: restitution is of rigid and held objects"
        v.problem(spans["restitution"], cause, "leave it out; damping takes energy of its springs")
    if solid.resolution is not None and not rope.thickness * (1.0 - 1e-9) <= solid.resolution <= 0.5 * rope.length:
        found = f"found {number(solid.resolution, 6)} m"
        cause = f"links of {solid.name} are at least as long as it is thick, and there are two or more: {found}"
        way_out = f"write resolution {say(rope.thickness, 'm', 6)} or more, or leave it out"
        v.problem(spans["resolution"], cause, way_out)
    return solid


def kind(rope: Rope) -> str:
    """Its word."""
    return "rope" if rope.bends else "chain"


def check(v: Any, top: Mapping, held: dict) -> None:
    """Ropes around what they run over, and parts of a scene that know objects by their cells, which a rope does not have."""
    known = {solid.name: solid for solid in held["solids"]}
    if any(solid.runs for solid in held["solids"]):
        held["solids"] = tuple(_around(v, known, solid) if solid.runs and is_rope(solid) else solid for solid in held["solids"])
    if rope := next(filter(is_rope, held["solids"]), None):
        instead = "shape cylinder for what is to float, or joint spring A B { pulls only } for a string"
        check_without_cells(v, held, rope, kind(rope.shape), instead)


def check_without_cells(v: Any, held: Mapping, solid: Any, what: str, instead: str) -> None:
    """Parts of a scene that know objects by their cells, which this one, a rope, a chain or a sheet (``what``), does not have."""
    at, control = solid.spans.get("shape"), held["control"]
    if held.get("liquid") is not None:
        cause = f"{solid.name} is a {what}, and a liquid finds objects by their cells, which a {what} does not have"
        v.problem(at, cause, f"take the liquid out, or write {instead}", key=f"{what}-liquid")
    if control is not None and control.contact_model.value == "paper" and len(held["solids"]) > 1:
        cause = f"{solid.name} is a {what}, which touches others with its surface alone"
        v.problem(at, cause, "take contact-model paper out of control", key=f"{what}-paper")


def _around(v: Any, known: Mapping, solid: Any) -> Any:
    """A rope with its line around what it runs over."""
    if not all(one.name in known for one in solid.runs):
        return solid  # told, or broken itself
    rollers = []
    for one in solid.runs:
        wheel = known[one.name]
        if not isinstance(wheel.shape, Cylinder):
            v.problem(solid.spans["runs"], f"{solid.name} runs {one.side} {one.name}, which does not have the shape cylinder",
                      f"write shape cylinder r h in {one.name}, or a cylinder welded to it")  # fmt: skip
            return solid
        axis = tuple(row[2] for row in wheel.rotation)
        radius = wheel.shape.radius + 0.5 * solid.shape.thickness
        rollers.append(Roller(one.name, wheel.position, axis, 0.5 * wheel.shape.height, radius, one.side == "over"))
    try:
        shape = solid.shape.around(tuple(rollers))
    except ValueError as e:
        cause, way_out = e.args
        v.problem(solid.spans["runs"], f"{solid.name} cannot run {solid.runs[0].side} {solid.runs[0].name}: {cause}", way_out)
        return solid
    return replace(solid, shape=shape, position=shape.curve.middle())


CHECKS = {"object": check_object}
