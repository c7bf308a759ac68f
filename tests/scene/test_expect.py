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
    """Of its size, whatever its sign and unit."""
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
    """What says nothing is refused with a way out."""
    problem = refusal(f"expect {line}")
    assert (problem.message, problem.hint) == (message, hint)
