# SPDX-License-Identifier: GPL-2.0-only
"""Which executor runs which island: collisions first, then balance, then few moves (Wcislo 1999, sec. 6.1).

Pure functions of arrays that every executor has, on integers only, so that all of them decide the same.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...records import dataclass
from .teams import GAIN, LEAST, TENTH, Team, form, time_each

CRUMB = 64
"""Islands that are smaller than the mean load over this are dealt out by whole runs."""


@dataclass(frozen=True, slots=True)
class Assignment:
    """Which executor runs which objects in a frame."""

    owner: np.ndarray
    """Executor of every object, int64, shape (M,); unchanged for objects that never move."""
    teams: tuple[Team, ...]
    """By island; no executor is in two of them."""
    load: np.ndarray
    """Time that each of K executors will need [µs], int64, shape (K,)."""


def assign(
    label: np.ndarray,
    cost: np.ndarray,
    owner: np.ndarray,
    executors: int,
    *,
    particles: np.ndarray | None = None,
    order: np.ndarray | None = None,
    teams: Sequence[Team] = (),
    gain: int = GAIN,
    least: int = LEAST,
) -> Assignment:
    """Executors for all islands: 1. no island is split; 2. loads within a tenth of the mean, or of the largest island, where
    islands allow it; 3. what moves costs little, and nothing moves while loads are in balance.

    An island stays at its home, the executor that has most of it. Where that is overloaded, large islands stay and the smallest
    go, not more than there is too much; they go to the executor that has least. Only where that leaves loads out of balance by
    more than a tenth that a new packing would spare are the large islands packed anew. Ties: lowest executor, smallest island.
    O(M log M), a loop over K executors and over at most ``CRUMB`` K islands. Raises ValueError for a cost below 0 or an owner out
    of range.

    :param label: island of every object, -1 for what is still, shape (M,)
    :param cost: time of every object in a frame [µs], int64, shape (M,); an island counts as 1 at least
    :param owner: executor that has it now, -1 for none, shape (M,)
    :param executors: their number K
    :param particles: of every object, shape (M,); without it there are no teams
    :param order: a number for every object, near for objects that are near, shape (M,): what is dealt out is so by runs of it
    :param teams: those of the frame before
    """
    if (cost < 0).any() or (owner < -1).any() or (owner >= executors).any():
        raise ValueError("a cost is negative, or an owner is not one of the executors")
    moving = np.flatnonzero(label >= 0)
    if not len(moving):
        return Assignment(owner.astype(np.int64), (), np.zeros(executors, np.int64))
    isle = label[moving]
    weight = np.maximum(total(isle, cost[moving]), 1)
    home = _homes(isle, np.maximum(cost[moving], 1), owner[moving], executors)
    first = moving[firsts(isle)]
    rank = np.argsort(first if order is None else order[first], kind="stable")
    place, load = _place(weight, home, (), executors, rank, gain)
    formed: tuple[Team, ...] = ()
    if particles is not None and executors > 1:
        formed = form(weight, total(isle, particles[moving]), home, executors, teams, gain, least)
    if formed:
        together, new = _place(weight, home, formed, executors, rank, gain)
        better, worse = (20, 19) if teams else (19, 20)  # a new team has to be better by a twentieth, an old one not much worse
        if new.max() * worse <= load.max() * better:
            place, load = together, new
        else:
            formed = ()
    new = owner.astype(np.int64)
    new[moving] = place[isle]
    return Assignment(new, formed, load)


def total(group: np.ndarray, value: np.ndarray, groups: int = 0) -> np.ndarray:
    """Sum of the values of every group, int64; exact below 2^53."""
    return np.bincount(group, value, groups).astype(np.int64)


def firsts(group: np.ndarray) -> np.ndarray:
    """Where each of the groups 0, 1 ... is met first."""
    first = np.empty(int(group.max()) + 1, np.int64)
    first[group[::-1]] = np.arange(len(group))[::-1]
    return first


def _homes(isle: np.ndarray, cost: np.ndarray, owner: np.ndarray, executors: int) -> np.ndarray:
    """The executor that has most of each island, by cost, the lowest of equals; -1 where no executor has any of it."""
    key = isle * (executors + 1) + owner + 1
    sort = np.argsort(key, kind="stable")
    key = key[sort]
    begin = np.flatnonzero(np.concatenate([[True], key[1:] != key[:-1]]))
    share = np.add.reduceat(cost[sort], begin)
    island, owner_from_1 = np.divmod(key[begin], executors + 1)
    share[owner_from_1 == 0] = 0
    most = np.maximum.reduceat(share, np.flatnonzero(np.concatenate([[True], island[1:] != island[:-1]])))
    top = np.flatnonzero(share == most[island])
    return owner_from_1[top][firsts(island[top])] - 1


# --- balance ------------------------------------------------------------------------------------------------


def _place(weight, home, teams, executors, rank, gain) -> tuple[np.ndarray, np.ndarray]:
    """Executors of islands, and all loads, with these teams."""
    place, alone, base = home.copy(), np.ones(len(weight), bool), np.zeros(executors, np.int64)
    for team in teams:
        place[team.island], alone[team.island] = team.members[0], False
        base[list(team.members)] += time_each(int(weight[team.island]), len(team.members), gain)
    largest = max(int(base.max()), int(weight[alone].max(initial=0)))
    rest = np.flatnonzero(alone)
    number = np.cumsum(alone) - 1
    place[rest], load = _balance(weight[rest], home[rest], base, largest, number[rank[alone[rank]]])
    return place, load


def _balance(weight, home, base, largest, rank) -> tuple[np.ndarray, np.ndarray]:
    """Executors of islands, and all loads; ``base`` (K,) is what executors have to do besides, ``rank`` the order of dealing out.

    Repeated while that helps, so that the next frame finds nothing to do: every turn lowers the largest load, or is the last.
    """
    mean = -(-int(weight.sum() + base.sum()) // len(base))
    cap = max(mean, largest) * TENTH[0] // TENTH[1]
    lost = home < 0
    stay = base + total(home[~lost], weight[~lost], len(base))
    if not lost.any() and stay.max() <= cap:
        return home, stay
    kept, load = _unload(weight, home, base, cap, mean, rank)
    if load.max() <= cap:
        return kept, load
    packed, new = _pack(weight, home, base, cap, mean, rank)
    if not lost.any() and stay.max() * TENTH[1] <= min(load.max(), new.max()) * TENTH[0]:
        return home, stay
    better = kept if load.max() * TENTH[1] <= new.max() * TENTH[0] else packed
    return _balance(weight, better, base, largest, rank)


def _unload(weight, home, base, cap, mean, rank) -> tuple[np.ndarray, np.ndarray]:
    """Islands stay at home up to the cap, large ones first; the others are dealt out."""
    place = np.where(_fitting(weight, home, cap - base), home, -1)
    load = base + total(place[place >= 0], weight[place >= 0], len(base))
    return _deal(weight, place, home, load, cap, mean, rank)


def _fitting(weight, home, room) -> np.ndarray:
    """Islands that stay: of each executor's, by size, all that still fit. The room that is left halves with every turn."""
    stay = np.zeros(len(weight), bool)
    sort = np.lexsort((-weight, home))
    bound = np.searchsorted(home[sort], np.arange(len(room) + 1))
    for e, left in enumerate(room):
        mine = sort[bound[e] : bound[e + 1]]
        size = -weight[mine]
        sum_before = np.concatenate([[0], np.cumsum(-size)])
        at = int(np.searchsorted(size, -left))
        while at < len(mine):
            end = int(np.searchsorted(sum_before, sum_before[at] + left, side="right")) - 1
            stay[mine[at:end]] = True
            left -= sum_before[end] - sum_before[at]
            at = max(end, int(np.searchsorted(size, -left)))
    return stay


