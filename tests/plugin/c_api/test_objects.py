# SPDX-License-Identifier: GPL-2.0-only
"""mdanim_insert and its sisters: an instance filled through ctypes against one filled by read_data."""

import ctypes
from dataclasses import replace

import numpy as np
import plugin_lab as lab
import plugin_path
import pytest

BODY = lab.shaken(lab.join(lab.block((3, 3, 3)), lab.block((3, 2, 2), (4.4, 0.3, 0.2), (-0.3, 0.0, 0.0))), 0.02)
COLUMNS = {"k": np.linspace(0.5, 1.5, len(BODY.x)), "drag": np.linspace(0.0, 0.02, len(BODY.x))}
PHYSICS = [
    "mass * 1.0",
    "group inner type 1",
    "group boundary type 2",
    "fix contact all mdanim/barrier boundary inner d_k 1.6",
    "fix run all mdanim/leapfrog lambda d_drag",
    "timestep 0.2",
]


def both_ends(body):
    """Bonds as rows: first (N + 1), partner tags, types."""
    _, kind = lab.bond_types(body)
    rows = [[] for _ in body.x]
    for (i, j), t in zip(body.bond, kind):
        rows[i].append((j + 1, t))
        rows[j].append((i + 1, t))
    first = np.cumsum([0] + [len(r) for r in rows]).astype(np.int64)
    flat = np.array([b for r in rows for b in r], np.int32).reshape(-1, 2)
    return first, flat[:, 0].copy(), flat[:, 1].copy()


def empty_instance(room=18, columns=COLUMNS):
    """A box without particles."""
    lmp = plugin_path.lammps()
    low, high = BODY.x.min(0) - 1.0, BODY.x.max(0) + 1.0
    box = " ".join(f"{a!r} {b!r}" for a, b in zip(low.tolist(), high.tolist()))
    for command in [
        *lab.prelude(columns),
        f"region box block {box}",
        f"create_box 2 box bond/types {len(lab.bond_types(BODY)[0])} extra/bond/per/atom {room}",
    ]:
        lmp.command(command)
    return lmp


def insert(lmp, body, columns=COLUMNS, bonds=None, order=None):
    """Call the C function; returns its status and message."""
    order = np.arange(len(body.x)) if order is None else order
    first, partner, kind = bonds or both_ends(body)
    arrays = [
        np.ascontiguousarray(a, t)
        for a, t in (
            (order + 1, np.int32),
            (1 + body.boundary[order], np.int32),
            (body.molecule[order], np.int32),
            (body.x[order], float),
            (body.v[order], float),
            (body.mass[order], float),
        )
    ]
    property_ = np.array([c[order] for c in columns.values()], float).reshape(len(columns), -1)
    error = ctypes.create_string_buffer(256)
    pointer = lambda a: a.ctypes.data_as(ctypes.c_void_p)
    status = ctypes.CDLL(plugin_path.folder() + "/mdanimplugin.so").mdanim_insert(
        ctypes.c_void_p(getattr(lmp.lmp, "value", lmp.lmp)),
        len(body.x),
        *map(pointer, arrays),
        len(columns),
        (ctypes.c_char_p * len(columns))(*(c.encode() for c in columns)),
        pointer(property_),
        pointer(first),
        pointer(partner),
        pointer(kind),
        error,
        len(error),
    )
    return status, error.value.decode()


def run_and_close(lmp, commands):
    """x, v, number of bonds and their energy after the commands."""
    for command in commands:
        lmp.command(command)
    result = lab.by_tag(lmp, "x"), lab.by_tag(lmp, "v"), lmp.extract_global("nbonds"), lmp.get_thermo("ebond")
    lmp.close()
    return result


