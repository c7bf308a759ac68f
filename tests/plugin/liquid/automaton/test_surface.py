# SPDX-License-Identifier: GPL-2.0-only
"""The smooth surface: level stays level, walls separate, bodies are covered, noise shrinks."""

import numpy as np
import pytest
from level_lab import smooth
from twin import level as twin

# Weights and weighted heights are in single precision: 10 steps of rounding at 6e-8 of the range of heights.
SINGLE = 2e-6


@pytest.mark.parametrize("seed", range(12))
def test_equals_the_twin(seed):
    """Random sizes, heights, holes and blocked columns, against powers of the matrix of one step."""
    random = np.random.default_rng(seed)
    shape = (1, 17) if seed == 0 else tuple(random.integers(2, 26, 2))
    height = random.uniform(0.0, 20.0, shape)
    height[random.random(shape) < random.choice([0.0, 0.3, 0.95])] = np.nan
    blocked = random.random(shape) < random.choice([0.0, 0.1, 0.4])
    result = smooth(height, blocked)
    assert np.abs(result - twin.smooth(height, blocked)).max() < 20.0 * SINGLE


# (v + v + v) / 3 is not v for some of the later ones.
@pytest.mark.parametrize("value", [0.0, 7.0, 2.0 + 1.0 / 3.0, 1e3 / 7.0, 5.6, 10.84, 11.7, 23.9])
def test_a_level_surface_keeps_every_bit(value):
    """Also over bodies, wide ones too, and over walls; beside a rough pool as well."""
    height = np.full((50, 60), value)
    height[5:45, 10:50] = np.nan
    blocked = np.zeros(height.shape, bool)
    blocked[:, 3] = blocked[0, 30] = True
    assert (smooth(height, blocked) == value).all()
    height[:, :3] += np.random.default_rng(1).random((50, 3))
    rough = smooth(height, blocked)
    assert (rough[:, 4:] == value).all()
    assert (rough[:, :3] > value).all()


def test_a_wall_separates():
    """Each side keeps its own level, unlike through an open boundary; the wall itself lies between."""
    height = np.full((8, 21), 4.0)
    height[:, 11:] = 9.0
    blocked = np.zeros(height.shape, bool)
    blocked[:, 10] = True
    result = smooth(height, blocked)
    assert (result[:, :10] == 4.0).all() and (result[:, 11:] == 9.0).all()
    assert (result[:, 10] == 6.5).all()
    assert 4.5 < smooth(height)[4, 9] < 6.5


def test_blocked_columns_tell_nothing():
    """A height written where a column is blocked is not used."""
    height = np.full((9, 9), 3.0)
    height[4] = 50.0
    blocked = np.zeros(height.shape, bool)
    blocked[4] = True
    assert (smooth(height, blocked) == 3.0).all()


def test_a_pool_shut_in_by_walls_without_liquid_takes_what_is_around():
    """No region stays without a height where any column tells one; where none does all is 0."""
    height = np.full((15, 15), 2.0)
    blocked = np.zeros(height.shape, bool)
    blocked[4:11, 4:11] = True
    blocked[5:10, 5:10] = False
    height[5:10, 5:10] = np.nan
    assert (smooth(height, blocked) == 2.0).all()
    assert (smooth(np.full((4, 6), np.nan)) == 0.0).all()
    assert (smooth(np.full((4, 6), 3.0), np.ones((4, 6))) == 0.0).all()


def test_under_a_wide_body_the_surface_runs_from_side_to_side():
    """A tilted surface around a body 40 columns wide: filled between what is told, half way in the middle."""
    height = np.repeat(np.linspace(2.0, 8.0, 61)[None], 61, axis=0)
    height[10:51, 10:51] = np.nan
    result = smooth(height)
    assert np.isfinite(result).all() and result.min() >= 2.0 and result.max() <= 8.0
    assert result[30, 30] == pytest.approx(5.0, abs=1e-5)
    # All the way under the body the filled surface rises, within rounding.
    assert (np.diff(result[30]) > -1e-5).all() and result[30, 45] - result[30, 15] > 1.0


def test_a_single_telling_column_reaches_every_other():
    """Everything beyond the filter's reach is filled ring by ring."""
    height = np.full((40, 33), np.nan)
    height[7, 30] = 3.25
    assert (smooth(height) == 3.25).all()


def test_width_of_the_filter():
    """A single raised column becomes a hump with variance 4 cells^2 along each axis and the same sum."""
    height = np.zeros((41, 41))
    height[20, 20] = 1.0
    hump = smooth(height)
    x = np.arange(41) - 20.0
    assert hump.sum() == pytest.approx(1.0, abs=1e-5)
    for axis in (0, 1):
        assert (hump.sum(axis) * x**2).sum() == pytest.approx(4.0, rel=1e-5)


def test_noise_at_rest():
    """A half-filled layer drawn by lot leaves 0.5 / sqrt(4 pi sigma^2) = 0.0705 cell, as a Gaussian would."""
    layer = np.random.default_rng(4).random((128, 128)) < 0.5
    noise = smooth(5.0 + layer)[8:-8, 8:-8]
    # 12 500 columns hold some 250 independent values: 5 % for their deviation, three times that allowed.
    assert noise.std() == pytest.approx(0.0705, rel=0.15)
    assert noise.mean() == pytest.approx(5.5, abs=0.02)


def test_mirrored_and_transposed_heights_give_the_same_bits():
    """No direction is preferred: floating bodies must not drift."""
    random = np.random.default_rng(6)
    height = random.uniform(0.0, 9.0, (37, 30))
    height[5:34, 4:27] = np.nan
    blocked = random.random(height.shape) < 0.05
    result = smooth(height, blocked)
    for turn in (np.fliplr, np.flipud, np.transpose):
        assert (smooth(turn(height), turn(blocked)) == turn(result)).all()
