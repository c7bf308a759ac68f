# SPDX-License-Identifier: GPL-2.0-only
"""Hard cases stay within their limits: each in its short form here, in its long form in `make soak`."""

import math

import pytest
import surfaces
from case import Case, broken
from cases import CASES
from contacts import IMPACTS, PLATES
from liquids import RESTLESS_IN_WAVES

every_case = pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)


@every_case
def test_hard_case(case):
    """Measure no more than what the case allows."""
    assert not broken(case, case.measure())


@pytest.mark.parametrize("case", surfaces.CASES, ids=lambda case: case.name)
def test_hard_case_at_surfaces(case):
    """The same with contact at the surfaces, for all in which something touches."""
    assert not broken(case, case.measure())


@pytest.mark.soak
@pytest.mark.timeout(1200)
@every_case
def test_hard_case_for_long(case):
    """The same after ten times the time or more: towers stand for 10^6 steps."""
    assert not broken(case, case.measure(long=True))


def test_names_are_unique():
    """A row of the report is one case."""
    assert len({case.name for case in CASES}) == len(CASES)


@pytest.mark.parametrize("case", RESTLESS_IN_WAVES, ids=lambda case: case.name)
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
