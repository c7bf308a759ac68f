# SPDX-License-Identifier: GPL-2.0-only
"""The command line: exit codes, messages, and what goes where."""

import json
import os
import subprocess
import sys
from itertools import takewhile
from pathlib import Path

import plugin_path
import pytest
from command_line import GOOD, call, run
from mdanim_lammps import Scene
from mdanim_lammps.report import check_json, scene_lines


@pytest.fixture
def scene(tmp_path):
    """Make a scene file."""

    def make(text=GOOD, name="cube.txt"):
        (tmp_path / name).write_text(text)
        return tmp_path / name

    return make


def test_run_leaves_a_movie(scene):
    """Run a scene as is: lines on stdout, progress on stderr, a movie at the end."""
    path = scene()
    done = run(path)
    assert done.returncode == 0, done.stderr
    words = [line.split()[0] for line in done.stdout.splitlines() if not line.startswith(" ")]
    assert words == ["scene", "certify", "output", "threads", "cost", "ledger", "movie"]  # tests ask for one thread
    assert (path.parent / "cube.out" / "movie.mp4").stat().st_size > 1000
    assert done.stdout.strip().endswith("movie.mp4")
    assert run(path).returncode == 7, "an existing folder is not overwritten"
    assert run(path, "--force", "--no-movie", "-q").stdout == ""


def test_check_text_and_json(scene):
    """Say the same in text and in JSON, and run nothing."""
    path = scene()
    text = call("check", path)
    assert text.returncode == 0 and "certify" in text.stdout and "contact" in text.stdout
    assert "cost     about " in text.stdout
    assert "basin, liquid, buoyancy, liquid-drag (no liquid in the scene)" in text.stdout
    data = json.loads(call("check", path, "--json").stdout)
    assert data["effects"]["gravity"]["on"] and not data["effects"]["contact"]["on"]
    assert data["certificate"]["object"] == "cube" and data["cost"]["wall"] > 0.0
    assert [p.name for p in path.parent.iterdir()] == ["cube.txt"]


def test_effects_are_told_in_short_lines(scene, scenes):
    """Break what is on and what is off into lines that a terminal shows whole, between effects;
    every effect stands in one of them."""
    from mdanim_lammps import features

    first, on, *rest = call("check", scene()).stdout.splitlines()
    assert [first, on] == ["scene    cube.txt  1 object (27 particles)", "         effects: springs, gravity, ground"]
    off = list(takewhile(lambda line: line.startswith(" "), rest))
    told = " ".join(line.strip() for line in off)
    assert told.startswith("off: ")
    for one in ("damping (no object has damping)", "contact (one object)", "walls (no walls in the scene)"):
        assert f"{one}," in told
    assert "basin, liquid, buoyancy, liquid-drag (no liquid in the scene)" in told and "air-drag (no object has drag)" in told
    assert len(off) > 1 and all(line.endswith("),") for line in off[:-1]) and max(map(len, off)) <= 110
    for name in ("crowd", "float"):
        lines = scene_lines(Scene.load(scenes / f"{name}.txt").prepared)
        assert max(map(len, lines)) <= 110
        words = " ".join(lines[1:]).replace(",", " ").split()
        assert all(e.name in words for e in features.effects())


def test_a_liquid_is_announced(scenes):
    """Say how many cells the liquid has, and by how much its volume was rounded where it was."""
    ready = Scene.load(scenes / "float.txt").prepared
    assert scene_lines(ready)[0].endswith("1 object (405 particles), 1 liquid (38 400 cells)")
    assert "its volume rounded by" in scene_lines(Scene.load(scenes / "float.txt", a=0.3).prepared)[0]
    data = check_json(ready)
    assert data["liquid"]["cells"] == [40, 40, 24] and data["liquid"]["cell"] == pytest.approx([0.05, 0.05, 0.05])


def test_build_writes_two_files_for_lammps(scene):
    """Write data and input files and no trajectory."""
    path = scene()
    assert call("build", path).returncode == 0
    names = {p.name for p in (path.parent / "cube.out").iterdir()}
    assert {"data.cube", "in.cube"} <= names and "trajectory.h5" not in names


