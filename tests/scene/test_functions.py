# SPDX-License-Identifier: GPL-2.0-only
"""Functions of expressions, beside Python's own."""

import math

import numpy as np
import pytest
from mdanim_lammps.errors import SceneError
from mdanim_lammps.scene.parse import parse_scene

TEXT = """
{lets}
object ball {{ shape sphere 10 cm  position {position}  density 1000 kg/m^3  elasticity 1 MPa }}
control {{ time 1 s }}
"""


def position(value: str, lets: str = "") -> np.ndarray:
    """Where a scene puts a ball [m]."""
    return np.array(parse_scene(TEXT.format(position=value, lets=lets)).solids[0].position)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("floor(2.7)", 2.0),
        ("floor(-2.7)", -3.0),
        ("ceil(2.2)", 3.0),
        ("round(2.5)", 3.0),
        ("round(-2.5)", -2.0),
        ("round((7 m)/(2 m))", 4.0),
        ("exp(1.5)", math.exp(1.5)),
        ("log(exp(2))", 2.0),
        ("sin(asin(0.3))", 0.3),
        ("cos(acos(-0.3))", -0.3),
        ("tan(atan(3))", 3.0),
        ("atan2(1 m, -1 m)/(1 deg)", 135.0),
        ("atan2(-1, 0)/(1 rad)", -0.5 * math.pi),
        ("norm((3, 4, 12))", 13.0),
        ("norm((3 cm, 4 cm, 12 cm))/(1 cm)", 13.0),
        ("norm((3, 4, 12) cm)/(1 m)", 0.13),
        ("dot((1, 2, 3), (4, -5, 6))", 12.0),
        ("dot(cross((1, 2, 3), (4, 5, 6)), (1, 2, 3))", 0.0),
    ],
)
def test_value(text, value):
    """Values of plain numbers, quantities and vectors."""
    assert position(f"({text}, 0, 1) m")[0] == pytest.approx(value, abs=1e-12)


def test_vectors():
    """A cross product is a vector with the product of both units; a let may hold vectors."""
    lets = "let a = (1, 0, 0) m\nlet b = (0, 2, 0) m"
    assert position("cross(a, b)/(1 m)", lets) == pytest.approx([0.0, 0.0, 2.0])
    assert position("a + b/norm(b)*(1 m) + (0, 0, 1) m", lets) == pytest.approx([1.0, 1.0, 1.0])


def test_a_let_may_have_the_name_of_a_new_function():
    """A scene that had the name before the function goes on to work; a call has brackets."""
    assert position("(round, round(1.6), 1) m", "let round = 0.25") == pytest.approx([0.25, 2.0, 1.0])


@pytest.mark.parametrize(
    ("text", "message", "hint"),
    [
        ("floor(2 m)", "floor needs a plain number, found a length, 2 m", "divide it by a unit first: floor(x/(1 m))"),
        ("exp((1, 2, 3))", "a number is needed here, found a vector (x, y, z)", ""),
        ("exp(1000)", "the result is not a finite number", ""),
        ("log(0)", "log needs a number > 0, found 0", ""),
        ("acos(1.5)", "acos needs a number from -1 to 1, found 1.5", ""),
        ("atan2(1 m, 1 s)", "cannot compare a length and a time (1 m, 1 s)", "both need the same kind of unit"),
        ("atan2(1)", "atan2 takes 2 numbers, found 1", ""),
        ("norm(3)", "norm needs a vector, (x, y, z), found 3", ""),
        ("dot((1, 2, 3), (1, 2))", "dot needs vectors of the same length, found 3 and 2 numbers", ""),
        ("norm(cross((1, 2), (1, 2)))", "cross needs vectors of three numbers, found 2", ""),
    ],
)
def test_refused(text, message, hint):
    """Say what was found, at its place."""
    with pytest.raises(SceneError) as caught:
        position(f"({text}, 0, 1) m")
    (problem,) = caught.value.problems
    assert problem.message == message and (problem.hint or "") == hint and problem.line == 3
