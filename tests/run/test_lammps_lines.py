# SPDX-License-Identifier: GPL-2.0-only
"""Commands for LAMMPS in a scene: they are run as they stand, behind all others, and never unless they are trusted."""

import json

import numpy as np
import pytest
from mdanim_lammps import Run, Scene, SceneError, Trajectory, cli
from mdanim_lammps.engine.commands import input_script
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.lock import lock_text
from mdanim_lammps.scene.parse import load_scene, parse_scene
from plugin_path import lmp

TOP = "object ball { shape box (8, 8, 8) cm position (0, 0, 0) m density 1000 kg/m^3 elasticity 100 kPa }\n"
END = "control { time 0.2 s frames 10 fps resolution 4 cm }\n"
PUSH = """lammps {
  # the same force on each particle, for a tenth of a second
  variable push equal 0.01*(step*dt<0.1)
  fix push mobile addforce v_push 0 &
    0
}
"""


def problem_of(text: str, **more):
    """The one problem of a scene when it is prepared."""
    with pytest.raises(SceneError) as error:
        prepare(parse_scene(text, **more))
    (problem,) = error.value.problems
    return problem


def test_lines_are_run(tmp_path):
    """A constant force of F on each of n particles for a time t gives n F t of momentum; the residual holds its work."""
    scene = Scene.from_text(TOP + PUSH + END, "push", trust=True)
    run, dt = scene.run(tmp_path / "push.out"), scene.certificate.timestep
    with Trajectory(tmp_path / "push.out") as trajectory:
        particles, mass = trajectory.metadata.total, trajectory.metadata.object_mass[0]
        v = trajectory.center_velocities[-1, 0]
    assert v[0] == pytest.approx(0.01 * particles * 0.1 / mass, abs=0.01 * particles * dt / mass)  # a step more or less
    assert v[1:] == pytest.approx(0.0, abs=1e-12)
    energy = 0.5 * mass * v[0] ** 2
    assert run.ledger.rows[-1]["kinetic"] == pytest.approx(energy, rel=1e-2)
    assert any("LAMMPS" in warning.message for warning in run.warnings)


def test_lines_in_scripts(tmp_path):
    """They stand in in.NAME behind the others, and lmp does with them what a run does."""
    scene = Scene.from_text(TOP + PUSH + END, "push", trust=True)
    script = input_script(scene.prepared.plan)
    assert script.index("run_style") < script.index("fix push mobile addforce v_push 0 &\n0\n") < script.index("balance 1.0")
    scene.run(tmp_path / "push.out")
    folder = tmp_path / "push.out"
    lmp(folder / "in.push")
    with Trajectory(folder) as trajectory:
        last = trajectory.position(len(trajectory) - 1)
    rows = (folder / "push.lammpstrj").read_text().splitlines()[-len(last) :]
    assert np.array_equal(np.array([row.split()[3:6] for row in rows], float), last)


def test_lock_of_lines():
    """scene.lock.txt has them, and is not trusted by that."""
    scene = parse_scene(TOP + PUSH + END, trust=True)
    again = parse_scene(lock_text(scene), scene.name)
    assert again == scene
    assert (scene.trusted, again.trusted) == (True, False)
    assert [c.text for c in again.lammps] == ["variable push equal 0.01*(step*dt<0.1)", "fix push mobile addforce v_push 0 &\n0"]


# --- who may run them -----------------------------------------------------------------------------------------


@pytest.fixture
def evil(tmp_path):
    """A scene whose commands leave a file, and that file."""
    mark = tmp_path / "mark"
    scene = tmp_path / "evil.txt"
    scene.write_text(f"{TOP}lammps {{ shell touch {mark} }}\n{END}")
    return scene, mark


def exit_code(*arguments) -> int:
    """Exit code of a command, run in this process."""
    with pytest.raises(SystemExit) as end:  # noqa: PT012 -- some commands return, others exit
        cli.main([str(a) for a in arguments])
        raise SystemExit(0)
    return int(end.value.code or 0)


COMMANDS = ["run --no-movie", "check", "build", "picture --at 0.1s", "study", "study --target 2%", "run --no-movie -n 2"]


@pytest.mark.parametrize("command", COMMANDS)
def test_no_command_runs_lines_that_are_not_trusted(evil, command, capsys):
    """Each that would run them ends with the place of the block, and nothing is run."""
    scene, mark = evil
    name, *options = command.split()
    assert exit_code(name, scene, *(o.replace("0.1s", "0.1 s").replace("2%", "2 %") for o in options)) == 3
    told = "".join(capsys.readouterr())
    assert "evil.txt:2:10" in told
    assert "-n and --control" in told or "write --trust if they may be run" in told
    assert not mark.exists()


