# SPDX-License-Identifier: GPL-2.0-only
"""Whole runs: what they leave, what they keep when they break, and how they go on."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from mdanim_lammps import Scene, Trajectory
from mdanim_lammps.certificate import Certificate
from mdanim_lammps.errors import DivergedError, OutputError
from mdanim_lammps.results.checkpoint import Checkpoint
from mdanim_lammps.results.compare import compare
from mdanim_lammps.results.ledger import Ledger
from mdanim_lammps.run import frame_source, loop
from mdanim_lammps.run.loop import Interrupted, simulate, write_inputs
from scene_texts import FALL


@pytest.fixture(scope="module")
def fall(tmp_path_factory):
    """A finished run of a falling cube: its folder and result."""
    directory = tmp_path_factory.mktemp("fall")
    (directory / "fall.txt").write_text(FALL)
    return Scene.load(directory / "fall.txt").run()


def test_output_folder_is_complete(fall):
    """Leave every file of the contract, and nothing half written."""
    names = {p.name for p in fall.folder.iterdir()}
    assert {
        "manifest.json",
        "scene.lock.txt",
        "data.fall",
        "in.fall",
        "contact.fall",
        "certificate.json",
        "trajectory.h5",
        "checkpoint",
        "ledger.csv",
        "cost.json",
        "summary.json",
        "progress.jsonl",
    } == names


def test_expectations_are_measured(fall):
    """Evaluate every expect line with a finite value, and meet it."""
    assert len(fall.outcomes) == 4 and not fall.missed
    assert all(np.isfinite(o.found) for o in fall.outcomes)
    assert 0.0 < fall.outcomes[1].found < 0.5 and fall.outcomes[2].found > 0.0


def test_a_missed_expectation_is_reported(tmp_path):
    """Find an expectation missed when it is wrong."""
    (tmp_path / "a.txt").write_text(FALL.replace("cube.position.x at 0.3 s = 0 +- 1 m", "cube.position.z at 0.3 s = 5 m +- 1 m"))
    missed = Scene.load(tmp_path / "a.txt").run().missed
    assert len(missed) == 1 and "MISSED" in str(missed[0])


def test_ledger_adds_up(fall):
    """Keep kinetic + elastic + gravity + contact + wall + losses constant, drag included."""
    ledger = Ledger.read(fall.folder / "ledger.csv")
    assert ledger.terms == ("kinetic", "elastic", "gravity", "contact", "let_go", "wall", "drag_loss")
    assert len(ledger.rows) == 16
    total = sum(ledger.array(t) for t in ledger.terms)
    scale = np.ptp(ledger.array("gravity"))
    assert np.abs(total - total[0]).max() < 5e-3 * scale
    assert ledger.array("contact").max() > 0 and ledger.array("wall").max() > 0 and ledger.array("drag_loss")[-1] > 0
    assert ledger.residual == fall.ledger.residual


def test_trajectory_is_the_state(fall):
    """Store exactly multiples of the frame time, and what the ledger's kinetic energy says."""
    with Trajectory(fall.folder) as t:
        np.testing.assert_allclose(t.times, np.arange(16) / 50.0, rtol=1e-12)
        v = t.velocity(7)
        mass = Scene.load(fall.folder.parent / "fall.txt").prepared.system.mass
        # The ledger's is the leap-frog's own energy, (w dt)^2/24 of a vibration apart: w dt is 1 at half of the bound.
        assert 0.5 * (mass @ (v**2).sum(1)) == pytest.approx(fall.ledger.rows[7]["kinetic"], rel=1e-3)


def test_folder_is_not_overwritten_unasked(fall):
    """Refuse to overwrite; obey force; never delete what is not ours."""
    scene = Scene.load(fall.folder.parent / "fall.txt")
    with pytest.raises(OutputError, match="force=True"):
        scene.run(fall.folder)
    other = fall.folder.parent / "precious"
    other.mkdir()
    (other / "thesis.tex").write_text("years of work")
    with pytest.raises(OutputError, match="does not delete"):
        scene.run(other, force=True)
    assert (other / "thesis.tex").exists()


