# SPDX-License-Identifier: GPL-2.0-only
"""The liquid's automaton: forms of every rule that must agree in every cell, and what rules do to liquid."""

import automaton_lab as lab
import numpy as np
import pytest
from twin import automaton as twin

SIZES = [
    (1, 1, 1), (9, 1, 1), (4, 1, 2), (1, 3, 3), (3, 3, 3), (4, 5, 7), (5, 2, 7), (6, 7, 2), (9, 16, 17),
    (18, 4, 35),
]  # fmt: skip


def random_grid(shape, share, most, seed):
    """Random solid cells, and random liquid of up to `most` units in the others."""
    random = np.random.default_rng(seed)
    solid = (random.random(shape) < share).astype(np.uint8)
    return solid, (random.integers(0, most + 1, shape) * (solid == 0)).astype(np.uint8)


def grid(solid, content, **options):
    """An automaton with these cells."""
    a = lab.Automaton(solid.shape, **options)
    a.displace(solid)
    a.content = content
    return a


@pytest.mark.parametrize("vertical", ["lower", "any"])
@pytest.mark.parametrize("shape", SIZES, ids=str)
def test_sweeps_equal_the_plain_form_and_the_naive_twin(shape, vertical):
    """Give the same cells after each sweep by one thread, three threads, plain loops and the twin."""
    for n, (share, most) in enumerate([(0.0, 1), (0.1, 1), (0.3, 4), (0.6, 250)]):
        solid, q = random_grid(shape, share, most, n)
        fast = {name: grid(solid, q, seed=n, vertical=vertical) for name in ("one thread", "threads")}
        fast["threads"].share(3)
        plain = grid(solid, q, seed=n, vertical=vertical)
        for when in range(4):
            plain.sweep(plain=True)
            twin.sweep(q, solid, n, when, vertical)
            assert (plain.content == q).all()
            for name, a in fast.items():
                a.sweep()
                assert (a.content == q).all(), (name, when)


@pytest.mark.parametrize("vertical", ["lower", "any"])
def test_layers_that_are_passed_over_would_not_have_changed(vertical):
    """Follow the plain form, which visits every cell, through pools, drops and solids that come and go."""
    random = np.random.default_rng(4)
    for trial in range(12):
        fast, plain = (lab.Automaton((20, 9, 11), seed=trial, vertical=vertical) for _ in range(2))
        units = int(random.integers(1, 20 * 99))
        for event in range(5):
            solid = np.zeros((20, 9, 11), np.uint8)
            z, y, x = random.integers(0, (18, 6, 8))
            solid[z : z + event, y : y + 4, x : x + 3] = 1
            for a in (fast, plain):
                a.displace(solid)
                if event == 0:
                    a.fill(units)
            for _ in range(int(random.integers(1, 30))):
                fast.sweep()
                plain.sweep(plain=True)
                assert (fast.content == plain.content).all()
            if event == 2:
                # Poured onto liquid that may be at rest; and one form goes on where the other stopped.
                for a in (fast, plain):
                    a.fill(20)
                fast.sweep(plain=True)
                plain.sweep()
            if event == 3:
                q = fast.content
                q[19][solid[19] == 0] += 1
                fast.content = plain.content = q


def test_a_full_box_is_at_rest_and_a_drop_is_not():
    """Tell full layers below empty ones from one unit in a layer, and from layers over a gap."""
    a = lab.Automaton((6, 5, 4))
    assert a.at_rest
    a.fill(3 * 20)
    assert a.at_rest
    a.sweep()
    assert a.at_rest
    q = a.content
    assert (q[:3] == 1).all() and (q[3:] == 0).all()
    q[3, 2, 2] = 1
    a.content = q
    assert not a.at_rest
    q[3] = 0
    a.content = np.roll(q, 1, axis=0)
    assert not a.at_rest
    # Findings on layers do not outlive a plain sweep or a filling.
    a.sweep(4, plain=True)
    assert a.at_rest
    a.fill(1)
    assert not a.at_rest


def test_no_sweep_gains_or_loses_a_unit():
    """Sum up after each of 200 sweeps, with random solids and cells of up to the most units."""
    for n in range(4):
        solid, q = random_grid((12, 13, 15), 0.2 * n, lab.FULLEST, n)
        a = grid(solid, q, vertical="any" if n % 2 else "lower")
        for _ in range(200):
            a.sweep()
            assert a.total == q.sum()
        assert a.content.max() <= lab.FULLEST and not a.content[solid != 0].any()