def test_a_folder_is_not_trusted_by_what_is_in_it(evil, tmp_path, capsys):
    """A run that was trusted, stopped and copied is resumed only with --trust; its pictures need none."""
    scene, mark = evil
    out = tmp_path / "evil.out"
    with pytest.raises(Exception, match="interrupted"):
        Scene.load(scene, trust=True).run(out, on_progress=lambda p: (out / "stop").touch())
    assert mark.exists()
    mark.unlink()
    assert exit_code("resume", out, "--no-movie") == 3
    assert "write --trust" in "".join(capsys.readouterr())
    with pytest.raises(SceneError, match="trust"):
        Run(out).resume()
    assert exit_code("render", out, "--size", 64, 48) == 0
    assert exit_code("export", out, "--to", "csv") == 0
    assert not mark.exists()
    assert exit_code("resume", out, "--no-movie", "--trust") == 0
    assert mark.exists()


def test_text_of_a_page_is_not_trusted(evil, tmp_path):
    """Lines in a text that is edited in the page of a view are checked, and not run."""
    from mdanim_lammps.view.check import found_problems

    scene, mark = evil
    found_problems(scene.read_text(), "evil", scene.parent)
    assert not mark.exists()


def test_scripts_are_not_written_untrusted(evil):
    """`in.NAME` would run them later, so it is not written, nor is an instance made, even of a plan that was prepared."""
    from dataclasses import replace

    scene, mark = evil
    ready = prepare(load_scene(scene, trust=True))
    resolved = replace(ready.resolved, scene=replace(ready.scene, trusted=False))
    plan = replace(ready.plan, context=replace(ready.context, resolved=resolved))
    for make in (input_script, Instance):
        with pytest.raises(SceneError, match="trust"):
            make(plan)
    assert not mark.exists()


def test_several_executors_are_refused(tmp_path):
    """Commands act on all objects together; nothing of an earlier run is lost by the refusal."""
    scene = Scene.from_text(TOP + PUSH + END, "push", trust=True)
    for more in ({"executors": 2}, {"control": "peers"}):
        with pytest.raises(SceneError, match="each executor has only some"):
            scene.run(tmp_path / "push.out", **more)
    assert not (tmp_path / "push.out").exists()


# --- mistakes -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("block", "line", "column", "words"), [
    pytest.param("lammps {\n  fxi a all nve\n}\n", 3, 3, "Unknown command: fxi", id="unknown command"),
    pytest.param("lammps { fix a nobody nve }\n", 2, 10, "Could not find fix group ID nobody", id="unknown group"),
    pytest.param("lammps {\n  variable a equal 1\n  timestep 1\n}\n", 4, 3, "a time step of 1.0 s", id="time step"),
    pytest.param("lammps { delete_atoms group all }\n", 2, 10, "there are 0 particles", id="particles"),
    pytest.param("lammps { run 3 }\n", 2, 10, "at step 3", id="steps"),
])  # fmt: skip
def test_line_that_is_wrong(block, line, column, words):
    """LAMMPS's own words at the line of the scene; particles and steps stay those of the scene."""
    ready = prepare(parse_scene(TOP + block + END, trust=True))
    with pytest.raises(SceneError) as error:
        Instance(ready.plan)
    (problem,) = error.value.problems
    assert (problem.line, problem.column) == (line, column)
    assert words in problem.message


@pytest.mark.parametrize(("text", "line", "column", "words"), [
    pytest.param(TOP + END + "lammps {\n  fix a all nve\n", 3, 8, "never closed", id="never closed"),
    pytest.param(TOP + END + "lammps a { }\n", 3, 8, "lammps has no name", id="name"),
    pytest.param(TOP + END + "repeat i in 1 .. 2 { lammps { } }\n", 3, 22, "cannot stand in a repeat", id="repeat"),
    pytest.param(TOP + END + "group g { lammps { } }\n", 3, 1, "is not closed before 'lammps'", id="group"),
    pytest.param(TOP + END + "lammps fix a all nve\n", 3, 8, "lammps has no name", id="no braces"),
])  # fmt: skip
def test_block_that_is_wrong(text, line, column, words):
    """Place and cause."""
    problem = problem_of(text, trust=True)
    assert (problem.line, problem.column) == (line, column)
    assert words in problem.message


def test_braces_of_lammps():
    """A line with } alone ends the block, not one that has it inside; other settings may follow."""
    text = TOP + 'lammps {\n  variable a equal 1\n  print ${a}\n  if "${a} > 0" then &\n   "print \'x\'"\n}\n' + END
    scene = parse_scene(text)
    assert [c.text for c in scene.lammps] == ["variable a equal 1", "print ${a}", 'if "${a} > 0" then &\n"print \'x\'"']
    assert parse_scene(TOP + "lammps { }\n" + END).lammps == ()


def test_check_of_lines_says_that_nothing_is_promised(tmp_path, capsys):
    """`check` warns, as a program reads it."""
    path = tmp_path / "push.txt"
    path.write_text(TOP + PUSH + END)
    assert exit_code("check", path, "--trust", "--json") == 0
    warnings = json.loads(capsys.readouterr().out)["warnings"]
    assert any("neither the bound on the time step nor the energies" in str(w) for w in warnings)
