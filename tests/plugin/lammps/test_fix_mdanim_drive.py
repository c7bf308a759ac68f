# SPDX-License-Identifier: GPL-2.0-only
"""fix mdanim/drive: places and velocities against numpy, the work that it takes, restart files, ranks, and what is refused."""

from itertools import pairwise

import numpy as np
import plugin_lab as lab
import pytest
from twin.drives import Motion

BLOCK = lab.block((2, 2, 3))
DT, STEPS = 0.02, 60
MOTIONS = {
    "velocity": Motion(velocity=(0.3, 0.1, -0.2)),
    "turn": Motion(turn=(0.3, -2.0, 1.0), about=(1.0, 0.5, 2.0)),
    "oscillation": Motion(oscillations=[((0.2, 0.0, 0.1), 1.5, 0.0), ((0.0, 0.1, 0.0), 3.1, 0.25)]),
    "keys": Motion(
        pivot=(1.0, 1.0, 1.5),
        keys=[
            (0.0, (0, 0, 0), (0, 0, 0)),
            (0.3, (1, 0, 0), (0, 0, 1)),
            (0.5, (1, 1, 0), (0, 0.5, 7)),
            (0.9, (0, 0, 2), (0, 0, 0)),
        ],
    ),
    "late keys": Motion(pivot=(1, 1, 1), keys=[(0.4, (0, 0, 0), (0, 0, 0)), (0.8, (0.5, 0, 0), (2.0, 0, 0))]),
}
MOTIONS["all at once"] = Motion(
    velocity=(0.3, 0.1, -0.2),
    turn=(0.0, 1.0, 0.4),
    about=(0.0, 3.0, 0.0),
    oscillations=MOTIONS["oscillation"].oscillations,
    pivot=MOTIONS["keys"].pivot,
    keys=MOTIONS["keys"].keys,
)
LOOSE = "bond_coeff * 0.0 1.0"


def drive(words: str, group: str = "all") -> list[str]:
    return [f"fix drive {group} mdanim/drive {words}", f"timestep {DT}"]


