# SPDX-License-Identifier: GPL-2.0-only
"""Units and dimensions."""

import math

import pytest
from mdanim_lammps.scene import units
from mdanim_lammps.scene.functions import FUNCTIONS, root
from mdanim_lammps.scene.units import DimensionError, Quantity


@pytest.mark.parametrize(("text", "worth", "dim"), [
    pytest.param("cm", 0.01, (1, 0, 0, 0), id="length"),
    pytest.param("km/h", 1000 / 3600, (1, 0, -1, 0), id="hour below the bar"),
    pytest.param("kg*m/s^2", 1.0, (1, 1, -2, 0), id="newton by hand"),
    pytest.param("N", 1.0, (1, 1, -2, 0), id="newton"),
    pytest.param("g/cm^3", 1000.0, (-3, 1, 0, 0), id="density"),
    pytest.param("N*s/m", 1.0, (0, 1, -1, 0), id="drag"),
    pytest.param("l", 1e-3, (3, 0, 0, 0), id="litre"),
    pytest.param("1/s", 1.0, (0, 0, -1, 0), id="rate"),
    pytest.param("rpm", math.pi / 30, (0, 0, -1, 1), id="turns"),
    pytest.param("deg", math.pi / 180, (0, 0, 0, 1), id="degree"),
    pytest.param("GPa", 1e9, (-1, 1, -2, 0), id="pressure"),
])  # fmt: skip
def test_unit_is_worth(text, worth, dim):
    """Know what a unit is in SI and which dimension it has."""
    u = units.unit(text)
    assert u.over / u.under == pytest.approx(worth, rel=1e-15)
    assert u.dim == dim


def test_every_listed_unit_is_one():
    """The list that people see holds units of the kind it says, at least one each."""
    for _, kind, texts in units.LISTED:
        dims = {units.unit(t).dim for t in texts.split()}
        assert len(dims) == 1, kind
        assert dims.pop() in units.NAMES


def test_hour_alone_is_no_unit():
    """Leave h to heights."""
    with pytest.raises(KeyError):
        units.unit("h")


def test_centimetres_are_rounded_once():
    """35 cm is the float 0.35, which 35 * 0.01 is not."""
    assert 35 * 0.01 != 0.35
    assert units.with_unit(35.0, units.unit("cm")) == Quantity(0.35, (1, 0, 0, 0))


M = Quantity(2.0, (1, 0, 0, 0))
KG = Quantity(3.0, (0, 1, 0, 0))


@pytest.mark.parametrize(("function", "arguments", "result"), [
    pytest.param(units.add, (M, M), Quantity(4.0, (1, 0, 0, 0)), id="same"),
    pytest.param(units.add, (M, 1.0), Quantity(3.0, (1, 0, 0, 0)), id="bare numbers are SI"),
    pytest.param(units.multiply, (M, KG), Quantity(6.0, (1, 1, 0, 0)), id="product"),
    pytest.param(units.divide, (M, M), 1.0, id="nothing left"),
    pytest.param(units.power, (M, 3.0), Quantity(8.0, (3, 0, 0, 0)), id="cube"),
    pytest.param(root, (units.power(M, 2.0),), M, id="root of a square"),
    pytest.param(units.power, (Quantity(4.0, (2, 0, 0, 0)), 0.5), M, id="half power"),
    pytest.param(units.modulo, (7.0, 3.0), 1.0, id="mod"),
    pytest.param(units.modulo, (-1.0, 3.0), 2.0, id="mod has the sign of the divisor"),
    pytest.param(units.multiply, ((1.0, 2.0, 3.0), M),
                 tuple(Quantity(2.0 * x, (1, 0, 0, 0)) for x in (1, 2, 3)), id="number times vector"),
    pytest.param(units.add, ((1.0, 2.0, 3.0), (1.0, 1.0, 1.0)), (2.0, 3.0, 4.0), id="vectors"),
])  # fmt: skip
def test_arithmetic(function, arguments, result):
    """Calculate with numbers, quantities and vectors."""
    assert function(*arguments) == result


@pytest.mark.parametrize(("function", "arguments", "words"), [
    pytest.param(units.add, (M, KG), "cannot add a length and a mass (2 m, 3 kg)", id="unlike"),
    pytest.param(units.power, (2.0, M), "an exponent is a plain number, found 2 m", id="exponent"),
    pytest.param(units.power, (-8.0, 1 / 3), "not a real number", id="complex"),
    pytest.param(root, (-1.0,), "sqrt needs a number >= 0, found -1", id="root"),
    pytest.param(FUNCTIONS["sin"][2], (M,), "an angle is needed here, found a length", id="sine"),
    pytest.param(FUNCTIONS["max"][2], (M, KG), "cannot compare", id="maximum"),
    pytest.param(units.add, ((1.0, 2.0), 1.0), "a vector and a number cannot be added", id="unlike shapes"),
    pytest.param(units.multiply, ((1.0,), (1.0,)), "a number is needed here, found a vector", id="vectors"),
    pytest.param(units.with_unit, (M, units.unit("m")), "has a unit already", id="two units"),
])  # fmt: skip
def test_refused_arithmetic(function, arguments, words):
    """Say what cannot be combined, with the values found."""
    with pytest.raises(DimensionError) as error:
        function(*arguments)
    assert words in str(error.value)


@pytest.mark.parametrize(("word", "dim", "hint"), [
    ("kgg", units.unit("kg").dim, "did you mean 'kg'?"),
    ("pa", units.unit("Pa").dim, "did you mean 'Pa'?"),
    ("lb", units.unit("kg").dim, "units that fit: kg g t"),
    ("Mpa", None, "did you mean 'MPa'?"),
])  # fmt: skip
def test_suggest_unit(word, dim, hint):
    """Propose a unit of the kind that is wanted."""
    assert units.suggest_unit(word, dim) == hint
