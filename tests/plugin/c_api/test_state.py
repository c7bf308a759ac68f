# SPDX-License-Identifier: GPL-2.0-only
"""The state of fixes as records: what C functions give and take, and what they refuse."""

import ctypes

import numpy as np
import plugin_lab as lab
import plugin_library
import plugin_path
import pytest
import state_lab
from mdanim_lammps.engine.plugin import folder
from mpi.remember import FIRST, MEMORY, PAIR, THEN, load, remember
from paths import MPI
from ranks_lab import on_ranks
from state_lab import Records

REMEMBER = MPI / "remember.py"

POOL = ["region basin block -4 4 -4 4 0 8", "fix water all mdanim/liquid basin 1.0 grid 8 8 8 level 5 gravity 0.01"]


@pytest.fixture
def pool(tmp_path):
    """An instance with a liquid, and a fix that has no state."""
    lmp = lab.load(lab.particles([[0.3, -0.2, 5.0]]), tmp_path, [*POOL, "fix move all mdanim/leapfrog", "run 0"])
    yield lmp
    lmp.close()


def records(*pairs) -> Records:
    """Records from (key, bytes) in this order."""
    first = np.concatenate([[0], np.cumsum([len(data) for _, data in pairs])]).astype(np.int64)
    data = np.frombuffer(b"".join(bytes(data) for _, data in pairs), np.uint8)
    return Records(np.array([key for key, _ in pairs], np.int32).reshape(-1, 2), first, data)


def test_stateful_fixes_are_listed(pool):
    """The liquid has a state of its own, the leap-frog has none."""
    assert state_lab.stateful(pool) == ["water"]
    pool.command("unfix water")
    assert state_lab.stateful(pool) == []


def test_the_liquid_is_one_record(pool):
    """The record of the whole, (0, 0), is taken up again to the byte."""
    state = state_lab.pack(pool, "water")
    assert state.key.tolist() == [[0, 0]]
    assert state.first.tolist() == [0, len(state.data)] and len(state.data) > 8**3
    pool.command("run 20")
    other = state.data.copy()
    other[40] ^= 1  # sweeps so far
    state_lab.put(pool, "water", records(((0, 0), other)))
    assert np.array_equal(state_lab.pack(pool, "water").data, other)


def test_what_was_packed_is_given_once(pool):
    """A second get without a pack has nothing to give, and says what is to be called."""
    state_lab.pack(pool, "water")
    error = ctypes.create_string_buffer(200)
    handle = ctypes.c_void_p(ctypes.cast(pool.lmp, ctypes.c_void_p).value)
    assert ctypes.CDLL(f"{folder()}/mdanimplugin.so").mdanim_state_get(handle, b"water", None, None, None, error, 200) == 1
    assert error.value == b"call mdanim_state_pack before, for fix water"


@pytest.mark.parametrize(
    ("fix", "message"), [("nothing", "there is no fix nothing"), ("move", "fix move mdanim/leapfrog has no state of its own")]
)
def test_fixes_without_a_state_are_refused(pool, fix, message):
    """Each with its own message."""
    with pytest.raises(RuntimeError, match=message):
        state_lab.pack(pool, fix)
    with pytest.raises(RuntimeError, match=message):
        state_lab.put(pool, fix, records(((0, 0), b"12345678")))


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ([(0, 1)], r"fix water: \(0, 1\) are not two objects"),
        ([(2, 1)], r"\(2, 1\) are not two objects"),
        ([(1, 1)], r"\(1, 1\) are not two objects"),
        ([(-1, 0)], r"\(-1, 0\) are not two objects"),
        ([(1, 2), (1, 0)], r"\(1, 0\) comes after \(1, 2\)"),
        ([(1, 0), (1, 0)], r"\(1, 0\) comes after \(1, 0\)"),
        ([], r"one record \(0, 0\), there are 0"),
        ([(1, 0)], r"one record \(0, 0\)"),
        ([(0, 0)], "has 8 bytes, that is too few"),
    ],
)
def test_wrong_records_are_refused(pool, keys, message):
    """Keys that are none, are not sorted or come twice, and records that are not the liquid's; nothing changes."""
    before = state_lab.pack(pool, "water")
    with pytest.raises(RuntimeError, match=message):
        state_lab.put(pool, "water", records(*((key, b"12345678") for key in keys)))
    assert state_lab.pack(pool, "water").same(before)


def test_records_that_overlap_are_refused(pool):
    """First bytes must ascend from 0."""
    state = state_lab.pack(pool, "water")
    for first in ([8, len(state.data)], [0, -1]):
        with pytest.raises(RuntimeError, match="begin"):
            state_lab.put(pool, "water", state._replace(first=np.array(first, np.int64)))


# --- a history of particles and of pairs of objects ---


def records_of(found: dict, name: str) -> Records:
    """Records of one moment of `remember`."""
    return Records(*(found[f"{name} {field}"] for field in Records._fields))


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """Records that `remember` finds on one rank."""
    folder = tmp_path_factory.mktemp("alone")
    return remember(folder) | {"folder": folder}


def ways(record: np.ndarray) -> np.ndarray:
    """The ways in the record of an object, in the order of its tags, shape (n, 3)."""
    rows = record[8:].view([("tag", "i4"), ("way", "f8", 3)])
    assert record[:8].view(np.int64) == 1 and rows["tag"].tolist() == list(range(len(rows)))
    return rows["way"]


