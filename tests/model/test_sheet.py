# SPDX-License-Identifier: GPL-2.0-only
"""Sheets as shapes, their lattice and springs against closed forms, and both sides that are drawn."""

import math

import numpy as np
import pytest
import sheet_cases
from mdanim_lammps.features.sheets.drawn import both_sides
from mdanim_lammps.features.sheets.weave import weave
from mdanim_lammps.model import shapes
from mdanim_lammps.model.build import build_models
from mdanim_lammps.model.distance import distance
from mdanim_lammps.scene.scene import HoldFaces, Sheet, Side
from model_samples import SHEET, rotation, scene, solid

SIZES = [((1.0, 1.0), 0.03), ((1.0, 0.1), 0.02), ((0.1, 1.0), 0.02), ((0.3, 0.5), 0.1), ((0.02, 1.0), 0.02)]


def made(shape=SHEET, **rest):
    return build_models(scene(solid(shape, **rest)))[0]


def test_formulas_of_a_sheet_are_those_of_a_plate():
    """Volume, extent, moments; the distance to it is that to a cuboid."""
    assert shapes.volume(SHEET) == pytest.approx(0.008) and shapes.thickness(SHEET) == 0.01
    np.testing.assert_allclose(shapes.extent(SHEET)[1], (0.5, 0.4, 0.005))
    points = np.array([[0.0, 0.0, 0.0], [0.6, 0.0, 0.0], [0.53, 0.44, 0.0], [0.0, 0.0, -0.105]])
    np.testing.assert_allclose(distance(SHEET, points), [0.005, -0.1, -0.05, -0.1], atol=1e-15)


