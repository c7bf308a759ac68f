# SPDX-License-Identifier: GPL-2.0-only
"""One solid as particles, springs and a drawable surface: frozen records of arrays, with unit and shape."""

from __future__ import annotations

from enum import IntEnum
from typing import TYPE_CHECKING

import numpy as np

from ..records import dataclass
from .nearest import blocks
from .tube import Tubes

if TYPE_CHECKING:
    from .contact_body import BodyFrame


class Layer(IntEnum):
    """Where a particle lies in its object (Wcislo 1999, sec. 3.3.2); these are also the LAMMPS atom types."""

    INNER = 1
    """Not on the boundary, and no neighbour on the boundary."""
    SUB_BOUNDARY = 2
    """Not on the boundary, and at least one neighbour on the boundary."""
    BOUNDARY = 3
    """On the surface: not all eight cells around it are filled."""
    THIN = 4
    """On the boundary, and so are all its lattice neighbours: the particle is its own barrier (docs/physics-solids.md)."""


@dataclass(frozen=True, slots=True)
class Surface:
    """Triangles for pictures; a vertex is a weighted sum of particle positions, so the surface deforms with the particles."""

    triangle: np.ndarray
    """Vertex indices, counter-clockwise seen from outside, int32, shape (T, 3)."""
    index: np.ndarray
    """Particles of which a vertex is the sum, int32, shape (V, K); K is 1 for boxes, 8 for embedded surfaces."""
    weight: np.ndarray
    """Their weights, rows sum to 1, shape (V, K)."""
    color: np.ndarray | None = None
    """RGB of the vertices, uint8, shape (V, 3); None where a mesh file has none, and for all other shapes."""
    tube: np.ndarray | None = None
    """Ways from the sums of particle positions to the vertices of a tube around a chain of particles, as `tube.Tubes` takes them,
    shape (V, 4); None of all else."""
    patch: np.ndarray | None = None
    """Patch of each vertex of what may tear (`patches.py`), int32, shape (V,); None of all else."""

    def vertices(self, position: np.ndarray) -> np.ndarray:
        """Vertex positions [m], shape (V, 3), for particle positions [m], shape (N, 3)."""
        found = np.empty((len(self.index), 3))
        for rows in blocks(len(self.index)):
            found[rows] = np.einsum("vk,vkd->vd", self.weight[rows], position[self.index[rows]])
        return found if self.tube is None else found + Tubes([(slice(0, len(position)), self.tube)]).around(position)


@dataclass(frozen=True)
class Particles:
    """N particles and S springs of few types: what one solid and a whole system have in common."""

    position: np.ndarray
    """At the start, world frame [m], shape (N, 3)."""
    velocity: np.ndarray
    """At the start [m/s], shape (N, 3); zero for held particles."""
    mass: np.ndarray
    """[kg], shape (N,)."""
    share: np.ndarray
    """Filled share of the eight cells around a particle, n/8 [-], shape (N,)."""
    layer: np.ndarray
    """Layer of each particle, uint8, shape (N,)."""
    held: np.ndarray
    """Particles that never move, bool, shape (N,)."""
    spring: np.ndarray
    """Neighbour pairs i < j, 0-based, sorted by (i, j), int32, shape (S, 2)."""
    spring_type: np.ndarray
    """Type of each spring, from 1, the smallest unsigned integers that do, shape (S,)."""
    constants: np.ndarray
    """k [N/m], r0 [m], the reduced mass of both ends, with masses by filled cells [kg], and the length in the body without load
    [m] of each type, in the order in which they appear, shape (T, 4). This length is r0 where the spring is then without load."""
    hexahedron: np.ndarray
    """Corners of every filled lattice cell, particle indices in VTK order, int32, shape (C, 8)."""

    @property
    def stiffness(self) -> np.ndarray:
        """k of each spring, eq. (3.6) [N/m], shape (S,)."""
        return self._constant(0)

    @property
    def rest(self) -> np.ndarray:
        """Rest length r0 of each spring [m], shape (S,)."""
        return self._constant(1)

    @property
    def unloaded(self) -> np.ndarray:
        """Length of each spring in the body without load [m], shape (S,); springs of a rope hold each other under load."""
        return self._constant(3)

    @property
    def preload(self) -> np.ndarray:
        """Pull of each spring in the body without load [N], shape (S,)."""
        return self.stiffness * (self.unloaded - self.rest)

    @property
    def preload_energy(self) -> np.ndarray:
        """Energy of each spring in the body without load [J], shape (S,)."""
        return 0.5 * self.stiffness * (self.unloaded - self.rest) ** 2

    def _constant(self, column: int) -> np.ndarray:
        return self.constants[self.spring_type - 1, column]


@dataclass(frozen=True)
class Model(Particles):
    """One solid; particles are numbered row by row, x fastest. The mass-weighted mean of its positions is that of the scene."""

    name: str
    cell: tuple[float, float, float]
    """Cell edges along the body axes [m]."""
    young: float
    """Young's modulus [Pa]; for ``elasticity spring k`` that of an endless lattice of this k."""
    inertia_error: float
    """Largest error of a moment of inertia about an axis through the centre, over that of the shape [-]; 0 where all is held."""
    surface: Surface
    frame: BodyFrame
    """Its shape and cells; objects of equal shape share one, and with it the contact body."""
    pinned: np.ndarray | None = None
    """Particles that are held until they are let go, bool, shape (N,); None for none. Otherwise they are as all that move."""
    driven: bool = False
    """Whether some effect moves its held particles."""
    tears: bool = False
    """Whether its springs may break: it is then drawn by patches (`patches.py`)."""
    inertia: np.ndarray | None = None
    """Tensor of inertia about the centre of mass, world frame, at the start [kg m^2], shape (3, 3), of a body that moves as a
    whole; None of a body that deforms, or is held."""

    @property
    def still(self) -> bool:
        """Whether it never moves: all of it is held, and nothing drives it."""
        return bool(self.held.all()) and not self.driven

    @property
    def spacing(self) -> float:
        """Longest cell edge [m]; sets the reach of the contact barrier."""
        return max(self.cell)
