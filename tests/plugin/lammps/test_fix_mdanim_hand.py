# SPDX-License-Identifier: GPL-2.0-only
"""fix mdanim/hand: the force against numpy, work, hands that come between two runs, passes, and what is refused.
Ranks are in tests/parallel/runtime/test_drives.py."""

import numpy as np
import plugin_lab as lab
import pytest

BLOCK = lab.block((2, 2, 3))
DT = 0.02
LOOSE = "bond_coeff * 0.0 1.0"
MOVE = "fix run all mdanim/leapfrog"
STRENGTH = "stiffness 2.5 damping 0.4 most 5 particles 3 1 0.5 2 0.75 4 -0.25"
KEYS = ((0.1, (0.0, 0.0, 0.0)), (0.5, (0.3, -0.2, 0.4)), (0.9, (0.3, 0.5, 0.4)))
WORDS = STRENGTH + "".join(f" key {t} {x} {y} {z}" for t, (x, y, z) in KEYS)
ROWS, WEIGHTS = np.array([0, 1, 3]), np.array([0.5, 0.75, -0.25])


def hand(tmp_path, words: str = WORDS) -> list[str]:
    (tmp_path / "hands").write_text(f"{words} # as it is\n")
    return [f"fix pull all mdanim/hand hands {tmp_path}/hands", f"timestep {DT}"]


def test_force_is_that_of_the_twin(tmp_path):
    """k (a - p) + c (u - v) at the mean of three particles, shared by their weights; nothing up to the first key, and behind the
    last."""
    lmp = lab.load(BLOCK, tmp_path, [LOOSE, MOVE, *hand(tmp_path)])
    for step in (4, 5, 6, 20, 25, 26, 45, 46):
        lmp.command(f"run {step - 1 - lmp.extract_global('ntimestep')}")
        before = lab.by_tag(lmp, "x")
        lmp.command("run 1 pre no")
        t, x, f = step * DT, lab.by_tag(lmp, "x"), lab.by_tag(lmp, "f")
        v = (x - before) / DT  # of half a step before
        expected = np.zeros(3)
        if 0.11 < t < 0.91:
            n = 0 if t < 0.51 else 1
            (begin, a), (end, b) = KEYS[n], KEYS[n + 1]
            a, b = np.array(a), np.array(b)
            place, speed = a + (t - begin) / (end - begin) * (b - a), (b - a) / (end - begin)
            expected = 2.5 * (place - WEIGHTS @ x[ROWS]) + 0.4 * (speed - WEIGHTS @ v[ROWS])
            assert np.linalg.norm(expected) < 5.0
        np.testing.assert_allclose(f[ROWS], WEIGHTS[:, None] * expected, rtol=0, atol=1e-12)
        assert not np.delete(f, ROWS, axis=0).any()
    lmp.close()


def test_no_force_is_larger_than_the_largest(tmp_path):
    lmp = lab.load(BLOCK, tmp_path, [LOOSE, *hand(tmp_path, WORDS.replace("most 5", "most 0.125")), "reset_timestep 20", "run 0"])
    assert np.linalg.norm(lab.by_tag(lmp, "f").sum(0)) == pytest.approx(0.125, rel=1e-12)
    lmp.close()


def test_work_is_the_energy_of_what_moves(tmp_path):
    """With springs, in passes and in plain steps, whose bits are the same."""
    found = {}
    for style in ("verlet", "verlet/mdanim"):
        lmp = lab.load(BLOCK, tmp_path, [MOVE, *hand(tmp_path), f"run_style {style}", "run 70"])
        kinetic = 0.5 * (BLOCK.mass[:, None] * lab.by_tag(lmp, "v") ** 2).sum()
        found[style] = lab.by_tag(lmp, "x"), lab.by_tag(lmp, "v"), lmp.extract_fix("pull", 0, 1, 0)
        assert kinetic > 1e-3
        assert found[style][2] == pytest.approx(kinetic + lmp.get_thermo("ebond"), rel=1e-3)
        lmp.close()
    for a, b in zip(*found.values()):
        assert np.array_equal(a, b)