@pytest.mark.parametrize("name", MOTIONS)
def test_places_and_mean_velocities(tmp_path, name):
    """At each step, in two runs: the places of the twin, and their difference over the step before and the next one."""
    motion = MOTIONS[name]
    lmp = lab.load(BLOCK, tmp_path, [LOOSE, *drive(motion.words())])
    for step in range(1, STEPS + 1):
        lmp.command("run 1" if step in (1, STEPS // 2) else "run 1 pre no post no")
        before, now, after = (motion.places(BLOCK.x, (step + more) * DT) for more in (-1, 0, 1))
        np.testing.assert_allclose(lab.by_tag(lmp, "x"), now, rtol=0, atol=3e-14)
        np.testing.assert_allclose(lab.by_tag(lmp, "v"), (after - before) / (2 * DT), rtol=0, atol=3e-12)
    lmp.close()


WAITS = {
    "a lift": [(0.2, 0.0), (0.6, 2.0), (0.8, 2.0), (1.0, 0.5)],
    "small and large ways": [(0.1, 1e-3), (0.5, 1.0), (0.52, 1.001), (1.0, 50.0)],
    "to and fro": [(0.2, 1.0), (0.3, -1.0), (0.7, 3.0), (1.0, 2.0)],
}


@pytest.mark.parametrize("name", WAITS)
@pytest.mark.parametrize("of", ["way", "angle"])
def test_keys_hold(tmp_path, name, of):
    """Between two keys it stays between them: two that are equal mean that it stands, in all digits. It is at each key."""
    keys = [(0.0, 0.0), *WAITS[name]]
    direction = {"way": (1.0, -0.5, 0.0, 0.0, 0.0, 0.0), "angle": (0.0, 0.0, 0.0, 0.0, 0.0, 0.05)}[of]
    words = " ".join(f"key {t} {' '.join(str(p * d) for d in direction)}" for t, p in keys)
    lmp = lab.load(BLOCK, tmp_path, [LOOSE, *drive(f"pivot 0 0 0 {words}")])
    found = [0.0]
    for step in range(1, STEPS + 1):
        lmp.command("run 1" if step == 1 else "run 1 pre no post no")
        (x, y), (start, beside) = lab.by_tag(lmp, "x")[-1, :2], BLOCK.x[-1, :2]
        turned = np.arctan2(y * start - x * beside, x * start + y * beside)
        found.append(x - start if of == "way" else turned / 0.05)
    lmp.close()
    times, found = DT * np.arange(STEPS + 1), np.array(found)
    for (t, p), (u, q) in pairwise(keys):
        here = found[(times > t - 1e-9) & (times < u + 1e-9)]
        assert here[[0, -1]] == pytest.approx([p, q], abs=1e-11)
        assert here.min() >= min(p, q) - 1e-11 and here.max() <= max(p, q) + 1e-11
        assert p != q or len(set(here[:-1].tolist())) == 1


def test_slopes_at_keys(tmp_path):
    """By hand: between ways of 1 and 3 in 0.4 each the slope is the mean, 5; between 0.1 and 3 it is three times that of the
    smaller one, 0.75, instead of 3.875. Half-way between two keys p is their mean and h/8 of the difference of their slopes."""
    for rise, slope in ((1.0, 5.0), (0.1, 0.75)):
        words = f"key 0 0 0 0 0 0 0 key 0.4 {rise} 0 0 0 0 0 key 0.8 {rise + 3.0} 0 0 0 0 0"
        lmp = lab.load(BLOCK, tmp_path, [LOOSE, *drive(words)])
        for half, ends in ((0.5 * rise, (0.0, slope)), (rise + 1.5, (slope, 0.0))):
            lmp.command(f"run {10 if half < rise else 20}")
            way = lab.by_tag(lmp, "x")[0, 0] - BLOCK.x[0, 0]
            assert way == pytest.approx(half + 0.4 / 8.0 * (ends[0] - ends[1]), abs=1e-13)
        lmp.close()


def test_the_setup_sets_the_same_velocities(tmp_path):
    """A run that begins in the middle has the velocities that it would have had."""
    lmp = lab.load(BLOCK, tmp_path, [LOOSE, *drive(MOTIONS["all at once"].words()), "run 7 post no"])
    v = lab.by_tag(lmp, "v")
    lmp.command("run 0")
    assert np.array_equal(lab.by_tag(lmp, "v"), v)
    lmp.close()


@pytest.mark.parametrize("since", [0, -50])
def test_a_run_of_no_step_changes_nothing(tmp_path, since):
    """At the setup of step 0 velocities are those of whole steps, as at any other; work counts from there."""
    motion = MOTIONS["all at once"]
    found = []
    for first in ([], ["run 0"], ["run 0", "run 4"]):
        commands = [LOOSE, "fix g all mdanim/gravity 0.5 0 -9.81", *drive(f"since {since} {motion.words()}"), *first]
        lmp = lab.load(BLOCK, tmp_path, [*commands, f"run {10 - 4 * (len(first) == 2)}"])
        found.append((lab.by_tag(lmp, "v"), lab.by_tag(lmp, "x"), lmp.extract_fix("drive", 0, 1, 0)))
        lmp.close()
    for v, x, work in found[1:]:
        assert np.array_equal(v, found[0][0]) and np.array_equal(x, found[0][1]) and work == found[0][2]


def test_velocities_at_step_0(tmp_path):
    """Mean velocities of the steps before and after it, by the twin."""
    motion = MOTIONS["all at once"]
    lmp = lab.load(BLOCK, tmp_path, [LOOSE, *drive(motion.words()), "run 0"])
    expected = (motion.places(BLOCK.x, DT) - motion.places(BLOCK.x, -DT)) / (2 * DT)
    np.testing.assert_allclose(lab.by_tag(lmp, "v"), expected, rtol=0, atol=1e-11)
    lmp.close()


def test_work_against_gravity(tmp_path):
    """A force that stays: -F dx, to rounding."""
    motion = MOTIONS["all at once"]
    commands = [LOOSE, "fix g all mdanim/gravity 0.5 0 -9.81", *drive(motion.words()), f"run {STEPS}"]
    lmp = lab.load(BLOCK, tmp_path, commands)
    way = motion.places(BLOCK.x, STEPS * DT) - BLOCK.x
    assert lmp.extract_fix("drive", 0, 1, 0) == pytest.approx(-(BLOCK.mass[:, None] * way * [0.5, 0.0, -9.81]).sum(), rel=1e-11)
    lmp.close()


def test_work_is_the_energy_that_springs_and_masses_get(tmp_path):
    """The lower end of a bar shakes: what is brought in is what the bar has, to the order of the step."""
    bar = lab.block((1, 1, 6))
    off = []
    for refined in (1, 2):
        commands = [
            "region foot block INF INF INF INF INF 0.5", "group foot region foot", "group free subtract all foot",
            "fix drive foot mdanim/drive oscillation 0.05 0 0.1 0.08 0.0", "fix run free mdanim/leapfrog",
            f"timestep {0.02 / refined}", f"run {500 * refined}",
        ]  # fmt: skip
        lmp = lab.load(bar, tmp_path, commands)
        free = bar.x[:, 2] > 0.5
        energy = 0.5 * (bar.mass[:, None] * lab.by_tag(lmp, "v") ** 2)[free].sum() + lmp.get_thermo("ebond")
        work = lmp.extract_fix("drive", 0, 1, 0)
        lmp.close()
        assert energy > 0.01
        off.append(abs(work - energy) / energy)
    assert off[0] < 1e-3 and off[1] < 0.35 * off[0]  # second order: a quarter


def test_motions_of_objects_from_a_file(tmp_path):
    """Each object has its own line; one without is refused where it is in the group."""
    two = lab.join(BLOCK, lab.block((1, 1, 1), corner=(5.0, 0.0, 0.0)))
    first, second = MOTIONS["turn"], MOTIONS["keys"]
    (tmp_path / "motions").write_text(f"# two\n1 {first.words()}\n2 {second.words()}\n")
    lmp = lab.load(two, tmp_path, [LOOSE, *drive(f"motions {tmp_path}/motions"), f"run {STEPS}"])
    x = lab.by_tag(lmp, "x")
    lmp.close()
    for molecule, motion in ((1, first), (2, second)):
        of = two.molecule == molecule
        np.testing.assert_allclose(x[of], motion.places(two.x[of], STEPS * DT), rtol=0, atol=3e-14)
    (tmp_path / "motions").write_text(f"1 {first.words()}\n")
    with pytest.raises(Exception, match=r"no motion is given for object 2 \(molecule ID\)"):
        lab.load(two, tmp_path, [LOOSE, *drive(f"motions {tmp_path}/motions"), "run 0"])


def test_same_bits_on_any_number_of_ranks(tmp_path):
    """Particles wander from rank to rank; places at the start go with them."""
    commands = [*drive(MOTIONS["all at once"].words()), f"run {STEPS}"]
    one, three = (lab.in_child(BLOCK, tmp_path, commands, ranks=ranks) for ranks in (1, 3))
    assert one == three


def test_a_restart_file_carries_it_on(tmp_path):
    """Time, places at the start and work; the script defines the fix again."""
    words = MOTIONS["all at once"].words()
    field = "fix g all mdanim/gravity 0 0 -1"
    lmp = lab.load(BLOCK, tmp_path, [LOOSE, field, *drive(words), "run 20", f"write_restart {tmp_path}/r", "run 20"])
    x, work = lab.by_tag(lmp, "x"), lmp.extract_fix("drive", 0, 1, 0)
    lmp.close()
    again = lab.restarted(tmp_path / "r", BLOCK, [field, *drive(words), "run 20"])
    assert np.array_equal(lab.by_tag(again, "x"), x)
    assert again.extract_fix("drive", 0, 1, 0) == pytest.approx(work, rel=1e-13)
    again.close()


def test_a_restart_file_with_another_time_step_is_refused(tmp_path):
    """Its steps are not those of the new time step."""
    lmp = lab.load(BLOCK, tmp_path, [LOOSE, *drive("velocity 1 0 0"), "run 20", f"write_restart {tmp_path}/r"])
    lmp.close()
    again = lab.restarted(tmp_path / "r", BLOCK, [*drive("velocity 1 0 0"), "timestep 0.001"])
    with pytest.raises(Exception, match=r"the time step has changed from 0\.02 to 0\.001"):
        again.command("run 1")
    again.close()


@pytest.mark.parametrize(("words", "told"), [
    ("", "there is no motion; write velocity, turn, oscillation or key"),
    ("velocity 1 2", "the velocity is missing"), ("velocity 1 2 a", "a is not a number; it stands for the velocity"),
    ("spin 1 2 3", "a motion is velocity, turn, oscillation, pivot, key or until, got spin"),
    ("turn 0 0 1 0 0 0 turn 0 0 1 0 0 0", "a second turn"),
    ("oscillation 1 0 0 -1 0", "frequency of an oscillation must be at least 0"),
    ("key 1 0 0 0 0 0 0 key 1 0 0 1 0 0 0", "times of keys ascend, got 1 behind 1"),
    ("home d_x velocity 1 0 0", "d2_NAME, got d_x"),
    ("home d2_none velocity 1 0 0", "there is no property d2_none of three numbers"),
    ("motions f more", "motions FILE ends the command"),
])  # fmt: skip
def test_words(tmp_path, words, told):
    """Words that are missing, no number, unknown, or against the order."""
    with pytest.raises(Exception, match=told):
        lab.load(BLOCK, tmp_path, [LOOSE, *drive(words), "run 0"])


def test_another_time_step_is_refused(tmp_path):
    """Places are functions of the step: they would jump."""
    with pytest.raises(
        Exception, match=r"the time step has changed from 0\.02 to 0\.01, and places would jump; define the fix anew"
    ):
        lab.load(BLOCK, tmp_path, [LOOSE, *drive("velocity 1 0 0"), "run 1", "timestep 0.01", "run 1"])
