# SPDX-License-Identifier: GPL-2.0-only
"""The level rule and exact heights: against the naive twin, vessels, dams, lids, moving masks."""

import numpy as np
import pytest
from level_lab import Pool
from twin import level as twin

NO_HEIGHT = np.nan


def random_cells(random, shape):
    """Content and mask of a random grid: sparse or dense, layered or not, with excess or without."""
    solid = (random.random(shape) < random.choice([0.0, 0.1, 0.4, 0.7])).astype(np.uint8)
    chance = random.choice([0.0, 0.1, 0.5, 0.8, 1.0])
    if random.random() < 0.5:
        chance = chance * np.linspace(1.5, 0.0, shape[0])[:, None, None]
    content = (random.random(shape) < chance).astype(np.uint8)
    overfull = random.random(shape) < random.choice([0.0, 0.02, 0.3])
    content += (overfull * random.integers(0, 5, shape)).astype(np.uint8)
    content[random.integers(1, 2 * shape[0]) :] = 0
    content[solid > 0] = 0
    return content, solid


def settle(pool, rate=1.0, limit=1000):
    """Call the rule until nothing moves; how many calls moved something."""
    for calls in range(limit):
        if pool.move(when=calls, rate=rate) == 0:
            return calls
    raise AssertionError("never ends")


# Rows of one word of 64 cells and less, exactly one, and more than one.
@pytest.mark.parametrize("nx", [1, 2, 5, 9, 63, 64, 65, 130])
def test_moves_and_heights_equal_the_twin_in_every_cell(nx):
    """Same cells, same counts, same heights to the last bit, also when the buffers come from other cells."""
    random = np.random.default_rng(nx)
    shape = (7, 5, nx)
    pool = Pool(*random_cells(random, shape))
    moved = 0
    for case in range(40 if nx < 60 else 8):
        content, solid = random_cells(random, shape)
        pool.set(content, solid)
        for when in range(3):
            rate, at_least = random.choice([0.0, 0.1, 0.25, 1.0]), int(random.choice([0, 3, 50]))
            content, expected = twin.move(content, solid, case, when, rate, at_least)
            assert pool.move(case, when, rate, at_least) == expected
            assert (pool.content == content).all()
            height, level = twin.heights(content, solid)
            for just_moved in (True, False):
                got, got_level = pool.heights(just_moved)
                np.testing.assert_array_equal(got, height)
                assert got_level == level
            moved += expected
    assert moved > 20


def test_draws_depend_on_seed_and_time():
    """Half a layer above half a layer: which cells move is another lot for every seed and every call."""
    content = np.zeros((3, 8, 8), np.uint8)
    content[0, :, :4] = content[1, :, :4] = 1
    results = set()
    for seed, when in ((1, 0), (1, 0), (2, 0), (1, 1)):
        pool = Pool(content, np.zeros_like(content))
        assert pool.move(seed, when, rate=0.25) == 8
        results.add(pool.content.tobytes())
    assert len(results) == 3


@pytest.mark.parametrize("seed", range(6))
def test_falls_strictly_and_ends_level(seed):
    """Without excess every call that moves loses energy; at the end all is level, and nothing was lost."""
    random = np.random.default_rng(seed)
    content, solid = random_cells(random, (8, 7, 12))
    content = np.minimum(content, 1)
    pool = Pool(content, solid)
    energy, units = twin.energy(content), int(content.sum())
    for when in range(1000):
        moved = pool.move(seed, when, 0.25)
        after = pool.content
        assert int(after.sum()) == units and not after[solid > 0].any() and after.max(initial=0) <= 1
        assert twin.energy(after) <= energy - moved
        energy = twin.energy(after)
        if moved == 0:
            break
    assert moved == 0
    assert pool.heights()[1]


def vessels(gap=2):
    """Two vessels 8 x 8 with a wall between that is open in the lowest cells; 12 and 4 full."""
    content = np.zeros((16, 8, 17), np.uint8)
    solid = np.zeros_like(content)
    solid[gap:, :, 8] = 2
    content[:12, :, :8] = 1
    content[:4, :, 9:] = 1
    content[:gap, :, 8] = 1
    return content, solid


@pytest.mark.parametrize(("rate", "calls"), [(0.1, 19), (0.25, 8), (1.0, 4)])
def test_vessels_joined_under_the_surface_become_equal(rate, calls):
    """12 | 4 are equal within half a cell after as many calls as a NumPy prototype needed."""
    pool = Pool(*vessels())
    difference = lambda: (pool.content[:, :, :8].sum() - pool.content[:, :, 9:].sum()) / 64.0
    for n in range(calls):
        assert difference() >= 0.5
        pool.move(when=n, rate=rate)
    assert abs(difference()) < 0.5
    settle(pool)
    assert abs(difference()) <= 0.5
    height, level = pool.heights()
    assert level
    assert np.unique(height[:, 9:]).tolist() == np.unique(height[:, :8]).tolist() == [8.0]
    assert np.isnan(height[:, 8]).all()


