# SPDX-License-Identifier: GPL-2.0-only
"""Tables of solids for a liquid: their lattice cells, by the particles at their corners."""

from __future__ import annotations

import numpy as np

from ...model.system import System


def lattice_cells(system: System) -> np.ndarray:
    """Tags (from 1) of corners 1 to 7 of the lattice cell whose corner 0 a particle is, int32, shape (N, 7).

    Corners in VTK order; 0 where it is none. Raises ValueError where a particle is corner 0 of two cells.
    """
    table = np.zeros((system.particles, 7), np.int32)
    owner = system.hexahedron[:, 0]
    if len(np.unique(owner)) != len(owner):
        raise ValueError("a particle is the first corner of two lattice cells")
    table[owner] = system.hexahedron[:, 1:] + 1
    return table


MOST_LAYERS = 8
"""Lattice cells whose layers are told apart, from the surface on."""


def layers_of_cells(system: System) -> np.ndarray:
    """How many lattice cells lie between each one and the surface of its solid, MOST_LAYERS at most, int32, shape (C,)."""
    reached = np.bincount(system.hexahedron.ravel(), minlength=system.particles) < 8  # a corner of fewer cells than meet inside
    layer = np.full(len(system.hexahedron), MOST_LAYERS, np.int32)
    for n in range(MOST_LAYERS):
        here = reached[system.hexahedron].any(axis=1)
        layer[here] = np.minimum(layer[here], n)
        reached[system.hexahedron[here]] = True
    return layer
