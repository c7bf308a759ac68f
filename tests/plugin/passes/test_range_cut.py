# SPDX-License-Identifier: GPL-2.0-only
"""Ranges of blocks for threads: plugin/passes/range_cut.h, without LAMMPS."""

import numpy as np
import pytest
from cut_samples import CASES, lattice, several
from engine_lab import cut, cut_into_ranges

CHUNK = 512
"""Particles of one object whose sums are kept together, as cutter.h has it."""


def springs_in_order(blocks, low_first, ranges):
    """Partners of each particle in the order in which their forces are added, by the order in which a pass has them.

    ``low_first``: partners below it, else those above it. A border's springs come before all others of both ranges.
    """
    seen = {}

    def note(block):
        for entry in block.entries:
            for lane in np.flatnonzero(entry.coeffs.any(0)).tolist():
                i, j = block.start + lane, block.start + lane + entry.offset
                seen.setdefault(j if low_first else i, []).append(i if low_first else j)

    for block in blocks:
        if block.crossing:
            note(block.crossing)
    for block in blocks:
        note(block)
    return seen


@pytest.mark.parametrize("lanes", [4, 8])
@pytest.mark.parametrize("wanted", [2, 3, 5])
@pytest.mark.parametrize("name", CASES)
def test_each_sum_keeps_its_order(name, wanted, lanes):
    """Every particle has the same partners in the same order as in one range; a spring crosses one border, and the right one."""
    particles, springs, krc, objects = CASES[name]
    whole = cut(lanes, particles, springs, krc, objects)
    blocks, first = cut_into_ranges(lanes, particles, springs, krc, objects, wanted)
    assert 1 < len(first) <= wanted and first[0] == 0
    assert [b.start for b in blocks] == [b.start for b in whole]
    for low_first in (False, True):
        assert springs_in_order(blocks, low_first, first) == springs_in_order(whole, low_first, [0])
    ends = [*first[1:], particles]
    for block in blocks:
        r = np.searchsorted(first, block.start, "right") - 1
        loaded = max(block.start + lanes + e.offset for e in block.entries) if block.entries else block.start + lanes
        if ends[r] < particles:  # nothing that another range moves is loaded without care
            assert block.at_border >= (max(loaded, block.start + lanes) > ends[r])
        for entry in block.entries:
            inside = block.start + np.flatnonzero(entry.coeffs.any(0)) + entry.offset
            assert inside.max() < ends[r]
        for entry in block.crossing.entries if block.crossing else ():
            outside = block.start + np.flatnonzero(entry.coeffs.any(0)) + entry.offset
            assert ends[r] <= outside.min() and outside.max() < ends[r + 1]


def test_borders_lie_where_chunks_or_objects_begin():
    """A range begins with a chunk of an object; where objects are small, with an object."""
    particles, springs, krc, objects = CASES["a cube"]
    _, first = cut_into_ranges(4, particles, springs, krc, objects, 3)
    assert [n % CHUNK for n in first] == [0, 0, 0]
    particles, springs, krc, objects = CASES["many small ones"]
    blocks, first = cut_into_ranges(4, particles, springs, krc, objects, 4)
    assert len(first) == 4 and not any(b.crossing for b in blocks)
    assert all(n == 0 or objects[n] != objects[n - 1] for n in first)


@pytest.mark.parametrize(
    ("layers", "border"), [((142, 144), 36 * 142), ((159, 143), 11 * CHUNK), ((171, 131), 11 * CHUNK), ((290,), 10 * CHUNK)]
)
def test_a_border_lies_at_an_object_that_begins_near(layers, border):
    """Half of the first two bars is nearer to a chunk than to the second bar, but no spring crosses the border at the bar. Other
    borders are at the nearest chunk, on either side."""
    particles, springs, krc, objects = several(*(lattice((5, 5, n - 1)) for n in layers))
    _, first = cut_into_ranges(4, particles, springs, krc, objects, 2)
    assert list(first) == [0, border]


def test_the_range_above_a_wide_border_has_fewer_particles():
    """It has the springs across the border to evaluate, too: those of a sixth of the particles of a slab."""
    particles, springs, krc, objects = several(lattice((30, 30, 5)))
    _, first = cut_into_ranges(4, particles, springs, krc, objects, 2)
    assert 0.6 < first[1] / particles < 0.65


def test_ranges_cost_alike():
    """Each of four ranges of a long bar has a quarter of the particles, up to a chunk."""
    particles, springs, krc, objects = several(lattice((5, 5, 300)))
    _, first = cut_into_ranges(4, particles, springs, krc, objects, 4)
    shares = np.diff([*first, particles])
    assert len(first) == 4 and np.ptp(shares) <= 2 * CHUNK


def test_springs_that_reach_too_far_make_fewer_ranges():
    """Particles that are all joined to others half of the numbering away are one range."""
    particles = 4 * CHUNK
    springs = np.array([(i, i + particles // 2) for i in range(particles // 2)])
    krc = np.tile([1.0, 1.0, 0.0], (len(springs), 1))
    _, first = cut_into_ranges(4, particles, springs, krc, np.ones(particles), 4)
    assert len(first) == 2
    chain = np.array([(i, j) for i in range(particles) for j in (i + 1, i + particles // 2) if j < particles])
    _, first = cut_into_ranges(4, particles, chain, np.tile([1.0, 1.0, 0.0], (len(chain), 1)), np.ones(particles), 8)
    assert len(first) == 2
