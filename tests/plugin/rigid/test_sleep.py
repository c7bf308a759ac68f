# SPDX-License-Identifier: GPL-2.0-only
"""Sleep of fix mdanim/rigid: what lies still is not moved, nor are its contacts looked at, until forces on it change."""

import numpy as np
import plugin_lab
import pytest
import rigid_lab as lab
import state_lab
from rigid_samples import G, tilted

SIDE = 0.1
RULE = "sleep 1e-4 1e-2 0.1"


def stacks(folder, words=RULE, ball=False, **more) -> lab.World:
    """Two stacks of three cubes and, after a flight of 0.4 s, a ball that strikes the foot of the first one."""
    bodies = [
        lab.box((SIDE, SIDE, SIDE), at=(x, 0, SIDE * (n + 0.5)), q=lab.about((0, 0, 1), 0.2 * n))
        for x in (0, 0.3)
        for n in range(3)
    ]
    flies = 0.4
    if ball:
        start = (-0.1 - 2 * flies, 0.01, 0.05)
        bodies.append(lab.ball(0.04, 12000.0, at=start, v=(2, 0, 0.5 * G * flies)))
    return lab.World(folder, bodies, frequency=lab.frequency_of(1.0, SIDE), words=words, **more)


def state(world) -> tuple[bytes, bytes]:
    """Bodies, and all numbers of their contacts, at the end of a step."""
    return world.rows().tobytes(), state_lab.pack(world.lmp, "r").data.tobytes()


def test_what_lies_still_sleeps_where_it_was(tmp_path):
    """A tenth of a second after it has come to rest, and not a bit farther on; where it lies without the word, as deep, and with
    the energy that contacts hold."""
    with stacks(tmp_path) as run, stacks(tmp_path, words="") as awake:
        for each in (run, awake):
            each.run(600)
        assert run.number("asleep") == 6 and awake.number("asleep") == 0
        rows = run.rows()
        run.run(100)
        assert (run.rows() == rows).all() and not rows[:, 3:6].any()
        assert np.abs(rows - awake.rows()).max() < 1e-5 * SIDE
        for name in ("contact", "touching"):
            assert run.number(name) == pytest.approx(awake.number(name), rel=1e-4)
        assert 0.0 < run.number("stilled") < 1e-7
        assert run.energy() + run.number("stilled") == pytest.approx(awake.energy(), rel=1e-9)
        for each in (run, awake):
            each.lmp.command("run 1")
        assert run.number("deepest") == pytest.approx(awake.number("deepest"), rel=1e-4)


def test_what_is_struck_wakes(tmp_path):
    """A ball strikes the foot of a stack out: what stood on it falls as if it had never slept, and then sleeps again. The other
    stack sleeps on until it is struck."""
    with stacks(tmp_path, ball=True) as run, stacks(tmp_path, words="", ball=True) as awake:
        for each in (run, awake):
            each.run(571)
        assert run.number("asleep") == 6
        for each in (run, awake):
            each.run(50)
        assert 3 <= run.number("asleep") < 6
        apart = np.abs(run.rows()[:, :3] - awake.rows()[:, :3]).max()
        for each in (run, awake):
            each.run(300)
        assert max(run.rows()[2, 2], awake.rows()[2, 2]) < 2.2 * SIDE
        assert apart < 1e-4 * SIDE
        run.run(7000)  # two cubes rock on a third
        assert run.number("asleep") >= 6
        lost = run.energy() + run.number("stilled") - awake.energy()
        assert abs(lost) < 1e-4 * awake.energy()


def test_what_is_pulled_wakes(tmp_path):
    """Gravity turns while all sleep, first a little, then beyond what friction holds: a cube slides as closed form has it."""
    cube = [lab.box((0.2, 0.2, SIDE), at=(0, 0, SIDE / 2), mu=0.3)]
    with lab.World(tmp_path, cube, frequency=lab.frequency_of(1.0, SIDE), words=RULE) as run:
        run.run(500)
        assert run.number("asleep") == 1
        for tangent in (0.2, 0.5):
            g, sine, cosine = tilted(tangent)
            run.lmp.commands_list(["unfix g", f"fix g all mdanim/gravity {' '.join(map(repr, map(float, g)))}", "run 1"])
            assert run.number("asleep") == 0
            before = run.rows()[0, 3]
            run.run(300)
            assert run.number("asleep") == (tangent == 0.2)
            slides = max(0.0, sine - 0.3 * cosine) * G * 300 * run.dt
            assert run.rows()[0, 3] - before == pytest.approx(slides, rel=5e-3, abs=1e-3)


def test_bits_do_not_depend_on_ranks_or_on_what_is_remembered(tmp_path):
    """Stacks sleep, and one is struck: on three ranks, with a state that is put back after each step, and from a restart file."""
    options = {"cutoff": 0.2, "skin": 0.1}
    with stacks(tmp_path, ball=True) as world:
        world.run(560)
        before = state_lab.pack(world.lmp, "r")
        assert world.number("asleep") == 6
        world.lmp.command(f"write_restart {tmp_path / 'half'}")
        world.run(60)
        assert world.number("asleep") < 6
        end = state(world)
        state_lab.put(world.lmp, "r", before)
        for _ in range(60):
            world.lmp.command("run 1")
            state_lab.put(world.lmp, "r", state_lab.pack(world.lmp, "r"))
        assert state(world) == end
        x = plugin_lab.by_tag(world.lmp, "x")
    again = plugin_lab.restarted(tmp_path / "half", world.setup, [*world.commands, "run 60"], **options)
    assert np.array_equal(plugin_lab.by_tag(again, "x"), x)
    again.close()
    mixed = np.random.default_rng(3).permutation(len(x))
    found = plugin_lab.in_child(world.setup, tmp_path, [*world.commands, "run 620"], **options, ranks=3, order=mixed)
    assert (np.loadtxt(found.splitlines()[1:])[:, 1:4] == x).all()


def test_velocities_that_are_set_wake_all(tmp_path):
    """Between two runs."""
    with stacks(tmp_path) as run:
        run.run(600)
        run.lmp.numpy.extract_atom("v")[:8] += (0.1, 0, 0)
        run.lmp.command("run 0")
        assert run.number("asleep") == 0


@pytest.mark.parametrize("words", ["sleep 0 1 1", "sleep 1 -1 1", "sleep 1 1 0"])
def test_a_rule_of_nothing_is_refused(tmp_path, words):
    """Speed, acceleration and time are above 0."""
    with pytest.raises(Exception, match="speed, acceleration and time of sleep must be above 0"):
        stacks(tmp_path, words=words).__enter__()