@pytest.mark.parametrize(("size", "h"), SIZES)
def test_triangles_cover_it_and_particles_have_its_mass(size, h):
    """All corners have a particle; triangles face +z and share all their edges but those of the border; the centre of mass and
    moments are those of the sheet."""
    woven = weave(Sheet(size, 0.001), h)
    place = woven.place
    for corner in ((-1, -1), (1, -1), (-1, 1), (1, 1)):
        assert np.abs(place - 0.5 * np.array(corner) * size).max(axis=1).min() < 1e-12
    a, b, c = (place[woven.triangle[:, k]] for k in range(3))
    area = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    assert (area > 0).all() and area.sum() == pytest.approx(size[0] * size[1])
    assert set(woven.triangle.ravel()) == set(range(len(place)))
    edges = np.sort(woven.triangle[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    _, uses = np.unique(edges, axis=0, return_counts=True)
    assert (uses == 1).sum() == 2 * (woven.along + woven.rows) and uses.max() == 2
    share = woven.share / woven.share.sum()
    np.testing.assert_allclose(share @ place, 0.0, atol=1e-15)
    wide = (share @ place**2) / (np.array(size) ** 2 / 12.0)
    assert (wide > 1.0).all() and wide[1] < 1.0 + 3.0 / woven.rows**2 and wide[0] < 1.0 + 3.0 / woven.along**2


@pytest.mark.parametrize(("size", "h"), SIZES)
def test_springs_hold_each_other(size, h):
    """Without load no particle is pulled, lengths are those of the lattice, and no pair has two springs."""
    woven = weave(Sheet(size, 0.01), h)
    pair, (k, rest, length) = (found := woven.springs(1e6, 0.01, 1.0, np.zeros(len(woven.place), bool)))[0], found[1].T
    assert len(np.unique(pair, axis=0)) == len(pair) and (pair[:, 0] < pair[:, 1]).all() and (k > 0).all() and (rest > 0).all()
    way = woven.place[pair[:, 1]] - woven.place[pair[:, 0]]
    np.testing.assert_allclose(np.linalg.norm(way, axis=1), length, rtol=1e-12)
    pull = (k * (length - rest) / length)[:, None] * way
    force = np.zeros_like(woven.place)
    np.add.at(force, pair[:, 0], pull)
    np.add.at(force, pair[:, 1], -pull)
    assert np.abs(force).max() < 1e-10 * 1e6 * 0.01 * h


CLOSED = [name for name in sheet_cases.CASES if name.split()[0] in ("pull", "modulus", "cantilever")]


@pytest.mark.parametrize("name", CLOSED)
def test_closed_forms(name):
    """E t along x, y and between; P l^3/3 E I. From the matrix of springs."""
    case, most = sheet_cases.CASES[name]
    found, expected = case()
    assert found == pytest.approx(expected, rel=most)


def test_poisson_s_ratio_is_a_third():
    """In the middle of a sheet that is pulled, and between the axes."""
    assert sheet_cases.pulled((1.0, 0.3), 0.02, 0)[1] == pytest.approx(1 / 3, rel=0.03)
    for angle in (0.0, 0.6, math.pi / 2):
        assert sheet_cases.modulus((1.0, 1.0), 0.025, angle)[1] == pytest.approx(1 / 3, rel=0.01)


def test_bending_scales_its_rigidity():
    """Nothing bears a bend with 0, twice as much with 2; E t stays."""
    woven = weave(Sheet((1.0, 0.5), 0.002), 0.05)
    free = np.zeros(len(woven.place), bool)
    found = [sheet_cases.across(*woven.springs(1e6, 0.002, f, free), len(free)) for f in (0.0, 1.0, 2.0)]
    assert abs(found[0]).max() == 0.0 and abs(found[2] - 2.0 * found[1]).max() < 1e-12 * abs(found[1]).max()


def test_a_strip_twists_as_a_plate_does():
    """With rods; an energy of the angle between triangles, of the same rigidity, resists twice as much."""
    rods, angles = (sheet_cases.bends(kind) for kind in ("rods", "angles"))
    assert rods["force"] == pytest.approx(1.0, rel=0.02) and rods["couple"] == pytest.approx(1.0, rel=0.06)
    assert angles["force"] == pytest.approx(1.0, rel=0.03) and angles["couple"] == pytest.approx(0.5, rel=0.05)


def test_both_sides_are_drawn_smooth():
    """Each side all of it, through all particles, and on a ball between them too."""
    woven = weave(Sheet((1.0, 1.0), 0.001), 0.05)
    surface = both_sides(woven.triangle, len(woven.place))
    np.testing.assert_allclose(surface.weight.sum(axis=1), 1.0, atol=1e-14)
    flat = np.column_stack([woven.place, np.zeros(len(woven.place))])
    drawn = surface.vertices(flat)
    a, b, c = (drawn[surface.triangle[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)[:, 2]
    assert normal[normal > 0].sum() == pytest.approx(2.0, rel=1e-3) and normal[normal < 0].sum() == pytest.approx(-2.0, rel=1e-3)
    x, y = woven.place.T
    bent = np.column_stack([x, y, np.sqrt(1.0 - x**2 - y**2)])
    off = np.abs(np.linalg.norm(surface.vertices(bent), axis=1) - 1.0)
    inside = np.abs(surface.vertices(flat)[:, :2]).max(axis=1) < 0.4
    assert off[inside].max() < 2e-5 and off.max() < 2e-3  # triangles alone are off by h^2/8 = 3e-4


def test_sides_and_turns():
    """Sides of a turned sheet are its own; their particles are at rest where it moves."""
    held = HoldFaces((Side.MINUS_X,))
    turned = made(rotation=rotation(0.3, 0.2, 0.1), hold=(held,), velocity=(1.0, 2.0, 3.0), position=(1.0, 1.0, 1.0))
    body = (turned.position - (1.0, 1.0, 1.0)) @ np.array(rotation(0.3, 0.2, 0.1))
    np.testing.assert_allclose(body[turned.held, 0], -0.5)
    assert turned.held.sum() == turned.frame.woven.rows + 1 and not turned.velocity[turned.held].any()
    assert turned.mass.sum() == pytest.approx(1.0) and np.abs(body[:, 2]).max() < 1e-12