def test_records_tell_what_was(alone):
    """Ways are sums of the particles' steps; steps near each other count from when boxes came as near as the reach."""
    state = records_of(alone, "state")
    assert state.key.tolist() == [[1, 0], [1, 2], [2, 0]]
    whole = load(PAIR, alone["folder"])
    whole.command(f"run {FIRST}")
    moved = lab.by_tag(whole, "x") - PAIR.x
    whole.close()
    assert np.concatenate([ways(state.record(1)), ways(state.record(2))]) == pytest.approx(moved, abs=1e-13)
    steps, more = (records_of(alone, name).record(1, 2).view(np.int64)[1] for name in ("state", "end"))
    assert 0 < steps < FIRST and more == steps + THEN


def test_a_history_is_taken_up(alone):
    """Another instance goes on to the bit, in positions and in records."""
    assert records_of(alone, "taken").same(records_of(alone, "state"))
    assert np.array_equal(alone["other x"], alone["x"])
    assert records_of(alone, "again").same(records_of(alone, "end"))


@pytest.mark.parametrize("lost", [(1, 0), (1, 2), (2, 0)])
def test_a_lost_record_changes_bits(alone, tmp_path, lost):
    """Without the record of an object, or of the pair, it goes on in another way."""
    x = []
    for state in (records_of(alone, "state"), records_of(alone, "state").without(*lost)):
        lmp = load(PAIR, tmp_path)
        state_lab.put(lmp, "memory", state)
        lmp.command("run 2")
        x.append(lab.by_tag(lmp, "x"))
        lmp.close()
    assert (x[0] != x[1]).any()


def test_records_do_not_depend_on_numbers_or_on_other_objects(alone, tmp_path):
    """With another object before them the two have other tags and IDs; their records keep their bytes, and can be taken up
    under these numbers."""
    between = lab.join(lab.block((2, 2, 2), (0.0, 40.0, 0.0)), PAIR)
    lmp = load(between, tmp_path)
    lmp.command(f"run {FIRST}")
    state, found = records_of(alone, "state"), state_lab.pack(lmp, "memory")
    lmp.close()
    assert found.key.tolist() == [[1, 0], [2, 0], [2, 3], [3, 0]]
    for a, b in state.key.tolist():
        assert np.array_equal(found.record(a + 1, b and b + 1), state.record(a, b))
    pair = load(PAIR, tmp_path)
    rest = found.without(1)
    state_lab.put(pair, "memory", rest._replace(key=rest.key - (rest.key > 0)))
    assert state_lab.pack(pair, "memory").same(state)
    pair.close()


def test_a_history_is_in_restart_files(alone, tmp_path):
    """LAMMPS's own restart goes on to the bit."""
    first = load(PAIR, tmp_path)
    first.command(f"run {FIRST}")
    first.command(f"write_restart {tmp_path}/half.restart")
    first.close()
    second = plugin_path.lammps()
    for command in (
        f"plugin load {plugin_library.build()}",
        "atom_modify map array sort 0 0",
        "newton off",
        f"read_restart {tmp_path}/half.restart",
        "fix model all property/atom rmass ghost yes",
        "fix move all mdanim/leapfrog",
        MEMORY,
        "timestep 0.1",
        "neighbor 0.4 bin",
        "neigh_modify every 1 delay 0",
        "comm_modify cutoff 3.0",
        "pair_style none",
    ):
        second.command(command)
    assert state_lab.pack(second, "memory").same(records_of(alone, "state"))
    second.command(f"run {THEN}")
    assert np.array_equal(lab.by_tag(second, "x"), alone["x"])
    second.close()


@pytest.mark.mpi
@pytest.mark.parametrize("ranks", [2, 3, 4])
def test_ranks_have_the_same_records(alone, tmp_path, ranks):
    """Records, what becomes of them, and positions: the bytes of one rank."""
    on_ranks(REMEMBER, ranks, tmp_path, tmp_path / "found.npz")
    found = np.load(tmp_path / "found.npz")
    assert all(np.array_equal(found[name], alone[name]) for name in alone if name != "folder")


def changed(state: Records, a: int, at: int, number: int) -> Records:
    """The same records but for an int32 of one."""
    data = state.data.copy()
    state._replace(data=data).record(a)[at : at + 4].view(np.int32)[:] = number
    return state._replace(data=data)


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda s: s._replace(key=s.key + (s.key > 0)), "there is no object 3"),
        (lambda s: s._replace(key=np.array([[0, 0], [1, 2], [2, 0]])), "a record of the whole"),
        (lambda s: s._replace(first=s.first - np.array([0, 0, 0, 1])), "the record of object 2 has 1351 bytes, not 8 and"),
        (lambda s: changed(s, 2, 0, 7), "the record of object 2 has version 7, 1 is needed"),
        (lambda s: changed(s, 1, 8, 5000), "of 108 particles in the state 107 are there"),
        (lambda s: changed(s, 1, 8, 60), "of 108 particles in the state 107 are there"),
    ],
    ids=["object", "whole", "size", "version", "no particle", "particle of another"],
)
def test_records_of_something_else_are_refused(alone, tmp_path, spoil, message):
    """Each with its own message, and nothing changes."""
    lmp = load(PAIR, tmp_path)
    before = state_lab.pack(lmp, "memory")
    with pytest.raises(RuntimeError, match=f"fix memory: {message}"):
        state_lab.put(lmp, "memory", spoil(records_of(alone, "state")))
    assert state_lab.pack(lmp, "memory").same(before)
    lmp.close()
