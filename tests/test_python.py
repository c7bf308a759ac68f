# SPDX-License-Identifier: GPL-2.0-only
"""The Python interface as a researcher uses it: texts, parameters, sweeps, frames, tables, notebooks."""

import os
import re
import subprocess
import sys
import time
from pathlib import Path

import mdanim_lammps
import numpy as np
import pytest
from mdanim_lammps import Interrupted, OutputError, RefusedError, Run, Scene, SceneError, UsageError

TEXT = """
let h = 0.3 m
gravity (0, 0, -9.81) m/s^2
object ball { shape sphere 10 cm position (0 m, 0 m, h) mass 1 kg elasticity 300 kPa spin (0, 0, 3) rad/s }
object box { shape box (10, 10, 20) cm position (1, 0, 1) m mass 2 kg elasticity 300 kPa velocity (0, 2, 0) m/s }
control { time 0.2 s  frames 10 fps  resolution 5 cm }
expect ball.position.z at 0 s = 0.3 m +- 1 mm
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return Scene.from_text(TEXT, "pair").run(tmp_path_factory.mktemp("python") / "pair.out")


def test_a_scene_from_a_text():
    """Its name, its values, and those that another Scene has."""
    scene = Scene.from_text(TEXT, "pair", h=0.5)
    assert scene.record.solids[0].position == (0.0, 0.0, 0.5) and scene.values == {"h": 0.5}
    assert scene.where(h="70 cm").record.solids[0].position == (0.0, 0.0, 0.7)
    assert scene.record.solids[0].position == (0.0, 0.0, 0.5)
    assert repr(scene) == "<Scene pair: 2 objects, 0.2 s, h=0.5>"
    with pytest.raises(SceneError, match="did you mean 'h'"):
        scene.where(hh=1.0)
    with pytest.raises(UsageError, match="made of records"):
        Scene(scene.record).where(h=1.0)


def test_a_scene_from_a_file_keeps_its_values(tmp_path):
    """``where`` changes one of them."""
    (tmp_path / "two.txt").write_text("let k = 1\n" + TEXT)
    scene = Scene.load(tmp_path / "two.txt", h=0.4).where(k=2.0)
    assert scene.values == {"h": 0.4, "k": 2.0} and scene.record.solids[0].position[2] == 0.4


SWEEP = """
from mdanim_lammps import Scene
print("main module")
for run in Scene.from_text(open("pair.txt").read(), "pair").sweep({"h": [0.3, 0.5]}):
    print(run.values, run.trajectory.objects["ball"].center_of_mass[0, 2].round(9), run.folder)
"""


def test_a_sweep(tmp_path):
    """All combinations in order, each in a folder of its own, from a script that no process runs again."""
    (tmp_path / "pair.txt").write_text(TEXT)
    (tmp_path / "script.py").write_text(SWEEP)
    done = subprocess.run([sys.executable, "script.py"], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == [
        "main module",
        f"{{'h': 0.3}} 0.3 {tmp_path}/pair.sweep/h=0.3",
        f"{{'h': 0.5}} 0.5 {tmp_path}/pair.sweep/h=0.5",
    ]


def test_a_sweep_that_is_left_ends_its_runs(tmp_path):
    """At once, with checkpoints, though they would go on for hours; the caller's environment is never changed."""
    text = "let t = 0.1\n" + TEXT.replace("time 0.2 s", "time t * 1 s").split("expect")[0]
    before = dict(os.environ)
    runs = Scene.from_text(text, "pair", h=0.5, folder=tmp_path).sweep({"t": [0.1, 9000]}, tmp_path / "s", processes=2)
    next(runs)
    assert os.environ == before
    checkpoint, deadline = tmp_path / "s" / "t=9000" / "checkpoint", time.monotonic() + 60
    while not checkpoint.exists() and time.monotonic() < deadline:
        time.sleep(0.02)
    runs.close()
    assert checkpoint.exists() and not (checkpoint.parent / "summary.json").exists()
    assert not (checkpoint.parent / ".in-use").exists()


def test_names_of_a_scene_that_are_words_of_python(tmp_path):
    """A table names them; as keywords they would mean something else, to overwrite earlier results among it."""
    text = "let force = 0.3\nlet values = 1\nlet strict = 1\nlet self = 1\n" + TEXT.replace(
        "position (0 m, 0 m, h)", "position (0 m, 0 m, force * 1 m)"
    )
    scene = Scene.from_text(text.split("expect")[0], "pair", folder=tmp_path)
    table = {"force": [0.4, 0.5], "self": [1, 2], "values": [3]}
    runs = list(scene.sweep(table, tmp_path / "s", processes=2))
    assert [run.values for run in runs] == [{"force": f, "self": s, "values": 3} for f in (0.4, 0.5) for s in (1, 2)]
    assert runs[2].trajectory.objects["ball"].center_of_mass[0, 2] == pytest.approx(0.5)
    changed = scene.where({"strict": 7, "self": 2}, values=3)
    assert changed.values == {"strict": 7, "self": 2, "values": 3}
    for wrong in (
        lambda: scene.sweep(tmp_path / "s", force=[0.4, 0.5]),
        lambda: scene.sweep({"h": [1.0]}, force=1),
        lambda: scene.run(tmp_path / "s" / "force=0.4,self=1,values=3", force="no"),
        lambda: Scene.from_text(text, strict=7),
    ):
        with pytest.raises(UsageError, match=r"is True or False here; .* in a table, where\(\{'(force|strict)'"):
            wrong()
    with pytest.raises(UsageError, match="h: given twice"):
        scene.sweep({"h": [1.0]}, h=[2.0])
    with pytest.raises(UsageError, match="two folders"):
        scene.sweep("a", "b", h=[1.0])


