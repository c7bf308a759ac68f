# SPDX-License-Identifier: GPL-2.0-only
"""The undeformed body as contact sees it: points of its drawn surface, and the depth below it."""

from __future__ import annotations

import math
from dataclasses import field, fields, replace
from functools import cached_property
from itertools import product
from typing import ClassVar

import numpy as np

from ..records import dataclass
from ..scene.scene import Box, Ellipsoid, PieceShape, Shape, Sphere
from .distance import grid_distance
from .embed import nearest_cell
from .lattice import Cells, any_corner, cells_around
from .nearest import blocks
from .shapes import contains, extent, thickness
from .spread import spread

FLAT, SHARP, DENSE, FINE = 0, 1, 2, 3
"""Kinds of points: inside a side of a cuboid, on an edge or in a corner of a cuboid, of any other shape, and closer ones of a
ball or an ellipsoid of few cells."""
DENSITY = 3
"""Points along a cell edge on shapes that are not cuboids: with 2 a rolling ball strays by a hundredth of its way, with 4 by half
as much as with 3."""
FINE_DENSITY = 4.5
"""Most of the fine points along a cell edge."""
FINE_ACROSS = 18
"""Fine points along the least diameter. Where a ball touches a plane the few points in its patch are not even around its middle,
and their pressures turn the ball: at 100 MPa by up to 12 % of what friction does for points a sixth of the radius apart, by up to
3 % for a ninth."""
WORTHWHILE = 0.9
"""Distance of fine points over that of dense ones from which on there are none."""
MARGIN, MOST_MARGIN = 2, 32
"""Nodes around the grid whose depth is kept, at least and at most, which for a rod of 1 mm and 1 m are 400 MB."""
OUTSIDE = 2
"""Nodes further out whose depth is worked out: where the spline ends it is not that of an endless grid, and a sixth of that error
is left at each next node."""
BEFORE_END = 0.55
"""Cells before the last of these nodes from which on the depth is not a distance: half of one, and the error of the spline."""


NO_SHARERS, NO_SHARES = np.zeros((0, 3), np.int32), np.zeros((0, 3))
"""No points between particles."""


