# SPDX-License-Identifier: GPL-2.0-only
"""The account of what velocity-dependent forces take: plugin/passes/loss.h against the sum that it documents, without LAMMPS."""

import numpy as np
import pytest
from engine_lab import loss

DT = 0.07


def twin(force: np.ndarray, seen: np.ndarray) -> float:
    """The sum of loss.h up to the last step, step 0 a setup."""

    def dot(a, b):
        return float((a * b).sum())

    n = len(force) - 1
    work = 0.5 * DT * -dot(force[0], seen[0])
    work -= 0.5 * DT * sum(dot(force[m], seen[m] + seen[m + 1]) for m in range(1, n))
    work -= DT / 6.0 * sum(dot(force[m + 1] - force[m], seen[m + 1] - seen[m]) for m in range(1, n))
    return work - 0.5 * DT * dot(force[n], seen[n]) + DT / 12.0 * dot(force[n] - force[n - 1], seen[n])


def smooth(steps: int, particles: int) -> tuple[np.ndarray, np.ndarray]:
    """Velocities that swing, shape (steps + 1, N, 3), and the forces of dashpots of different strength on them."""
    random = np.random.default_rng(7)
    rate, phase = random.uniform(0.5, 2.0, (particles, 3)), random.uniform(0.0, 6.0, (particles, 3))
    seen = np.cos(rate * DT * np.arange(steps + 1)[:, None, None] + phase)
    return -random.uniform(0.1, 1.0, (particles, 1)) * seen[:-1], seen


@pytest.mark.parametrize("steps", [4, 5, 40])
def test_plain_steps_give_the_documented_sum(steps):
    """Add up forces of three particles."""
    force, seen = smooth(steps, 3)
    assert loss(force, seen, DT) == pytest.approx(twin(force, seen), rel=1e-12)


@pytest.mark.parametrize(("first", "last"), [(3, 4), (3, 20), (7, 37), (10, 38)])
def test_passes_go_on_with_the_account(first, last):
    """Let passes take some of the steps: the same sum, but for the bend of the first pass, which is that of the step before."""
    force, seen = smooth(40, 3)
    bend = [((force[m + 1] - force[m]) * (seen[m + 1] - seen[m])).sum() for m in (first - 2, first - 1)]
    expected = twin(force, seen) - DT / 6.0 * (bend[0] - bend[1])
    assert loss(force, seen, DT, (first, last)) == pytest.approx(expected, rel=1e-12)
    assert loss(force, seen, DT) > 0.0
