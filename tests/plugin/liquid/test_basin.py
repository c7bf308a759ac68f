# SPDX-License-Identifier: GPL-2.0-only
"""The liquid's basin on its own: solids as shares of cells, sums over ranks, when updates are due, state."""

from __future__ import annotations

import ctypes

import numpy as np
import pytest
from plugin_library import library

CELLS = (6, 4, 3)  # nz, ny, nx
EVERY, STRIDE, PERIOD = 4, 0.25, 0.06
"""Defaults of Basin::Pace."""


class Basin:
    """A basin of unit cells, gravity 1, on equal ranks."""

    def __init__(self, ranks=1):
        found = library()
        found.mdanim_basin_new.restype = ctypes.c_void_p
        found.mdanim_basin_pour.restype = ctypes.c_long
        self.library, self.handle = found, ctypes.c_void_p(found.mdanim_basin_new(*CELLS[::-1], ranks))
        self.when = 0

    def __del__(self):
        self.library.mdanim_basin_free(self.handle)

    def pour(self, solids, units: int) -> int:
        """Solids (N, 4) as place and share of a cell, then liquid; units that find no room."""
        rows = np.ascontiguousarray(solids, float).reshape(-1, 4)
        return self.library.mdanim_basin_pour(self.handle, rows.ctypes.data_as(ctypes.c_void_p), len(rows), ctypes.c_long(units))

    def is_due(self, fastest: float, dt: float) -> bool:
        """One look; the square of the fastest speed, -1 for none."""
        return bool(self.library.mdanim_basin_is_due(self.handle, ctypes.c_double(fastest), ctypes.c_double(dt)))

    def looks_until_due(self, fastest: float, dt: float, most=1000) -> int:
        """Number of the look at which an update is due."""
        return next(n for n in range(1, most) if self.is_due(fastest, dt))

    def update(self, solids) -> None:
        """An update; RuntimeError with its message."""
        rows = np.ascontiguousarray(solids, float).reshape(-1, 4)
        error = ctypes.create_string_buffer(300)
        self.when += EVERY
        arguments = (rows.ctypes.data_as(ctypes.c_void_p), len(rows), ctypes.c_uint64(self.when))
        if self.library.mdanim_basin_update(self.handle, *arguments, error, 300):
            raise RuntimeError(error.value.decode())

    @property
    def contents(self) -> np.ndarray:
        """Units of every cell, 255 where it is solid, shape (nz, ny, nx)."""
        out = np.empty(CELLS, np.uint8)
        self.library.mdanim_basin_contents(self.handle, out.ctypes.data_as(ctypes.c_void_p))
        return out

    @property
    def calm(self) -> bool:
        """Whether all is level."""
        return bool(self.library.mdanim_basin_is_calm(self.handle))


def liquid(basin: Basin) -> int:
    """Units in all cells."""
    found = basin.contents
    return int(found[found < 255].sum())


MIDDLE = (1.5, 1.5, 0.5)


@pytest.mark.parametrize(("share", "ranks", "solid"), [(0.45, 1, False), (0.55, 1, True), (0.3, 1, False), (0.3, 2, True)])
def test_a_cell_is_solid_when_ranks_fill_half_of_it(share, ranks, solid):
    """Counts of all ranks are added before they are compared with half a cell."""
    basin = Basin(ranks)
    assert basin.pour([[*MIDDLE, share]], 24) == 0
    assert (basin.contents == 255).sum() == solid
    assert (basin.contents[0, 1, 1] == 255) == solid
    assert liquid(basin) == 24


def test_liquid_makes_room_and_is_kept():
    """A solid that comes in takes its cell; the unit that was there goes elsewhere; it comes out again, and all is level."""
    basin = Basin()
    basin.pour([], 24)
    assert basin.calm
    basin.update([[*MIDDLE, 1.0]])
    assert basin.contents[0, 1, 1] == 255 and liquid(basin) == 24
    for _ in range(200):
        basin.is_due(-1.0, 0.1)
        basin.update([])
    assert liquid(basin) == 24 and basin.calm
    assert np.array_equal(basin.contents[:2], np.ones((2, 4, 3)))


def test_without_room_an_update_is_refused():
    """All cells become solid: the message names a cell and its units."""
    basin = Basin()
    basin.pour([], 24)
    everywhere = np.argwhere(np.ones(CELLS))[:, ::-1] + 0.5
    with pytest.raises(RuntimeError, match=r"a solid fills cell \(\d, \d, \d\) of the basin and there is no room"):
        basin.update(np.column_stack([everywhere, np.ones(len(everywhere))]))
    assert liquid(basin) == 24


@pytest.mark.parametrize("speed", [0.01, 0.07, 0.4])
def test_an_update_is_due_after_a_stride(speed):
    """Level liquid waits for solids alone: until the fastest has gone a quarter of a cell."""
    basin, dt = Basin(), 0.1
    basin.pour([], 24)
    assert basin.looks_until_due(speed**2, dt) == int(np.ceil(STRIDE / (speed * EVERY * dt) - 1e-9))


def test_level_liquid_with_nothing_near_is_never_due():
    """However long it is looked at."""
    basin = Basin()
    basin.pour([], 24)
    assert not any(basin.is_due(-1.0, 10.0) for _ in range(1000))


def test_liquid_that_is_not_level_is_due_after_a_period():
    """A part of a layer more than one deep, under a solid that is taken away."""
    basin, dt = Basin(), 0.004
    basin.pour([[x + 0.5, y + 0.5, z + 0.5, 1.0] for x in range(2) for y in range(4) for z in range(3)], 12)
    basin.update([])
    assert not basin.calm
    assert basin.looks_until_due(-1.0, dt) == int(np.ceil(PERIOD / (EVERY * dt)))


def test_the_last_solid_that_leaves_is_seen_at_once():
    """Its cells are solid still, and none is near: an update is due."""
    basin = Basin()
    basin.pour([[*MIDDLE, 1.0]], 23)
    assert basin.is_due(-1.0, 0.1)


def test_a_copied_state_goes_on_alike():
    """Another basin with the state of the first has its cells, now and after the same updates."""
    first, second = Basin(), Basin()
    first.pour([[*MIDDLE, 1.0]], 30)
    second.pour([], 1)
    error = ctypes.create_string_buffer(200)
    assert first.library.mdanim_basin_copy(first.handle, second.handle, error, 200) == 0, error.value
    for _ in range(5):
        assert np.array_equal(first.contents, second.contents)
        for basin in (first, second):
            basin.is_due(0.01, 0.1)
            basin.update([[1.5, 2.5, 0.5, 1.0]])
