# SPDX-License-Identifier: GPL-2.0-only
"""Drops: what leaves a surface flies as points do and comes back to the unit, with its momentum."""

import numpy as np
import pytest
import waves_forms as forms
import waves_lab as lab
from wave_sources_lab import DROP, Drops

UNIT = lab.UNIT


def put(drops, *records):
    """Have these drops fly: (x, y, z), (vx, vy, vz), units."""
    drops.state = np.array(list(records), DROP).view(np.uint8)


def momentum(w):
    """Momentum of the liquid along x, in a channel along x."""
    links = w.links
    return (links.u * links.height)[links.direction == 0].sum()


def bore(shape=(40, 6, 96), high=30, deep=16.0, shallow=2.0):
    """A dam that breaks onto shallow liquid, runs to a wall, and sheds drops."""
    w = lab.Waves(shape)
    w.pour(np.where(np.arange(shape[2]) < high, deep, shallow))
    return w


def test_a_drop_flies_as_a_point_does():
    """Its way is the parabola of a point, from update to update."""
    w = lab.Waves((40, 12, 12))
    drops = Drops(w, share=0.0)
    put(drops, ((3, 4, 5), (0.7, -0.2, 3.0), 77))
    for n in range(1, 60):
        drops.update(0.1)
        t = 0.1 * n
        (drop,) = drops.all
        assert drop["x"] == pytest.approx([3 + 0.7 * t, 4 - 0.2 * t, 5 + 3 * t - t * t / 2], abs=1e-12)
        assert drop["v"] == pytest.approx([0.7, -0.2, 3 - t], abs=1e-12)