@pytest.mark.parametrize("at", [0.7777, 0.001, 1 / 3, 1.0, 0.123456789])
def test_a_picture_at_any_time(tmp_path, at):
    """Also where it is not a whole number of frames of the scene: nobody has asked for frames."""
    drawn = Scene.from_text(TEXT.split("expect")[0], "pair").picture(tmp_path / "p.png", at=at, size=(64, 48))
    assert drawn.exists()


def test_what_a_sweep_refuses(tmp_path):
    """All problems before the first run; an error of a run comes from its process as it is."""
    scene = Scene.from_text(TEXT, "pair")
    with pytest.raises(UsageError, match="lists of different values"):
        scene.sweep({"h": [0.3, 0.3]})
    for no_list in (0.3, "12", "30 cm"):
        with pytest.raises(UsageError, match="needs a list of values for h, found"):
            next(scene.sweep({"h": no_list}, tmp_path / "s"))
    with pytest.raises(SceneError):
        scene.sweep({"h": [0.3, "soft"]}, tmp_path / "s")
    assert not (tmp_path / "s").exists()
    (tmp_path / "s" / "h=0.5").mkdir(parents=True)
    (tmp_path / "s" / "h=0.5" / "thesis.tex").touch()
    runs = scene.sweep({"h": [0.3, 0.5]}, tmp_path / "s", processes=1)
    assert next(runs).values == {"h": 0.3}
    with pytest.raises(OutputError, match="exists; overwrite it with force=True"):
        next(runs)
    # Overlapping objects are found when models are built, in the process of the run.
    with pytest.raises(SceneError) as caught:
        next(Scene.from_text(TEXT.replace("(1, 0, 1) m", "(0, 0, 1) m"), "pair").sweep({"h": [1.0]}, tmp_path / "p"))
    assert all(problem.message for problem in caught.value.problems)
    assert scene.where(h=1.0).prepared  # apart they are fine


def test_frames(run):
    """By number, from the end, as slices, one after the other."""
    t = run.trajectory
    assert [frame.frame for frame in t] == [0, 1, 2] == [frame.frame for frame in t[:]]
    assert t[-1].time == t.times[2] and t[1].step == t.steps[1]
    np.testing.assert_array_equal(t[1].position, t.position(1))
    np.testing.assert_array_equal(t[1].velocity, t.velocity(1))
    np.testing.assert_array_equal(t[1].centers, t.centers[1])
    assert [frame.frame for frame in t[1:]] == [1, 2] and t[np.int64(1)].frame == 1
    assert t[1].surface().n_cells == t.surface(1).n_cells
    with pytest.raises(IndexError):
        t[3]
    with pytest.raises(TypeError):
        t[0.5]


def test_tracks_of_objects(run):
    """Velocity, spin and surface of one object, in SI units."""
    ball, box = (run.trajectory.objects[name] for name in ("ball", "box"))
    np.testing.assert_allclose(ball.spin[0], (0.0, 0.0, 3.0), atol=1e-9)
    np.testing.assert_allclose(box.spin, 0.0, atol=1e-6)
    np.testing.assert_allclose(box.velocity[:, 1], 2.0, rtol=1e-9)
    # Its lattice fills the box: mass per volume is that of the text.
    assert box.surface(2).volume == pytest.approx(0.1 * 0.1 * 0.2, rel=1e-6)
    np.testing.assert_allclose(box.surface(2).center, box.center_of_mass[2], atol=1e-6)
    assert ball.surface(0).n_cells + box.surface(0).n_cells == run.trajectory.surface(0).n_cells


def test_tables(run):
    """pandas gets a row for each object and frame, and the columns of the ledger."""
    table = run.trajectory.to_pandas()
    assert list(table.object) == ["ball", "box"] * 3 and list(table.frame) == [0, 0, 1, 1, 2, 2]
    np.testing.assert_array_equal(table[table.object == "box"][["x", "y", "z"]], run.trajectory.centers[:, 1])
    assert table.wz[0] == pytest.approx(3.0) and table.kinetic[1] == pytest.approx(0.5 * 2.0 * 2.0**2)
    ledger = run.ledger.to_pandas()
    np.testing.assert_array_equal(ledger["elastic"], run.ledger.array("elastic"))
    assert tuple(ledger) == run.ledger.columns


def test_names_are_suggested(run):
    """Whatever has names says which one is near."""
    for ask, words in (
        (lambda: run.trajectory.objects["bal"], "no object is called 'bal'; did you mean 'ball'"),
        (lambda: run.ledger.array("kinetc"), "no column 'kinetc'; did you mean 'kinetic'"),
        (lambda: Scene.from_text(TEXT).effects["gravty"], "did you mean 'gravity'"),
    ):
        with pytest.raises(KeyError, match=re.escape(words)):
            ask()


