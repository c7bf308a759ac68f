# SPDX-License-Identifier: GPL-2.0-only
"""From solids to models: what holds for every body, and what a solid's keywords do to it."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mdanim_lammps.errors import SceneError
from mdanim_lammps.model import shapes
from mdanim_lammps.model.build import build_models
from mdanim_lammps.model.model import Layer
from mdanim_lammps.scene.scene import Box, Cylinder, HoldAll, HoldFaces, HoldWithin, Mesh, Side, Sphere, SpringConstant, Young
from model_samples import SHAPES, assert_closed, model, rotation, scene, shape_id, solid
from paths import REPOSITORY
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

every_shape = pytest.mark.parametrize("shape", SHAPES, ids=shape_id)
number = st.floats(-3.0, 3.0)
vectors = st.tuples(number, number, number)


@settings(max_examples=60, deadline=None)
@given(st.sampled_from(SHAPES), st.floats(1.5, 5.0), st.floats(1e-3, 1e3), vectors, vectors, vectors, vectors)
def test_what_holds_for_every_body(shape, cells, mass, position, angles, velocity, spin):
    """Keep mass, centre of mass, momentum, order of springs and layers for any solid that can be built."""
    try:
        body = model(
            shape,
            shapes.thickness(shape) / cells,
            mass=mass,
            position=position,
            rotation=rotation(*angles),
            velocity=velocity,
            spin=spin,
        )
    except SceneError:
        # Only a tip or a neck that this spacing misses may keep a shape from being built.
        assert cells < 3
        return
    n = len(body.position)
    # A sum of n terms in pairs is exact to a few units in the last place.
    assert body.mass.sum() == pytest.approx(mass, rel=1e-15)
    hair = 1e-13 * (1 + np.abs(position).max())
    np.testing.assert_allclose(body.mass @ body.position / mass, position, atol=hair)
    np.testing.assert_allclose(body.mass @ body.velocity / mass, velocity, atol=1e-13)
    np.testing.assert_allclose(body.velocity - velocity, np.cross(spin, body.position - position), atol=1e-12)

    i, j = body.spring.astype(np.int64).T
    assert (i >= 0).all() and (i < j).all() and (j < n).all()
    assert (np.diff(i * n + j) > 0).all()
    length = np.linalg.norm(body.position[j] - body.position[i], axis=1)
    np.testing.assert_allclose(length, body.rest, rtol=1e-12)
    assert (body.stiffness > 0).all()
    graph = coo_matrix((np.ones(len(i)), (i, j)), (n, n))
    assert connected_components(graph, directed=False)[0] == 1

    boundary = body.layer >= Layer.BOUNDARY
    np.testing.assert_array_equal(boundary, body.share < 1)
    touches = np.zeros(n, bool)
    touches[j[boundary[i]]] = touches[i[boundary[j]]] = True
    np.testing.assert_array_equal(body.layer == Layer.SUB_BOUNDARY, touches & ~boundary)
    assert body.hexahedron.min() >= 0 and body.hexahedron.max() < n
    np.testing.assert_allclose(np.bincount(body.hexahedron.ravel(), minlength=n) / 8, body.share)
    for array in (body.spring, body.hexahedron, body.surface.index, body.surface.triangle):
        assert array.dtype == np.int32


@every_shape
def test_turning_a_solid_turns_its_model(shape):
    """Rotate particles, velocities and drawn surface with the solid and change nothing else."""
    h = shapes.thickness(shape) / 4
    turn = rotation(0.3, -1.1, 2.0)
    here, there = model(shape, h), model(shape, h, rotation=turn, position=(1.0, -2.0, 3.0))
    expected = here.position @ np.array(turn).T + (1.0, -2.0, 3.0)
    np.testing.assert_allclose(there.position, expected, atol=1e-14 * 4)
    for name in ("mass", "spring", "stiffness", "rest", "layer", "share"):
        np.testing.assert_array_equal(getattr(here, name), getattr(there, name))
    np.testing.assert_allclose(
        there.surface.vertices(there.position),
        here.surface.vertices(here.position) @ np.array(turn).T + (1.0, -2.0, 3.0),
        atol=1e-13,
    )


@every_shape
def test_the_drawn_surface_is_the_shape_itself(shape):
    """Embed the true surface: closed, weights that sum to 1, vertices on the shape, not on the staircase."""
    h = shapes.thickness(shape) / 4
    body = model(shape, h)
    assert_closed(body.surface.triangle)
    np.testing.assert_allclose(body.surface.weight.sum(axis=1), 1, rtol=1e-12)
    vertices = body.surface.vertices(body.position)
    assert np.abs(shapes.depth(shape, vertices)).max() < 1e-6 * h + 1e-9
    assert len(np.unique(body.surface.triangle)) == len(vertices)


@pytest.mark.parametrize("cells", [3, 4, 6, 10])
def test_surface_of_a_sphere_stays_with_its_particles(cells):
    """Draw a ball within 0.6 h of the ball, also stretched evenly: the embedding is exact for that."""
    radius = 0.5
    h = 2 * radius / cells
    body = model(Sphere(radius), h)
    stretch = np.diag([1.2, 0.9, 1.0])
    vertices = body.surface.vertices(body.position @ stretch) @ np.linalg.inv(stretch)
    assert np.abs(np.linalg.norm(vertices, axis=1) - radius).max() < 1e-9
    middle = vertices[body.surface.triangle].mean(axis=1)
    assert np.abs(np.linalg.norm(middle, axis=1) - radius).max() < 0.6 * h


def test_cuboids_have_particles_on_faces_edges_and_corners():
    """Put the outermost particles exactly on the cuboid (Wcislo 1999, sec. 5.2)."""
    body = model(Box((0.7, 0.5, 0.3)), 0.1)
    half = np.array([0.35, 0.25, 0.15])
    on = np.isclose(np.abs(body.position), half, rtol=0, atol=1e-15)
    np.testing.assert_array_equal(on.sum(axis=1) > 0, body.layer >= Layer.BOUNDARY)
    assert (on.sum(axis=1) == 3).sum() == 8
    assert body.surface.index.shape[1] == 1


def test_density_is_mass_over_the_true_volume():
    """Weigh a ball by its volume, not by that of its cells."""
    ball = Sphere(0.5)
    body = model(ball, 0.25, mass=None, density=800.0)
    assert body.mass.sum() == pytest.approx(800 * np.pi / 6, rel=1e-14)


def test_elasticity_is_young_or_one_k():
    """Scale springs with Young's modulus; give every spring the k that the scene asks for."""
    soft, hard = (model(Box((4.0, 4.0, 4.0)), 1.0, elasticity=Young(e)) for e in (1.0, 1e6))
    np.testing.assert_allclose(hard.stiffness, soft.stiffness * 1e6, rtol=1e-14)
    assert hard.young == 1e6
    literal = model(Box((4.0, 4.0, 4.0)), 1.0, elasticity=SpringConstant(20.0))
    assert (literal.stiffness == 20.0).all()
    assert literal.young == pytest.approx(50.0)


