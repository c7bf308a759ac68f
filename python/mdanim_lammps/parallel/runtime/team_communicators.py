# SPDX-License-Identifier: GPL-2.0-only
"""Communicators of teams: MPI has about 2000 in a process at a time, and a long run may have more different teams than that."""

from __future__ import annotations

from collections.abc import Collection

from mpi4py import MPI

MOST_COMMUNICATORS = 256
"""Teams whose communicators are kept; those of the plan in use are kept in any case. Teams of all executors count, because MPI
looks for a number that is free on all members of a team."""

Members = tuple[int, ...]


class TeamCommunicators:
    """One for each team, kept for when that team comes again.

    To free a communicator is a matter of all its members. All executors follow the same plans, hence all know the same teams in
    the same order and free those that have not been used for longest at the same plan, without a message.
    """

    def __init__(self, comm: MPI.Comm, most: int = MOST_COMMUNICATORS):
        """``comm``: of all executors, whose ranks the members of teams are."""
        self.comm, self.most = comm, most
        self._known: dict[Members, MPI.Comm | None] = {}
        """Teams of all executors, the latest last; None where this one is not a member, or the communicator was not asked for."""

    def follow(self, teams: Collection[Members]) -> None:
        """Take up the teams of a plan; no communicator of another team may be in use. All executors call it with each plan."""
        for members in teams:
            self._known[members] = self._known.pop(members, None)
        for members in list(self._known)[: -max(self.most, len(set(teams)), 1)]:
            self._free(members)

    def of(self, members: Members) -> MPI.Comm | None:
        """The communicator of a team of the plan, its leader first; None for one executor alone. Its members call it together."""
        if len(members) == 1:
            return None
        comm = self._known[members] or self.comm.Create_group(self.comm.group.Incl(members))
        self._known[members] = comm
        return comm

    def close(self) -> None:
        """Free all. All executors call it, at the end."""
        for members in list(self._known):
            self._free(members)

    def _free(self, members: Members) -> None:
        comm = self._known.pop(members)
        if comm is not None:
            comm.Free()
