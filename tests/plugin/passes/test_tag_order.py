# SPDX-License-Identifier: GPL-2.0-only
"""Particles and springs of a rank in the order of tags: plugin/passes/tag_order.h, without LAMMPS."""

from itertools import pairwise

import numpy as np
import pytest
from engine_lab import order


def scene(seed: int, mixed: bool = False) -> tuple[int, np.ndarray, np.ndarray, dict[int, list[int]]]:
    """A rank's share of three objects of 8 particles at random, ghosts behind its own ones, in any order.

    Springs are within objects, or with ``mixed`` among them as well, and stored at both ends.
    """
    random = np.random.default_rng(seed)
    objects = {t: (t - 1) // 8 + 1 for t in range(1, 25)}
    pairs = [(a, b) for a in objects for b in objects if a < b and (objects[a] == objects[b] or (mixed and b - a == 8))]
    pairs = [pairs[k] for k in random.permutation(len(pairs))[: len(pairs) // 2]]
    own = random.permutation(24)[:11] + 1
    bonds: dict[int, list[int]] = {int(t): [] for t in own}
    for a, b in pairs:
        for one, other in ((a, b), (b, a)):
            if one in bonds:
                bonds[one].append(other)
    ghosts = random.permutation(sorted({p for many in bonds.values() for p in many} - set(bonds)))
    tags = np.concatenate([own, ghosts]).astype(int)
    return len(own), tags, np.array([objects[int(t)] for t in tags]), {t: sorted(b) for t, b in bonds.items()}


@pytest.mark.parametrize("mixed", [False, True], ids=["objects apart", "objects joined"])
@pytest.mark.parametrize("seed", range(5))
def test_the_line_has_every_particle_and_spring_once_in_tag_order(seed, mixed):
    """Line up a rank's particles and their partners: tags ascend, each spring with an end here is in the row of its lower end.

    Partners of a row descend.
    """
    own, tags, objects, bonds = scene(seed, mixed)
    places, springs = order(own, tags, objects, bonds)
    line = tags[places]
    assert (np.diff(line) > 0).all()
    needed = set(tags[:own].tolist()) | {p for many in bonds.values() for p in many}
    assert set(line.tolist()) == needed
    wanted = {(min(t, p), max(t, p)) for t, many in bonds.items() for p in many}
    found = [(int(line[a]), int(line[b])) for a, b in springs]
    assert len(found) == len(wanted) and set(found) == wanted
    for (a, b), (c, d) in pairwise(springs):
        assert a < b and (a < c or (a == c and b > d))


@pytest.mark.parametrize("mixed", [False, True], ids=["objects apart", "objects joined"])
@pytest.mark.parametrize("seed", range(3))
def test_tags_may_have_any_gaps(seed, mixed):
    """The same line as without gaps, in memory for the particles that there are: tags go up to 2·10⁹."""
    own, tags, objects, bonds = scene(seed, mixed)
    far = {int(t): int(t) * 83_000_000 for t in {*tags.tolist(), *(p for many in bonds.values() for p in many)}}
    spread = {far[t]: [far[p] for p in many] for t, many in bonds.items()}
    assert order(own, np.array([far[int(t)] for t in tags]), objects, spread) == order(own, tags, objects, bonds)


def test_no_particles_make_an_empty_line():
    """A rank may have none."""
    assert order(0, np.array([], int), [], {}) == ([], [])


def test_a_partner_that_is_not_here_is_named():
    """Leave a ghost out."""
    with pytest.raises(LookupError, match="7"):
        order(2, np.array([3, 5]), [1, 1], {3: [5], 5: [3, 7]})