def test_inserted_and_read_instances_run_to_the_same_bits(tmp_path):
    """200 steps with contact and drag; LAMMPS counts as many bonds as after read_data."""
    read = run_and_close(lab.load(BODY, tmp_path, columns=COLUMNS), [*PHYSICS, "run 200"])
    lmp = empty_instance()
    assert insert(lmp, BODY) == (0, "")
    put_in = run_and_close(lmp, [*lab.springs(BODY), "thermo_modify norm no", *PHYSICS, "run 200"])
    assert np.array_equal(read[0], put_in[0]) and np.array_equal(read[1], put_in[1])
    assert read[2:] == put_in[2:]
    assert read[2] == len(BODY.bond)
    assert np.abs(read[0] - BODY.x).max() > 1.0


def test_particles_keep_the_given_order():
    """Local order is the order of the arrays, so that views of LAMMPS's arrays need no sorting."""
    lmp = empty_instance()
    assert insert(lmp, BODY)[0] == 0
    for command in [*lab.springs(BODY), *PHYSICS, "run 0"]:
        lmp.command(command)
    n = len(BODY.x)
    assert np.array_equal(lmp.numpy.extract_atom("id")[:n], np.arange(1, n + 1))
    assert np.array_equal(lmp.numpy.extract_atom("x")[:n], BODY.x)
    assert np.array_equal(lmp.numpy.extract_atom("rmass")[:n].ravel(), BODY.mass)
    lmp.close()


def test_a_second_object_may_follow_the_first(tmp_path):
    """Two calls give the particles and bonds of one."""
    lmp = empty_instance()
    first, partner, kind = both_ends(BODY)
    table = {}
    for molecule in (1, 2):
        pick = np.flatnonzero(BODY.molecule == molecule)
        part = replace(BODY, **{n: getattr(BODY, n)[pick] for n in ("x", "v", "mass", "molecule", "boundary")})
        inside = slice(first[pick[0]], first[pick[-1] + 1])
        table[molecule] = (first[pick[0] : pick[-1] + 2] - first[pick[0]], partner[inside].copy(), kind[inside].copy())
        # Tags go on from the first object.
        arrays = [
            np.ascontiguousarray(a, t)
            for a, t in (
                (pick + 1, np.int32),
                (1 + part.boundary, np.int32),
                (part.molecule, np.int32),
                (part.x, float),
                (part.v, float),
                (part.mass, float),
            )
        ]
        property_ = np.array([c[pick] for c in COLUMNS.values()])
        error = ctypes.create_string_buffer(256)
        pointer = lambda a: a.ctypes.data_as(ctypes.c_void_p)
        status = ctypes.CDLL(plugin_path.folder() + "/mdanimplugin.so").mdanim_insert(
            ctypes.c_void_p(getattr(lmp.lmp, "value", lmp.lmp)),
            len(pick),
            *map(pointer, arrays),
            2,
            (ctypes.c_char_p * 2)(*(c.encode() for c in COLUMNS)),
            pointer(property_),
            *map(pointer, table[molecule]),
            error,
            len(error),
        )
        assert (status, error.value) == (0, b"")
    twice = run_and_close(lmp, [*lab.springs(BODY), "thermo_modify norm no", *PHYSICS, "run 50"])
    once = run_and_close(lab.load(BODY, tmp_path, columns=COLUMNS), [*PHYSICS, "run 50"])
    assert np.array_equal(twice[0], once[0]) and twice[2:] == once[2:]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        pytest.param({"room": 5}, "there is room for 5; raise extra/bond/per/atom", id="no room for bonds"),
        pytest.param({"columns": {**COLUMNS, "spin": COLUMNS["k"]}}, "no per-particle property d_spin", id="unknown property"),
        pytest.param({"kind": 99}, "bond type 99 is not within 1 and", id="unknown bond type"),
        pytest.param({"odd": True}, "both ends", id="a bond at one end only"),
    ],
)
def test_mistakes_come_back_as_text(change, message):
    """A wrong argument gives status 1 and a message; nothing is thrown."""
    lmp = empty_instance(change.get("room", 18))
    first, partner, kind = both_ends(BODY)
    if "kind" in change:
        kind[3] = change["kind"]
    if "odd" in change:
        first[-1] -= 1
    status, text = insert(lmp, BODY, change.get("columns", COLUMNS), (first, partner, kind))
    assert status == 1 and message in text
    lmp.close()