def test_the_command_that_build_tells_runs(scene, tmp_path):
    """Tell a command that runs as it stands, whether or not the shell finds our ``lmp`` by its name."""
    path = scene()
    bare = {"PATH": "/usr/bin:/bin"}
    for env in (bare, {"PATH": f"{Path(sys.executable).parent}:/usr/bin:/bin"}):
        built = subprocess.run(
            [sys.executable, "-m", "mdanim_lammps", "build", path, "--force"],
            capture_output=True,
            text=True,
            env=os.environ | env,
            timeout=100,
        )
        command = built.stdout.splitlines()[-1].removeprefix("built ")
        assert (" lmp " in command) == (env is not bare), command
        done = subprocess.run(
            command, shell=True, capture_output=True, text=True, env=plugin_path.environment() | env, timeout=100
        )
        assert done.returncode == 0 and "Total wall time" in done.stdout, done.stdout + done.stderr


def test_compare_and_render_use_an_output_folder(scene):
    """Draw again smaller, compare a run with itself and with another."""
    path = scene()
    folder = path.parent / "cube.out"
    assert call(path, "--no-movie", "-q").returncode == 0
    assert call("render", folder, "--size", 320, 180, "-q", "--frames", "--fps", 1).returncode == 0
    assert (folder / "movie.mp4").exists()
    draft = (folder / "frames" / "frame-00000.png").read_bytes()
    assert call("render", folder, "--size", 320, 180, "-q", "--frames", "--fps", 1, "--quality", "final").returncode == 0
    assert (folder / "frames" / "frame-00000.png").read_bytes() != draft
    for when, name in (("0 s", "first"), ("0.1 s", "later")):
        assert call("render", folder, "--at", when, "--size", 320, 180, "-q", "-o", path.parent / f"{name}.png").returncode == 0
    assert (path.parent / "first.png").read_bytes() != (path.parent / "later.png").read_bytes()
    assert call("render", folder, "--at", "0.1 s", "--size", 320, 180).stdout.endswith(f"{folder / 'picture.png'}\n")
    assert (folder / "picture.png").read_bytes() == (path.parent / "later.png").read_bytes()
    late = call("render", folder, "--at", "9 s")
    assert late.returncode == 2 and "--at 9 s: the last frame is at" in late.stderr
    assert call("compare", folder, folder).stdout.startswith("equal")
    assert call(path, "--no-movie", "-q", "-o", path.parent / "b.out").returncode == 0
    assert call("compare", folder, path.parent / "b.out").returncode == 0
    assert call("compare", folder, path.parent / "b.out", "--movie", "--size", 320, 90, "-q", cwd=path.parent).returncode == 0
    assert (path.parent / "compare.mp4").stat().st_size > 500


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        pytest.param(["chekc", "cube.txt"], 2, ["did you mean 'check'"], id="mistyped command"),
        pytest.param(["cube.txt", "--frobnicate"], 2, ["frobnicate"], id="unknown option"),
        pytest.param(["missing.txt"], 3, ["missing.txt"], id="no such scene"),
        pytest.param(["bad.txt"], 3, ["bad.txt:7:14: error", "'kgg'", "did you mean", "^"], id="scene error"),
        pytest.param(
            ["check", "liquid.txt"],
            3,
            ["cube is 4 cm below the floor of the basin", "move it up by 4 cm", "2 cells wide along x"],
            id="basin",
        ),
        pytest.param(["check", "alone.txt"], 3, ["there is nothing in the scene", "object ball {"], id="nothing"),
        pytest.param(
            ["check", "dry.txt"], 3, ["liquid.level needs the liquid, which is off", "switch the liquid on"], id="liquid off"
        ),
        pytest.param(["fast.txt"], 4, ["certified bound", "cube", "timestep auto"], id="step above the bound"),
        pytest.param(["cube.txt", "-n", "0"], 2, ["-n 0", "at least one"], id="no executor"),
        pytest.param(["cube.txt", "-n", "1.5"], 2, ["1.5 is not a whole number"], id="part of an executor"),
        pytest.param(["study", "cube.txt", "--budget", "soon"], 2, ["--budget soon", "expected a time above 0"], id="study"),
        pytest.param(["render", "nowhere.out", "--size", "0", "0"], 2, ["between 2 and 8192"], id="no size"),
        pytest.param(["view", "nowhere.out"], 7, ["nowhere.out does not exist"], id="nothing to view"),
        pytest.param(["view", "nowhere.out", "--port", "70000"], 2, ["--port 70000", "65535"], id="no port"),
        pytest.param(["report", "nowhere.out"], 7, ["nowhere.out does not exist"], id="nothing to report"),
        pytest.param(["report", "nowhere.out", "-o", "x.pdf"], 2, ["written as .html"], id="no report"),
        pytest.param(["export", "nowhere.out", "--to", "usd"], 7, ["nowhere.out does not exist"], id="nothing to export"),
        pytest.param(["export", "nowhere.out"], 2, ["--to"], id="no format"),
        pytest.param(["export", "nowhere.out", "--to", "usd", "--frames", "7"], 2, ["expected START:END"], id="no range"),
        pytest.param(["render", "nowhere.out", "--quality", "best"], 2, ['"best"', '"draft", "final"'], id="no quality"),
        pytest.param(["render", "nowhere.out", "--fps", "-3"], 2, ["--fps -3", "above 0"], id="no rate"),
        pytest.param(
            ["resume", "nowhere.out"], 7, ["error: nowhere.out does not exist; name the folder"], id="nothing to resume"
        ),
        pytest.param(["render", "."], 7, ["error: . has no run in it; name the folder"], id="nothing to draw"),
        pytest.param(
            ["render", "cube.txt"], 7, ["cube.txt is a file, not the output folder"], id="a scene in place of its folder"
        ),
        pytest.param(["cube.txt", "--set", "nonsense"], 2, ["NAME=VALUE"], id="set without value"),
        pytest.param(["wrong.txt", "--no-movie"], 6, ["MISSED"], id="missed expectation"),
        pytest.param(["cube.txt", "-o", "."], 7, ["-o .: the output folder is the current folder", "cube.out"], id="here"),
        pytest.param(["cube.txt", "-o", ""], 7, ["the output folder is the current folder"], id="no name"),
        pytest.param(["build", "cube.txt", "-o", ".."], 7, ["-o ..: the output folder holds the current folder"], id="above"),
        pytest.param(["cube.txt", "-o", "/"], 7, ["-o /: the output folder holds the current folder"], id="everything"),
        pytest.param(["study", "cube.txt", "-o", "/"], 7, ["-o /: the output folder holds"], id="study of everything"),
        pytest.param(["sub/deep.txt", "-o", "sub"], 7, ["-o sub: the output folder holds the scene"], id="over the scene"),
        pytest.param(["movie.txt"], 3, ['movie "/etc/x.mp4"', "lies outside of the output folder"], id="a movie elsewhere"),
        pytest.param(["avi.txt"], 3, ['movie "x.avi"', "written as .mp4"], id="another kind of movie"),
        pytest.param(["compare", "a", "b", "--size", "64", "36"], 2, ["write --movie"], id="size without a movie"),
        pytest.param(["run", "bad.txt"], 3, ["bad.txt:7:14: error"], id="run as a word"),
    ],
)
def test_exit_codes(scene, arguments, code, words):
    """End with the documented code and a message that says how to go on; never with a traceback."""
    directory = scene().parent
    scene(GOOD.replace("density 1000 kg/m^3", "mass   1.5 kgg"), "bad.txt")
    water = "liquid water {\n basin from (-1, -1, 0) m to (1, 1, 1) m\n density 1000 kg/m^3\n level 0.5 m\n}\n"
    scene(
        GOOD + water.replace("(-1, -1, 0) m to (1, 1, 1)", "(-4, -20, 5) cm to (4, 20, 80)").replace(") m\n d", ") cm\n d"),
        "liquid.txt",
    )
    scene("gravity (0, 0, -9.81)\ncontrol { time 1 s }\neffects { liquid off }\n" + water, "alone.txt")
    scene(GOOD + water + "effects { liquid off }\nexpect liquid.level = 0.5 m +- 1 cm\n", "dry.txt")
    scene(GOOD.replace("time 0.1 s", "time 0.1 s\n  timestep 1 s"), "fast.txt")
    scene(GOOD + "expect cube.position.z at 0.1 s = 9 m +- 1 m\n", "wrong.txt")
    (directory / "sub").mkdir()
    scene(GOOD, "sub/deep.txt")
    scene(GOOD + 'render { movie "/etc/x.mp4" }\n', "movie.txt")
    scene(GOOD + 'render { movie "x.avi" }\n', "avi.txt")
    done = (run if arguments[0] in ("chekc", "missing.txt", "movie.txt") else call)(*arguments, cwd=directory)
    assert done.returncode == code, done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    for word in words:
        assert word in done.stderr