def test_springs_know_the_reduced_mass_of_their_ends():
    """By masses by filled cells, not by those that fit the moments of the shape."""
    body = model(Box((2.0, 2.0, 2.0)), 1.0, mass=6.0)
    i, j = body.spring.T
    mass = 6.0 * body.share / 8.0
    np.testing.assert_allclose(body.constants[body.spring_type - 1, 2], 1 / (1 / mass[i] + 1 / mass[j]), rtol=1e-14)


# --- hold ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("hold", "count"),
    [
        pytest.param(HoldFaces((Side.MINUS_X,)), 5 * 4, id="one face"),
        pytest.param(HoldFaces((Side.MINUS_X, Side.PLUS_X)), 2 * 5 * 4, id="two faces"),
        pytest.param(HoldFaces((Side.PLUS_X, Side.PLUS_Z)), 5 * 4 + 7 * 5 - 5, id="two faces with a common edge"),
        pytest.param(HoldWithin((-3.0, -2.0, -1.5), (-3.0, 2.0, 1.5)), 5 * 4, id="a flat box on a face"),
        pytest.param(HoldWithin((-0.1, -9.0, -9.0), (9.0, 9.0, 9.0)), 4 * 5 * 4, id="half of it"),
        pytest.param(HoldAll(), 8, id="all, which has the corners of a box"),
    ],
)
def test_hold_catches_exactly_these_particles(hold, count):
    """Hold particles of 6 x 4 x 3 cells on faces, or within a box of the world, and stop them."""
    body = model(Box((6.0, 4.0, 3.0)), 1.0, hold=(hold,), velocity=(1.0, 0.5, 0), spin=(0, 2.0, 0))
    assert body.held.sum() == count
    assert (body.velocity[body.held] == 0).all()
    assert (body.velocity[~body.held] != 0).any(axis=1).all()


