# SPDX-License-Identifier: GPL-2.0-only
"""Which objects a name stands for, and the pairs of two such names."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence

PIECE = ".piece["
"""Between the name of an object with pieces and the number of one."""


def objects_by_name(names: Iterable[str]) -> dict[str, list[int]]:
    """Objects, from 0 and ascending, that a name stands for: one by its own name, all of a repeat by the name without index, a
    row of two nested repeats by the first index alone (``brick[3]`` of ``brick[3][4]``), all of a group by its name. Without any
    index it stands for those of all places of the group: ``cart.wheel``.

    Some of the objects of a scene give the same as all of them; so a name that is both has all of these objects.
    """
    found: dict[str, list[int]] = {}
    for number, name in enumerate(names):
        for other in _names_of(name):
            found.setdefault(other, []).append(number)
    return found


def _names_of(name: str) -> Iterator[str]:
    """Its own name, and names of several objects that it is one of, each once."""
    yield name
    if "[" not in name and "." not in name:
        return
    parts, told = name.split("."), {name}
    for n in range(1, len(parts) + 1):
        wholes = [".".join(parts[:n])]
        while wholes[-1].endswith("]"):
            wholes.append(wholes[-1].rpartition("[")[0])
        for other in (*wholes, bare_name(wholes[0])):
            if other not in told:
                told.add(other)
                yield other


def pairs_of(first: Sequence[int], second: Sequence[int]) -> Iterator[tuple[int, int]]:
    """Pairs (i, j), i < j, of an object of one set and another object of the other, each once."""
    both = set(first) & set(second)
    for i in first:
        for j in second:
            if i < j or (j < i and not (i in both and j in both)):
                yield min(i, j), max(i, j)


def labelled(numbers: Iterable[int], names: Sequence[str]) -> list[list[int]]:
    """Objects that have words together: the pieces of one object, any other alone."""
    found: dict[str, list[int]] = {}
    for number in numbers:
        whole, piece, _ = names[number].rpartition(PIECE)
        found.setdefault(whole if piece else names[number], []).append(number)
    return list(found.values())


def bare_name(name: str) -> str:
    """A name without indices: ``cart.wheel`` of ``cart[2].wheel[1]``."""
    return ".".join(part.partition("[")[0] for part in name.split("."))


def told_together(names: Sequence[str]) -> str:
    """Objects in a message: ``ball``, ``domino[1...9]`` of a repeat without gaps, ``gate.post (12 objects)`` of one name, else
    ``ball and 3 more``."""
    if len(names) == 1:
        return names[0]
    bare = bare_name(names[0])
    if any(bare_name(name) != bare for name in names):
        return f"{names[0]} and {len(names) - 1} more"
    found = [re.fullmatch(r"(.*)\[(-?\d+)\]", name) for name in names]
    numbers = [int(one[2]) for one in found if one and one[1] == bare]
    if len(numbers) == len(names) and numbers == list(range(numbers[0], numbers[-1] + 1)):
        return f"{bare}[{numbers[0]}...{numbers[-1]}]"
    return f"{bare} ({len(names)} objects)"
