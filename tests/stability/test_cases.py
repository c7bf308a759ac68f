# SPDX-License-Identifier: GPL-2.0-only
"""Hard cases stay within their limits: each in its short form here, in its long form in `make soak`."""

import math

import pytest
import surfaces
from case import Case, broken
from cases import CASES
from contacts import IMPACTS, PLATES
from liquids import RESTLESS_IN_WAVES

AMONG_HARDER = (
    "impact at 0.5 c",
    "impact at 0.8 c",
    "0.9 of the tunnelling speed, 3 cells",
    "0.9 of the tunnelling speed, 4 cells",
    "0.9 of the tunnelling speed, plate of 2 cells",
    "1000 times as dense, at rest, 0.02 E",
    "1000 times as dense, at rest, 0.1 E",
    "tower of 3, weak drag",
    "tower of 3, a quarter of a cell askew",
    "plate of one cell, block at 0.4 c",
    "spin, rim at 0.28 c",
    "squeezed to 0.4",
    "beam 100:1, 2 cells thick",
    "drag phi = 0.001",
    "drag phi = 100",
    "tilted",
    "entry at 0.3 c",
    "light, released from the bottom",
    "density 0.01 of the liquid",
    "density 100",
    "20 times softer",
)
"""Cases of a row whose harder or simpler members are run every day; these are with `make soak`, in liquids of both kinds."""


def of_each_day(cases):
    """The cases as parameters, those among harder ones marked."""
    return [
        pytest.param(case, id=case.name, marks=pytest.mark.soak if case.name.removesuffix(", waves") in AMONG_HARDER else ())
        for case in cases
    ]


@pytest.mark.parametrize("case", of_each_day(CASES))
def test_hard_case(case):
    """Measure no more than what the case allows."""
    assert not broken(case, case.measure())


@pytest.mark.parametrize("case", of_each_day(surfaces.CASES))
def test_hard_case_at_surfaces(case):
    """The same with contact at the surfaces, for all in which something touches."""
    assert not broken(case, case.measure())


@pytest.mark.soak
@pytest.mark.timeout(1200)
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_hard_case_for_long(case):
    """The same after ten times the time or more: towers stand for 10^6 steps."""
    assert not broken(case, case.measure(long=True))


def test_names_are_unique():
    """A row of the report is one case; none is marked that is not there."""
    assert len({case.name for case in CASES}) == len(CASES)
    assert {*AMONG_HARDER} <= {case.name for case in CASES}


@pytest.mark.parametrize("case", of_each_day(RESTLESS_IN_WAVES))
def test_light_bodies_do_not_rest_in_waves(case):
    """A known fault, of these alone and of their speed alone: once it is mended they belong to the other cases."""
    assert [what.split(" is ")[0] for what in broken(case, case.measure())] == ["speed left"]


@pytest.mark.parametrize("case", [*IMPACTS, *PLATES], ids=lambda case: case.name)
def test_without_contact_the_limits_are_broken(case):
    """Cases can fail: objects that pass through each other are found out."""
    mute = Case(case.name, case.scene + "effects { contact off }\n", case.play, case.most, case.why)
    assert broken(mute, mute.measure())


@pytest.mark.parametrize(("value", "allowed"), [(1.0, True), (0.0, True), (-1.0, True), (1.1, False), (math.nan, False)])
def test_a_limit_is_the_most_that_is_allowed(value, allowed):
    """At the limit is within it; no number at all is not."""
    case = Case("", "", lambda text, long: {"error": value}, {"error": 1.0}, "")
    assert bool(broken(case, case.measure())) != allowed