@dataclass(frozen=True, eq=False)
class ContactBody:
    """P points of the drawn surface of a body of N particles, and how deep its inside is; read-only arrays.

    Lattice coordinates X: cells from the lower corner of the grid along the body axes. Flat numbers count x fastest.
    """

    count: np.ndarray
    """Cells nx, ny, nz of the grid, int32, shape (3,)."""
    edge: np.ndarray
    """Cell edges along the body axes [m], shape (3,)."""
    node: np.ndarray
    """Flat number of each particle among the (nx + 1)(ny + 1)(nz + 1) corners of cells, ascending, int32, shape (N,); -1
    where particles are at no cells."""
    filled: np.ndarray
    """Which cells are filled, uint8, shape (nz ny nx,)."""
    cell: np.ndarray
    """Flat number of the filled cell that carries each point, int32, shape (P,)."""
    at: np.ndarray
    """X of each point [-], shape (P, 3)."""
    centre: np.ndarray
    """X of the middle of the area of each point [-], shape (P, 3)."""
    normal: np.ndarray
    """Outward normals of length 1, body frame, shape (P, 3)."""
    area: np.ndarray
    """Part of the drawn surface that each point stands for [m^2], shape (P,)."""
    kind: np.ndarray
    """FLAT, SHARP, DENSE or FINE, uint8, shape (P,). Fine points act on what is flat, and then no dense ones do."""
    depth: np.ndarray | None
    """Depth below the drawn surface [m], the distance to it, negative outside: coefficients of centred quadratic B-splines on the
    nodes -m .. n + m of each axis, shape ((nz + 1 + 2m)(ny + 1 + 2m)(nx + 1 + 2m),) with the margin m. None for a cuboid: the
    distance to its six sides."""
    open: np.ndarray
    """Open parts of sides of a cuboid that others cover (model/cover.py): rows of a side, 0 to 5 for -x, +x, -y, +y, -z, +z, and
    a rectangle, low and high along the first and the second axis across, X, shape (R, 5). A side acts only in its rectangles; a
    side without any acts everywhere."""
    frame: np.ndarray | None = None
    """Four particles that are not in one plane, ascending, int32, shape (4,): contact finds places in a body that does not deform
    by these alone. None for one that deforms."""
    frame_at: np.ndarray | None = None
    """X of each [-], shape (4, 3)."""
    radius: float = 0.0
    """Radius of the surface around each point [m]: above 0 particles are points themselves, each in a cell of its own, one behind
    the other, and the body is never a host."""
    hardness: float = 1.0
    """Stiffness of such a body where it touches others, over that which its material gives."""
    sharer: np.ndarray = field(default_factory=lambda: NO_SHARERS)
    """Particles that carry the points of such a body which lie between particles and follow those of particles, ascending,
    int32, shape (K, 3)."""
    share: np.ndarray = field(default_factory=lambda: NO_SHARES)
    """Their weights, shape (K, 3)."""
    spread: float = 0.0
    """No such point is farther from one of its particles [m]."""
    tears: bool = False
    """Whether particles inside of it become points where a tear lays them bare."""

    @cached_property
    def carried(self) -> np.ndarray:
        """w_i, the area of the surface that each particle carries [m^2], shape (N,): the larger one of that of its fine points
        and that of all others, as either act. Points beyond the cell that carries them have weights below 0. Particles at no
        cells carry nothing; those inside of a body that may tear a cell's share of a face, which they are once they are bare."""
        if self.radius:
            own, of_point = len(self.node), self.area[len(self.node) :, None] * self.share
            return self.area[:own] + np.bincount(self.sharer.ravel(), of_point.ravel(), own) if len(of_point) else self.area
        if (self.node < 0).any():
            return np.zeros(len(self.node))
        fine = self.kind == FINE
        sets = [np.flatnonzero(some) for some in (fine, ~fine) if some.any()]
        most = np.max([_carried(self, some) for some in sets], axis=0)
        if not self.tears:
            return most
        around = cells_around(self.filled.reshape(self.count[::-1]).astype(bool)).ravel()[self.node]
        return np.where(around == 8, np.maximum(most, self.edge.prod() ** (2.0 / 3.0)), most)


