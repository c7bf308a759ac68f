# SPDX-License-Identifier: GPL-2.0-only
"""How far particles may go before lists are made anew: plugin/passes/displacement_budget.h, without LAMMPS."""

import numpy as np
import pytest
from engine_lab import Budget

RANDOM = np.random.default_rng(4)
THEN = RANDOM.uniform(-1.0, 1.0, (40, 3))


def moved(size: float, drift=(0.0, 0.0, 0.0)) -> np.ndarray:
    """Each particle elsewhere by up to ``size``, and all of them by ``drift``."""
    step = RANDOM.standard_normal(THEN.shape)
    return THEN + drift + size * step / np.linalg.norm(step, axis=1).max()


@pytest.mark.parametrize(
    ("absolute", "relative", "drift", "left"),
    [
        pytest.param(0.0, 0.0, 0.0, 0.3, id="half the skin less the farthest"),
        pytest.param(2.0, 0.0, 0.0, 0.4, id="one participant that needs lists sets it"),
        pytest.param(2.0, 3.0, 0.0, 1.8, id="participants that sleep allow more"),
        pytest.param(100.0, 3.0, 10.0, 2.9, id="relative: what all do together does not count"),
        pytest.param(5.0, 50.0, 10.0, -5.2, id="absolute: it does"),
    ],
)
def test_what_is_left(absolute, relative, drift, left):
    """Move two particles by a drift, and one of them by 0.2 more: half the skin is 0.5."""
    now = np.array([[drift, 0.0, 0.0], [drift + 0.2, 0.0, 0.0]])
    budget = Budget()
    budget.measure(now, np.zeros((2, 3)), 0.5, absolute, relative)
    assert budget.left() == pytest.approx(left, abs=1e-6)


@pytest.mark.parametrize("drift", [0.0, 7.0])
def test_no_pair_comes_nearer_than_the_limit_while_some_is_left(drift):
    """Move 40 particles at random beside a drift, and compare all pairs.

    While some of a relative budget is left, no two have come nearer by more than twice the limit; the drift takes nothing of it.
    """
    limit, kept = 1.0, 0
    for size in np.linspace(0.1, 1.4, 40):
        now = moved(size, (drift, 0.3 * drift, -drift))
        budget = Budget()
        budget.measure(now, THEN, 0.0, 1e6, limit)
        d = now - THEN
        nearer = np.linalg.norm(d[:, None] - d[None], axis=2).max()
        if budget.spend(0.0):
            kept += 1
            assert nearer <= 2.0 * limit
        assert budget.spend(0.0) or size > 0.5
    assert 10 < kept < 40


def test_it_is_spent_until_it_is_nearly_and_wholly_spent():
    """Spend a budget of 1 by tenths."""
    budget = Budget()
    budget.measure(THEN, THEN, 1.0)
    budget.begin(3)
    states = []
    for _ in range(10):
        states.append((budget.spend(0.1), budget.nearly_spent))
        budget.begin(3)  # the same lists: the whole stays what it was
    assert states[:7] == [(True, False)] * 7 and states[8] == (True, True)
    assert not budget.spend(0.001) and not budget.overflowed
    budget.spend(np.inf)
    assert budget.overflowed


SHARES = np.array([[0.0, 8.0, 0.0, 4.0, 0.0, 0.0], [0.0, 8.0, 0.0, 8.0, 0.0, 0.0], [0.0, 8.0, 0.0, 8.0, 0.0, 0.0]])
"""The lower half of a fixed box."""


def test_ranks_share_what_is_left():
    """Let another rank tell a lower number: it counts on this one."""
    other = {1: [0.25], 5: [9.0, 9.0, 0.5, 1.0, 1.0], 12: [np.inf] * 12}

    def least(numbers):
        numbers[:] = np.minimum(numbers, other[len(numbers)])

    budget = Budget(least, SHARES)
    budget.measure([[2.0, 4.0, 4.0]], [[2.0, 4.0, 4.0]], 0.5, 9.0, 9.0)
    assert budget.spend(0.0)
    other[1] = [-np.inf]
    assert not budget.spend(0.0) and budget.overflowed


@pytest.mark.parametrize(("x", "left"), [(2.0, 2.0), (3.0, 1.5), (4.0, 1.0), (5.5, 0.5)])
def test_no_particle_passes_by_half_a_rank_unseen(x, left):
    """Put a particle of the lower half of the box near its upper end and beyond.

    It may go half of the way to the middle of the other half, which may come towards it, but half the skin, 0.5, in any case.
    """
    budget = Budget(lambda numbers: np.minimum(numbers, [9, 9, 0.5, 1, 1], out=numbers) if len(numbers) == 5 else None, SHARES)
    budget.measure([[x, 4.0, 4.0]], [[x, 4.0, 4.0]], 0.5, 9.0, 9.0)
    assert budget.left() == pytest.approx(left, abs=1e-6)


def test_shares_go_where_particles_are():
    """Let all particles, and a box that follows them, drift by 100 after lists were made: no way is lost."""
    shares = SHARES.copy()
    shares[:, 4:] = 1.0
    then = np.array([[0.0, 0.0, 0.0], [2.0, 8.0, 8.0]])

    def least(numbers):
        if len(numbers) == 12:  # the box around all: another rank has a particle at the upper end
            numbers[6:] = np.minimum(numbers[6:], [100.0, 100.0, 100.0, -108.0, -108.0, -108.0])

    for drift in (0.0, 100.0):
        budget = Budget(least if drift else lambda n: n[6:].__setitem__(3, -8.0) if len(n) == 12 else None, shares)
        budget.measure(then + drift, then, 0.5, 1e3, 9.0)
        assert budget.left() == pytest.approx(2.0, abs=1e-6)