@pytest.mark.parametrize(
    ("options", "code", "words"),
    [
        pytest.param(["-o", "nowhere/x.mp4"], 7, "there is no folder nowhere; make it first", id="no folder"),
        pytest.param(["-o", "x.xyz"], 2, "written as .mp4; give it a name such as x.mp4", id="no movie's name"),
        pytest.param(["-o", "cube.txt"], 2, "written as .mp4", id="the scene"),
        pytest.param(["--scene", "look.txt"], 2, "looks at 'kube'", id="a camera without its object"),
        pytest.param(["--fps", "0.0004", "-o", "slow.mp4"], 0, "", id="a slow movie"),
    ],
)
def test_render_refuses(drawn, options, code, words):
    """Render refuses names that are not those of movies, folders that are not there, cameras that look at nothing."""
    before = {p.name for p in drawn.iterdir()}
    (drawn / "look.txt").write_text(GOOD + "object kube { shape sphere 1 m position (9, 9, 9) m mass 1 kg elasticity 1 MPa }\n"
                                    "render { camera from (1, 1, 1) m look kube }\n")  # fmt: skip
    done = call("render", "cube.out", *options, "--size", 160, 90, "-q", cwd=drawn)
    assert done.returncode == code, done.stderr
    assert words in done.stderr and "Traceback" not in done.stderr
    assert {p.name for p in drawn.iterdir()} - before - {"look.txt"} == ({"slow.mp4"} if code == 0 else set())


