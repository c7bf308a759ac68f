# SPDX-License-Identifier: GPL-2.0-only
"""What a scene may ask for, checked before anything is allocated: numbers that can be computed with, sizes, places."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass

import numpy as np

from ..errors import Problem, Span
from ..scene.formatting import estimate, number, say
from ..scene.scene import Box, Mesh, Scene, Shape, Solid
from . import shapes
from .mesh import SIZES

NUMBERS = 1e-30, 1e30
"""Least and largest number that a scene may use, in SI units: their squares and quotients are in the range of doubles."""
PRECISION = 1e-8
"""Largest distance between neighbouring numbers at an object's place, over the spacing: it is the strain of rounding."""
SPARSE_CELLS, SPARSE = 3e7, 20.0
"""A shape whose bounding box has more cells than this is to fill one in so many of them."""
POSITIVE = frozenset({"mass", "density", "modulus", "k", "resolution", "timestep", "frames"})
"""Fields to which the least number applies too; anything else may be as small as it likes."""
KEYWORDS = {"modulus": "elasticity", "k": "elasticity", "low": "basin", "high": "basin", "major": "shape", "minor": "shape"}
"""Keyword of a field where that is not the field's own name."""


def check_numbers(scene: Scene) -> list[Problem]:
    """A problem for every number beyond NUMBERS, and for every shape with a measure beyond SIZES."""
    problems = [p for s in scene.solids for p in (*_beyond(s, s.spans, s.name), *_measures(s))]
    for record, what in ((scene.control, "control"), (scene.liquid, "liquid")):
        problems += _beyond(record, record.spans, what) if record else []
    for name in ("gravity", "ground", "walls"):
        if _bad(name, getattr(scene, name)):
            problems.append(_beyond_problem(scene.spans.get(name), name))
    return problems


def _beyond(record, spans, what: str) -> Iterator[Problem]:
    """Problems of the fields of a solid, a liquid or ``control``."""
    for field in fields(record):
        value = getattr(record, field.name)
        if field.name in ("spans", "rotation", "shape"):
            continue
        if _bad(field.name, value):
            keyword = KEYWORDS.get(field.name, field.name)
            place = spans.get(keyword) or spans.get(keyword.replace("_", "-")) or spans.get("object") or spans.get("liquid")
            yield _beyond_problem(place, f"{what}: {keyword.replace('_', '-')}")


def _beyond_problem(span: Span | None, what: str) -> Problem:
    low, high = NUMBERS
    return Problem(
        span,
        f"{what} is beyond the numbers that can be computed with",
        f"write one between {number(low)} and {number(high)} in SI units (is a unit or an exponent wrong?)",
    )


def _bad(name: str, value) -> bool:
    """Whether a number of a value is out of range; values are numbers, tuples of them, records, or no numbers at all."""
    if isinstance(value, float | int):
        least = NUMBERS[0] if name in POSITIVE else 0.0
        return not least <= abs(value) <= NUMBERS[1]
    if isinstance(value, tuple):
        return any(_bad("", v) for v in value)
    if is_dataclass(value):
        return any(_bad(f.name, getattr(value, f.name)) for f in fields(value))
    return False


def _measures(solid: Solid) -> Iterator[Problem]:
    """A problem where a measure of a shape is beyond SIZES; meshes tell of theirs when they are loaded."""
    shape, (low, high) = solid.shape, SIZES
    if isinstance(shape, Mesh):
        return
    values = [v for f in fields(shape) for v in np.ravel(getattr(shape, f.name)).tolist()]
    worst = next((v for v in values if not low <= v <= high), None)
    if worst is not None:
        yield Problem(
            solid.spans.get("shape") or solid.spans.get("object"),
            f"{solid.name}: a measure of its shape is {say(worst, 'm')}; {say(low, 'm')} to {say(high, 'm')} can be modelled",
            "is a unit or an exponent wrong?",
        )


def check_places(scene: Scene, h: float) -> list[Problem]:
    """A problem for every object so far from the origin that its particles, ``h`` [m] apart, cannot be told apart well."""
    farthest = max((abs(x) for s in scene.solids for x in s.position), default=0.0)
    if np.spacing(farthest) <= PRECISION * h:
        return []
    return [
        Problem(
            s.spans.get("position") or s.spans.get("object"),
            f"{s.name} is {say(far, 'm')} from the origin, where numbers are {say(float(np.spacing(far)), 'm')} apart: "
            f"too coarse for particles at {say(h, 'm')}",
            "move the scene nearer to the origin, or make everything larger",
        )
        for s in scene.solids
        if np.spacing(far := max(map(abs, s.position))) > PRECISION * h
    ]


def check_sparse(solid: Solid, h: float, particles: float) -> Problem | None:
    """A problem for a shape that fills so little of its bounding box that looking for its cells would take too long."""
    cells = bounding_cells(solid.shape, h)
    if isinstance(solid.shape, Box) or cells <= max(SPARSE_CELLS, SPARSE * particles):
        return None
    return Problem(
        solid.spans.get("shape") or solid.spans.get("object"),
        f"{solid.name}: the box around it has {estimate(cells)} cells of {say(h, 'm')}, and it fills about "
        f"{estimate(particles)} of them; up to {estimate(SPARSE_CELLS)} can be searched",
        "make it thicker or smaller, or build it of several objects",
    )


def bounding_cells(shape: Shape, h: float) -> float:
    """Cells of edge h [m] in the bounding box of a shape."""
    low, high = shapes.extent(shape)
    return float(np.prod(np.ceil((high - low) / h) + 1.0))
