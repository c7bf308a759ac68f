# SPDX-License-Identifier: GPL-2.0-only
"""Surfaces of shapes and meshes as sheets: their geometry, triangles, springs against closed forms, and what is refused."""

import math

import numpy as np
import pytest
import sheet_cases
from mdanim_lammps.features.sheets.drawn import both_sides
from mdanim_lammps.features.sheets.tiled import Tiled, tiled
from mdanim_lammps.model import shapes
from mdanim_lammps.model.build import build_models
from mdanim_lammps.model.distance import distance
from mdanim_lammps.model.remesh import remeshed
from mdanim_lammps.model.triangles import areas, edges
from mdanim_lammps.scene.scene import Box, Cone, Cylinder, HoldFaces, Mesh, Shell, Side, Sphere, Torus
from model_samples import SHAPES, assert_closed, scene, shape_id, solid
from paths import MESHES

CLOSED = [shape for shape in SHAPES if not isinstance(shape, Mesh)]


def spacing(shape, particles: int = 400) -> float:
    return math.sqrt(2.0 / math.sqrt(3.0) * shapes.shell_surface(Shell(shape, 1e-3)).area / particles)


def random_rectangle(lx: float, ly: float, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """A rectangle about the origin, of triangles of all kinds."""
    from scipy.spatial import Delaunay

    rng = np.random.default_rng(seed)
    n, m = 6, max(2, round(6 * ly / lx))
    border = [(x, y) for x in np.linspace(0, lx, n + 1) for y in (0.0, ly)]
    border += [(x, y) for y in np.linspace(0, ly, m + 1)[1:-1] for x in (0.0, lx)]
    points = np.concatenate([border, rng.uniform(0.1, 0.9, (20, 2)) * (lx, ly)])
    triangle = Delaunay(points).simplices
    a, b, c = (points[triangle[:, k]] for k in range(3))
    area = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    triangle[area < 0] = triangle[area < 0][:, ::-1]
    flat = np.column_stack([points - (0.5 * lx, 0.5 * ly), np.zeros(len(points))])
    return flat, triangle[np.abs(area) > 1e-9].astype(np.int32)


# --- geometry -----------------------------------------------------------------------------------------------------------


def test_formulas_of_a_shell_around_a_ball():
    """Volume is area times thickness, moments those of a hollow ball; the distance is positive in its layer alone."""
    shell = Shell(Sphere(0.5), 0.02)
    assert shapes.volume(shell) == pytest.approx(math.pi * 0.02) and shapes.thickness(shell) == 0.02
    np.testing.assert_allclose(shapes.second_moments(shell), np.eye(3) * 0.25 / 3.0, atol=1.5e-3)
    away = distance(shell, np.array([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.7, 0.0]]))
    np.testing.assert_allclose(away, [-0.49, 0.01, -0.19], atol=2e-3)


def test_place_of_a_shell_is_the_middle_of_its_area():
    """The one of a cone is not that of the solid: base and mantle, r^2 at the bottom and r s with its middle at a third."""
    r, h = 0.5, 1.2
    base, mantle = r**2, r * math.hypot(r, h)
    above = (mantle * h / 3.0) / (base + mantle)
    low = shapes.extent(Shell(Cone(r, h), 1e-3))[0][2]
    assert low == pytest.approx(-above - 0.5e-3, rel=3e-3)


@pytest.mark.parametrize("shape", CLOSED, ids=shape_id)
def test_triangles_are_even_and_close(shape):
    """Edges of about the spacing, as many particles as asked for, closed, creases and area kept."""
    h = spacing(shape)
    skin = shapes.shell_surface(Shell(shape, 1e-3))
    made = tiled(Shell(shape, 1e-3), h)
    assert_closed(made.triangle)
    edge = made.edge
    length = np.linalg.norm(made.place[edge[:, 0]] - made.place[edge[:, 1]], axis=1) / h
    assert length.min() > 0.3 and length.max() < 1.7 and 0.95 < np.median(length) < 1.06
    assert len(made.place) == pytest.approx(400, rel=0.15)
    assert len(made.place) - len(edge) + len(made.triangle) == (0 if isinstance(shape, Torus) else 2)
    area = areas(made.place, made.triangle)
    assert area.sum() == pytest.approx(skin.area, rel=0.02)
    sharp = made.creases
    lines = {Box: 8.0, Cylinder: 4.0 * math.pi * 0.4, Cone: 2.0 * math.pi * 0.5}.get(type(shape), 0.0)
    kept = np.linalg.norm(made.place[sharp[:, 0]] - made.place[sharp[:, 1]], axis=1).sum()
    assert kept == pytest.approx(lines, rel=0.01)


@pytest.mark.parametrize("shape", [Sphere(0.1), Torus(0.1, 0.04)], ids=shape_id)
def test_few_triangles_of_what_is_smooth_have_no_creases(shape):
    """A coarser surface that is bent sharply between two triangles was taken for one with creases, and the nearest of none
    searched."""
    found = tiled(Shell(shape, 1e-3), 0.05)
    _, uses = np.unique(np.sort(edges(found.triangle), axis=1), axis=0, return_counts=True)
    assert (uses == 2).all() and not len(found.creases)


