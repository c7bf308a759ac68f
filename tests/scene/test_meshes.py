# SPDX-License-Identifier: GPL-2.0-only
"""An output folder holds all that it needs: copies of meshes under names of their content."""

import shutil

import pytest
from command_line import run
from mdanim_lammps.api import Scene
from mdanim_lammps.errors import OutputError
from mdanim_lammps.run.loop import Interrupted
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.meshes import mesh_files
from mdanim_lammps.scene.parse import load_scene
from paths import MESHES

MESH = MESHES / "cuboid.obj"
SCENE = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
object a { shape mesh "my mesh.OBJ" position (0, 0, 2) m density 900 kg/m^3 elasticity 1 MPa }
object b { shape mesh "same.obj" position (0, 9, 2) m density 900 kg/m^3 elasticity 1 MPa }
control { time 0.1 s frames 20 fps accuracy preview }
"""


@pytest.fixture
def place(tmp_path):
    """A folder whose name holds what no text of the language can, with a scene of two equal meshes."""
    folder = tmp_path / "a \"b' ü\\n $(c)"
    folder.mkdir()
    shutil.copy(MESH, folder / "my mesh.OBJ")
    shutil.copy(MESH, folder / "same.obj")
    (folder / "two.txt").write_text(SCENE)
    return folder


def test_run_is_used_without_its_meshes(place, tmp_path):
    """Run, remove the meshes, move the folder: it is drawn, resumed and shown all the same."""
    out = place / "two.out"
    with pytest.raises(Interrupted):
        Scene.load(place / "two.txt").run(out, on_progress=lambda progress: (out / "stop").touch())
    (place / "my mesh.OBJ").unlink()
    (place / "same.obj").unlink()
    out = shutil.move(out, tmp_path / "elsewhere")
    lock = (out / "scene.lock.txt").read_text()
    assert str(tmp_path) not in lock
    assert [p.suffix for p in (out / "meshes").iterdir()] == [".obj"]
    # The timeline is refused where there were no executors; that is told after the scene was read.
    for code, *arguments in ((0, "resume", out, "--no-movie"), (0, "render", out, "--size", 64, 48), (4, "timeline", out)):
        done = run(*arguments)
        assert done.returncode == code, (arguments[0], done.stderr)
        assert "Traceback" not in done.stderr
    done = run(out / "scene.lock.txt", "-o", tmp_path / "again", "--no-movie")
    assert done.returncode == 0, done.stderr
    again = (tmp_path / "again" / "scene.lock.txt").read_text()
    assert again.splitlines()[1:] == lock.splitlines()[1:]  # the first line names the file


def test_lock_of_the_copy_is_the_same(place, tmp_path):
    """The lock, and so the run's hash, depends on what meshes hold, not on where they are."""
    scene = load_scene(place / "two.txt")
    names = mesh_files(scene)
    assert len(names) == 2 and len(set(names.values())) == 1
    other = tmp_path / "plain"
    shutil.copytree(place, other)
    assert prepare(scene).lock == prepare(load_scene(other / "two.txt")).lock
    with open(other / "same.obj", "a") as file:
        file.write("# more\n")
    assert len(set(mesh_files(load_scene(other / "two.txt")).values())) == 2


def test_a_folder_is_not_emptied_of_its_own_scene(place):
    """--force refuses to delete a mesh that the scene is about to read."""
    Scene.load(place / "two.txt").run(place / "two.out")
    mesh = next((place / "two.out" / "meshes").iterdir())
    (place / "three.txt").write_text(SCENE.replace("same.obj", f"two.out/meshes/{mesh.name}"))
    with pytest.raises(OutputError, match="holds the mesh"):
        Scene.load(place / "three.txt").run(place / "two.out", force=True)
    assert mesh.is_file()
