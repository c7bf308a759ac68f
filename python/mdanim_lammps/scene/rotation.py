# SPDX-License-Identifier: GPL-2.0-only
"""Rotation matrices as rows of tuples: world = R @ body."""

from __future__ import annotations

import math

from .schema import Vector


def rotation_about(axis: Vector, angle: float) -> tuple[Vector, Vector, Vector]:
    """By ``angle`` [rad] about a unit axis u; Rodrigues' formula, R = cos I + sin [u]x + (1 - cos) u u^T."""
    x, y, z = axis
    c, s = math.cos(angle), math.sin(angle)
    d = 1.0 - c
    return (
        (c + d * x * x, d * x * y - s * z, d * x * z + s * y),
        (d * y * x + s * z, c + d * y * y, d * y * z - s * x),
        (d * z * x - s * y, d * z * y + s * x, c + d * z * z),
    )


def product(a, b) -> tuple[Vector, Vector, Vector]:
    """Matrix product a @ b of 3x3 tuples."""
    return tuple(tuple(sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)) for i in range(3))


def rotation_euler(angles: Vector) -> tuple[Vector, Vector, Vector]:
    """About x, then y, then z, fixed axes [rad]: R = Rz @ Ry @ Rx."""
    about = [rotation_about(tuple(float(i == k) for i in range(3)), angles[k]) for k in range(3)]
    return product(about[2], product(about[1], about[0]))


IDENTITY = rotation_about((0.0, 0.0, 1.0), 0.0)


def departure(rows) -> float:
    """How far a matrix is from a rotation: the largest entry of R R^T - 1, or 2 for a reflection."""
    r = rows
    error = max(abs(sum(r[i][k] * r[j][k] for k in range(3)) - (i == j)) for i in range(3) for j in range(3))
    determinant = (
        r[0][0] * (r[1][1] * r[2][2] - r[1][2] * r[2][1])
        - r[0][1] * (r[1][0] * r[2][2] - r[1][2] * r[2][0])
        + r[0][2] * (r[1][0] * r[2][1] - r[1][1] * r[2][0])
    )
    return max(error, 2.0 if determinant < 0.0 else 0.0)
