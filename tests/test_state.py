# SPDX-License-Identifier: GPL-2.0-only
"""The state of fixes as records: what C functions give and take, and what they refuse."""

import ctypes

import numpy as np
import plugin_lab as lab
import pytest
import state_lab
from mdanim_lammps.engine.plugin import folder
from state_lab import Records

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
    """Of the whole, (0, 0), and taken up again to the byte."""
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
        ([(0, 1)], r"fix water: \(0, 1\) are no two objects"),
        ([(2, 1)], r"\(2, 1\) are no two objects"),
        ([(1, 1)], r"\(1, 1\) are no two objects"),
        ([(-1, 0)], r"\(-1, 0\) are no two objects"),
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
