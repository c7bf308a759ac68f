# SPDX-License-Identifier: GPL-2.0-only
"""Errors, orders and advice, on tracks made by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest
from mdanim_lammps.scene.parse import parse_scene
from mdanim_lammps.study.analysis import Measurement, advice, analyse, off, pareto, sharp
from mdanim_lammps.study.error import SAFETY, SHORT, converge, difference, distance, extent, growth, order_until
from mdanim_lammps.study.setting import Ladder, Setting, together
from mdanim_lammps.study.store import Point
from study_lab import BAR, TIMES, track


def test_distance_leaves_out_what_never_moves():
    """Take the mean over frames and moving objects only: 3 and 4 in two axes are 5 apart."""
    a = track()
    b = a.copy()
    b[1:, 0] += (3.0, 4.0, 0.0)
    assert distance(a, b) == pytest.approx(5.0 * math.sqrt(40 / 41), rel=1e-12)
    assert extent(a) == pytest.approx(2.0, rel=1e-3)


@pytest.mark.parametrize("order", [1.0, 2.0, 3.0])
def test_order_of_a_made_up_ladder(order):
    """Find the exponent that errors were made with, and the limit, from steps that are not evenly spaced."""
    steps = [0.2, 0.14, 0.1, 0.07, 0.05]
    tracks = [track(1.0 + s**order, 0.3 * s**order) for s in steps]
    found = converge(steps, tracks, 2.0)
    # Higher powers of the error, the phase's, leave 5 % in the exponent at the largest step.
    assert found.order == pytest.approx(order, abs=0.05 * order)
    assert distance(found.limit, track()) < 0.1 * distance(track(1.0 + steps[-1] ** order, 0.3 * steps[-1] ** order), track())
    assert found.doubt == pytest.approx(distance(tracks[-1], found.limit) / 2.0)


def test_a_reference_does_not_flatter_its_neighbour():
    """Keep order 2 where a fit against the finest run would say much more: that one's own error is taken off all others."""
    steps = [0.2, 0.14, 0.1]
    tracks = [track(1.0 + s**2) for s in steps]
    plain = [distance(t, tracks[-1]) for t in tracks[:-1]]
    assert math.log(plain[0] / plain[1]) / math.log(steps[0] / steps[1]) > 2.8
    assert converge(steps, tracks, 2.0).order == pytest.approx(2.0, abs=0.01)


@pytest.mark.parametrize(
    ("sizes", "why"),
    [
        pytest.param([0.0, 0.0, 0.0], "round-off", id="all the same"),
        pytest.param([0.1, 0.1, 0.0], "runs converge", id="no nearer from step to step"),
        pytest.param([0.9, -0.9, 0.8, -0.7], "runs converge", id="as far apart as can be"),
        pytest.param([0.1, 0.0], "three runs", id="two runs"),
    ],
)
def test_no_order_where_there_is_none(sizes, why):
    """Say why instead of giving a number, and doubt the finest run by twice as much as it is from those half as fine."""
    steps = [0.2, 0.1, 0.05, 0.025][: len(sizes)]
    tracks = [track(1.0 + x) for x in sizes]
    found = converge(steps, tracks, 2.0)
    assert found.order is None
    assert why in found.why
    assert found.doubt == pytest.approx(SAFETY * distance(tracks[-2], tracks[-1]) / 2.0 if "round-off" not in why else 0.0)


def _beside(track: np.ndarray, aside: float) -> np.ndarray:
    """A track that also goes aside."""
    out = track.copy()
    out[:, 0, 1] += aside * TIMES
    return out


def test_order_of_the_finest_runs_where_all_have_none():
    """Coarse cells may differ by more than any power of the spacing: the three finest runs tell an order, which is doubted by a
    quarter more."""
    steps = [1 / 2, 1 / 3, 1 / 4, 1 / 6, 1 / 8]
    tracks = [_beside(track(1.0 + 0.2 * s**1.5), b) for s, b in zip(steps, (0.95, 0.8, 0.0, 0.0, 0.0))]
    found = converge(steps, tracks, 2.0)
    assert found.order == pytest.approx(1.5, abs=1e-3) and found.used == 3
    assert distance(found.limit, track()) < 1e-3
    assert found.doubt == pytest.approx(SAFETY * distance(tracks[-1], track()) / 2.0, rel=1e-3)


