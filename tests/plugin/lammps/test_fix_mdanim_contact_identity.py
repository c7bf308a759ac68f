# SPDX-License-Identifier: GPL-2.0-only
"""fix mdanim/contact gives the same bits on any number of ranks, in pieces, after a state was put back, through restart files."""

import contact_lab
import numpy as np
import plugin_lab as lab
import plugin_path
import pytest
import state_lab
from contact_lab import PILE, State, load, pile
from mpi.contact_pile import PIECES, film
from paths import MPI
from ranks_lab import on_ranks

SOAK = [pytest.param(seed, marks=pytest.mark.soak) for seed in range(10, 30)]
MIDDLE, REST = 110, 130
"""Steps before a state is taken up, in the middle of blows, and after it."""


def middle(seed, folder):
    """A pile in the middle of its blows, its state there, and after the rest."""
    lmp = load(pile(seed), folder, **PILE)
    lmp.command(f"run {MIDDLE} pre no post no")
    kept = State.of(lmp)
    assert contact_lab.contacts(kept.contacts)
    lmp.command(f"run {REST} pre no post no")
    end = State.of(lmp)
    assert not end.contacts.same(kept.contacts)
    return lmp, kept, end


@pytest.mark.mpi
@pytest.mark.parametrize(("seed", "friction", "ranks"), [(1, True, 2), (2, True, 3), (3, False, 2), (4, True, 4)])
def test_ranks_have_the_bits_of_one(tmp_path, seed, friction, ranks):
    """Places, velocities, forces, energies, losses and records after each of several pieces."""
    compare_ranks(tmp_path, seed, friction, ranks)


@pytest.mark.mpi
@pytest.mark.soak
@pytest.mark.parametrize("seed", range(10, 30))
def test_ranks_have_the_bits_of_one_in_many_piles(tmp_path, seed):
    """The same with 20 piles."""
    compare_ranks(tmp_path, seed, seed % 4 > 0, 2 + seed % 3)


def compare_ranks(folder, seed, friction, ranks):
    alone = film(seed, friction, folder)
    assert alone[f"told {PIECES - 1}"][5] > 0.05  # the deepest point
    on_ranks(MPI / "contact_pile.py", ranks, seed, friction, folder / "film.npz")
    found = np.load(folder / "film.npz")
    assert [name for name in alone if alone[name].tobytes() != found[name].tobytes()] == []


@pytest.mark.parametrize("seed", [1, 2, *SOAK])
def test_a_state_is_taken_up_in_the_middle_of_blows(tmp_path, seed):
    """In the same instance, in one that goes on elsewhere first, and in a fresh one."""
    lmp, kept, end = middle(seed, tmp_path)
    kept.put(lmp)
    lmp.command(f"run {REST} pre no post no")
    assert State.of(lmp).same(end)
    lmp.close()
    fresh = load(pile(seed), tmp_path, **PILE, setup=False)
    kept.put(fresh)
    assert State.of(fresh).same(kept)
    fresh.command(f"run {REST} pre no post no")
    assert State.of(fresh).same(end)
    fresh.close()


@pytest.mark.parametrize("seed", [1, *SOAK])
def test_a_state_may_be_put_back_after_every_few_steps(tmp_path, seed):
    """Each piece of random length ends with its own state being taken up again."""
    lmp, _, end = middle(seed, tmp_path)
    lmp.close()
    lmp, random, left = load(pile(seed), tmp_path, **PILE), np.random.default_rng(seed), MIDDLE + REST
    while left:
        piece = min(left, int(random.integers(1, 20)))
        lmp.command(f"run {piece} pre no post no")
        left -= piece
        State.of(lmp).put(lmp)
    assert State.of(lmp).same(end)
    lmp.close()


@pytest.mark.parametrize("seed", [1, *SOAK])
def test_pieces_of_any_length_are_one_run(tmp_path, seed):
    """And neither the skin nor the order of particles in the file matters."""
    lmp, _, end = middle(seed, tmp_path)
    lmp.close()
    order = np.random.default_rng(seed).permutation(len(end.x))
    lmp = load(pile(seed), tmp_path, **PILE, skin=0.11, order=order)
    for piece in (1, 2, 3, 5, 7, 1, 60, 31):
        lmp.command(f"run {piece} pre no post no")
    lmp.command(f"run {MIDDLE + REST - 110} pre no post no")
    assert State.of(lmp).same(end)
    lmp.close()


def test_restart_files_hold_contacts(tmp_path):
    """Read in the middle of blows: the same records at once, and the same bits later but for the forces of the first half step,
    which LAMMPS works out anew."""
    cuboids = pile(1)
    lmp, kept, _ = middle(1, tmp_path)
    kept.put(lmp)
    lmp.command("write_restart middle.restart".replace("middle", str(tmp_path / "middle")))
    lmp.command("run 0 post no")
    lmp.command(f"run {REST} pre no post no")
    end = State.of(lmp)
    lmp.close()
    lmp = plugin_path.lammps()
    for command in ("atom_modify map array sort 0 0", "newton off", f"read_restart {tmp_path}/middle.restart"):
        lmp.command(command)
    columns = " ".join(f"d_{name}" for name in contact_lab.COLUMNS)
    body, _ = contact_lab.scene(cuboids)
    for command in (
        f"fix model all property/atom rmass {columns} ghost yes",
        "neigh_modify every 1 delay 0 check yes",
        *lab.springs(body),
        "group inner type 1",
        *contact_lab.commands(cuboids, PILE["words"], PILE["dt"], PILE["more"]),
    ):
        lmp.command(command)
    for n, one in enumerate(cuboids):
        contact_lab.give_body(lmp, "contact", n, one.arrays)
    lmp.command("run 0 post no")
    assert state_lab.pack(lmp, "contact").same(kept.contacts)
    lmp.command(f"run {REST} pre no post no")
    assert State.of(lmp).same(end)
    lmp.close()
