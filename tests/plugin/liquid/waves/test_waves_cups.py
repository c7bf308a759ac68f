# SPDX-License-Identifier: GPL-2.0-only
"""Cups of a held bottom and four held walls, each of one lattice cell: they hold what is in them, wherever they stand."""

import ctypes

import numpy as np
import pytest
import waves_lab as lab
from plugin_library import library

NZ, NY, NX = SHAPE = (16, 24, 24)
INNER, HIGH = 10.0, 9.0
"""Width and height of the room in a cup [cells]."""
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float)
"""Corners of a lattice cell, in VTK order."""


def box(size, at):
    """Corners of the lattice cells of a box, shape (C, 8, 3)."""
    n = [max(1, round(edge)) for edge in size]
    cell = np.stack(np.meshgrid(*map(np.arange, n), indexing="ij"), -1).reshape(-1, 1, 3)
    return (cell + CORNERS) / n * size - np.array(size) / 2 + at


def turned(angle, at):
    """Places of the middles of columns as a cup sees them that is turned and shifted, shapes (ny, nx)."""
    a = np.radians(angle)
    y, x = np.mgrid[0:NY, 0:NX] + 0.5 - np.array([NY / 2 + at[1], NX / 2 + at[0]])[:, None, None]
    return x * np.cos(a) + y * np.sin(a), y * np.cos(a) - x * np.sin(a)


def cup(thickness, angle, bottom, at):
    """Solid parts of all cells; `bottom` is the height of the middle of the bottom."""
    outer, middle, z = INNER + 2 * thickness, (INNER + thickness) / 2, bottom + (thickness + HIGH) / 2
    corners = [box((outer, outer, thickness), (0, 0, bottom))]
    corners += [box((thickness, outer, HIGH), (x, 0, z)) for x in (-middle, middle)]
    corners += [box((outer, thickness, HIGH), (0, y, z)) for y in (-middle, middle)]
    a = np.radians(angle)
    turn = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    corners = np.ascontiguousarray(np.concatenate(corners) @ turn.T + [NX / 2 + at[0], NY / 2 + at[1], 0])
    count = np.zeros(np.prod(SHAPE), np.int32)
    pointer = lambda a: a.ctypes.data_as(ctypes.c_void_p)
    library().mdanim_occupancy_of_cells(NX, NY, NZ, len(corners), pointer(corners), None, 1, pointer(count), None)
    full = library().mdanim_occupancy_full(1)
    return np.minimum(lab.SOLID, (count.astype(np.int64) * lab.SOLID + full // 2) // full).reshape(SHAPE)


def full_cup(thickness=1.0, angle=10.0, bottom=2.334, at=(0.0, 0.0), held=True):
    """Waves with five cells of liquid in a cup, a little off its walls."""
    part = cup(thickness, angle, bottom, at)
    waves = lab.Waves(SHAPE)
    if held:
        waves.walls(part)
    waves.solids(part)
    inside = np.maximum(*map(abs, turned(angle, at))) < INNER / 2 - 0.8
    top = bottom + thickness / 2
    waves.pour(np.where(inside, top + 5.0, 0.0), above=np.where(inside, top, 0.0))
    return waves


def lost(waves, thickness=1.0, angle=10.0, bottom=2.334, at=(0.0, 0.0)) -> float:
    """Part of the liquid that is beyond the walls or below the bottom."""
    spans = waves.spans
    within = (np.maximum(*map(abs, turned(angle, at))) < (INNER + thickness) / 2).ravel()
    inside = within[spans.column] & (spans.roof > bottom + 0.6)
    return spans.content[~inside].sum() / waves.total


@pytest.mark.parametrize("thickness", [1.0, 1.3])
@pytest.mark.parametrize("angle", [0.0, 5.0, 10.0, 20.0, 30.0, 45.0])
@pytest.mark.parametrize("bottom", [2.0, 2.334, 2.5, 2.7])
@pytest.mark.parametrize("at", [(0.0, 0.0), (0.3, 0.13)])
def test_a_held_cup_holds(thickness, angle, bottom, at):
    """Columns which a wall fills in part are cut where the bottom passes below it, so that nothing falls down at the wall."""
    where = dict(thickness=thickness, angle=angle, bottom=bottom, at=at)
    waves = full_cup(**where)
    assert waves.total > 290 * lab.UNIT and lost(waves, **where) == 0.0
    waves.update(150)
    assert lost(waves, **where) < 1e-3


def test_the_walls_are_part_of_the_state():
    """Without them other columns would be cut: spans and what is in them would not be those of before."""
    waves = full_cup()
    waves.update(20)
    other = lab.Waves(SHAPE)
    other.state = waves.state
    assert np.array_equal(other.state, waves.state)
    waves.update(50)
    other.update(50)
    assert np.array_equal(other.state, waves.state)
    other.solids(np.zeros(SHAPE, int))
    other.state = waves.state
    assert np.array_equal(other.state, waves.state)


def test_walls_that_are_told_later_cut_what_is_there():
    """As those which were there from the start, when solids are set next: how it came about makes no difference."""
    part = cup(1.0, 10.0, 2.334, (0.0, 0.0))
    first, later = lab.Waves(SHAPE), lab.Waves(SHAPE)
    first.walls(part)
    first.solids(part)
    later.solids(part)
    assert len(later.spans.column) < len(first.spans.column)
    later.walls(part)
    later.solids(part)
    assert all(np.array_equal(a, b) for a, b in zip(first.spans, later.spans, strict=True))


def test_a_cup_that_is_not_held_is_cut_as_before():
    """Its columns would be cut and joined again with each of its motions; `check` warns of such hulls."""
    assert len(full_cup(held=False).spans.column) < len(full_cup().spans.column)
