# SPDX-License-Identifier: GPL-2.0-only
"""The automaton on its own, for tests and benchmarks. Arrays of cells are uint8 (nz, ny, nx)."""

from __future__ import annotations

import ctypes

import numpy as np
from plugin_library import library

FULLEST = 250
"""Most units that a cell may hold (plugin/liquid/automaton/cells.h)."""

CELLS = np.ctypeslib.ndpointer(np.uint8, flags="C_CONTIGUOUS")
INT, LONG, SEED = ctypes.c_int, ctypes.c_long, ctypes.c_uint64
HANDLE, TEXT = ctypes.c_void_p, ctypes.c_char_p
FUNCTIONS = {
    "new": (HANDLE, [INT, INT, INT, SEED, INT, TEXT, INT]),
    "free": (None, [HANDLE]),
    "use": (TEXT, [HANDLE, INT]),
    "threads": (None, [HANDLE, INT]),
    "sweep": (None, [HANDLE, SEED, INT]),
    "plain_sweep": (None, [HANDLE, SEED]),
    "at_rest": (INT, [HANDLE]),
    "displace": (LONG, [HANDLE, CELLS, SEED, TEXT, INT]),
    "fill": (LONG, [HANDLE, LONG, HANDLE, SEED, TEXT, INT]),
    "total": (LONG, [HANDLE]),
    "count_solid": (LONG, [HANDLE]),
    "get": (None, [HANDLE, CELLS]),
    "set": (None, [HANDLE, CELLS]),
    "solid": (None, [HANDLE, CELLS]),
}


def function(name: str):
    """A plain C function of the automaton, with its types."""
    found = getattr(library(), f"mdanim_automaton_{name}")
    found.restype, found.argtypes = FUNCTIONS[name]
    return found


class Automaton:
    """One grid of (nz, ny, nx) cells."""

    def __init__(self, shape, seed=1, vertical="lower"):
        self.shape = tuple(shape)
        nz, ny, nx = self.shape
        error = ctypes.create_string_buffer(500)
        self.handle = function("new")(nx, ny, nz, seed, vertical == "any", error, len(error))
        if not self.handle:
            raise MemoryError(error.value.decode())
        self.now = 0

    def __del__(self):
        if self.handle:
            function("free")(self.handle)

    def share(self, threads: int):
        """Let so many threads share whatever they can."""
        function("threads")(self.handle, threads)

    def sweep(self, count=1, plain=False):
        """Sweep; the clock that keys the draws goes on by one each."""
        if plain:
            for n in range(count):
                function("plain_sweep")(self.handle, self.now + n)
        else:
            function("sweep")(self.handle, self.now, count)
        self.now += count

    def displace(self, solid) -> int:
        """Make exactly these cells solid (0 open, 1 solid, 2 solid and still); RuntimeError without room."""
        error = ctypes.create_string_buffer(500)
        solid = np.ascontiguousarray(solid, np.uint8).reshape(self.shape)
        changed = function("displace")(self.handle, solid, self.now, error, len(error))
        if changed < 0:
            raise RuntimeError(error.value.decode())
        return changed

    def fill(self, units, within=None) -> int:
        """Pour units from the lowest layer up; how many found no room."""
        if within is not None:
            within = np.ascontiguousarray(within, np.uint8).reshape(self.shape)
        error = ctypes.create_string_buffer(500)
        where = None if within is None else within.ctypes.data
        left = function("fill")(self.handle, units, where, self.now, error, len(error))
        if left < 0:
            raise MemoryError(error.value.decode())
        return left

    @property
    def content(self) -> np.ndarray:
        """Units of liquid."""
        cells = np.empty(self.shape, np.uint8)
        function("get")(self.handle, cells)
        return cells

    @content.setter
    def content(self, cells):
        function("set")(self.handle, np.ascontiguousarray(cells, np.uint8).reshape(self.shape))

    @property
    def solid(self) -> np.ndarray:
        """0 open, 1 solid, 2 solid and still."""
        cells = np.empty(self.shape, np.uint8)
        function("solid")(self.handle, cells)
        return cells

    @property
    def total(self) -> int:
        """Units in all cells."""
        return function("total")(self.handle)

    @property
    def count_solid(self) -> int:
        """Solid cells, without the rim."""
        return function("count_solid")(self.handle)

    @property
    def at_rest(self) -> bool:
        """Whether a sweep is known to change nothing."""
        return bool(function("at_rest")(self.handle))