def test_two_runs_are_equal(fall, tmp_path):
    """Give the same bits twice, and let compare see one changed bit."""
    again = Scene.load(fall.folder.parent / "fall.txt").run(tmp_path / "again.out")
    assert compare(fall.folder, again.folder).equal
    faster = Scene.load(fall.folder.parent / "fall.txt")
    faster.record = __import__("dataclasses").replace(faster.record, gravity=(0.0, 0.0, -9.82))
    other = faster.run(tmp_path / "other.out")
    difference = compare(fall.folder, other.folder)
    assert difference.frame == 1 and difference.distance > 0


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
def test_interrupted_run_resumes_bit_for_bit(fall, tmp_path, sent):
    """Stop a run by a signal, resume it, and get the film of the run that never stopped."""
    text = FALL.replace("frames 50 fps", "frames 50 fps\n  accuracy reference").replace("drag 2", "drag 2\n damping 0.05")
    text = text.replace("resolution 2.5 cm", "resolution 1.25 cm")
    (tmp_path / "long.txt").write_text(text)
    whole = Scene.load(tmp_path / "long.txt").run(tmp_path / "whole.out")
    out = tmp_path / "cut.out"
    process = subprocess.Popen(
        [sys.executable, "-m", "mdanim_lammps", str(tmp_path / "long.txt"), "-o", str(out), "--no-movie"],
        stderr=subprocess.PIPE,
        text=True,
    )
    deadline = time.monotonic() + 60
    while not (out / "checkpoint").exists() and time.monotonic() < deadline:
        time.sleep(0.02)
    process.send_signal(sent)
    error = process.stderr.read()
    if process.wait() == 0:
        pytest.skip("the run ended before the signal came")
    assert process.returncode == 130, error
    assert "mdanim-lammps resume" in error and "Traceback" not in error
    resumed = subprocess.run(
        [sys.executable, "-m", "mdanim_lammps", "resume", str(out), "--no-movie"], capture_output=True, text=True
    )
    assert resumed.returncode in (0, 6), resumed.stderr
    assert compare(whole.folder, out).equal
    # Dashpots see half-step velocities, so what they lose in the step across the cut is known to second order only; energies
    # and drag are known to rounding.
    for cut, row in zip(Ledger.read(out / "ledger.csv").rows, Ledger.read(whole.folder / "ledger.csv").rows, strict=True):
        loss = cut.pop("damping_loss"), row.pop("damping_loss")
        assert loss[0] == pytest.approx(loss[1], rel=1e-3, abs=1e-12)
        del cut["residual"], row["residual"]
        assert cut == pytest.approx(row, rel=1e-12, abs=1e-15)


def test_killed_run_keeps_its_frames(tmp_path):
    """Kill a run without warning and resume from its checkpoint."""
    text = FALL.replace("resolution 2.5 cm", "resolution 7 mm")
    (tmp_path / "long.txt").write_text(text)
    out = tmp_path / "long.out"
    process = subprocess.Popen([sys.executable, "-m", "mdanim_lammps", str(tmp_path / "long.txt"), "--no-movie", "-q"])
    deadline = time.monotonic() + 60
    while not (out / "checkpoint").exists() and time.monotonic() < deadline:
        time.sleep(0.02)
    time.sleep(0.3)
    process.kill()
    process.wait()
    if (out / "summary.json").exists():
        pytest.skip("the run ended before it was killed")
    assert Checkpoint.read(out / "checkpoint").x.shape[1] == 3
    resumed = subprocess.run(
        [sys.executable, "-m", "mdanim_lammps", "resume", str(out), "--no-movie", "-q"], capture_output=True, text=True
    )
    assert resumed.returncode in (0, 6), resumed.stderr
    with Trajectory(out) as t:
        assert len(t) == 16


def test_a_finished_ledger_is_written_once(tmp_path, monkeypatch):
    """With the last checkpoint; before that with the first one alone, in a run that is too short for others."""
    lengths, write = [], Ledger.write
    monkeypatch.setattr(Ledger, "write", lambda self, path: (lengths.append(len(self.rows)), write(self, path)))
    (tmp_path / "a.txt").write_text(FALL.replace("time 0.3 s", "time 0.04 s").split("expect")[0])
    Scene.load(tmp_path / "a.txt").run()
    assert lengths == [1, 3]


