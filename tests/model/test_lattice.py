# SPDX-License-Identifier: GPL-2.0-only
"""Particles, springs and layers of a lattice against the naive twin."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from mdanim_lammps.model.embed import _faces
from mdanim_lammps.model.lattice import CORNERS, OFFSETS, Cells, make_lattice
from mdanim_lammps.model.model import Layer
from mdanim_lammps.scene.scene import Box
from model_samples import assert_closed, enclosed_volume, model
from twin import lattice as twin

LAYER = {"inner": Layer.INNER, "sub": Layer.SUB_BOUNDARY, "boundary": Layer.BOUNDARY, "thin": Layer.THIN}
fillings = arrays(bool, st.tuples(*[st.integers(1, 4)] * 3)).filter(np.any)


def cells(filled, edge=(1.0, 1.0, 1.0)):
    """Cells with the lower corner at the origin."""
    return Cells(filled, np.zeros(3), np.array(filled.shape[::-1]) * edge)


@settings(max_examples=150, deadline=None)
@given(fillings)
def test_lattice_equals_its_naive_twin(filled):
    """Number nodes row by row and find every spring, its holders, shares and layers, whatever the filling."""
    lattice = make_lattice(cells(filled))
    nodes, springs = twin.lattice(filled)
    layers = twin.layers(nodes, springs)
    order = sorted(nodes)
    number = {n: i for i, n in enumerate(order)}
    np.testing.assert_array_equal(lattice.share * 8, [nodes[n] for n in order])
    np.testing.assert_array_equal(lattice.layer, [LAYER[layers[n]] for n in order])
    expected = sorted((number[a], number[b], held) for (a, b), held in springs.items())
    assert np.column_stack([lattice.spring, lattice.holders]).tolist() == [list(e) for e in expected]
    steps = (np.array(order) - order[0])[:, ::-1]
    np.testing.assert_allclose(lattice.position - lattice.position[0], steps, atol=1e-12)


@settings(max_examples=50, deadline=None)
@given(fillings)
def test_spring_kinds_and_hexahedra_are_steps_of_the_lattice(filled):
    """Tell the step of every spring by its kind, and the corners of every cell in VTK order."""
    edge = np.array([1.0, 1.1, 0.9])
    lattice = make_lattice(cells(filled, edge))
    step = lattice.position[lattice.spring[:, 1]] - lattice.position[lattice.spring[:, 0]]
    np.testing.assert_allclose(step, OFFSETS[lattice.kind] * edge, atol=1e-12)
    corners = lattice.position[lattice.hexahedron]
    expected = np.broadcast_to(CORNERS * edge, corners.shape)
    np.testing.assert_allclose(corners - corners[:, :1], expected, atol=1e-12)
    assert len(corners) == filled.sum()


@settings(max_examples=50, deadline=None)
@given(fillings)
def test_centre_of_mass_is_the_origin(filled):
    """Weigh particles by their share of cells: the origin is the mean of the cells' centres."""
    lattice = make_lattice(cells(filled))
    np.testing.assert_allclose(lattice.share @ lattice.position, 0, atol=1e-12)
    centres = lattice.position[lattice.hexahedron].mean(axis=1)
    np.testing.assert_allclose(centres.mean(axis=0), 0, atol=1e-12)


@pytest.mark.parametrize(
    ("count", "inner", "sub", "boundary", "thin"),
    [
        pytest.param((1, 1, 1), 0, 0, 0, 8, id="one cell: nothing inside"),
        pytest.param((5, 5, 1), 0, 0, 0, 72, id="plate of one cell"),
        pytest.param((2, 2, 2), 0, 1, 26, 0, id="one particle inside guards all, corners too"),
        pytest.param((4, 4, 4), 1, 26, 98, 0, id="cube"),
        pytest.param((6, 1, 6), 0, 0, 0, 98, id="plate on edge"),
        pytest.param((8, 4, 2), 0, 21, 114, 0, id="two cells: all that is inside touches the boundary"),
    ],
)
def test_layers_of_cuboids(count, inner, sub, boundary, thin):
    """Sort particles into layers (Wcislo 1999, sec. 3.3.2); hand-made numbers."""
    layer = model(Box(tuple(map(float, count))), 1.0).layer
    assert np.bincount(layer, minlength=5).tolist() == [0, inner, sub, boundary, thin]


def test_only_the_thin_part_of_a_body_guards_itself():
    """Find a block with a fin one cell thick: the fin is thin, the block and its foot are not."""
    filled = np.zeros((8, 4, 4), bool)
    filled[:4] = True
    filled[4:, 1, 1] = True
    lattice = make_lattice(cells(filled))
    height = lattice.position[:, 2] - lattice.position[0, 2]
    assert (lattice.layer[height > 4.5] == Layer.THIN).all()
    assert (lattice.layer[height < 4.5] != Layer.THIN).all()


@settings(max_examples=40, deadline=None)
@given(st.tuples(*[st.integers(1, 5)] * 3))
def test_faces_of_a_cuboid_are_a_closed_surface_of_boundary_particles(count):
    """Draw a cuboid by its boundary particles, all of them, with the right volume."""
    lattice = make_lattice(cells(np.ones(count, bool)))
    surface = _faces(lattice)
    assert_closed(surface.triangle)
    vertices = surface.vertices(lattice.position)
    assert enclosed_volume(vertices, surface.triangle) == pytest.approx(np.prod(count), rel=1e-12)
    np.testing.assert_array_equal(surface.index[:, 0], np.flatnonzero(lattice.share < 1))
