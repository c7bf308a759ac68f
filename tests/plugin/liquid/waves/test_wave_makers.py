# SPDX-License-Identifier: GPL-2.0-only
"""Makers of waves: inflow, drain, paddle and current, each accounted to the unit."""

import numpy as np
import pytest
import waves_lab as lab
from wave_sources_lab import EAST, NORTH, SOUTH, WEST, Makers

UNIT = lab.UNIT


def accounted(makers, start):
    """Whether the liquid is what it was, plus what came, minus what went."""
    came, went = makers.account
    return makers.w.total == start + came - went


def test_an_inflow_fills_a_basin_at_its_rate():
    """To the unit over 200 updates, though an update is not a whole number of units."""
    w = lab.Waves((16, 8, 10))
    w.pour(1)
    start = w.total
    makers = Makers(w)
    makers.flow((2, 5, 3, 5), rate=1 / 3)
    for n in range(1, 201):
        makers.update()
        assert abs(makers.account[0] - UNIT * n * 0.1 / 3) < 1.01 and accounted(makers, start)
    assert makers.account[1] == 0


def test_a_drain_empties_a_basin_at_its_rate_and_stops():
    """At the rate while there is liquid; a film stays."""
    w = lab.Waves((10, 4, 6))
    w.pour(2)
    start = w.total
    makers = Makers(w)
    makers.flow((2, 4, 1, 3), rate=-1.5)
    makers.update(100)
    assert abs(makers.account[1] - UNIT * 15) < 1.01 and accounted(makers, start)
    makers.update(900)
    assert accounted(makers, start) and w.total < 0.05 * start
    gone = makers.account[1]
    makers.update(10)
    assert makers.account[1] - gone < 0.02 * UNIT and w.spans.content.min() >= 0


def test_an_inflow_comes_in_with_its_velocity():
    """Momentum along a channel grows by the rate times the velocity, less the push of the wall behind."""
    w = lab.Waves((20, 1, 80))
    w.pour(6)
    makers = Makers(w)
    makers.flow((38, 42, 0, 1), rate=0.5, u=(1.5, 0))
    makers.update(100)
    links = w.links
    assert (links.u * links.height).sum() == pytest.approx(0.5 * 1.5 * 10, rel=0.1)


def test_liquid_comes_in_at_its_height():
    """Below a shelf or above it; what finds no room stays outside."""
    part = np.zeros((12, 3, 5), int)
    part[6, :, :] = 4096
    w = lab.Waves(part.shape)
    w.solids(part)
    makers = Makers(w)
    makers.flow((0, 5, 0, 3), rate=15.0, height=3.0)
    makers.flow((0, 5, 0, 3), rate=1.5, height=8.0)
    makers.update(60)
    spans = w.spans
    below = spans.content[spans.floor == 0].sum()
    assert below == pytest.approx(6 * 15 * UNIT, rel=0.01) and spans.content[spans.floor == 7].sum() == 9 * UNIT
    assert accounted(makers, 0)


def paddle(period, depth=8, cells=160, amplitude=0.2, side=WEST):
    """Waves that have run into a channel, not yet back from its end: heights after a time, and the wave number."""
    across = side in (SOUTH, NORTH)
    shape = (2 * depth, cells, 1) if across else (2 * depth, 1, cells)
    w = lab.Waves(shape)
    w.pour(depth)
    start = w.total
    makers = Makers(w)
    makers.paddle(side, amplitude, period, depth)
    speed = np.sqrt(depth)
    heights = []
    for _ in range(int(cells / speed / 0.1)):
        makers.update()
        assert accounted(makers, start)
        heights.append(w.surface.ravel() - depth)
    heights = np.array(heights)
    return heights[:, ::-1] if side in (EAST, NORTH) else heights


