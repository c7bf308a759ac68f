# SPDX-License-Identifier: GPL-2.0-only
"""Columns of particles, springs and objects as properties of LAMMPS's particles, and as records."""

from types import SimpleNamespace

import numpy as np
import pytest
from mdanim_lammps.effects.fields import Field, column
from mdanim_lammps.engine.columns import (
    from_records,
    gathered,
    most_bonds,
    places,
    property_of,
    spread,
    to_records,
    values_of_pairs,
    wide_columns,
)
from mdanim_lammps.engine.plan import Plan
from mdanim_lammps.engine.state import StateRecords, join
from mdanim_lammps.errors import SetupError

FIRST = np.array([0, 3, 5, 9])
BONDS = np.array([(0, 1), (0, 2), (1, 2), (3, 4), (5, 6), (5, 8), (6, 7), (6, 8)], np.int32)
COLUMNS = (
    column("mark", "1"),
    column("way", "m", shape=(2,), state=True),
    column("load", "N", "object", state=True),
    column("most", "m", "bond", state=True, default=-1.0),
    column("hits", "1", "bond", dtype="int32", shape=(2,), state=True),
    column("cell", "1", dtype="int32", shape=(3,), tags=3),
)


def plan():
    """Three objects, the second of which never moves, with all these columns."""
    system = SimpleNamespace(first=FIRST, particles=9, names="abc", object=np.repeat([0, 1, 2], np.diff(FIRST)))
    system.still = np.array([False, True, False])
    count = {"particle": 9, "object": 3, "bond": len(BONDS)}
    columns = {
        f.name: np.arange(10 * k, 10 * k + count[f.per] * int(np.prod(f.shape, dtype=int))).astype(f.dtype).reshape(-1, *f.shape)
        for k, f in enumerate(COLUMNS)
    }
    found = SimpleNamespace(system=system, bonds=BONDS, columns=columns, fields={f.name: f for f in COLUMNS})
    found.slots, found.places = most_bonds(BONDS), places(BONDS, 9)
    found.rows = lambda per: Plan.rows(found, per)
    return found


def test_properties_have_the_names_that_fixes_look_up():
    """One number, a table, and room for all springs of a particle."""
    words = [property_of(f, 4).word for f in COLUMNS]
    assert words == ["d_mark", "d2_way 2", "d_load", "d2_most 4", "i2_hits 8", "i2_cell 3"]
    assert property_of(column("n", "1", dtype="int32"), 4).word == "i_n"
    assert wide_columns(plan()) == ["way", "most"]


def test_a_spring_has_its_place_in_the_rows_of_both_ends():
    """The place of the partner among all partners, ascending."""
    partners = {i: sorted({int(b) for pair in BONDS for b in pair if i in pair} - {i}) for i in range(9)}
    low, high = places(BONDS, 9)
    assert low.tolist() == [partners[i].index(j) for i, j in BONDS.tolist()]
    assert high.tolist() == [partners[j].index(i) for i, j in BONDS.tolist()]
    assert most_bonds(BONDS) == max(map(len, partners.values())) and most_bonds(BONDS[:0]) == 0
    assert [len(p) for p in places(BONDS[:0], 9)] == [0, 0]


@pytest.mark.parametrize("name", [f.name for f in COLUMNS])
def test_values_come_back_from_properties(name):
    """Also other values than those at the start; rows of springs that a particle does not have hold the default."""
    made = plan()
    for values in (None, made.columns[name] + 5):
        rows = spread(made, name, values)
        assert rows.shape == ((9, width) if (width := property_of(made.fields[name], made.slots).width) else (9,))
        expected = made.columns[name] if values is None else values
        assert np.array_equal(gathered(made, name, rows), expected) and rows.dtype == expected.dtype
    if name == "most":
        assert (spread(made, name) == -1.0).sum() == 9 * made.slots - 2 * len(BONDS)
        assert spread(made, name)[2, :2].tolist() == made.columns[name][[1, 2]].tolist()


def test_states_are_records_of_objects():
    """Columns of objects that never move stay as at the start; a part knows its own, whatever the numbers of objects are."""
    made, names = plan(), ("way", "load", "most", "hits")
    now = {name: made.columns[name] + 7 for name in names}
    records = to_records(made, now)
    for name in names:
        found, record = from_records(made, name, records), records[f"column {name}"]
        still = slice(*made.rows(made.fields[name].per)[1:3])
        assert np.array_equal(found[still], made.columns[name][still]) and (record.keys == [(1, 0), (3, 0)]).all()
        moving = np.delete(np.arange(len(found)), np.arange(len(found))[still])
        assert np.array_equal(found[moving], now[name][moving])
        third = record.take([2], False)
        assert third.keys.tolist() == [[1, 0]] and join([record.take([0], False), third.renumbered([2])]) == record
    assert np.array_equal(from_records(made, "way", {}), made.columns["way"])


def test_records_of_another_size_are_refused():
    """A damaged checkpoint must not write beyond an object."""
    made = plan()
    wrong = StateRecords(np.array([[1, 0]], np.int32), np.array([0, 16]), np.zeros(16, np.uint8))
    with pytest.raises(SetupError, match="column most of object 1 has 16 bytes, not 24"):
        from_records(made, "most", {"column most": wrong})
    pair = StateRecords(np.array([[1, 2]], np.int32), np.array([0, 24]), np.zeros(24, np.uint8))
    with pytest.raises(SetupError, match="something else than taut"):
        values_of_pairs(pair, Field("taut", "1", per="pair"))


def test_values_of_pairs_are_read_from_records():
    """Behind the version; records of one object are others."""
    keys = np.array([[1, 0], [1, 3], [2, 3]], np.int32)
    data = b"".join([b"12345", *(np.int64(1).tobytes() + np.array([v, -v]).tobytes() for v in (0.5, 2.5))])
    records = StateRecords(keys, np.array([0, 5, 29, 53]), np.frombuffer(data, np.uint8))
    found = values_of_pairs(records, Field("slid", "m", per="pair", shape=(2,)))
    assert found["a"].tolist() == [0, 1] and found["b"].tolist() == [2, 2]
    assert found["value"].tolist() == [[0.5, -0.5], [2.5, -2.5]]
