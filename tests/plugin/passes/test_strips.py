# SPDX-License-Identifier: GPL-2.0-only
"""Strips of blocks: plugin/passes/strips.h, without LAMMPS."""

from itertools import pairwise

import numpy as np
import pytest
from cut_samples import CASES, several
from engine_lab import cut_into_ranges

LONGEST, SHORTEST = 16, 4
"""Blocks of a strip, as strips.cpp and pass.h have it."""


def strips_of(lanes, case, wanted):
    """The strips of blocks, and the first particle of each range."""
    particles, springs, krc, objects = case
    blocks, first = cut_into_ranges(lanes, particles, springs, krc, objects, wanted)
    strips, n = [], 0
    while n < len(blocks):
        strips.append(blocks[n : n + blocks[n].strip])
        assert blocks[n].strip >= 1 and all(block.strip == 0 for block in strips[-1][1:])
        n += blocks[n].strip
    return strips, first


@pytest.mark.parametrize("lanes", [4, 8])
@pytest.mark.parametrize("wanted", [1, 3])
@pytest.mark.parametrize("name", CASES)
def test_blocks_of_a_strip_are_neighbours_with_the_same_offsets(name, wanted, lanes):
    """Blocks of a strip follow each other without gaps in one range."""
    strips, first = strips_of(lanes, CASES[name], wanted)
    for strip in strips:
        assert len(strip) == 1 or SHORTEST <= len(strip) <= LONGEST
        for before, own in pairwise(strip):
            assert own.start == before.start + lanes and own.start not in first and own.damped == before.damped
            assert [e.offset for e in own.entries] == [e.offset for e in before.entries] != []
            assert not own.at_border and not before.at_border


def test_most_blocks_of_a_cube_are_in_strips():
    """A cube of 12^3 particles, in blocks of four: all layers but the upper one."""
    strips, _ = strips_of(4, CASES["a cube"], 1)
    assert sum(len(s) for s in strips if len(s) > 1) > 0.5 * sum(len(s) for s in strips)


@pytest.mark.parametrize("lanes", [4, 8])
def test_a_strip_ends_where_another_thread_begins(lanes):
    """Chains as long as a block is wide all have the same offsets, and no spring crosses the border between two ranges."""
    chain = lanes, [(i, i + 1) for i in range(lanes - 1)], np.tile([1.0, 1.0, 0.0], (lanes - 1, 1))
    strips, first = strips_of(lanes, several(*[chain] * 41), 2)
    assert len(first) == 2 and first[1] in [s[0].start for s in strips]
    assert max(len(s) for s in strips) == LONGEST
