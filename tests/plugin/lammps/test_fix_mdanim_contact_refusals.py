# SPDX-License-Identifier: GPL-2.0-only
"""fix mdanim/contact refuses records and bodies that do not fit, with a message, and nothing has changed."""

import contact_lab
import numpy as np
import plugin_lab as lab
import pytest
import state_lab
from contact_lab import FIELD, PILE, PLANE, Cuboid, State, load, pile
from state_lab import Records

NUMBERS = ("X", "change", "anchor", "offset", "depth", "pull", "stick", "stick_energy", "force", "moved", "energy")
CUBE = Cuboid((2, 2, 2)).arrays


@pytest.fixture(scope="module")
def touching(tmp_path_factory):
    """A pile in the middle of its blows, and its state there."""
    lmp = load(pile(1), tmp_path_factory.mktemp("pile"), **PILE)
    lmp.command("run 130 pre no post no")
    yield lmp, State.of(lmp)
    lmp.close()


def one(records: Records, pair: bool) -> int:
    """The first record of a pair, or of an object and planes, whose first rows are not none."""
    for n, (_, b) in enumerate(records.key.tolist()):
        if (b > 0) == pair and (not pair or records.data[records.first[n] + 8 : records.first[n] + 16].view("i8")[0] > 1):
            return n
    raise AssertionError("no such record")


def changed(records: Records, n: int, data: bytes) -> Records:
    """The same with other bytes of the n-th record."""
    parts = [records.data[a:b].tobytes() for a, b in zip(records.first, records.first[1:])]
    parts[n] = data
    first = np.cumsum([0, *map(len, parts)]).astype(np.int64)
    return Records(records.key, first, np.frombuffer(b"".join(parts), np.uint8))


def refused(touching, records: Records, why: str) -> None:
    lmp, kept = touching
    with pytest.raises(RuntimeError, match=why):
        state_lab.put(lmp, "contact", records)
    assert state_lab.pack(lmp, "contact").same(kept.contacts)


@pytest.mark.parametrize("pair", [True, False])
def test_records_that_are_cut_off_or_of_another_version_are_refused(touching, pair):
    """At every eighth byte, and with some more at the end."""
    records = touching[1].contacts
    n = one(records, pair)
    data = records.data[records.first[n] : records.first[n + 1]].tobytes()
    for length in range(0, len(data), 8):
        refused(touching, changed(records, n, data[:length]), "cut off|another version")
    refused(touching, changed(records, n, data + b"1"), "too long")
    refused(touching, changed(records, n, np.int64(99).tobytes() + data[8:]), "another version")
    refused(touching, changed(records, n, data[:8] + np.int64(2**60).tobytes() + data[16:]), "cut off")


@pytest.mark.parametrize(
    ("field", "value", "why"),
    [
        *(("point", value, "points that there are not") for value in (-1, 2**30)),
        *(("side", value, "points that there are not") for value in (-1, 6)),
        *(("cell", value, "points that there are not") for value in (-1, 2**30)),
        *((field, value, "not a number") for field in NUMBERS for value in (np.nan, np.inf)),
        ("order", None, "do not ascend"),
    ],
)
def test_rows_that_do_not_fit_are_refused(touching, field, value, why):
    """One field of the first row of a pair."""
    records = touching[1].contacts
    n = one(records, True)
    data = bytearray(records.data[records.first[n] : records.first[n + 1]].tobytes())
    rows = np.frombuffer(data, FIELD, 2, 16)
    if field == "order":
        rows["point"] = rows["point"][::-1].copy()
    elif rows[field].ndim > 1:
        rows[field][0, 1] = value
    else:
        rows[field][0] = value
    refused(touching, changed(records, n, bytes(data)), why)


