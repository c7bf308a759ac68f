# SPDX-License-Identifier: GPL-2.0-only
"""Pages pull at objects of a run that goes on, where that was asked for, and do nothing else."""

import json
import time

import numpy as np
import pytest
from mdanim_lammps import Scene
from mdanim_lammps.cli import main
from mdanim_lammps.results.files import HAND, STOP
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.run.hands import read_request
from mdanim_lammps.view import pull
from mdanim_lammps.view.pull import Puller
from scene_texts import FALL
from view_lab import Held, page, served
from websockets.exceptions import ConnectionClosed

HELD = {"object": 0, "vertex": [0, 1, 2], "weight": [0.2, 0.3, 0.5], "to": [0.1, 0.2, 0.3]}
LEAST = 0.002


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The folder of a run that is paused."""
    place = tmp_path_factory.mktemp("pull")
    (place / "fall.txt").write_text(FALL)
    run = Held(place / "fall.txt", place / "fall.out")
    run.wait_for("paused")
    yield run.folder
    (run.folder / STOP).touch()
    run.thread.join()


@pytest.fixture
def view(folder, monkeypatch):
    monkeypatch.setattr(pull, "LEAST", LEAST)
    with served(folder) as found:
        found.puller = Puller(found.tail)
        yield found
        (folder / HAND).unlink(missing_ok=True)


def say(link, hand) -> None:
    """Move the hand; return when the server has done it."""
    link.send(json.dumps({"hand": hand}))
    link.send(json.dumps({"track": 0}))
    while isinstance(link.recv(20), str):
        pass


def test_a_page_moves_the_hand_and_lets_go(view, folder):
    """The run is told of the point as it is at the start, whatever the frame; a page that is gone lets go."""
    with page(view) as link:
        say(link, HELD)
        name, at, to = read_request(folder / HAND)
        with Trajectory(folder) as trajectory:
            corners = view.tail.feed().vertices(trajectory.frames.value("position", 0))[:3]
            assert name == trajectory.metadata.names[0] and to == (0.1, 0.2, 0.3)
        np.testing.assert_allclose(at, [0.2, 0.3, 0.5] @ corners, rtol=1e-12)
        say(link, None)
        assert not (folder / HAND).exists()
        say(link, HELD)
    deadline = time.monotonic() + 20
    while (folder / HAND).exists() and time.monotonic() < deadline:
        time.sleep(0.005)
    assert not (folder / HAND).exists()


def test_before_the_first_frame_there_is_nothing_to_pull_at(view, folder, monkeypatch):
    """A page that asks before it can have seen one is told so, and goes on."""
    monkeypatch.setattr(type(view.tail), "count", 0)
    with page(view) as link:
        link.send(json.dumps({"hand": HELD}))
        while "refused" not in (said := json.loads(link.recv(20))):
            pass
        assert "no frame yet" in said["refused"] and not (folder / HAND).exists()


def test_one_page_has_the_hand(view, folder):
    """Another one is not heard until the hand is free."""
    with page(view) as first, page(view) as second:
        say(first, HELD)
        say(second, HELD | {"to": [0, 0, 9]})
        say(second, None)
        assert read_request(folder / HAND)[2] == (0.1, 0.2, 0.3)
        say(first, None)
        say(second, HELD | {"to": [0, 0, 9]})
        assert read_request(folder / HAND)[2] == (0.0, 0.0, 9.0)


def test_words_of_a_page_wait(view):
    """More of them than a hundred in a second."""
    with page(view) as link:
        say(link, HELD)
        begin = time.monotonic()
        for _ in range(20):
            link.send(json.dumps({"hand": HELD}))
        say(link, HELD)
        assert time.monotonic() - begin > 20 * LEAST


@pytest.mark.parametrize(
    "wrong",
    [
        "ball",
        {"object": 9},
        {"object": True},
        {"vertex": [0, 1]},
        {"vertex": [0, 1, 10**9]},
        {"vertex": [0, 1, -1]},
        {"vertex": [0, 1, 0.5]},
        {"weight": [1.0, 1.0, -1.0]},
        {"weight": [0.0, 0.0, 0.0]},
        {"to": [0, 0, float("nan")]},
        {"to": [0, 0, 1e10]},
        {"to": "abc"},
        {"to": [0, 0, 0] * 2000},
    ],
)
def test_other_words_end_the_connection(view, folder, wrong):
    with page(view) as link:
        link.send(json.dumps({"hand": HELD | wrong if isinstance(wrong, dict) else wrong}))
        with pytest.raises(ConnectionClosed) as end:
            list(link)
    assert end.value.rcvd.code in (1008, 1009) and not (folder / HAND).exists()


def test_without_hands_no_page_pulls(folder):
    with served(folder) as view, page(view) as link:
        news = json.loads(link.recv(20))["news"]
        assert news["hands"] is False
        link.send(json.dumps({"hand": HELD}))
        with pytest.raises(ConnectionClosed) as end:
            list(link)
    assert end.value.rcvd.code == 1008 and not (folder / HAND).exists()


def test_nothing_pulls_at_a_run_that_has_ended(tmp_path):
    (tmp_path / "fall.txt").write_text(FALL)
    ended = Scene.load(tmp_path / "fall.txt").run(tmp_path / "fall.out").folder
    with served(ended) as view:
        view.puller = Puller(view.tail)
        with page(view) as link:
            say(link, HELD)
    assert not (ended / HAND).exists()


def test_hands_need_one_process(tmp_path, monkeypatch, capsys):
    """And no page that edits."""
    (tmp_path / "fall.txt").write_text(FALL)
    for more, why in ((["-n", "2"], "leave out -n"), (["--edit"], "leave out --edit")):
        with pytest.raises(SystemExit) as end:
            main([str(tmp_path / "fall.txt"), "--hands", *more])
        assert end.value.code == 2 and why in capsys.readouterr().err
