# SPDX-License-Identifier: GPL-2.0-only
"""A feature with all that one may have, tests/lab/features/whole, gives the same bits in all forms of the distribution."""

import os
import signal
import subprocess
import sys

import numpy as np
import plugin_path
import pytest
import whole
from distribution_lab import RESUMED, TEAMS, THREADS, WINDOWS, film_of, film_of_lammps, forms_in, matrix, of_features, same_frames
from mdanim_lammps.export.cut import Cut
from mdanim_lammps.export.write import export
from mdanim_lammps.results.checkpoint import Checkpoint
from mdanim_lammps.results.compare import compare
from mdanim_lammps.results.ledger import Ledger
from mdanim_lammps.results.trajectory import Trajectory

pytestmark = pytest.mark.mpi

CASES = (
    matrix((2,), ["central"], name="all move ", rotate=True)
    | matrix((3,), ["peers"], name="all move ", rotate=True)
    | matrix((3,), ["central"], name="again ", settings=WINDOWS | {"safety": 0.2})
    | TEAMS
    | THREADS
    | RESUMED
)


FORGETFUL = matrix((2,), ["central"], name="forgetful ", rotate=True, forget="all")


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """The folder of each form, all made in one start of MPI."""
    return forms_in(tmp_path_factory.mktemp("whole"), whole.REMEMBERING, CASES | FORGETFUL, timeout=200.0, features="whole")


@pytest.mark.parametrize("way", CASES)
def test_all_forms_give_the_same(found, way):
    """Frames, the state with all columns and records, and the sum of the work but for rounding."""
    alone, other = same_frames(found, way)
    for name in "xvf":
        assert np.array_equal(getattr(alone, name), getattr(other, name)), name
    assert alone.records.keys() == {"contact", "rig", "column way", "column most", "column turns"}
    assert alone.records == other.records
    assert other.carried["work"] == pytest.approx(alone.carried["work"], rel=1e-9)


def test_a_state_that_is_lost_is_seen(found):
    """Instances that begin without columns and records give other frames: the test above can fail."""
    assert not compare(found["sequential"], found["forgetful central2"]).equal


def test_frames_have_its_columns(found):
    """Values of particles, springs, objects and pairs, with their units; those of the checkpoint at the end."""
    folder = found["all move peers3"]
    with Trajectory(folder) as trajectory:
        of = {field.name: field for field in trajectory.metadata.fields}
        told = {name: trajectory.field(name, len(trajectory) - 1) for name in of}
        bonds, particles, objects = len(trajectory.metadata.bond), len(trajectory.metadata.id), len(trajectory.names)
        lengths = trajectory.field("most", 0)
        i, j = np.searchsorted(trajectory.metadata.id, trajectory.metadata.bond.T)
        apart = np.linalg.norm(np.subtract(*(trajectory.position(0)[k] for k in (i, j))), axis=1)
    assert {name: field.unit for name, field in of.items()} == {
        "most": "m",
        "reached": "m",
        "taut": "1",
        "turns": "1",
        "way": "m",
    }
    assert told["way"].shape == (particles, 3) and told["most"].shape == (bonds,) and told["turns"].shape == (objects,)
    np.testing.assert_allclose(lengths, apart, rtol=1e-12)
    assert (told["most"] >= lengths).all() and (told["most"] > lengths).any()
    steps = told["turns"].max()
    assert (told["turns"] == steps).all() and np.abs(told["way"]).max() > 0.005
    assert (
        told["taut"]["a"].tolist() == [0, 2, 4, 6]
        and (told["taut"]["value"] > 0).all()
        and (told["taut"]["value"] <= steps).all()
    )
    records = Checkpoint.read(folder / "checkpoint").records
    assert np.array_equal(records["column most"].data.view(float), told["most"])


def test_the_work_of_what_is_driven_closes_the_ledger(found):
    """A table shakes a rider and tethers, in all forms: what it gives is a column, and nothing is missing or too much."""
    for way in ("sequential", *CASES):
        folder = found[way]
        ledger = Ledger.read(folder / "ledger.csv")
        assert np.abs(ledger.array("residual")).max() < 2e-4  # 7e-5: the order of leap-frog
        assert np.abs(ledger.array("work")).max() > 1.0


def test_exports_have_its_columns(found, tmp_path):
    """A table has those of objects, ParaView's points have those of particles, springs and objects."""
    folder = found["teams peers2"]
    export(folder, "csv", tmp_path / "table.csv", frames=slice(8, 9))
    header, *rows = (tmp_path / "table.csv").read_text().splitlines()
    assert header.split(",")[-2:] == ["reached", "turns"] and len(rows) == 8
    with Trajectory(folder) as trajectory:
        points = Cut(trajectory, ["arm", "far"], 1, slice(8, 9)).of_particles(8)
        most, turns = trajectory.field("most", 8), trajectory.field("turns", 8)
        inside = np.isin(trajectory.metadata.object_of, (2, 5))
        i, j = np.searchsorted(trajectory.metadata.id, trajectory.metadata.bond.T)
    largest = np.zeros(len(inside))
    np.maximum.at(largest, i, most)
    np.maximum.at(largest, j, most)
    assert np.array_equal(points["most"], largest[inside]) and (points["turns"] == turns[0]).all()
    assert points["way"].shape == (inside.sum(), 3) and points["reached"].shape == (inside.sum(),)


PROGRAM = """
import os, signal, sys
from pathlib import Path
from mdanim_lammps.results.checkpoint import Checkpoint
from mdanim_lammps.run import loop
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import load_scene

scene, folder, kill = Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3])
ready, loop.CHECKPOINT_SECONDS = prepare(load_scene(scene)), 0.0
if kill:
    folder.mkdir()
    loop.write_inputs(ready, folder)
resume = None if kill else Checkpoint.read(folder / "checkpoint")
assert kill or resume.frame == 4
loop.simulate(ready, folder, resume=resume, on_progress=lambda p: p.frame == kill and os.kill(os.getpid(), signal.SIGKILL))
"""
"""Runs a scene and is killed in the middle of a frame, which counts from 1; with 0 it goes on."""


@pytest.fixture(scope="module")
def killed(found):
    """The folder of a run that was killed and gone on with."""
    folder = found["sequential"].parent / "killed"
    env = {**plugin_path.environment(), **of_features("whole"), "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    for kill in (5, 0):
        command = [sys.executable, "-c", PROGRAM, folder.parent / "scene.txt", folder, str(kill)]
        done = subprocess.run(command, env=env, capture_output=True, text=True, timeout=120)
        assert done.returncode == (-signal.SIGKILL if kill else 0), done.stderr
    return folder


def test_a_run_that_is_killed_goes_on(found, killed):
    """From the checkpoint of the frame before, to the same frames, state and work."""
    test_all_forms_give_the_same(found | {"killed": killed}, "killed")


def test_plain_lammps_gives_the_same(found, killed):
    """The script and data of the scene for two frames, with two ranks; columns come by the section Model and by their file."""
    script = killed / "in.scene"
    text, steps = script.read_text().split("\nrun ")
    script.write_text(f"{text}\nrun {int(steps) // 4}\n")
    film = film_of(found["sequential"])[:3]
    assert np.array_equal(film_of_lammps(killed, film.shape[1], name="scene", more=of_features("whole")), film)
