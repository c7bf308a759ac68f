# SPDX-License-Identifier: GPL-2.0-only
"""Tubes around chains of particles, for pictures: rings across the line, in frames that do not turn about it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

SIDES = 10
"""Vertices around."""
FEW = 250
"""Links up to which there is a ring in the middle of each, besides those at particles."""
OF_TORN = 3
"""Rings for each link of a line that may tear: two between particles, of which either side gets one where the link is gone."""
CAP = (0.5, 0.85)
"""Rings of an end, a half of a ball: how far out, over the radius."""


class Tubes:
    """The vertices of some tubes beside the sums of particle positions of which they hang."""

    def __init__(self, chains: Sequence[tuple[slice, np.ndarray]]):
        """
        Args:
            chains: of each tube its particles, one after the other, and its vertices: place along the chain [links], and the way
                from there [m] along two axes across and along the chain, shape (V, 4).
        """
        self._parts = []
        first = 0
        for particles, vertex in chains:
            place, ring = np.unique(vertex[:, 0], return_inverse=True)
            self._parts.append((particles, place, ring.reshape(-1), vertex[:, 1:], slice(first, first + len(vertex))))
            first += len(vertex)
        self.count = first

    def torn(self, position: np.ndarray, gone: np.ndarray) -> Iterator[tuple[slice, np.ndarray]]:
        """Vertices of tubes that are torn [m], shape (n, 3), with their rows, for particle positions [m], shape (N, 3), and the
        ends of springs that are gone, shape (G, 2)."""
        low, high = gone.T
        gone = np.zeros(len(position), bool)
        gone[low[high == low + 1]] = True
        for particles, place, ring, way, rows in self._parts:
            if gone[particles][:-1].any():
                yield rows, in_pieces(position[particles], gone[particles][:-1], place, ring, way)

    def around(self, position: np.ndarray) -> np.ndarray:
        """From sums of particle positions to vertices [m], shape (V, 3), for particle positions [m], shape (N, 3)."""
        found = np.empty((self.count, 3))
        for particles, place, ring, way, rows in self._parts:
            frame = frames(slopes(position[particles], place))
            found[rows] = np.einsum("va,vad->vd", way, frame[ring])
        return found


def smooth(links: int, place: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A smooth line through particles (Catmull and Rom): the particles around each place [links], shape (P, 4), and their weights
    in it and in its slope, shape (P, 4) each."""
    before = np.minimum(place.astype(np.int64), links - 1)
    t = (place - before)[:, None]
    weight = 0.5 * np.concatenate(
        [-t + 2 * t**2 - t**3, 2 - 5 * t**2 + 3 * t**3, t + 4 * t**2 - 3 * t**3, -(t**2) + t**3], axis=1
    )
    slope = 0.5 * np.concatenate([-1 + 4 * t - 3 * t**2, -10 * t + 9 * t**2, 1 + 8 * t - 9 * t**2, -2 * t + 3 * t**2], axis=1)
    # Beyond an end the line goes straight on: x_-1 = 2 x_0 - x_1.
    index = before[:, None] + np.arange(-1, 3)
    for w in (weight, slope):
        low, high = index[:, 0] < 0, index[:, 3] > links
        w[low, 1] += 2 * w[low, 0]
        w[low, 2] -= w[low, 0]
        w[low, 0] = 0.0
        w[high, 2] += 2 * w[high, 3]
        w[high, 1] -= w[high, 3]
        w[high, 3] = 0.0
    return np.clip(index, 0, links).astype(np.int32), weight, slope


