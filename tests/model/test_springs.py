# SPDX-License-Identifier: GPL-2.0-only
"""Bodies of springs against linear elasticity and the beam of the textbook, by sparse linear algebra."""

import tracemalloc
from itertools import product
from types import SimpleNamespace

import numpy as np
import pytest
from mdanim_lammps.model import lattice as lattice_module
from mdanim_lammps.model import springs
from mdanim_lammps.model.lattice import AXES, OFFSETS, Cells, make_lattice
from mdanim_lammps.model.springs import dashpots, distinct_rows, reduced_mass, spring_constants, stiffness, types
from mdanim_lammps.scene.scene import Box, SpringConstant, Young
from model_samples import model
from spring_lab import NU, cantilever, stretched


@pytest.mark.parametrize("cells", [1, 2, 4, 6])
def test_a_bar_is_as_stiff_as_its_material_however_thin(cells):
    """Pull a bar 1, 2, 4 or 6 cells thick: E and nu are the material's (within 2e-6 and 1e-5)."""
    young, nu = stretched(model(Box((24.0, cells, cells)), 1.0, elasticity=Young(7.0)))
    assert young / 7.0 == pytest.approx(1.0, abs=1e-5)
    assert nu == pytest.approx(NU, abs=5e-5)


@pytest.mark.parametrize(
    ("size", "cell"),
    [
        pytest.param((28.8, 4.0, 4.0), (1.2, 1.0, 1.0), id="long cells along the pull"),
        pytest.param((24.0, 4.8, 4.8), (1.0, 1.2, 1.2), id="flat cells"),
        pytest.param((24.0, 4.4, 4.8), (1.0, 1.1, 1.2), id="three different edges"),
    ],
)
def test_a_bar_of_cuboid_cells_is_isotropic_too(size, cell, monkeypatch):
    """Pull bars with aspects up to 1.2: exactly, if no cell moves its springs inward; else within 1e-4 and 0.001,
    since edges that are much weaker than diagonals would have to move more than three times their part."""
    count = np.rint(np.divide(size, cell)).astype(int)
    for inward, most in ((dict.fromkeys(lattice_module.INWARD, 0.0), (1e-6, 1e-6)), (lattice_module.INWARD, (1e-4, 1e-3))):
        monkeypatch.setattr(lattice_module, "INWARD", inward)
        lattice = make_lattice(Cells(np.ones(count[::-1], bool), np.zeros(3), np.array(size)))
        k = stiffness(lattice, Young(3.0))
        assert k.min() > 0
        body = SimpleNamespace(position=lattice.position, spring=lattice.spring, stiffness=k, share=lattice.share)
        young, nu = stretched(body)
        assert young / 3.0 == pytest.approx(1.0, abs=most[0])
        assert nu == pytest.approx(NU, abs=most[1])


def test_the_naked_lattice_of_the_paper_is_too_stiff():
    """Pull a bar with one k for every spring: surface springs count fully, E is 1.36 times too large."""
    body = model(Box((12.0, 4.0, 4.0)), 1.0, elasticity=SpringConstant(0.4))
    assert (body.stiffness == 0.4).all()
    assert body.young == pytest.approx(1.0)
    young, _ = stretched(body)
    assert young == pytest.approx(1.36, abs=0.02)


def test_constants_of_a_cube_are_all_equal():
    """Give edges and face diagonals 0.4 E h where cells are cubes."""
    k = spring_constants(np.full(3, 0.05), 3e5)
    np.testing.assert_allclose(k[AXES < 3], 0.4 * 3e5 * 0.05, rtol=1e-14)
    assert (k[AXES == 3] == 0).all()


@pytest.mark.parametrize("brace", [0.0, 0.1, 0.3])
@pytest.mark.parametrize("cell", [(1.0, 1.0, 1.0), (1.2, 1.0, 1.1)])
def test_constants_make_an_isotropic_solid_braced_or_not(cell, brace):
    """Sum k l^2 n n n n over the springs of a cell: C11 = 1.2 E, C12 = C44 = 0.4 E along every axis."""
    cell = np.array(cell)
    # One edge per axis, both diagonals of one face per plane and all four body diagonals belong to a cell.
    offset = OFFSETS * cell
    k = spring_constants(cell, 2.5, brace)
    c = np.einsum("s,si,sj,sk,sl->ijkl", k / (offset**2).sum(1), offset, offset, offset, offset) / cell.prod()
    for i, j in product(range(3), repeat=2):
        assert c[i, i, j, j] == pytest.approx((1.2 if i == j else 0.4) * 2.5, rel=1e-12)
        assert c[i, j, i, j] == pytest.approx((1.2 if i == j else 0.4) * 2.5, rel=1e-12)
    assert c[0, 0, 0, 1] == pytest.approx(0.0, abs=1e-12)


