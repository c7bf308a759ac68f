# SPDX-License-Identifier: GPL-2.0-only
"""Overwriting and deleting: only files that this program has made."""

import os
import subprocess
import sys
import time

import pytest
from command_line import GOOD, call
from mdanim_lammps import Scene
from mdanim_lammps.cli import scene_commands
from mdanim_lammps.errors import OutputError, UsageError
from mdanim_lammps.export.write import export
from mdanim_lammps.results.files import claimed, delete_results, scratch
from mdanim_lammps.results.overwriting import check_overwriting, place_of

SMALL = GOOD + "render { size (64, 48)  movie 'films/a.mp4' }\n".replace("'", '"')


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    """A scene that has been run, with a movie and all that commands make of it."""
    path = tmp_path_factory.mktemp("scene") / "good.txt"
    path.write_text(SMALL)
    assert call(path).returncode == 0
    out = path.with_suffix(".out")
    for words in (("render", out, "--frames"), ("report", out)):
        assert call(*words).returncode == 0
    return path


def test_force_leaves_what_is_the_users(scene):
    """Notes, exports, files beside pictures; what the run before has written is gone."""
    out = scene.with_suffix(".out")
    for name in ("notes.md", "good.usdc", "data.csv", "in.txt", "frames/title.png", "films/other.mp4"):
        (out / name).write_text("of the user")
    scene = scene.rename(scene.with_name("other.txt"))
    assert call("build", scene, "-o", out, "--force").returncode == 0
    left = {str(p.relative_to(out)) for p in out.rglob("*") if p.is_file()}
    assert left == {
        *("notes.md", "good.usdc", "data.csv", "in.txt", "frames/title.png", "films/other.mp4"),
        *("manifest.json", "scene.lock.txt", "certificate.json", "data.other", "in.other", "contact.other"),
    }
    with pytest.MonkeyPatch.context() as patch:  # as on a full disk
        patch.setattr("mdanim_lammps.run.folder.write_json", lambda *_: (_ for _ in ()).throw(OutputError("full")))
        assert call("build", scene, "-o", out, "--force").returncode == 7
    assert call("build", scene, "-o", out, "--force").returncode == 0, "the folder is still ours"
    again = call("build", scene, "-o", out)
    assert again.returncode == 7 and "overwrite it with --force" in again.stderr


def test_force_leaves_pictures_of_others(scene):
    """A movie, a page, a diagram that a run could have made, but has not; what it has made says so in itself."""
    out = scene.parent / "theirs.out"
    scene = scene if scene.exists() else scene.with_name("other.txt")
    assert call(scene, "-o", out).returncode == 0
    assert call("render", out, "--frames").returncode == 0 and call("report", out).returncode == 0
    theirs = ("films/a.mp4", "report.html", "trace.json", "frames/frame-00000.png")
    for name in theirs[1:]:
        (out / name).write_text("precious")
    assert call("build", scene, "-o", out, "--force").returncode == 0
    left = {str(p.relative_to(out)) for p in out.rglob("*") if p.is_file()}
    assert left & {"films/a.mp4", "frames/frame-00001.png", *theirs} == {*theirs[1:]}
    (out / "films").mkdir(exist_ok=True)
    (out / "films/a.mp4").write_text("precious")
    assert call(scene, "-o", out, "--force", "--no-movie").returncode == 0
    assert {(out / name).read_text() for name in theirs} == {"precious"}


@pytest.mark.parametrize("name", ["../out.mp4", "/tmp/out.mp4", "notes.md", 7])
def test_a_manifest_names_no_other_files(tmp_path, name):
    """As the movie to be deleted: a folder may be a stranger's."""
    import json

    home = tmp_path / "x.out"
    home.mkdir()
    (home / "manifest.json").write_text(json.dumps({"program": "mdanim-lammps", "movie": name}))
    for other in ("out.mp4", "x.out/notes.md"):
        (tmp_path / other).write_text("precious")
    delete_results(home)
    assert sorted(p.name for p in tmp_path.rglob("*")) == ["manifest.json", "notes.md", "out.mp4", "x.out"]


@pytest.mark.parametrize(
    ("command", "suffix"), [("picture", ".png"), ("render", ".mp4"), ("report", ".html")], ids=lambda w: w.strip(".")
)
def test_files_of_others_ask_for_force(tmp_path, command, suffix):
    """A file that this program has made is replaced by the next one."""
    path = tmp_path / "good.txt"
    path.write_text(GOOD + "render { size (64, 48) }\n")
    if command != "picture":
        assert call(path, "--no-movie").returncode == 0
    made, about = tmp_path / f"made{suffix}", path if command == "picture" else path.with_suffix(".out")
    made.write_text("precious")
    refused = call(command, about, "-o", made)
    assert refused.returncode == 7 and "overwrite it with --force" in refused.stderr
    assert made.read_text() == "precious"
    assert call(command, about, "-o", made, "--force").returncode == 0
    assert call(command, about, "-o", made).returncode == 0
    assert made.stat().st_size > 100


