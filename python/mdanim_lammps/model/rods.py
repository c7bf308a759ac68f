# SPDX-License-Identifier: GPL-2.0-only
"""Springs of rods: lines of particles that bear pull along them and bending across (docs/physics-sheets.md)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ..records import dataclass
from .bends import BendLine

SOFT = 1.0 / 16.0
"""Constant of a spring over two links, over that of a link: so soft that its push hardly changes where the rod is bent."""


@dataclass(frozen=True, eq=False)
class Rod:
    """Particles one after the other, on a straight line without load, and what its sections are multiples of."""

    particle: np.ndarray
    """int64, shape (n,)."""
    length: np.ndarray
    """Lengths of links [m], shape (n - 1,)."""
    width: np.ndarray
    """Factor of the section of each link, shape (n - 1,)."""
    bent: np.ndarray
    """The same of its resistance to bending at each particle between two links, shape (n - 2,)."""


def bends_of(rods: Sequence[Rod], place: np.ndarray) -> Iterator[tuple[int, BendLine]]:
    """Particles between two links of rods, and the lines across them, with the energy of `springs_of`, E I theta^2/(l1 + l2) =
    E I k^2 (l1 + l2)/4, for I = w t^3/12. ``place``: particles [m], shape (N, 3)."""
    for rod in rods:
        for k in range(len(rod.length) - 1):
            one, other = rod.length[k : k + 2].tolist()
            near, far = 2.0 / ((one + other) * one), 2.0 / ((one + other) * other)
            low, middle, high = rod.particle[k : k + 3].tolist()
            stiffness = float(rod.bent[k]) / 12.0 * 0.5 * (one + other)
            weight, sharpest = (near, -near - far, far), near * one + far * other
            line = BendLine((low, middle, high), weight, stiffness, place[high] - place[low], sharpest)
            yield middle, line


def springs_of(rods: Sequence[Rod], pull: float, bend: float) -> tuple[np.ndarray, np.ndarray]:
    """Pairs i < j of particles, sorted, int32, shape (S, 2), and k [N/m], r0 [m] and length without load [m] of each, shape (S,
    3).

    A link of the width w bears E A = ``pull`` w, a particle between two links l1, l2 bears E I = ``bend`` w: over both there is a
    spring that pushes with P = 2 E I/l1 l2, and the links hold it, so that a bend by an angle theta has the energy
    E I theta^2/(l1 + l2). It is SOFT of a link, and links have what it leaves of E A. No two rods have a link in common.
    """
    pairs, values = [], []
    for rod in rods:
        at, length = rod.particle, rod.length
        k1, soft, push = pull * rod.width / length, np.zeros(len(length)), np.zeros(len(length))
        if bend > 0.0 and len(length) > 1:
            one, other = length[:-1], length[1:]
            both = one + other
            k2, p = 2.0 * SOFT * pull * rod.bent / both, 2.0 * bend * rod.bent / (one * other)
            pairs.append(np.stack([at[:-2], at[2:]], axis=1))
            values.append(np.stack([k2, both + p / k2, both], axis=1))
            for links in (slice(None, -1), slice(1, None)):
                soft[links] += k2 * (both / length[links])
                push[links] += p
        k1 = k1 - soft
        pairs.append(np.stack([at[:-1], at[1:]], axis=1))
        values.append(np.stack([k1, length - push / k1, length], axis=1))
    pair, value = np.sort(np.concatenate(pairs), axis=1), np.concatenate(values)
    order = np.lexsort((pair[:, 1], pair[:, 0]))
    return pair[order].astype(np.int32), value[order]
