# SPDX-License-Identifier: GPL-2.0-only
"""Blocks for the vector units: plugin/passes/cutter.h against exhaustive search, without LAMMPS."""

from itertools import pairwise, product

import numpy as np
import plugin_lab as lab
import pytest
from engine_lab import cut

OVERHEAD = 2
"""Cost of a block besides its entries, as in cutter.cpp."""


def random_springs(random, particles: int, many: int) -> tuple[np.ndarray, np.ndarray]:
    """Some of all pairs, each once, and K, r0 and c of each; about half of them have no dashpot."""
    pairs = np.array([(i, j) for i in range(particles) for j in range(i + 1, particles)])
    chosen = pairs[np.sort(random.permutation(len(pairs))[:many])]
    krc = random.uniform(0.5, 2.0, (many, 3))
    krc[random.random(many) < 0.5, 2] = 0.0
    return chosen, krc


def springs_of(blocks) -> dict[tuple[int, int], tuple[float, ...]]:
    """Push, pull and c of each spring that entries hold, by its two particles."""
    found = {}
    for block in blocks:
        for entry, lane in product(block.entries, range(block.entries[0].coeffs.shape[1] if block.entries else 0)):
            coeffs = tuple(entry.coeffs[:, lane].tolist())
            if coeffs == (0.0, 0.0, 0.0):
                continue
            assert lane < block.lanes
            pair = (block.start + lane, block.start + lane + entry.offset)
            assert pair not in found
            found[pair] = coeffs
    return found


def cost(springs: set[tuple[int, int]], begin: int, end: int) -> int:
    """Cost of a block of these particles."""
    return OVERHEAD + len({j - i for i, j in springs if begin <= i < end})


@pytest.mark.parametrize("lanes", [2, 4, 8])
@pytest.mark.parametrize("seed", range(6))
def test_every_spring_is_in_one_lane_and_no_cut_is_better(lanes, seed):
    """Cut 9 particles of two objects at random: springs are all there, and of all cuts none has fewer vectors to compute."""
    random, particles = np.random.default_rng(seed), 9
    pairs, krc = random_springs(random, particles, 14)
    objects = np.where(np.arange(particles) < 5, 1, 2)
    blocks = cut(lanes, particles, pairs, krc, objects)

    damped = set(pairs[krc[:, 2] > 0.0].ravel().tolist())
    found = springs_of(blocks)
    assert set(found) == {tuple(p) for p in pairs.tolist()}
    for (i, j), (k, r0, c) in zip(pairs.tolist(), krc.tolist()):
        assert found[i, j] == (2.0 * k * r0, 2.0 * k, c)
    starts = [b.start for b in blocks]
    assert starts[0] == 0 and [b.start + b.lanes for b in blocks] == [*starts[1:], particles]
    for block in blocks:
        inside = range(block.start, block.start + block.lanes)
        assert 0 < block.lanes <= lanes and len(set(objects[list(inside)])) == 1
        assert block.damped == any(i in damped for i in inside)
        assert [e.offset for e in block.entries] == sorted((e.offset for e in block.entries), reverse=True)

    springs = set(found)
    best = min(
        sum(cost(springs, a, b) for a, b in pairwise(edges))
        for chosen in product((False, True), repeat=particles - 1)
        for edges in [[0, *(i + 1 for i, is_edge in enumerate(chosen) if is_edge or objects[i] != objects[i + 1]), particles]]
        if max(b - a for a, b in pairwise(edges)) <= lanes
    )
    assert sum(OVERHEAD + len(b.entries) for b in blocks) == best


def test_rows_of_a_lattice_fill_the_lanes():
    """Cut a block of 8 x 5 x 4 particles, numbered row by row: nearly all lanes of 4 have springs."""
    body = lab.block((7, 4, 3))
    blocks = cut(4, len(body.x), body.bond, np.stack([0.5 * body.k, body.r0, 0.0 * body.k], 1))
    entries = sum(len(b.entries) for b in blocks)
    assert len(body.bond) / (4 * entries) > 0.8


def test_two_springs_between_the_same_particles_are_two_entries():
    """Give a pair two springs: passes add up both."""
    (block,) = cut(4, 2, [(0, 1), (0, 1)], [(1.0, 2.0, 0.0), (3.0, 4.0, 0.0)])
    assert [(e.offset, e.coeffs[:2, 0].tolist()) for e in block.entries] == [(1, [4.0, 2.0]), (1, [24.0, 6.0])]


def test_nothing_is_cut_into_nothing():
    """Cut no particles, and particles without springs."""
    assert cut(4, 0, [], []) == []
    assert [(b.start, b.lanes, b.entries) for b in cut(4, 6, [], [])] in ([(0, 4, ()), (4, 2, ())], [(0, 2, ()), (2, 4, ())])
