# SPDX-License-Identifier: GPL-2.0-only
"""Studies: what they leave, how they stop and go on, and what they promise of the program."""

import io
import json
import math
import signal
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from mdanim_lammps import Scene
from mdanim_lammps.certificate import fit_steps
from mdanim_lammps.cli.scene_commands import study as study_command
from mdanim_lammps.errors import DivergedError, OutputError, RefusedError, UsageError
from mdanim_lammps.features.liquid.record import LiquidModel
from mdanim_lammps.run.loop import Interrupted, simulate
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import load_scene, parse_scene
from mdanim_lammps.scene.scene import Accuracy
from mdanim_lammps.study import bench
from mdanim_lammps.study.measure import Sample, TooLong, measure
from mdanim_lammps.study.setting import LADDERS, Setting, ladders, own_setting, same_frames, scene_hash, with_setting
from mdanim_lammps.study.store import Store
from mdanim_lammps.study.study import run_study
from study_lab import BAR, TIMES, track

BLOCKS = """
object a {{ shape box (10, 10, 10) cm  position (-8, 0, 0) cm   density 1000  elasticity 1 MPa  velocity ({v}, 0, 0) }}
object b {{ shape box (10, 10, 10) cm  position (8, 1, 0.5) cm  density 1000  elasticity 1 MPa  velocity (-{v}, 0, 0) }}
control {{ time 0.04 s  frames 1000 fps }}
"""
WAVE = math.sqrt(1.2 * 1e6 / 1000.0)


@pytest.fixture(scope="module")
def bar_file(tmp_path_factory):
    """The bar as a file."""
    path = tmp_path_factory.mktemp("bar") / "bar.txt"
    path.write_text(BAR)
    return path


@pytest.fixture(scope="module")
def bar_study(bar_file):
    """A study of the bar, with every point within its budget."""
    return Scene.load(bar_file).study(budget=30.0)


def test_study_leaves_its_files(bar_study, bar_file):
    """Keep points, errors, seconds and the order of each ladder, a table and a picture, and no temporary folder."""
    folder = bar_file.parent / "bar.out" / "study"
    assert bar_study.folder == folder
    assert sorted(p.name for p in folder.iterdir()) == ["study.csv", "study.json", "study.png", "tracks"]
    data = json.loads((folder / "study.json").read_text())
    assert {"hash", "points", "ladders", "advice", "left_out", "own"} <= set(data)
    assert all({"error", "seconds", "seconds_spread", "pareto", "energy_drift", "expect_error"} <= set(p) for p in data["points"])
    assert data["ladders"]["time step"]["order"] == bar_study.analysis.ladders["time step"].order
    assert (folder / "study.png").read_bytes().startswith(b"\x89PNG")
    rows = (folder / "study.csv").read_text().splitlines()
    assert len(rows) == 1 + len(data["points"])
    assert set(data["left_out"]) == {"sweeps", "contact", "rigid"}


def test_ladders_of_a_bar(bar_study):
    """Vary one thing at a time around the scene's own setting: 0.7 to 0.125 of the bound, half to twice the cells."""
    own = bar_study.analysis.own
    assert own.cells == 4 and own.fraction == pytest.approx(0.5, abs=0.01)
    steps, cells = bar_study.analysis.measured["time step"], bar_study.analysis.measured["resolution"]
    assert {s.cells for s in steps} == {4}
    assert [s.fraction for s in steps] == sorted((s.fraction for s in steps), reverse=True)
    assert steps[0].fraction == pytest.approx(0.7, abs=0.02) and steps[-1].fraction == pytest.approx(0.125, abs=0.005)
    assert [s.cells for s in cells] == [2, 3, 4, 6, 8]


def test_time_step_has_order_two(bar_study):
    """Converge as leap-frog does, eq. (3.12): 2.0 +- 0.2."""
    assert bar_study.analysis.ladders["time step"].order == pytest.approx(2.0, abs=0.2)


def test_resolution_is_what_costs_accuracy(bar_study):
    """See errors fall with the cells, about as h/t, and far above those of the time step."""
    found = bar_study.analysis.ladders["resolution"]
    assert list(found.errors) == sorted(found.errors, reverse=True)
    # Bending itself is right from 2 cells on; what is left is the clamp, whose corners converge slowly.
    assert 0.9 < found.order < 1.5
    assert "most of the error from the resolution" in bar_study.advice


