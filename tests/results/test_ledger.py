# SPDX-License-Identifier: GPL-2.0-only
"""The ledger's residual: the error in the sum of energies over the energy that is really in play."""

from __future__ import annotations

import numpy as np
import pytest
from mdanim_lammps.results.ledger import Ledger


def residuals(terms, rows):
    """Residuals of rows of energies."""
    ledger = Ledger(terms, potentials=tuple(term for term in ("gravity", "buoyancy") if term in terms))
    for i, row in enumerate(rows):
        ledger.add(float(i), dict(zip(terms, row)))
    return [row["residual"] for row in ledger.rows]


def test_residual_is_change_over_energy_in_play():
    """A body that falls through 10 J and gains 9.9 J is off by a hundredth."""
    assert residuals(("kinetic", "gravity"), [(0, 10), (5, 5), (9.9, 0)])[-1] == pytest.approx(-0.01)


@pytest.mark.parametrize("zero", [(0.0, 0.0), (1e6, 0.0), (0.0, -1e6), (3e5, 1e6)])
def test_zero_of_a_potential_does_not_count(zero):
    """Wherever gravity and buoyancy count from, the residual is the same: no constant makes it look small."""
    rows = np.array([(0.0, 10.0, 0.0, 0.0), (2.0, 3.0, 5.0, 0.0), (0.5, 0.0, 8.0, 1.4)])
    rows[:, 1:3] += zero
    found = residuals(("kinetic", "gravity", "buoyancy", "drag_loss"), rows)
    # 0.1 J too little in the end; at most 10 J are in play. A million joules leave ten digits of a tenth.
    assert found == pytest.approx([0.0, 0.0, -0.01], abs=1e-10)


def test_a_floating_body_has_what_it_trades_in_play():
    """A body that trades 2 J of gravity for buoyancy is measured by those, not by its few millijoules of motion."""
    found = residuals(("kinetic", "gravity", "buoyancy"), [(0, 4, 0), (1e-3, 2, 2.0), (0, 4, 0.004)])
    assert found[-1] == pytest.approx(0.004 / 2.004)


def test_cells_are_written_to_the_unit(tmp_path):
    """Whole cells of a liquid stand in the file as integers, others to 2^-20 of one; every float comes back to the bit."""
    ledger = Ledger(("kinetic",), ("liquid_cells", "draft.box"), counts=("liquid_cells",))
    ledger.add(0.1, {"kinetic": 1 / 3, "liquid_cells": 2_000_001.0, "draft.box": 0.1})
    ledger.add(0.2, {"kinetic": 1 / 3, "liquid_cells": 2.0**32 - 2.0**-20, "draft.box": 0.1})
    ledger.write(tmp_path / "ledger.csv")
    text = (tmp_path / "ledger.csv").read_text().splitlines()
    assert text == [
        "time,kinetic,residual,liquid_cells,draft.box",
        "0.1,0.3333333333333333,0.0,2000001,0.1",
        "0.2,0.3333333333333333,0.0,4294967295.999999,0.1",
    ]
    back = Ledger.read(tmp_path / "ledger.csv")
    assert back.rows == ledger.rows and back.extras == ledger.extras


def test_rounding_is_no_energy():
    """Count energies below the floor as the floor, so that what rests does not seem to create energy out of nothing."""
    ledger = Ledger(("kinetic", "elastic"), floor=1e-20)
    for kinetic in (1e-31, 5e-31, 1e-10):
        ledger.add(0.0, {"kinetic": kinetic, "elastic": 0.0})
    assert [row["residual"] for row in ledger.rows] == pytest.approx([0.0, 4e-11, 1.0])


def test_a_ledger_is_read_as_it_was_written(tmp_path):
    """Residuals too, although the file holds neither the floor nor the potentials that they were weighed by."""
    ledger = Ledger(("kinetic", "gravity"), floor=1e-3, potentials=("gravity",))
    for time, kinetic in enumerate((1e-31, 5e-31, 1e-10)):
        ledger.add(float(time), {"kinetic": kinetic, "gravity": 1e6})
    ledger.write(tmp_path / "ledger.csv")
    back = Ledger.read(tmp_path / "ledger.csv")
    assert back.rows == ledger.rows and back.residual == ledger.residual
    assert back.checksum(3) == ledger.checksum(3)
