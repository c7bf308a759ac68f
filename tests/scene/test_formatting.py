# SPDX-License-Identifier: GPL-2.0-only
"""Numbers and quantities in messages."""

import re

import pytest
from command_line import GOOD
from mdanim_lammps.scene.formatting import PREFIXED, at_least, at_most, estimate, number, say, whole
from mdanim_lammps.scene.units import unit


@pytest.mark.parametrize(
    ("value", "si", "digits", "text"),
    [
        pytest.param(176.3e3, "Pa", 3, "176 kPa", id="a prefix for a power of ten"),
        pytest.param(1.8e2, "Pa", 2, "180 Pa", id="two digits, and no power of ten for the third"),
        pytest.param(2e9, "Pa", 3, "2 GPa", id="the largest prefix"),
        pytest.param(999.9, "Pa", 3, "1 kPa", id="the unit is that of the rounded number"),
        pytest.param(0.034, "m", 3, "3.4 cm", id="a length"),
        pytest.param(-0.0051, "m", 3, "-5.1 mm", id="below zero"),
        pytest.param(0.0, "m", 3, "0 m", id="nothing has no size"),
        pytest.param(3.0e-17, "m", 3, "3e-17 m", id="too small for any unit"),
        pytest.param(3.36e-5, "s", 3, "0.0336 ms", id="a time step"),
        pytest.param(2.5, "s", 3, "2.5 s", id="a time"),
        pytest.param(0.0453, "m^3", 3, "45.3 l", id="a volume"),
        pytest.param(12345.6, "kg/m^3", 3, "12300 kg/m^3", id="no prefix, five digits"),
        pytest.param(123456.0, "J", 3, "1.23e5 J", id="six digits"),
        pytest.param(123456.0, "J", 6, "123456 J", id="six digits that are known"),
        pytest.param(float("inf"), "s", 3, "inf s", id="not finite"),
    ],
)
def test_quantities_are_written_as_people_do(value, si, digits, text):
    """Write some digits and the unit that suits the size."""
    assert say(value, si, digits) == text


@pytest.mark.parametrize(
    ("value", "text"), [(0.001, "0.001"), (0.00099, "9.9e-4"), (99_949.0, "99900"), (99_960.0, "1e5"), (0.16249, "0.162")]
)
def test_powers_of_ten_stand_only_at_the_ends(value, text):
    """Write no power of ten between 0.001 and 99999."""
    assert number(value) == text


def test_counts_stand_in_threes():
    """Set thousands apart."""
    assert whole(1234567) == "1 234 567" and estimate(1234567.0) == "1 230 000" and estimate(3e12) == "3e12"


@pytest.mark.parametrize(("value", "enough"), [(174.2, 180.0), (180.0, 180.0), (990.1, 1000.0), (0.0991, 0.1)])
def test_what_is_told_to_write_is_enough(value, enough):
    """Round up."""
    assert at_least(value) == pytest.approx(enough, rel=1e-12) and at_least(value) >= value


@pytest.mark.parametrize(("value", "enough"), [(0.0125, 0.0125), (0.012349, 0.0123), (0.01239, 0.0123), (0.9996, 0.999)])
def test_what_is_told_to_write_is_not_too_much(value, enough):
    """Round down."""
    assert at_most(value) == pytest.approx(enough, rel=1e-12)


@pytest.mark.parametrize("si", PREFIXED)
def test_a_scene_reads_what_is_said(si):
    """Know every unit that is written, and what it is worth, in the scene language too."""
    for name, worth, _ in PREFIXED[si]:
        known = unit(name)
        assert known.dim == unit(si).dim
        assert known.over / known.under == pytest.approx(worth * unit(si).over / unit(si).under, rel=1e-15)


def test_warnings_have_no_powers_of_ten(prepared):
    """Warn of a fall onto a soft ball, and do what the hint says: the warning goes."""
    text = GOOD.replace("shape box (10, 10, 10) cm", "shape sphere 20 cm").replace("(0, 0, 6) cm", "(0, 0, 60) cm")
    first = prepared(text.replace("100 kPa", "21.7 kPa")).warnings[0]
    assert not re.search(r"\de[+-]?\d", f"{first}"), first
    told = re.search(r"write elasticity (\d\d\d kPa) or more", first.hint)[1]
    assert not prepared(text.replace("100 kPa", told)).warnings
