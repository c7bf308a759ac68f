# SPDX-License-Identifier: GPL-2.0-only
"""Which part of each cell a lattice body fills, with samples spread over cells."""

import ctypes
from itertools import product

import numpy as np
import pytest
from plugin_library import library
from scipy.spatial.transform import Rotation

CORNERS = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], float)
"""Of a lattice cell, in VTK order."""


def shares(cells, shape=(16, 16, 16), spread=True):
    """Share of each cell (nz, ny, nx) that lattice cells (n, 8, 3), in cells, fill."""
    cells = np.ascontiguousarray(cells, np.float64)
    count = np.empty(shape, np.int32)
    nz, ny, nx = shape
    library().mdanim_occupancy_of_cells(
        nx, ny, nz, len(cells), ctypes.c_void_p(cells.ctypes.data), int(spread), ctypes.c_void_p(count.ctypes.data)
    )
    return count / library().mdanim_occupancy_full(int(spread))


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


def test_what_is_outside_is_left_out():
    """A cube half out of the basin counts half; one that is nowhere counts nothing."""
    assert shares(block(4, (0, 8, 8))).sum() == pytest.approx(32.0, abs=0.01)
    assert shares(block(4, (-9, 8, 8))).sum() == 0.0
    assert shares(block(2, (np.nan, 8, 8))).sum() == 0.0
