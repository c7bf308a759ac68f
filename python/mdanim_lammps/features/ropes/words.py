# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature: what a rope cannot have."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ...scene.formatting import number, say
from ...scene.shapes import HoldEnds, HoldFaces, Rope, Young

SWITCHES: dict[str, str] = {}


def is_rope(solid: Any) -> bool:
    """Whether an object is a line of particles."""
    return isinstance(solid.shape, Rope)


def check_object(v: Any, block: Any, solid: Any) -> Any:
    """Settings that make no sense in a rope, and those that ropes alone have."""
    spans = solid.spans
    if not is_rope(solid):
        if any(isinstance(h, HoldEnds) for h in solid.hold):
            cause = f"{solid.name} is not a rope and has no start and no end"
            v.problem(spans["hold"], cause, "write hold faces x, hold face -x, hold all, or a box")
        return solid
    rope = solid.shape
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


def check(v: Any, top: Mapping, held: Mapping) -> None:
    """Parts of a scene that know objects by their cells, which a rope does not have."""
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


CHECKS = {"object": check_object}