def test_vessels_without_a_gap_stay_apart():
    """A closed wall separates: each side is level by itself, and nothing moves."""
    content, solid = vessels(gap=0)
    content[12, :4, :4] = 1
    pool = Pool(content, solid)
    assert pool.move(rate=1.0) == 0
    height, level = pool.heights()
    assert level
    assert (height[:, :8] == 12.25).all() and (height[:, 9:] == 4.0).all()


def test_nothing_leaks_through_a_diagonal_gap():
    """Cells that only touch along an edge are not a way."""
    solid = np.zeros((6, 2, 2), np.uint8)
    solid[:, 0, 1] = solid[:, 1, 0] = 1
    content = np.zeros_like(solid)
    content[:5, 0, 0] = 1
    pool = Pool(content, solid)
    assert pool.move(rate=1.0) == 0
    assert (pool.content == content).all()


@pytest.mark.parametrize("width", [16, 32, 64])
def test_dam_break_takes_time_in_proportion_to_its_width(width):
    """A full quarter of the basin levels out to 2 cells in 0.8 W calls; sweeps alone need some W^2 / 4."""
    content = np.zeros((width // 2, 8, width), np.uint8)
    content[: width // 2 - 2, :, : width // 4] = 1
    pool = Pool(content, np.zeros_like(content))
    for calls in range(2 * width):
        height, _ = pool.heights()
        if np.ptp(height) <= 2:
            break
        assert pool.move(when=calls, rate=0.25) > 0
    assert 0.4 * width <= calls <= width
    settle(pool)
    height, level = pool.heights()
    assert level
    # A quarter of a layer is left over on top: one height, exactly the volume over the area.
    assert (height == content.sum() / (8 * width)).all()


def test_excess_under_a_lid_gets_out():
    """Units above 1 under a lid rise beside it, to the lowest room there is, and the count stays."""
    content = np.zeros((8, 6, 10), np.uint8)
    solid = np.zeros_like(content)
    solid[4, :, :6] = 1
    content[:4] = 1
    content[1, 2, :5] = 4
    pool = Pool(content, solid)
    units = int(content.sum())
    assert not pool.heights()[1]
    assert pool.move(rate=0.0, at_least=7) == 7  # S = 24: at most max(1, 0, 7)
    assert settle(pool) == 1
    after = pool.content
    assert int(after.sum()) == units and after.max() == 1
    # 15 units on 24 cells beside the lid.
    assert int(after[4].sum()) == 15 and not after[5:].any()
    height, level = pool.heights()
    assert level and np.isnan(height[:, :6]).all() and (height[:, 6:] == 4.0 + 15.0 / 24.0).all()


def test_excess_without_room_stays():
    """A closed box that is overfull keeps its units where they are."""
    content = np.full((2, 3, 4), 2, np.uint8)
    pool = Pool(content, np.zeros_like(content))
    assert pool.move(rate=1.0, at_least=100) == 0
    assert (pool.content == content).all()
    height, level = pool.heights()
    assert not level and (height == 2.0).all()


def test_two_bodies_cannot_fill_one_cell_twice():
    """A cell between two bodies goes to the first in order; the other waits."""
    solid = np.ones((4, 1, 3), np.uint8)
    solid[:, 0, 0] = solid[:, 0, 2] = 0
    solid[0, 0, 1] = 0
    content = np.zeros_like(solid)
    content[:3, 0, 0] = content[:3, 0, 2] = 1
    pool = Pool(content, solid)
    assert pool.move(rate=1.0) == 1
    assert pool.content[:3, 0].tolist() == [[1, 1, 1], [1, 0, 1], [0, 0, 1]]


def test_moving_masks_never_lose_a_unit():
    """50 random masks, liquid of solid cells piled up by lot: sum exact, none in solid, equal to the twin."""
    random = np.random.default_rng(3)
    shape = (7, 6, 9)
    content = np.zeros(shape, np.uint8)
    content[:3] = 1
    pool = Pool(content, np.zeros_like(content))
    for when in range(50):
        solid = (random.random(shape) < random.uniform(0.0, 0.5)).astype(np.uint8)
        homeless = int(content[solid > 0].sum())
        content[solid > 0] = 0
        np.add.at(content.ravel(), random.choice(np.flatnonzero(solid.ravel() == 0), homeless), 1)
        pool.set(content, solid)
        content, moved = twin.move(content, solid, 5, when, 0.25, homeless)
        assert pool.move(5, when, 0.25, homeless) == moved
        assert (pool.content == content).all()
        assert int(content.sum()) == 3 * 6 * 9 and not content[solid > 0].any()


def half_full(shape, height, seed=1):
    """A level pool: whole layers, and a random part of the layer on top."""
    random = np.random.default_rng(seed)
    content = (np.arange(shape[0])[:, None, None] < int(height)).astype(np.uint8) * np.ones(shape, np.uint8)
    cells = shape[1] * shape[2]
    part = random.choice(cells, round((height - int(height)) * cells), replace=False)
    content[min(int(height), shape[0] - 1)].flat[part] = 1
    return content


@pytest.mark.parametrize("height", [0.0, 3.0, 5.25, 5.5, 8.0, 8.75, 9.0])
def test_a_level_pool_has_one_height_everywhere(height):
    """Volume over area in every column, up to the top of the grid; their sum is the volume."""
    content = half_full((9, 12, 20), height)
    pool = Pool(content, np.zeros_like(content))
    told, level = pool.heights()
    assert level and (told == height).all()
    assert told.sum() == content.sum()


def test_a_heap_tells_raw_heights():
    """Where a body is not level every column has its own whole height."""
    content = half_full((9, 4, 4), 2.0)
    content[2:5, 1, 1] = 1
    told, level = Pool(content, np.zeros_like(content)).heights()
    expected = np.full((4, 4), 2.0)
    expected[1, 1] = 5.0
    assert not level
    np.testing.assert_array_equal(told, expected)


def test_a_column_up_to_the_top_of_the_grid_falls():
    """A basin is open at the top: nothing covers the cells of the top layer."""
    content = half_full((6, 5, 5), 2.0)
    content[:, 2, 2] = 1
    pool = Pool(content, np.zeros_like(content))
    assert pool.move(rate=0.0, at_least=1) == 1
    assert pool.content[:, 2, 2].tolist() == [1, 1, 1, 1, 1, 0]


def test_columns_around_a_floating_body():
    """Columns of the body and of a wall tell nothing, all others exactly the level of their side."""
    content = half_full((10, 12, 20), 5.5)
    solid = np.zeros_like(content)
    solid[4:8, 3:6, 3:6] = 1
    solid[:, :, 10] = 2
    content[solid > 0] = 0
    free = np.ones((12, 20), bool)
    free[3:6, 3:6] = free[:, 10] = False
    told, level = Pool(content, solid).heights()
    left, right = free[:, :10], free[:, 11:]
    assert level
    assert np.isnan(told[~free]).all()
    assert (told[:, :10][left] == 5.0 + content[5][:, :10].sum() / left.sum()).all()
    assert (told[:, 11:][right] == 5.0 + content[5][:, 11:].sum() / right.sum()).all()
    # Without solids in the column the sum over columns is the volume there; 100 sums of rounded heights.
    assert told[:, 11:].sum() == pytest.approx(content[:, :, 11:].sum(), rel=1e-12)


def test_a_sunken_block_is_an_ordinary_column():
    """With liquid above it a block at the bottom changes no height."""
    content = half_full((10, 8, 8), 5.5)
    solid = np.zeros_like(content)
    solid[:3, 2:5, 2:5] = 2
    content[solid > 0] = 0
    told, level = Pool(content, solid).heights()
    assert level and (told == 5.5).all()


def test_films_drops_and_dry_columns():
    """Films and drops, which stand neither on liquid nor on the floor, have no height; dry columns have 0, or none."""
    solid = np.zeros((6, 1, 12), np.uint8)
    content = np.zeros_like(solid)
    solid[:, 0, [1, 3, 5, 8]] = 2  # partitions
    content[:2, 0, 0] = 1  # a pool
    solid[:2, 0, 2] = 1
    content[2, 0, 2] = 1  # a film on a block
    content[4, 0, 4] = 1  # a drop in the air
    solid[0, 0, 6], solid[:2, 0, 7] = 1, 1
    content[1, 0, 6] = content[2, 0, 7] = 1  # a film down two steps
    content[0, 0, 9] = 1  # a film on the floor, and beside it dry floor
    solid[0, 0, 11] = 1  # a dry block
    told, _ = Pool(content, solid).heights()
    nan = NO_HEIGHT
    np.testing.assert_array_equal(told[0], [2.0, nan, nan, nan, nan, nan, nan, nan, nan, 1.0, 0.0, nan])


def test_a_pool_flush_with_a_block_is_not_overrated():
    """Cells on top of a block that reaches up to the part-filled layer do not count in the mean."""
    content = half_full((6, 6, 8), 3.5)
    solid = np.zeros_like(content)
    solid[:3, :, :4] = 1
    content[solid > 0] = 0
    content[3] = 0
    content[3, :3, 3:] = 1
    told, level = Pool(content, solid).heights()
    assert level
    assert (told[:, 4:] == 3.5).all() and (told[:3, 3] == 3.5).all()
    assert np.isnan(told[:, :3]).all() and np.isnan(told[3:, 3]).all()


def test_heights_see_what_was_written_after_a_call():
    """Only `just_moved` spares the search."""
    content = half_full((6, 4, 4), 2.5)
    pool = Pool(content, np.zeros_like(content))
    assert pool.move() == 0
    pool.set(half_full((6, 4, 4), 3.25), np.zeros_like(content))
    assert (pool.heights()[0] == 3.25).all()
