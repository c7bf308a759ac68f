# SPDX-License-Identifier: GPL-2.0-only
"""Limits of the lattice of a scene, checked before any array is allocated: positions, and shapes that fill little of their
boxes. Limits of single numbers are in scene/limits.py."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..errors import Problem
from ..scene.formatting import estimate, say
from ..scene.scene import Box, SceneRecord, Shape, Solid
from . import shapes

PRECISION = 1e-8
"""Largest distance between neighbouring numbers at an object's place, over the spacing: it is the strain of rounding."""
SPARSE_CELLS, SPARSE = 3e7, 20.0
"""A shape whose bounding box has more than SPARSE_CELLS cells must fill at least one in SPARSE of them."""


def check_places(scene: SceneRecord, spacings: Sequence[float]) -> list[Problem]:
    """A problem for every object so far from the origin that its particles, so far apart [m], cannot be distinguished well."""
    farthest = max((abs(x) for s in scene.solids for x in s.position), default=0.0)
    if np.spacing(farthest) <= PRECISION * min(spacings, default=1.0):
        return []
    return [
        Problem(
            s.spans.get("position") or s.spans.get("object"),
            f"{s.name} is too far from the origin for its size: at {say(far, 'm')} numbers are "
            f"{say(float(np.spacing(far)), 'm')} apart, too coarse for particles that are {say(h, 'm')} apart",
            "move the scene nearer to the origin, or make everything larger",
        )
        for s, h in zip(scene.solids, spacings)
        if np.spacing(far := max(map(abs, s.position))) > PRECISION * h
    ]


def check_sparse(solid: Solid, h: float, particles: float) -> Problem | None:
    """A problem for a shape that fills so little of its bounding box that the search for its cells would take too long."""
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
