# SPDX-License-Identifier: GPL-2.0-only
"""fix mdanim/tear: which springs break in which step, against a naive form in numpy; energies, ranks, runs, and refusals."""

from dataclasses import replace

import numpy as np
import plugin_lab as lab
import pytest

MOVE = "fix run all mdanim/leapfrog"
STATE = "fix state all property/atom i_torn"
DT = 0.1
BLOCK = lab.block((3, 2, 2))
PULLED = replace(BLOCK, v=0.25 * (BLOCK.x - BLOCK.x.mean(0)) * np.array([1.0, 0.3, -0.2]))
STRAIN = 0.2
CHAIN = 9
"""Particles of a line that resists bending: links of k = 1 and springs of k = 0.1 over two, which push."""


def line() -> lab.Body:
    x = np.stack([np.arange(CHAIN, dtype=float), np.zeros(CHAIN), np.zeros(CHAIN)], 1)
    links = [(i, i + 1, 1.0, 1.0 - 0.02 * (1 if i in (0, CHAIN - 2) else 2)) for i in range(CHAIN - 1)]
    overs = [(i, i + 2, 0.1, 2.2) for i in range(CHAIN - 2)]
    rows = sorted(links + overs)
    v = np.zeros_like(x)
    v[:, 0], v[:, 1] = 0.3 * (x[:, 0] - 3.2), 0.05 * np.sin(x[:, 0])
    bond = np.array([row[:2] for row in rows])
    one = np.ones(CHAIN)
    return lab.Body(x, v, one, one.astype(int), one > 0, bond, *np.array([row[2:] for row in rows]).T)


def table(body: lab.Body) -> str:
    """Rules of the line: links of the length 1 that bear STRAIN, the fourth one less, and springs over two."""
    text = f"object 1 {STRAIN}\n"
    text += "".join(f"link {i + 1} {i + 2} 1 {1.0 + STRAIN * (0.5 if i == 3 else 1.0)!r}\n" for i in range(CHAIN - 1))
    return text + "".join(f"over {i + 1} {i + 2} {i + 3} 0.05 2.2\n" for i in range(CHAIN - 2))


def rules(path, text=f"object 1 {STRAIN}\n", torn="torn") -> list[str]:
    (path / "tear").write_text(text)
    return [STATE, f"fix tear all mdanim/tear torn {torn} objects {path}/tear"]


def twin(body: lab.Body, steps: int):
    """Places, velocities, springs that are gone, and energies of springs at the moment in which they broke: leap-frog, where all
    springs are looked at before the forces of each step."""
    x, v, gone = body.x.copy(), body.v.copy(), np.zeros(len(body.bond), bool)
    over = body.r0 > 1.5 if len(body.x) == CHAIN else np.zeros(len(body.bond), bool)
    length = np.where(over, 2.0, 1.0) if over.any() else body.r0
    bears = (1.0 + STRAIN) * length
    if over.any():
        bears[(body.bond == (3, 4)).all(1)] = 1.0 + 0.5 * STRAIN
    number = {tuple(pair): s for s, pair in enumerate(body.bond.tolist())}

    def forces():
        f = np.zeros_like(x)

        def pull(i, j, k, r0):
            d = x[i] - x[j]
            r = np.linalg.norm(d)
            f[i] -= k * (r - r0) * d / r
            f[j] += k * (r - r0) * d / r

        for s, (i, j) in enumerate(body.bond.tolist()):
            if not gone[s]:
                pull(i, j, body.k[s], body.r0[s])
            elif over[s]:  # what remains along the link that is there
                for a, b in ((i, i + 1), (i + 1, j)):
                    if not gone[number[a, b]]:
                        pull(a, b, 2.0 * body.k[s], 0.5 * body.r0[s])
        return f

    def look():
        d = x[body.bond[:, 0]] - x[body.bond[:, 1]]
        gone[~over & ((d**2).sum(1) > bears**2)] = True
        for s in np.flatnonzero(over):
            i, j = body.bond[s].tolist()
            gone[s] |= gone[number[i, i + 1]] or gone[number[i + 1, j]]

    f = forces()
    for _ in range(steps):
        v += 0.5 * DT * f / body.mass[:, None]
        x += DT * v
        look()
        f = forces()
        v += 0.5 * DT * f / body.mass[:, None]
    return x, v, gone


CASES = {"block": (PULLED, f"object 1 {STRAIN}\n"), "line": (line(), table(line()))}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("steps", [4, 12, 25])
def test_springs_break_as_in_the_naive_form(tmp_path, case, steps):
    """Places, and how many springs of each particle are gone."""
    body, text = CASES[case]
    lmp = lab.load(body, tmp_path, [*rules(tmp_path, text), MOVE, f"timestep {DT}", f"run {steps}"])
    x, v, torn = (lab.by_tag(lmp, name) for name in ("x", "v", "i_torn"))
    lmp.close()
    at, speed, gone = twin(body, steps)
    assert gone.any() == (steps > 4 or case == "line")
    np.testing.assert_allclose(x, at, rtol=0, atol=1e-11)
    np.testing.assert_allclose(v, speed, rtol=0, atol=1e-11)
    counted = np.bincount(body.bond[gone].ravel(), minlength=len(x))
    assert [bin(bits).count("1") for bits in torn.tolist()] == counted.tolist()