@pytest.mark.parametrize(
    ("field", "value", "why"),
    [
        ("point", -1, "points or planes that there are not"),
        ("plane", 1, "points or planes that there are not"),
        *((name, np.nan, "not a number") for name in PLANE.names[2:]),
    ],
)
def test_rows_of_planes_that_do_not_fit_are_refused(touching, field, value, why):
    """One field of the first row."""
    records = touching[1].contacts
    n = one(records, False)
    data = bytearray(records.data[records.first[n] : records.first[n + 1]].tobytes())
    rows = np.frombuffer(data, PLANE, 1, 16)
    rows[field][0] = value
    refused(touching, changed(records, n, bytes(data)), why)


def test_records_of_objects_that_there_are_not_are_refused(touching):
    """A sixth object."""
    records = touching[1].contacts
    key = records.key.copy()
    key[-1] = (5, 6)
    refused(touching, Records(key, records.first, records.data), "object that is not there")


def test_whatever_bytes_there_are_forces_are_worked_out(tmp_path, touching):
    """Change bytes at random: either the records are refused, or a run is set up from them."""
    _, kept = touching
    lmp, random, taken = load(pile(1), tmp_path, **PILE), np.random.default_rng(5), 0
    for _ in range(150):
        data = kept.contacts.data.copy()
        at = random.integers(0, len(data), 3)
        data[at] = random.integers(0, 256, 3)
        try:
            kept._replace(contacts=kept.contacts._replace(data=data)).put(lmp)
        except RuntimeError:
            continue
        taken += 1
    assert 10 < taken < 140
    lmp.close()


def test_places_that_are_no_numbers_do_not_end_the_process(tmp_path):
    """Points that are nowhere are looked up without harm."""
    lmp = load(pile(1), tmp_path, **PILE)
    lmp.command("run 130 pre no post no")
    points = next(rows for (_, host), rows in contact_lab.contacts(state_lab.pack(lmp, "contact")).items() if host >= 0)
    assert len(points)
    lmp.numpy.extract_atom("v")[:] = np.nan
    lmp.command("run 5 pre no post no")
    assert np.isnan(lab.by_tag(lmp, "x")).all()
    lmp.close()


@pytest.fixture
def fix(tmp_path):
    """An instance with the fix and without bodies."""
    cubes = (Cuboid((2, 2, 2)), Cuboid((2, 2, 2), (0.1, 0, 2.1)))
    lmp = load(cubes, tmp_path, setup=False, give=False)
    yield lmp
    lmp.close()


def with_entry(name, at, value):
    array = CUBE[name].copy()
    array[at] = value
    return {**CUBE, name: array}


SHORT = {name: CUBE[name][:-1] for name in ("cell", "at", "centre", "normal", "area", "kind")}
BAD = {
    "no cells": with_entry("count", 1, 0),
    "less than no cells": with_entry("count", 1, -2),
    "far too many cells": with_entry("count", slice(None), 2**19),
    "too many along one axis": with_entry("count", 0, 2**30),
    "no edge": with_entry("edge", 2, 0.0),
    "edge that is not a number": with_entry("edge", 2, np.nan),
    "particle that there is not": with_entry("node", 26, 27),
    "particle below none": with_entry("node", 0, -1),
    "particles that do not ascend": with_entry("node", 5, 4),
    "too few particles": {**CUBE, "node": CUBE["node"][:-1]},
    "no particles": {**CUBE, "node": CUBE["node"][:0]},
    "empty cell of a cuboid": with_entry("filled", 3, 0),
    "cell that there is not": with_entry("cell", 7, 8),
    "cell below none": with_entry("cell", 7, -1),
    "point nowhere": with_entry("at", (3, 1), np.nan),
    "centre nowhere": with_entry("centre", (3, 1), np.inf),
    "normal of no length": with_entry("normal", 3, 0.0),
    "normal that is not a number": with_entry("normal", (3, 2), np.nan),
    "no area": with_entry("area", 3, 0.0),
    "area that is not a number": with_entry("area", 3, np.nan),
    "infinite area": with_entry("area", 3, np.inf),
    "unknown kind": with_entry("kind", 3, 4),
    "depth that is not a number": {**CUBE, "depth": np.full(7**3, np.nan)},
    "open part of no side": {**CUBE, "open": np.array([[6.0, 0, 1, 0, 1]])},
    "open part of half a side": {**CUBE, "open": np.array([[0.5, 0, 1, 0, 1]])},
    "open part that is nowhere": {**CUBE, "open": np.array([[0.0, 0, np.nan, 0, 1]])},
    "covered side of no cuboid": {**CUBE, "depth": np.ones(7**3), "open": np.array([[0.0, 0, 1, 0, 1]])},
}