def test_hold_follows_the_body_and_within_the_world():
    """Turn a cuboid by 90 degrees about z: its +x face looks along y, the box of the world stays."""
    turned = dict(rotation=rotation(0, 0, np.pi / 2), position=(10.0, 0.0, 0.0))
    body = model(Box((6.0, 4.0, 3.0)), 1.0, hold=(HoldFaces((Side.PLUS_X,)),), **turned)
    np.testing.assert_allclose(body.position[body.held, 1], 3.0, atol=1e-14)
    body = model(Box((6.0, 4.0, 3.0)), 1.0, hold=(HoldWithin((12.0, -9, -9), (13.0, 9, 9)),), **turned)
    np.testing.assert_allclose(body.position[body.held, 0], 12.0, atol=1e-14)
    assert body.held.sum() == 7 * 4


def test_hold_of_a_round_body_is_its_outermost_layer():
    """Hold the disc of particles at the foot of a cylinder."""
    body = model(Cylinder(0.5, 1.0), 0.125, hold=(HoldFaces((Side.MINUS_Z,)),))
    foot = body.position[:, 2] == body.position[:, 2].min()
    np.testing.assert_array_equal(body.held, foot)
    assert foot.sum() > 30


def test_a_body_that_is_all_held_has_no_springs():
    """Leave springs out where nothing can move, and keep mass and surface."""
    body = model(Box((4.0, 4.0, 4.0)), 1.0, hold=(HoldAll(),), damping=0.1)
    assert body.spring.shape == (0, 2)
    assert len(body.stiffness) == len(body.rest) == 0
    assert body.mass.sum() == pytest.approx(1.0) and len(body.surface.triangle) == 192


def test_a_hold_that_catches_nothing_is_a_problem():
    """Point at the hold, and tell where the object is."""
    with pytest.raises(SceneError) as caught:
        model(Box((1.0, 1.0, 1.0)), 0.25, hold=(HoldWithin((2.0, 0, 0), (3.0, 1, 1)),))
    (problem,) = caught.value.problems
    assert problem.line == 4 and "catches no particle" in problem.message
    assert "from (-0.5, -0.5, -0.5) to (0.5, 0.5, 0.5) m" in problem.hint


# --- many objects -------------------------------------------------------------------------------------------


def test_equal_objects_share_what_cannot_change():
    """Make the springs of a thousand equal cubes once, read-only; give each its own positions."""
    cubes = [solid(Box((0.2, 0.2, 0.2)), f"cube[{i}]", position=(0.3 * i, 0, 0)) for i in range(1000)]
    models = build_models(scene(*cubes, resolution=0.1))
    assert [m.name for m in models] == [c.name for c in cubes]
    assert all(
        m.spring is models[0].spring and m.spring_type is models[0].spring_type and m.mass is models[0].mass for m in models
    )
    assert not models[0].spring.flags.writeable and not models[0].mass.flags.writeable
    assert models[0].position.flags.writeable and not np.shares_memory(models[0].position, models[1].position)
    apart = models[-1].position - models[0].position
    np.testing.assert_allclose(apart, [(299.7, 0, 0)] * 27, rtol=1e-13, atol=1e-13)


def test_objects_of_other_stuff_do_not_share_it():
    """Share the lattice, not the springs, between a soft and a hard cube of one shape."""
    cube = solid(Box((0.2, 0.2, 0.2)))
    soft, hard, heavy = build_models(scene(cube, replace(cube, elasticity=Young(2.0)), replace(cube, mass=3.0), resolution=0.1))
    assert soft.spring is hard.spring
    assert hard.stiffness[0] == 2 * soft.stiffness[0]
    assert heavy.mass[0] == pytest.approx(3 * soft.mass[0])


def test_all_problems_of_all_solids_come_in_one_pass():
    """Report two bad holds of two objects together."""
    nothing = (HoldWithin((9.0, 9, 9), (10.0, 10, 10)),)
    box = Box((1.0, 1.0, 1.0))
    with pytest.raises(SceneError) as caught:
        build_models(scene(solid(box, "a", hold=nothing), solid(box, "b"), solid(box, "c", hold=nothing)))
    assert [p.message[0] for p in caught.value.problems] == ["a", "c"]


def test_models_without_a_mesh_need_no_vtk():
    """Build every other shape without importing VTK."""
    import subprocess
    import sys

    code = (
        "import sys; sys.path.insert(0, 'tests/lab')\n"
        "from model_samples import SHAPES, model\n"
        "[model(s, 0.1) for s in SHAPES[:-1]]\n"
        "assert not {'pyvista', 'vtk', 'vtkmodules'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True, cwd=REPOSITORY)
    assert isinstance(SHAPES[-1], Mesh)
