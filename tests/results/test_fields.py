# SPDX-License-Identifier: GPL-2.0-only
"""Fields of effects in a trajectory, of each kind of thing that objects have, also where some particles are not stored."""

import h5py
import numpy as np
import pytest
from mdanim_lammps.effects.fields import Field, join_fields, pair_rows, part_of_fields
from mdanim_lammps.errors import OutputError
from mdanim_lammps.results.compare import compare
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.results.trajectory_file import trajectory_bytes
from mdanim_lammps.results.trajectory_metadata import kept_fields
from mdanim_lammps.results.trajectory_writer import TrajectoryWriter
from mdanim_lammps.scene.scene import Save
from picture_samples import slab_scene

FIELDS = (
    Field("way", "m", per="particle", shape=(3,)),
    Field("hits", "1", per="particle", dtype="int32"),
    Field("most", "m", per="bond"),
    Field("turn", "rad", per="object", shape=(2,)),
    Field("met", "1", per="pair", counts=(4,)),
    Field("slid", "m", per="pair", shape=(2,), counts=(3,)),
)


def values(models, seed=0):
    """Values of all of them for these models."""
    rng = np.random.default_rng(seed)
    particles, springs = sum(len(m.position) for m in models), sum(len(m.spring) for m in models)
    pairs = [np.zeros(n, pair_rows(field)) for n, field in ((2, FIELDS[4]), (0, FIELDS[5]))]
    pairs[0]["a"], pairs[0]["b"], pairs[0]["value"] = [0, 0], [1, 2], [3.0, 0.0]
    return {
        "way": rng.normal(size=(particles, 3)),
        "hits": np.arange(particles, dtype=np.int32),
        "most": rng.normal(size=springs),
        "turn": rng.normal(size=(len(models), 2)),
        "met": pairs[0],
        "slid": pairs[1],
    }


def write(path, save=Save.ALL, told=None):
    """A file with one frame; its models, and what it was told."""
    scene, models = slab_scene(save=save)
    told = values(models) if told is None else told
    with TrajectoryWriter(path, scene, models, frames=1, dt=0.1, steps_per_frame=1, fields=FIELDS) as out:
        x = np.concatenate([m.position for m in models])
        out.write(0, 0.0, x, np.zeros_like(x), told)
    return models, told


@pytest.mark.parametrize("save", [Save.ALL, Save.BOUNDARY])
def test_fields_come_back(tmp_path, save):
    """Fields of particles and springs that are stored; the size of the file is known before."""
    models, told = write(tmp_path / "trajectory.h5", save)
    with Trajectory(tmp_path) as found:
        m = found.metadata
        got = {field.name: found.field(field.name, 0) for field in m.fields}
        assert {(f.name, f.unit, f.per, f.shape) for f in m.fields} == {(f.name, f.unit, f.per, f.shape) for f in FIELDS}
        found.check(0)
    assert (len(m.id) < m.total) == (save is Save.BOUNDARY)
    springs = np.concatenate(
        [one.spring + first for one, first in zip(models, np.cumsum([0, *(len(o.position) for o in models)]))]
    )
    stored = np.isin(springs + 1, m.id).all(axis=1)
    assert np.array_equal(springs[stored] + 1, m.bond)
    kept = {"way": m.id - 1, "hits": m.id - 1, "most": stored}
    for name, value in told.items():
        assert np.array_equal(got[name], value[kept[name]] if name in kept else value), name
        assert got[name].dtype == value.dtype, name
    size = trajectory_bytes(models, 1, save, fields=kept_fields({}, FIELDS, models, save))
    assert size >= (tmp_path / "trajectory.h5").stat().st_size * 0.9


def test_two_runs_differ_by_a_field(tmp_path):
    """One number of a spring, or of a pair, is enough."""
    for name in ("a", "b", "spring", "pair"):
        (tmp_path / name).mkdir()
        models = slab_scene()[1]
        told = values(models)
        if name in ("spring", "pair"):
            told["most" if name == "spring" else "met"][-1:] = (
                (0, 2, 1.0) if name == "pair" else np.nextafter(told["most"][-1], 9)
            )
        write(tmp_path / name / "trajectory.h5", told=told)
    assert compare(tmp_path / "a", tmp_path / "b").equal
    assert not compare(tmp_path / "a", tmp_path / "spring").equal and not compare(tmp_path / "a", tmp_path / "pair").equal


def test_more_pairs_than_there_is_room_for_are_refused(tmp_path):
    """A frame without a field, or with too many rows, is not written."""
    told = values(slab_scene()[1])
    with pytest.raises(ValueError, match=r"met must have the shape \(4, 3\) or fewer rows, found \(5, 3\)"):
        write(tmp_path / "trajectory.h5", told=told | {"met": np.zeros(5, pair_rows(FIELDS[4]))})
    with pytest.raises(ValueError, match=r"way must have the shape .*, found None"):
        write(tmp_path / "trajectory.h5", told={name: value for name, value in told.items() if name != "way"})


@pytest.mark.parametrize(("name", "spoil"), [("most", "per"), ("met", "objects")])
def test_a_damaged_field_is_refused(tmp_path, name, spoil):
    """A kind of thing that there is not, and pairs of objects that are not there."""
    told = values(slab_scene()[1])
    told["met"]["b"] = 7 if spoil == "objects" else told["met"]["b"]
    write(tmp_path / "trajectory.h5", told=told)
    if spoil == "per":
        with h5py.File(tmp_path / "trajectory.h5", "r+") as file:
            file[f"observables/fields/{name}/value"].attrs["per"] = "planet"
    with pytest.raises(OutputError, match="damaged"), Trajectory(tmp_path) as found:
        found.field(name, 0)


def test_parts_make_the_whole():
    """Objects 0, 2, 3 in one part with a guest 1, and 4 in another; 1 is still, and as at the start."""
    first = {"particle": np.array([0, 2, 5, 6, 8, 9]), "bond": np.array([0, 1, 3, 3, 4, 4]), "object": np.arange(6)}
    whole = {per: np.arange(10.0, 10.0 + f[-1]) for per, f in first.items()}
    declared = [*(Field(per, "1", per=per) for per in first), Field("pairs", "1", per="pair"), Field("sum", "J")]
    still = np.arange(5) == 1
    parts = []
    for objects, own in (([0, 1, 2, 3], [0, 2, 3]), ([4], [4])):
        objects, moves = np.array(objects), np.isin(objects, own)
        told = {per: np.concatenate([whole[per][f[m] : f[m + 1]] for m in objects]) for per, f in first.items()}
        told["pairs"] = np.zeros(3 if len(own) > 1 else 0, pair_rows(declared[3]))
        told["pairs"]["a"], told["pairs"]["b"] = ([0, 1, 1], [1, 2, 1]) if len(own) > 1 else ([], [])
        rows = {per: np.append(0, np.cumsum(np.diff(f)[objects])) for per, f in first.items()}
        told["sum"] = 1.5
        parts.append((np.array(own), part_of_fields(declared, told, rows.get, objects, moves)))
    start = {"particle": np.arange(9.0), "bond": np.arange(4.0)}
    found = join_fields(declared, first.get, still, parts, start)
    expected = {"particle": [10, 11, 2, 3, 4, 15, 16, 17, 18], "bond": [10, 1, 2, 13], "object": [10, 0, 12, 13, 14], "sum": 3.0}
    for name, value in expected.items():
        assert np.array_equal(found[name], value), name
    assert found["pairs"][["a", "b"]].tolist() == [(0, 1), (1, 2)]