@pytest.mark.parametrize("case", CASES)
def test_energies_add_up(tmp_path, case):
    """Kinetic energy, that of springs and of what remains, and what is gone, while springs break."""
    body, text = CASES[case]
    lmp = lab.load(body, tmp_path, [*rules(tmp_path, text), MOVE, "timestep 0.02", "run 0"])
    found = []
    for _ in range(30):
        lmp.command("run 10 pre no")
        gone = lmp.extract_fix("tear", 0, 1, 0)
        # ebond counts springs from no length on: what they store without load is not theirs to lose.
        stored = 0.0
        if case == "line":
            length = np.where(body.r0 > 1.5, 2.0, 1.0)
            bits = lab.by_tag(lmp, "i_torn")
            order = {i: sorted(q for pair in body.bond.tolist() if i in pair for q in pair if q != i) for i in range(CHAIN)}
            torn = [bits[i] >> order[i].index(j) & 1 for i, j in body.bond.tolist()]
            stored = 0.5 * (body.k * (length - body.r0) ** 2) @ np.array(torn)
        kinetic = lmp.extract_fix("run", 0, 1, 1)
        found.append(kinetic + lmp.get_thermo("ebond") + lmp.extract_fix("tear", 0, 0) + gone + stored)
    assert gone > 1e-3
    assert np.ptp(found) < 2e-3 * gone
    lmp.close()


@pytest.mark.parametrize("case", CASES)
def test_same_bits_on_any_number_of_ranks(tmp_path, case):
    """Pieces on different ranks, too."""
    body, text = CASES[case]
    commands = [*rules(tmp_path, text), MOVE, f"timestep {DT}", "run 40"]
    one, three = (lab.in_child(body, tmp_path, commands, ranks=ranks, velocities=True, cutoff=4.0) for ranks in (1, 3))
    assert one == three


@pytest.mark.parametrize("case", CASES)
def test_a_run_cut_in_two_is_the_same(tmp_path, case):
    """The property tells which springs are gone."""
    body, text = CASES[case]
    found = []
    for runs in (["run 25"], ["run 11", "run 14"]):
        lmp = lab.load(body, tmp_path, [*rules(tmp_path, text), MOVE, f"timestep {DT}", *runs])
        found.append([lab.by_tag(lmp, name) for name in ("x", "v", "i_torn")])
        lmp.close()
    for a, b in zip(*found):
        assert np.array_equal(a, b)


@pytest.mark.parametrize(
    ("text", "words", "message"),
    [
        ("object 1 0.1\n", "", "torn NAME objects FILE"),
        ("object 1 0.1\n", "torn torn torn torn", "nothing may break"),
        ("object 1 0.1\n", "torn other objects FILE", "there is no per-particle property i_other"),
        ("object 1 0.1\n", "objects FILE objects FILE", "the keyword torn is missing"),
        ("", "torn torn objects FILE", "nothing may break"),
        ("object 7 0.1\n", "torn torn objects FILE", r"there is no object 7 \(molecule ID\)"),
        ("object 1 -1\n", "torn torn objects FILE", "the strain that springs bear must be above 0"),
        ("object 1 0.1\nobject 1 0.1\n", "torn torn objects FILE", "object 1 is there already"),
        ("link 1 2 1 1.1\n", "torn torn objects FILE", "link belongs behind a line object"),
        ("object 1 0.1\nlink 2 1 1 1.1\n", "torn torn objects FILE", "the lower end of a spring comes first"),
        ("object 1 0.1\nlink 2 3 1 1.1\nlink 1 2 1 1.1\n", "torn torn objects FILE", "springs ascend"),
        ("object 1 0.1\nover 1 2 3 0.5 2\n", "torn torn objects FILE", "a spring lies over two links"),
        (
            "object 1 0.1\nlink 1 2 1 1.1\nlink 2 3 1 1.1\nover 1 2 3 0.5 2 0\n",
            "torn torn objects FILE",
            "the length of a spring without load must be above 0",
        ),
        ("object 1 0.1\ncut 1\n", "torn torn objects FILE", "a line begins with object, link or over, got cut"),
        ("object 1 0.1 0.2\n", "torn torn objects FILE", "there is more than belongs to it"),
    ],
)
def test_what_is_refused(tmp_path, text, words, message):
    """With the line of the file."""
    (tmp_path / "tear").write_text(text)
    command = f"fix tear all mdanim/tear {words}".replace("FILE", f"{tmp_path}/tear")
    with pytest.raises(Exception, match=message):
        lab.load(BLOCK, tmp_path, [STATE, command, MOVE, "run 0"])


def test_springs_over_two_links_must_be_there(tmp_path):
    """The file tells of a bond that the object does not have."""
    text = "object 1 0.2\nlink 1 2 1 1.2\nlink 2 4 1 1.2\nover 1 2 4 0.05 2.2\n"
    body = line()
    with pytest.raises(Exception, match="have no bond over two links"):
        lab.load(body, tmp_path, [*rules(tmp_path, text), MOVE, "run 0"])
