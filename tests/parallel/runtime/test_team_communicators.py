# SPDX-License-Identifier: GPL-2.0-only
"""Communicators of teams: given back where many teams come and go, kept for those that come again."""

import pytest
from mdanim_lammps.parallel.runtime.team_communicators import TeamCommunicators
from mpi4py import MPI
from paths import MPI as PROGRAMS
from ranks_lab import on_ranks


@pytest.mark.mpi
def test_more_teams_than_mpi_has_communicators_for():
    """Each executor is in ten of the twelve teams of three executors, whose orders differ, and MPI has six communicators left."""
    teams, different, of_mpi = map(int, on_ranks(PROGRAMS / "teams.py", 3, 60, 6, 4, timeout=60.0, own=True).split())
    assert (teams, different) == (720, 12)
    assert of_mpi > 1000, "that many were taken away before"


class Executors:
    """A communicator of executors that counts what is made of it."""

    class Made:
        freed = False

        def Free(self):
            assert not self.freed
            self.freed = True

    def __init__(self):
        self.group, self.made = MPI.COMM_SELF.group, []

    def Create_group(self, group):
        self.made.append(self.Made())
        return self.made[-1]


@pytest.fixture
def executors(monkeypatch):
    """One that is asked for teams of ranks that there are not."""
    found = Executors()
    monkeypatch.setattr(found, "group", type("Group", (), {"Incl": staticmethod(lambda members: members)}))
    return found


def test_the_latest_teams_are_kept_and_those_of_the_plan_always(executors):
    """A team that comes again has the same communicator; of the others the oldest goes; a plan may have more than are kept."""
    kept = TeamCommunicators(executors, most=2)
    kept.follow([(0, 1)])
    first = kept.of((0, 1))
    kept.follow([(0, 2)])
    kept.follow([(1, 2), (0, 1)])
    assert kept.of((0, 1)) is first and not first.freed and len(executors.made) == 1
    kept.follow([(0, 1, 2)])
    assert not first.freed
    kept.follow([(1, 0), (2, 3), (4, 5)])
    assert first.freed
    several = [kept.of(members) for members in ((1, 0), (2, 3), (4, 5))]
    assert kept.of((7,)) is None
    kept.close()
    assert all(one.freed for one in several)


def test_teams_of_others_count(executors):
    """All executors forget at the same plan, also who is in few teams: else some would wait for others."""
    kept = TeamCommunicators(executors, most=2)
    kept.follow([(0, 1)])
    mine = kept.of((0, 1))
    for other in range(2, 4):
        kept.follow([(other, other + 1)])
    assert mine.freed
