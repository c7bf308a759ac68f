# SPDX-License-Identifier: GPL-2.0-only
"""Friction of the ground, (W4): closed forms, thin water, and what the account of momentum says of it."""

import numpy as np
import pytest
import waves_lab as lab
from wave_sources_lab import Makers

DT = 0.1


def ground(height, layers):
    """Solid parts below these heights of columns, shape (ny, nx)."""
    return np.round(np.clip(height - np.arange(layers)[:, None, None], 0, 1) * lab.SOLID).astype(int)


@pytest.mark.parametrize(("depth", "bed"), [(3.0, 0.5), (0.4, 0.05)])
def test_a_river_comes_to_the_depth_of_manning(depth, bed):
    """Down a slope of 1 in 20, from a source to a fall: q = h^(5/3) sqrt(S/bed), in deep water and in less than a cell."""
    cells, slope = 100, 0.05
    x = np.arange(cells) + 0.5
    floor = np.where(x < 90, 1 + slope * (90 - x), 0.0)[None]
    w = lab.Waves((12, 1, cells), bed=bed)
    w.solids(ground(floor, 12))
    w.walls(ground(floor, 12))
    w.pour(np.maximum(floor + np.where(x < 90, depth, 0.0), 0.3))
    flow = depth ** (5 / 3) * np.sqrt(slope / bed)
    makers = Makers(w)
    makers.flow((0, 6, 0, 1), flow, u=(flow / depth, 0.0))
    makers.flow((95, 100, 0, 1), -flow)
    makers.update(1200)
    river = (x > 20) & (x < 50)
    assert w.volume.ravel()[river] == pytest.approx(depth, rel=0.01)


def test_a_flow_across_the_grid_is_slowed_by_its_speed():
    """Uniform flow along the diagonal, in the middle of a basin before waves of the sides get there: 1/|u| grows by bed/h^(4/3)
    in each time, with the speed |u| and not that along x or y alone."""
    bed, depth, updates, cells = 1.0, 4.0, 30, 64
    w = lab.Waves((8, cells, cells), bed=bed, viscosity=0.0)
    w.pour(depth)
    w.set_velocities(np.full(len(w.links.u), 0.2))
    w.update(updates)
    links = w.links
    middle = links.a == (cells // 2) * (cells + 1)
    speed = 1 / (1 / (0.2 * np.sqrt(2)) + bed / depth ** (4 / 3) * updates * DT)
    assert links.u[middle] == pytest.approx(speed / np.sqrt(2), rel=1e-4)


def test_thin_water_on_rough_ground_creeps_and_never_turns_back():
    """A dam breaks onto dry ground, at last one where friction stops nearly all: nothing turns back or springs up, and
    the front is far behind that on smooth ground."""
    fronts = []
    for bed in (0.0, 0.1, 1e4):
        w = lab.Waves((8, 1, 64), bed=bed)
        x = np.arange(64)
        w.pour(np.where(x < 20, 4.0, 0.0))
        highest = []
        for _ in range(100):
            w.update()
            assert bed == 0.0 or w.links.u.min() > -1e-4
            highest.append(w.volume.max())
        assert np.isfinite(w.links.u).all() and max(highest) < 4.0 + 1e-4
        fronts.append(np.flatnonzero(w.volume.ravel() > 0.01).max())
    assert fronts[0] > fronts[1] + 10 and fronts[1] > fronts[2] + 10 and fronts[2] >= 20


def test_the_account_of_momentum_has_what_the_ground_takes():
    """Uniform flow along x between walls far away: what liquid has lost beyond the push of the walls is what it has less."""
    lost = []
    for bed in (0.0, 0.5):
        w = lab.Waves((8, 1, 40), bed=bed)
        w.pour(2.0)
        w.set_velocities(np.full(39, 0.3))
        w.update(10)
        now, taken, _ = w.take_momenta()
        lost.append(taken[0])
        assert now[0] + taken[0] == pytest.approx(39 * 2.0 * 0.3, rel=0.01)
    assert lost[1] > lost[0] + 1.0
