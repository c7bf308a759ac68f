# SPDX-License-Identifier: GPL-2.0-only
"""Have teams of two and more ranks, in every order of members, one after the other and again and again, where MPI has few
communicators left; print how many there were: ``mpiexec -n N python teams.py ROUNDS LEFT MOST``."""

import sys
from itertools import permutations

from mdanim_lammps.parallel.runtime.team_communicators import TeamCommunicators
from mpi4py import MPI

world = MPI.COMM_WORLD
rounds, left, most = map(int, sys.argv[1:])
taken = []
while True:
    try:
        taken.append(MPI.COMM_SELF.Dup())
    except MPI.Exception:
        break
for comm in taken[-left:]:
    comm.Free()

communicators = TeamCommunicators(world, most)
ranks = range(world.size)
teams = [members for size in ranks[1:] for members in permutations(ranks, size + 1)] * rounds
for members in teams:
    communicators.follow([members])
    if world.rank in members:
        comm = communicators.of(members)
        assert members[comm.rank] == world.rank and comm.size == len(members), "the leader is first"
communicators.close()
world.Dup().Free()
if world.rank == 0:
    print(len(teams), len(set(teams)), len(taken))
