# SPDX-License-Identifier: GPL-2.0-only
"""Words that would save time, as `check` and the end of a run tell them."""

from dataclasses import replace
from types import SimpleNamespace

import pytest
from mdanim_lammps.errors import DivergedError
from mdanim_lammps.report import saving_lines
from mdanim_lammps.results.cost import Cost
from mdanim_lammps.run.loop import simulate
from mdanim_lammps.run.prepare import prepare

BRICKS = """gravity (0, 0, -9.81) m/s^2
ground z 0 m
repeat i in 0 .. 3 {
  object brick[i] { shape box (20, 10, 6) cm  position (0, 0, 3 + 6*i) cm  density 800  elasticity 5 MPa  damping 0.1 }
}
control { time 0.06 s  frames 50 fps  friction 0.5 }
"""


@pytest.fixture
def told(monkeypatch):
    """Savings of runs however short they are; a forecast is a millisecond for each step, and no matter of this machine."""
    from mdanim_lammps.cost import saving

    monkeypatch.setattr(saving, "LEAST", 0.0)
    monkeypatch.setattr(saving, "forecast", lambda ready, movie: counted(ready))
    return saving


def counted(ready):
    return Cost(1.0 + 1e-6 * ready.certificate.steps * ready.system.particles, 1, 1, other={"setup": 1.0})


def test_what_is_saved_is_told_before_and_after_a_run(prepared, tmp_path, told):
    """Bricks as rigid ones, with eight particles each: of the run as it is the forecast counts, or what it has taken."""
    ready = prepared(BRICKS)
    cost = counted(ready)
    (saving,) = told.before_run(ready, cost)
    assert [name for name, _ in saving.proposal.groups] == ["brick[0...3]"]
    assert saving.now == cost.total - 1.0
    assert saving.then == counted(prepare(saving.proposal.scene)).total - 1.0
    (tmp_path / "out").mkdir()
    result = simulate(ready, tmp_path / "out")
    (after,) = told.after_run(ready, tmp_path / "out", replace(result.cost, wall=9.0 + result.cost.other["setup"]))
    assert after.now == pytest.approx(9.0) and after.then == saving.then
    lines = saving_lines([after])
    assert lines[0] == "quicker  with elasticity rigid these would look the same (measured in the frames of the run):"
    assert "brick[0...3]: largest strain 0." in lines[1] and "of the time" in lines[2] and len(lines) == 3
    assert saving.to_json()["groups"][0]["objects"] == "brick[0...3]"


def test_nothing_is_said_of_a_short_run_nor_where_the_other_form_takes_as_long(prepared, monkeypatch, told):
    """Nor where it cannot be run, or the forecast found an end of the run."""
    ready = prepared(BRICKS)
    cost = counted(ready)
    assert not told.before_run(ready, None)
    for name, value in (
        ("MOST", 1e-9),
        ("LEAST", 1e9),
        ("forecast", lambda ready, movie: DivergedError("it stops")),
        ("forecast", lambda ready, movie: None),
    ):
        with monkeypatch.context() as other:
            other.setattr(told, name, value)
            assert not told.before_run(ready, cost)
    assert told.before_run(ready, cost)


@pytest.mark.parametrize(
    ("now", "then", "part"), [(185.0, 0.61, "1/300"), (10.0, 0.8, "1/12"), (10.0, 3.0, "1/3"), (9.0, 0.6, "1/15")]
)
def test_the_part_of_the_time_has_few_digits(now, then, part):
    """One, or two where the first is a 1: no forecast is better than that."""
    proposal = SimpleNamespace(words="elasticity rigid", how="measured", ladder="rigid", groups=(("ball", "largest strain 1 %"),))
    assert f"about {part} of the time" in saving_lines([SimpleNamespace(proposal=proposal, now=now, then=then)])[-1]
