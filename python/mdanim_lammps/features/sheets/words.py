# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature: what a sheet cannot have."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from ...scene.formatting import number, say
from ...scene.shapes import HOLLOW, Box, Cone, Cylinder, Ellipsoid, HoldFaces, Sheet, Shell, Sphere, Torus, Young
from ..ropes.words import check_without_cells

SWITCHES: dict[str, str] = {}

THICKEST = 0.25
"""Thickness of a sheet around a shape over the thinnest part of that, at most."""


def is_sheet(solid: Any) -> bool:
    """Whether an object is a layer of particles."""
    return isinstance(solid.shape, Sheet | Shell)


def width(shape: Sheet | Shell) -> float:
    """How wide a sheet is across where it is narrowest [m]; of a mesh, whose file is not read for it, without limit."""
    match shape if isinstance(shape, Sheet) else shape.shape:
        case Sheet(size=size) | Box(size=size):
            return min(size)
        case Sphere(radius=r) | Torus(minor=r):
            return 2.0 * r
        case Ellipsoid(radii=radii):
            return 2.0 * min(radii)
        case Cylinder(radius=r, height=height) | Cone(radius=r, height=height):
            return min(2.0 * r, height)
    return math.inf


def finest(sheet: Sheet | Shell) -> float:
    """Least spacing of its particles [m]: of finer ones, springs that hold those which resist bending would have no length."""
    return sheet.thickness * math.sqrt(max(1.0, sheet.bending))


def coarsest(sheet: Sheet | Shell) -> float:
    """Largest spacing of its particles [m], with two of them across: on a wider lattice springs of oblique rods push."""
    return 0.5 * width(sheet)


def check_object(v: Any, block: Any, solid: Any) -> Any:
    """Settings that make no sense in a sheet."""
    if not is_sheet(solid) or (isinstance(solid.shape, Shell) and solid.pieces is not None):
        return solid  # a shell in pieces is a rigid hollow one
    spans, sheet = solid.spans, solid.shape
    if not isinstance(solid.elasticity, Young):
        cause = f"{solid.name} is a sheet: its springs follow from Young's modulus and its thickness"
        hollow = "leave out sheet and write its mass for what is rigid"
        if isinstance(sheet, Shell) and isinstance(sheet.shape, HOLLOW):
            hollow += "; of what breaks, pieces 20 makes it rigid and hollow"
        rigid = "shape box for a rigid plate" if isinstance(sheet, Sheet) else hollow
        v.problem(spans["elasticity"], cause, f"write elasticity 1 MPa, or whatever its material has, or {rigid}")
    flat = isinstance(sheet, Sheet)
    if not flat and sheet.thickness > THICKEST * width(sheet):
        cause = f"{solid.name} is too thick for a sheet: {say(sheet.thickness, 'm', 6)}, it is {say(width(sheet), 'm', 6)} wide"
        v.problem(spans["shape"], cause, "write a smaller thickness, or leave out sheet for what is solid")
        return solid
    if flat and any(side.value[1] == "z" for hold in solid.hold if isinstance(hold, HoldFaces) for side in hold.sides):
        cause = f"{solid.name} is a sheet in its xy plane, and its faces along z are all of it"
        v.problem(spans["hold"], cause, "write hold face -x, +x, -y or +y, hold all, or a box")
    if solid.restitution is not None and isinstance(solid.elasticity, Young):  # a material has one for what is rigid
        cause = f"{solid.name} is a sheet: restitution is of rigid and held objects"
        v.problem(spans["restitution"], cause, "leave it out; damping takes energy of its springs")
    least, most = finest(sheet), coarsest(sheet)
    if solid.resolution is not None and not least * (1.0 - 1e-9) <= solid.resolution <= most:
        cause = (
            f"particles of {solid.name} are at least {say(least, 'm', 6)} apart and there are two spacings or more across: "
            f"found {number(solid.resolution, 6)} m"
        )
        most_of = f", up to {say(most, 'm', 6)}" if most < math.inf else ""
        way_out = f"write resolution {say(least, 'm', 6)} or more{most_of}, or leave it out"
        v.problem(spans["resolution"], cause, way_out)
    elif least > most:
        cause = f"{solid.name} with bending {number(sheet.bending, 6)} is too stiff for its size"
        v.problem(
            spans["shape"], cause, f"write bending {number((most / sheet.thickness) ** 2, 2)} or less, or a larger elasticity"
        )
    return solid


def check(v: Any, top: Mapping, held: Mapping) -> None:
    """Parts of a scene that know objects by their cells, which a sheet does not have."""
    if sheet := next(filter(is_sheet, held["solids"]), None):
        check_without_cells(v, held, sheet, "sheet", "shape box for what is to float")


CHECKS = {"object": check_object}