def test_study_repeats_and_shows_spread(bar_study):
    """Run the cheapest points three times within the budget; without a liquid only seconds can differ."""
    cheapest = next(iter(bar_study.analysis.rated.values()))
    assert len(cheapest.point.seconds) == bench.REPEATS
    assert cheapest.seconds.middle == min(cheapest.point.seconds)
    assert cheapest.seconds.spread >= np.median(cheapest.point.seconds) - min(cheapest.point.seconds) > 0.0
    assert all(np.array_equal(t, cheapest.point.tracks[0]) for t in cheapest.point.tracks)


def test_study_goes_on(bar_study, bar_file, monkeypatch):
    """Measure nothing again that is there, and come to the same result."""

    def refuse(*_, **__):
        raise AssertionError("measured again")

    monkeypatch.setattr(bench, "measure", refuse)
    monkeypatch.setattr(bench, "REPEATS", 1)
    again = Scene.load(bar_file).study(budget=30.0)
    assert again.advice == bar_study.advice
    assert again.analysis.rated.keys() == bar_study.analysis.rated.keys()


def test_study_of_a_changed_scene_is_refused(bar_study, bar_file):
    """Keep a study of another scene unless told otherwise; accuracy, pictures and title change no motion."""
    scene = load_scene(bar_file)
    stiffer = parse_scene(BAR.replace("2 MPa", "3 MPa"))
    assert scene_hash(scene) != scene_hash(stiffer)
    other = BAR.replace("frames 100 fps", "frames 100 fps\n accuracy preview") + 'title "a bar"\nrender { background white }\n'
    assert scene_hash(parse_scene(other)) == scene_hash(scene)
    with pytest.raises(OutputError, match="force=True"):
        Store(bar_study.folder, scene_hash(stiffer))


def test_run_leaves_the_study_alone(tmp_path, monkeypatch):
    """Start a run in a folder that holds nothing but a study, and keep it when a run is made again by force."""
    (tmp_path / "bar.txt").write_text(BAR)
    monkeypatch.setattr(bench, "REPEATS", 1)
    scene = Scene.load(tmp_path / "bar.txt")
    scene.study(budget=5.0, ladders=["time step"])
    before = (tmp_path / "bar.out" / "study" / "study.json").read_bytes()
    scene.run()
    scene.run(force=True)
    assert (tmp_path / "bar.out" / "study" / "study.json").read_bytes() == before
    assert (tmp_path / "bar.out" / "trajectory.h5").exists()


def test_ctrl_c_keeps_what_is_there(tmp_path, monkeypatch):
    """Stop after the point that Ctrl-C fell into, keep all before it, and say how to go on."""
    scene = parse_scene(BAR)
    count = 0

    def interrupted(*arguments, **options):
        nonlocal count
        if (count := count + 1) == 3:
            options["on_progress"] = lambda p: signal.raise_signal(signal.SIGINT)
        return simulate(*arguments, **options)

    monkeypatch.setattr("mdanim_lammps.study.measure.simulate", interrupted)
    with pytest.raises(Interrupted, match="the same command continues"):
        run_study(scene, tmp_path / "study", budget=30.0)
    assert len(json.loads((tmp_path / "study" / "study.json").read_text())["points"]) == 2
    assert sorted(p.name for p in (tmp_path / "study").iterdir()) == ["study.json", "tracks"]


def test_a_run_that_takes_too_long_is_stopped(tmp_path, monkeypatch):
    """Break off by the run's own pace and leave nothing behind."""
    monkeypatch.setattr("mdanim_lammps.study.measure.PACE_SECONDS", 0.0)
    with pytest.raises(TooLong) as stopped:
        measure(parse_scene(BAR), Setting(4, 0.5), tmp_path, limit=1e-3)
    assert stopped.value.seconds > 1e-3
    assert list(tmp_path.iterdir()) == []


@pytest.fixture
def clock(monkeypatch):
    """Runs that claim 0.5 s at 4 cells and half of the bound, elsewhere by particle-steps, on a clock of their own."""
    now = [0.0]

    def took(scene, setting, *_, **__):
        wall = 0.5 * (setting.cells / 4.0) ** 4 * 0.5 / setting.fraction
        now[0] += wall
        return Sample(setting, 1e-3, 100, 10, wall, wall, 0.0, 0.0, (0.0,), TIMES, track(1.0 + setting.cells**-2))

    monkeypatch.setattr(bench, "measure", took)
    monkeypatch.setattr(bench, "time", SimpleNamespace(perf_counter=lambda: now[0]))
    return now


