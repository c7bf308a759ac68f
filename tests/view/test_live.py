# SPDX-License-Identifier: GPL-2.0-only
"""A run that is looked at, paused and stopped is the run that it would have been."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from mdanim_lammps import Scene
from mdanim_lammps.results.compare import compare
from mdanim_lammps.results.files import PAUSE, STOP
from mdanim_lammps.results.progress import ProgressTail
from scene_texts import FALL, MEETING
from view_lab import HOLD, Held, page, served


@pytest.fixture
def scene(tmp_path) -> Path:
    (tmp_path / "fall.txt").write_text(FALL)
    return tmp_path / "fall.txt"


def told(link, wanted) -> dict:
    """State of a page once this holds of it."""
    known = {}
    while not wanted(known):
        said = link.recv(60)
        if isinstance(said, str):
            known |= json.loads(said).get("news", {})
    return known


def answers(link, asked: dict) -> dict[str, np.ndarray]:
    """Arrays that the server answers with."""
    link.send(json.dumps(asked))
    while isinstance(said := link.recv(60), str):
        assert "news" in json.loads(said), said
    size = int.from_bytes(said[4:8], "little")
    table = json.loads(said[8 : 8 + size])["buffers"]
    return {name: np.frombuffer(said, dtype, count, 8 + size + at) for name, (dtype, at, count) in table.items()}


def test_bits_do_not_depend_on_a_view(scene, tmp_path):
    """Watched, paused and let go by a page, every frame and the ledger are those of a run that was left alone; curves of the
    paused run are the begin of those at the end."""
    Scene.load(scene).run(tmp_path / "alone")
    run = Held(scene, tmp_path / "seen")
    assert run.wait_for("paused").count == HOLD + 1
    with served(tmp_path / "seen") as view, page(view) as link:
        told(link, lambda known: known.get("state") == "paused")
        for frame in range(HOLD + 1):
            link.send(json.dumps({"get": frame, "layers": 3}))
            assert link.recv(60)[:4] == b"MDF1"
        before = [answers(link, {"curve": ["cube", word]}) for word in ("strain.max", "contact.z")]
        before.append(answers(link, {"arrows": "contact"}))
        assert len(before[0]["value"]) == HOLD + 1 and np.isfinite(before[1]["value"][1:]).all()
        time.sleep(0.5)
        assert run.wait_for("paused").count == HOLD + 1
        link.send('{"do": "go"}')
        told(link, lambda known: known.get("state") == "done")
        after = [answers(link, {"curve": ["cube", word]}) for word in ("strain.max", "contact.z")]
        after.append(answers(link, {"arrows": "contact"}))
    for early, late in zip(before, after):
        for name, values in early.items():
            np.testing.assert_array_equal(late[name][: len(values)], values)
    assert len(after[0]["value"]) == 16
    run.thread.join()
    assert compare(tmp_path / "alone", tmp_path / "seen").equal
    assert (tmp_path / "alone" / "ledger.csv").read_bytes() == (tmp_path / "seen" / "ledger.csv").read_bytes()
    assert not (tmp_path / "seen" / PAUSE).exists()
    held = [p for p in run.words if p.paused]
    assert [(p.frame, p.paused) for p in held] == [(HOLD, str(tmp_path / "seen" / PAUSE))]
    cost = json.loads((tmp_path / "seen" / "cost.json").read_text())
    assert 0.5 < cost["other"]["paused"] < cost["wall"] and cost["effects"]["springs"]["seconds"] < 0.5


def test_a_paused_run_can_be_killed(scene, tmp_path):
    """Everything up to the pause is kept: the run goes on from there, with the same bits."""
    Scene.load(scene).run(tmp_path / "alone")
    folder = tmp_path / "killed"
    code = f"""
