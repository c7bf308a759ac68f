# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from ...scene.formatting import say, with_article
from ...scene.limits import MOST_PIECES, Limit
from ...scene.schema import Observable, OneOf, Rule, setting
from ...scene.shapes import HOLLOW, Bricks, PieceShape, Rope, Sheet, Shell, VoronoiCells, holds_all

SWITCHES = {"pieces": "an object's `pieces n`"}

QUANTITIES = {
    ("NAMES", "pieces"): Observable("1", "parts of an object with `pieces` that hang together; 1 before it breaks", "pieces"),
    ("NAMES", "stress.max"): Observable(
        "Pa", "largest stress that glue of an object with `pieces` bore so far, above its `strength` where that broke", "pieces"
    ),
}

LEDGER = {"torn": "energy of motion and contact that was lost where glue broke"}

STRENGTH = Limit("strength", 1e12, 1.0, "30 MPa for glass, 1 MPa for a biscuit")


class PieceWords:
    """Settings of an object."""

    pieces: VoronoiCells | Bricks | None = setting(
        None,
        "What it breaks into: so many pieces, cells of points that the `seed` of `control` chooses, or `bricks` of about this "
        "size, in rows of which every other one is shifted. Each is an object of its own, `NAME.piece[1]` and so on. Glue of the "
        "`strength` holds them together, and the object moves as a whole, until it breaks. Of `rigid` objects.",
        "20", Rule.SEVERAL, default=None, limit=MOST_PIECES, codec=OneOf(VoronoiCells, Bricks), after="elasticity")  # fmt: skip
    strength: float | None = setting(
        "<s:Pa>",
        "Of an object with `pieces`: the stress at which the glue of a face breaks, in tension and bending or in shear. Absent: "
        "that of its material.",
        "1 MPa", Rule.POSITIVE, default=None, limit=STRENGTH, shared=True, after="elasticity")  # fmt: skip
    """[Pa]"""


OBJECT = PieceWords

ALLOWED = frozenset(
    ("object", "shape", "position", "origin", "orientation", "velocity", "spin", "elasticity", "mass", "density", "friction")
    + ("restitution", "material", "color", "resolution", "pieces", "strength")
)
"""Settings that an object with pieces may have."""


def check_object(v: Any, block: Any, solid: Any) -> Any:
    """Rigid solids break, and all that they have is known of their pieces."""
    from ..rigid.words import Rigid  # they have words, too
    from ..sheets.words import width

    if solid.pieces is None:
        if solid.strength is not None and "strength" in solid.spans:
            cause = f"{solid.name} has a strength and no pieces: it is that of what holds pieces together"
            v.problem(solid.spans["strength"], cause, "write pieces 20, or leave it out", severity="warning")
        return solid
    span, shape = solid.spans["pieces"], solid.shape
    if isinstance(shape, Shell) and isinstance(shape.shape, HOLLOW):
        if shape.thickness >= 0.5 * width(shape):
            thick, wide = say(shape.thickness, "m"), say(width(shape), "m")
            cause = f"{solid.name} is not hollow: its wall is {thick} thick and it is {wide} wide"
            v.problem(solid.spans["shape"], cause, "write a thinner wall, or leave out sheet")
            return solid
    elif isinstance(shape, Shell):
        cause = f"{solid.name} is the sheet of a {type(shape.shape).FORMS[0].split()[0]}, which is not cut into pieces"
        v.problem(span, cause, "write a mesh file with both sides of its wall, without sheet")
        return solid
    elif isinstance(shape, Rope | Sheet):
        kind = with_article(type(shape).FORMS[0].split()[0])
        v.problem(span, f"{solid.name} is {kind}, which is not cut into pieces", "write tear-strain 0.1 in place of it")
        return solid
    if holds_all(solid.hold):
        v.problem(span, f"{solid.name} is held as a whole, so it never breaks", "leave out pieces, or hold all")
    elif not isinstance(solid.elasticity, Rigid):
        cause = f"{solid.name} has pieces and deforms; only rigid objects are cut into pieces"
        v.problem(span, cause, "write elasticity rigid, or tear-strain 0.1 in place of pieces")
    if solid.strength is None and not block.excused("strength"):
        cause = f"{solid.name} has pieces and no strength: when does it break?"
        v.problem(span, cause, "write strength 1 MPa, or a material: glass, brick, biscuit, ice")
    for word, place in solid.spans.items():
        if word not in ALLOWED and word in given(solid) and not (word == "hold" and holds_all(solid.hold)):
            v.problem(place, f"{solid.name} has pieces, and {word} does not act on pieces", f"leave out {word}, or pieces")
    return solid


def given(solid: Any) -> set[str]:
    """Words of the settings of an object that are not as if they were left out."""
    return {
        keyword.name or field.name.replace("_", "-")
        for field in fields(solid)
        if (keyword := field.metadata.get("keyword")) is not None and getattr(solid, field.name) != field.default
    }


CHECKS = {"object": check_object}


def check(v: Any, top: Any, held: Any) -> None:
    """Pieces of objects do not know a liquid or air."""
    whole = next((s.shape.whole for s in held["solids"] if isinstance(s.shape, PieceShape)), None)
    for field, word in (("liquid", "liquid"), ("air", "air")):
        if whole is not None and held.get(field) is not None and held.get(field) != ():
            cause = f"{whole.name} has pieces, which do not know the {word} of the scene"
            v.problem(whole.spans["pieces"], cause, f"leave out pieces, or the {word}")