def test_small_budget_measures_the_own_setting_and_the_cheapest(clock, tmp_path):
    """Leave room for the scene's own setting, say of the others what they would take, and keep to the budget."""
    study = run_study(parse_scene(BAR), tmp_path / "study", budget=1.0)
    assert sorted(r.point.setting.cells for r in study.analysis.rated.values()) == [2, 3, 4]
    assert study.analysis.own.key in study.analysis.rated
    assert sum("would take about" in why for why in study.left_out.values()) == 7
    assert 0.7 < clock[0] <= 1.0  # repeats fill what points leave


def test_what_a_run_takes_to_start_does_not_grow_with_its_work(clock, tmp_path, monkeypatch):
    """A second of modelling and writing beside 0.03 s of simulation: 16 times the work is half a second more, not 16 s."""
    simulated = bench.measure

    def slow_to_start(*arguments, **options):
        sample = simulated(*arguments, **options)
        return replace(sample, wall=sample.seconds + 1.0)

    monkeypatch.setattr(bench, "measure", slow_to_start)
    study = run_study(parse_scene(BAR), tmp_path / "study", budget=8.0)
    assert study.analysis.own.key in study.analysis.rated
    assert sum("would take about" in why for why in study.left_out.values()) < 7


def test_budget_too_small_for_the_own_setting(clock, tmp_path):
    """Refuse, and say what it would take."""
    with pytest.raises(RefusedError, match=r"would take about 0\.5.*budget"):
        run_study(parse_scene(BAR), tmp_path / "study", budget=0.3)


def test_a_setting_becomes_spacing_and_time_step():
    """Put cells across the thinnest part and the share of the bound at that spacing into the scene."""
    scene = with_setting(parse_scene(BAR), Setting(5, 0.3))
    assert scene.control.resolution == pytest.approx(0.02, rel=1e-12)
    certificate = prepare(scene).certificate
    assert 0.28 < certificate.fraction <= 0.3 + 1e-8  # a whole number of steps per frame


def test_a_setting_that_diverges_is_told(tmp_path, monkeypatch):
    """Go on with the other points, say what went wrong, and keep runs that a repeat of the same setting has spoilt."""
    count = {}

    def breaks(scene, setting, *arguments, **options):
        count[setting.cells] = count.get(setting.cells, 0) + 1
        if setting.cells == 2 or (setting.cells == 3 and count[3] == 2):
            raise DivergedError("step 7: folded up\n  change: nothing")
        return measure(scene, setting, *arguments, **options)

    monkeypatch.setattr(bench, "measure", breaks)
    monkeypatch.setattr(bench, "time", SimpleNamespace(perf_counter=lambda: 0.0))  # the budget lasts, however busy the machine is
    study = run_study(parse_scene(BAR), tmp_path / "study", budget=3.0, only=["resolution"])
    told = {name.split()[0]: why for name, why in study.left_out.items()}
    assert told["2"] == told["3"] == "step 7: folded up"
    assert sorted(r.point.setting.cells for r in study.analysis.rated.values())[:2] == [3, 4]


def test_unknown_ladder(tmp_path):
    """Name the ladders there are."""
    with pytest.raises(UsageError, match="time step, resolution, sweeps"):
        run_study(parse_scene(BAR), tmp_path / "study", only=["dt"])


def test_help_names_all_ladders():
    """Each that ``--ladders`` takes."""
    assert all(name in study_command.__doc__ for name in LADDERS)


def test_ladders_of_what_a_scene_has(scenes):
    """Vary sweeps only with an automaton, contact only where something may touch, and say why not elsewhere."""
    pool = load_scene(scenes / "float.txt")
    automaton = replace(pool, liquid=replace(pool.liquid, model=LiquidModel.SURFACE))
    others = ((load_scene(scenes / f"{name}.txt"), own) for name, own in (("beam", {"contact", "rigid"}), ("spin", {"rigid"})))
    for scene, own in ((automaton, {"sweeps", "rigid"}), (pool, {"rigid"}), *others):
        ready = prepare(scene)
        found, left = ladders(scene, ready, own_setting(scene, ready))
        assert {ladder.name for ladder in found} == {"time step", "resolution", *own}
        assert set(left) == {"sweeps", "contact", "rigid"} - own
    assert left["contact"] == "nothing touches: one object, and there is neither ground nor walls"