def test_the_limit_is_that_of_the_finest_runs():
    """Coarse runs that are far aside make errors fall steeper than those of the finest runs do, with order 1.5."""
    steps = [1 / 2, 1 / 3, 1 / 4, 1 / 6, 1 / 8]
    tracks = [_beside(track(1.0 + 0.4 * s**1.5), b) for s, b in zip(steps, (0.9, -0.4, 0.0, 0.0, 0.0))]
    found = converge(steps, tracks, 2.0)
    assert found.order > 3.0 and found.used == 4
    assert distance(found.limit, track()) < 1e-3
    assert found.doubt == pytest.approx(distance(tracks[-1], track()) / 2.0, rel=1e-3)


def test_no_order_where_the_finest_runs_turn():
    """Distances alone may fall as a power of the spacing while each run goes elsewhere: that tells no limit."""
    steps = [1 / 2, 1 / 3, 1 / 4, 1 / 6]
    tracks = [track(1.0 + 0.8 * s**2) for s in steps]
    assert converge(steps, tracks, 2.0).order == pytest.approx(2.0, abs=0.01)
    apart = distance(tracks[-1], tracks[-2])
    way = distance(track(), _beside(track(), 1.0))
    tracks[-1] = _beside(tracks[-2], apart / way)
    found = converge(steps, tracks, 2.0)
    assert found.order is None and "different directions" in found.why


def test_a_ladder_that_is_cut_short_is_doubted_more():
    """Fewer runs than were meant to be there may be near each other by chance."""
    own = Setting(4.0, 0.5)
    ladder = Ladder("resolution", tuple(replace(own, cells=float(n)) for n in (2, 3, 4, 6, 8)))
    runs = [track(1.0 + x) for x in (0.1, -0.04, 0.02, -0.01, 0.005)]
    points = {s.key: Point(s, 1e-3, 9, 9, [1.0], [1.0], [1e-5], [0.0], [()], [t]) for s, t in zip(ladder.settings, runs)}
    for count, factor in ((5, SAFETY), (4, SHORT), (3, SHORT)):
        some = {s.key: points[s.key] for s in ladder.settings[:count]}
        found = analyse(some, [ladder], own, TIMES, (), ["a", "b"])
        finest = ladder.settings[count - 1].cells
        near = max(distance(t, runs[count - 1]) for s, t in zip(ladder.settings, runs[:count]) if 2 * s.cells >= finest)
        assert found.doubt == pytest.approx(factor * near / found.scale)


@pytest.mark.parametrize(
    ("error", "doubt", "said"),
    [
        pytest.param(0.11, 0.0372, "11 ± 4 %", id="a doubt is rounded up"),
        pytest.param(0.11, 0.012, "11 ± 1.2 %", id="two digits where the first is 1"),
        pytest.param(0.077, 0.154, "up to 24 %", id="may as well be none"),
        pytest.param(0.11, 1e-4, "11 %", id="well known"),
        pytest.param(0.0, 0.0372, "up to 3.8 %", id="its own limit"),
        pytest.param(0.0, 0.0, "0 %", id="nothing moves"),
        pytest.param(0.0, math.inf, "not known", id="one run"),
    ],
)
def test_errors_are_told_with_their_doubt(error, doubt, said):
    """Say no number of which half may be wrong."""
    assert off(error, doubt) == said


