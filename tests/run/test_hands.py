# SPDX-License-Identifier: GPL-2.0-only
"""Hands on a run that goes on are kept as lines of a scene: with these it is the same run, also on executors, and when it was
stopped and resumed."""

import json
import os
import shutil
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mdanim_lammps import Scene
from mdanim_lammps.errors import OutputError, UsageError
from mdanim_lammps.results.checkpoint import Checkpoint
from mdanim_lammps.results.compare import compare
from mdanim_lammps.results.files import CHECKPOINT, HAND, HANDS, PAUSE, STOP
from mdanim_lammps.results.ledger import Ledger
from mdanim_lammps.run import hands
from mdanim_lammps.run.folder import open_run
from mdanim_lammps.run.hands import SILENT, read_request
from mdanim_lammps.run.loop import Interrupted, simulate
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

SCENE = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
object ball  { shape sphere 5 cm         position (0, 0, 6) cm   density 1000  elasticity 300 kPa }
object crate { shape box (8, 8, 8) cm    position (30, 0, 4) cm  density 700   elasticity rigid }
control { time 0.18 s  frames 100 fps  friction 0.5  resolution 4 cm }
"""
BALL = {"object": "ball", "at": [0.03, 0.0, 0.1]}
CRATE = {"object": "crate", "at": [0.34, 0.03, 0.08]}


def ask(folder: Path, asked: dict | None) -> None:
    if asked is None:
        (folder / HAND).unlink(missing_ok=True)
    else:
        (folder / HAND).write_text(json.dumps(asked))


def hand(frame: int) -> dict | None:
    """Pulls at the ball, lets go, and pulls at the crate at once from frame 10 on."""
    if 2 <= frame < 10:
        return BALL | {"to": [0.03, 0.01 * frame, 0.1 + 0.01 * frame]}
    return CRATE | {"to": [0.34, 0.03, 0.2]} if 10 <= frame < 17 else None


def pulled(folder: Path, *, stop: int | None = None, resume: bool = False, live: bool = True):
    """The run with hands; its page says "go on" at once."""
    ready = prepare(replace(parse_scene(SCENE, "toys"), steerable=True))

    def on_progress(p):
        (folder / PAUSE).unlink(missing_ok=True)
        ask(folder, hand(p.frame))
        if p.frame == stop:
            (folder / STOP).touch()

    if resume:
        return simulate(ready, folder, on_progress=on_progress, resume=Checkpoint.read(folder / CHECKPOINT), hands=live)
    with open_run(ready, folder, force=False, draws=False):
        return simulate(ready, folder, on_progress=on_progress, hands=live)


def works(folder: Path) -> list[float]:
    """Work of the hands frame by frame [J]."""
    return Ledger.read(folder / "ledger.csv").array("work").tolist()


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("hands") / "toys.out"
    pulled(folder)
    return folder


def test_its_lines_give_the_same_bits(run, tmp_path):
    """The ledger too; the hands have done work, and the crate was lifted."""
    (tmp_path / "toys.txt").write_text(f'{SCENE}include "{run / HANDS}"\n')
    again = Scene.load(tmp_path / "toys.txt").run(tmp_path / "again.out")
    assert compare(run, again.folder).equal
    assert (run / "ledger.csv").read_bytes() == (again.folder / "ledger.csv").read_bytes()
    ledger = again.ledger
    assert ledger.array("work")[-1] > 0.1 and np.abs(ledger.array("residual")).max() < 1e-3
    assert again.trajectory.centers[16, 1, 2] > 0.042


@pytest.mark.mpi
@pytest.mark.soak
def test_its_lines_give_the_same_bits_on_executors(run, tmp_path):
    (tmp_path / "toys.txt").write_text(f'{SCENE}include "{run / HANDS}"\n')
    again = Scene.load(tmp_path / "toys.txt").run(tmp_path / "again.out", executors=2)
    assert compare(run, again.folder).equal


@pytest.mark.parametrize("stop", [5, 10])
def test_a_run_that_was_stopped_goes_on_the_same(run, tmp_path, stop, monkeypatch):
    """Stopped while a hand pulls or as it lets go, and resumed with the hand; and what was kept of frames behind the checkpoint
    is done again, without a page. The hand's work between checkpoint and next step is not lost."""
    folder, on_disk = tmp_path / "toys.out", []
    monkeypatch.setattr(hands, "sync", lambda path: on_disk.append(path.read_bytes()))
    with pytest.raises(Interrupted):
        pulled(folder, stop=stop)
    assert on_disk[-1] == (folder / HANDS).read_bytes()  # before the checkpoint
    kept, lines = (folder / CHECKPOINT).read_bytes(), (folder / HANDS).read_text()
    assert lines.endswith("}\n") and lines.count("key") == stop - 1
    (folder / HANDS).write_bytes((run / HANDS).read_bytes())  # of a run that was killed later
    pulled(folder, resume=True, live=False)
    assert compare(run, folder).equal and works(folder) == pytest.approx(works(run), rel=1e-14)
    (folder / CHECKPOINT).write_bytes(kept)
    for torn in (b"  key 0.06 s at (0.0", b"\xff\n}\n"):
        (folder / HANDS).write_bytes(lines.removesuffix("}\n").encode() + torn)
        with pytest.raises(OutputError, match=rf"hands\.txt is damaged: keep its first {lines.count(chr(10)) - 1} lines"):
            pulled(folder, resume=True, live=False)
    (folder / HANDS).write_text(lines.replace("0.03", "0.04"))
    with pytest.raises(OutputError, match="hands\\.txt is damaged: it is not the one of the checkpoint"):
        pulled(folder, resume=True, live=False)