def test_an_own_triangulation_of_that_size_stays():
    """Triangles of about the spacing are particles as they are."""
    made = tiled(Shell(Sphere(0.5), 1e-3), 0.1)
    points, triangle, _ = remeshed(made.place, made.triangle, 0.1)
    assert points is made.place and triangle is made.triangle


def test_an_open_mesh_keeps_its_border():
    """A box without a lid: its rim stays, all of it is drawn on both sides, and it is open."""
    shell = Shell(Mesh(MESHES / "open.obj", 0.1), 1e-3)
    made = tiled(shell, 0.05)
    assert not made.closed
    edge, uses = np.unique(np.sort(edges(made.triangle), axis=1), axis=0, return_counts=True)
    rim = edge[uses == 1]
    assert np.linalg.norm(made.place[rim[:, 0]] - made.place[rim[:, 1]], axis=1).sum() > 0.5
    assert len(np.unique(edges(made.triangle), axis=0)) == 3 * len(made.triangle)
    assert areas(made.place, made.triangle).sum() == pytest.approx(shapes.volume(shell) / 1e-3, rel=1e-3)
    drawn = both_sides(made.triangle, len(made.place), made.creases)
    np.testing.assert_allclose(drawn.weight.sum(axis=1), 1.0)


# --- springs ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("particles", "seed", "axis", "off"), [(400, 0, 0, 0.04), (400, 1, 1, 0.04), (1200, 0, 1, 0.02)])
def test_random_triangles_pull_as_the_material(particles, seed, axis, off):
    """E t and Poisson's ratio 1/3 of a triangulation without order; its borders are uneven, so it is the better the finer."""
    h = math.sqrt(2.0 / math.sqrt(3.0) * 0.8 / particles)
    layer = Tiled(*remeshed(*random_rectangle(1.0, 0.8, seed), h), h, False)
    pull, across = sheet_cases.pulled_layer(layer, (1.0, 0.8), axis)
    assert pull == pytest.approx(1.0, abs=off) and across == pytest.approx(1.0 / 3.0, abs=0.03)


@pytest.mark.parametrize(("width", "h"), [(0.1, 0.01), (0.05, 0.01), (0.05, 0.005)])
def test_strips_of_random_triangles_bend_as_beams(width, h):
    """P l^3/3 E I within 3 %; the wide strip is stiffer by up to 1 - nu^2, as plates are, and free sides are uneven."""
    layer = Tiled(*remeshed(*random_rectangle(0.5, width, 0), h), h, False)
    assert sheet_cases.tip(layer) == pytest.approx(1.0, abs=0.03)


def test_what_is_flat_is_in_balance():
    """Springs that resist bending push, and others hold them: no particle of a flat one has a force."""
    layer = Tiled(*remeshed(*random_rectangle(1.0, 0.8, 0), 0.05), 0.05, False)
    pair, value = layer.springs(1e6, 2e-3, 1.0, np.zeros(len(layer.place), bool))
    assert (value[:, 0] > 0).all() and (value[:, 1] > 0).all()
    way = layer.place[pair[:, 1]] - layer.place[pair[:, 0]]
    pull = (value[:, 0] * (1.0 - value[:, 1] / value[:, 2]))[:, None] * way
    total = np.zeros_like(layer.place)
    np.add.at(total, pair[:, 0], pull)
    np.add.at(total, pair[:, 1], -pull)
    assert np.abs(total).max() < 1e-10 * np.abs(pull).max()


def test_a_ball_yields_to_pressure_as_a_membrane():
    """p r^2 (1 - nu)/2 E t, within 2 %."""
    assert sheet_cases.blown(tiled(Shell(Sphere(0.5), 2e-3), 0.1)) == pytest.approx(1.0, abs=0.02)


def test_a_cube_bends_freely_at_its_edges():
    """Springs over two links lie in one side each."""
    made = tiled(Shell(Box((1.0, 1.0, 1.0)), 1e-3), 0.2)
    pair, _ = made.springs(1e6, 1e-3, 1.0, np.zeros(len(made.place), bool))
    on = np.abs(np.abs(made.place) - 0.5) < 1e-9
    signed = np.where(on, np.sign(made.place), 0.0)
    assert ((signed[pair[:, 0]] * signed[pair[:, 1]]) > 0).any(axis=1).all()


# --- models -------------------------------------------------------------------------------------------------------------


def test_a_model_has_mass_place_and_faces():
    """Density times area times thickness, the centre of mass at its place within a thousandth, held particles on a face."""
    shape = Shell(Cylinder(0.4, 1.0), 0.01)
    model = build_models(
        scene(solid(shape, mass=None, density=1000.0, position=(1.0, 2.0, 3.0), hold=(HoldFaces((Side("-z"),)),)))
    )[0]
    assert model.mass.sum() == pytest.approx(1000.0 * shapes.area(Cylinder(0.4, 1.0)) * 0.01)
    np.testing.assert_allclose(model.mass @ model.position / model.mass.sum(), (1.0, 2.0, 3.0), atol=2e-3)
    np.testing.assert_allclose(model.position[model.held, 2], 2.5, atol=1e-9)
    assert model.held.sum() > 20 and model.frame.closed and model.frame.bare