def test_order_is_lost_at_a_blow():
    """Find the order that holds up to a blow whose outcome follows no power of the spacing, and the time of the blow."""
    steps, blow = [1 / 2, 1 / 3, 1 / 4, 1 / 6, 1 / 8], TIMES >= 0.4
    tracks = [track(1.0 + 0.1 * s**2) for s in steps]
    for t, aside in zip(tracks, (0.3, -0.4, 0.35, -0.2, 0.25)):
        t[blow, 0, 1] += aside * (TIMES[blow] - 0.39)
    assert converge(steps, tracks, 2.0).order is None
    time, order = order_until(TIMES, steps, tracks, 2.0)
    assert 0.35 < time < 0.45 and order == pytest.approx(2.0, abs=0.1)
    assert order_until(TIMES, steps, [t[::-1] for t in tracks], 2.0) is None

    own = Setting(4, 0.5)
    ladder = Ladder("resolution", tuple(replace(own, cells=round(1 / s)) for s in steps))
    points = {s.key: Point(s, 1e-3, 100, 10, [1.0], [1.0], [1e-5], [0.0], [()], [t]) for s, t in zip(ladder.settings, tracks)}
    said = "most of the error from the resolution, which has order 2 up to t = 0.38 s and none from then on"
    for touching, why in ((True, ": which particles meet in a blow"), (False, "; how far others are off")):
        assert said + why in advice(analyse(points, [ladder], own, TIMES, (), ["a", "b"], touching=touching))


def test_growth_of_what_parts():
    """Measure the e-folding time of a difference that grows, and when it passes a hundredth of the motion."""
    a, b = track(), track()
    b[:, 0, 0] = 2e-6 * np.exp(TIMES / 0.08)
    found = growth(TIMES, a, b, 2.0)
    assert found.folding == pytest.approx(0.08, rel=0.02)  # the one frame beyond the mark counts too
    assert found.parted == pytest.approx(0.08 * math.log(1e4), abs=TIMES[1])
    assert growth(TIMES, a, a, 2.0).parted is None


def test_not_ranked_what_differs_less_than_the_spread():
    """Call less only what is less by both half spreads, and keep both on the front."""
    a, b, c = Measurement(1.0, 0.3), Measurement(1.2, 0.3), Measurement(2.0, 0.1)
    assert not a.below(b) and not b.below(a)
    assert a.below(c) and not c.below(a)
    same = Measurement(0.1, 0.0)

    def front(values):
        return pareto(values, *(lambda x, y, i=i: values[x][i].below(values[y][i]) for i in (0, 1)))

    assert front({"a": (a, same), "b": (b, same), "c": (c, same)}) == {"a", "b"}
    assert front(
        {"cheap": (a, Measurement(0.2, 0.0)), "good": (c, Measurement(0.1, 0.0)), "bad": (c, Measurement(0.3, 0.0))}
    ) == {"cheap", "good"}


def test_a_difference_of_errors_is_better_known_than_each():
    """Two runs on a line with the truth at 3 ± 1: errors of 3 and 1 with a doubt of 1 each, and a difference of 2 whatever the
    truth; across the line the difference varies, and is never more than the two are apart."""
    still, way = np.zeros((4, 1, 3)), np.ones((4, 1, 3)) * (1.0, 0.0, 0.0)
    way[0] = 0.0  # one object, at rest in the first frame
    unit = distance(still, way)
    a, b, limit = still, 2.0 * way, 3.0 * way
    least, most = difference(a, b, limit, unit)
    assert most == pytest.approx(2.0 * unit)
    beside = [  # the truth anywhere on the circle around the limit
        distance(a, limit + shift) - distance(b, limit + shift)
        for angle in np.linspace(0.0, 2.0 * np.pi, 73)
        for shift in [np.cos(angle) * way + np.sin(angle) * way[..., [1, 0, 2]]]
    ]
    assert least <= min(beside) + 1e-12 and least == pytest.approx(min(beside), abs=0.01 * unit)
    assert difference(a, b, limit, math.inf) == (-2.0 * unit, 2.0 * unit)
    assert difference(a, a, limit, unit) == (0.0, 0.0)