def test_render_tells_of_slow_motion_that_jerks(drawn):
    """With another render block and the frames of a run that was not meant for it: at its line, with what is smooth."""
    for speed, warned in (("0.25", True), ("0.5", False), ("1", False)):
        (drawn / "cam.txt").write_text(f"render {{\n  speed {speed}\n}}\n")
        done = call("render", "cube.out", "--scene", "cam.txt", "--size", 64, 48, "-q", "-o", "cam.mp4", cwd=drawn)
        assert done.returncode == 0 and ("warning" in done.stderr) == warned, done.stderr
        if warned:
            assert "cam.txt:2:9: warning: at speed 0.25 the movie shows 7.5 pictures a second" in done.stderr
            assert "write speed 0.25 in the scene" in done.stderr and "frames 120 fps" in done.stderr
    for name in ("cam.txt", "cam.mp4"):
        (drawn / name).unlink()


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    """A folder with a scene and its output."""
    folder = tmp_path_factory.mktemp("drawn")
    (folder / "cube.txt").write_text(GOOD)
    assert call("cube.txt", "--no-movie", "-q", cwd=folder).returncode == 0
    return folder


def test_a_stopped_run_says_how_to_draw_it(scene, monkeypatch, capsys):
    """A run that the guard has stopped ends with the command that draws its frames, and that command draws them."""
    from mdanim_lammps import cli
    from mdanim_lammps.errors import DivergedError
    from mdanim_lammps.run.guard import Guard

    def look(self, step, *_):
        if step > 50:
            raise DivergedError("cube has blown up")

    path = scene()
    monkeypatch.setattr(Guard, "check", look)
    with pytest.raises(SystemExit) as end:
        cli.main([str(path)])
    assert end.value.code == 6
    message = capsys.readouterr().err
    command = message.split("draw what was kept with: mdanim-lammps ")[1].splitlines()[0]
    assert call(*command.split(), "--size", 160, 90).returncode == 0
    assert (path.parent / "cube.out" / "movie.mp4").stat().st_size > 1000


