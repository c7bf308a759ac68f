# SPDX-License-Identifier: GPL-2.0-only
"""Which LAMMPS instances a plan wants of an executor."""

import numpy as np
from mdanim_lammps.parallel.plan.frame_plan import FrameAssignment
from mdanim_lammps.parallel.plan.teams import Team
from mdanim_lammps.parallel.runtime.bundle import wanted_bundles

OWNER = np.array([0, 0, 1, -1, 0, 2, 1])
LABEL = np.array([0, 1, 2, -1, 0, 3, 4])
BUNDLE = np.array([5, 5, 7, -1, 5, 9, 8])
GUESTS = np.array([[1, 3], [2, 3]])


def wanted(executor, objects=7, teams=()):
    """(objects that it has, liquid, team, objects that it moves) of each bundle."""
    plan = FrameAssignment(OWNER, LABEL, BUNDLE, GUESTS, tuple(teams), np.zeros(3, np.int64))
    return [(w.key.objects, w.key.grid, w.key.team, w.members.tolist()) for w in wanted_bundles(plan, objects, executor)]


def test_bundles_of_one_executor():
    """Its own, in the order of their numbers, with copies of the still objects that their islands touch."""
    assert wanted(0) == [((0, 1, 3, 4), False, (0,), [0, 1, 4])]
    assert wanted(1) == [((2, 3), False, (1,), [2]), ((6,), False, (1,), [6])]
    assert wanted(2) == [((5,), False, (2,), [5])]
    assert wanted(3) == []


def test_the_pool_is_a_bundle_of_its_island():
    """The last object of all is the liquid; it is none of LAMMPS's molecules."""
    assert wanted(1, objects=6) == [((2, 3), False, (1,), [2]), ((), True, (1,), [])]


def test_a_team_comes_first_and_all_its_members_want_it():
    """Members run what they do not own, before what is their own; one in no team does not."""
    team = Team(4, (1, 2))
    assert wanted(1, teams=[team]) == [((6,), False, (1, 2), [6]), ((2, 3), False, (1,), [2])]
    assert wanted(2, teams=[team]) == [((6,), False, (1, 2), [6]), ((5,), False, (2,), [5])]
    assert wanted(0, teams=[team]) == wanted(0)
