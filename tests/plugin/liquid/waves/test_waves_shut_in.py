# SPDX-License-Identifier: GPL-2.0-only
"""Water below roofs, at the pressure of the surface beside them."""

import numpy as np
import pytest
import waves_lab as lab


def tilted_bottom():
    """Solid parts under a tilted body: nearly shut cells above partly solid ones, and shut ones above those."""
    shape = (16, 9, 9)
    part = np.zeros(shape, int)
    part[9:, 3:6, 3:6] = 4096
    for (y, x), cells in {(4, 4): (171, 2235, 4018), (3, 4): (85, 2055, 3982), (4, 3): (8, 919, 3470)}.items():
        part[6:9, y, x] = cells
    part[9, 4, 3] = 4095
    return part


def test_water_that_a_roof_shuts_in_keeps_its_pressure_when_it_wakes():
    """The roof rises by a thousandth of a cell: heads below it stay near that of the surface, four cells higher."""
    part = tilted_bottom()
    w = lab.Waves(part.shape, calm=0.3)
    w.solids(part)
    w.pour(12 + 0.01 * np.arange(9)[None, :] * np.ones((9, 1)))
    w.update(1500)
    assert w.at_rest
    part[8, 4, 4] -= 4
    w.solids(part)
    w.update(1)
    spans = w.spans
    below = (spans.low == 0) & (spans.roof < 10)
    assert below.sum() == 9 and (spans.phi[below] > 11.8).all() and spans.full[below].all()


def test_water_that_is_parted_keeps_its_pressure():
    """A shelf comes into a shut span as its roof rises: neither part gets the head of its own roof."""
    part = np.zeros((16, 9, 9), int)
    part[8:, 3:6, 3:6] = 4096
    w = lab.Waves(part.shape)
    w.solids(part)
    w.pour(12)
    part[8, 3:6, 3:6] = 4056
    part[3, 4, 4] = 3990  # what it takes is less than what the roof gives
    part[9, 3:6, 3:6] = 4096
    w.solids(part)
    spans = w.spans
    parted = (spans.column == 4 * 9 + 4) & (spans.high <= 8)
    assert parted.sum() == 2 and spans.full[parted].all() and spans.phi[parted] == pytest.approx(12.0)


def test_water_in_a_tank_that_is_full_keeps_its_pressure_beside_waves():
    """Nothing tells the head of a pocket that held walls and a lid shut in: what the solver added to all of it grew without end,
    to 9.9 here and to 116 later."""
    part = np.zeros((16, 12, 20), int)
    part[:12, 2:10, 8:17] = 4096
    part[:8, 3:9, 9:16] = 0
    w = lab.Waves(part.shape)
    w.solids(part)
    w.pour(8 + 2 * np.exp(-((np.arange(20) / 3) ** 2)) * np.ones((12, 1)))
    w.update(200)
    spans = w.spans
    below = (spans.low == 0) & (spans.roof == 8)
    assert below.sum() == 42 and spans.full[below].all()
    assert spans.phi[below] == pytest.approx(8.0, abs=0.1)