@dataclass(frozen=True, eq=False)
class BodyFrame:
    """A shape and the cells that it fills: what a contact body is made from, when one is first asked for."""

    shape: Shape
    cells: Cells
    open: np.ndarray | None = None
    """As that of ContactBody; None where nothing is covered."""
    rigid: bool = False
    """Whether it does not deform."""
    dimensions: ClassVar[int] = 3
    """Dimensions that its particles span: 1 of a line, 2 of a sheet."""
    hardness = 1.0
    """As that of ContactBody."""
    parts = 1
    """Distance of particles over that of points of contact, of lines and sheets."""
    corners: np.ndarray | None = None
    """X of its eight particles, the corners of a box [-], shape (8, 3); None where particles are at the corners of cells."""
    margin: int = MARGIN
    """Nodes around the grid whose depth is kept."""
    tears: bool = False
    """As that of ContactBody."""
    grain: float = 0.0
    """Points are 1 / DENSITY of this apart where cells are smaller [m]."""

    @property
    def radius(self) -> float:
        """Radius of the surface around each of its points [m]."""
        return 0.0

    def stiff(self, radius: float) -> BodyFrame:
        """The frame as one that does not deform, with a depth that is a distance wherever points of this radius [m] touch it."""
        margin = math.ceil(float(((radius + self._beyond_cells) / self.cells.edge).max()) + BEFORE_END)
        return replace(self, rigid=True, margin=min(max(MARGIN, margin), MOST_MARGIN))

    @property
    def known_for(self) -> float:
        """The largest radius of points that touch it [m]."""
        exact = isinstance(self.shape, Box) or not self.rigid
        return math.inf if exact else float(((self.margin - BEFORE_END) * self.cells.edge - self._beyond_cells).min())

    @property
    def _beyond_cells(self) -> np.ndarray:
        """How far the shape extends beyond the grid along each axis [m], shape (3,)."""
        low, high = extent(self.shape)
        return np.maximum(self.cells.low - low, high - (self.cells.low + self.cells.count * self.cells.edge))

    @property
    def spans(self) -> int:
        """Dimensions of a part of it that a joint holds on to."""
        return self.dimensions

    @property
    def bare(self) -> bool:
        """Whether its particles are its points of contact, and nothing is ever in it."""
        return self.dimensions < 3

    @cached_property
    def contact(self) -> ContactBody:
        """The same object at every call."""
        body = make_contact_body(self.shape, self.cells, self.open, self.margin, self.grain)
        if self.corners is not None:
            return _in_box(body, self.corners)
        if self.rigid:
            return frame_of(body)
        return replace(body, tears=True) if self.tears else body

    @cached_property
    def drawn(self) -> np.ndarray:
        """Which particles lie inside the shape or on it, bool, shape (N,): corners of cells may be outside of a shape that is not
        a cuboid."""
        if self.corners is not None:
            return np.zeros(len(self.corners), bool)
        z, y, x = np.nonzero(self.cells.filled)
        cell = np.stack([x, y, z], axis=1)
        corner = cell[:, None] + np.array(list(product((0, 1), repeat=3)))
        # Points on the surface are evaluated a twentieth of a cell towards the middle of a cell.
        place = np.zeros((*(self.cells.count + 1)[::-1], 3))
        place[tuple(np.moveaxis(corner, -1, 0)[::-1])] = 0.9 * corner + 0.1 * (cell[:, None] + 0.5)
        place = place[cells_around(self.cells.filled) > 0]
        return contains(self.shape, self.cells.low + place * self.cells.edge)


def make_contact_body(
    shape: Shape, cells: Cells, open_parts: np.ndarray | None = None, margin: int = MARGIN, grain: float = 0.0
) -> ContactBody:
    """Points and depth of a shape that fills these cells, both about its centre of mass; the depth is kept on so many nodes
    around the grid.

    A cuboid has a point for every boundary particle and side, in the order FLAT, SHARP, then sides -x, +x, -y, +y, -z, +z, then
    particles; none on covered parts of its sides (``open_parts`` as ContactBody.open). Any other shape has points of its true
    surface, 1 / DENSITY of a cell or of a coarser ``grain`` [m] apart, each carried by the nearest cell; behind them a ball or an
    ellipsoid of five cells and less has fine points.
    """
    open_parts = np.zeros((0, 5)) if open_parts is None else open_parts
    boxed = isinstance(shape, Box) or (
        isinstance(shape, PieceShape) and cells.filled.size == 1
    )  # a piece whose points nothing reads
    points = _cuboid(cells, open_parts) if boxed else _dense(shape, cells, grain)
    points = {name: np.ascontiguousarray(field) for name, field in points.items()}  # row by row, as C functions read them
    body = ContactBody(
        count=cells.count.astype(np.int32),
        edge=cells.edge,
        node=np.flatnonzero(cells_around(cells.filled)).astype(np.int32),
        filled=cells.filled.astype(np.uint8).ravel(),
        **points,
        depth=None if boxed else _depth(shape, cells, margin),
        open=open_parts,
    )
    for one in fields(body):
        if isinstance(array := getattr(body, one.name), np.ndarray):
            array.setflags(write=False)
    return body


