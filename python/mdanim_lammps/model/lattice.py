# SPDX-License-Identifier: GPL-2.0-only
"""From filled cells to particles and springs: numbering, neighbour pairs, layers; whole arrays, body frame.

Wcislo 1999, sec. 3.1 and 5.2; formulas in docs/physics-solids.md.
"""

from __future__ import annotations

import math
from itertools import product

import numpy as np

from ..records import dataclass
from .model import Layer

OFFSETS = np.array(
    [
        (1, 0, 0),
        (-1, 1, 0),
        (0, 1, 0),
        (1, 1, 0),
        (-1, -1, 1),
        (0, -1, 1),
        (1, -1, 1),
        (-1, 0, 1),
        (0, 0, 1),
        (1, 0, 1),
        (-1, 1, 1),
        (0, 1, 1),
        (1, 1, 1),
    ]
)
"""Steps (x, y, z) from a particle to its neighbours of higher number: 3 edges, 6 face diagonals and 4 body diagonals.

Steps are in the order of the neighbours' numbers, so springs written particle by particle come out sorted.
"""

INWARD = {2: 27 / 256, 3: 20 / 256, 4: 18 / 256}
"""Part of its face diagonals that a cell on a surface moves from the face outside to the one inside, for 2, 3, 4 or more in line.

docs/physics-solids.md, Bending. Binary fractions, so that springs that are equal by symmetry are equal to the last bit.
"""

EDGES = 3.0
"""Factor of the part of edges over that of diagonals: with this factor a bar under tension is as wide outside as inside."""

AXES = np.count_nonzero(OFFSETS, axis=1)
"""1 for an edge, 2 for a face diagonal, 3 for a body diagonal, shape (13,)."""

CORNERS = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)])
"""Corners (x, y, z) of a cell in the order of a VTK hexahedron."""


@dataclass(frozen=True, slots=True)
class Cells:
    """Which cells of a regular grid a body fills."""

    filled: np.ndarray
    """bool, shape (nz, ny, nx)."""
    low: np.ndarray
    """Lower corner of the grid, body frame [m], shape (3,)."""
    high: np.ndarray
    """Upper corner of the grid, body frame [m], shape (3,)."""

    @property
    def count(self) -> np.ndarray:
        """Cells along x, y, z, shape (3,)."""
        return np.array(self.filled.shape[::-1])

    @property
    def edge(self) -> np.ndarray:
        """Cell edges along x, y, z [m], shape (3,).

        Rounded to 13 digits: 0.3 / 12 and 0.1 / 4 are one length, so that equal cells of different objects
        have equal springs to the last bit.
        """
        return np.array([float(f"{edge:.13g}") for edge in (self.high - self.low) / self.count])


@dataclass(frozen=True, slots=True, eq=False)
class Lattice:
    """N particles, S springs and C cells of a body whose centre of mass is the origin."""

    position: np.ndarray
    """Body frame [m], shape (N, 3)."""
    share: np.ndarray
    """n/8 for n filled cells around a particle [-], shape (N,)."""
    layer: np.ndarray
    """Layer of each particle, uint8, shape (N,)."""
    spring: np.ndarray
    """Neighbour pairs i < j, sorted, int32, shape (S, 2)."""
    kind: np.ndarray
    """Row of OFFSETS of each spring, uint8, shape (S,)."""
    holders: np.ndarray
    """Filled cells around a spring, each counted by its share of the spring (`_parts`) [-], shape (S,)."""
    braced: np.ndarray
    """The same for braced cells [-], shape (S,)."""
    hexahedron: np.ndarray
    """Corner particles of each filled cell, VTK order, int32, shape (C, 8)."""
    cells: Cells
    """The cells, moved with the particles."""