def test_no_frame_takes_longer_in_a_long_run(tmp_path, monkeypatch):
    """The table of all frames' steps, which is as long as the run, is made once, not for each frame."""
    made, lengths = [], Certificate.lengths.fget
    monkeypatch.setattr(Certificate, "lengths", property(lambda c: made.append(1) or lengths(c)))
    (tmp_path / "a.txt").write_text(FALL.replace("time 0.3 s", "time 0.1 s").split("expect")[0])
    result = Scene.load(tmp_path / "a.txt").run()
    assert len(result.ledger.rows) > 5 and len(made) == 1


def test_a_run_that_blows_up_keeps_the_last_good_frame(tmp_path):
    """Insist on a step far above the bound: stop with the object, the cause and what to change, and keep the good frames."""
    (tmp_path / "bad.txt").write_text(FALL.replace("time 0.3 s", "time 3 s\n timestep 4 ms"))
    from mdanim_lammps.run.prepare import prepare

    ready = prepare(Scene.load(tmp_path / "bad.txt").record, allow_unstable=True)
    out = tmp_path / "bad.out"
    out.mkdir()
    write_inputs(ready, out)
    with pytest.raises(DivergedError, match="last good frame"):
        simulate(ready, out)
    with Trajectory(out) as t:
        assert len(t) >= 1 and np.isfinite(t.position(len(t) - 1)).all()


def test_summary_says_what_was_run(fall):
    """Summarise the run in plain data."""
    summary = json.loads((fall.folder / "summary.json").read_text())
    assert summary["done"] and summary["objects"] == 2 and summary["frames"] == 16
    assert summary["particles"] == sum(len(m.position) for m in Scene.load(fall.folder.parent / "fall.txt").prepared.models)
    assert all(e["met"] for e in summary["expect"])


def test_disk_full_is_told(fall, tmp_path):
    """End with an OutputError that says how to go on when nothing can be written."""
    full = "/dev/full"
    if not os.path.exists(full) or shutil.disk_usage("/").free == 0:
        pytest.skip("no /dev/full here")
    from mdanim_lammps.results.files import disk_errors

    (tmp_path / "checkpoint").touch()
    with pytest.raises(OutputError, match="make room and resume"), disk_errors(tmp_path / "ledger.csv"), open(full, "w") as file:
        file.write("x" * 100000)


def test_force_never_deletes_a_folder_that_only_looks_like_ours(fall):
    """Leave a folder alone that holds another program's manifest.json."""
    folder = fall.folder.parent / "webapp"
    folder.mkdir()
    (folder / "manifest.json").write_text('{"name": "my web app"}')
    (folder / "index.html").write_text("hello")
    with pytest.raises(OutputError, match="does not delete"):
        Scene.load(fall.folder.parent / "fall.txt").run(folder, force=True)
    assert (folder / "index.html").exists()


def stop_at(frame):
    """A watcher that interrupts the run after this frame, as Ctrl-C does."""

    def watch(progress):
        if progress.frame == frame:
            os.kill(os.getpid(), signal.SIGINT)

    return watch


def test_a_file_named_stop_stops_the_run(tmp_path):
    """Stop as Ctrl-C does, and take the file away, so that the next run is not stopped by it."""
    (tmp_path / "fall.txt").write_text(FALL)
    folder = tmp_path / "fall.out"

    def watch(progress):
        if progress.frame == 2:
            (folder / "stop").touch()

    with pytest.raises(Interrupted, match=rf"resume {folder}\n.* render {folder}$"):
        Scene.load(tmp_path / "fall.txt").run(folder, on_progress=watch)
    assert Checkpoint.read(folder / "checkpoint").frame == 2 and not (folder / "stop").exists()


