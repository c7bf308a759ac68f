# SPDX-License-Identifier: GPL-2.0-only
"""Gravity that changes with time: motion, work, bounds, the same bits everywhere, and what is refused."""

import shutil

import numpy as np
import pytest
from mdanim_lammps import Scene, SceneError, Trajectory
from mdanim_lammps.features.gravity.effect import GRAVITY_WORK
from mdanim_lammps.results.compare import compare
from mdanim_lammps.scene.in_time import MOST_POINTS, vector_at
from mdanim_lammps.scene.lock import lock_text
from mdanim_lammps.scene.parse import parse_scene
from plugin_path import lmp
from scene_parts import pool

PATH = ((0.0, (0.0, 0.0, -9.0)), (0.1, (20.0, 0.0, -9.0)), (0.25, (-20.0, 5.0, 3.0)), (0.3, (0.0, 0.0, -9.0)))
LINES = "".join(f"gravity at {t} s {g} m/s^2\n" for t, g in PATH)
BALL = (
    "object ball { shape box (8, 8, 8) cm position (0, 0, 1) m velocity (1, 0, 2) m/s density 1000 kg/m^3 elasticity 100 kPa }\n"
)
END = "control { time 0.4 s frames 20 fps resolution 4 cm }\n"
SHAKEN = """ground z 0 m
repeat i in 0 .. 40 {
  let t = i*10 ms
  gravity at t (6*sin(2*pi*t/(0.2 s)), 0, -9.81) m/s^2
}
repeat i in 1 .. 3 {
  object cube[i] { shape box (6, 6, 6) cm position (20*i - 40, 0, 3.2) cm density 900 kg/m^3 elasticity 200 kPa damping 0.1 }
}
object far { shape box (6, 6, 6) cm position (0, 1, 0.4) m density 900 kg/m^3 elasticity 200 kPa }
control { time 0.4 s frames 20 fps resolution 3 cm friction 0.3 }
"""


def acceleration(t: np.ndarray) -> np.ndarray:
    """The path by numpy's interpolation, shape (T, 3)."""
    times, values = [p[0] for p in PATH], np.array([p[1] for p in PATH])
    return np.column_stack([np.interp(t, times, values[:, d]) for d in range(3)])


def problem_of(text: str):
    """The one error of a bad scene."""
    with pytest.raises(SceneError) as error:
        parse_scene(text)
    (problem,) = [p for p in error.value.problems if p.severity == "error"]
    return problem


def test_flight_and_work(tmp_path):
    """A free body moves as the integrals of g say, to the second order of the step; the work is its kinetic energy."""
    scene = Scene.from_text(LINES + BALL + END, "flight")
    run, dt = scene.run(tmp_path / "flight.out"), scene.certificate.timestep
    fine = np.linspace(0.0, 0.4, 400_001)
    h = fine[1]
    g = acceleration(fine)
    v = np.array([1.0, 0.0, 2.0]) + np.concatenate([np.zeros((1, 3)), np.cumsum(0.5 * h * (g[1:] + g[:-1]), axis=0)])
    x = np.array([0.0, 0.0, 1.0]) + np.concatenate([np.zeros((1, 3)), np.cumsum(0.5 * h * (v[1:] + v[:-1]), axis=0)])
    steepest = 800.0 / 3.0  # of the path [m/s^3]
    with Trajectory(tmp_path / "flight.out") as trajectory:
        at = np.rint(np.array(trajectory.times) / h).astype(int)
        np.testing.assert_allclose(trajectory.center_velocities[:, 0], v[at], atol=steepest * dt**2)
        np.testing.assert_allclose(trajectory.centers[:, 0], x[at], atol=steepest * dt**2)
        mass = trajectory.metadata.object_mass[0]
    work = [row[GRAVITY_WORK] for row in run.ledger.rows]
    kinetic = 0.5 * mass * (v[at] ** 2).sum(axis=1)
    telescopes = mass * dt**2 / 8.0 * (acceleration(fine) ** 2).sum(axis=1).max()
    np.testing.assert_allclose(work, kinetic - kinetic[0], atol=1.1 * telescopes)
    # The kinetic energy of the ledger is that of a smooth path through the steps: dt^2/12 m (g^2 - v dg/dt) is left of the work.
    left = mass * dt**2 / 12.0 * ((acceleration(fine) ** 2).sum(axis=1).max() + steepest * np.linalg.norm(v, axis=1).max())
    assert run.ledger.residual < 1.1 * left / kinetic.max() < 1e-4
    assert "gravity" not in run.ledger.rows[0]