def make_lattice(cells: Cells, tied: bool = True) -> Lattice:
    """Put a particle on every corner of a filled cell and, where they are ``tied``, tie the 18 nearest neighbours that share a
    cell.

    A cell with a corner that no other cell shares is braced by its body diagonals: with edges and face diagonals
    alone, a blow on such a corner pushes it through the cell, where it stays (docs/physics-solids.md). Particles are
    numbered row by row (z slowest, x fastest).
    """
    around = cells_around(cells.filled)
    braced = cells.filled & any_corner(around == 1)
    present = np.flatnonzero(around)
    number = np.full(around.size, -1, np.int32)
    number[present] = np.arange(len(present), dtype=np.int32)
    number = number.reshape(around.shape)
    share = around.ravel()[present] / 8.0
    position = _corner_positions(cells, present)
    centre = share @ position / share.sum()
    moved = Cells(cells.filled, cells.low - centre, cells.high - centre)
    some = (cells.filled, braced, number, present)
    untied = np.zeros((0, 2), np.int32), np.zeros(0, np.uint8), np.zeros(0, np.float32), np.zeros(0, np.float32)
    spring, kind, holders, braces = _springs(*some) if tied else untied
    return Lattice(
        position=position - centre,
        share=share,
        layer=_layers(around).ravel()[present],
        spring=spring,
        kind=kind,
        holders=holders,
        braced=braces,
        hexahedron=_hexahedra(cells.filled, number),
        cells=moved,
    )


def cells_around(filled: np.ndarray) -> np.ndarray:
    """Count the filled cells at each corner of the grid, uint8, shape (nz + 1, ny + 1, nx + 1)."""
    padded = np.pad(filled, 1).astype(np.uint8)
    return sum(_window(padded, start) for start in product((0, 1), repeat=3))


def _window(padded: np.ndarray, start) -> np.ndarray:
    """The view of the padded cells that starts at (z, y, x) and is as large as the grid of corners."""
    return padded[tuple(slice(s, s + n - 1) for s, n in zip(start, padded.shape))]


