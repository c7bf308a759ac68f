# SPDX-License-Identifier: GPL-2.0-only
"""Masses of particles: lattices have the mass, the centre and the second moments of their shapes."""

import numpy as np
import pytest
from mdanim_lammps.features.springs.effect import spring_norm
from mdanim_lammps.model import masses, shapes
from mdanim_lammps.model.build import build_models
from mdanim_lammps.model.lattice import cells_around
from mdanim_lammps.model.masses import HEAVIEST, STEPS, exposed, inertia, pairwise
from mdanim_lammps.model.system import assemble
from mdanim_lammps.model.tensors import largest_eigenvalue, solve
from mdanim_lammps.scene.scene import Box, Cone, Cylinder, Ellipsoid, HoldAll, Mesh, Sphere, SpringConstant, Torus
from model_samples import SHAPES, model, scene, shape_id, solid
from paths import MESHES, REPOSITORY

ROUND = [Sphere(0.5), Ellipsoid((0.6, 0.4, 0.3)), Cylinder(0.5, 1.0), Cylinder(0.3, 2.0), Cone(0.5, 1.0), Torus(1.0, 0.3)]
BOXES = [Box((1.0, 1.0, 1.0)), Box((4.0, 2.0, 1.0)), Box((1.0, 3.0, 6.0)), Box((8.0, 1.0, 1.0))]
FILES = [Mesh(REPOSITORY / "scenes/meshes/duck.ply", 1.0), Mesh(MESHES / "cuboid.obj", 1.0), Mesh(MESHES / "knot.ply", 1.0)]


def moments(body, mass) -> np.ndarray:
    """Second moments about the origin over the mass, shape (3, 3)."""
    return np.einsum("n,na,nb->ab", mass, body.position, body.position) / mass.sum()


def off(shape, found) -> float:
    """Largest error of a moment of inertia about an axis through the centre, by the axes in which both tensors are diagonal."""
    true = shapes.second_moments(shape)
    ratio = np.linalg.eigvals(np.linalg.solve(inertia(true), inertia(found))).real
    return float(np.abs(ratio - 1).max())


@pytest.mark.parametrize("shape", SHAPES, ids=shape_id)
def test_second_moments_are_those_of_the_inside(shape):
    """Sum x x' over the points of a fine grid that are inside: within 0.5 % of the closed form."""
    low, high = shapes.extent(shape)
    axes = [np.linspace(a, b, 121)[:-1] + (b - a) / 240 for a, b in zip(low, high)]
    inside = np.argwhere(shapes.fill(shape, *axes))
    points = np.stack([axes[d][inside[:, 2 - d]] for d in range(3)], axis=1)
    found = points.T @ points / len(points)
    np.testing.assert_allclose(found, shapes.second_moments(shape), atol=0.005 * np.trace(found))


