# SPDX-License-Identifier: GPL-2.0-only
"""Surfaces of several parts."""

import numpy as np
from mdanim_lammps.model import shapes


def joined(parts) -> tuple[np.ndarray, np.ndarray]:
    """Boxes and balls (shape, place [m], whether turned inside out) as one surface."""
    points, triangles = [], []
    for shape, place, turned in parts:
        p, t = shapes.surface(shape, 0.5)
        triangles.append((t[:, ::-1] if turned else t) + sum(map(len, points)))
        points.append(p + place)
    return np.concatenate(points), np.concatenate(triangles).astype(np.int32)
