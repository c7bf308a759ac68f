# SPDX-License-Identifier: GPL-2.0-only
"""docs/gallery.py: all scenes of a folder on a page with their movies."""

import re
from runpy import run_path
from urllib.parse import unquote

import pytest
from command_line import GOOD, call
from mdanim_lammps import Interrupted, Scene
from mdanim_lammps.run.folder import open_run
from paths import REPOSITORY

script = run_path(str(REPOSITORY / "docs" / "gallery.py"))


def gallery(*arguments, cwd=None):
    """Run the script."""
    return call(*arguments, cwd=cwd, main=script["main"])


def test_gallery(tmp_path):
    """All scenes of a folder on a page; one that fails is shown with its message and does not stop the others."""
    folder = tmp_path / "scenes"
    folder.mkdir()
    (folder / "good.txt").write_text('title "A <cube>"\n' + GOOD)
    (folder / "bad.txt").write_text(GOOD.replace("100 kPa", "100 kg"))
    said = gallery(folder, "-o", tmp_path / "g", "--size", "64", "48", "--accuracy", "preview")
    assert said.returncode == 6 and "2 scenes, 1 of them failed" in said.stdout
    page = (tmp_path / "g" / "index.html").read_text()
    assert '<video src="good/movie.mp4"' in page and "A &lt;cube&gt;" in page and "bad.txt:8" in page
    movie = tmp_path / "g" / "good" / "movie.mp4"
    before = movie.stat().st_mtime_ns
    gallery(folder, "-o", tmp_path / "g")
    assert movie.stat().st_mtime_ns == before  # what is there is kept
    (tmp_path / "g" / "index.html").write_text("precious")
    refused = gallery(folder, "-o", tmp_path / "g")
    assert refused.returncode == 7 and "write elsewhere with -o DIR" in refused.stderr
    assert (tmp_path / "g" / "index.html").read_text() == "precious"
    empty = gallery(tmp_path, cwd=tmp_path)
    assert empty.returncode == 7 and "holds no scenes" in empty.stderr


def test_a_gallery_finishes_what_was_stopped(tmp_path):
    """A run that was stopped is not a finished one: it goes on, and its movie is drawn anew."""
    folder, place = tmp_path / "scenes", tmp_path / "g" / "good"
    folder.mkdir()
    (folder / "good.txt").write_text(GOOD + "render { size (64, 48) }\n")
    with pytest.raises(Interrupted):
        Scene.load(folder / "good.txt").run(place, on_progress=lambda p: p.frame == 1 and (place / "stop").touch())
    (place / "movie.mp4").write_text("of one frame")
    said = gallery(folder, "-o", tmp_path / "g")
    assert said.returncode == 0, said.stderr
    assert (place / "summary.json").exists() and (place / "movie.mp4").stat().st_size > 1000


def test_a_gallery_runs_what_was_stopped_at_once(tmp_path):
    """There is no checkpoint to go on from; a folder of `build`, whose script may be changed, is left alone."""
    folder, place, built = tmp_path / "scenes", tmp_path / "g" / "good", tmp_path / "g" / "built"
    folder.mkdir()
    for name in ("good", "built"):
        (folder / f"{name}.txt").write_text(GOOD + "render { size (64, 48) }\n")
    ready = Scene.load(folder / "good.txt").prepared
    with open_run(ready, place, force=False):
        pass  # and is killed
    assert call("build", folder / "built.txt", "-o", built).returncode == 0
    said = gallery(folder, "-o", tmp_path / "g")
    assert (
        said.returncode == 6
        and "2 scenes, 1 of them failed" in said.stdout
        and f"{built}/checkpoint cannot be read" in said.stderr
    )
    assert (place / "summary.json").exists() and (place / "movie.mp4").stat().st_size > 1000


def test_ctrl_c_ends_a_gallery(tmp_path, monkeypatch):
    """And not one of its scenes, after which the next would begin."""
    begun = []

    def run_(scene, place, force):
        begun.append(scene.record.name)
        raise Interrupted("interrupted at t = 1 s")

    for name in ("a", "b"):
        (tmp_path / f"{name}.txt").write_text(GOOD)
    monkeypatch.setattr(Scene, "run", run_)
    said = gallery(tmp_path, "-o", tmp_path / "g")
    assert said.returncode == 130 and begun == ["a"] and "interrupted at t = 1 s" in said.stderr
    assert not (tmp_path / "g" / "index.html").exists()


def test_addresses_of_a_gallery_are_quoted(tmp_path):
    """A name may have any sign."""
    name = "50 % #1?"
    (tmp_path / f"{name}.txt").write_text(GOOD + "render { size (64, 48) }\n")
    said = gallery(tmp_path, "-o", tmp_path / "g", "--accuracy", "preview")
    assert said.returncode == 0, said.stderr
    (source,) = re.findall(r'<video src="([^"]+)"', (tmp_path / "g" / "index.html").read_text())
    assert source == "50%20%25%20%231%3F/movie.mp4" and (tmp_path / "g" / unquote(source)).exists()