def test_a_corner_pushed_through_its_cell_comes_back():
    """Let the braced corner of a held cube of cells go at any place within its cell: it returns to its own."""
    lattice = make_lattice(Cells(np.ones((3, 3, 3), bool), np.zeros(3), np.full(3, 3.0)))
    corner = len(lattice.position) - 1
    k = stiffness(lattice, Young(1.0))
    mine = (lattice.spring == corner).any(axis=1)
    other = lattice.position[lattice.spring[mine].sum(axis=1) - corner]
    rest = np.linalg.norm(lattice.position[corner] - other, axis=1)
    for start in product((-0.05, -0.3, -0.7, -1.02), repeat=3):
        x = lattice.position[corner] + start
        for _ in range(4000):
            d = x - other
            r = np.linalg.norm(d, axis=1)
            x = x - 0.5 * ((k[mine] * (r - rest) / np.maximum(r, 1e-12)) @ d)
        np.testing.assert_allclose(x, lattice.position[corner], atol=1e-6, err_msg=f"let go at {start}")


def test_dashpots_damp_two_particles_by_the_fraction_asked_for():
    """Take half of critical: 1 and 3 kg on a spring of 12 N/m have m = 3/4 kg, c = 3 N*s/m."""
    spring = np.array([[0, 1]])
    constants = np.column_stack([[12.0], [1.0], reduced_mass(np.array([1.0, 3.0]), spring)])
    pair = SimpleNamespace(constants=constants, spring=spring, spring_type=np.array([1]), object=np.array([0, 0]))
    c = dashpots(pair, np.array([0.5]))
    assert c == pytest.approx([2 * 0.5 * np.sqrt(12.0 * 0.75)])


@pytest.mark.parametrize(
    ("cells", "bend", "tone"),
    [
        # docs/physics-solids.md: measured 1.0007 and 1.0031, 0.992 and 1.0064, 0.992 and 1.0055, 0.996 and 1.0029. Masses by
        # cells would lower the frequency by 0.0093/n^2: half of 4.65 r^2/L^2 with r^2 = 2/n^2 t^2/12 by the cross section, and
        # 0.46 h^2/L^2 by the half layer at the tip.
        pytest.param(2, 0.003, 0.0035, id="2 cells: 0.3 %"),
        pytest.param(3, 0.010, 0.007, id="3 cells: 1 % and 0.7 %"),
        pytest.param(4, 0.010, 0.006, id="4 cells: 1 % and 0.6 %"),
        pytest.param(8, 0.005, 0.004, id="8 cells: 0.5 % and 0.4 %"),
    ],
)
def test_cantilever_against_timoshenko(cells, bend, tone):
    """Bend a clamped bar and let it swing: deflection and first frequency, L/t = 10."""
    deflection, frequency = cantilever(cells)
    assert deflection == pytest.approx(1.0, abs=bend)
    assert frequency == pytest.approx(1.0, abs=tone)


def test_types_keep_every_bit():
    """Give springs one type exactly when their constants agree in every bit, and as few bytes as the number of types allows."""
    constants = np.full((4, 3), 0.1)
    constants[:, 0] = 1.0, np.nextafter(1.0, 2.0), 1.0, 2.0
    kind, table = types(constants)
    assert kind.tolist() == [1, 2, 1, 3] and kind.dtype == np.uint8
    assert np.array_equal(table[kind - 1], constants)
    kind, table = types(np.repeat(np.arange(256.0), 3)[:, None] * np.ones(3))
    assert kind.tolist() == np.repeat(np.arange(1, 257), 3).tolist() and len(table) == 256


def test_distinct_rows_are_the_same_in_blocks_and_take_little_memory(monkeypatch):
    """Kinds are numbered by first appearance whatever the blocks; a million numbers take half as much memory again."""
    draw = np.random.default_rng(5)
    rows = draw.integers(0, 40, 333_000)[:, None] * np.array([1.0, 0.1, -3.0])
    tracemalloc.start()
    first, which = distinct_rows(rows)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 0.6 * rows.nbytes
    _, seen = np.unique(rows[:, 0], return_index=True)
    np.testing.assert_array_equal(first, np.sort(seen))
    np.testing.assert_array_equal(rows[first][which], rows)
    monkeypatch.setattr(springs, "ROWS", 7)
    for ours, theirs in zip(distinct_rows(rows[:500]), (first[first < 500], which[:500])):
        np.testing.assert_array_equal(ours, theirs)
    assert [len(part) for part in distinct_rows(rows[:0])] == [0, 0]


def test_distinct_rows_are_told_apart_by_bits(monkeypatch):
    """0.0 and -0.0 are two rows; the first ones come in the order in which they appear, also where all keys collide."""
    rows = np.array([[3.0, 0.0], [1.0, 2.0], [3.0, -0.0], [1.0, 2.0], [3.0, 0.0], [0.5, 0.5]])
    first, which = distinct_rows(rows)
    assert first.tolist() == [0, 1, 2, 5] and which.tolist() == [0, 1, 2, 1, 0, 3]
    unique = np.unique
    monkeypatch.setattr(np, "unique", lambda a, **k: unique(a if a.ndim > 1 else 0 * a, **k))
    first, which = distinct_rows(rows)
    assert first.tolist() == [0, 1, 2, 5] and which.tolist() == [0, 1, 2, 1, 0, 3]