@pytest.mark.parametrize("style", ["verlet", "verlet/mdanim"])
def test_a_hand_that_comes_between_two_runs_is_the_same(tmp_path, style):
    """Taken up at a step, brought on key by key without a new setup, let go, and taken up by another hand at once."""
    second = STRENGTH.replace("2.5", "1.5") + " key 0.9 0 0 0 key 1.1 0.1 0 0"
    pulled = [*hand(tmp_path, f"{WORDS}\n{second}"), f"run_style {style}"]
    found = []
    for commands in (
        [*pulled, "run 60"],
        [
            *("fix pull all mdanim/hand", f"timestep {DT}", f"run_style {style}", "run 5"),
            f"fix_modify pull hold {STRENGTH} key 0.1 0 0 0",
            *("fix_modify pull key 0.5 0.3 -0.2 0.4", "run 20 pre no", "fix_modify pull key 0.9 0.3 0.5 0.4", "run 20 pre no"),
            *(f"fix_modify pull hold {STRENGTH.replace('2.5', '1.5')} key 0.9 0 0 0", "fix_modify pull key 1.1 0.1 0 0"),
            "run 15 pre no",
        ],
    ):
        lmp = lab.load(BLOCK, tmp_path, [MOVE, *commands])
        found.append((lab.by_tag(lmp, "x"), lab.by_tag(lmp, "v"), lmp.extract_fix("pull", 0, 1, 0)))
        lmp.close()
    for a, b in zip(*found):
        assert np.array_equal(a, b)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("pull 1 2 3", "stiffness is expected, got pull"),
        ("stiffness 1 damping 1 most 0 particles 1 1 1", "the largest force must be above 0"),
        ("stiffness 1 damping 1 most 1 particles 0", "a hand holds on to one particle at least"),
        ("stiffness 1 damping 1 most 1 particles 2 1 1", "the number of particles is more than the line has"),
        ("stiffness 1 damping 1 most 1 particles 1 1.5 1", "a particle is told by its ID, a whole number"),
        ("stiffness 1 damping 1 most 1 particles 1 9999 1 key 0 0 0 0", "particle 9999, which it holds on to, is gone"),
        ("stiffness 1 damping 1 most 1 particles 1 1 1 key 1 0 0 0 key 1 0 0 0", "times of keys rise, got 1 after 1"),
    ],
)
def test_what_is_refused(tmp_path, words, message):
    with pytest.raises(Exception, match=message):
        lab.load(BLOCK, tmp_path, [LOOSE, *hand(tmp_path, words), "run 0"])


def test_a_key_of_no_hand_is_refused(tmp_path):
    with pytest.raises(Exception, match="there is no hand that the key is of; write hold first"):
        lab.load(BLOCK, tmp_path, ["fix pull all mdanim/hand", "fix_modify pull key 1 0 0 0"])


def test_a_restart_file_has_the_last_force(tmp_path):
    """Two hands pull at one object from one time on: the work of each goes on, as places do, as if nothing had been."""
    script = [MOVE, *hand(tmp_path, f"{WORDS}\n{WORDS.replace('2.5', '1.5').replace('0.4 most', '0.8 most')}")]
    lmp = lab.load(BLOCK, tmp_path, [*script, "run 20", f"write_restart {tmp_path}/half"])
    half = lmp.extract_fix("pull", 0, 1, 0)
    lmp.command("run 20 pre no")
    whole, x = lmp.extract_fix("pull", 0, 1, 0), lab.by_tag(lmp, "x").copy()
    lmp.close()
    again = lab.restarted(tmp_path / "half", BLOCK, [*script, "run 20"])
    np.testing.assert_array_equal(lab.by_tag(again, "x"), x)
    assert half + again.extract_fix("pull", 0, 1, 0) == pytest.approx(whole, rel=1e-14)
    again.close()