def test_walls_stop_drops():
    """They fall along a wall, into the column beside it."""
    w = lab.Waves((20, 4, 4))
    w.pour(2)
    before = w.volume
    drops = Drops(w, share=0.0)
    put(drops, ((2.1, 2.1, 10), (5, -5, 0), UNIT // 8))
    while len(drops.all):
        (drop,) = drops.all
        assert (drop["x"][:2] >= 0).all() and (drop["x"][:2] < 4).all()
        assert drop["v"][0] == (5 if drop["x"][0] < 3.99 else 0) and drop["v"][1] == (-5 if drop["x"][1] > 0 else 0)
        drops.update(0.1)
    assert (w.volume - before)[0, 3] == 1 / 8 and (w.volume - before).sum() == 1 / 8


def test_a_drop_lands_on_what_is_topmost():
    """On a shelf, not on the liquid below it; and on the floor where all is dry."""
    part = np.zeros((12, 3, 6), int)
    part[6, :, :3] = 4096
    w = lab.Waves(part.shape)
    w.solids(part)
    w.pour(np.where(np.arange(6) < 3, 4.0, 0.0))
    drops = Drops(w, share=0.0)
    put(drops, ((1.5, 1.5, 9), (0, 0, 0), 1000), ((4.5, 1.5, 9), (0, 0, 0), 2000))
    for _ in range(60):
        drops.update(0.1)
    spans = w.spans
    assert len(drops.all) == 0
    assert spans.content[(spans.column == 7) & (spans.floor == 7)].tolist() == [1000]
    assert spans.content[spans.column == 10].tolist() == [2000]


def test_solids_stop_drops():
    """A drop that meets a block falls along it, one that meets a roof from below comes down again, each into the liquid below."""
    part = np.zeros((16, 3, 12), int)
    part[:9, :, 6:8] = 4096  # a block
    part[9, :, :6] = 4096  # a roof
    w = lab.Waves(part.shape)
    w.solids(part)
    w.pour(2.0, above=np.zeros((3, 12)))
    before = w.volume
    drops = Drops(w, share=0.0)
    put(drops, ((1.5, 1.5, 5), (3, 0, 0), UNIT // 4), ((0.5, 1.5, 7), (0, 0, 6), UNIT // 8))
    while len(drops.all):
        for drop in drops.all:
            assert drop["x"][0] < 6 and drop["x"][2] < 9
        drops.update(0.1)
    assert (w.volume - before)[1, [5, 0]].tolist() == [1 / 4, 1 / 8] and (w.volume - before).sum() == 3 / 8


def test_drops_bring_their_momentum():
    """Rain that falls aslant sets a channel in motion, by its mass times its velocity."""
    w = lab.Waves((20, 1, 60))
    w.pour(6)
    drops = Drops(w, share=0.0)
    rain = [((10 + 0.4 * n, 0.5, 6.5), (2.0, 0, 0), UNIT // 50) for n in range(100)]
    put(drops, *rain)
    given = 100 * 2.0 / 50
    while len(drops.all):
        drops.update(0.1)
    w.update()
    assert momentum(w) == pytest.approx(given, rel=0.03)


def test_drops_wake_what_sleeps():
    """Liquid at rest, until a drop lands."""
    w = lab.Waves((12, 5, 5))
    w.pour(3)
    w.update()
    assert w.at_rest
    drops = Drops(w, share=0.0)
    put(drops, ((2.5, 2.5, 4), (0, 0, 0), UNIT // 4))
    while len(drops.all):
        assert w.at_rest
        drops.update(0.1)
    assert not w.at_rest


@pytest.mark.parametrize("share", [0.3, 1.0])
def test_a_bore_sheds_drops_and_loses_nothing(share):
    """Units of liquid and drops sum to the same in every update; no drop has left upwards faster than liquid runs."""
    w = bore()
    drops = Drops(w, share)
    total, most, high = w.total, 0, 0.0
    for _ in range(250):
        w.update()
        drops.update()
        found = drops.all
        assert w.total + drops.total == total and (found["units"] > 0).all() and w.spans.content.min() >= 0
        most = max(most, drops.total)
        high = max(high, found["v"][:, 2].max(initial=0.0))
    assert most > 0.1 * UNIT
    assert 1.0 < high < np.sqrt(2 * 16)


def test_without_a_share_nothing_flies():
    """The default costs nothing: the liquid does the same, to the unit."""
    alone, w = bore(), bore()
    drops = Drops(w, share=0.0)
    for _ in range(60):
        alone.update()
        w.update()
        drops.update()
    assert len(drops.all) == 0 and (w.state == alone.state).all()


def test_still_liquid_and_gentle_waves_shed_nothing():
    """A standing wave of a tenth of the depth has no drops."""
    w = lab.Waves((16, 4, 64))
    w.pour(8 + 0.8 * np.cos(np.pi * (np.arange(64) + 0.5) / 64))
    drops = Drops(w, share=1.0)
    for _ in range(200):
        w.update()
        drops.update()
        assert len(drops.all) == 0


def test_a_stone_throws_a_crown():
    """Outwards on all sides; then drops fly inwards where the cavity closes over it. All of it is accounted."""
    w = lab.Waves((48, 48, 48), calm=0.005)
    w.pour(20)
    total = w.total
    stone = forms.Body(5.0, (24.2, 23.9, 27), 3.0, velocity=(0, 0, -4), drag=0.45)
    drops = Drops(w, share=1.0)

    def flown(updates):
        found = []
        for _ in range(updates):
            stone.move(w, 1)
            drops.update()
            found.append(drops.all)
            assert w.total + drops.total == total
        found = np.concatenate(found)
        away = found["x"][:, :2] - [24.2, 23.9]
        return away, np.sum(away * found["v"][:, :2], axis=1)

    away, out = flown(20)
    assert len(out) > 200 and (out > 0).mean() > 0.7
    assert all((np.sign(away[:, d]) == side).mean() > 0.2 for d in range(2) for side in (-1, 1))
    _, out = flown(25)
    assert (out > 0).mean() < 0.3


def test_too_many_drops_become_fewer_with_all_their_momentum():
    """Two neighbours in the order become one; units and momentum stay."""
    w = lab.Waves((400, 8, 8))
    drops = Drops(w, share=0.0, most=4)
    random = np.random.default_rng(0)
    records = np.zeros(7, DROP)
    records["x"], records["v"] = random.uniform(1, 7, (7, 3)) + [0, 0, 100], random.normal(0, 0.1, (7, 3))
    records["units"] = random.integers(1, 10**6, 7)
    drops.state = records.view(np.uint8)
    drops.update(0.1)
    found = drops.all
    assert len(found) == 4 and drops.total == records["units"].sum()
    before = (records["units"][:, None] * (records["v"] - [0, 0, 0.1])).sum(0)
    assert (found["units"][:, None] * found["v"]).sum(0) == pytest.approx(before, rel=1e-12)


def test_drops_go_on_from_a_state_to_the_last_bit():
    """Waves and drops that take up a state in the middle of a splash go on alike."""
    w = bore()
    drops = Drops(w)
    for _ in range(60):
        w.update()
        drops.update()
    assert len(drops.all) > 10
    other = lab.Waves(w.shape)
    other.state = w.state
    again = Drops(other)
    again.state, again.when = drops.state, drops.when
    for _ in range(40):
        for one, spray in ((w, drops), (other, again)):
            one.update()
            spray.update()
        assert (other.state == w.state).all() and (again.state == drops.state).all()


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda d: d.view(np.uint8)[:-3], "bytes, that is not a multiple of 56"),
        (lambda d: np.array([((9.0, 1, 1), (0, 0, 0), 5)], DROP), r"a drop of 5 units is at \(9"),
        (lambda d: np.array([((1, 1, 1), (0, 0, 0), -5)], DROP), "a drop of -5 units"),
        (lambda d: np.array([((1, np.nan, 1), (0, 0, 0), 5)], DROP), "is damaged"),
        (lambda d: np.array([((1, 1, 1), (0, np.nan, 0), 5)], DROP), "is damaged"),
    ],
)
def test_a_damaged_state_of_drops_is_refused(damage, message):
    """No whole number of drops, or a drop that cannot be; nothing changes."""
    drops = Drops(lab.Waves((8, 4, 4)))
    put(drops, ((1, 2, 3), (0, 0, 0), 5))
    before = drops.state
    with pytest.raises(RuntimeError, match=message):
        drops.state = damage(drops.all).view(np.uint8)
    assert (drops.state == before).all()
