# SPDX-License-Identifier: GPL-2.0-only
"""Symmetric matrices of many particles or objects at once, without LAPACK, which rounds as the CPU has it."""

from __future__ import annotations

import numpy as np


def largest_eigenvalue(matrices: np.ndarray, squarings: int = 5) -> np.ndarray:
    """Largest eigenvalue of positive matrices, shape (M, 3, 3), from below, by high powers: to 1 % by 32nd ones; shape (M,), same
    unit."""
    trace = lambda a: a[:, 0, 0] + a[:, 1, 1] + a[:, 2, 2]
    product = lambda a, b: sum(a[:, :, k, None] * b[:, None, k, :] for k in range(3))
    unit = power = matrices / trace(matrices)[:, None, None]
    for _ in range(squarings):
        power = product(power, power)
        power = power / trace(power)[:, None, None]
    return trace(matrices) * trace(product(power, unit))


def solve(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """x of ``matrix`` x = ``right`` for a positive definite matrix, shapes (K, K) and (K,)."""
    rows = np.column_stack([matrix, right])
    for k in range(len(rows)):  # Gauss and Jordan; no pivot is needed
        rows[k] /= rows[k, k]
        others = np.arange(len(rows)) != k
        rows[others] -= rows[others, k, None] * rows[k]
    return rows[:, -1]