@pytest.mark.parametrize(("period", "cells"), [(12.0, 160), (20.0, 320)])
def test_a_paddle_makes_waves_of_its_amplitude_and_length(period, cells):
    """With the period 2 pi/sqrt(k tanh(k depth)): the crest within 6 %, the length within 4 %."""
    w = 2 * np.pi / period
    k = w * w
    for _ in range(200):
        k = w * w / np.tanh(8 * k) * 0.5 + k * 0.5
    heights = paddle(period, cells=cells)
    late = heights[-int(period / 0.1) :]
    near = late[:, 4 : int(2 * np.pi / k)]
    assert (near.max(0) - near.min(0)).mean() / 2 == pytest.approx(0.2, rel=0.06)
    phase = np.unwrap(np.angle(np.exp(-1j * w * 0.1 * np.arange(len(late))) @ near))
    assert abs(np.polyfit(np.arange(len(phase)), phase, 1)[0]) == pytest.approx(k, rel=0.04)


def test_paddles_at_all_sides_do_the_same():
    """Mirrored and turned, to the solver's tolerance."""
    west = paddle(12.0)
    for side in (EAST, SOUTH, NORTH):
        assert np.allclose(paddle(12.0, side=side), west, atol=1e-3)


def test_a_paddle_takes_back_what_it_brings():
    """After whole periods the basin holds what it held, but for a fraction of a cell."""
    w = lab.Waves((16, 3, 60))
    w.pour(6)
    start = w.total
    makers = Makers(w)
    makers.paddle(WEST, 0.3, 10.0, 6)
    makers.update(1000)
    assert accounted(makers, start) and abs(w.total - start) < 0.5 * UNIT * 3


@pytest.mark.parametrize("side", [WEST, NORTH])
def test_a_current_runs_through_and_changes_no_sum(side):
    """At its speed in the middle, in the end; what goes out comes in."""
    w = lab.Waves((12, 24, 24), calm=0.0)
    w.pour(5)
    start = w.total
    makers = Makers(w)
    makers.current(side, 0.4)
    for _ in range(100):
        makers.update(20)
        assert w.total == start
    links = w.links
    along = links.u[links.direction == (0 if side == WEST else 1)]
    assert np.mean(along) == pytest.approx(0.4 if side == WEST else -0.4, rel=0.1)
    assert np.abs(links.u[links.direction == (1 if side == WEST else 0)]).max() < 0.05


def test_makers_keep_liquid_awake():
    """A slow inflow is not slept through."""
    w = lab.Waves((8, 5, 6))
    w.pour(3)
    makers = Makers(w)
    makers.flow((0, 6, 0, 5), rate=0.01)
    makers.update(300)
    assert makers.account[0] == pytest.approx(0.3 * UNIT, abs=2)


def test_makers_go_on_from_a_state_to_the_last_bit():
    """With parts of units that are due; that of other makers is refused."""

    def basin():
        w = lab.Waves((14, 9, 11))
        w.pour(5)
        makers = Makers(w)
        makers.flow((1, 3, 2, 4), rate=0.123, u=(0.3, -0.1))
        makers.flow((7, 9, 5, 8), rate=-0.07)
        makers.paddle(SOUTH, 0.2, 7.0, 5)
        makers.current(EAST, 0.1)
        return w, makers

    w, makers = basin()
    makers.update(37)
    other, again = basin()
    other.state, again.state = w.state, makers.state
    w.take_momenta()  # begins the account of what came
    for _ in range(30):
        makers.update()
        again.update()
        assert (other.state == w.state).all() and (again.state == makers.state).all()
        assert (other.take_momenta()[2] == w.take_momenta()[2]).all()
    few = Makers(w)
    with pytest.raises(RuntimeError, match="has 56 bytes, these have 24"):
        few.state = makers.state


def test_no_makers_cost_and_change_nothing():
    """Liquid at rest stays asleep."""
    w = lab.Waves((8, 5, 6))
    w.pour(3)
    makers = Makers(w)
    makers.update(5)
    assert w.at_rest and makers.account == (0, 0)
