# SPDX-License-Identifier: GPL-2.0-only
"""Joints on sheets, which have places and directions in their plane alone: all of their particles are there at the start."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...model.model import Model
from ...scene.formatting import number, say
from ...scene.scene import Sheet, Solid
from ...scene.schema import Vector

ON = 1e-6
"""Distance from the particles of a line or of a sheet, over their spacing, up to which a point is on them; also the part of a
direction that may be across a sheet."""
ROUNDED = 2e-3
"""Part of the longer side of a sheet by which a place may be off its surface because it is written with three digits."""
ALONG = 0.5
"""Part of an axis that is in the plane of a sheet, from which on that part is offered in its place: 30 degrees."""


def normal(sheet: Solid) -> np.ndarray:
    """Unit normal of a sheet at the start, shape (3,)."""
    return np.array(sheet.rotation, float)[:, 2]


def off(sheet: Solid, point: np.ndarray) -> float:
    """How far a point is off the plane of a sheet, along its normal [m]."""
    return float(normal(sheet) @ (point - sheet.position))


def onto(sheets: Sequence[Solid], point: np.ndarray) -> np.ndarray:
    """The nearest point in the planes of all these sheets [m], shape (3,); between them where they have none in common."""
    normals, away = np.array([normal(s) for s in sheets]), np.array([off(s, point) for s in sheets])
    return point - np.linalg.lstsq(normals, away, rcond=ON)[0]


def settled(sheets: Sequence[Solid], point: Vector) -> Vector:
    """A point moved into the planes of sheets, where it is inside of them but for a rounding of its digits."""
    at = np.array(point, float)
    away = [(abs(off(s, at)), s.shape) for s in sheets if isinstance(s.shape, Sheet)]
    if all(far <= ON * shape.thickness for far, shape in away):
        return point
    most = min(0.5 * shape.thickness + ROUNDED * max(shape.size) for _, shape in away)
    there = onto(sheets, at)
    if max(far for far, _ in away) > most or np.linalg.norm(there - at) > most:
        return point
    x, y, z = there.tolist()
    return x, y, z


def off_plane(
    place: str, at: np.ndarray, word: str, sheets: Sequence[tuple[Solid, Model]], line: str | None
) -> tuple[str, str] | None:
    """Cause and way out of a place off one of the sheets that hold it; ``line`` is the name of a rope that holds it too."""
    away = [(abs(off(s, at)), s) for s, model in sheets if abs(off(s, at)) > ON * model.spacing]
    if not away:
        return None
    far, sheet = max(away, key=lambda found: found[0])
    cause = f"{place} is {say(far, 'm')} off the plane of {sheet.name}, a sheet, which has all of its particles there"
    if line is not None:
        return (
            cause,
            f"move {sheet.name} by {_vector(off(sheet, at) * normal(sheet))} m: then this place of {line} is in its plane",
        )
    found = onto([s for s, _ in sheets], at)
    if any(abs(off(s, found)) > ON * model.spacing for s, model in sheets):
        names = " and ".join(s.name for s, _ in sheets)
        return cause, f"move {names}, whose planes have no place in common, so that they meet there"
    return cause, f"write {word} {_vector(found)} m, the nearest place in the plane"


def across(words: str, kind: str, axis: Vector, sheets: Sequence[Solid], other: str) -> tuple[str, str] | None:
    """Cause and way out of an axis that is not in the plane of one of the sheets that have to hold it."""
    along = np.array(axis, float) / np.linalg.norm(axis)
    tilted = [s for s in sheets if abs(normal(s) @ along) > ON]
    if not tilted:
        return None
    sheet = max(tilted, key=lambda s: abs(normal(s) @ along))
    angle = number(float(np.rad2deg(np.arcsin(min(1.0, abs(normal(sheet) @ along))))), 3)
    cause = f"the axis of joint {words} is {angle} deg out of the plane of {sheet.name}, a sheet, which has no other directions"
    within = along - normal(sheet) * (normal(sheet) @ along)
    written = ""
    if len(sheets) == 1 and np.linalg.norm(within) >= ALONG:
        written = f"write axis {_vector(within / np.linalg.norm(within))}, which is in its plane, or "
    if kind == "slider" and other not in {s.name for s in sheets}:
        return cause, written + f"name the sheet first: joint slider {sheet.name} {other} slides along an axis of {other}"
    return cause, written + f"hold a small rigid object to {sheet.name} by joint weld, and put this joint between it and {other}"


def _vector(v: np.ndarray) -> str:
    return f"({', '.join(f'{c + 0.0:.9g}' for c in v.tolist())})"
