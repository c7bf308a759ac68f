# SPDX-License-Identifier: GPL-2.0-only
"""Expect lines as they are written: relations, tolerances in per cent, subjects, and what is refused."""

from __future__ import annotations

import pytest
from mdanim_lammps.errors import SceneError
from mdanim_lammps.scene.parse import parse_scene

BALL = """
object ball { shape sphere 10 cm position (0, 0, 1) m mass 1 kg elasticity 150 kPa }
control { time 1 s }
"""


def expected(line, scene=BALL):
    """The last expectation of a scene with this line."""
    return parse_scene(f"{scene}{line}\n").expects[-1]


def refusal(line, scene=BALL):
    """The one problem of a scene with this line."""
    with pytest.raises(SceneError) as error:
        parse_scene(f"{scene}{line}\n")
    (problem,) = error.value.problems
    return problem


@pytest.mark.parametrize(
    ("written", "relation"), [("=", "="), ("<", "<"), (">", ">"), ("<=", "<="), (">=", ">="), ("≤", "<="), ("≥", ">=")]
)
def test_relations(written, relation):
    """Every relation is read, with and without blanks around it, behind a time as well."""
    for line in (f"ball.position.z {written} 10 cm", f"ball.position.z{written}10 cm", f"ball.position.z at 1 s{written}10 cm"):
        e = expected(f"expect {line}")
        assert (e.relation, e.value, e.tolerance) == (relation, 0.1, 0.0), line


@pytest.mark.parametrize(("value", "tolerance"), [("0.12 m", 0.0024), ("-12 cm", 0.0024), ("2 m", 0.04)])
def test_a_tolerance_in_per_cent_is_of_the_value(value, tolerance):
    """Per cent of its size, whatever its sign and unit."""
    assert expected(f"expect ball.position.z = {value} +- 2 %").tolerance == pytest.approx(tolerance, rel=1e-15)
    assert expected(f"expect ball.position.z = {value} ± (1 + 1)%").tolerance == pytest.approx(tolerance, rel=1e-15)


@pytest.mark.parametrize(
    ("line", "message", "hint"),
    [
        ("ball.position.z < 10 cm +- 1 cm", "a tolerance cannot follow '<'", "write the bound itself, or = 0.1 +- ..."),
        ("ball.position.z = 0 m +- 2 %", "per cent of 0 is nothing", "write a tolerance with the unit of the value"),
        ("ball.position.z = 1 m +- 2 cm %", "per cent is of a plain number, found 2 cm", "leave out the unit, or the per cent"),
        ("ball.position.z = 1 m +- -2 %", "the tolerance must be >= 0, found -2", ""),
        ("ball.position.z = 5 %", "'%' cannot follow here; expect is complete", "write a fraction"),
        ("ball.position.z => 5 m", "a number is expected here, found '>'", ""),
        ("ball.position.z 5 m", "'=' is missing in expect, found '5'",
         "e.g. expect ball.position.z at 1 s = 0.1 m +- 1 cm; or <, >, <=, >="),
    ],
)  # fmt: skip
def test_mistakes_of_relations_and_tolerances(line, message, hint):
    """Lines that demand nothing are refused with a way out."""
    problem = refusal(f"expect {line}")
    assert (problem.message, problem.hint) == (message, hint)


TWO = (
    BALL
    + """
object cube[2] { shape box (1, 1, 1) m position (3, 0, 1) m mass 1 kg elasticity 150 kPa }
liquid water { basin from (-5, -4, -3) m to (5, 4, 3) m density 1000 kg/m^3 level 0 m }
gravity (0, 0, -9.81) m/s^2
"""
)


def test_arguments_of_quantities():
    """Another object of a distance, with its index; a place of a height, in any unit."""
    e = expected("expect ball.distance(cube[1 + 1]) at 1 s > 2 m", TWO)
    assert (e.quantity, e.argument, e.what) == ("distance", "cube[2]", "ball.distance(cube[2])")
    for place in ("(50 cm, -1 m)", "(0.5, -1)", "(0.5, -1) m", "(50, -100) cm"):
        e = expected(f"expect liquid.height{place} at 1 s = 1 m", TWO)
        assert (e.quantity, e.argument, e.what) == ("height", (0.5, -1.0), "liquid.height(0.5 m, -1 m)"), place


def test_a_liquid_may_be_called_by_its_name():
    """`liquid` and its own name are the same subject."""
    for what in ("level", "height(0 m, 0 m)", "residual"):
        assert expected(f"expect water.{what} = 1", TWO) == expected(f"expect liquid.{what} = 1", TWO)


@pytest.mark.parametrize(
    ("line", "message", "hint"),
    [
        ("ball.distance < 1 m", "distance needs another object in brackets", "write distance(cube)"),
        ("ball.distance(ball) < 1 m", "the distance of ball and itself is 0", "name another object"),
        ("ball.distance(cub[2]) < 1 m", "no object is called cub[2]", "did you mean 'cube[2]'?"),
        ("ball.distance() < 1 m", "distance needs another object in brackets, found ')'", ""),
        ("ball.distance(cube[2] < 1 m", "a ) is missing after cube, found '<'", ""),
        ("ball.air.force < 1 N", "ball.air.force needs an air block, and the scene has none",
         "write one, as 'mdanim-lammps explain air' shows, or take this out"),
        ("liquid.height < 1 m", "height needs a place (x, y) in brackets", "write height(0.2 m, 0 m)"),
        ("liquid.height(6 m, 0 m) < 1 m", "the place (6, 0) m lies outside the basin",
         "the basin goes from (-5, -4) to (5, 4) m"),
        ("liquid.height(1 kg, 0) < 1 m", "x of the place of height must be a length, found (1 kg, 0), a mass",
         "units that fit: m mm cm km"),
        ("ball.speed(cube[2]) < 1 m/s", "speed has nothing in brackets", "write ball.speed"),
        ("liquid.flow.x(1 s) < 1 m^3/s", "the place of flow.x must be a length, found 1 s, a time", "units that fit: m mm cm km"),
        ("liquid.flow.z(1 m) < 1 m^3/s", "flow.z is not a quantity of liquid", "write flow.x or flow.y"),
        ("ball.joint.powr(world) < 1 W", "joint.powr is not a quantity of ball", "did you mean 'joint.power'?"),
        ("ball.height < 1 m", "height is not a quantity of ball", "it belongs to liquid: write liquid.height(0.2 m, 0 m)"),
        ("ball.stress < 1 Pa", "stress is not a quantity of ball", "write stress.max, stress.x, stress.y or stress.z"),
    ],
)  # fmt: skip
def test_mistakes_of_arguments(line, message, hint):
    """Arguments that are missing, unknown or out of place are refused."""
    problem = refusal(f"expect {line}", TWO)
    assert (problem.message, problem.hint) == (message, hint)
