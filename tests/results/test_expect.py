# SPDX-License-Identifier: GPL-2.0-only
"""Expect lines on a liquid, against heights made by hand: drafts, level, volume, cells gained or lost."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from mdanim_lammps.effects.measured import Measured
from mdanim_lammps.features.liquid.measure import immersed_depth, immersed_share
from mdanim_lammps.model.grid import Grid
from mdanim_lammps.results.expect import Outcome, evaluate
from mdanim_lammps.results.quantities import recorded
from mdanim_lammps.scene.scene import Expect

GRID = Grid((-1.0, -2.0, 0.0), (1.0, 2.0, 3.0), (20, 40, 30))
X, Y = np.meshgrid(-0.95 + 0.1 * np.arange(20), -1.95 + 0.1 * np.arange(40))


def corners(low, high):
    """The eight corners of a box [m], shape (8, 3)."""
    return np.array([[(low, high)[k >> axis & 1][axis] for axis in range(3)] for k in range(8)], dtype=float)


CELLS = SimpleNamespace(cell_volume=0.25)


def found(subject, quantity, time=None, level=None, fed=False, **columns):
    """Value of one expect line in a run of three frames at 0, 1 and 2 s in which nothing moves, with these columns of the
    ledger and levels."""
    still = np.zeros((3, 1, 3))
    scene = SimpleNamespace(liquid=SimpleNamespace(fed=fed))
    ledger = {name: np.array(column, float) for name, column in columns.items()}
    times, levels = np.array([0.0, 1.0, 2.0]), SimpleNamespace(liquid_levels=level)
    run = Measured(scene, ("box",), CELLS, times, still, still, 0.0, ledger.__getitem__, levels)
    (outcome,) = evaluate((Expect(subject, quantity, 0.0, time=time),), run)
    return outcome.found


@pytest.mark.parametrize(
    ("bottom", "depth"), [(0.6, 0.4), (0.95, 0.05), (1.2, 0.0), (0.1, 0.9)], ids=["afloat", "dips", "above", "under"]
)
def test_draft_in_level_liquid(bottom, depth):
    """Level less lowest point, of what has sunk, too; not less than nothing."""
    box = corners((-0.3, 0.1, bottom), (0.1, 0.4, bottom + 0.5))
    assert immersed_depth(box, GRID, np.full((40, 20), 1.0)) == pytest.approx(depth)


def test_draft_is_measured_where_the_object_is():
    """On a slope the level is that of the columns under the object, each axis its own."""
    height = 1.0 + 0.5 * X + 0.25 * Y
    box = corners((0.205, -1.195, 0.5), (0.595, -0.605, 1.5))
    # The columns that the box touches are centred on the box: 0.4 and -0.9.
    assert immersed_depth(box, GRID, height) == pytest.approx(1.0 + 0.5 * 0.4 - 0.25 * 0.9 - 0.5)


def test_draft_of_an_object_smaller_than_a_column():
    """A pebble has the level of the column that it is in."""
    height = np.where((X > 0.5) & (Y > 1.0), 2.0, 1.0)
    assert immersed_depth(corners((0.52, 1.01, 0.99), (0.54, 1.03, 1.5)), GRID, height) == pytest.approx(1.01)
    assert immersed_depth(corners((0.42, 1.01, 0.99), (0.44, 1.03, 1.5)), GRID, height) == pytest.approx(0.01)


@pytest.mark.parametrize("shift", [(2.5, 0.0), (-2.5, 0.0), (0.0, 4.5), (0.0, -4.5)])
def test_an_object_beside_the_basin_is_dry(shift):
    """Out of the basin there is no liquid, however low the object lies; half out counts the part inside."""
    height = np.full((40, 20), 1.0)
    box = corners((-0.2, -0.2, 0.5), (0.2, 0.2, 0.9))
    assert immersed_depth(box + [*shift, 0.0], GRID, height) == 0.0
    half = np.sign(shift) * [1.0, 2.0]
    assert immersed_depth(box + [*half, 0.0], GRID, height) == pytest.approx(0.5)


def test_draft_between_frames_is_a_straight_line():
    """At a time between two frames the draft is between theirs; without a time it is the last."""
    draft = {"draft.box": [0.0, 0.4, 0.2]}
    assert found("box", "draft", 1.25, **draft) == pytest.approx(0.35)
    assert found("box", "draft", 1.0, **draft) == pytest.approx(0.4)
    assert found("box", "draft", **draft) == pytest.approx(0.2)


def test_level_and_volume():
    """The level between frames, the volume as cells times their size."""
    assert found("liquid", "level", 0.5, level=np.array([1.0, 2.0, 4.0])) == pytest.approx(1.5)
    assert found("liquid", "level", level=np.array([1.0, 2.0, 4.0])) == 4.0
    assert found("liquid", "volume", liquid_cells=[10.0, 10, 12]) == pytest.approx(3.0)
    assert found("liquid", "volume", 1.0, liquid_cells=[10.0, 10, 12]) == pytest.approx(2.5)


def test_crest_is_the_highest_so_far():
    """The highest at any frame up to a time, not the farthest from 0: basins may be below it."""
    crest = [-3.0, -1.0, -2.0]
    assert [found("liquid", "crest", time, liquid_crest=crest) for time in (0.0, 1.0, 2.0, None)] == [-3.0, -1.0, -1.0, -1.0]


def test_energy_of_waves_is_that_of_its_time():
    """Between frames on a straight line, at the end without a time."""
    assert [found("liquid", "waves", time, waves=[0.0, 4.0, 1.0]) for time in (0.5, 1.0, None)] == [2.0, 4.0, 1.0]


@pytest.mark.parametrize(
    ("cells", "time", "residual"),
    [
        ((10, 10, 10), None, 0),
        ((10, 8, 10), None, 2),
        ((10, 11, 13), None, 3),
        ((10, 11, 13), 1.0, 1),
        ((2**30, 2**30 - 2**-20, 2**30), None, 2**-20),
    ],
)
def test_residual_is_the_worst_so_far(cells, time, residual):
    """Cells gained or lost count even if they come back later; up to a time only what was before."""
    assert found("liquid", "residual", time, liquid_cells=cells) == residual


@pytest.mark.parametrize(
    ("relation", "below", "equal", "above"), [("=", 0, 1, 0), ("<", 1, 0, 0), (">", 0, 0, 1), ("<=", 1, 1, 0), (">=", 0, 1, 1)]
)
def test_bounds_are_met_on_their_side(relation, below, equal, above):
    """Less, equal and more than a value by a thousandth; a number that is none meets nothing."""
    for value in (-2.0, 0.3):
        expect = Expect("box", "position.z", value, relation=relation)
        met = [Outcome(expect, value + d).met for d in (-1e-3, 0.0, 1e-3)]
        assert met == [bool(below), bool(equal), bool(above)]
        assert not Outcome(expect, float("nan")).met
    assert f"expect box.position.z {relation} 0.3" in str(Outcome(expect, 0.2))
    assert "it has no value then (mdanim-lammps explain position.z tells of it), MISSED" in str(Outcome(expect, float("nan")))


def test_what_to_record_is_named_once():
    """Every quantity that a line asks about and frames alone do not tell, in order, whatever the time."""
    wanted = [("b", "draft"), ("c", "position.z"), ("a", "strain.max"), ("liquid", "level"), ("b", "draft"), ("b", "immersed")]
    named = recorded(tuple(Expect(*line, 0.1, time=float(i)) for i, line in enumerate(wanted)))
    assert list(named) == ["draft.b", "strain.a", "immersed.b"]


def test_immersed_share_of_cells_across_a_slope():
    """Two lattice cells under a surface that rises along x: the share below it, by points in every cell."""
    height = 1.0 + 0.5 * X
    cell = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float)
    boxes = np.stack([cell * [0.4, 0.4, 1.0] + [-0.4, 0.0, 0.5], cell * [0.4, 0.4, 1.0] + [0.0, 0.0, 0.5]])
    # Mean heights over the boxes are 0.9 and 1.1; columns are 0.1 wide and points stand 1/4 of a cell apart.
    assert immersed_share(boxes, GRID, height) == pytest.approx((0.4 + 0.6) / 2, abs=0.05)
    assert immersed_share(boxes[:1], GRID, height) < immersed_share(boxes[1:], GRID, height)
    assert immersed_share(boxes - [0.0, 0.0, 3.0], GRID, height) == 1.0
    assert immersed_share(boxes + [5.0, 0.0, -3.0], GRID, height) == 0.0
