# SPDX-License-Identifier: GPL-2.0-only
"""Where exports go, and what they leave alone."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from mdanim_lammps import Scene
from mdanim_lammps.errors import OutputError
from mdanim_lammps.export.write import export
from picture_samples import falling, slab_scene, write
from scene_texts import FALL


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The output folder of a short run."""
    place = tmp_path_factory.mktemp("run")
    (place / "fall.txt").write_text(FALL.split("expect")[0].replace("time 0.3 s", "time 0.1 s"))
    return Scene.load(place / "fall.txt").run().folder


@pytest.mark.parametrize("name", ["notes.vtp", "surfaces-000000.vtp.vtp", "frames-000000.vtp", "surfaces-000002.vtp"])
def test_force_deletes_no_folders(folder, tmp_path, name):
    """Neither a folder with the name of a piece, nor a file with another name, nor what a folder of another format holds."""
    export(folder, "vtk", tmp_path / "a.pvd", every=4)
    inside = tmp_path / "a.vtk" / name
    if name.startswith("surfaces"):
        inside.mkdir()
        inside = inside / "kept.txt"
    inside.write_text("mine")
    other = tmp_path / "a.csv" / "surfaces-000000.vtp"
    other.parent.mkdir()
    other.write_text("mine")
    with pytest.raises(OutputError, match="holds files that are not of an export"):
        export(folder, "vtk", tmp_path / "a.pvd", force=True)
    export(folder, "csv", tmp_path / "a.csv", force=True)  # into that folder, with a name of its own
    assert inside.read_text() == other.read_text() == "mine"


def test_the_current_folder_is_exported(folder, tmp_path, monkeypatch):
    """``export .``: the file is called as the folder is."""
    shutil.copytree(folder, tmp_path / "here.out")
    monkeypatch.chdir(tmp_path / "here.out")
    done = export(Path("."), "csv")
    assert [file.resolve() for file in done.files] == [tmp_path / "here.out" / "here.csv"]
    assert done.files[0].exists()


@pytest.mark.parametrize(("where", "formats"), [(np.nan, ["xtc", "xyz", "lammpstrj", "vtk"]), (3e5, ["xtc"])])
def test_what_cannot_be_held_is_refused(tmp_path, where, formats):
    """A place that is none, and one that is farther away than XTC can say: its library would write a damaged frame."""
    scene, models = slab_scene()
    frames = falling(models, 3)
    frames = [(step, time, x.copy(), v) for step, time, x, v in frames]
    frames[2][2][0, 0] = where
    (tmp_path / "r.out").mkdir()
    write(tmp_path / "r.out" / "trajectory.h5", scene, models, frames)
    for to in formats:
        with pytest.raises(OutputError, match=r"frame 2(: a particle is 3e5 m| is damaged)"):
            export(tmp_path / "r.out", to)
        assert export(tmp_path / "r.out", to, frames=slice(0, 2)).frames == 2
