# SPDX-License-Identifier: GPL-2.0-only
"""The page of published figures: what is kept is what it tells, and every scene of it can be run."""

import math
import sys

import pytest
from mdanim_lammps.scene.parse import load_scene
from paths import REPOSITORY

sys.path.insert(0, str(REPOSITORY / "bench"))
import validation
from published import ropes, yielding

CASES = validation.cases()
SCENES = sorted((REPOSITORY / "scenes" / "validation").glob("*.txt"))


def test_the_page_is_what_its_program_writes():
    """A case whose kept figures change has its page written again."""
    text = validation.PAGE.read_text(encoding="utf-8")
    assert validation.overview(CASES).strip() in text and validation.beside_peers(CASES).strip() in text
    for case in CASES:
        assert validation.section(case).strip() in text, case.name


@pytest.mark.parametrize("scene", SCENES, ids=lambda path: path.stem)
def test_scenes_are_valid_and_belong_to_a_case(scene):
    """A scene of the page is read without a problem, and one of its cases has its name or begins with it."""
    load_scene(scene)
    assert any(scene.stem.startswith(case.name) for case in CASES)


@pytest.mark.parametrize("case", [case for case in CASES if case.quick], ids=lambda case: case.name)
def test_quick_cases_give_what_is_kept(case):
    """Figures of a case that takes seconds are those of the page, to the digits that processors share."""
    found, _ = validation.measured(case, "balanced")
    kept = validation.kept(case)["balanced"][0]
    for row, before in zip(found.rows, kept, strict=True):
        assert math.isclose(row.found, before.found, rel_tol=1e-6), row.figure
        assert row.within == before.within, row.figure


def test_a_row_is_close_within_its_tolerance_only():
    """The tolerance is of the published figure, or of the scale of the row; a figure that was not found is not close."""
    assert validation.Row("a", 2.0, 2.1, 0.051).close and not validation.Row("a", 2.0, 2.1, 0.049).close
    assert validation.Row("a", 0.0, 0.1, 0.051, scale=2.0).close
    assert not validation.Row("a", 2.0, math.nan, 0.5).close


def test_closed_forms_of_the_page_have_their_known_ends():
    """A strip that sticks out a little droops by L^3/8 as a beam does, and Peirce's formula goes along; a bar whose section
    yields all through is bent by 20/9 of what its first yield is."""
    assert math.isclose(ropes.heavy(0.3), math.degrees(0.3**3 / 8.0), rel_tol=1e-3)
    assert math.isclose(ropes.peirce(ropes.heavy(1.4)), 1.4, rel_tol=0.01)
    assert math.isclose(yielding.under(1.0) / yielding.under(2.0 / 3.0), 20.0 / 9.0, rel_tol=1e-6)