def give_springs(lmp, pair=BODY.bond, kind=None):
    """Call the C function; returns its status and message."""
    arrays = [np.ascontiguousarray(a, np.int32) for a in (pair, lab.bond_types(BODY)[1] if kind is None else kind)]
    error = ctypes.create_string_buffer(256)
    status = ctypes.CDLL(plugin_path.folder() + "/mdanimplugin.so").mdanim_give_springs(
        ctypes.c_void_p(getattr(lmp.lmp, "value", lmp.lmp)),
        len(pair),
        *(a.ctypes.data_as(ctypes.c_void_p) for a in arrays),
        error,
        len(error),
    )
    return status, error.value.decode()


@pytest.fixture
def without_bonds():
    """An instance that holds the particles, in the order of their tags, and no bonds."""
    lmp = empty_instance(room=0)
    assert insert(lmp, BODY, bonds=(np.zeros(len(BODY.x) + 1, np.int64), *np.zeros((2, 1), np.int32))) == (0, "")
    yield lmp
    lmp.close()


def test_springs_that_are_given_act_as_bonds_do(without_bonds, tmp_path):
    """200 steps with contact and drag, and their energy, to the bits of an instance that reads its bonds."""
    read = run_and_close(lab.load(BODY, tmp_path, columns=COLUMNS), [*PHYSICS, "run 200"])
    for command in lab.springs(BODY):
        without_bonds.command(command)
    assert give_springs(without_bonds) == (0, "")
    for command in ["thermo_modify norm no", *PHYSICS, "run 200"]:
        without_bonds.command(command)
    assert np.array_equal(lab.by_tag(without_bonds, "x"), read[0]) and np.array_equal(lab.by_tag(without_bonds, "v"), read[1])
    assert without_bonds.get_thermo("ebond") == read[3] and without_bonds.extract_global("nbonds") == 0


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        pytest.param({"style": "zero"}, "springs need 'bond_style mdanim/harmonic'", id="another style"),
        pytest.param({"kind": 99}, "bond type 99 is not within 1 and", id="unknown bond type"),
        pytest.param({"pair": BODY.bond[:, ::-1]}, "spring 0 is 1, 0", id="higher particle first"),
        pytest.param({"pair": BODY.bond[[1, 0]]}, "spring 1 is 0, 1", id="not sorted"),
        pytest.param({"pair": np.array([[0, len(BODY.x)]])}, f"spring 0 is 0, {len(BODY.x)}", id="no such particle"),
    ],
)
def test_wrong_springs_come_back_as_text(without_bonds, wrong, message):
    """Name the first that cannot be."""
    pair = wrong.get("pair", BODY.bond)
    for command in [
        f"bond_style {wrong.get('style', 'mdanim/harmonic')}",
        "bond_coeff *" + " 1.0" * (2 if "style" not in wrong else 0),
    ]:
        without_bonds.command(command)
    status, text = give_springs(without_bonds, pair, np.full(len(pair), wrong.get("kind", 1)))
    assert status == 1 and message in text


def test_springs_that_were_given_want_their_particles(without_bonds):
    """Say so when particles come or go afterwards, instead of taking others for them."""
    for command in lab.springs(BODY):
        without_bonds.command(command)
    assert give_springs(without_bonds) == (0, "")
    for command in [*PHYSICS, "group gone id 3", "delete_atoms group gone compress no"]:
        without_bonds.command(command)
    with pytest.raises(Exception, match=f"springs were given for {len(BODY.x)} particles"):
        without_bonds.command("run 0")


@pytest.mark.parametrize("file", ["write_restart", "write_data"])
def test_springs_that_were_given_are_not_lost_in_files(without_bonds, tmp_path, file):
    """Refuse to write a file that would be without them."""
    for command in lab.springs(BODY):
        without_bonds.command(command)
    assert give_springs(without_bonds) == (0, "")
    for command in [*PHYSICS, "run 0"]:
        without_bonds.command(command)
    with pytest.raises(Exception, match="a file would be without them"):
        without_bonds.command(f"{file} {tmp_path / 'file'}")
