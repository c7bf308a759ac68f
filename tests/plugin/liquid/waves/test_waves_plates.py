# SPDX-License-Identifier: GPL-2.0-only
"""Plates of one lattice cell across the basin: what stands on them stays there, at any height and slope."""

import ctypes

import numpy as np
import pytest
import waves_lab as lab
from plugin_library import library

SHAPE = (20, 16, 16)
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float)
"""Corners of a lattice cell, in VTK order."""


def turned(degrees):
    """A rotation about x and then y."""
    a, b = np.radians(degrees)
    about_x = [[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]]
    about_y = [[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]]
    return np.array(about_y) @ about_x


def plate(thickness, height, rotation, wide=44):
    """Solid parts of all cells."""
    cell = np.stack(np.meshgrid(np.arange(wide), np.arange(wide), [0], indexing="ij"), -1).reshape(-1, 1, 3)
    corners = (cell + CORNERS - [wide / 2, wide / 2, 0.5]) * [1, 1, thickness] @ rotation.T + [8, 8, height]
    corners, count = np.ascontiguousarray(corners), np.zeros(np.prod(SHAPE), np.int32)
    pointer = lambda a: a.ctypes.data_as(ctypes.c_void_p)
    nz, ny, nx = SHAPE
    library().mdanim_occupancy_of_cells(nx, ny, nz, len(corners), pointer(corners), None, 1, pointer(count), None)
    full = library().mdanim_occupancy_full(1)
    return np.minimum(lab.SOLID, (count.astype(np.int64) * lab.SOLID + full // 2) // full).reshape(SHAPE)


@pytest.mark.parametrize("slope", [(0, 0), (5, 0), (20, 0), (0, 35), (25, 20), (40, 0)], ids=str)
@pytest.mark.parametrize("height", [9.6, 9.85, 10.1])
@pytest.mark.parametrize("thickness", [0.91, 1.0, 1.5])
def test_a_plate_holds_what_stands_on_it(thickness, height, slope):
    """For 600 updates not a unit gets below it."""
    rotation = turned(slope)
    y, x = np.mgrid[0:16, 0:16] + 0.5
    normal = rotation[:, 2]
    middle = height - (normal[0] * (x - 8) + normal[1] * (y - 8)) / normal[2]
    waves = lab.Waves(SHAPE)
    waves.solids(plate(thickness, height, rotation))
    waves.pour(max(14.0, middle.max() + 2.0), above=middle)
    total = waves.total
    waves.update(600)
    spans = waves.spans
    below = spans.floor + spans.roof < 2 * middle.ravel()[spans.column]
    assert below.sum() >= 200 and total > 700 * lab.UNIT
    assert spans.content[below].sum() == 0 and waves.total == total


def test_a_column_beside_a_body_is_not_cut():
    """A body fills half of the columns at its flank; they stay whole, though what is in them is as much as a plate."""
    part = np.zeros(SHAPE, int)
    part[8:11, 5:11, 5:11] = lab.SOLID
    part[8:11, 5:11, 11] = lab.SOLID // 2
    waves = lab.Waves(SHAPE)
    waves.solids(part)
    column = waves.spans.column
    assert np.count_nonzero(column == 7 * 16 + 11) == 1 and np.count_nonzero(column == 7 * 16 + 7) == 2