def test_path_at_any_time():
    """Straight between points, and as at the ends beyond them."""
    for t in (-1.0, 0.0, 0.03, 0.1, 0.2, 0.3, 7.0):
        np.testing.assert_allclose(vector_at(PATH, t), acceleration(np.array([t]))[0], rtol=1e-15, atol=1e-15)


@pytest.fixture(scope="module")
def shaken(tmp_path_factory):
    """A run of boxes on a ground that shakes."""
    folder = tmp_path_factory.mktemp("shaken")
    (folder / "shaken.txt").write_text(SHAKEN)
    scene = Scene.load(folder / "shaken.txt")
    run = scene.run(folder / "shaken.out")
    assert run.ledger.residual < 1e-3
    return scene, folder / "shaken.out", run


@pytest.mark.parametrize("how", [{"executors": 2}, {"executors": 2, "control": "peers"}, {"threads": 2}], ids=str)
def test_same_bits_on_executors_and_threads(shaken, tmp_path, how):
    """Objects that slide and bounce on a shaking ground, on several executors and threads."""
    scene, whole, first = shaken
    run = scene.run(tmp_path / "again.out", **how)
    assert compare(whole, tmp_path / "again.out").frame is None
    works = ([row[GRAVITY_WORK] for row in r.ledger.rows] for r in (first, run))
    np.testing.assert_allclose(*works, rtol=1e-9, atol=1e-12)


def test_same_bits_after_a_resume(shaken, tmp_path):
    """A run that is stopped half way goes on at the time where it was, and so does its account."""
    scene, whole, first = shaken
    out = tmp_path / "stopped.out"
    with pytest.raises(Exception, match="interrupted"):
        scene.run(out, on_progress=lambda p: (out / "stop").touch() if p.frame == 4 else None)
    from mdanim_lammps import Run

    run = Run(out).resume()
    assert compare(whole, out).frame is None
    assert run.ledger.rows[-1][GRAVITY_WORK] == pytest.approx(first.ledger.rows[-1][GRAVITY_WORK], rel=1e-9)


def test_same_bits_of_the_script(shaken, tmp_path):
    """`lmp -in` on one rank and on two."""
    _, whole, _ = shaken
    with Trajectory(whole) as trajectory:
        last = trajectory.position(len(trajectory) - 1)
    for ranks in (1, 2):
        folder = shutil.copytree(whole, tmp_path / f"on{ranks}")
        assert lmp(folder / "in.shaken", ranks).returncode == 0
        rows = (folder / "shaken.lammpstrj").read_text().splitlines()[-len(last) :]
        assert np.array_equal(np.array([row.split()[3:6] for row in rows], float), last), ranks


def test_a_path_that_stays_is_a_constant(tmp_path):
    """Two points of one acceleration give the frames of the constant, to the bit, though without passes."""
    for name, lines in (
        ("one", "gravity (0, 0, -9.81)\n"),
        ("two", "gravity at 0 s (0, 0, -9.81)\ngravity at 1 s (0, 0, -9.81)\n"),
    ):
        Scene.from_text("ground z 0.9 m\n" + lines + BALL + END, "same").run(tmp_path / f"{name}.out")
    with Trajectory(tmp_path / "one.out") as one, Trajectory(tmp_path / "two.out") as two:
        for frame in range(len(one)):
            assert np.array_equal(one.position(frame), two.position(frame))