def test_contact_ladder_goes_with_the_scene(prepared):
    """Take a quarter to eight times what the scene says, within what the language takes, softest first."""
    for said, factors in (
        ("", [0.25, 0.5, 1, 2, 4, 8]),
        ("contact-stiffness 0.3", [0.15, 0.3, 0.6, 1.2, 2.4]),
        ("contact-stiffness 40", [10, 20, 40, 80]),
    ):
        ready = prepared(BLOCKS.format(v=1.0).replace("1000 fps", f"1000 fps {said}"))
        own = own_setting(ready.scene, ready)
        found, _ = ladders(ready.scene, ready, own)
        ladder = next(ladder for ladder in found if ladder.name == "contact")
        assert [s.contact for s in ladder.settings] == pytest.approx(factors)
        assert own in ladder.settings
        steps = [ladder.step(s) for s in ladder.settings]
        assert steps == sorted(steps, reverse=True)
        assert with_setting(ready.scene, ladder.settings[0]).control.contact_stiffness == pytest.approx(factors[0])
    assert scene_hash(ready.scene) == scene_hash(parse_scene(BLOCKS.format(v=1.0), "blocks"))


def test_contact_ladder_trades_depth_for_time(tmp_path, monkeypatch):
    """Sink in less the stiffer contact is, in shorter time steps, and tell both in table, files and plot."""
    from mdanim_lammps.study.report import table
    from rich.console import Console

    monkeypatch.setattr(bench, "REPEATS", 1)
    scene = parse_scene(BLOCKS.format(v=0.2 * WAVE).replace("1000 fps", "1000 fps contact-model paper"))
    study = run_study(scene, tmp_path / "study", budget=30.0, only=["contact"])
    points = [study.points[s.key] for s in study.analysis.measured["contact"]]
    assert [p.setting.contact for p in points] == [0.25, 0.5, 1, 2, 4, 8]
    deep = [p.penetration[0] for p in points]
    assert deep == sorted(deep, reverse=True) and deep[0] > 4.0 * deep[2]
    assert [p.steps for p in points] == sorted(p.steps for p in points) and points[-1].steps > 1.8 * points[2].steps
    errors = study.analysis.ladders["contact"].errors
    assert errors[0] > 2.0 * errors[2] > 2.0 * errors[4]
    rows = json.loads((tmp_path / "study" / "study.json").read_text())["points"]
    assert sorted(r["penetration"] for r in rows) == sorted(deep)
    assert "penetration" in (tmp_path / "study" / "study.csv").read_text().splitlines()[0].split(",")
    console = Console(width=200, file=io.StringIO())
    console.print(table(study))
    assert "sunk in" in console.file.getvalue()
    again = Store(tmp_path / "study", scene_hash(scene))
    assert {k: p.penetration for k, p in again.points.items()} == {k: p.penetration for k, p in study.points.items()}


def test_liquid_repeats_have_another_seed(scenes, tmp_path):
    """Let repeats of a scene with an automaton differ, so that the spread of its errors is seen."""
    scene = load_scene(scenes / "float.txt")
    liquid = replace(scene.liquid, model=LiquidModel.SURFACE)
    scene = replace(scene, liquid=liquid, control=replace(scene.control, time=0.4), expects=())
    a, b, again = (measure(scene, Setting(2, 0.5), tmp_path, repeat=k).center for k in (0, 1, 0))
    assert np.array_equal(a, again)
    assert not np.array_equal(a, b)
    ready = prepare(scene)
    store = Store(tmp_path / "study", scene_hash(scene))
    runs = bench.Bench(scene, ready, own_setting(scene, ready), store, 10.0, lambda line: None)
    for _ in range(2):
        runs.measure(Setting(2, 0.5))
    assert not np.array_equal(*store.points["c2-f0.5"].tracks)


@pytest.mark.parametrize(("time", "frames"), [("0.20371 s", 20), ("0.2 s", 20), ("0.195 s", 19)])
def test_settings_of_a_study_have_the_same_frames(time, frames):
    """Whether a last, shorter frame follows depends on the time step: 500 steps in a frame are too many for a long one."""
    text = (
        BAR.replace("time 0.2 s", f"time {time}").replace("at 0.2 s", "at 0.1 s")
        + f"expect bar.position.y at {time} = 0 +- 1 m\n"
    )
    scene = same_frames(parse_scene(text))
    counts = {fit_steps(scene, longest)[1:] for longest in (1e-2, 1e-3, 1e-4, 1e-5)}
    assert {whole for whole, _ in counts} == {frames} and len({last > 0 for _, last in counts}) == 1
    assert len(scene.expects) == (1 if time == "0.20371 s" else 2)
    if time == "0.20371 s":
        assert len({fit_steps(parse_scene(BAR.replace("0.2 s", time)), longest)[2] > 0 for longest in (1e-2, 1e-5)}) == 2