def slopes(chain: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Directions of the smooth line through particles [m], shape (N, 3), at places [links], shape (P, 3)."""
    index, _, weight = smooth(len(chain) - 1, place)
    found = np.einsum("pk,pkd->pd", weight, chain[index])
    length = np.linalg.norm(found, axis=1, keepdims=True)
    return np.divide(found, length, out=np.tile([0.0, 0.0, 1.0], (len(found), 1)), where=length > 0.0)


def frames(along: np.ndarray) -> np.ndarray:
    """Two axes across a line and the one along it, at each of its directions, shape (P, 3, 3). From one to the next they turn as
    little as they can: by the rotation that takes one direction to the next."""
    rows = along.tolist()
    x, y, z = rows[0]
    least = min(range(3), key=lambda d: abs(rows[0][d]))
    across = np.cross(along[0], np.eye(3)[least])
    ux, uy, uz = (across / np.linalg.norm(across)).tolist()
    found = [(ux, uy, uz)]
    for nx, ny, nz in rows[1:]:
        # The rotation of what is across t, with n the next direction: u - (u.n)/(1 + t.n) (t + n).
        side, cosine = ux * nx + uy * ny + uz * nz, 1.0 + x * nx + y * ny + z * nz
        part = side / cosine if cosine > 1e-9 else 0.0
        ux, uy, uz = ux - part * (x + nx), uy - part * (y + ny), uz - part * (z + nz)
        size = (ux * ux + uy * uy + uz * uz) ** 0.5
        ux, uy, uz = ux / size, uy / size, uz / size
        found.append((ux, uy, uz))
        x, y, z = nx, ny, nz
    u = np.array(found)
    return np.stack([u, np.cross(along, u), along], axis=1)


def in_pieces(chain: np.ndarray, gone: np.ndarray, place: np.ndarray, ring: np.ndarray, way: np.ndarray) -> np.ndarray:
    """Vertices of a tube around a line of particles [m], shape (V, 3), whose links are ``gone`` in part, bool, shape (L,).

    Each piece is a line of its own. Of the rings between the particles of a link that is gone, those of either half are a point
    at their particle: they close the piece, and what is between them has no area.
    """
    links = len(gone)
    link = np.minimum(place.astype(np.int64), links - 1)
    part = place - link
    open_ = gone[link] & (part > 0.0) & (part < 1.0)
    at = np.where(open_, link + (part >= 0.5), place)
    centre, frame = np.empty((len(place), 3)), np.tile(np.eye(3), (len(place), 1, 1))
    cut = np.flatnonzero(gone)
    for a, b in zip([0, *(cut + 1).tolist()], [*cut.tolist(), links]):
        own = np.flatnonzero((at >= a) & (at <= b))
        if a == b:
            centre[own] = chain[a]
            continue
        index, weight, _ = smooth(b - a, at[own] - a)
        centre[own] = np.einsum("pk,pkd->pd", weight, chain[a : b + 1][index])
        frame[own] = frames(slopes(chain[a : b + 1], at[own] - a))
    return centre[ring] + np.einsum("va,vad->vd", np.where(open_[ring], 0.0, 1.0)[:, None] * way, frame[ring])


def make_tube(links: int, radius: float, each: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """A tube of this radius [m] around so many links, with ``each`` rings for a link, 0 for as many as show, and round ends:
    triangles, particles and weights of the line at each vertex, and vertices as `Tubes` takes them; shapes (T, 3) and
    three of (V, 4)."""
    each = each or (2 if links <= FEW else 1)
    place = np.arange(each * links + 1) / each
    ends = [(place[0], -c, np.sqrt(1 - c * c)) for c in CAP[::-1]], [(place[-1], c, np.sqrt(1 - c * c)) for c in CAP]
    rings = np.array([*ends[0], *((s, 0.0, 1.0) for s in place), *ends[1]])
    angle = 2 * np.pi * np.arange(SIDES) / SIDES
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    body = np.concatenate(
        [
            np.repeat(rings[:, :1], SIDES, axis=1)[..., None],
            radius * rings[:, None, 2:] * circle,
            np.repeat(radius * rings[:, 1:2], SIDES, axis=1)[..., None],
        ],
        axis=-1,
    ).reshape(-1, 4)
    vertex = np.concatenate([body, [[place[0], 0.0, 0.0, -radius], [place[-1], 0.0, 0.0, radius]]])
    here = np.arange(SIDES)
    there = (here + 1) % SIDES
    low = SIDES * np.arange(len(rings) - 1)[:, None]
    quad = np.stack([low + here, low + there, low + SIDES + there, low + SIDES + here], axis=-1).reshape(-1, 4)
    last, first_pole, last_pole = SIDES * (len(rings) - 1), len(body), len(body) + 1
    triangle = np.concatenate(
        [
            quad[:, [0, 1, 2]],
            quad[:, [0, 2, 3]],
            np.stack([np.full(SIDES, first_pole), there, here], axis=1),
            np.stack([np.full(SIDES, last_pole), last + here, last + there], axis=1),
        ]
    )
    index, weight, _ = smooth(links, vertex[:, 0])
    return triangle.astype(np.int32), index, weight, vertex
