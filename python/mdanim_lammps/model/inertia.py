# SPDX-License-Identifier: GPL-2.0-only
"""Moments of inertia of a shape of even density: those of the shape itself, not of the lattice that stands for it.

With the second moments S = integral of x x' over the volume, by the volume (shapes.second_moments: closed forms, of a mesh the
sum over the tetrahedra from the origin to its triangles), the tensor of inertia of a mass m is

    I = m (tr(S) 1 - S)    [kg m^2]

so a ball has 2/5 m r^2, a cuboid m (b^2 + c^2)/12 about its edge a, a cylinder m r^2/2 about its axis and m (3 r^2 + h^2)/12
across.
Of a body that is turned by R it is R I R'.
"""

from __future__ import annotations

import numpy as np

from ..scene.scene import Shape
from . import shapes
from .masses import inertia

COMPONENTS = ("xx", "yy", "zz", "xy", "xz", "yz")
"""Components of a tensor in the order in which fix mdanim/rigid takes them."""


def tensor(shape: Shape, mass: float, rotation) -> np.ndarray:
    """Tensor of inertia about the centre of mass, world frame [kg m^2], shape (3, 3), for a mass [kg] and a rotation matrix.

    Raises mesh.MeshError for a mesh that encloses no volume.
    """
    turned = np.array(rotation, float)
    found = turned @ (mass * inertia(shapes.second_moments(shape))) @ turned.T
    return 0.5 * (found + found.T)


def components(tensors: np.ndarray) -> np.ndarray:
    """Ixx Iyy Izz Ixy Ixz Iyz of tensors, shape (M, 3, 3); shape (M, 6)."""
    return np.stack([tensors[:, "xyz".index(a), "xyz".index(b)] for a, b in COMPONENTS], axis=1)


def mobility(tensor: np.ndarray, mass: float, arm: np.ndarray, along: np.ndarray) -> np.ndarray:
    """1/m + (r x n) I^-1 (r x n): how far a free body yields to a push along n at an arm r from its centre [1/kg].

    Args:
        tensor: of inertia [kg m^2], shape (3, 3).
        mass: [kg].
        arm, along: r [m] and the unit vector n, shape (P, 3), in the frame of the tensor.
    """
    lever = np.cross(arm, along)
    return 1.0 / mass + np.einsum("pi,pi->p", lever, np.linalg.solve(tensor, lever.T).T)


def largest_mobility(tensor: np.ndarray, mass: float, arm: np.ndarray) -> np.ndarray:
    """The mobility in the direction in which a free body yields most, at each arm r from its centre [1/kg], shape (P,).

    Args:
        tensor: of inertia [kg m^2], shape (3, 3).
        mass: [kg].
        arm: r [m], shape (P, 3), in the frame of the tensor.
    """
    lever = np.cross(arm[:, None, :], np.eye(3))  # rows are r x e_k
    return 1.0 / mass + np.linalg.eigvalsh(lever @ np.linalg.solve(tensor, lever.transpose(0, 2, 1)))[:, -1]
