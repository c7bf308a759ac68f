# SPDX-License-Identifier: GPL-2.0-only
"""Momentum of waves: what the liquid gains, walls and friction lose; against closed forms and the sum of pressures on faces."""

import numpy as np
import pytest
import waves_lab as lab
from wave_sources_lab import Makers

DT = 0.1


def account(w, updates, dt=DT):
    """Momentum after each update, and what was lost and what came until then, shapes (updates, 2)."""
    rows = []
    for _ in range(updates):
        w.update(dt=dt)
        rows.append(w.take_momenta())
    now, lost, came = np.moveaxis(rows, 1, 0)
    return now, np.cumsum(lost, axis=0), np.cumsum(came, axis=0)


def dam(along=0, depth=10, width=3, held=None, **settings):
    """Half of a basin is full, the other dry."""
    w = lab.Waves((2 * depth, width, 12 * depth) if along == 0 else (2 * depth, 12 * depth, width), **settings)
    if held is not None:
        w.solids(held)
        w.walls(held)
    place = np.arange(12 * depth) + 0.5 < 6 * depth
    w.pour(np.where(place if along == 0 else place[:, None], depth, 0.0))
    return w


@pytest.mark.parametrize("along", [0, 1])
def test_the_wall_behind_a_dam_takes_half_the_depth_squared(along):
    """Until the dip gets there the pressure on it is that of liquid at rest, h^2/2 on each width: to 0.5 %, what runs ahead of
    the dip. The liquid has that momentum: to 6 %, as it counts by openings of the upwind side."""
    now, lost, came = account(dam(along), 120)
    time = DT * np.arange(1, 121)
    np.testing.assert_allclose(-lost[:, along], 3 * 50.0 * time, rtol=5e-3)
    np.testing.assert_allclose(now[50:, along], -lost[50:, along], rtol=0.06)
    assert np.abs(lost[:, 1 - along]).max() < 1e-9 and not came.any()


def test_friction_takes_its_part():
    """Calm takes momentum that no wall gets: with it the account closes as well as without it, and without its part it is open
    by more than twice as much."""
    plain, calmed = (account(dam(calm=calm), 200) for calm in (0.0, 0.05))
    left = [(now + lost)[-1, 0] / np.abs(now).max() for now, lost, _ in (plain, calmed)]
    rubbed = 0.05 * DT * calmed[0][:, 0].sum() / np.abs(calmed[0]).max()
    assert abs(left[1]) < abs(left[0]) + 0.02 < 0.1 < 0.25 * rubbed


def test_sloshing_gives_back_what_it_took():
    """A standing wave: after a quarter of a period the walls have given what the liquid has, after a whole one nothing."""
    cells, depth, crest = 80, 10, 0.2
    k = np.pi / cells
    w = lab.Waves((20, 2, cells))
    w.pour(depth + crest * np.cos(k * (np.arange(cells) + 0.5)))
    omega = np.sqrt(k * np.tanh(k * depth))
    period = 2 * np.pi / omega
    now, lost, _ = account(w, int(2.2 * period / DT))
    # Flux a w/k sin(wt) sin(kx), summed over the length 2/k, on a width of 2.
    most = 2 * crest * omega / k * 2 / k
    at = lambda periods: round(periods * period / DT) - 1
    assert now[at(0.25), 0] == pytest.approx(most, rel=0.03) and now[at(0.75), 0] == pytest.approx(-most, rel=0.03)
    assert -lost[at(0.25), 0] == pytest.approx(most, rel=0.03) and -lost[at(0.75), 0] == pytest.approx(-most, rel=0.03)
    assert np.abs(lost[[at(1), at(2)], 0]).max() < 0.05 * most  # the period is that of the closed form to 1 %
    assert np.abs(now + lost).max() < 0.01 * most


