# SPDX-License-Identifier: GPL-2.0-only
"""A resume takes up nothing that does not fit the run, and loses nothing of it: checkpoint, ledger, depth, seconds, folder."""

import shutil
from dataclasses import replace

import numpy as np
import pytest
from command_line import GOOD
from mdanim_lammps import Scene
from mdanim_lammps.engine.state import StateRecords
from mdanim_lammps.errors import OutputError
from mdanim_lammps.results.checkpoint import Checkpoint
from mdanim_lammps.results.files import PAUSE
from mdanim_lammps.results.stored import read_json
from mdanim_lammps.run.loop import Interrupted, simulate
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import load_scene
from paths import MESHES

HARD = GOOD.replace("(0, 0, 6) cm", "(0, 0, 5.1) cm\n  velocity (0, 0, -2) m/s").replace(
    "resolution", "friction 0.4\n  resolution"
)
"""It is deepest in the ground in the first frames, and its blow loses energy."""


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A run from its beginning to its end."""
    place = tmp_path_factory.mktemp("whole")
    (place / "hard.txt").write_text(HARD)
    return Scene.load(place / "hard.txt").run(place / "whole.out")


@pytest.fixture
def cut(whole, tmp_path):
    """The same run, stopped after its second frame, ready to go on: the prepared scene and its folder."""
    scene, folder = Scene.load(whole.folder.parent / "hard.txt"), tmp_path / "cut.out"
    with pytest.raises(Interrupted):
        scene.run(folder, on_progress=lambda progress: progress.frame == 2 and (folder / "stop").touch())
    return scene.prepared, folder


def go_on(cut, **changed):
    """Resume from the checkpoint with other values in it."""
    ready, folder = cut
    return simulate(ready, folder, resume=replace(Checkpoint.read(folder / "checkpoint"), **changed))


def test_losses_depth_and_seconds_are_carried_over(whole, cut):
    """The rest alone would tell a shallow dent, few losses and a short time."""
    before = Checkpoint.read(cut[1] / "checkpoint").carried
    assert before["contact_damping_loss"] > 0.0 and before["penetration"] > 0.0 and before["seconds"] > 0.0
    resumed = go_on(cut)
    assert read_json(cut[1] / "summary.json")["penetration"] == read_json(whole.folder / "summary.json")["penetration"]
    assert resumed.ledger.rows[-1]["contact_damping_loss"] == whole.ledger.rows[-1]["contact_damping_loss"]
    assert resumed.cost.other["before the resume"] == before["seconds"]
    assert resumed.cost.wall > before["seconds"]


def test_a_state_that_does_not_fit_is_refused(cut):
    """A frame that is not of the run, a step of another frame, a particle less, a record of an object that is not there."""
    whole = Checkpoint.read(cut[1] / "checkpoint")
    of = {at: StateRecords(np.array([[at, 0]], np.int32), np.zeros(2, np.int64), np.zeros(0, np.uint8)) for at in (2, -1)}
    last = cut[0].certificate.last_frame
    for wrong in (
        {"frame": -1, "step": -whole.step // 2},
        {"frame": last + 1, "step": cut[0].certificate.steps},
        {"step": whole.step + 1},
        {"x": whole.x[:-1]},
        {"records": dict.fromkeys(whole.records, of[2])},
        {"records": dict.fromkeys(whole.records, of[-1])},
    ):
        with pytest.raises(OutputError, match="checkpoint is damaged; run the scene again with force"):
            go_on(cut, **wrong)
    assert go_on(cut).folder == cut[1], "nothing was lost by the refusals"


@pytest.mark.parametrize("change", [("0.0,", "0.25,"), ("kinetic", "kinetik")], ids=["a figure", "a column"])
def test_a_ledger_of_something_else_is_refused(cut, change):
    """A figure before the checkpoint has changed, or a column has another name."""
    path = cut[1] / "ledger.csv"
    path.write_text(path.read_text().replace(*change, 1))
    with pytest.raises(OutputError, match=r"ledger.csv .*(rows are not those of the checkpoint|damaged)"):
        go_on(cut)


def test_a_pause_of_a_killed_run_does_not_hold_the_resume(cut):
    """The file is of a run that is no more."""
    (cut[1] / PAUSE).touch()
    go_on(cut)
    assert not (cut[1] / PAUSE).exists()


def test_a_stop_ends_a_pause(whole, tmp_path):
    """A run that is paused obeys the file ``stop``."""
    folder, told = tmp_path / "held.out", []

    def watch(progress):
        told.append(progress.paused)
        (folder / ("stop" if progress.paused else PAUSE)).touch()

    with pytest.raises(Interrupted, match="interrupted at t = "):
        Scene.load(whole.folder.parent / "hard.txt").run(folder, on_progress=watch)
    assert any(told)


def test_an_output_folder_holds_neither_scene_nor_mesh(tmp_path):
    """A run that empties the folder would delete them."""
    home = tmp_path / "home"
    home.mkdir()
    (home / "hard.txt").write_text(HARD)
    with pytest.raises(OutputError, match="holds the scene, and force=True would delete it"):
        Scene.load(home / "hard.txt").run(home, force=True)
    scene, mesh = tmp_path / "mesh.txt", home / "cuboid.obj"
    shutil.copy(MESHES / "cuboid.obj", mesh)
    scene.write_text(GOOD.replace("shape box (10, 10, 10) cm", 'shape mesh "home/cuboid.obj"  scale 0.05'))
    with pytest.raises(OutputError, match=r"holds the mesh cuboid\.obj of this scene and cannot be emptied"):
        Scene.load(scene).run(home, force=True)
    assert (home / "hard.txt").exists() and mesh.exists()


def test_an_unstable_run_is_told_how_it_goes_on(tmp_path):
    """With the word that it was begun with."""
    path, folder = tmp_path / "hard.txt", tmp_path / "far.out"
    path.write_text(GOOD)
    limit = prepare(load_scene(path)).certificate
    path.write_text(GOOD.replace("resolution", f"timestep {1.05 * limit.timestep / limit.fraction!r} s\n  resolution"))
    folder.mkdir()
    with pytest.raises(Interrupted, match=f"mdanim-lammps resume {folder} --allow-unstable\n"):
        simulate(prepare(load_scene(path), allow_unstable=True), folder, on_progress=lambda _: (folder / "stop").touch())
