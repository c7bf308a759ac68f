# SPDX-License-Identifier: GPL-2.0-only
"""Records of every kind, as an earlier program wrote them: they are taken up and written again byte for byte."""

import sys
from pathlib import Path

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.engine.state import State, StateRecords

sys.path.insert(0, str(Path(__file__).parent))
from make_states import FILE, SCENES, plan_of

STORED = dict(np.load(FILE))
RECORDS = {
    name: {
        key.split()[1]: StateRecords(*(STORED[f"{name} {key.split()[1]} {what}"] for what in ("keys", "first", "data")))
        for key in STORED
        if key.startswith(f"{name} ") and key.endswith(" data")
    }
    for name in SCENES
}


@pytest.mark.parametrize("name", SCENES)
def test_stored_records_are_written_again_byte_for_byte(name):
    """Contacts of pairs and at planes, the liquid's of every model with drops and makers, and rows of particles in waves."""
    with Instance(plan_of(name)) as instance:
        instance.put(int(STORED[f"{name} step"]), State(*(STORED[f"{name} {what}"] for what in "xvf"), RECORDS[name]))
        written = instance.records()
    assert written.keys() == RECORDS[name].keys()
    assert not [fix for fix in written if written[fix] != RECORDS[name][fix]]


def test_the_stored_states_hold_every_kind():
    """Pairs, planes, a liquid, particles in waves; drops and makers are in that of waves."""
    assert {np.count_nonzero(key) for fix in RECORDS["waves"].values() for key in fix.keys} == {0, 1, 2}
    assert all(RECORDS[name]["contact"].data.size > 1000 for name in SCENES if name != "drops")
    assert len(RECORDS["waves"]["liquid"]) > 1 and len(RECORDS["surface"]["liquid"]) == 1


def cut_short(records: StateRecords, n: int, size: int) -> StateRecords:
    """The n-th record ends after so many bytes."""
    first, end = records.first[n], records.first[n + 1]
    data = np.concatenate([records.data[: first + size], records.data[end:]])
    return StateRecords(
        records.keys, np.concatenate([records.first[: n + 1], records.first[n + 1 :] - (end - first - size)]), data
    )


@pytest.mark.parametrize(("name", "fix"), [("waves", "contact"), ("waves", "liquid"), ("surface", "liquid"), ("waves", "basin")])
def test_a_record_that_is_cut_short_or_too_long_is_refused(name, fix):
    """At many places; a record with bytes behind its end; nothing changes."""
    whole = RECORDS[name][fix]
    with Instance(plan_of(name)) as instance:
        state = State(*(STORED[f"{name} {what}"] for what in "xvf"), RECORDS[name])
        instance.put(int(STORED[f"{name} step"]), state)
        before = instance.records()
        size = int(whole.first[1])
        longer = StateRecords(
            whole.keys, whole.first + np.append(0, np.full(len(whole), 8)), np.insert(whole.data, size, np.zeros(8, np.uint8))
        )
        for wrong in (*(cut_short(whole, 0, n) for n in {0, 4, 8, 12, 40, size // 2, size - 1}), longer):
            with pytest.raises(Exception, match=r"cut off|too long|bytes|damaged|version"):
                instance._put_records({**RECORDS[name], fix: wrong})
        assert instance.records() == before