def test_files_of_others_in_a_folder_of_results(scene):
    """They are asked for, too, where no -o names them: a movie, a page."""
    out = scene.parent / "mine.out"
    assert call(scene if scene.exists() else scene.with_name("other.txt"), "-o", out, "--no-movie").returncode == 0
    (out / "films").mkdir()
    for command, name in (("render", "films/a.mp4"), ("report", "report.html")):
        (out / name).write_text("precious")
        refused = call(command, out)
        assert refused.returncode == 7 and "overwrite it with --force" in refused.stderr
        assert (out / name).read_text() == "precious"
        assert call(command, out, "--force").returncode == 0
        assert call(command, out).returncode == 0


def test_what_cannot_be_overwritten(tmp_path):
    """A folder, a link to a file of others; an empty file is none of ours."""
    (tmp_path / "folder.png").mkdir()
    (tmp_path / "empty.png").touch()
    (tmp_path / "link.png").symlink_to(tmp_path / "empty.png")
    (tmp_path / "dangling.png").symlink_to(tmp_path / "nowhere.png")  # what is written through it lands elsewhere
    asks = dict.fromkeys(("empty.png", "link.png", "dangling.png"), "force=True")
    for name, words in {"folder.png": "is a folder", **asks}.items():
        with pytest.raises(OutputError, match=words):
            check_overwriting(tmp_path / name, force=False)
    check_overwriting(tmp_path / "none.png", force=False)
    check_overwriting(tmp_path / "empty.png", force=True)


def test_where_a_file_goes(tmp_path):
    """A folder takes it under its usual name, the letters of a suffix may be capitals; another kind, and a folder that is not
    there, are refused."""
    default = tmp_path / "good.png"
    assert place_of(default, None) == default
    assert place_of(default, tmp_path) == default
    assert place_of(default, tmp_path / "OTHER.PNG") == tmp_path / "OTHER.PNG"
    with pytest.raises(UsageError, match=r"this file is written as .png; give it a name such as other.png"):
        place_of(default, tmp_path / "other.jpg")
    with pytest.raises(OutputError, match="there is no folder"):
        place_of(default, tmp_path / "none" / "other.png")


def test_an_export_deletes_no_folders_inside_of_it(tmp_path):
    """Whatever they are called."""
    (tmp_path / "good.txt").write_text(GOOD)
    run = Scene.load(tmp_path / "good.txt").run()
    export(run.folder, "vtk")
    theirs = run.folder / "good.vtk" / "theirs.vtp"
    theirs.mkdir()
    (theirs / "thesis.tex").write_text("years of work")
    with pytest.raises(OutputError, match="holds files that are not of an export"):
        export(run.folder, "vtk", force=True)
    assert (theirs / "thesis.tex").exists()
    (theirs / "thesis.tex").unlink()
    theirs.rmdir()
    export(run.folder, "vtk", force=True)


KILLED = """
import os, signal, sys
from pathlib import Path
from mdanim_lammps.results.files import scratch
with scratch(Path(sys.argv[1]), "movie") as place:
    (place / "movie.mp4").write_bytes(bytes(1000))
    os.kill(os.getpid(), signal.SIGKILL)
"""


def test_what_killed_processes_leave_is_removed(tmp_path):
    """By the next that works there; what a living one uses stays, and so do folders of others."""
    (tmp_path / ".movie-notes123").mkdir()
    (tmp_path / ".movie-0123abcd").mkdir()  # without a lock: not of `scratch`
    for _ in range(2):
        subprocess.run([sys.executable, "-c", KILLED, tmp_path], check=False)
    others = {".movie-notes123", ".movie-0123abcd"}
    assert len(set(os.listdir(tmp_path)) - others) == 1, "the second has removed what the first has left"
    with scratch(tmp_path, "export") as living:
        with claimed(tmp_path):
            assert set(os.listdir(tmp_path)) == {*others, living.name, ".in-use"}
        assert living.exists()
    assert set(os.listdir(tmp_path)) == others


def test_a_killed_study_leaves_no_run(tmp_path):
    """The next one removes it."""
    (tmp_path / "good.txt").write_text(GOOD.replace("time 0.1 s", "time 100 s"))
    place = tmp_path / "good.out" / "study"
    words = [sys.executable, "-m", "mdanim_lammps", "study", str(tmp_path / "good.txt"), "-q", "--budget", "60 s"]
    with subprocess.Popen(words, stderr=subprocess.DEVNULL) as process:
        deadline = time.monotonic() + 30
        while not list(place.glob(".*/trajectory*")) and process.poll() is None and time.monotonic() < deadline:
            time.sleep(0.01)
        process.kill()
    assert len(left := list(place.glob(".*-*"))) == 1
    with scratch(place, "c4"):
        assert not left[0].exists()


def test_a_folder_in_the_way_is_told_before_the_work(tmp_path, monkeypatch):
    """Preparing a large scene takes a minute."""
    path = tmp_path / "good.txt"
    path.write_text(GOOD)
    assert call("build", path).returncode == 0
    monkeypatch.setattr(scene_commands, "prepare", lambda *a, **more: pytest.fail("the scene was prepared"))
    for command in ((), ("build",)):
        ended = call(*command, path)
        assert ended.returncode == 7 and "overwrite it with --force" in ended.stderr