def test_second_moments_of_a_turned_mesh(tmp_path):
    """Turn the points of a mesh: its tensor turns with them, and its products of inertia are not lost."""
    size, turn = np.array([1.0, 2.0, 3.0]), np.linalg.qr(np.random.default_rng(3).standard_normal((3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    points, triangles = shapes.surface(Box(tuple(size)), 5.0)
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in (points @ turn.T).tolist()]
    lines += [f"f {a} {b} {c}" for a, b, c in (triangles + 1).tolist()]
    (tmp_path / "turned.obj").write_text("\n".join(lines))
    found = shapes.second_moments(Mesh(tmp_path / "turned.obj", 2.0))
    np.testing.assert_allclose(found, 4.0 * turn @ np.diag(size**2 / 12) @ turn.T, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("cells", [4, 5, 8])
@pytest.mark.parametrize("shape", [*BOXES, *ROUND, *FILES], ids=shape_id)
def test_moments_of_inertia_are_those_of_the_shape(shape, cells):
    """With four cells across, as `balanced` has, and more: within 0.2 %, where masses by cells are up to 30 % off."""
    body = model(shape, shapes.thickness(shape) / cells, mass=3.0)
    assert off(shape, moments(body, body.mass)) < 0.002
    assert body.inertia_error == pytest.approx(off(shape, moments(body, body.mass)), abs=1e-6)
    assert body.mass.sum() == pytest.approx(3.0, rel=1e-14)
    np.testing.assert_allclose(body.mass @ body.position / 3.0, 0.0, atol=1e-13 * np.abs(body.position).max())


def test_masses_by_cells_are_a_cubes_one_and_two_over_n_squared_off():
    """The excess that the fit takes away: (1 + 2/n^2) by the trapezoidal rule."""
    for n in (2, 3, 4, 8):
        body = model(Box((1.0, 1.0, 1.0)), 1.0 / n)
        assert off(Box((1.0, 1.0, 1.0)), moments(body, body.share)) == pytest.approx(2 / n**2, rel=1e-9)


@pytest.mark.parametrize(
    ("shape", "cells", "kept"),
    [
        *((box, cells, 1.0) for box in BOXES for cells in (4, 6)),
        *((shape, 6, 0.995) for shape in ROUND),
        (Sphere(0.5), 4, 0.83),
        *((shape, 4, 0.91) for shape in ROUND[1:]),
        *((shape, 2, 0.79) for shape in BOXES + ROUND),
    ],
)
def test_the_stable_step_of_springs_is_kept(shape, cells, kept):
    """The largest stable step of springs alone over that of masses by cells: all for cuboids of four cells, all shapes of six."""
    made = scene(solid(shape), resolution=shapes.thickness(shape) / cells)
    system = assemble(build_models(made), made)
    stiff = spring_norm(system, system.stiffness)
    by_cells = system.share / system.share.sum() * system.mass.sum()
    # Eigenvalues of the limits are known to 1 %, steps therefore to 0.5 %.
    assert np.sqrt((stiff / by_cells).max() / (stiff / system.mass).max()) > kept - 0.005


@pytest.mark.parametrize("cells", [1, 2, 3])
@pytest.mark.parametrize("shape", [*BOXES, *ROUND], ids=shape_id)
def test_what_cannot_be_reached_is_told(shape, cells):
    """Few cells: no mass leaves its limits, mass and centre hold, no moment is worse than by cells, and what is left is told."""
    body = model(shape, shapes.thickness(shape) / cells)
    weight = body.mass / (body.share / body.share.sum())
    assert weight.min() > STEPS[-1] ** 2 * 0.7 and weight.max() < HEAVIEST * (1 + 1e-9)
    np.testing.assert_allclose(body.mass @ body.position, 0.0, atol=1e-12)
    left = off(shape, moments(body, body.mass))
    assert left <= off(shape, moments(body, body.share)) + 1e-6
    assert body.inertia_error == pytest.approx(left, abs=1e-6)
    if cells == 1 and shape in BOXES[:1]:
        assert left == pytest.approx(2.0)  # all of it is at the corners
    if cells > 1:
        assert left < 0.45 * off(shape, moments(body, body.share)) + 0.002


def test_a_body_that_is_all_held_has_masses_by_cells():
    """It never turns, so nothing is fitted; partly held it may."""
    held = model(Sphere(0.5), 0.25, hold=(HoldAll(),))
    np.testing.assert_allclose(held.mass, held.share / held.share.sum(), rtol=1e-14)
    assert held.inertia_error == 0.0


def test_masses_do_not_depend_on_springs():
    """One lattice, one set of masses, whatever its elasticity, damping and units of length."""
    one = model(Sphere(0.5), 0.125)
    for other in (model(Sphere(0.5), 0.125, elasticity=SpringConstant(7.0)), model(Sphere(0.5), 0.125, damping=0.2)):
        np.testing.assert_array_equal(other.mass, one.mass)
    small = model(Sphere(0.5e-6), 0.125e-6)
    np.testing.assert_allclose(small.mass, one.mass, rtol=1e-9)


@pytest.mark.parametrize("count", [1, 7, 129, 4096, 10_001, 283_409])
def test_sums_by_blocks_have_the_bits_of_sums_of_rows(monkeypatch, count):
    """So blocks, which stay in the cache, change no mass."""
    monkeypatch.setattr(masses, "BLOCK", 256)
    rows = np.random.default_rng(count).standard_normal((3, count))
    np.testing.assert_array_equal(pairwise(lambda some: rows[:, some].sum(axis=1), 0, count), rows.sum(axis=1))


@pytest.mark.parametrize("shape", [Sphere(0.5), Cone(0.02, 1.0), FILES[0]], ids=shape_id)
def test_a_body_of_many_blocks_has_the_masses_of_one(monkeypatch, shape):
    """With 64 particles in a block, those at their limits or those that are not are summed, whichever are fewer."""
    h = shapes.thickness(shape) / 4
    one = model(shape, h)
    monkeypatch.setattr(masses, "BLOCK", 64)
    many = model(shape, h)
    np.testing.assert_allclose(many.mass, one.mass, rtol=1e-9)
    assert many.inertia_error == pytest.approx(one.inertia_error, abs=1e-9)


def test_outer_faces_at_a_corner():
    """Two cells side by side: three faces at each end corner, and in the middle two at each of four corners."""
    filled = np.ones((1, 1, 2), bool)
    assert exposed(filled).ravel().tolist() == [3, 4, 3] * 4
    assert exposed(filled).sum() == 4 * 10
    assert not exposed(np.ones((3, 3, 3), bool))[1:-1, 1:-1, 1:-1].any()
    assert (exposed(np.ones((3, 4, 5), bool)) > 0).sum() == np.count_nonzero(cells_around(np.ones((3, 4, 5), bool)) < 8)


def test_eigenvalues_and_equations_without_lapack():
    """Against LAPACK: eigenvalues to 1 % from below, solutions to rounding."""
    random = np.random.default_rng(5).standard_normal((50, 3, 3))
    positive = random @ random.transpose(0, 2, 1)
    true = np.linalg.eigvalsh(positive)[:, -1]
    found = largest_eigenvalue(positive)
    assert (found <= true * (1 + 1e-12)).all() and (found >= 0.99 * true).all()
    matrix = np.random.default_rng(6).standard_normal((10, 30))
    matrix, right = matrix @ matrix.T, np.arange(10.0)
    np.testing.assert_allclose(solve(matrix, right), np.linalg.solve(matrix, right), rtol=1e-9)
