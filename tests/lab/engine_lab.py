# SPDX-License-Identifier: GPL-2.0-only
"""Classes of plugin/engine that need no LAMMPS, from Python."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from functools import cache

import numpy as np
from plugin_library import library

INTS = np.ctypeslib.ndpointer(np.int32, flags="C_CONTIGUOUS")
DOUBLES = np.ctypeslib.ndpointer(np.float64, flags="C_CONTIGUOUS")
LEAST = ctypes.CFUNCTYPE(None, ctypes.POINTER(ctypes.c_double), ctypes.c_int)


@cache
def functions() -> ctypes.CDLL:
    """The test library with the functions declared."""
    found = library()
    handle, i, d = ctypes.c_void_p, ctypes.c_int, ctypes.c_double
    for name, result, *arguments in (
        ("cut_new", handle, i, i, i, INTS, INTS, DOUBLES, INTS),
        ("cut_delete", None, handle),
        ("cut_blocks", i, handle),
        ("cut_entries", i, handle),
        ("cut_tell", None, handle, INTS, INTS, DOUBLES),
        ("cut_ranges", i, handle, i, INTS, INTS),
        ("ranges_tell", None, handle, INTS, INTS, INTS, INTS, DOUBLES, INTS),
        ("strips_tell", None, handle, INTS),
        ("team_count", None, i, i, i, i, INTS),
        ("team_throws", i, i, i, i),
        ("team_wakes", None, i, i, i, i, INTS),
        ("order", i, i, i, INTS, INTS, INTS, INTS, INTS, INTS, ctypes.POINTER(i)),
        ("loss", d, i, i, DOUBLES, DOUBLES, d, i, i),
        ("budget_new", handle, LEAST, handle),
        ("budget_delete", None, handle),
        ("budget_measure", None, handle, d, d, d, i, DOUBLES, DOUBLES),
        ("budget_spend", i, handle, d),
        ("budget_begin", None, handle, ctypes.c_long),
        ("budget_state", i, handle),
    ):
        function = getattr(found, f"mdanim_{name}")
        function.restype, function.argtypes = result, arguments
    return found


def ints(values) -> np.ndarray:
    """As the functions take them."""
    return np.ascontiguousarray(values, np.int32)


def doubles(values) -> np.ndarray:
    """As the functions take them."""
    return np.ascontiguousarray(values, np.float64)


@dataclass(frozen=True)
class Entry:
    """Springs from the particles of a block to those ``offset`` further on."""

    offset: int
    coeffs: np.ndarray
    """push, pull and c of every lane, shape (3, lanes); 0 where there is no spring."""


@dataclass(frozen=True)
class Block:
    """Particles side by side."""

    start: int
    lanes: int
    damped: bool
    entries: tuple[Entry, ...]
    at_border: bool = False
    crossing: Block | None = None
    """Its springs over the border above it, which are not among the entries."""
    strip: int = 1
    """How many blocks the strip has that begins with it, 0 within a strip."""


def cut(lanes: int, particles: int, springs, krc, objects=None) -> list[Block]:
    """Blocks of so many lanes for springs (S, 2), the lower particle first, of K, r0, c (S, 3)."""
    return cut_into_ranges(lanes, particles, springs, krc, objects, 1)[0]


def cut_into_ranges(lanes: int, particles: int, springs, krc, objects, wanted: int) -> tuple[list[Block], list[int]]:
    """The blocks of `cut`, and the first particle of each of up to so many ranges of them."""
    springs, krc = np.reshape(springs, (-1, 2)), np.reshape(krc, (-1, 3))
    order = np.lexsort((-springs[:, 1], springs[:, 0]))
    low, high = ints(springs[order, 0]), ints(springs[order, 1])
    objects = ints(np.ones(particles) if objects is None else objects)
    made = functions().mdanim_cut_new(lanes, particles, len(springs), low, high, doubles(krc[order]), objects)
    try:
        crossings, crossing_entries = ints([0]), ints([0])
        ranges = functions().mdanim_cut_ranges(made, wanted, crossings, crossing_entries)
        blocks, entries = functions().mdanim_cut_blocks(made), functions().mdanim_cut_entries(made)
        block, offset, coeffs = np.zeros((blocks, 4), np.int32), np.zeros(entries, np.int32), np.zeros((entries, 3, lanes))
        functions().mdanim_cut_tell(made, block, offset, coeffs)
        first, of_border, border = np.zeros(ranges, np.int32), np.zeros(ranges, np.int32), np.zeros((blocks, 2), np.int32)
        crossing, far = np.zeros((crossings[0], 3), np.int32), np.zeros(crossing_entries[0], np.int32)
        far_coeffs = np.zeros((crossing_entries[0], 3, lanes))
        functions().mdanim_ranges_tell(made, first, of_border, crossing, far, far_coeffs, border)
        strips = np.zeros(blocks, np.int32)
        functions().mdanim_strips_tell(made, strips)
    finally:
        functions().mdanim_cut_delete(made)
    far_ends, ends = [0, *crossing[:, 1].tolist()], [0, *block[:, 2].tolist()]
    over = [
        Block(int(start), lanes, bool(damped), tuple(Entry(int(far[e]), far_coeffs[e]) for e in range(begin, end)))
        for (start, end, damped), begin in zip(crossing, far_ends)
    ]
    assert [b.start for b in over] == [s for s, (_, c) in zip(block[:, 0].tolist(), border.tolist()) if c >= 0]
    made_blocks = [
        Block(
            int(start), int(own), bool(damped), tuple(Entry(int(offset[e]), coeffs[e]) for e in range(begin, end)),
            bool(at_border), over[c] if c >= 0 else None, int(strip),
        )
        for (start, own, end, damped), begin, (at_border, c), strip in zip(block, ends, border, strips)
    ]  # fmt: skip
    # Crossings of a border are those of the blocks of the range below it.
    for n, (low, high) in enumerate(zip([0, *of_border[:-2]], of_border[:-1])):
        assert all(first[n] <= over[k].start < first[n + 1] for k in range(low, high))
    return made_blocks, first.tolist()


def order(own: int, tags, objects, bonds: dict[int, list[int]]) -> tuple[list[int], list[tuple[int, int]]]:
    """Order of own particles, then ghosts, and the bonds of own ones by tag: indices in the line, springs as places in it.

    Raise LookupError with the tag of a partner that is not among the particles.
    """
    partners = [bonds.get(int(t), []) for t in tags[:own]]
    first = ints(np.cumsum([0, *map(len, partners)]))
    count = int(first[-1])
    place, pair, springs = np.zeros(len(tags) + 1, np.int32), np.zeros(2 * count + 1, np.int32), ctypes.c_int()
    flat = ints([*(p for many in partners for p in many), 0])
    size = functions().mdanim_order(own, len(tags), ints(tags), ints(objects), first, flat, place, pair, ctypes.byref(springs))
    if size < 0:
        raise LookupError(springs.value)
    return place[:size].tolist(), [tuple(p) for p in pair[: 2 * springs.value].reshape(-1, 2).tolist()]


def loss(force, seen, dt: float, passes: tuple[int, int] = (-1, -1)) -> float:
    """Energy that forces (steps, N, 3), which see velocities (steps + 1, N, 3), take.

    Passes take the steps from passes[0] to passes[1] - 1.
    """
    force, seen = doubles(force), doubles(seen)
    return functions().mdanim_loss(len(force), force.shape[1], force, seen, dt, *passes)


class Budget:
    """A DisplacementBudget, of a rank that is alone or of one of several with its ``shares`` (3, 6); ``least`` is called with the
    numbers of this rank, as an array to be changed in place, whenever all ranks look for the least ones."""

    def __init__(self, least=None, shares=None):
        self._least = LEAST(0) if least is None else LEAST(lambda n, count: least(np.ctypeslib.as_array(n, (count,))))
        self._shares = doubles(np.zeros((3, 6)) if shares is None else shares)
        self._handle = functions().mdanim_budget_new(self._least, self._shares.ctypes.data)

    def measure(self, now, then, half_skin: float, absolute: float = 0.0, relative: float = 0.0) -> None:
        """Set limits, and what is left after particles went from ``then`` to ``now``, both (N, 3)."""
        now, then = doubles(now), doubles(then)
        functions().mdanim_budget_measure(self._handle, half_skin, absolute, relative, len(now), now, then)

    def spend(self, way: float) -> bool:
        """Whether some is left after going so far."""
        return bool(functions().mdanim_budget_spend(self._handle, way))

    def begin(self, build: int) -> None:
        """Take what is left for the whole of lists of this number."""
        functions().mdanim_budget_begin(self._handle, build)

    @property
    def nearly_spent(self) -> bool:
        """Whether less than a fifth of the whole is left."""
        return bool(functions().mdanim_budget_state(self._handle) & 1)

    @property
    def overflowed(self) -> bool:
        """Whether some rank has spent infinity."""
        return bool(functions().mdanim_budget_state(self._handle) & 2)

    def left(self) -> float:
        """Remaining time, found by spending it, to 1e-9."""
        low, high = -1e6, 1e6  # how much it would have to get
        spent = 0.0
        for _ in range(60):
            middle = 0.5 * (low + high)
            more = self.spend(middle - spent)
            spent = middle
            low, high = (middle, high) if more else (low, middle)
        self.spend(-spent)
        return low

    def __del__(self):
        functions().mdanim_budget_delete(self._handle)
