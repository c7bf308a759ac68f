# SPDX-License-Identifier: GPL-2.0-only
"""Weighted sums of rows against the full matrix."""

import numpy as np
from mdanim_lammps.results.weights import Weights


def test_products_and_rows_are_those_of_the_matrix():
    """Entries in any order, several for one place of the matrix, rows of one entry and of many."""
    random = np.random.default_rng(7)
    row, column = np.concatenate([np.arange(50), random.integers(50, size=400)]), random.integers(20, size=450)
    weight = random.normal(size=450)
    full = np.zeros((50, 20))
    np.add.at(full, (row, column), weight)
    order = random.permutation(450)
    weights = Weights.of(row[order], column[order], weight[order])
    value, some = random.normal(size=(20, 3)), random.permutation(50)[:30]
    assert len(weights) == 50
    np.testing.assert_allclose(weights @ value, full @ value, atol=1e-13)
    np.testing.assert_allclose(weights @ value[:, 0], full @ value[:, 0], atol=1e-13)
    np.testing.assert_allclose(weights[some] @ value, full[some] @ value, atol=1e-13)
    np.testing.assert_allclose(weights[some][::-1] @ value, full[some][::-1] @ value, atol=1e-13)


def test_no_rows():
    """A mesh without vertices."""
    none = np.zeros(0, dtype=np.int64)
    assert (Weights.of(none, none, np.zeros(0)) @ np.zeros((4, 3))).shape == (0, 3)
