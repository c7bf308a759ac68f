# SPDX-License-Identifier: GPL-2.0-only
"""The checksum of a whole from those of its pieces is zlib's."""

import zlib
from itertools import pairwise

import numpy as np
import pytest
from mdanim_lammps.results.checksums import joined, shifts


def piecewise(data: bytes, edges: list[int]) -> np.ndarray:
    """Share of each piece between these edges in the checksum of all, uint32."""
    pieces = list(pairwise(edges))
    alone = np.array([zlib.crc32(data[a:b]) for a, b in pieces], np.uint32)
    factors = shifts(np.array([len(data) - b for _, b in pieces], np.int64))
    return np.array([joined(alone[k : k + 1], factors[k : k + 1]) for k in range(len(pieces))], np.uint32)


@pytest.mark.parametrize("size", [1, 2, 24, 25, 4096, 100_003])
def test_pieces_make_the_checksum_of_the_whole(size):
    """However the whole is cut, and in whatever order and company the pieces are taken."""
    rng = np.random.default_rng(size)
    data = rng.bytes(size)
    for count in (0, 1, 7, 40):
        edges = [0, *np.sort(rng.integers(0, size + 1, count)).tolist(), size]
        parts = piecewise(data, edges)
        assert np.bitwise_xor.reduce(parts) == zlib.crc32(data)
        some = rng.random(len(parts)) < 0.5
        assert np.bitwise_xor.reduce(parts[some]) ^ np.bitwise_xor.reduce(parts[~some]) == zlib.crc32(data)


def test_several_quantities_of_the_same_pieces():
    """One row of checksums each."""
    data = [b"abcdefgh" * 9, bytes(range(72))]
    factors = shifts(np.array([48, 0], np.int64))
    alone = np.array([[zlib.crc32(d[:24]), zlib.crc32(d[24:])] for d in data], np.uint32)
    assert joined(alone, factors).tolist() == [zlib.crc32(d) for d in data]


def test_a_piece_far_from_the_end():
    """Megabytes of zeros behind a piece as zlib sees them; terabytes as two halves of them."""
    after, zeros = 5 << 22, bytes(1 << 20)
    whole = zlib.crc32(b"piece")
    rest = 0
    for _ in range(after >> 20):
        whole, rest = zlib.crc32(zeros, whole), zlib.crc32(zeros, rest)
    alone = np.array([zlib.crc32(b"piece")], np.uint32)
    assert joined(alone, shifts(np.array([after]))) ^ rest == whole
    twice = shifts(np.array([1 << 44, 1 << 43]))  # x^(8 2^44) is x^(8 2^43) twice
    assert (joined(joined(alone, twice[1:])[None], twice[1:]) == joined(alone, twice[:1])).all()


def test_nothing_has_no_part_in_it():
    """An executor without rows."""
    assert joined(np.zeros((2, 0), np.uint32), shifts(np.zeros(0, np.int64))).tolist() == [0, 0]