# --- must hold: order of the time step, drift of the classes ----------------------------------------------------------


def test_beam_converges_in_the_time_step(scenes, tmp_path, monkeypatch):
    """Follow the beam through the blow of the cube. Its corners, light as the cube turns as a true one, touch and part several
    times, which leaves no clear order between one and two; what is off is below 1e-5 of the way at the shortest step."""
    monkeypatch.setattr(bench, "REPEATS", 1)
    scene = load_scene(scenes / "beam.txt")
    scene = replace(scene, expects=(), control=replace(scene.control, time=0.4, accuracy=Accuracy.PREVIEW))
    study = run_study(scene, tmp_path / "study", budget=30.0, only=["time step"])
    ladder = study.analysis.ladders["time step"]
    assert 0.8 < ladder.order < 2.8 and ladder.used >= 3
    assert 0.0 < ladder.errors[-1] < 1e-5
    assert set(study.analysis.measured) == {"time step"}
    assert "resolution" not in study.left_out


def test_cantilever_has_order_two_in_the_time_step(scenes, tmp_path, monkeypatch):
    """Follow the cantilever through its first swing: 2.0 +- 0.2."""
    monkeypatch.setattr(bench, "REPEATS", 1)
    scene = load_scene(scenes / "cantilever.txt")
    scene = replace(scene, expects=(), control=replace(scene.control, time=0.4, accuracy=Accuracy.PREVIEW))
    study = run_study(scene, tmp_path / "study", budget=30.0, only=["time step"])
    assert study.analysis.ladders["time step"].order == pytest.approx(2.0, abs=0.2)


DRIFT = {Accuracy.PREVIEW: 1e-2, Accuracy.BALANCED: 1e-3, Accuracy.REFERENCE: 1e-4}


def drift(scene, accuracy: Accuracy, folder: Path) -> float:
    """Largest energy residual of a scene in a class."""
    return measure(replace(scene, expects=()), Setting(accuracy.cells, accuracy.fraction), folder).drift


@pytest.mark.parametrize("accuracy", Accuracy)
@pytest.mark.parametrize("speed", [0.2, 0.5])
def test_energy_drift_of_an_impact(accuracy, speed, tmp_path):
    """Keep the class's drift when two blocks meet off centre at a share of their wave speed."""
    assert drift(parse_scene(BLOCKS.format(v=speed * WAVE / 2.0)), accuracy, tmp_path) <= DRIFT[accuracy]


@pytest.mark.parametrize("accuracy", [Accuracy.PREVIEW, Accuracy.BALANCED])
@pytest.mark.parametrize("name", ["spin", "cantilever"])
def test_energy_drift_of_free_motion(name, accuracy, scenes, tmp_path):
    """Keep the class's drift in scenes that lose no energy."""
    assert drift(load_scene(scenes / f"{name}.txt"), accuracy, tmp_path) <= DRIFT[accuracy]


@pytest.mark.soak
@pytest.mark.parametrize("accuracy", Accuracy)
@pytest.mark.parametrize("name", ["beam", "crowd", "spin", "cantilever"])
def test_energy_drift_of_scenes(name, accuracy, scenes, tmp_path):
    """Keep the class's drift in whole scenes; crowd.txt at 8 cells up to where its balls fold up (docs/accuracy.md)."""
    scene = load_scene(scenes / f"{name}.txt")
    if (name, accuracy) == ("crowd", Accuracy.REFERENCE):
        scene = replace(scene, control=replace(scene.control, time=0.4))
    assert drift(scene, accuracy, tmp_path) <= DRIFT[accuracy]


def test_study_command(bar_study, bar_file, capsys, monkeypatch):
    """Print table, orders and advice; refuse a budget that is not a time."""
    from mdanim_lammps.cli import main

    monkeypatch.setattr(bench, "REPEATS", 1)
    with pytest.raises(SystemExit) as stopped:
        main(["study", str(bar_file), "--budget", "20 s"])
    out = capsys.readouterr().out
    assert not stopped.value.code
    assert "off expect" in out and "time step: order" in out and "advice   The scene's own setting" in out
    for wrong in ("2 kg", "two minutes", "0 s", "-1 s"):
        with pytest.raises(SystemExit) as stopped:
            main(["study", str(bar_file), f"--budget={wrong}"])
        assert stopped.value.code == 2
        assert "expected a time above 0" in capsys.readouterr().err
