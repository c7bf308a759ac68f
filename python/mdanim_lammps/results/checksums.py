# SPDX-License-Identifier: GPL-2.0-only
"""CRC-32 of a whole from those of its pieces: several processes write a quantity of a frame, and the file has one checksum of it.

A CRC-32 is linear, so that of a whole is the sum modulo 2 of those of its pieces, each times x^(8 b) modulo the polynomial, where
b bytes of the whole come after the piece. The highest bit of a number here is its coefficient of x^0, as in zlib.
"""

from __future__ import annotations

from functools import cache

import numpy as np

_POLYNOMIAL = np.uint32(0xEDB88320)
_BITS = np.arange(31, -1, -1, dtype=np.uint32)
"""Bit of each power of x, from x^0 on."""


def shifts(after: np.ndarray) -> np.ndarray:
    """Coefficients that `joined` needs for pieces followed by ``after`` bytes of the whole, int64, shape (P,): uint32, (P,
    32)."""
    factor = np.full(len(after), 1 << 31, np.uint32)
    for bit in range(int(after.max(initial=0)).bit_length()):
        some = (after >> bit & 1).astype(bool)
        factor[some] = _product(factor[some], _byte_shifts()[bit])
    return _multiples(factor)


def joined(checksums: np.ndarray, of_pieces: np.ndarray) -> np.ndarray:
    """The part of these pieces in the checksum of the whole, of which others may write the rest: that of all is the sum modulo 2.

    ``checksums`` are those of each piece alone, uint32, shape (..., P); ``of_pieces`` as `shifts` gives it. Returns uint32 of
    shape (...).
    """
    return np.bitwise_xor.reduce(_product(checksums, of_pieces), axis=-1)


def _product(a: np.ndarray, multiples: np.ndarray) -> np.ndarray:
    """Products of ``a`` and numbers of which `_multiples` are given."""
    return np.bitwise_xor.reduce(np.where(a[..., None] >> _BITS & 1, multiples, np.uint32(0)), axis=-1)


def _multiples(b: np.ndarray) -> np.ndarray:
    """b, b x, b x^2, ... b x^31, shape (..., 32)."""
    found = np.empty((*b.shape, 32), np.uint32)
    for k in range(32):
        found[..., k] = b
        b = b >> 1 ^ np.where(b & 1, _POLYNOMIAL, np.uint32(0))
    return found


@cache
def _byte_shifts() -> np.ndarray:
    """`_multiples` of x^(8 2^k) for each bit k of a number of bytes, shape (63, 32)."""
    factor, found = np.array([1 << 23], np.uint32), []  # x^8
    for _ in range(63):
        found.append(_multiples(factor)[0])
        factor = _product(factor, found[-1])
    return np.array(found)
