# SPDX-License-Identifier: GPL-2.0-only
"""Random scenes: none breaks down at the certified time step, most do at three times it, with the contact of the paper. They are
always the same."""

import pytest
from random_scenes import BROKEN, MOST, STEPS, play_scenes, try_scenes


def check(trial) -> None:
    """Finite to the end (or Trial raises), energies that add up, every unit of liquid in place."""
    assert trial.drift <= MOST
    assert trial.lost_cells == 0


def check_at_surfaces(trial) -> None:
    """Little energy comes or goes where `check` does not warn that a body folds up. Of 300 scenes with friction 269 kept theirs
    to 1e-3, 27 of the others folded up; the rest are bodies of one and two cells that hit at 0.1 c: 3.2e-3, a tenth of that at
    ``accuracy reference``."""
    check(trial)
    folds = any(m.name == "amplitude" and m.severity == "warning" for m in trial.ready.certificate.margins)
    assert folds or trial.drift <= 5e-3


def judge(count: int, most: float) -> None:
    """Try so many scenes and look at all of them; at least the share ``most`` is to break down at three times the step."""
    tally = try_scenes(count, check)
    assert len(tally.drift) >= count
    assert tally.particles <= 2000 and STEPS <= 2000 and MOST < BROKEN
    # Scenes in which nothing meets anything would be a weak test; contact is on only where swept bounds meet.
    assert tally.met > 0.3 * len(tally.drift) and len(tally.lost) >= 0.02 * count
    free, meeting = tally.share(contact=False), tally.share(contact=True)
    print(f"\n{tally}")
    # Springs and walls alone: 2/w_b is at most 1.24 times below the exact limit, and three halves of it are too long.
    assert free >= 0.9
    # Contact enters the bound as if every corner were pressed 0.7 h deep; few are.
    assert meeting >= 0.15
    assert tally.share() >= most


@pytest.mark.timeout(300)
def test_twenty_random_scenes():
    """Twenty, for every day: so few that the share of those that break down is only roughly known."""
    judge(20, 0.4)


@pytest.mark.soak
@pytest.mark.timeout(1800)
def test_three_hundred_random_scenes():
    """Three hundred, for `make soak`."""
    judge(300, 0.5)


@pytest.mark.timeout(300)
def test_ten_random_scenes_with_friction():
    """Ten, for every day; most of them touch something."""
    assert play_scenes(10, check_at_surfaces, "friction 0.5").met >= 4


@pytest.mark.soak
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("more", ["friction 0.5", "contact-model surface"])
def test_three_hundred_random_scenes_at_the_surfaces(more):
    """Three hundred, for `make soak`, with and without friction."""
    tally = play_scenes(300, check_at_surfaces, more)
    print(f"\n{max(tally.drift):.1e}")
    assert tally.met >= 150
