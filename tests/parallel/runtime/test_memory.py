# SPDX-License-Identifier: GPL-2.0-only
"""The state of any fix goes where its objects go: forces with a history give the same bits in all forms of the distribution."""

import numpy as np
import plugin_library
import pytest
from distribution_lab import SEQUENTIAL, WINDOWS, matrix, ways
from mdanim_lammps.results.checkpoint import Checkpoint
from mdanim_lammps.results.compare import compare
from mpi import scenes as films

pytestmark = pytest.mark.mpi


@pytest.fixture(scope="module", autouse=True)
def library():
    """Compile once, before several ranks would."""
    plugin_library.build()


def film(scene, text, cases, **more):
    """The folder of each way, with the effect."""
    return ways(scene(text), cases, features="remembers", **more)


def records(folder) -> dict[tuple[int, int], bytes]:
    """Records of the fix at a checkpoint, by objects."""
    found = Checkpoint.read(folder / "checkpoint").records["memory"]
    return {
        tuple(key): found.data[a:b].tobytes() for key, (a, b) in zip(found.keys.tolist(), zip(found.first[:-1], found.first[1:]))
    }


AGAIN, TEAMS = WINDOWS | {"safety": 0.3}, {"least": 50}
FORMS = {
    "flying": (
        films.FLYING,
        matrix((3,), ["central"], "again ", settings=AGAIN)
        | matrix((3,), ["peers"], "all move ", rotate=True)
        | matrix((2,), ["peers"], "teams ", settings=TEAMS),
    ),
    "flying, long": (
        films.FLYING,
        matrix((1, 2, 3))
        | matrix((3,), name="again ", settings=AGAIN)
        | matrix((3,), name="all move ", rotate=True)
        | matrix((2,), name="teams ", settings=TEAMS),
    ),
    "bounce": (films.BOUNCE, matrix((2,), name="teams ", settings=AGAIN | TEAMS)),
    "mixed": (films.MIXED, matrix((3,), ["central"]) | matrix((2,), ["peers"], "all move ", rotate=True)),
    "mixed, long": (films.MIXED, matrix((2, 3)) | matrix((2,), name="all move ", rotate=True)),
    "rafts": (films.RAFTS, matrix((3,)) | matrix((2,), ["peers"], "all move ", rotate=True)),
}


@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.soak] * n.endswith("long")) for n in FORMS])
def test_a_history_is_the_same_in_all_forms(scene, name):
    """Frames and records of one process, and those of executors: migration, windows begun again, teams."""
    text, cases = FORMS[name]
    found = film(scene, text, cases, timeout=200.0)
    alone = records(found["sequential"])
    assert any(a and b for a, b in alone) or name in ("bounce", "rafts"), "no two objects are near each other at the end"
    for way in cases:
        assert compare(found["sequential"], found[way]).equal, way
        assert records(found[way]) == alone, way


def test_a_history_goes_on_with_other_executors(scene):
    """Stop while objects touch, go on with more executors, with none, in a team."""
    cases = {
        "a": {"executors": 3, "control": "central", "stop": 8},
        "a more": {"executors": 4, "control": "peers", "resume": True, "in": "a"},
        "b": SEQUENTIAL | {"stop": 8},
        "b spread": {"executors": 2, "control": "peers", "resume": True, "in": "b", "stop": 13},
        "b alone": SEQUENTIAL | {"resume": True, "in": "b"},
        "c": {"executors": 2, "control": "central", "stop": 8, "settings": {"least": 50}},
        "c alone": SEQUENTIAL | {"resume": True, "in": "c"},
    }
    found = film(scene, films.FLYING, cases, timeout=200.0)
    for way in ("a", "b", "c"):
        assert compare(found["sequential"], found[way]).equal, way
        assert records(found[way]) == records(found["sequential"]), way


@pytest.mark.parametrize("forget", ["all", "pairs"])
def test_a_history_that_is_lost_is_seen(scene, forget):
    """Where instances begin without records, or without those of pairs, frames differ: the tests above can fail."""
    cases = matrix((3,), ["central"], rotate=True, forget=forget)
    found = film(scene, films.FLYING, cases)
    assert not compare(found["sequential"], found["central3"]).equal


def test_two_objects_that_part_lose_their_record(scene):
    """The record of two objects ends when they are out of reach, and with it what would have to travel."""
    found = film(scene, films.BOUNCE, {"met": SEQUENTIAL | {"stop": 6}})
    assert (1, 2) in records(found["met"]) and (1, 2) not in records(found["sequential"])
    ways_gone = [
        np.frombuffer(data[8:], [("tag", "i4"), ("way", "f8", 3)])["way"]
        for data in records(found["met"]).values()
        if len(data) > 16
    ]
    assert len(ways_gone) == 2 and all(np.abs(way).max() > 0.0 for way in ways_gone)