@pytest.mark.parametrize("name", BAD)
def test_bodies_that_do_not_fit_are_refused(fix, name):
    """One thing is wrong in each; what was there before stays."""
    contact_lab.give_body(fix, "contact", 0, CUBE)
    with pytest.raises(RuntimeError, match="not those of a contact body"):
        contact_lab.give_body(fix, "contact", 0, BAD[name])
    contact_lab.give_body(fix, "contact", 1, CUBE)
    fix.command("run 1")


def test_filled_cells_have_their_particles(fix):
    """Filled cells of a body that is not a cuboid."""
    shape = {**CUBE, "depth": np.ones(7**3)}
    contact_lab.give_body(fix, "contact", 0, shape)
    with pytest.raises(RuntimeError, match="a filled cell lacks a particle"):
        contact_lab.give_body(fix, "contact", 0, {**shape, "node": CUBE["node"][:-1]})
    hole = CUBE["filled"].copy()
    hole[7] = 0
    inside = CUBE["cell"] != 7
    points = {key: CUBE[key][inside] for key in SHORT}
    with pytest.raises(RuntimeError, match="a particle is at no filled cell"):
        contact_lab.give_body(fix, "contact", 0, {**shape, **points, "filled": hole})


@pytest.mark.parametrize(("name", "why"), [("other", "there is no fix other of style"), ("run", "there is no fix run of style")])
def test_bodies_for_no_such_fix_are_refused(fix, name, why):
    """No fix, and one of another style."""
    with pytest.raises(RuntimeError, match=why):
        contact_lab.give_body(fix, name, 0, CUBE)


def test_an_object_without_its_body_ends_the_run(fix):
    """The message names object and body; and one whose particles are not those of its body."""
    contact_lab.give_body(fix, "contact", 0, CUBE)
    with pytest.raises(Exception, match=r"object 2 \(molecule ID\) has body 1, and no such body was given"):
        fix.command("run 0")
    contact_lab.give_body(fix, "contact", 1, Cuboid((2, 2, 3)).arrays)
    with pytest.raises(Exception, match=r"object 2 \(molecule ID\) has 27 particles, its body 1 has 36"):
        fix.command("run 0")
    assert len(lab.by_tag(fix, "x")) == 54


@pytest.mark.parametrize(
    ("words", "why"),
    [
        ("objects stiffness 0", "stiffness must be above 0, got 0"),
        ("objects stiffness -1", "stiffness must be at least 0, got -1"),
        ("objects pair 1 3 0.5 0.3", "pair names molecule 3, and no particle has this ID"),
        ("objects pair 1 2 0.5 0.3 pair 7 2 0 0", "pair names molecule 7, and no particle has this ID"),
        ("objects exclude 1 7", "exclude names molecule 7, and no particle has this ID"),
        ("objects exclude 2 2", "a pair is two different molecule IDs > 0, got 2 and 2"),
    ],
)
def test_words_that_do_nothing_are_refused(tmp_path, words, why):
    """A stiffness of 0, and rules for molecules that there are not."""
    cubes = (Cuboid((2, 2, 2)), Cuboid((2, 2, 2), (0.1, 0, 2.1)))
    with pytest.raises(Exception, match=why):
        load(cubes, tmp_path, words)
    load(cubes, tmp_path, "objects stiffness 0.5 pair 2 1 0.5 0.3").close()