def test_bounds_hold_at_all_times(tmp_path):
    """The region that a body can reach holds its path; the forecast of its speed, its speed."""
    scene = Scene.from_text(LINES + BALL + END, "flight")
    scene.run(tmp_path / "flight.out")
    reach = scene.prepared.context.reach
    with Trajectory(tmp_path / "flight.out") as trajectory:
        places, speeds = trajectory.centers[:, 0], np.linalg.norm(trajectory.center_velocities[:, 0], axis=1)
    assert (reach.region.low[0] <= places.min(axis=0)).all() and (places.max(axis=0) <= reach.region.high[0]).all()
    assert speeds.max() <= reach.speed[0]
    assert reach.acting.strongest >= np.linalg.norm(acceleration(np.linspace(0, 0.4, 1001)), axis=1).max()
    assert not reach.stands.any()


def test_lock():
    """The points are written, and read back the same; a constant is written as it was."""
    scene = parse_scene(LINES + BALL + END)
    assert (scene.gravity, scene.gravity_path) == (PATH[0][1], PATH)
    assert parse_scene(lock_text(scene), scene.name) == scene
    constant = parse_scene("gravity (0, 0, -9.81) m/s^2\n" + BALL + END)
    assert "gravity (0.0, 0.0, -9.81) m/s^2\n" in lock_text(constant)
    assert constant.gravity_path == parse_scene("gravity at 1 s (0, 0, -9.81) m/s^2\n" + BALL + END).gravity_path == ()


AT = "gravity at {} (0, 0, -9) m/s^2\n"
MISTAKES = [
    ("twice", "gravity (0, 0, -9) m/s^2\n" * 2 + BALL + END, 1, 1, "this one has no time", "gravity at 1 s"),
    ("one without time", AT.format("0 s") + "gravity (0, 0, -9) m/s^2\n" + BALL + END, 2, 1, "this one has no time", ""),
    ("back in time", AT.format("1 s") + AT.format("0.5 s") + BALL + END, 2, 1, "times of gravity must be >= 0 and rise", ""),
    ("twice at a time", AT.format("1 s") * 2 + BALL + END, 2, 1, "found 1 s after 1 s", ""),
    ("before the start", AT.format("-1 s") + AT.format("0.5 s") + BALL + END, 1, 1, "found -1 s", ""),
    ("a length for the time", AT.format("1 m") + BALL + END, 1, 12, "T of gravity must be a time", "ms"),
    ("no time", "gravity at (0, 0, -9) m/s^2\n" + BALL + END, 1, 27, "nothing follows", "e.g. gravity"),
    ("with a liquid", pool(gravity=AT.format("0 s") + AT.format("1 s")), 2, 1, "a liquid lies under one gravity",
     "write gravity once"),
    ("too many", f"repeat i in 0 .. {MOST_POINTS} {{ {AT.format('i*1 ms').strip()} }}\n" + BALL + END, 1, 26, "10 001 times",
     "10 000"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "line", "column", "words", "hint"), [m[1:] for m in MISTAKES], ids=[m[0] for m in MISTAKES])
def test_mistakes(text, line, column, words, hint):
    """Place, cause and way out."""
    problem = problem_of(text)
    assert (problem.line, problem.column) == (line, column), str(problem)
    assert words in problem.message
    assert hint in problem.hint


def test_forces_of_contact(shaken):
    """The impulse of gravity between two frames is known: a box that falls is touched by nothing, one on the ground is borne, and
    friction holds it by 0.3 of its weight at most."""
    from mdanim_lammps.results.motion import ContactForces

    _, whole, _ = shaken
    with Trajectory(whole) as trajectory:
        forces = ContactForces(trajectory)
        found = np.array([forces.since(frame) for frame in range(1, len(trajectory))])
        mass, names = trajectory.metadata.object_mass, list(trajectory.names)
    np.testing.assert_allclose(found[:5, names.index("far")], 0.0, atol=1e-5)  # points of the path lie within steps
    for name in ("cube[1]", "cube[2]", "cube[3]"):
        of, weight = found[2:, names.index(name)], 9.81 * mass[names.index(name)]
        assert of[:, 2].mean() == pytest.approx(weight, rel=0.05)
        assert 0.1 * weight < np.abs(of[:, 0]).max() and (np.abs(of[:, 0]) <= 0.3 * of[:, 2] + 1e-9).all()