from pathlib import Path
from mdanim_lammps import Scene
folder = Path({str(folder)!r})
Scene.load({str(scene)!r}).run(folder, on_progress=lambda p: p.frame == {HOLD} and not p.paused and (folder / "pause").touch())
"""
    process = subprocess.Popen([sys.executable, "-c", code])
    tail = ProgressTail(folder)
    deadline = time.monotonic() + 60
    while tail.state != "paused" and time.monotonic() < deadline:
        tail.read()
        time.sleep(0.01)
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert (folder / PAUSE).exists()
    again = subprocess.run(
        [sys.executable, "-m", "mdanim_lammps", "resume", str(folder), "--no-movie"], capture_output=True, text=True, timeout=100
    )
    assert again.returncode == 0, again.stderr
    assert compare(tmp_path / "alone", folder).equal and not (folder / PAUSE).exists()
    tail.read()
    assert (tail.state, tail.count, tail.lives, tail.keep) == ("done", 16, 2, HOLD + 1)
    tail.close()


@pytest.mark.parametrize("how", ["page", "file"])
def test_a_paused_run_can_be_stopped(scene, tmp_path, how):
    """By the page or by the file: it makes its frame, leaves a checkpoint, and goes on later with the same bits."""
    Scene.load(scene).run(tmp_path / "alone")
    run = Held(scene, tmp_path / "stopped")
    run.wait_for("paused")
    if how == "file":
        (tmp_path / "stopped" / STOP).touch()
    else:
        with served(tmp_path / "stopped") as view, page(view) as link:
            link.send('{"do": "stop"}')
            known = told(link, lambda known: known.get("state") == "stopped")
            assert "mdanim-lammps resume" in known["message"] and known["count"] == HOLD + 2
    run.thread.join()
    assert run.error is not None and (tmp_path / "stopped" / "trajectory.h5.part").exists()
    again = subprocess.run(
        [sys.executable, "-m", "mdanim_lammps", "resume", str(tmp_path / "stopped"), "--no-movie"],
        capture_output=True,
        timeout=100,
    )
    assert again.returncode == 0 and compare(tmp_path / "alone", tmp_path / "stopped").equal


@pytest.mark.mpi
def test_executors_are_paused_too(tmp_path):
    """No frame comes meanwhile; owners and cost are told; the bits are those of a run by one process."""
    (tmp_path / "meeting.txt").write_text(MEETING.replace("time 40 ms", "time 160 ms"))
    Scene.load(tmp_path / "meeting.txt").run(tmp_path / "alone")
    run = Held(tmp_path / "meeting.txt", tmp_path / "two", executors=2)
    count = run.wait_for("paused").count
    time.sleep(1.0)
    assert run.wait_for("paused").count == count < 17
    (tmp_path / "two" / PAUSE).unlink()
    tail = run.wait_for("done")
    run.thread.join()
    assert compare(tmp_path / "alone", tmp_path / "two").equal
    assert tail.executors == 2 and {executor for _, _, executor in tail.owners} <= {-1, 0, 1} and tail.owners
    from mdanim_lammps.results.timeline import Timeline

    assert tail.owners == Timeline.read(tmp_path / "two").owners
    assert {"springs", "waiting", "paused"} <= set(tail.cost)
    cost = json.loads((tmp_path / "two" / "cost.json").read_text())
    assert cost["other"]["paused"] > 1.0 and cost["other"]["held"] < 0.8


def test_the_command_shows_and_waits(scene, tmp_path):
    """``--view`` prints an address that works, is there while a page is open after the run, and gives the run's exit code."""
    folder = tmp_path / "out"
    process = subprocess.Popen(
        [sys.executable, "-m", "mdanim_lammps", str(scene), "--view", "--no-movie", "-o", str(folder)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")},
    )
    try:
        for line in process.stdout:
            if line.startswith("view     http"):
                break
        from websockets.sync.client import connect

        address = line.split()[1]
        origin, _, secret = address.rpartition("/?t=")
        with connect(f"{origin.replace('http', 'ws')}/socket?t={secret}", origin=origin) as link:
            known = told(link, lambda known: known.get("state") == "done")
            assert known["count"] == 16
            assert process.poll() is None
        process.send_signal(signal.SIGINT)
        err = process.communicate(timeout=30)[1]
        assert process.returncode == 0, err
    finally:
        process.kill()


def test_looking_leaves_no_trace(scene, tmp_path):
    """Whatever looks at a run reads its files: the run is asked for nothing, so it cannot be slower for it."""
    Scene.load(scene).run(tmp_path / "a")
    names = {p.name for p in (tmp_path / "a").iterdir()}
    with served(tmp_path / "a") as view, page(view) as link:
        told(link, lambda known: known.get("state") == "done")
        link.send('{"get": 3, "layers": 0}')
        assert np.frombuffer(link.recv(60)[4:8], "<u4") == 3
    assert {p.name for p in (tmp_path / "a").iterdir()} == names
