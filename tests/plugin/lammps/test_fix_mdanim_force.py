# SPDX-License-Identifier: GPL-2.0-only
"""fix mdanim/force: forces of particles against numpy, impulses of windows, work, ranks, and what is refused."""

from dataclasses import replace

import numpy as np
import plugin_lab as lab
import pytest

BLOCK = lab.block((2, 2, 3))
TWO = lab.join(BLOCK, lab.block((1, 1, 2), corner=(5.0, 0.0, 0.0)))
DT = 0.02
LOOSE = "bond_coeff * 0.0 1.0"
MOVE = "fix run all mdanim/leapfrog"


def force(words: str, group: str = "all") -> list[str]:
    return [f"fix push {group} mdanim/force {words}", f"timestep {DT}"]


def twin(x, mass, push=(0.0, 0.0, 0.0), torque=(0.0, 0.0, 0.0)) -> np.ndarray:
    """m (F/M + (I^-1 T) x (x - c)) on each particle."""
    arm = x - mass @ x / mass.sum()
    inertia = np.einsum("i,i,jk->jk", mass, (arm**2).sum(1), np.eye(3)) - np.einsum("i,ij,ik->jk", mass, arm, arm)
    return mass[:, None] * (np.array(push) / mass.sum() + np.cross(np.linalg.solve(inertia, torque), arm))


def test_forces_are_those_of_the_twin(tmp_path):
    """Two objects by their lines of a file; the sums are what was asked for."""
    push, torque = (0.3, -0.2, 0.1), (0.5, 1.5, -0.7)
    (tmp_path / "forces").write_text("1 force 0.3 -0.2 0.1 torque 0.5 1.5 -0.7\n2 torque 0 0 2 # turns\n")
    lmp = lab.load(TWO, tmp_path, [LOOSE, *force(f"forces {tmp_path}/forces"), "run 0"])
    f = lab.by_tag(lmp, "f")
    lmp.close()
    for molecule, of_twin in ((1, (push, torque)), (2, ((0, 0, 0), (0, 0, 2)))):
        of = TWO.molecule == molecule
        x, mass = TWO.x[of], TWO.mass[of]
        np.testing.assert_allclose(f[of], twin(x, mass, *of_twin), rtol=0, atol=1e-13)
        np.testing.assert_allclose(f[of].sum(0), of_twin[0], rtol=0, atol=1e-13)
        np.testing.assert_allclose(np.cross(x - mass @ x / mass.sum(), f[of]).sum(0), of_twin[1], rtol=0, atol=1e-12)


@pytest.mark.parametrize(("begin", "end"), [(0.0, 0.31), (0.117, 0.4), (0.205, 0.213), (0.2, 0.26)])
@pytest.mark.parametrize("dt", [0.02, 0.013])
def test_a_window_gives_the_impulse_of_its_length(tmp_path, begin, end, dt):
    """F (T2 - T1), to rounding, where neither end is at a step, and where it is shorter than one."""
    commands = [LOOSE, MOVE, *force(f"force 3 0 -1 from {begin} to {end}"), f"timestep {dt}", "run 60"]
    lmp = lab.load(BLOCK, tmp_path, commands)
    np.testing.assert_allclose(
        BLOCK.mass @ lab.by_tag(lmp, "v"), (end - begin) * np.array([3.0, 0.0, -1.0]), rtol=1e-12, atol=1e-14
    )
    lmp.close()


@pytest.mark.parametrize("words", ["force 0.02 0 0.01", "force 0.02 0 0 from 0.3 to 2.2 torque 0 0.05 0.1 from 1.01"])
def test_work_is_the_energy_of_what_moves(tmp_path, words):
    """With springs, in passes and in plain steps, whose bits are the same."""
    found = {}
    for style in ("verlet", "verlet/mdanim"):
        lmp = lab.load(TWO, tmp_path, [MOVE, *force(words), f"run_style {style}", "run 200"])
        kinetic = 0.5 * (TWO.mass[:, None] * lab.by_tag(lmp, "v") ** 2).sum()
        found[style] = lab.by_tag(lmp, "x"), lab.by_tag(lmp, "v"), lmp.extract_fix("push", 0, 1, 0)
        assert kinetic > 1e-3
        assert found[style][2] == pytest.approx(kinetic + lmp.get_thermo("ebond"), rel=2e-4)
        lmp.close()
    for a, b in zip(*found.values()):
        assert np.array_equal(a, b)


def test_same_bits_on_any_number_of_ranks(tmp_path):
    """Sums do not depend on where particles are."""
    commands = [MOVE, *force("force 0.3 0 0 from 0.1 torque 0 0 2 to 0.9"), "run 60"]
    one, three = (lab.in_child(TWO, tmp_path, commands, ranks=ranks) for ranks in (1, 3))
    assert one == three


def test_a_run_cut_in_two_is_the_same(tmp_path):
    """Windows are those of steps, not of runs; work counts on."""
    found = []
    for runs in (["run 60"], ["run 23", "run 37"]):
        lmp = lab.load(TWO, tmp_path, [MOVE, *force("force 0.3 0 0 from 0.1 to 0.77 torque 0 0 2 to 0.9"), *runs])
        found.append((lab.by_tag(lmp, "x"), lab.by_tag(lmp, "v"), lmp.extract_fix("push", 0, 1, 0)))
        lmp.close()
    for a, b in zip(*found):
        assert np.array_equal(a, b)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("", "there is no force; write force fx fy fz"),
        ("push 1 2 3", "a force is force or torque, then from and to; got push"),
        ("force 1 2", "the force is missing"),
        ("from 1 force 1 2 3", "got from"),
        ("force 1 2 3 from 2 to 1", "a force ends after it begins"),
        ("force 1 2 3 from 1 from 2", "from stands twice"),
        ("forces nowhere", "nowhere"),
    ],
)
def test_what_is_refused(tmp_path, words, message):
    with pytest.raises(Exception, match=message):
        lab.load(BLOCK, tmp_path, [LOOSE, *force(words), "run 0"])


def test_an_object_without_a_line_is_refused(tmp_path):
    (tmp_path / "forces").write_text("1 force 0.3 -0.2 0.1\n")
    with pytest.raises(Exception, match=r"no force is given for object 2 \(molecule ID\)"):
        lab.load(TWO, tmp_path, [LOOSE, *force(f"forces {tmp_path}/forces"), "run 0"])


def test_a_line_of_particles_is_not_turned_about_itself(tmp_path):
    line = replace(BLOCK, x=BLOCK.x.sum(1, keepdims=True) * np.array([1.0, 0.0, 0.0]))
    with pytest.raises(Exception, match="stand on a line"):
        lab.load(line, tmp_path, [LOOSE, *force("torque 1 0 0"), "run 0"])
