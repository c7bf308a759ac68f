# SPDX-License-Identifier: GPL-2.0-only
"""Velocities that no liquid has are held where they enter, so that an update has a bounded number of parts."""

import numpy as np
import pytest
import waves_lab as lab
from wave_sources_lab import Makers


def absurd(w):
    """Ways in which a velocity comes into waves."""
    return {"an impulse": lambda u: w.add_impulse(0.5 * u, -u), "an inflow": lambda u: pour_in(w, u)}


def pour_in(w, u):
    """A cell of liquid for each column of a corner, with a velocity."""
    makers = Makers(w)
    makers.flow((0, 3, 0, 3), 90.0, 2.0, (u, -u))
    makers.update(dt=0.1)


@pytest.mark.parametrize("way", ["an impulse", "an inflow"])
@pytest.mark.parametrize("u", [1e3, 1e12, 1e300])
def test_an_absurd_velocity_is_held_where_it_enters(way, u):
    """To that which liquid may have: an update has as many parts as that takes, and no more. 10^12 would be as many parts, or
    none, as no whole number holds them."""
    w = lab.Waves((9, 8, 8))
    w.pour(4)
    absurd(w)[way](u)
    assert 0.0 < w.fastest <= 4 * 9**0.5
    w.update(dt=0.2)
    assert w.counts.sub_updates <= np.ceil(4 * 9**0.5 * 0.2 / 0.5)
    assert np.isfinite(w.energy).all()


def test_an_impulse_that_is_too_large_is_lost_to_the_basin():
    """Impulse that the liquid does not take is in the account."""
    w = lab.Waves((9, 8, 8))
    w.pour(4)
    w.update()
    w.take_momenta()
    x = np.zeros((8, 8))
    x[4, 4] = 1e4
    w.add_impulse(x, 0.0 * x)
    now, lost, _ = w.take_momenta()
    assert lost[0] > 9e3 and now[0] + lost[0] == pytest.approx(1e4, rel=1e-6)
