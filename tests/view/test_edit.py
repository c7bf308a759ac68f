# SPDX-License-Identifier: GPL-2.0-only
"""A scene is edited and run again, where that was asked for; the run that was viewed keeps its results."""

import json
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
from mdanim_lammps import Scene, Trajectory, children
from mdanim_lammps.errors import UsageError
from mdanim_lammps.view import check, edit
from mdanim_lammps.view.edit import LONGEST_TEXT, Editor
from mdanim_lammps.view.tail import Tail, in_use
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
        link.known = getattr(link, "known", {}) | said["news"]  # for `heard`
    return said


def heard(link, wanted) -> dict:
    """State of a page once this holds of it."""
    known = link.__dict__.pop("known", {})
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


def test_the_text_is_that_of_the_scene(folder):
    """For a folder alone it is the text of the run, as long as that has not changed; else the lock of the run."""
    assert (Editor(folder).text, Editor(folder).name) == (FALL, "fall")
    lock = (folder / "scene.lock.txt").read_text()
    (folder.parent / "fall.txt").write_text(FALL + "# changed\n")
    assert (Editor(folder).text, Editor(folder).name) == (lock, "fall")
    made = json.loads((folder / "manifest.json").read_text())
    for scene in ("/dev/zero", "/etc/passwd", str(folder), "", "\0"):
        (folder / "manifest.json").write_text(json.dumps(made | {"scene": scene}))
        assert Editor(folder).text == lock


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
    """Some mistakes show only when models are built, as two objects in one place."""
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


def test_half_a_character_is_no_text(folder):
    """JSON can hold one, UTF-8 cannot: it is a problem of its line, and no run is left in preparation."""
    with served(folder, editor=Editor(folder)) as view, page(view) as link:
        found = ask(link, edit=SHORT + "# \ud800\n", run=True)
        assert not found["started"] and found["problems"][0]["line"] == SHORT.count("\n") + 1
        assert "half of a character" in found["problems"][0]["message"]
        assert ask(link, edit=SHORT) == {"problems": [], "started": False}


def test_a_check_has_an_end(folder, monkeypatch):
    """A text that takes long to be read is told; the next is checked as if nothing had been."""
    endless = SHORT + "repeat i in 1 .. 1000 { repeat j in 1 .. 1990 { let unused = i * j } }\n"
    with served(folder, editor=Editor(folder)) as view, page(view) as link:
        assert ask(link, edit=SHORT) == {"problems": [], "started": False}
        monkeypatch.setattr(check, "CHECKING", 2.0)
        found = ask(link, edit=endless, run=True)
        assert not found["started"] and "takes more than 2 s" in found["problems"][0]["message"]
        monkeypatch.undo()
        assert ask(link, edit=SHORT) == {"problems": [], "started": False}


def test_texts_that_wait_are_not_run_when_the_server_ends(folder, monkeypatch):
    """A dozen pages ask for a run at once: the last one is run, and the end of the server is not kept waiting by the others."""
    started = []
    editor = Editor(folder, folder.parent / "fall.txt")
    monkeypatch.setattr(edit, "start", lambda *a, **more: started.append(a) or children.start(*a, **more))
    with Tail(folder) as tail:
        editor.run(SHORT.replace("time 0.1 s", "time 100 s"), tail)
        threads = [threading.Thread(target=editor.run, args=(SHORT, tail)) for _ in range(12)]
        for thread in threads:
            thread.start()
        editor.end()
        by_then = len(started)
        for thread in threads:
            thread.join(30)
        assert len(started) == by_then and editor._process.poll() is not None
        editor.run(SHORT, tail)
        assert len(started) == by_then


def test_a_run_ends_with_its_server(folder, tmp_path):
    """Also where that is killed: the run stops after its frame, with a checkpoint, and the folder is free again."""
    program = (
        "import sys, time; from pathlib import Path; from mdanim_lammps.view.edit import Editor; from mdanim_lammps.view.tail "
        "import Tail\nfolder = Path(sys.argv[1])\nwith Tail(folder) as tail:\n"
        "    Editor(folder).run(sys.stdin.read(), tail)\n    time.sleep(600)"
    )
    server = subprocess.Popen([sys.executable, "-c", program, str(folder)], stdin=subprocess.PIPE, text=True)
    server.stdin.write(SHORT.replace("time 0.1 s", "time 500 s"))
    server.stdin.close()
    out = folder.with_name("fall.edited.out")
    until(lambda: (out / "checkpoint").exists())
    assert in_use(out)
    server.kill()
    server.wait()
    until(lambda: not in_use(out))
    assert '"stopped"' in (out / "progress.jsonl").read_text()


def until(holds) -> None:
    """Wait for something."""
    deadline = time.monotonic() + 60
    while not holds():
        assert time.monotonic() < deadline
        time.sleep(0.02)


def test_a_text_that_is_too_long_is_told_at_once(folder):
    """Before a page opens it, which could not send it back."""
    (folder.parent / "fall.txt").write_text(FALL + "#" * LONGEST_TEXT)
    with pytest.raises(UsageError, match="less than 1 MB"):
        Editor(folder, folder.parent / "fall.txt")


def test_the_current_folder_has_a_name(folder, monkeypatch):
    """``view . --edit``: the scene and its edited run are called as the folder is."""
    monkeypatch.chdir(folder)
    (folder.parent / "fall.txt").unlink()
    editor = Editor(Path("."))
    assert (editor.name, editor.out) == ("fall", folder.with_name("fall.edited.out"))
