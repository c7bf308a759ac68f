# SPDX-License-Identifier: GPL-2.0-only
"""Which objects the names of a contact block stand for."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

PLANES = ("ground", "walls", "basin")
"""Words of a contact block that are no objects."""


def objects_by_name(names: Iterable[str]) -> dict[str, list[int]]:
    """Objects, from 0 and ascending, that a name stands for: one by its own name, all of a repeat by the name without index."""
    alone: dict[str, list[int]] = {}
    repeated: dict[str, list[int]] = {}
    for number, name in enumerate(names):
        alone[name] = [number]
        base, indexed, _ = name.partition("[")
        if indexed:
            repeated.setdefault(base, []).append(number)
    return repeated | alone


def pairs_of(first: Sequence[int], second: Sequence[int]) -> Iterator[tuple[int, int]]:
    """Pairs (i, j), i < j, of an object of one set and another object of the other, each once."""
    both = set(first) & set(second)
    for i in first:
        for j in second:
            if i < j or (j < i and not (i in both and j in both)):
                yield min(i, j), max(i, j)