def _corner_positions(cells: Cells, present: np.ndarray) -> np.ndarray:
    """Positions [m], shape (N, 3), of the corners with these flat numbers."""
    nx, ny, nz = cells.count + 1
    # linspace ends exactly on the faces; low + n * edge need not.
    x, y, z = (np.linspace(a, b, n) for a, b, n in zip(cells.low, cells.high, (nx, ny, nz)))
    position = np.empty((len(present), 3))
    position[:, 0] = x[present % nx]
    position[:, 1] = y[present // nx % ny]
    position[:, 2] = z[present // (nx * ny)]
    return position


def any_corner(mask: np.ndarray) -> np.ndarray:
    """Which cells have a corner in the mask, bool, one shorter than the mask along every axis."""
    nz, ny, nx = np.array(mask.shape) - 1
    found = np.zeros((nz, ny, nx), bool)
    for z, y, x in product((0, 1), repeat=3):
        found |= mask[z : z + nz, y : y + ny, x : x + nx]
    return found


def _springs(filled: np.ndarray, braced: np.ndarray, number: np.ndarray, present: np.ndarray):
    """Pairs (S, 2), rows of OFFSETS, what holding cells and the braced ones among them count (S,), sorted by pair."""
    all_cells, braced_cells = (np.pad(cells, 1).astype(np.float32) for cells in (filled, braced))
    # Shares of cells in springs along their upper and their lower face; 0 where there is no cell.
    inward = _inward(filled)
    parts = {
        axes: [((1.0 - more * m) * all_cells, (1.0 + more * m) * all_cells) for m in inward]
        for axes, more in ((1, EDGES), (2, 1.0))
    }
    _, rows, columns = number.shape
    flat = number.ravel()
    other = np.zeros((len(present), len(OFFSETS)), np.int32)
    holders = np.zeros((len(present), len(OFFSETS)), np.float32)
    braces = np.zeros_like(holders)
    # A corner lies between two cells of each axis: a step of +1 runs along the upper one, a step of -1 along
    # the lower one, and a spring with no step along an axis belongs to both.
    sides = {0: (0, 1), 1: (1,), -1: (0,)}
    for o, (x, y, z) in enumerate(OFFSETS.tolist()):
        counted, stiffened = (np.zeros(number.shape, np.float32) for _ in range(2))
        for start in product(sides[z], sides[y], sides[x]):
            # A body diagonal lies in no face.
            given = [_window(parts[AXES[o]][axis][start[axis]], start) for axis, step in enumerate((z, y, x)) if not step]
            part = math.prod(given[1:], start=given[0]) if given else _window(all_cells, start)
            counted += part
            stiffened += part * _window(braced_cells, start)
        braces[:, o] = stiffened.ravel()[present]
        holders[:, o] = braces[:, o] if AXES[o] == 3 else counted.ravel()[present]
        held = np.flatnonzero(holders[:, o])
        other[held, o] = flat[present[held] + (z * rows + y) * columns + x]
    exists = holders > 0
    spring = np.empty((np.count_nonzero(exists), 2), np.int32)
    spring[:, 0] = np.repeat(np.arange(len(present), dtype=np.int32), np.count_nonzero(exists, axis=1))
    spring[:, 1] = other[exists]
    kind = np.broadcast_to(np.arange(len(OFFSETS), dtype=np.uint8), exists.shape)[exists]
    return spring, kind, holders[exists], braces[exists]


def _inward(filled: np.ndarray) -> list[np.ndarray]:
    """Share that each cell moves from its upper to its lower face across z, y, x [-], float32, padded by one cell all around.

    ``INWARD`` where only its upper side is free, negative where only its lower side is, else 0.
    """
    padded = np.pad(filled, 1)
    moved = []
    for axis in range(3):
        total = np.zeros(padded.shape, np.float32)
        for up in (1, -1):
            outer, line = ~np.roll(padded, -up, axis), padded
            part = np.zeros(padded.shape, np.float32)
            for count in range(2, max(INWARD) + 1):
                # Cells with ``count`` in line, the first of them included: the next ones are inside.
                line = padded & np.roll(line, up, axis)
                part[line] = INWARD[count]
            total += up * part * outer
        moved.append(total)
    return moved


def _layers(around: np.ndarray) -> np.ndarray:
    """Layer of each corner of the grid (0 where there is no particle), uint8.

    A boundary particle is THIN where none of the 26 lattice neighbours is off the boundary. The corner of a
    solid block is not: the particle one body diagonal further in guards it, as in all measurements of the
    barrier.
    """
    inner = around == 8
    boundary = (around > 0) & ~inner
    layer = np.zeros(around.shape, np.uint8)
    layer[inner] = Layer.INNER
    layer[inner & _near(boundary, diagonals=2)] = Layer.SUB_BOUNDARY
    layer[boundary] = Layer.THIN
    layer[boundary & _near(inner, diagonals=3)] = Layer.BOUNDARY
    return layer


def _near(mask: np.ndarray, diagonals: int) -> np.ndarray:
    """True where a neighbour at most one step away along at most ``diagonals`` axes is in the mask."""
    padded = np.pad(mask, 1)
    near = np.zeros_like(mask)
    nz, ny, nx = mask.shape
    for z, y, x in product((0, 1, 2), repeat=3):
        if 0 < sum(step != 1 for step in (z, y, x)) <= diagonals:
            near |= padded[z : z + nz, y : y + ny, x : x + nx]
    return near


def _hexahedra(filled: np.ndarray, number: np.ndarray) -> np.ndarray:
    """Corner particles of the filled cells, int32, shape (C, 8)."""
    nz, ny, nx = filled.shape
    corners = np.empty((np.count_nonzero(filled), 8), np.int32)
    for c, (x, y, z) in enumerate(CORNERS.tolist()):
        corners[:, c] = number[z : z + nz, y : y + ny, x : x + nx][filled]
    return corners