def _carried(body: ContactBody, some: np.ndarray) -> np.ndarray:
    """Area that each particle carries [m^2], shape (N,), of some points, whose numbers are ascending."""
    cells, nodes = body.count.astype(np.int64), body.count.astype(np.int64) + 1
    particle = np.zeros(nodes.prod(), np.int32)
    particle[body.node] = np.arange(len(body.node), dtype=np.int32)

    def parts(rows: slice) -> tuple[np.ndarray, list[np.ndarray]]:
        """The lowest corner of the cell of some points, and how the absolute weights of its eight corners come about."""
        z, rest = np.divmod(body.cell[some[rows]], cells[0] * cells[1])
        y, x = np.divmod(rest, cells[0])
        inside = [body.at[some[rows], axis] - at for axis, at in enumerate((x, y, z))]
        return (z * nodes[1] + y) * nodes[0] + x, [(1.0 - t, t) for t in inside]

    def weight(part: list[np.ndarray], way: tuple[int, int, int]) -> np.ndarray:
        return np.abs(math.prod(side[end] for side, end in zip(part, way)))

    ways, stretches = list(product((0, 1), repeat=3)), list(blocks(len(some)))
    area = body.area[some]
    for rows in stretches:
        part = parts(rows)[1]
        area[rows] *= sum(weight(part, way) for way in ways)
    carried = np.zeros(len(body.node))
    for way in ways:
        for rows in stretches:
            low, part = parts(rows)
            corner = low + way @ np.array([1, nodes[0], nodes[0] * nodes[1]])
            np.add.at(carried, particle[corner], weight(part, way) * area[rows])
    return carried


BOX = np.array([0, 1, 2, 4], np.int32)
"""The lower corner of a box and the ends of its edges there, x fastest."""


def _in_box(body: ContactBody, corners: np.ndarray) -> ContactBody:
    """The same body as one that does not deform, whose particles are the corners of a box at these X, shape (8, 3)."""
    return replace(body, node=np.full(len(corners), -1, np.int32), frame=BOX, frame_at=np.ascontiguousarray(corners[BOX]))