def reachable(solid, start):
    """Cells joined to the start by faces."""
    found = np.zeros_like(solid, bool)
    found[start] = True
    while True:
        padded = np.pad(found, 1)
        grown = found | padded[:-2, 1:-1] | padded[2:, 1:-1] | padded[1:-1, :-2] | padded[1:-1, 2:]
        grown &= solid == 0
        if (grown == found).all():
            return found
        found = grown


@pytest.mark.parametrize("side", [pytest.param(12, marks=pytest.mark.soak), 13])
def test_density_is_uniform_among_obstacles(side):
    """Find liquid as often in every cell that can be reached, and in no other, with 25 % random obstacles."""
    solid = (np.random.default_rng(side).random((side, side)) < 0.25).astype(np.uint8)
    free = reachable(solid, tuple(np.argwhere(solid == 0)[side]))
    assert free.sum() > side**2 / 2
    places = np.argwhere(free)
    layers, samples, apart = 1000, 10, 400
    # Every layer is a sample of its own: solid layers lie between, so that nothing falls.
    tower = np.ones((2 * layers, side, side), np.uint8)
    tower[::2] = solid
    q = np.zeros_like(tower)
    half = places[: len(places) // 2]
    q[::2, half[:, 0], half[:, 1]] = 1
    a = grid(tower, q)
    seen = np.zeros((side, side))
    # The slowest mode of an open square takes side^2/pi^2 = 15 sweeps, of a maze some times that.
    a.sweep(1000)
    for _ in range(samples):
        a.sweep(apart)
        seen += a.content[::2].sum(0)
    assert not seen[~free].any()
    density = seen[free] / (samples * layers)
    expected = len(half) / len(places)
    # Five standard deviations of independent draws.
    assert np.abs(density - expected).max() < 5.0 * np.sqrt(expected * (1.0 - expected) / (samples * layers))


def test_nothing_leaks_through_a_diagonal_gap():
    """Keep liquid in its room where two rooms touch at an edge only."""
    solid = np.zeros((3, 8, 8), np.uint8)
    solid[:, :4, 4:] = solid[:, 4:, :4] = 1
    q = np.zeros_like(solid)
    q[:, :4, :4] = 1
    q[2, 1, 1] = 9
    a = grid(solid, q)
    a.sweep(3000)
    assert a.content[:, :4, :4].sum() == q.sum() and not a.content[:, 4:, 4:].any()


def test_a_slope_levels_in_the_time_of_diffusion():
    """Decay e-fold in W^2 / pi^2 sweeps, as for a diffusion coefficient of 1 cell^2 per sweep."""
    width, depth, layers = 32, 64, 16
    mode = np.cos(np.pi * (np.arange(width) + 0.5) / width)
    columns = np.arange(layers)[:, None] < np.round(8.0 + 6.0 * mode)
    q = np.repeat(columns[:, None], depth, axis=1).astype(np.uint8)
    a = grid(np.zeros_like(q), q)
    sweeps = width**2 // 10
    a.sweep(sweeps)
    left = a.content.sum((0, 1)) @ mode / (q.sum((0, 1)) @ mode)
    # Twenty seeds gave 0.1018 with a standard deviation of 0.0008; 1 / pi^2 = 0.1013.
    assert -sweeps / np.log(left) / width**2 == pytest.approx(1.0 / np.pi**2, rel=0.05)


def test_buried_excess_rises_to_the_surface():
    """Clear 40 extra units 8 cells deep in a few sweeps."""
    for vertical in ("lower", "any"):
        a = lab.Automaton((16, 16, 16), vertical=vertical)
        a.fill(10 * 256)
        q = a.content
        q[2, 3:8, 4:12] += 1
        a.content = q
        a.sweep(8)
        assert a.content.max() == 1 and (a.content[:10] == 1).all() and a.content[10:].sum() == 40


@pytest.mark.parametrize("trial", range(20))
def test_moving_solids_lose_no_liquid(trial):
    """Keep the sum, the most per cell and solids dry under 100 masks of 0 to 50 %; follow the twin."""
    random = np.random.default_rng(trial)
    shape = tuple(random.integers(2, 11, 3))
    a = lab.Automaton(shape, seed=trial)
    a.fill(int(random.integers(1, np.prod(shape))))
    total, old = a.total, a.solid
    for step in range(100):
        new = (random.random(shape) < random.uniform(0.0, 0.5)).astype(np.uint8) * random.integers(1, 3)
        new[tuple(random.integers(0, shape))] = 0
        new = new.astype(np.uint8)
        q = a.content
        assert a.displace(new) == ((new != 0) != (old != 0)).sum()
        if step < 5:
            assert twin.displace(q, new, trial, a.now)
            assert (a.content == q).all()
        assert (a.solid == new).all() and a.count_solid == (new != 0).sum()
        fresh = grid(new, a.content, seed=trial)
        fresh.now = a.now
        fresh.share(3)
        for b in (a, fresh):
            b.sweep(2)
        # Solids that came and went leave the same as solids that were there from the start.
        assert (a.content == fresh.content).all()
        assert a.total == total and a.content.max() <= lab.FULLEST and not a.content[new != 0].any()
        old = new


def test_a_piston_raises_the_level_by_its_volume():
    """Push a block of 6^3 cells under a 16x16 pool 10 deep: level 10.84, no cell keeps more than one unit."""
    a = lab.Automaton((20, 16, 16))
    a.fill(10 * 256)
    for bottom in range(14, 1, -1):
        solid = np.zeros(a.shape, np.uint8)
        solid[bottom : bottom + 6, 5:11, 5:11] = 1
        a.displace(solid)
        a.sweep(8)
    a.sweep(100)
    q = a.content
    assert a.total == 2560 and q.max() == 1
    assert (q.sum() + 216) / 256 == pytest.approx(10.84, abs=0.005)
    assert (q[:10][solid[:10] == 0] == 1).all() and q[10].sum() == 216 and not q[11:].any()


def test_no_room_is_an_error_and_changes_nothing():
    """Name the cell whose liquid fits nowhere, after others found a place, and leave everything as before."""
    solid = np.zeros((1, 1, 6), np.uint8)
    a = lab.Automaton(solid.shape)
    q = np.array([1, 2, 20, 0, 240, 200], np.uint8).reshape(solid.shape)
    a.content = q
    solid[..., :2], solid[..., 4] = (1, 2), 2
    solid[..., 3] = 1
    with pytest.raises(RuntimeError, match=r"cell \(4, 0, 0\) .* no room for the 240 units"):
        a.displace(solid)
    assert (a.content == q).all() and not a.solid.any()
    solid[..., 4] = 0
    assert a.displace(solid) == 3
    assert a.content.ravel().tolist() == [0, 0, 23, 0, 240, 200]
    q, before = a.content, a.solid
    with pytest.raises(RuntimeError, match="no room for the 23 units"):
        a.displace(np.ones_like(solid))
    assert (a.content == q).all() and (a.solid == before).all()


def test_a_cell_takes_no_more_than_the_most():
    """Count room for the whole content: 120 units fit on 130, not on 131, whatever lies nearer."""
    a = lab.Automaton((1, 1, 4))
    solid = np.array([1, 0, 0, 0])
    a.content = np.array([120, 131, 131, 200])
    with pytest.raises(RuntimeError, match="no room for the 120 units"):
        a.displace(solid)
    a.content = np.array([120, 131, 130, 200])
    a.displace(solid)
    assert a.content.ravel().tolist() == [0, 131, 250, 200]


@pytest.mark.parametrize("shape", [(4, 5, 6), (7, 3, 5), (3, 16, 17)], ids=str)
def test_filling_is_exact(shape):
    """Pour any number of units around solids, within a region, on liquid, as the twin; tell the rest."""
    random = np.random.default_rng(1)
    for n in range(20):
        solid, _ = random_grid(shape, 0.3, 1, n)
        within = (random.random(shape) < 0.7).astype(np.uint8)
        units = int(random.integers(0, np.prod(shape)))
        a = grid(solid, np.zeros(shape, np.uint8), seed=n)
        q = np.zeros(shape, np.uint8)
        left = a.fill(units // 2, within)
        assert left == twin.fill(q, solid, units // 2, within, n, 0)
        a.now = 1
        rest = a.fill(units)
        assert rest == twin.fill(q, solid, units, np.ones(shape), n, 1)
        assert (a.content == q).all() and a.total == units // 2 - left + units - rest


@pytest.mark.no_memory
def test_a_grid_without_memory_is_told():
    """An absurd size raises an error with its reason instead of ending the process."""
    with pytest.raises(MemoryError, match="out of memory"):
        lab.Automaton((2**20, 2**20, 2**20))
