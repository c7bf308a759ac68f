# SPDX-License-Identifier: GPL-2.0-only
"""A body that never moves: its drawn surface, and eight particles at the corners of the box around it, which say where it is."""

from __future__ import annotations

import math
from itertools import product
from typing import Any

import numpy as np

from ..records import dataclass
from ..scene.scene import Shape, Solid
from . import shapes
from .cells import fill_cells
from .contact_body import BodyFrame
from .embed import make_surface
from .lattice import make_lattice
from .model import Layer, Model, Surface
from .springs import equivalent_modulus

ENDS = np.array(list(product((0, 1), repeat=3)))[:, ::-1]
"""Corners of a box, x fastest, shape (8, 3)."""
CELL = np.array([[0, 1, 3, 2, 4, 5, 7, 6]], np.int32)
"""The cell that they are the corners of, shape (1, 8)."""
UPRIGHT = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
"""Axes of an object that is not turned."""


@dataclass(frozen=True, eq=False)
class _Placed:
    """A shape at a spacing, turned; about its centre of mass [m]."""

    corner: np.ndarray
    """Corners of the box around the drawn surface, axes of the world, shape (8, 3)."""
    share: np.ndarray
    """Parts of the mass at them, whose mean is the centre of mass, shape (8,)."""
    surface: Surface
    frame: BodyFrame


def held_model(solid: Solid, h: float, shared: Any, bare: bool = False, across: float = math.inf) -> Model:
    """The model of an object that is held as a whole, with the cells of its contact h [m] wide, those of its depth ``across`` [m]
    where that is less.

    The drawn surface is that of its lattice: each vertex is a weighted sum of the eight corners. ``shared`` makes what equal
    objects share (build.SharedParts). A ``bare`` one, whose contact is found elsewhere, has a surface of one cell, and counts as
    resolved with h.

    Raises cells.TooThin, mesh.MeshError.
    """
    placed = shared.once(_placed, solid.shape, math.inf if bare else h, tuple(map(tuple, solid.rotation)), across)
    edge = placed.frame.cells.edge
    cell = one_cell_as(edge, h) if bare else edge
    return corner_model(solid, cell, placed.corner, shapes.mass(solid) * placed.share, placed.surface, placed.frame, free=None)


def free_model(solid: Solid, h: float, shared: Any, hollow: bool = False, bare: bool = False) -> Model:
    """The same of an object that moves and does not deform, with the corners of a box along its own axes; their centre of mass is
    that of the object. Of one that is ``hollow`` the box is not a cell: it may surround others.

    A ``bare`` mesh, whose contact is found elsewhere, has a surface of one cell, and counts as resolved with h.

    Raises cells.TooThin, mesh.MeshError.
    """
    placed = shared.once(_placed, solid.shape, math.inf if bare else h, UPRIGHT)
    arm, mass = placed.corner @ np.array(solid.rotation).T, shapes.mass(solid) * placed.share
    edge = placed.frame.cells.edge
    cell = one_cell_as(edge, h) if bare else edge
    return corner_model(solid, cell, arm, mass, placed.surface, placed.frame, free=CELL[:0] if hollow else CELL)


def one_cell_as(edge: np.ndarray, h: float) -> np.ndarray:
    """Edges of cells of about h [m] in one cell with these edges [m], both of shape (3,)."""
    return edge / np.maximum(1.0, np.rint(edge / h))


def corner_model(
    solid: Solid,
    cell: np.ndarray,
    arm: np.ndarray,
    mass: np.ndarray,
    surface: Surface,
    frame: BodyFrame,
    *,
    free: np.ndarray | None,
) -> Model:
    """The model of an object with eight particles at the corners of a box, which say where it is.

    Args:
        solid: the object.
        cell: edges of the cells that it counts as resolved with [m], shape (3,).
        arm: places of the corners from its position [m], shape (8, 3).
        mass: masses at them [kg], shape (8,).
        surface: drawn surface, of weighted sums of the corners.
        frame: its cells and the corners in them.
        free: corners of its cell, if there is one, shape (1, 8) or (0, 8), that may move; None for an object that is held.
    """
    return Model(
        name=solid.name,
        position=arm + solid.position,
        velocity=np.zeros((8, 3)) if free is None else solid.velocity + np.cross(solid.spin, arm),
        mass=mass,
        share=np.full(8, shapes.volume(solid.shape) / (8.0 * cell.prod())),
        layer=np.full(8, Layer.BOUNDARY if free is None else Layer.THIN, np.uint8),
        held=np.full(8, free is None),
        spring=np.zeros((0, 2), np.int32),
        spring_type=np.zeros(0, np.uint8),
        constants=np.zeros((0, 4)),
        young=equivalent_modulus(cell, solid.elasticity),
        inertia_error=0.0,
        hexahedron=np.zeros((0, 8), np.int32) if free is None else free,
        cell=tuple(cell.tolist()),
        surface=surface,
        frame=frame,
    )


def _shaped(shared: Any, shape: Shape, h: float, across: float = math.inf) -> tuple[BodyFrame, Surface, np.ndarray]:
    """Cells, and the drawn surface with its vertices [m], shape (V, 3); body frame. Points and vertices go by h where the cells
    of the depth are finer."""
    lattice = make_lattice(fill_cells(shape, min(h, across), loose=True), tied=False)
    grain = h if across < h else 0.0
    surface = make_surface(shape, lattice, grain)
    return BodyFrame(shape, lattice.cells, grain=grain), surface, surface.vertices(lattice.position)


def _placed(shared: Any, shape: Shape, h: float, rotation: tuple[tuple[float, ...], ...], across: float = math.inf) -> _Placed:
    frame, surface, body = shared.once(_shaped, shape, h, across)
    turn = np.array(rotation)
    vertex = body @ turn.T
    low, high = vertex.min(axis=0), vertex.max(axis=0)
    corner = np.where(ENDS, high, low)
    weight = _weights((vertex - low) / (high - low))
    X = (corner @ turn - frame.cells.low) / frame.cells.edge
    drawn = Surface(surface.triangle, np.broadcast_to(np.arange(8, dtype=np.int32), weight.shape), weight, surface.color)
    for array in (corner, weight, X):
        array.setflags(write=False)
    share = _weights(-low[None] / (high - low))[0]
    return _Placed(corner, share, drawn, BodyFrame(shape, frame.cells, rigid=True, corners=X))


def _weights(t: np.ndarray) -> np.ndarray:
    """Trilinear weights of the corners at places in a box, 0 to 1 along each axis, shape (V, 3); shape (V, 8)."""
    return np.stack([np.where(end, t, 1.0 - t).prod(axis=1) for end in ENDS], axis=1)
