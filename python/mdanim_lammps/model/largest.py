# SPDX-License-Identifier: GPL-2.0-only
"""Which of several shapes have most of the volume of all."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..scene.scene import Shape
from .shapes import volume


def largest(shapes: Sequence[Shape], part: float) -> list[int]:
    """Numbers of the largest shapes, the largest first, until they have this part of the volume of all. Raises mesh.MeshError."""
    volumes = np.array([volume(shape) for shape in shapes])
    order = np.argsort(-volumes, kind="stable")
    before = np.cumsum(volumes[order]) - volumes[order]
    return order[before < part * volumes.sum()].tolist()
