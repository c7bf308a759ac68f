# SPDX-License-Identifier: GPL-2.0-only
"""fix mdanim/yield: by how much springs grow in which step, against a naive form in numpy; energies, ranks, refusals."""

from dataclasses import replace

import numpy as np
import plugin_lab as lab
import pytest

MOVE = "fix run all mdanim/leapfrog"
SLOTS = 20
STATE = f"fix state all property/atom d2_grown {SLOTS} d2_bears {SLOTS}"
DT = 0.1
MOST = 0.06
BLOCK = lab.block((3, 2, 2))
PULLED = replace(BLOCK, v=0.2 * (BLOCK.x - BLOCK.x.mean(0)) * np.array([1.0, 0.3, -0.7]))


def yielding(most=MOST) -> list[str]:
    """All bonds bear this stretch."""
    return [
        STATE,
        *(f"set group all d2_bears[{slot}] {most}" for slot in range(1, SLOTS + 1)),
        "fix yield all mdanim/yield grown grown bears bears",
    ]


def twin(body: lab.Body, steps: int, dt: float):
    """Places, velocities and growth of springs: leap-frog, where all springs are looked at before the forces of each step."""
    x, v, grown = body.x.copy(), body.v.copy(), np.zeros(len(body.bond))
    i, j = body.bond.T

    def forces(moves: bool):
        d = x[i] - x[j]
        r = np.linalg.norm(d, axis=1)
        if moves:
            beyond = r - body.r0 - grown
            grown[:] = np.where(np.abs(beyond) > MOST, r - body.r0 - np.sign(beyond) * MOST, grown)
        pull = (-body.k * (r - body.r0 - grown) / r)[:, None] * d
        f = np.zeros_like(x)
        np.add.at(f, i, pull)
        np.add.at(f, j, -pull)
        return f

    f = forces(False)
    for _ in range(steps):
        v += 0.5 * dt * f / body.mass[:, None]
        x += dt * v
        f = forces(True)
        v += 0.5 * dt * f / body.mass[:, None]
    return x, v, grown


def of_bonds(body: lab.Body, rows: np.ndarray, end: int) -> np.ndarray:
    """Values of bonds by the rows of particles, which have them in the order of their partners."""
    order = {i: sorted(q for pair in body.bond.tolist() if i in pair for q in pair if q != i) for i in range(len(body.x))}
    return np.array([rows[pair[end], order[pair[end]].index(pair[1 - end])] for pair in body.bond.tolist()])


@pytest.mark.parametrize("steps", [2, 12, 60])
def test_springs_grow_as_in_the_naive_form(tmp_path, steps):
    """Places, and the same growth at both ends."""
    lmp = lab.load(PULLED, tmp_path, [*yielding(), MOVE, f"timestep {DT}", f"run {steps}"])
    x, v, rows = (lab.by_tag(lmp, name) for name in ("x", "v", "d2_grown"))
    lmp.close()
    at, speed, grown = twin(PULLED, steps, DT)
    assert grown.any() == (steps > 2)
    np.testing.assert_allclose(x, at, rtol=0, atol=1e-11)
    np.testing.assert_allclose(v, speed, rtol=0, atol=1e-11)
    low, high = (of_bonds(PULLED, rows, end) for end in (0, 1))
    assert np.array_equal(low, high)
    np.testing.assert_allclose(low, grown, rtol=0, atol=1e-11)


def test_energies_add_up(tmp_path):
    """Kinetic energy, that of springs, and what is gone, while springs yield either way."""
    lmp = lab.load(PULLED, tmp_path, [*yielding(), MOVE, "timestep 0.02", "run 0"])
    found, gone = [], [0.0]
    for _ in range(60):
        lmp.command("run 10 pre no")
        gone.append(lmp.extract_fix("yield", 0, 1, 0))
        found.append(lmp.extract_fix("run", 0, 1, 1) + lmp.get_thermo("ebond") + lmp.extract_fix("yield", 0, 0) + gone[-1])
    lmp.close()
    assert gone[-1] > 0.05 and (np.diff(gone) >= -1e-9).all()
    assert np.ptp(found) < 1e-4 * gone[-1]


def test_work_of_a_loop_of_one_spring(tmp_path):
    """A spring that is pulled, pushed and pulled again by a heavy particle takes k b times the way on which it yields."""
    k, b, one = 2.0, 0.02, np.ones(2)
    body = lab.Body(
        np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]),
        np.array([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0]]),
        one,
        one.astype(int),
        one > 0,
        np.array([[0, 1]]),
        np.array([k]),
        np.array([1.0]),
    )
    lmp = lab.load(body, tmp_path, [*yielding(b), MOVE, "timestep 0.001", "run 0"])
    grown, gone = [0.0], 0.0
    for _ in range(4000):
        lmp.command("run 10 pre no post no")
        grown.append(lab.by_tag(lmp, "d2_grown")[0, 0])
    gone = lmp.extract_fix("yield", 0, 1, 0)
    lmp.close()
    way = np.abs(np.diff(grown)).sum()
    assert way > b
    assert gone == pytest.approx(k * b * way, rel=1e-3)


def test_same_bits_on_any_number_of_ranks(tmp_path):
    """Both ends on different ranks, too."""
    commands = [*yielding(), MOVE, f"timestep {DT}", "run 40"]
    one, three = (lab.in_child(PULLED, tmp_path, commands, ranks=ranks, velocities=True, cutoff=4.0) for ranks in (1, 3))
    assert one == three


def test_a_run_cut_in_two_is_the_same(tmp_path):
    """The property tells by how much springs have grown."""
    found = []
    for runs in (["run 25"], ["run 11", "run 14"]):
        lmp = lab.load(PULLED, tmp_path, [*yielding(), MOVE, f"timestep {DT}", *runs])
        found.append([lab.by_tag(lmp, name) for name in ("x", "v", "d2_grown")])
        lmp.close()
    for a, b in zip(*found):
        assert np.array_equal(a, b)


def test_a_spring_that_has_yielded_tears(tmp_path):
    """Counted from the length at the start; with what it stores then, all energies add up."""
    (tmp_path / "tear").write_text("object 1 0.2\n")
    tear = ["fix torn all property/atom i_torn", f"fix tear all mdanim/tear torn torn objects {tmp_path}/tear"]
    fast = replace(PULLED, v=2.0 * PULLED.v)
    lmp = lab.load(fast, tmp_path, [*tear, *yielding(), MOVE, "timestep 0.02", "run 0"])
    found = []
    for _ in range(60):
        lmp.command("run 10 pre no")
        gone = [lmp.extract_fix(fix, 0, 1, 0) for fix in ("tear", "yield")]
        found.append(lmp.extract_fix("run", 0, 1, 1) + lmp.get_thermo("ebond") + lmp.extract_fix("yield", 0, 0) + sum(gone))
    lmp.close()
    assert min(gone) > 1e-3
    assert np.ptp(found) < 1e-3 * sum(gone)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("", "grown NAME bears NAME"),
        ("grown grown grown grown", "the keyword bears is missing"),
        ("bears bears bears bears", "the keyword grown is missing"),
        ("grown other bears bears", "there is no per-particle property d2_other"),
        ("grown grown bears other", "there is no per-particle property d2_other"),
        ("grown grown most bears", "most"),
    ],
)
def test_what_is_refused(tmp_path, words, message):
    """With a way out."""
    with pytest.raises(Exception, match=message):
        lab.load(BLOCK, tmp_path, [STATE, f"fix yield all mdanim/yield {words}", MOVE, "run 0"])