def test_doubt_of_a_first_order_ladder_reaches_its_limit():
    """A finest run that is its own limit is off by as much as from the run half as fine, not as from the one before it."""
    steps = [1 / 4, 1 / 6, 1 / 8]
    tracks = [track(1.0 + s) for s in steps]
    tracks[0][:] = track(1.0 + 1 / 4 + 1e-3)
    tracks[1][:, 0, 1] += 0.2 * TIMES  # no order
    found = converge(steps, tracks, 2.0)
    assert found.order is None
    assert found.doubt >= distance(tracks[-1], track()) / 2.0 > distance(track(1.0 + steps[1]), tracks[-1]) / 2.0


def test_errors_of_opposite_signs_are_not_added():
    """Cells are 8 % short at the own setting and contact is 7.2 % far: it is 0.8 % off, and finer in one thing alone is worse."""
    own = Setting(4.0, 0.5)
    cells = Ladder("resolution", tuple(replace(own, cells=float(n)) for n in (2, 3, 4, 6, 8)))
    contact = Ladder("contact", tuple(replace(own, contact=k) for k in (0.25, 0.5, 1.0, 2.0, 4.0, 8.0)))
    every = together(own, [cells, contact])
    assert [(s.cells, s.contact) for s in every.settings] == [(2, 0.25), (3, 0.5625), (4, 1.0), (6, 2.25), (8, 4.0)]
    points, swing = {}, distance(np.zeros_like(track()), track()) / extent(track())
    for s in {*cells.settings, *contact.settings, *every.settings}:
        seconds, run = s.cells**4 * s.contact**0.5, track(1.0 - 0.32 / s.cells + 0.072 * s.contact**-0.5)
        points[s.key] = Point(s, 1e-3, 100, 10, [seconds], [seconds], [1e-5], [0.0], [()], [run])
    found = analyse(points, [every, cells, contact], own, TIMES, (), ["a", "b"], touching=True)
    for key, r in found.rated.items():
        s = r.point.setting
        truth = abs(-0.32 / s.cells + 0.072 * s.contact**-0.5) * swing
        assert r.error.middle == pytest.approx(truth, abs=found.doubt), key
    said = advice(found)
    assert "stiffer contact alone (4 cells, 0.50 of the bound, contact-stiffness 8) makes it worse" in said
    assert "8 cells, 0.50 of the bound, contact-stiffness 4 brings 0.2" in said and "is as good" not in said


def test_closed_forms_are_sharp_expects():
    """Measure errors by what a line states as the truth, not by bounds and not by vague lines."""
    scene = parse_scene(
        BAR
        + """
expect bar.position.z at 0.1 s = 0.9 +- 0.05 m
expect bar.position.z at 0.1 s = 0.9 +- 0.5 m
expect bar.velocity.z at 0.1 s = -1 +- 0.1 m/s
expect energy.residual = 0 +- 1e-3
expect bar.position.z at 0.1 s < 0.9
"""
    )
    swing = track()[:, :1]
    found = sharp(scene.expects, ["bar"], swing, TIMES)
    assert found == {0: extent(swing), 1: extent(swing), 3: pytest.approx(12.0 / 2, rel=0.03)}  # a speed of 6, by differences
    short = sharp(scene.expects, ["bar"], 0.4 * swing, TIMES)
    assert short[0] == short[1] == 0.9  # the truth goes farther than the run
    assert sharp(scene.expects, ["bar"], 0.1 * swing, TIMES)[1] == 0.9


def test_advice_for_a_scene_without_order():
    """Say that runs part and name no best setting."""
    own = Setting(4, 0.5)
    ladder = Ladder("time step", tuple(Setting(4, f) for f in (0.7, 0.5, 0.35, 0.25)))
    points = {}
    for k, s in enumerate(ladder.settings):
        wild = track()
        wild[:, 0, 0] = (-1) ** k * np.minimum(0.7, 1e-6 * (1 + k) * np.exp(TIMES / 0.06))
        points[s.key] = Point(s, 1e-3, 100, 10, [1.0], [1.0], [1e-5], [0.0], [()], [wild])
    found = analyse(points, [ladder], own, TIMES, (), ["a", "b"])
    assert found.chaotic
    assert "is chaotic" in advice(found)
    assert "e-fold every 0.06" in advice(found)