def test_interrupt_during_an_impact_resumes_bit_for_bit(tmp_path):
    """Stop while objects are pressed together and dashpots work; the resumed film is that of the run that never stopped."""
    text = FALL.replace("drag 2", "drag 2\n damping 0.1").replace("spin (1, 2, 3)", "spin (1, 2, 3)\n damping 0.1")
    (tmp_path / "fall.txt").write_text(text)
    scene = Scene.load(tmp_path / "fall.txt")
    whole = scene.run(tmp_path / "whole.out")
    frame = int(np.argmax(whole.ledger.array("contact")))
    assert whole.ledger.rows[frame]["contact"] > 0 and whole.ledger.rows[frame]["damping_loss"] > 0
    with pytest.raises(Interrupted, match="mdanim-lammps resume"):
        scene.run(tmp_path / "cut.out", on_progress=stop_at(frame))
    checkpoint = Checkpoint.read(tmp_path / "cut.out" / "checkpoint")
    assert checkpoint.frame == frame, "the frame at which it was stopped is the one that is kept"
    resumed = simulate(scene.prepared, tmp_path / "cut.out", resume=checkpoint)
    assert compare(whole.folder, tmp_path / "cut.out").equal
    for term in ("kinetic", "elastic", "contact", "drag_loss"):
        np.testing.assert_allclose(resumed.ledger.array(term), whole.ledger.array(term), rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(resumed.ledger.array("damping_loss"), whole.ledger.array("damping_loss"), rtol=1e-3, atol=1e-9)


def test_pieces_of_frames_change_no_bit(fall, tmp_path, monkeypatch):
    """LAMMPS is left alone for a step at a time."""
    monkeypatch.setattr(frame_source, "PIECE_SECONDS", 0.0)
    simulate(Scene.load(fall.folder.parent / "fall.txt").prepared, tmp_path)
    assert compare(fall.folder, tmp_path).equal


def test_a_second_interrupt_does_not_wait_for_the_frame(tmp_path, monkeypatch):
    """The first one asks for an end after the frame; it says how to go on, and the run does so to the same bits."""
    (tmp_path / "fall.txt").write_text(FALL)
    scene = Scene.load(tmp_path / "fall.txt")
    whole, folder = scene.run(tmp_path / "whole.out"), tmp_path / "cut.out"
    windows, run_window = [], frame_source.run_window
    frame = scene.certificate.steps_per_frame

    def window(instance, steps):
        run_window(instance, steps)
        windows.append(steps)
        if len(windows) in (3 * frame + 2, 3 * frame + 5):
            os.kill(os.getpid(), signal.SIGINT)

    monkeypatch.setattr(frame_source, "run_window", window)
    monkeypatch.setattr(frame_source, "PIECE_SECONDS", 0.0)
    monkeypatch.setattr(loop, "CHECKPOINT_SECONDS", 0.0)
    with pytest.raises(Interrupted, match=f"within a frame; go on with: mdanim-lammps resume {folder}"):
        scene.run(folder)
    assert len(windows) == 3 * frame + 5 and set(windows) == {1}
    checkpoint = Checkpoint.read(folder / "checkpoint")
    assert checkpoint.frame == 3
    simulate(scene.prepared, folder, resume=checkpoint)
    assert compare(whole.folder, folder).equal


AT_REST = """
object a {{ shape {shape} position (0, 0, 1) m density 1000 kg/m^3 elasticity 1 MPa }}
control {{ time 3 s  frames 2 fps  {control} }}
"""


@pytest.mark.parametrize(
    ("shape", "control"),
    [("sphere 10 cm", ""), ("box (10, 10, 10) cm", "accuracy preview"), ("torus 20 cm 5 cm", "save boundary")],
)
def test_a_scene_at_rest_is_resumed(tmp_path, shape, control):
    """Where rounding alone moves something the ledger counts from its floor, which its file does not hold."""
    (tmp_path / "rest.txt").write_text(AT_REST.format(shape=shape, control=control))
    scene = Scene.load(tmp_path / "rest.txt")
    whole = scene.run(tmp_path / "whole.out")
    assert any(row["residual"] for row in whole.ledger.rows), "rounding is seen"
    with pytest.raises(Interrupted, match="mdanim-lammps resume"):
        scene.run(tmp_path / "cut.out", on_progress=stop_at(3))
    resumed = simulate(scene.prepared, tmp_path / "cut.out", resume=Checkpoint.read(tmp_path / "cut.out" / "checkpoint"))
    assert compare(whole.folder, tmp_path / "cut.out").equal
    assert resumed.ledger.rows == whole.ledger.rows
    stored = Ledger.read(tmp_path / "cut.out" / "ledger.csv")
    assert stored.rows == whole.ledger.rows and stored.residual < 1e-3


def test_a_checkpoint_of_another_run_is_refused(fall, tmp_path):
    """Refuse to go on with another time step: its steps would mean other times."""
    checkpoint = Checkpoint.read(fall.folder / "checkpoint")
    (tmp_path / "fall.txt").write_text(FALL.replace("frames 50 fps", "frames 50 fps\n timestep 0.1 ms"))
    with pytest.raises(OutputError, match="another run"):
        simulate(Scene.load(tmp_path / "fall.txt").prepared, tmp_path, resume=checkpoint)


@pytest.mark.parametrize(
    "damage",
    [
        pytest.param(lambda b: b"", id="empty"),
        pytest.param(lambda b: b[: len(b) // 2], id="half"),
        pytest.param(lambda b: b"nonsense", id="no archive"),
    ],
)
def test_a_damaged_checkpoint_is_told(fall, tmp_path, damage):
    """Say that there is nothing to resume from."""
    (tmp_path / "checkpoint").write_bytes(damage((fall.folder / "checkpoint").read_bytes()))
    with pytest.raises(OutputError, match="nothing to resume from"):
        Checkpoint.read(tmp_path / "checkpoint")


def test_a_title_may_hold_any_letter(tmp_path):
    """Write LAMMPS's files in ASCII whatever the title and the name of the scene."""
    (tmp_path / "würfel.txt").write_text('title "Würfel fällt"\n' + FALL)
    scene = Scene.load(tmp_path / "würfel.txt")
    write_inputs(scene.prepared, tmp_path)
    assert (tmp_path / "data.w_rfel").read_bytes().isascii() and (tmp_path / "in.w_rfel").read_bytes().isascii()
    assert "Würfel" in (tmp_path / "scene.lock.txt").read_text(encoding="utf-8")


def test_strong_air_drag_decays_without_overshoot(tmp_path):
    """Take drag exponentially, with a warning, where the implicit form would turn the velocity round every step."""
    (tmp_path / "feather.txt").write_text("""
        object feather {
          shape box (4, 4, 4) cm
          position (0, 0, 0) m
          density 10
          elasticity 1 kPa
          velocity (1, 0, 0)
          drag 5
        }
        control {
          time 0.1 s
          frames 100 fps
        }
    """)
    scene = Scene.load(tmp_path / "feather.txt")
    assert [w.message for w in scene.prepared.warnings if "air drag is strong" in w.message]
    scene.run()
    with Trajectory(tmp_path / "feather.out") as t:
        v = t.center_velocities[:, 0, 0]
    assert v[0] == pytest.approx(1.0) and np.abs(v[1:]).max() < 1e-12


# --- liquid -------------------------------------------------------------------------------------------------

SPLASH = """
gravity (0, 0, -9.81) m/s^2
liquid water {
  basin from (-30, -30, 0) cm to (30, 30, 50) cm
  density 1000
  volume 90 l
  model surface
}
object raft {
  shape box (20, 20, 10) cm
  position (0, 0, 36) cm
  orientation euler (0, 15, 0) deg
  density 500
  elasticity 100 kPa
  drag 5
}
control {
  time 1.2 s
  frames 25 fps
  resolution 2.5 cm
}
expect raft.draft at 1.2 s = 5 cm +- 2 cm
expect liquid.residual = 0
expect liquid.volume = 90 l +- 0.01 l
expect liquid.level at 1.2 s = 25.6 cm +- 0.5 cm
"""


@pytest.fixture(scope="module")
def splash(tmp_path_factory):
    """A finished run of a raft that falls into a liquid."""
    directory = tmp_path_factory.mktemp("splash")
    (directory / "splash.txt").write_text(SPLASH)
    return Scene.load(directory / "splash.txt").run()


def test_a_liquid_meets_its_expectations(splash):
    """Measure draft, level, volume and residual of the liquid."""
    assert len(splash.outcomes) == 4 and not splash.missed, splash.missed


def test_ledger_of_a_liquid_adds_up(splash):
    """Keep energy with the work of buoyancy in it, count drag of air and liquid once, and every cell."""
    ledger = Ledger.read(splash.folder / "ledger.csv")
    assert ledger.terms == ("kinetic", "elastic", "gravity", "wall", "drag_loss", "buoyancy")
    assert ledger.extras == ("draft.raft", "liquid_cells")
    assert set(ledger.array("liquid_cells")) == {5760}
    assert ledger.array("drag_loss")[-1] > 1.0 and np.ptp(ledger.array("buoyancy")) > 1.0
    # Counted twice, the loss alone would make a residual of a half.
    assert ledger.residual < 1e-3


def test_frames_are_read_again_only_where_a_line_asks(tmp_path, monkeypatch):
    """The level of a liquid needs all its frames after the run: no other line does."""
    text = SPLASH.split("expect")[0].replace("time 1.2 s", "time 0.05 s")
    monkeypatch.setattr(Trajectory, "liquid_height", lambda *_: pytest.fail("read"))
    (tmp_path / "splash.txt").write_text(text + "expect liquid.volume = 0.09 +- 0.01 m^3\n")
    assert not Scene.load(tmp_path / "splash.txt").run().missed


def test_heights_of_a_liquid_are_stored(splash):
    """Keep both heights of every frame: flat at the start, risen by what the raft displaces at the end."""
    with Trajectory(splash.folder) as t:
        assert t.liquid.shape == (24, 24, 20) and t.liquid_height(0).shape == (24, 24)
        assert np.ptp(t.liquid_height(0)) < 1e-6
        # Archimedes: half of 4 l over 0.36 m^2.
        assert t.liquid_levels[-1] - t.liquid_levels[0] == pytest.approx(0.002 / 0.36, abs=0.002)
        assert np.isnan(t.liquid_raw(len(t) - 1)).any()


def test_cost_of_a_liquid_is_split(splash):
    """Tell flow, occupancy and coupling apart, and give no second twice."""
    clocks = splash.cost.effects["liquid"].clocks
    assert set(clocks) == {"flow", "occupancy"} and all(seconds > 0.0 for seconds in clocks.values())
    assert splash.cost.parts["buoyancy"] > 0.0
    assert splash.cost.parts["liquid"] == pytest.approx(sum(clocks.values()))
    summary = json.loads((splash.folder / "summary.json").read_text())
    assert (summary["liquid_cells"], summary["liquid_residual"]) == (5760, 0)


@pytest.mark.parametrize("frame", [pytest.param(5, id="in the splash"), pytest.param(28, id="afloat")])
def test_interrupt_in_a_liquid_resumes_bit_for_bit(splash, tmp_path, frame):
    """Stop while the liquid moves; the resumed film, heights included, is that of the run that never stopped."""
    scene = Scene.load(splash.folder.parent / "splash.txt")
    with pytest.raises(Interrupted):
        scene.run(tmp_path / "cut.out", on_progress=stop_at(frame))
    checkpoint = Checkpoint.read(tmp_path / "cut.out" / "checkpoint")
    assert checkpoint.frame == frame and list(checkpoint.records) == ["basin", "liquid"]
    resumed = simulate(scene.prepared, tmp_path / "cut.out", resume=checkpoint)
    assert compare(splash.folder, tmp_path / "cut.out").equal
    for term in (*resumed.ledger.terms, *resumed.ledger.extras):
        np.testing.assert_allclose(resumed.ledger.array(term), splash.ledger.array(term), rtol=1e-9, atol=1e-12, err_msg=term)


def test_a_liquid_without_anything_that_moves_levels(tmp_path):
    """Let a dam of liquid run down beside a held block, a little in every frame, though nothing in the scene vibrates."""
    (tmp_path / "dam.txt").write_text(
        SPLASH.split("expect")[0]
        .replace("drag 5", "hold all")
        .replace("volume 90 l", "volume 45 l\n  fill from (-30, -30, 0) cm to (0, 30, 50) cm")
    )
    Scene.load(tmp_path / "dam.txt").run()
    with Trajectory(tmp_path / "dam.out") as t:
        assert np.ptp(t.liquid_height(0)) > 0.1 and np.ptp(t.liquid_height(len(t) - 1)) < 0.03
        changes = [np.abs(t.liquid_height(i + 1) - t.liquid_height(i)).max() for i in range(6)]
        assert min(changes) > 1e-3
