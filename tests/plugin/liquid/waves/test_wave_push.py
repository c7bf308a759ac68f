# SPDX-License-Identifier: GPL-2.0-only
"""Push of waves on bodies cell by cell, against the pressure on the faces of cells, which is summed in another way."""

import ctypes

import numpy as np
import pytest
import waves_lab as lab
from plugin_library import library

SHAPE = (16, 20, 24)


def push(w: lab.Waves, part: np.ndarray, volume: np.ndarray | None = None) -> np.ndarray:
    """Force on all that is solid, the sum over its cells, or on the volumes in cells that are given, shape (3,)."""
    nz, ny, nx = w.shape
    mass = np.ascontiguousarray((part > 0).any(axis=0), float)
    out = np.empty((*w.shape, 8))
    found = library().mdanim_wave_push
    found.restype, found.argtypes = None, [lab.HANDLE, lab.INT, lab.INT, lab.INT, lab.DOUBLES, ctypes.c_void_p]
    found(w.handle, nx, ny, nz, mass, out.ctypes.data)
    known, head, share, over, on_top, along_x, along_y, beside = np.moveaxis(out, -1, 0)
    assert known[part > 512].all(), "no push on a body"
    z = np.arange(nz)[:, None, None]
    below = np.clip(head - z, 0.0, 1.0) * share
    every, aside = below + over - on_top, np.maximum(0.0, below + beside)
    solid = (part if volume is None else volume) / lab.SOLID * (known > 0)
    return np.array([(solid * along_x * aside).sum(), (solid * along_y * aside).sum(), (solid * every).sum()])


def faces(w: lab.Waves, part: np.ndarray) -> np.ndarray:
    """The same by pressure on faces, shape (3,)."""
    return w.forces(np.where(part > 0, 0, -1), 1)[0]


def block(low, high) -> np.ndarray:
    """Solid from cell to cell (z, y, x)."""
    part = np.zeros(SHAPE, int)
    part[tuple(slice(a, b) for a, b in zip(low, high))] = lab.SOLID
    return part


def hull() -> np.ndarray:
    """An open hull, planks of two cells, its bottom 4 above the floor."""
    part = block((4, 4, 4), (13, 16, 20))
    part[6:, 6:14, 6:18] = 0
    return part


BODIES = {
    "afloat": block((6, 5, 6), (12, 12, 15)),
    "under water": block((3, 5, 6), (7, 12, 15)),
    "hull": hull(),
    "partly solid": np.where(block((6, 5, 6), (12, 12, 15)) > 0, 3000, 0),
}


@pytest.mark.parametrize("body", BODIES)
def test_at_rest_it_is_archimedes(body):
    """The weight of what is displaced, air in a hull included, and nothing sideways."""
    part = BODIES[body]
    w = lab.Waves(SHAPE)
    w.solids(part)
    level = np.full(SHAPE[1:], 9.0)
    w.pour(level)
    if body == "hull":
        w.pour(np.where((part > 0).any(axis=0), 4.0, level))  # dry inside
    assert push(w, part) == pytest.approx(faces(w, part), abs=0.02)
    wet = np.clip(9.0 - np.arange(16), 0.0, 1.0)
    displaced = wet @ part.sum(axis=(1, 2)) / lab.SOLID
    if body != "hull":
        assert push(w, part)[2] == pytest.approx(displaced, rel=1e-6)
    assert np.abs(push(w, part)[:2]).max() < 1e-5


def moved(part: np.ndarray, by: float, axis: int) -> np.ndarray:
    """Solid parts when a body has moved by a part of a cell."""
    return np.rint((1.0 - by) * part + by * np.roll(part, 1, axis)).astype(int)


@pytest.mark.parametrize("aside", [0.0, 0.06, 0.5])
@pytest.mark.parametrize("gap", [0.0, 0.02, 0.2, 0.8])
def test_a_dry_hull_near_the_floor_is_pushed_as_one_that_floats(gap, aside):
    """Liquid seeps below it from outside alone: the push is what an air-filled hull displaces, to the part of a thin gap. Beside
    its walls, which fill columns in part, there are cracks, dry inside and wet outside: 0.2 %."""
    part = np.zeros(SHAPE, int)
    part[:9] = hull()[4:13]
    part = moved(moved(part, gap, 0), aside, 2)
    w = lab.Waves(SHAPE)
    w.solids(part)
    inside = np.zeros(SHAPE[1:], bool)
    inside[6:14, 6 : 18 + (aside > 0.0)] = True
    w.pour(np.where(inside, 0.0, 8.0))
    error = max(1e-3 if gap > 0.1 else 1e-6 + gap, 3e-3 if aside == 0.06 else 0.0)
    assert push(w, part)[2] == pytest.approx((8.0 - gap) * 12 * 16, rel=error)


@pytest.mark.parametrize("body", ["afloat", "under water", "hull"])
def test_in_a_swell_it_is_the_pressure_on_the_faces(body):
    """A slope runs at the body: upward to 2 % of the weight that it displaces, sideways to a quarter of the largest push."""
    part = BODIES[body]
    w = lab.Waves(SHAPE)
    w.solids(part)
    w.pour(8.5 + 1.5 * np.cos(np.pi * (np.arange(24) + 0.5) / 24)[None, :])
    found, expected = [], []
    for _ in range(40):
        w.update(3)
        found.append(push(w, part))
        expected.append(faces(w, part))
    found, expected = np.array(found), np.array(expected)
    scale = np.abs(expected[:, 2]).max()
    assert np.abs(found - expected)[:, 2].max() < 0.02 * scale
    largest = np.abs(expected[:, 0]).max()
    assert largest > 0.05 * scale
    assert np.abs(found - expected)[:, :2].max() < 0.25 * largest


@pytest.mark.parametrize("aside", [0.0, 0.3, 0.4, 0.7])
def test_a_gate_that_stands_between_two_levels(aside):
    """Half of the difference of their squares acts on it, to 5 %, wherever its faces lie in their columns."""
    part = moved(block((0, 0, 9), (16, 20, 15)), aside, 2)
    w = lab.Waves(SHAPE)
    w.solids(part)
    levels = np.where(np.arange(24) < 12, 9.0, 2.0) * np.ones(SHAPE[1:])
    w.pour(levels)
    whole = np.where(part >= lab.SOLID // 2, lab.SOLID, 0)  # as its lattice cells lie in columns
    assert push(w, part, whole)[0] == pytest.approx(0.5 * (9.0**2 - 2.0**2) * 20, rel=0.05)
