# SPDX-License-Identifier: GPL-2.0-only
"""The state of a plan between two steps: positions, velocities, forces, and what fixes keep besides, as records by object.

A record is of one object, of a pair of objects, or of the whole. Its bytes depend neither on how particles are numbered nor on
which other objects there are (plugin/lammps/stateful.h), so records are cut out, sent and joined here without a look inside.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field

import numpy as np

from ..records import dataclass


@dataclass(frozen=True)
class StateRecords:
    """R records of one fix, by ascending keys."""

    keys: np.ndarray
    """Objects from 1 that each is of, int32, shape (R, 2): (a, b) with a < b for a pair, (a, 0) for one object, (0, 0) for the
    whole."""
    first: np.ndarray
    """Where the bytes of each begin, and B at the end, int64, shape (R + 1,)."""
    data: np.ndarray
    """The bytes of all, uint8, shape (B,)."""

    def __len__(self) -> int:
        return len(self.keys)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, StateRecords) and all(
            np.array_equal(getattr(self, name), getattr(other, name)) for name in ("keys", "first", "data")
        )

    def where(self, chosen: np.ndarray) -> StateRecords:
        """Records for which ``chosen`` is true, bool, shape (R,)."""
        return self if chosen.all() else self._ordered(self.keys, np.flatnonzero(chosen))

    def of(self, inside: np.ndarray) -> np.ndarray:
        """Which records are of such objects alone, bool, shape (R,). ``inside`` says of every object whether it is one, and last
        whether the whole is; bool, shape (M + 1,)."""
        of_object = np.concatenate([[True], inside[:-1]])
        return np.where(self.keys.any(axis=1), of_object[self.keys].all(axis=1), inside[-1])

    def home(self, still: np.ndarray) -> np.ndarray:
        """Object, from 0, with which each record travels: the lower one of those that can move; M for that of the whole; int64,
        shape (R,). ``still`` says which of all M objects cannot move."""
        a, b = self.keys.T.astype(np.int64) - 1
        return np.where(a < 0, len(still), np.where((b >= 0) & np.append(still, False)[a], b, a))

    def take(self, objects: Sequence[int], whole: bool) -> StateRecords:
        """Records of a part that has these objects of M, from 0 and ascending, numbered as in the part; and that of the whole
        if ``whole``."""
        objects = np.asarray(objects, np.int64)
        most = int(max(self.keys.max(initial=0), objects.max(initial=-1) + 1))
        number = np.zeros(most + 1, np.int32)
        number[objects + 1] = np.arange(1, len(objects) + 1)
        found = self.where(self.of(np.append(number[1:] > 0, whole)))
        return StateRecords(number[found.keys], found.first, found.data)

    def renumbered(self, objects: Sequence[int]) -> StateRecords:
        """The reverse of `take`: records of a part with the numbers of the whole."""
        return StateRecords(np.append(0, np.asarray(objects, np.int64) + 1).astype(np.int32)[self.keys], self.first, self.data)

    def _ordered(self, keys: np.ndarray, order: np.ndarray) -> StateRecords:
        size = np.diff(self.first)[order]
        first = np.append(0, np.cumsum(size))
        byte = np.repeat(self.first[:-1][order] - first[:-1], size) + np.arange(first[-1])
        return StateRecords(keys[order], first, self.data[byte])


NO_RECORDS = StateRecords(np.zeros((0, 2), np.int32), np.zeros(1, np.int64), np.zeros(0, np.uint8))

Records = Mapping[str, StateRecords]
"""Records of all fixes that keep any, by the ID of the fix."""


@dataclass(frozen=True)
class State:
    """All that the later steps of an instance depend on, but for the number of the step."""

    x: np.ndarray
    """Positions in tag order [m], shape (N, 3)."""
    v: np.ndarray
    """Velocities [m/s], shape (N, 3)."""
    f: np.ndarray
    """Forces [N], shape (N, 3): dashpots see half-step velocities, which x and v do not hold."""
    records: Records = field(default_factory=dict)
    """Further values that fixes keep; a fix that is absent begins anew."""


def join(pieces: Iterable[StateRecords]) -> StateRecords:
    """All records of some, by ascending keys. Raises ValueError when two are of the same objects."""
    pieces = [piece for piece in pieces if len(piece)]
    if len(pieces) < 2:
        return pieces[0] if pieces else NO_RECORDS
    keys = np.concatenate([piece.keys for piece in pieces])
    ends = np.cumsum([len(piece.data) for piece in pieces])
    first = np.concatenate([[0], *(piece.first[1:] + end - len(piece.data) for piece, end in zip(pieces, ends))])
    order = np.lexsort((keys[:, 1], keys[:, 0]))
    joined = StateRecords(keys, first, np.concatenate([piece.data for piece in pieces]))._ordered(keys, order)
    twice = (np.diff(joined.keys, axis=0) == 0).all(axis=1)
    if twice.any():
        raise ValueError(f"two records of the objects {tuple(joined.keys[twice.argmax()].tolist())}")
    return joined


def join_all(pieces: Iterable[Records]) -> dict[str, StateRecords]:
    """`join` for every fix."""
    pieces = list(pieces)
    return {
        fix: join(piece[fix] for piece in pieces if fix in piece) for fix in sorted({fix for piece in pieces for fix in piece})
    }
