# SPDX-License-Identifier: GPL-2.0-only
"""fix mdanim/folds: forces against a twin without lists; momentum, energy, lists that change nothing, ranks, what is refused."""

from dataclasses import replace

import numpy as np
import plugin_lab as lab
import pytest
from twin.folds import Layer, Pair

DT = 0.01


def grid(n: int, height: float, seed: int, turn: float = 0.0) -> np.ndarray:
    """Places of n x n particles about a square of side 1."""
    rng = np.random.default_rng(seed)
    a = np.linspace(0.0, 1.0, n)
    place = np.stack([*np.meshgrid(a, a), np.full((n, n), height)], axis=-1).reshape(-1, 3)
    c, s = np.cos(turn), np.sin(turn)
    return place @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + rng.uniform(-0.05, 0.05, place.shape)


def sheet(first: int, n: int, rest: np.ndarray) -> Layer:
    k = np.arange(n * n).reshape(n, n)
    a, b, c, d = (part.ravel() for part in (k[:-1, :-1], k[:-1, 1:], k[1:, 1:], k[1:, :-1]))
    element = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    return Layer(first + np.arange(n * n), rest, element, np.linspace(0.5, 1.0, n * n))


def rope(first: int, x: np.ndarray) -> Layer:
    n = len(x)
    rest = np.zeros((n, 3))
    rest[:, 0] = 0.25 * np.arange(n)
    return Layer(first + np.arange(n), rest, np.stack([np.arange(n - 1), np.arange(1, n)], axis=1), np.ones(n))


def two_sheets():
    x = np.concatenate([grid(4, 0.0, 1), grid(3, 0.15, 2, 0.3)])
    one, other = sheet(0, 4, x[:16]), sheet(16, 3, x[16:])
    return x, [16, 9], [Pair(one, other, 0.3, 20.0, 0.4, 0.3)], [(1, 2)]


def folded():
    """A strip that is folded over: without load it is flat."""
    rest = grid(4, 0.0, 3)
    x = rest.copy()
    over = x[:, 0] > 0.5
    x[over, 0], x[over, 2] = 1.0 - x[over, 0], x[over, 2] + 0.1
    one = sheet(0, 4, rest)
    return x, [16], [Pair(one, one, 0.25, 20.0, 0.4, 0.3, 0.4)], [(1, 1)]


def ropes():
    a = np.stack([0.25 * np.arange(5), np.zeros(5), np.zeros(5)], axis=1)
    b = np.stack([0.4 + 0.05 * np.arange(5), 0.25 * np.arange(5) - 0.5, np.full(5, 0.12)], axis=1)
    x = np.concatenate([a, b]) + np.random.default_rng(4).uniform(-0.02, 0.02, (10, 3))
    return x, [5, 5], [Pair(rope(0, x[:5]), rope(5, x[5:]), 0.2, 20.0, 0.4, 0.3)], [(1, 2)]


def rope_and_sheet():
    a = np.stack([0.25 * np.arange(5), np.full(5, 0.5), np.full(5, 0.1)], axis=1)
    x = np.concatenate([grid(4, 0.0, 5), a])
    return x, [16, 5], [Pair(sheet(0, 4, x[:16]), rope(16, a), 0.2, 20.0, 0.4, 0.3)], [(1, 2)]


CASES = {made.__name__: made for made in (two_sheets, folded, ropes, rope_and_sheet)}


def setting(tmp_path, made, group: str = "all"):
    """Particles, the commands of the fix, and the twin."""
    x, sizes, pairs, numbers = made()
    rng = np.random.default_rng(7)
    body = lab.particles(
        x, molecule=np.repeat(np.arange(len(sizes)) + 1, sizes), v=rng.uniform(-1, 1, x.shape), mass=rng.uniform(0.5, 2.0, len(x))
    )
    layers = {}
    for pair, (i, j) in zip(pairs, numbers):
        layers[i], layers[j] = pair.first, pair.second
    text = "".join(layers[i].text(i) for i in sorted(layers)) + "".join(p.text(*n) for p, n in zip(pairs, numbers))
    (tmp_path / "table").write_text(text)
    return body, [f"fix folds {group} mdanim/folds {tmp_path}/table", f"timestep {DT}"], pairs[0]


@pytest.mark.parametrize("name", CASES)
def test_forces_are_those_of_the_twin(tmp_path, name):
    """Potential, friction and dashpot together, and the energy; momentum is kept, and angular momentum by the push."""
    body, script, pair = setting(tmp_path, CASES[name])
    lmp = lab.load(body, tmp_path, [*script, "run 0"])
    found, energy = lab.by_tag(lmp, "f"), lmp.extract_fix("folds", 0, 0)
    lmp.close()
    push, rub, damp, stored = pair.forces(body.x, body.v, body.mass, DT)
    size = np.abs(push).max()
    assert size > 0.1 and np.abs(rub).max() > 0.01 and np.abs(damp).max() > 0.01
    np.testing.assert_allclose(found, push + rub + damp, rtol=0, atol=1e-12 * size)
    assert energy == pytest.approx(stored, rel=1e-12)
    np.testing.assert_allclose(found.sum(axis=0), 0.0, atol=1e-13 * size * len(found))
    np.testing.assert_allclose(np.cross(body.x, push + damp).sum(axis=0), 0.0, atol=1e-12 * size)


