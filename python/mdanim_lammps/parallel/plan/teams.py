# SPDX-License-Identifier: GPL-2.0-only
"""Teams of executors for islands that are too heavy for one.

A team on one host is its leader with threads for the processors of all. On several hosts it is an instance of LAMMPS on the ranks
of all.
"""

from __future__ import annotations

import numpy as np

from ...records import dataclass

TENTH = (11, 10)
"""Loads within this ratio of the mean, or of the largest island, are in balance."""
LEAST = 8000
"""Particles for each member of a team: below, talking at every step costs more than it spares. Where processors are shared with
other work, teams of less are slower than one executor."""
GAIN = 60
"""Speed that every further member adds to a team, in percent of one executor; two have been measured at 140 to 180."""


LEAST_BY_THREADS, GAIN_BY_THREADS = 1000, 80
"""The same where the leader has threads for all: two have been measured at 160 to 190."""


@dataclass(frozen=True, slots=True)
class Team:
    """An island that several executors run together."""

    island: int
    members: tuple[int, ...]
    """Executors; the first one leads: it owns the objects."""


def time_each(cost: int, size: int, gain: int) -> int:
    """Time that an island takes of each of ``size`` executors [µs]."""
    return cost * 100 // (100 + gain * (size - 1))


def form(weight, particles, home, executors, previous, gain, least) -> tuple[Team, ...]:
    """Teams for islands above the mean by more than a tenth, of as many as bring them back to it.

    A team shrinks only when the smaller one would keep to the mean. Leaders are at home where they can be, members those that
    were, then those with least to do. A loop over islands above the mean: fewer than K, and O(K) turns.

    :param weight: cost of every island [µs], shape (I,), with its ``particles``
    :param home: executor that has most of it, -1 for none, shape (I,)
    :param previous: teams of the frame before, known by their leaders
    :param gain: as `GAIN` [%], and ``least`` as `LEAST`
    """
    most = np.minimum(particles // least, executors)
    found = np.flatnonzero((most >= 2) & (weight * executors > weight.sum()))
    if not len(found):
        return ()
    heavy = [int(i) for i in found[np.lexsort((found, -weight[found]))]]
    before = {team.members[0]: team.members for team in previous}
    cost = {i: int(weight[i]) for i in heavy}
    size, old = {}, {}
    for i in heavy:
        old[i] = before.pop(int(home[i]), ())
        size[i] = max(1, min(len(old[i]), int(most[i])))

    def spent():
        return int(weight.sum()) + sum(size[i] * time_each(cost[i], size[i], gain) - cost[i] for i in heavy)

    def shrink():
        for i in heavy:
            while size[i] > 1 and time_each(cost[i], size[i] - 1, gain) * executors <= spent():
                size[i] -= 1

    shrink()
    while True:
        left = executors - sum(n for n in size.values() if n > 1)
        short = [
            i
            for i in heavy
            if size[i] < most[i]
            and left >= (2 if size[i] == 1 else 1)
            and time_each(cost[i], size[i], gain) * executors * TENTH[1] > spent() * TENTH[0]
        ]
        if not short:
            break
        size[max(short, key=lambda i: (time_each(cost[i], size[i], gain), -i))] += 1
    shrink()

    wanted = [i for i in heavy if size[i] > 1]
    load = np.bincount(home[home >= 0], weight[home >= 0], executors)
    for i in wanted:
        if home[i] >= 0:
            load[home[i]] -= cost[i]
    free, members = set(range(executors)), {}
    for i in wanted:
        leader = int(home[i])
        if leader not in free:
            leader = min(free - {int(home[j]) for j in wanted} or free, key=lambda e: (load[e], e))
        free.remove(leader)
        members[i] = [leader]
    for i in members:
        ranked = sorted(free, key=lambda e: (e not in old[i], load[e], e))[: size[i] - 1]
        free.difference_update(ranked)
        members[i] += sorted(ranked)
    return tuple(Team(i, tuple(members[i])) for i in sorted(members) if len(members[i]) > 1)