def test_lines_of_hands_are_read_up_to_a_length(run, tmp_path, monkeypatch):
    """As long as a scene may be, and not through a link."""
    folder = shutil.copytree(run, tmp_path / "toys.out")
    monkeypatch.setattr(hands, "MOST_BYTES_OF_LINES", (folder / HANDS).stat().st_size - 1)
    with pytest.raises(OutputError, match=r"hands\.txt is damaged: it has more than"):
        pulled(folder, resume=True, live=False)
    (folder / HANDS).unlink()
    (folder / HANDS).symlink_to(run / HANDS)
    with pytest.raises(OutputError, match=r"hands\.txt is a link"):
        pulled(folder, resume=True, live=False)


def test_executors_do_not_go_on_with_it(run):
    from mdanim_lammps.parallel.frames import run_frames

    ready = prepare(replace(parse_scene(SCENE, "toys"), steerable=True))
    with pytest.raises(UsageError, match="a run with hands goes on in one process, not on executors: leave out -n"):
        run_frames(ready, run, executors=2, resume=Checkpoint.read(run / CHECKPOINT))


def test_a_hand_is_no_faster_than_its_certificate(run):
    """And begins where its point is."""
    scene = parse_scene(f"{SCENE}{(run / HANDS).read_text()}", "toys")
    ball, crate = scene.held_by
    assert (ball.object, crate.object) == ("ball", "crate") and ball.at == (0.03, 0.0, 0.1)
    for one, radius, waves in ((ball, 0.05, (300e3 / 1000) ** 0.5), (crate, 3**0.5 * 0.04, np.inf)):
        times = np.diff([key.time for key in one.keys])
        speed = np.linalg.norm(np.diff([key.at for key in one.keys], axis=0), axis=1) / times
        assert speed.max() <= (1 + 1e-9) * min(0.1 * waves, 2.0 * (9.81 * radius) ** 0.5)
    assert np.linalg.norm(np.subtract(crate.keys[0].at, CRATE["at"])) < 2e-3


def test_only_requests_of_the_form_are_read(tmp_path):
    """Other words, links, pipes, and a file of which nothing was heard for long, do nothing."""
    path, good = tmp_path / HAND, BALL | {"to": [0, 0, 1]}
    assert read_request(path) is None
    ask(tmp_path, good)
    assert read_request(path) == ("ball", (0.03, 0.0, 0.1), (0, 0, 1))
    for wrong in ([], {}, good | {"to": [0, 0]}, good | {"to": [0, 0, 1e10]}, good | {"at": ["0", 0, 0]}, good | {"object": 3}):
        path.write_text(json.dumps(wrong))
        assert read_request(path) is None
    for text in ("", "{", '{"object": "ball", "at": [0, 0, NaN], "to": [0, 0, 1]}', json.dumps(good) + " " * 5000):
        path.write_text(text)
        assert read_request(path) is None
    ask(tmp_path, good)
    os.utime(path, (time.time() - SILENT - 1.0,) * 2)
    assert read_request(path) is None
    path.rename(tmp_path / "other")
    (tmp_path / "other").touch()
    path.symlink_to(tmp_path / "other")
    assert read_request(path) is None
    path.unlink()
    os.mkfifo(path)
    assert read_request(path) is None