@pytest.mark.parametrize("name", CASES)
def test_the_push_is_the_gradient_of_the_energy(tmp_path, name):
    """By differences; in one place where it touches most."""
    body, _, pair = setting(tmp_path, CASES[name])
    push = pair.forces(body.x, 0 * body.v, body.mass, DT)[0]
    i, axis = np.unravel_index(np.abs(push).argmax(), push.shape)
    ends = []
    for way in (1e-6, -1e-6):
        x = body.x.copy()
        x[i, axis] += way
        ends.append(pair.forces(x, 0 * body.v, body.mass, DT)[3])
    assert push[i, axis] == pytest.approx(-(ends[0] - ends[1]) / 2e-6, rel=1e-5)


@pytest.mark.parametrize("name", ["two_sheets", "ropes"])
def test_the_books_close(tmp_path, name):
    """Kinetic and stored energy and what is lost, to the second order of the step."""
    body, script, _ = setting(tmp_path, CASES[name])
    off = []
    for refined in (1, 2):
        steps = [f"timestep {DT / 40 / refined}", "fix run all mdanim/leapfrog", "run 0"]
        lmp = lab.load(body, tmp_path, [*script, *steps])
        start = lmp.extract_fix("folds", 0, 0)
        lmp.command(f"run {800 * refined}")
        kinetic = 0.5 * (body.mass[:, None] * (lab.by_tag(lmp, "v") ** 2 - body.v**2)).sum()
        heat, lost = (lmp.extract_fix("folds", 0, 1, n) for n in range(2))
        off.append(abs(kinetic + lmp.extract_fix("folds", 0, 0) - start + heat + lost) / (heat + lost))
        lmp.close()
    assert heat > 0.0 and lost > 0.0 and off[0] < 2e-2 and off[1] < max(0.75 * off[0], 1e-4)


def smooth():
    """Two sheets without friction and dashpots."""
    x, sizes, pairs, numbers = two_sheets()
    pairs[0].friction = pairs[0].damping = 0.0
    return x, sizes, pairs, numbers


def test_lists_change_no_bit(tmp_path):
    """A run in one piece, and one that looks for what is near anew before each step."""
    body, script, _ = setting(tmp_path, smooth)
    film, lists = [], []
    for commands in (["run 60"], ["run 1"] * 60):
        lmp = lab.load(body, tmp_path, [*script, "fix run all mdanim/leapfrog", *commands])
        film.append(lab.by_tag(lmp, "x"))
        lists.append(lmp.extract_fix("folds", 0, 1, 2))
        lmp.close()
    assert np.array_equal(*film) and lists[0] < lists[1] == 60


def test_particles_of_the_group_alone_are_pushed(tmp_path):
    body, script, _ = setting(tmp_path, two_sheets, group="some")
    lmp = lab.load(body, tmp_path, ["group some id 17:25", *script, "run 0"])
    found = lab.by_tag(lmp, "f")
    lmp.close()
    assert not found[:16].any() and found[16:].any()


def test_a_link_between_others_opens_nothing(tmp_path):
    """Particles of the molecule that the file leaves out: a link between two of them tears, beside a cell that is as it was."""
    corner = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], float)
    x = np.concatenate([corner[:4], [(9.0, 0.0, 0.0)], corner[4:], [(7.0, 0.0, 0.0), (0.3, 0.4, 1.1), (0.6, 0.5, 1.1)]])
    links = lab.particles(x, molecule=np.repeat([1, 2], [10, 2]))
    links = replace(links, bond=np.array([[4, 9]]), k=np.ones(1), r0=np.ones(1))
    rows = [*range(1, 5), *range(6, 10)]
    text = "object 1\n" + "".join(f"particle {n} {' '.join(map(str, x[n - 1]))} 1\n" for n in rows) + "cell 1 2 3 4 5 6 7 8\n"
    text += "object 2\nparticle 1 0.3 0.4 1.1 1\nparticle 2 0.6 0.5 1.1 1\nsegment 1 2\npair 1 2 0.3 1 0 0\n"
    (tmp_path / "table").write_text(text)
    (tmp_path / "tear").write_text("object 1 0.2\n")
    tear = ["fix state all property/atom i_torn", f"fix tear all mdanim/tear torn torn objects {tmp_path}/tear"]
    fixes = [*tear, f"fix folds all mdanim/folds {tmp_path}/table", "fix run all mdanim/leapfrog", f"timestep {DT}"]
    lmp = lab.load(links, tmp_path, [*fixes, "run 2"])
    gone, energy = lmp.extract_fix("tear", 0, 1, 0), lmp.extract_fix("folds", 0, 0)
    lmp.close()
    assert gone > 0.0 and energy == 0.0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "nothing touches; write a line pair"),
        ("particle 1 0 0 0 1\n", "particle belongs behind a line object"),
        ("object 1\nparticle 1 0 0 0 1\nparticle 1 0 0 0 1\n", "ascend"),
        ("object 1\nparticle 1 0 0 0 1\ntriangle 1 2 3\n", "there is no particle 2"),
        ("object 1\nparticle 1 0 0 0 1\npair 1 1 1 1 0 0 1\n", "has no cell, triangle or segment"),
        ("object 1\npair 2 1 1 1 0 0\n", "there is no object 2"),
    ],
)
def test_refused(tmp_path, text, message):
    body, script, _ = setting(tmp_path, two_sheets)
    (tmp_path / "table").write_text(text)
    with pytest.raises(Exception, match=message):
        lab.load(body, tmp_path, [*script, "run 0"])