def test_a_movie_cannot_leave_the_folder_by_a_link(scene, tmp_path):
    """Refuse a movie whose folder inside the output folder is a link to elsewhere."""
    from mdanim_lammps.errors import OutputError
    from mdanim_lammps.run.folder import movie_file
    from mdanim_lammps.scene.parse import load_scene

    record = load_scene(scene(GOOD + 'render { movie "sub/x.mp4" }\n'))
    folder, elsewhere = tmp_path / "x.out", tmp_path / "elsewhere"
    folder.mkdir()
    elsewhere.mkdir()
    assert movie_file(folder, record) == folder / "sub" / "x.mp4"
    (folder / "sub").symlink_to(elsewhere)
    with pytest.raises(OutputError, match="lies outside of the output folder"):
        movie_file(folder, record)


def test_a_large_scene_is_told_before_modelling(prepared, monkeypatch, capsys):
    """Say particles, memory and time before models are made where they are many, and nothing where they are few."""
    from mdanim_lammps import report
    from mdanim_lammps.cli import steps

    ready = prepared(GOOD)
    assert report.size_line(ready.scene) is None
    monkeypatch.setattr(report, "LARGE", 20)
    monkeypatch.setattr("mdanim_lammps.run.prepare.build_models", lambda *_, **__: pytest.fail("modelled"))
    with pytest.raises(pytest.fail.Exception):
        steps.prepare(ready.scene, allow_unstable=False)
    line = capsys.readouterr().err
    assert line.startswith("size     about 2.7e-5 million particles, spacing 5 cm set by resolution: ") and "of modelling" in line


def test_a_movie_tells_the_time_left():
    """Tell from the pictures so far how long the others will take."""
    from mdanim_lammps.report import movie_line

    assert movie_line(30, 120, 15.0) == "frame 30/120  45 s left"


def test_help_lists_every_command():
    """Show the commands and the options."""
    text = call("--help").stdout
    for word in ("check", "build", "resume", "render", "compare", "--executors", "--force", "--set"):
        assert word in text


def test_check_is_quick(scenes):
    """Import none of the slow libraries to check a scene of boxes that are far from each other."""
    code = (
        "import sys; from mdanim_lammps.cli import main\n"
        f"try: main(['check', {str(scenes / 'beam.txt')!r}])\n"
        "except SystemExit: pass\n"
        "dear = {'pyvista', 'vtk', 'MDAnalysis', 'vtkmodules', 'h5py', 'lammps', 'scipy'}\n"
        "print(sorted({m.split('.')[0] for m in sys.modules} & dear))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout.splitlines()[-1] == "[]", done.stdout


@pytest.mark.parametrize(
    ("asked", "resumed", "drawn"),
    [(["--no-movie"], [], False), (["--no-movie"], ["--movie"], True), ([], [], True), ([], ["--no-movie"], False)],
)
def test_a_resumed_run_draws_as_the_run_would(tmp_path, asked, resumed, drawn):
    """Unless another wish is told."""
    path, out = tmp_path / "cube.txt", tmp_path / "cube.out"
    path.write_text(GOOD.replace("time 0.1 s", "time 0.1 s\n  frames 100 fps") + "render { size (64, 48) }\n")
    loop = "mdanim_lammps.run.loop"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(f"{loop}._Stop.is_set", lambda stop: True)
        assert call(path, *asked).returncode == 130
    assert call("resume", out, *resumed).returncode == 0
    assert (out / "summary.json").exists() and (out / "movie.mp4").exists() == drawn