def _deal(weight, place, home, load, cap, mean, rank) -> tuple[np.ndarray, np.ndarray]:
    """Islands without a place: large ones go to the executor that has least, one by one; others fill all to one level, by runs
    of ``rank``."""
    place, load = place.copy(), load.copy()
    out = place < 0
    large = np.flatnonzero(out & (weight * CRUMB > mean))
    for i in large[np.argsort(-weight[large], kind="stable")]:
        e, h = int(load.argmin()), int(home[i])
        least = load[e] + weight[i]
        if h >= 0 and least > cap and (load[h] + weight[i]) * TENTH[1] <= least * TENTH[0]:
            e = h
        place[i] = e
        load[e] += weight[i]
    small = rank[(place < 0)[rank]]
    if len(small):
        room = np.maximum(_level(load, int(weight[small].sum())) - load, 0)
        start = np.cumsum(weight[small]) - weight[small]
        place[small] = np.searchsorted(np.cumsum(room), start, side="right")
        load += total(place[small], weight[small], len(load))
    return place, load


def _level(load: np.ndarray, amount: int) -> int:
    """The level that ``amount`` poured into the loads comes up to, rounded up."""
    full = np.sort(load)
    level = (np.cumsum(full) + amount + np.arange(len(full))) // np.arange(1, len(full) + 1)
    return int(level.min())


def _pack(weight, home, base, cap, mean, rank) -> tuple[np.ndarray, np.ndarray]:
    """Large islands anew, each to the executor that has least, the largest first; then executors that do nothing else are named
    after the homes of what they have. The other islands as before.
    """
    place, load = np.full(len(weight), -1), base.copy()
    large = np.flatnonzero(weight * CRUMB > mean)
    for i in large[np.argsort(-weight[large], kind="stable")]:
        place[i] = load.argmin()
        load[place[i]] += weight[i]
    idle = np.flatnonzero(base == 0)
    both = large[np.isin(place[large], idle) & np.isin(home[large], idle)]
    common = np.zeros((len(base), len(base)), np.int64)
    np.add.at(common, (place[both], home[both]), weight[both])
    name, taken = np.arange(len(base)), np.zeros(len(base), bool)
    name[idle] = -1
    while common.any():
        group, e = np.unravel_index(common.argmax(), common.shape)
        name[group], taken[e] = e, True
        common[group] = common[:, e] = 0
    name[name < 0] = idle[~taken[idle]]
    place[large], renamed = name[place[large]], np.empty_like(load)
    renamed[name] = load
    small = np.flatnonzero(place < 0)
    place[small] = np.where(_fitting(weight[small], home[small], cap - renamed), home[small], -1)
    load = base + total(place[place >= 0], weight[place >= 0], len(base))
    return _deal(weight, place, home, load, cap, mean, rank)
