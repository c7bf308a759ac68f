# SPDX-License-Identifier: GPL-2.0-only
"""A scene is edited and run again, where that was asked for; the run that was viewed keeps its results."""

import json

import pytest
from mdanim_lammps import Scene, Trajectory
from mdanim_lammps.view.edit import LONGEST_TEXT, Editor
from scene_texts import FALL
from view_lab import page, served
from websockets.exceptions import ConnectionClosed

SHORT = FALL.replace("time 0.3 s", "time 0.1 s").split("expect")[0]


@pytest.fixture
def folder(tmp_path):
    """A finished run."""
    (tmp_path / "fall.txt").write_text(FALL)
    return Scene.load(tmp_path / "fall.txt").run().folder


def ask(link, **what) -> dict:
    """The answer to a message about the text."""
    link.send(json.dumps(what))
    while "news" in (said := json.loads(link.recv(30))):
        pass
    return said


def heard(link, wanted) -> dict:
    """What a page knows when this holds of it."""
    known = {}
    while not wanted(known):
        said = link.recv(60)
        known |= json.loads(said).get("news", {}) if isinstance(said, str) else {}
    return known


def test_without_edit_there_is_no_editing(folder):
    """Neither the text nor a run is to be had, and the page is told so."""
    with served(folder) as view:
        for message in ({"edit": None}, {"edit": SHORT, "run": True}):
            with page(view) as link:
                assert heard(link, lambda known: "edit" in known)["edit"] is False
                link.send(json.dumps(message))
                with pytest.raises(ConnectionClosed) as end:
                    list(link)
                assert end.value.rcvd.code == 1008
    assert not (folder.parent / "fall.edited.out").exists()


def test_problems_have_their_lines(folder):
    """As ``check`` finds them, all in one pass; the text is that of the scene's file, or of the folder's."""
    with served(folder, editor=Editor(folder, folder.parent / "fall.txt")) as view, page(view) as link:
        assert ask(link, edit=None) == {"text": FALL}
        assert ask(link, edit=FALL) == {"problems": [], "started": False}
        bad = FALL.replace("density 1000", "density -1", 1).replace("frames", "fraems")
        found = ask(link, edit=bad, run=True)
        assert found["started"] is False and len(found["problems"]) == 2
        lines = bad.split("\n")
        assert {lines[p["line"] - 1].split()[0] for p in found["problems"]} == {"object", "fraems"}
        assert all(p["message"] and p["severity"] == "error" for p in found["problems"])
    assert Editor(folder).text == (folder / "scene.lock.txt").read_text()


def test_a_run_of_the_edited_text(folder):
    """It goes into a folder of its own, to which the pages turn; the next takes its place; the first run stays as it was."""
    before = {p.name: p.read_bytes() for p in folder.iterdir()}
    editor = Editor(folder, folder.parent / "fall.txt")
    with served(folder, editor=editor) as view, page(view) as link:
        first = heard(link, lambda known: known.get("state") == "done")
        assert ask(link, edit=SHORT, run=True) == {"problems": [], "started": True}
        known = heard(link, lambda known: known.get("state") == "done" and "count" in known)
        assert known["file"] == first["file"] + 1 and known["count"] == 6
        link.send('{"get": 5, "layers": 0}')
        while isinstance(frame := link.recv(30), str):
            pass
        assert frame[:4] == b"MDF1"
        with Trajectory(editor.out) as t:
            assert len(t) == 6
        assert (editor.out / "edited.txt").read_text() == SHORT and editor.text == SHORT
        again = SHORT.replace("time 0.1 s", "time 0.06 s")
        assert ask(link, edit=again, run=True)["started"]
        assert heard(link, lambda known: known.get("state") == "done" and "count" in known)["count"] == 4
    assert {p.name: p.read_bytes() for p in folder.iterdir()} == before


def test_a_run_that_cannot_begin_says_why(folder):
    """What only shows when models are built, as two objects in one place."""
    cube = SHORT[SHORT.index("object cube") : SHORT.index("object plate")]
    text = SHORT + cube.replace("object cube", "object twin")
    with served(folder, editor=Editor(folder, folder.parent / "fall.txt")) as view, page(view) as link:
        heard(link, lambda known: known.get("state") == "done")
        assert ask(link, edit=text, run=True)["started"]
        assert "twin" in heard(link, lambda known: known.get("state") == "failed")["message"]
        assert ask(link, edit=SHORT, run=True)["started"]
        heard(link, lambda known: known.get("state") == "done")


def test_includes_are_those_of_the_scene(folder):
    """Names of files start where the scene's file is."""
    (folder.parent / "parts.txt").write_text("ground z 0 m\n")
    text = SHORT.replace("ground z 0 m\n", 'include "parts.txt"\n')
    assert "include" in text
    with served(folder, editor=Editor(folder, folder.parent / "fall.txt")) as view, page(view) as link:
        heard(link, lambda known: known.get("state") == "done")
        assert ask(link, edit=text, run=True) == {"problems": [], "started": True}
        heard(link, lambda known: known.get("state") == "done")


@pytest.mark.parametrize("message", [{"edit": 1}, {"edit": ["x"]}, {"edit": "x" * LONGEST_TEXT}], ids=["number", "list", "long"])
def test_only_texts_of_bounded_length(folder, message):
    """Anything else closes the page."""
    with served(folder, editor=Editor(folder)) as view, page(view, max_size=None) as link:
        link.send(json.dumps(message))
        with pytest.raises(ConnectionClosed) as end:
            list(link)
        assert end.value.rcvd.code in (1008, 1009)
