# SPDX-License-Identifier: GPL-2.0-only
"""The bits of joints: on ranks, in any order of particles, from restart files and records; and what is laid aside."""

from dataclasses import replace

import joint_lab as lab
import numpy as np
import plugin_lab
import pytest
import rigid_lab
import state_lab

WORDS = [
    "hinge 1 world at 0 0 0 axis 0 1 0 frequency 1000 friction 0.02 limits -1 1",
    "ball 2 1 at 0.4 0 0 frequency 1000 damping 3",
    "slider 3 2 at 0.8 0 0 axis 1 0 1 frequency 1000 motor 0.2 3.0 limits -0.1 0.1",
    "spring 3 4 from 1.2 0 0 to 1.3 0 0 stiffness 3e3 damping 2",
    "weld 4 5 at 1.6 0 0 patch 0.25 all stiffness 5e3 damping 1 breaks 16",
    "spring 5 1 from 1.9 0 0 to 0.3 0 0.05 stiffness 50 pulls-only length 1.5",
]
"""A chain of rigid boxes with an elastic one in it, which is let fall; the weld breaks on the way."""


def chain(folder, commands=(), words=WORDS, **more) -> lab.World:
    """The third and the last body stand turned."""
    q = rigid_lab.about((1, 0, 0), 0.3)
    bodies = [lab.box((0.4, 0.1, 0.05), 2.0, (0.2 + 0.4 * n, 0, 0), q if n == 2 else (1, 0, 0, 0)) for n in range(3)]
    soft = lab.elastic((3, 2, 2), 0.1, 600.0, 2e5, (1.3, -0.1, -0.1))
    soft = replace(soft, v=soft.v + 0.1 * np.random.default_rng(1).normal(size=soft.v.shape))
    bodies += [soft, lab.box((0.3, 0.1, 0.1), 1.0, (1.75, 0, 0), q, spin=(0, 3, 0))]
    return lab.World(folder, bodies, words, 3e-4, elastic=(4,), commands=tuple(commands), **more)


def test_bits_do_not_depend_on_ranks_or_order(tmp_path):
    """All ranks compute all joints, by sums in the order of tags."""
    world = chain(tmp_path, ["run 1500"])
    mixed = np.random.default_rng(3).permutation(len(world.body.x))
    forms = ({}, {"order": mixed, "ranks": 2}, {"ranks": 3})
    ends = [plugin_lab.in_child(world.body, tmp_path, world.script, **world.options, **form) for form in forms]
    assert len(set(ends)) == 1
    with chain(tmp_path) as alone:
        alone.run(1500)
        assert alone.number("broken") == 1.0 and alone.told("broken", 4) == 1.0
        assert alone.number("work") != 0.0 and alone.number("joint_heat") > 0.0


def test_a_restart_file_has_the_state(tmp_path):
    """Half a run, written, and the rest in a new instance, whose joints have no particles where the words say."""
    with chain(tmp_path) as world:
        world.run(700)
        world.lmp.command(f"write_restart {tmp_path}/half")
        world.lmp.command("run 0")
        world.run(300)
        expected, told = world.array("x"), world.rows()
    again = plugin_lab.restarted(tmp_path / "half", world.body, [*world.script, "run 300"], **world.options)
    assert np.array_equal(plugin_lab.by_tag(again, "x"), expected)
    assert [again.extract_fix("j", 0, 2, n, 2) for n in range(len(WORDS))] == told[:, 2].tolist()
    again.close()


def test_a_state_goes_on_elsewhere(tmp_path):
    """Records, positions, velocities and forces in another instance that was made at the start: the same bits from there on."""
    with chain(tmp_path) as first:
        first.run(700)
        state = {fix: state_lab.pack(first.lmp, fix) for fix in ("r", "j")}
        x, v, f = (first.array(name) for name in "xvf")
        told = first.rows()
        first.run(800)
        expected, records = first.array("x"), state_lab.pack(first.lmp, "j")
    with chain(tmp_path) as second:
        second.run(3)
        order = np.argsort(second.lmp.numpy.extract_atom("id")[: len(x)])
        for name, values in (("x", x), ("v", v)):
            second.lmp.numpy.extract_atom(name)[order] = values
        for fix, one in state.items():
            state_lab.put(second.lmp, fix, one)
        second.lmp.command("run 0 post no")
        for name, values in (("v", v), ("f", f)):
            second.lmp.numpy.extract_atom(name)[order] = values
        assert state_lab.pack(second.lmp, "j").same(state["j"])
        assert np.array_equal(second.rows()[:, 2], told[:, 2])
        second.run(800)
        assert np.array_equal(second.array("x"), expected) and state_lab.pack(second.lmp, "j").same(records)


def test_records_are_of_pairs_and_do_not_depend_on_numbers(tmp_path):
    """(1, 0) of the hinge to the world, (a, b) of others; a pair without a record begins anew."""
    with chain(tmp_path) as world:
        world.run(700)
        records = state_lab.pack(world.lmp, "j")
        assert records.key.tolist() == [[1, 0], [1, 2], [1, 5], [2, 3], [3, 4], [4, 5]]
        assert world.told("broken", 4) == 1.0
        state_lab.put(world.lmp, "j", records.without(4, 5))
        assert world.told("broken", 4) == 0.0
        state_lab.put(world.lmp, "j", records)
        assert world.told("broken", 4) == 1.0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda data: data[:-4], "is cut off"),
        (lambda data: np.r_[data, data[:8]], "is too long"),
        (lambda data: np.r_[data[:8] * 0, data[8:]], "has version 0, 2 is needed"),
        (lambda data: np.r_[data[:8], data[8:16] + 1, data[16:]], "is of joints of other kinds, or in another order"),
    ],
)
def test_damaged_records_are_refused(tmp_path, change, message):
    """With their objects; then nothing has changed."""
    with chain(tmp_path) as world:
        world.run(10)
        before = state_lab.pack(world.lmp, "j")
        data = change(before.record(1, 2))
        one = state_lab.Records(np.array([[1, 2]], np.int32), np.array([0, len(data)]), data.astype(np.uint8))
        with pytest.raises(RuntimeError, match=f"the record of the joints of 1 and 2 {message}"):
            state_lab.put(world.lmp, "j", one)
        assert state_lab.pack(world.lmp, "j").same(before)


def test_what_is_laid_aside_has_no_joints(tmp_path):
    """Particles that leave the group during a run take their joints with them; others go on as they are alone."""
    pair = "ball {} {} at {} 0 0 frequency 1000"
    bodies = [lab.box((0.4, 0.1, 0.1), 1.0, (0.5 * n, 0, 0), spin=(0, 0, 1.0 + n)) for n in range(4)]
    words = [pair.format(1, 2, 0.25), pair.format(3, 4, 1.25)]
    ends = []
    for aside in (False, True):
        with lab.World(tmp_path, bodies, words, 3e-4, gravity=(0, 0, 0), skin=0.05) as world:
            world.run(100)
            if aside:
                local = world.lmp.numpy.extract_atom("molecule")[: len(world.body.x)]
                put_aside = np.isin(local, (3, 4))
                world.lmp.numpy.extract_atom("mask")[: len(local)][put_aside] = 1
                world.lmp.numpy.extract_atom("x")[: len(local)][put_aside] += 0.2
                world.lmp.numpy.extract_atom("v")[: len(local)][put_aside] = 0.0
            world.run(100)
            ends.append(world.array("x")[:16])
            if aside:
                assert np.abs(world.array("f")[16:]).max() == 0.0
                assert state_lab.pack(world.lmp, "j").key.tolist() == [[1, 2]]
    assert np.array_equal(*ends)