def test_what_notebooks_show(run):
    """A picture and a table of a scene and of a result, a table of a trajectory; names are not markup."""
    scene = Scene.from_text(TEXT, "<b>pair")._repr_html_()
    result = run._repr_html_()
    assert scene.count("data:image/png;base64,") == 1 == result.count("data:image/png;base64,")
    assert "&lt;b&gt;pair" in scene and "<td>ball</td><td>1 kg</td>" in scene
    assert "<td>ball.position.z</td>" in result and "<td>met</td>" in result
    assert "<td>box</td><td>2 kg</td>" in run.trajectory._repr_html_()
    assert repr(run).startswith(f"<Run {run.folder}: 3 frames, energy residual ")


def test_progress_is_shown_where_asked_for(tmp_path, capfd):
    """Lines of a bar on stderr, and none without ``progress``."""
    scene = Scene.from_text(TEXT, "pair")
    scene.run(tmp_path / "a", progress=True)
    assert re.search(r"run +\d+%  t=", capfd.readouterr().err)
    scene.run(tmp_path / "b")
    assert "%" not in capfd.readouterr().err


def test_types_are_for_others_too():
    """Type checkers of other projects read the annotations."""
    assert (Path(mdanim_lammps.__file__).parent / "py.typed").exists()


def test_a_run_by_its_folder(run):
    """Whatever the program that has run it had in hand is read back from its folder."""
    again = Run(run.folder)
    assert str(again.status) == "done, 3 of 3 frames" and repr(again) == f"<Run {run.folder}: done, 3 of 3 frames>"
    assert again.ledger.rows == run.ledger.rows and again.ledger.columns == run.ledger.columns
    assert [(o.found, o.met) for o in again.outcomes] == [(o.found, o.met) for o in run.outcomes] and not again.missed
    assert again.cost == run.cost and again.timeline is None and not again.warnings
    assert [solid.name for solid in again.scene.record.solids] == ["ball", "box"]
    np.testing.assert_array_equal(again.trajectory.position(2), run.trajectory.position(2))
    with pytest.raises(RefusedError, match="is complete"):
        again.resume()
    with pytest.raises(OutputError, match="does not exist"):
        Run(run.folder / "nowhere")


def test_a_run_that_was_stopped(run, tmp_path):
    """Its state is told with its reason; it goes on to what a run has left that was never stopped."""
    place = tmp_path / "pair.out"
    with pytest.raises(Interrupted):
        Scene.from_text(TEXT, "pair").run(place, on_progress=lambda p: p.frame == 1 and (place / "stop").touch())
    stopped = Run(place)
    assert stopped.status.state == "stopped" and stopped.status.frames == 2 and "resume" in stopped.status.message
    assert stopped.outcomes == [] and stopped.cost is None
    seen = []
    assert stopped.resume(on_progress=lambda p: seen.append(p.frame)) is stopped and seen == [2]
    assert stopped.status.state == "done" and stopped.ledger.rows == run.ledger.rows
    np.testing.assert_array_equal(stopped.trajectory.position(2), run.trajectory.position(2))


def test_a_run_is_drawn_and_exported(run, tmp_path):
    """-o means the same in Python: a file, or a folder for it; a file of others is kept."""
    movie = run.render(tmp_path, size=(64, 48), quality="draft")
    assert movie == tmp_path / "movie.mp4" and movie.stat().st_size > 500
    (exported,) = run.export("csv", tmp_path).files
    assert exported == tmp_path / "pair.csv" and exported.exists()
    (tmp_path / "mine.mp4").write_text("precious")
    with pytest.raises(OutputError, match="not of this program"):
        run.render(tmp_path / "mine.mp4")
    with pytest.raises(UsageError, match=r"written as \.mp4"):
        run.render(tmp_path / "movie.avi")


def test_old_spellings_are_told(tmp_path):
    """They work for one version, with a warning that names the new one and the caller's line."""
    scene = Scene.from_text(TEXT, "pair", folder=tmp_path)
    for old, new in (
        (lambda: scene.effects()["gravity"].on, "without brackets"),
        (lambda: scene.certificate().timestep, "without brackets"),
        (lambda: mdanim_lammps.Universe, "open_universe"),
        (lambda: scene.sweep(h=[0.4]), "sweep({'NAME'"),
    ):
        with pytest.warns(DeprecationWarning, match=re.escape(new)) as told:
            assert old()
        assert told[0].filename == __file__


def test_what_is_documented_is_exported():
    """Each name of docs/api.md comes from the package itself, and what it exports is there."""
    page = (Path(__file__).parents[1] / "docs" / "api.md").read_text()
    documented = set(re.findall(r"^\.\. auto\w+:: (\S+)$", page, re.MULTILINE))
    assert documented == {f"mdanim_lammps.{name}" for name in mdanim_lammps.__all__}
    assert all(getattr(mdanim_lammps, name) for name in mdanim_lammps.__all__)
