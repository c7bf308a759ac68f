# SPDX-License-Identifier: GPL-2.0-only
"""Tops and coins on the ground, against steady motions in closed form and Jellett's integral.

The ground gives way, by 2 % of the thinnest part in a blow at 1 m/s: bodies nod as they sink in at the start. In a second run
it is a tenth of that.
"""

import numpy as np
import pytest
import rigid_tops


@pytest.mark.parametrize(("depth", "most"), [(0.02, 1e-3), (0.002, 2e-4)])
@pytest.mark.parametrize("spin", [150.0, 300.0])
def test_the_axis_of_a_top_goes_around(tmp_path, spin, depth, most):
    """At the rate of the heavy top and without falling; its tip sinks in by 5e-3 of its height, or a tenth."""
    top, rate = rigid_tops.top(np.radians(20.0), spin)
    found, rise, grown = rigid_tops.turned(tmp_path, top, (0.0, 0.0), 2.0, 0.02 / depth)
    assert found == pytest.approx(rate, rel=most)
    assert abs(rise) < 6e-3 * depth / 0.02 and abs(grown) < 2e-3


@pytest.mark.parametrize(("depth", "most"), [(0.02, 5e-3), (0.002, 5e-4)])
@pytest.mark.parametrize(("lean", "rate"), [(30.0, 6.0), (30.0, 10.0), (60.0, 6.0), (60.0, 10.0)])
def test_a_coin_rolls_around(tmp_path, lean, rate, depth, most):
    """On its rim, without slipping: its lean, its circle and its rate stay."""
    coin, middle = rigid_tops.coin(np.radians(lean), rate)
    found, rise, grown = rigid_tops.turned(tmp_path, coin, (middle, 0.0), 2.0, 0.02 / depth)
    assert found == pytest.approx(rate, rel=most)
    assert abs(rise) < most and abs(grown) < 2.0 * most


def test_a_tippe_top_turns_over(tmp_path):
    """By friction alone, from 6 to above 170 degrees, as long as steps ten times finer. Jellett's integral stays to rounding."""
    times = [0.0, 0.5, 1.0, 1.5, 2.0]
    leans, changed = rigid_tops.tippe_leans(tmp_path, times)
    assert np.all(np.diff(leans) > 30.0) and leans[-1] > 170.0 and changed < 1e-12
    assert leans == pytest.approx(rigid_tops.tippe_leans(tmp_path, times, 0.035)[0], abs=1.0)
