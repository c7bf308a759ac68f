# SPDX-License-Identifier: GPL-2.0-only
"""Moments of the part of a solid that is in a box: tetrahedra from the origin to the triangles of its surface, cut at the sides.

A point of the solid is in one more tetrahedron that is turned outward than in ones that are turned inward, so signed moments of
cut tetrahedra add up to those of the part, whatever the shape of the surface.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

CUTS = (
    (),
    ((0, (0, 1), (0, 2), (0, 3)),),
    ((0, 1, (0, 2), (0, 3)), (1, (0, 2), (0, 3), (1, 3)), (1, (0, 2), (1, 2), (1, 3))),
    ((0, 1, 2, (0, 3)), (1, 2, (0, 3), (1, 3)), (2, (0, 3), (1, 3), (2, 3))),
    ((0, 1, 2, 3),),
)
"""Tetrahedra of what is kept, by how many corners are inside: of corners, and of points from one inside to one outside."""


def moments_in_box(
    place: np.ndarray, triangle: np.ndarray, turn: np.ndarray, low: Sequence[float], high: Sequence[float]
) -> tuple[float, np.ndarray, np.ndarray]:
    """Volume [m^3], integral of x [m^4], shape (3,), and of x x' [m^5], shape (3, 3), of what a closed surface and a box share.

    Args:
        place: corners of triangles [m], shape (V, 3), body frame.
        triangle: counter-clockwise seen from outside, shape (T, 3).
        turn: rotation from the body to the frame of the box, shape (3, 3), in which the moments are, too.
        low, high: sides of the box from the origin of the body [m].
    """
    corners = (place @ turn.T)[triangle]
    origin = np.clip(np.zeros(3), low, high)  # in the box: fewer cuts
    four = np.concatenate([np.broadcast_to(origin, (len(corners), 1, 3)), corners], axis=1)
    sign = np.sign(np.linalg.det(four[:, 1:] - four[:, :1]))
    four, sign = four[sign != 0.0], sign[sign != 0.0]
    for axis in range(3):
        four, sign = _kept(four, sign, four[:, :, axis] - low[axis])
        four, sign = _kept(four, sign, high[axis] - four[:, :, axis])
    volume = sign * np.abs(np.linalg.det(four[:, 1:] - four[:, :1])) / 6.0
    middle = four.mean(axis=1)
    # A tetrahedron has V/20 (sum of x x' of its corners + 16 times that of its middle).
    second = (np.einsum("t,tki,tkj->ij", volume, four, four) + 16.0 * np.einsum("t,ti,tj->ij", volume, middle, middle)) / 20.0
    return float(volume.sum()), volume @ middle, second


def _kept(four: np.ndarray, sign: np.ndarray, inside: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Parts of tetrahedra, shape (T, 4, 3), where a linear function is above 0, by its values at their corners, shape (T, 4)."""
    order = np.argsort(-inside, axis=1, kind="stable")  # those inside first
    four, inside = np.take_along_axis(four, order[:, :, None], axis=1), np.take_along_axis(inside, order, axis=1)
    count = (inside > 0.0).sum(axis=1)
    found, signs = [], []
    for many, cuts in enumerate(CUTS):
        chosen = count == many
        for cut in cuts:
            found.append(np.stack([_point(four[chosen], inside[chosen], corner) for corner in cut], axis=1))
            signs.append(sign[chosen])
    return np.concatenate(found), np.concatenate(signs)


def _point(four: np.ndarray, inside: np.ndarray, corner: int | tuple[int, int]) -> np.ndarray:
    """A corner of tetrahedra, or the point between two of them where the function is 0, shape (T, 3)."""
    if isinstance(corner, int):
        return four[:, corner]
    i, o = corner
    part = (inside[:, i] / (inside[:, i] - inside[:, o]))[:, None]
    return four[:, i] + part * (four[:, o] - four[:, i])
