# SPDX-License-Identifier: GPL-2.0-only
"""Records of fixes: cut out, numbered anew, joined, against a dictionary that does the same one by one."""

import numpy as np
import pytest
from mdanim_lammps.engine.state import NO_RECORDS, StateRecords, join, join_all


def records(content: dict[tuple[int, int], bytes]) -> StateRecords:
    """Records from a dictionary, in any order."""
    keys = sorted(content)
    first = np.cumsum([0, *(len(content[key]) for key in keys)])
    data = np.frombuffer(b"".join(content[key] for key in keys), np.uint8)
    return StateRecords(np.array(keys, np.int32).reshape(-1, 2), first.astype(np.int64), data)


def content(found: StateRecords) -> dict[tuple[int, int], bytes]:
    """The same, back."""
    assert (found.keys.dtype, found.first.dtype, found.data.dtype) == (np.int32, np.int64, np.uint8)
    bounds = zip(found.first[:-1], found.first[1:])
    return {tuple(key): found.data[a:b].tobytes() for key, (a, b) in zip(found.keys.tolist(), bounds)}


def random_content(seed: int, objects: int = 7) -> dict[tuple[int, int], bytes]:
    rng = np.random.default_rng(seed)
    every = [(0, 0), *((a, b) for a in range(1, objects + 1) for b in (0, *range(a + 1, objects + 1)))]
    return {key: rng.bytes(int(rng.integers(0, 9))) for key in every if rng.random() < 0.5}


@pytest.mark.parametrize("seed", range(20))
def test_a_part_has_the_records_of_its_objects(seed):
    """Records of which all objects are in it, under the numbers of the part; and back."""
    rng, whole = np.random.default_rng(seed), random_content(seed)
    objects = np.flatnonzero(rng.random(7) < 0.6)
    number = {0: 0} | {int(m) + 1: k + 1 for k, m in enumerate(objects)}
    for with_whole in (False, True):
        mine = {k: d for k, d in whole.items() if set(k) <= set(number) and (k != (0, 0) or with_whole)}
        part = records(whole).take(objects, with_whole)
        assert content(part) == {(number[a], number[b]): d for (a, b), d in mine.items()}
        assert content(part.renumbered(objects)) == mine


@pytest.mark.parametrize("seed", range(20))
def test_pieces_are_joined_in_order(seed):
    """Dealt out at random and joined, records are what they were."""
    rng, whole = np.random.default_rng(seed), random_content(seed)
    pieces = [{}, {}, {}]
    for key, data in whole.items():
        pieces[rng.integers(3)][key] = data
    assert join(map(records, pieces)) == records(whole)
    assert content(join(map(records, pieces))) == whole


def test_no_two_records_of_the_same():
    """A record is at one place only; two are told with their objects."""
    with pytest.raises(ValueError, match=r"two records of the objects \(1, 2\)"):
        join([records({(1, 2): b"a", (3, 0): b"b"}), records({(1, 2): b"a"})])


def test_equality_sees_every_array():
    """Keys, lengths and bytes."""
    one = records({(1, 0): b"ab", (1, 2): b"c"})
    assert one == records({(1, 0): b"ab", (1, 2): b"c"}) and len(one) == 2
    for other in ({(2, 0): b"ab", (2, 3): b"c"}, {(1, 0): b"a", (1, 2): b"bc"}, {(1, 0): b"ab", (1, 2): b"d"}):
        assert one != records(other)
    assert join([]) == NO_RECORDS and one != NO_RECORDS


def test_fixes_are_joined_apart():
    """Each by its ID, in the order of IDs."""
    a, b = records({(1, 0): b"a"}), records({(2, 0): b"b"})
    found = join_all([{"rub": a, "heat": b}, {"rub": b}, {}])
    assert list(found) == ["heat", "rub"] and found["rub"] == join([a, b]) and found["heat"] == b


def test_without_objects_records_are_those_of_the_whole():
    """The place of the only record of a liquid alone."""
    assert records({(0, 0): b"all"}).home(np.zeros(0, bool)).tolist() == [0]
