# SPDX-License-Identifier: GPL-2.0-only
"""Moments of inertia of shapes: closed forms, and integrals by another way."""

import numpy as np
import pytest
from mdanim_lammps.model.inertia import components, largest_mobility, mobility, tensor
from mdanim_lammps.scene.rotation import rotation_euler
from mdanim_lammps.scene.scene import Box, Cone, Cylinder, Ellipsoid, Mesh, Sphere, Torus
from model_samples import MESHES

M = 3.0
FORMS = {
    Box((0.1, 0.2, 0.3)): M / 12 * np.array([0.2**2 + 0.3**2, 0.1**2 + 0.3**2, 0.1**2 + 0.2**2]),
    Sphere(0.2): M * 0.4 * 0.2**2 * np.ones(3),
    Ellipsoid((0.1, 0.2, 0.3)): M / 5 * np.array([0.2**2 + 0.3**2, 0.1**2 + 0.3**2, 0.1**2 + 0.2**2]),
    Cylinder(0.2, 0.5): M * np.array([0.2**2 / 4 + 0.5**2 / 12] * 2 + [0.2**2 / 2]),
    Cone(0.2, 0.5): M * np.array([3 / 20 * 0.2**2 + 3 / 80 * 0.5**2] * 2 + [0.3 * 0.2**2]),
    Torus(0.3, 0.1): M * np.array([0.3**2 / 2 + 5 / 8 * 0.1**2] * 2 + [0.3**2 + 3 / 4 * 0.1**2]),
}
"""Principal moments [kg m^2] as books have them."""


@pytest.mark.parametrize("shape", FORMS, ids=lambda shape: type(shape).__name__)
def test_closed_forms(shape):
    """Along the axes of the body; turned, R I R'."""
    np.testing.assert_allclose(tensor(shape, M, np.eye(3)), np.diag(FORMS[shape]), rtol=1e-12, atol=1e-15)
    turn = np.array(rotation_euler((0.3, -1.1, 2.0)))
    np.testing.assert_allclose(tensor(shape, M, turn), turn @ np.diag(FORMS[shape]) @ turn.T, rtol=1e-12, atol=1e-15)


def test_a_mesh_is_the_sum_over_its_tetrahedra():
    """Points at random inside it have the same, to their noise: 1/sqrt(N) of a moment."""
    from mdanim_lammps.model import mesh, shapes

    knot = Mesh(MESHES / "knot.ply", 0.01)
    low, high = shapes.extent(knot)
    point = low + np.random.default_rng(1).random((200_000, 3)) * (high - low)
    inside = point[mesh.contains(mesh.load(knot), point)]
    square = np.einsum("nd,nd->n", inside, inside)
    sampled = M * (square.mean() * np.eye(3) - np.einsum("nd,ne->de", inside, inside) / len(inside))
    found = tensor(knot, M, np.eye(3))
    np.testing.assert_allclose(found, sampled, atol=5.0 * np.abs(found).max() / len(inside) ** 0.5)


def test_components_are_in_the_order_of_the_fix():
    """Ixx Iyy Izz Ixy Ixz Iyz."""
    assert components(np.array([[[1, 4, 5], [4, 2, 6], [5, 6, 3]]])).tolist() == [[1, 2, 3, 4, 5, 6]]


def test_mobility_of_a_corner_of_a_cube():
    """1/m (1 + 6 (2 s^2/4) / s^2) = 4/m."""
    cube = tensor(Box((0.2, 0.2, 0.2)), M, np.eye(3))
    along = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]])
    found = mobility(cube, M, np.array([[0.1, 0.1, 0.1], [0.0, 0.0, 0.1]]), along)
    np.testing.assert_allclose(found, [4.0 / M, 1.0 / M], rtol=1e-12)


def test_the_largest_mobility_is_that_of_the_best_direction():
    """No other direction of many yields more, and the best of them nearly as much."""
    turn, random = np.array(rotation_euler((0.3, -1.1, 2.0))), np.random.default_rng(1)
    box, arm = tensor(Box((0.1, 0.2, 0.3)), M, turn), random.normal(size=(3, 3))
    along = random.normal(size=(20_000, 3))
    along /= np.linalg.norm(along, axis=1)[:, None]
    tried = np.array([mobility(box, M, np.broadcast_to(r, along.shape), along).max() for r in arm])
    found = largest_mobility(box, M, arm)
    assert (tried <= found * (1 + 1e-12)).all() and (tried > 0.999 * found).all()