def frame_of(body: ContactBody) -> ContactBody:
    """The same body as one that does not deform: its frame is of four particles far from each other."""
    nodes = body.count.astype(np.int64) + 1
    z, rest = np.divmod(body.node, nodes[0] * nodes[1])
    X = np.stack([rest % nodes[0], rest // nodes[0], z], axis=1).astype(float)
    x = X * body.edge
    chosen = [int(x.sum(axis=1).argmin())]
    chosen.append(int(((x - x[chosen[0]]) ** 2).sum(axis=1).argmax()))
    across = np.cross(x - x[chosen[0]], x[chosen[1]] - x[chosen[0]])
    chosen.append(int((across**2).sum(axis=1).argmax()))
    chosen.append(int(abs((x - x[chosen[0]]) @ across[chosen[2]]).argmax()))
    frame = np.sort(np.array(chosen, np.int32))
    frame_at = X[frame]
    for array in (frame, frame_at):
        array.setflags(write=False)
    return replace(body, frame=frame, frame_at=frame_at)


# --- cuboids ----------------------------------------------------------------------------------------------------------


def _cuboid(cells: Cells, open_parts: np.ndarray) -> dict[str, np.ndarray]:
    """Fields of the points of a cuboid on what is open of its sides."""
    count, edge = cells.count, cells.edge
    rows = []
    for side, (axis, end) in enumerate(product(range(3), (0, 1))):
        row = _side(count, edge, axis, end)
        if len(parts := open_parts[open_parts[:, 0] == side, 1:]):
            a, b = np.delete(row["at"], axis, axis=1).T[:, :, None]
            acts = ((parts[:, 0] < a) & (a < parts[:, 1]) & (parts[:, 2] < b) & (b < parts[:, 3])).any(axis=1)
            row = {name: field[acts] for name, field in row.items()}
        rows.append(row)
    points = {name: np.concatenate([row[name] for row in rows]) for name in rows[0]}
    order = np.argsort(points["kind"], kind="stable")
    return {name: field[order] for name, field in points.items()}


def _side(count: np.ndarray, edge: np.ndarray, axis: int, end: int) -> dict[str, np.ndarray]:
    """Fields of the points of the lower or upper side across an axis, by ascending particle."""
    steps = [np.arange(n + 1) if a != axis else np.array([end * n]) for a, n in enumerate(count)]
    node = np.stack(np.meshgrid(*steps[::-1], indexing="ij")[::-1], axis=-1).reshape(-1, 3)
    # -1 and 1 where a point lies on the lower or the upper edge of the side across each axis.
    border = (node == count).astype(int) - (node == 0)
    border[:, axis] = 0
    normal = np.zeros((len(node), 3))
    normal[:, axis] = 2 * end - 1
    return {
        "cell": _flat(np.minimum(node, count - 1), count),
        "at": node.astype(float),
        "centre": node - border / 4,
        "normal": normal,
        "area": np.delete(edge, axis).prod() / 2.0 ** abs(border).sum(axis=1),
        "kind": np.where(border.any(axis=1), SHARP, FLAT).astype(np.uint8),
    }


def _flat(place: np.ndarray, count: np.ndarray) -> np.ndarray:
    """Flat numbers, int32, of places (x, y, z), shape (P, 3), in a grid of this many."""
    return (place @ [1, count[0], count[0] * count[1]]).astype(np.int32)


# --- all other shapes -------------------------------------------------------------------------------------------------


def _dense(shape: Shape, cells: Cells, grain: float) -> dict[str, np.ndarray]:
    """Fields of the points of any other shape."""
    edge = max(float(cells.edge.min()), grain)
    sets = [_spread_on(shape, cells, edge / DENSITY, DENSE)]
    fine = max(thickness(shape) / FINE_ACROSS, edge / FINE_DENSITY)
    if isinstance(shape, Sphere | Ellipsoid) and fine < WORTHWHILE * edge / DENSITY:
        sets.append(_spread_on(shape, cells, fine, FINE))
    return {name: np.concatenate([points[name] for points in sets]) for name in sets[0]}


def _spread_on(shape: Shape, cells: Cells, spacing: float, of_kind: int) -> dict[str, np.ndarray]:
    """Fields of points of one kind, so far apart [m]."""
    point, normal, area = spread(shape, spacing)
    around = cells_around(cells.filled)
    z, y, x = np.nonzero(cells.filled & any_corner(around < 8))
    outer = np.stack([x, y, z], axis=1)
    near, _ = nearest_cell(point, cells.low + outer * cells.edge, cells.edge)
    at = (point - cells.low) / cells.edge
    kind = np.full(len(point), of_kind, np.uint8)
    cell = _flat(outer, cells.count)[near]
    return {"cell": cell, "at": at, "centre": at, "normal": normal, "area": area, "kind": kind}


def _depth(shape: Shape, cells: Cells, margin: int) -> np.ndarray:
    """Coefficients of the depth, see ContactBody."""
    out = margin + OUTSIDE
    x, y, z = (low + edge * np.arange(-out, n + out + 1) for low, edge, n in zip(cells.low, cells.edge, cells.count))
    depth = grid_distance(shape, x, y, z)
    inner = slice(OUTSIDE, -OUTSIDE)
    return _spline(depth)[inner, inner, inner].ravel()


def _spline(values: np.ndarray) -> np.ndarray:
    """Coefficients of centred quadratic B-splines that have these values at the nodes, same shape, linear beyond the ends."""
    from scipy.linalg import solve_banded

    for axis in range(values.ndim):
        rows = np.moveaxis(values, axis, 0)
        bands = np.repeat([[1 / 8], [3 / 4], [1 / 8]], len(rows), axis=1)
        bands[1, [0, -1]] = 1
        bands[0, 1] = bands[2, -2] = 0
        solved = solve_banded((1, 1), bands, rows.reshape(len(rows), -1))
        values = np.moveaxis(solved.reshape(rows.shape), 0, axis)
    return values