def test_walls_and_held_bodies_take_what_pressure_on_their_faces_is():
    """Beside a block that is held, a porous cell and a shelf, in the middle of a splash: that on the sides of the basin, by
    heads, and on faces of held cells, one by one."""
    held = np.zeros((20, 8, 24), int)
    held[:14, 2:6, 16:19] = 4096
    held[4:6, :, 4:7] = 4096
    held[7, 5, 10] = 1500
    w = lab.Waves(held.shape)
    w.solids(held)
    w.walls(held)
    w.pour(np.where(np.arange(24) < 12, 13.0, 6.0))
    w.update(15)
    w.take_momenta()
    for _ in range(5):
        before = w.counts.sub_updates
        w.update()
        assert w.counts.sub_updates == before + 1
        on_held = w.forces(np.where(held > 0, 0, -1), 1)[0, :2]
        spans = w.spans
        y, x = np.divmod(spans.column, 24)
        top = np.minimum(spans.high, np.maximum(spans.phi, spans.low))
        side = np.where(spans.content > 0, 0.5 * ((spans.phi - spans.low) ** 2 - (spans.phi - top) ** 2), 0.0)
        on_sides = side @ np.stack([(x == 23) * 1.0 - (x == 0), (y == 7) * 1.0 - (y == 0)], axis=1)
        np.testing.assert_allclose(w.take_momenta()[1], DT * (on_held + on_sides), rtol=1e-9, atol=1e-9)
        assert abs(on_held[0]) > 10.0 and abs(on_sides[0]) > 10.0


def test_a_dam_before_a_wall_that_is_held():
    """The flow comes to a block on the floor and goes over it: gain and loss differ by 10 % of the most that moves,
    after five passages."""
    held = np.zeros((20, 3, 120), int)
    held[:4, :, 80:88] = 4096
    now, lost, _ = account(dam(held=held), 600)
    assert np.abs(now + lost).max() < 0.1 * np.abs(now).max()
    without = lab.Waves(held.shape)
    without.solids(held)
    without.pour(np.where(np.arange(120) < 60, 10.0, 0.0))
    now, lost, _ = account(without, 600)
    assert np.abs(now + lost).max() > 0.2 * np.abs(now).max(), "the block takes next to nothing, so nothing is shown"


def test_what_comes_brings_its_momentum():
    """An inflow: rate, time and velocity; what a drain takes is that of the liquid there. The account is open by 5 % of it."""
    w = lab.Waves((20, 2, 100))
    w.pour(6)
    makers = Makers(w)
    makers.flow((20, 22, 0, 2), rate=0.8, u=(1.5, 0.0))
    rows = []
    for _ in range(100):
        makers.update()
        rows.append(w.take_momenta())
    now, lost, came = np.moveaxis(rows, 1, 0)
    assert came[:, 0].sum() == pytest.approx(0.8 * 10.0 * 1.5, rel=1e-4) and not came[:, 1].any()
    left = now[:, 0] + np.cumsum(lost[:, 0] - came[:, 0])
    assert np.abs(left).max() < 0.05 * came[:, 0].sum()
    makers.flow((24, 40, 0, 2), rate=-2.0)
    before = w.take_momenta()[0, 0]
    makers.update(1)
    _, _, gone = w.take_momenta()
    assert before > 0.0 and -2.0 * DT * 1.5 < gone[0] - 0.8 * DT * 1.5 < 0.0


@pytest.mark.parametrize("change", ["threads", "general", 0, 1, 2])
def test_the_account_has_the_same_bits_however_it_is_computed(change):
    """Threads, the general form and every instruction set."""
    found = []
    for changed in (False, True):
        w = dam(held=np.pad(np.full((4, 3, 8), 4096), [(0, 16), (0, 0), (80, 32)]), calm=0.02, bed=0.02)
        if changed and change == "threads":
            w.threads(3)
        elif changed and change == "general":
            w.use_general_form()
        elif changed and not w.use(change):
            pytest.skip("this processor lacks it")
        found.append(np.array(account(w, 150)))
    assert np.array_equal(*found) and found[0][1].any()
