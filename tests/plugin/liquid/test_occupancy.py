# SPDX-License-Identifier: GPL-2.0-only
"""Which part of each cell a lattice body fills, with samples spread over cells."""

import ctypes
from itertools import product

import numpy as np
import pytest
from plugin_library import library
from scipy.spatial.transform import Rotation

CORNERS = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], float)
"""Corners of a lattice cell, in VTK order."""


def counted(cells, shape=(16, 16, 16), spread=True, layers=None):
    """Share of each cell (nz, ny, nx) that lattice cells (n, 8, 3), in cells, fill; `layers` (n,) of others are around them.
    And the box of cells that were touched, low and high along x, y, z."""
    cells = np.ascontiguousarray(cells, np.float64)
    count = np.empty(shape, np.int32)
    nz, ny, nx = shape
    layers = None if layers is None else np.ascontiguousarray(layers, np.int32)
    box = np.empty((2, 3), np.int32)
    pointers = [ctypes.c_void_p(None if a is None else a.ctypes.data) for a in (cells, layers)]
    found = [ctypes.c_void_p(a.ctypes.data) for a in (count, box)]
    library().mdanim_occupancy_of_cells(nx, ny, nz, len(cells), *pointers, int(spread), *found)
    return count / library().mdanim_occupancy_full(int(spread)), box


def shares(*arguments, **keywords):
    """The first of what `counted` tells."""
    return counted(*arguments, **keywords)[0]


def block(side, at, turn=None, bend=0.0):
    """Lattice cells of a cube about a place, turned, and bent by up to `bend` cells."""
    first = np.array(list(product(range(side), repeat=3)), float)
    cells = (first[:, None, :] + CORNERS - side / 2) @ (np.eye(3) if turn is None else turn.as_matrix()).T
    return cells + bend * np.sin(cells[..., [1, 2, 0]]) + at


@pytest.mark.parametrize("seed", range(6))
def test_all_of_a_body_is_counted_and_its_inside_is_shut(seed):
    """The volume of a turned and bent cube, to the weight's rounding; cells well inside are solid (31/32 and more)."""
    turn = Rotation.random(random_state=seed)
    at = np.random.default_rng(seed).uniform(7.5, 8.5, 3)
    bend = 0.05 if seed % 2 else 0.0
    found = shares(block(8, at, turn, bend))
    assert found.sum() == pytest.approx(8**3, rel=1e-3 + 0.05 * bend)
    z, y, x = np.meshgrid(*[np.arange(16) + 0.5] * 3, indexing="ij")
    inside = (x - at[0]) ** 2 + (y - at[1]) ** 2 + (z - at[2]) ** 2 < 2.2**2
    assert inside.sum() > 20 and found[inside].min() > 31 / 32 and found.max() < 1.03


def test_a_cube_on_the_grid_fills_its_cells_and_no_other():
    """Whole cells are whole, to the last unit, and half cells half."""
    found = shares(block(4, (8, 8, 8)))
    assert (found[6:10, 6:10, 6:10] == 1.0).all() and found.sum() == 64.0
    found = shares(block(4, (8, 8, 8.5)))
    assert found[6, 7, 7] == pytest.approx(0.5, abs=1e-3) and found[10, 7, 7] == pytest.approx(0.5, abs=1e-3)


@pytest.mark.parametrize("seed", range(3))
def test_counts_follow_a_body_smoothly(seed):
    """A small shift changes each cell by no more than its face would sweep; samples at points jump by a third of a cell."""
    turn = Rotation.random(random_state=seed) if seed else None
    step = 0.01
    path = [shares(block(4, (8.3 + step * n, 8.1, 8.2), turn)) for n in range(60)]
    change = np.abs(np.diff(path, axis=0)).max()
    assert change < 1.6 * step
    jumps = [shares(block(4, (8.3 + step * n, 8.1, 8.2), turn), spread=False) for n in range(60)]
    assert np.abs(np.diff(jumps, axis=0)).max() > 3 * change


@pytest.mark.parametrize("edge", [1.0, 0.8, 0.6])
@pytest.mark.parametrize("seed", range(6))
def test_cells_deep_inside_are_filled_without_samples(seed, edge):
    """Filled cells would have been filled, to 1/32, most full cells are among them, and no other count changes."""
    side, at = 14, np.random.default_rng(seed).uniform(9.5, 10.5, 3)
    turn = Rotation.random(random_state=seed) if seed else None
    first = np.array(list(product(range(side), repeat=3)))
    layers = np.minimum(first, side - 1 - first).min(axis=1)
    cells = edge * block(side, at / edge, turn, bend=0.05 if seed % 2 else 0.0)
    sampled, found = shares(cells, (20, 20, 20)), shares(cells, (20, 20, 20), layers=layers)
    filled, full = found > 2.0, sampled > 31 / 32
    assert full[filled].all()
    assert np.array_equal(np.minimum(found[~filled], 1.0), np.minimum(sampled[~filled], 1.0))
    assert filled.sum() / full.sum() > {1.0: 0.55, 0.8: 0.35, 0.6: 0.2}[edge]


def test_what_is_stretched_or_near_the_surface_is_sampled():
    """Longer edges leave gaps, and few layers do not reach: counts are those of samples."""
    cells = block(6, (8, 8, 8))
    assert np.array_equal(shares(1.2 * cells, layers=np.full(216, 8)), shares(1.2 * cells))
    assert np.array_equal(shares(cells, layers=np.full(216, 1)), shares(cells))
    assert not np.array_equal(shares(cells, layers=np.full(216, 2)), shares(cells))


def test_what_is_outside_is_left_out():
    """A cube half out of the basin counts half; one that is nowhere counts nothing."""
    assert shares(block(4, (0, 8, 8))).sum() == pytest.approx(32.0, abs=0.01)
    assert shares(block(4, (-9, 8, 8))).sum() == 0.0
    for layers in (None, np.full(8, 8)):
        assert shares(block(2, (np.nan, 8, 8)), layers=layers).sum() == 0.0
        assert shares(block(2, (1e9, 8, -1e300)), layers=layers).sum() == 0.0


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("at", [-8.0, 30.0])
@pytest.mark.parametrize("layers", [None, 8])
def test_a_body_beside_or_above_the_basin_touches_no_box(axis, at, layers):
    """Neither by samples nor deep inside: a box that has grown along two axes alone would be read beyond all memory."""
    place = np.full(3, 8.0)
    place[axis] = at
    found, (low, high) = counted(block(8, place), layers=None if layers is None else np.full(8**3, layers))
    assert found.sum() == 0.0
    assert (low >= high).all()
