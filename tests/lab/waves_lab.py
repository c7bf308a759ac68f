# SPDX-License-Identifier: GPL-2.0-only
"""Waves on their own, for tests and benchmarks. Cells are (nz, ny, nx), columns (ny, nx).

The cell, g and the density of the liquid are 1, so times are in sqrt(cell/g).
"""

from __future__ import annotations

import ctypes
from typing import NamedTuple

import numpy as np
from plugin_library import library

UNIT = 1 << 20
"""Units of liquid in a cell (plugin/liquid/waves/span.h)."""
SOLID = 4096
"""Solid part of a solid cell."""


def array(kind):
    """Type of an argument."""
    return np.ctypeslib.ndpointer(kind, flags="C_CONTIGUOUS")


INT, DOUBLE, LONG, HANDLE, TEXT = ctypes.c_int, ctypes.c_double, ctypes.c_int64, ctypes.c_void_p, ctypes.c_char_p
INTS, DOUBLES, LONGS = array(np.int32), array(np.float64), array(np.int64)
FUNCTIONS = {
    "new": (HANDLE, [INT, INT, INT, TEXT, INT]),
    "free": (None, [HANDLE]),
    "set": (INT, [HANDLE, TEXT, DOUBLE]),
    "use": (INT, [HANDLE, INT]),
    "threads": (None, [HANDLE, INT]),
    "use_general_form": (None, [HANDLE]),
    "solids": (INT, [HANDLE, array(np.uint16), HANDLE, TEXT, INT]),
    "pour": (None, [HANDLE, DOUBLES, HANDLE]),
    "set_velocities": (None, [HANDLE, DOUBLES]),
    "update": (DOUBLE, [HANDLE, DOUBLE, INT]),
    "at_rest": (INT, [HANDLE]),
    "total": (LONG, [HANDLE]),
    "count_spans": (INT, [HANDLE]),
    "count_links": (INT, [HANDLE]),
    "spans": (None, [HANDLE, INTS, DOUBLES, LONGS]),
    "links": (None, [HANDLE, INTS, DOUBLES, LONGS]),
    "state_size": (LONG, [HANDLE]),
    "state": (None, [HANDLE, array(np.uint8)]),
    "set_state": (INT, [HANDLE, array(np.uint8), LONG, TEXT, INT]),
    "surface": (None, [HANDLE, DOUBLES, DOUBLES]),
    "add_forces": (None, [HANDLE, INTS, DOUBLES]),
    "add_impulse": (None, [HANDLE, DOUBLES, DOUBLES]),
    "walls": (None, [HANDLE, array(np.uint16)]),
    "momenta": (None, [HANDLE, DOUBLES]),
    "energy": (None, [HANDLE, DOUBLES]),
    "counts": (None, [HANDLE, LONGS]),
}


def function(name: str):
    """A plain C function of waves, with its types."""
    found = getattr(library(), f"mdanim_waves_{name}")
    found.restype, found.argtypes = FUNCTIONS[name]
    return found


class Spans(NamedTuple):
    """Arrays over all spans: columns in their order, each from the lowest span up."""

    column: np.ndarray
    low: np.ndarray
    high: np.ndarray
    full: np.ndarray
    floor: np.ndarray
    roof: np.ndarray
    head: np.ndarray
    phi: np.ndarray
    content: np.ndarray


class Links(NamedTuple):
    """Arrays over all links: numbers of spans, direction (0 along x, 1 along y), velocity, wetted height, units that passed."""

    a: np.ndarray
    b: np.ndarray
    direction: np.ndarray
    u: np.ndarray
    height: np.ndarray
    units: np.ndarray


class Counts(NamedTuple):
    """Work done so far; `displaced` are units of spans that closed."""

    updates: int
    sub_updates: int
    solutions: int
    iterations: int
    limited: int
    displaced: int


class Waves:
    """Liquid in a basin of (nz, ny, nx) cells."""

    def __init__(self, shape, **settings):
        self.shape = tuple(shape)
        error = ctypes.create_string_buffer(500)
        nz, ny, nx = self.shape
        self.handle = function("new")(nx, ny, nz, error, len(error))
        if not self.handle:
            raise MemoryError(error.value.decode())
        self.set(**settings)

    def __del__(self):
        if self.handle:
            function("free")(self.handle)

    def set(self, **settings):
        """Numbers of the law and of the solver, by their names in waves_c.cpp; KeyError for another name."""
        for name, value in settings.items():
            if not function("set")(self.handle, name.encode(), float(value)):
                raise KeyError(name)

    def use(self, instruction_set: int) -> bool:
        """Choose kernels by number; False where this processor lacks them."""
        return bool(function("use")(self.handle, instruction_set))

    def threads(self, number: int):
        """Let so many threads take updates, each one row or more."""
        function("threads")(self.handle, number)

    def use_general_form(self):
        """Leave nothing to the kernels alone."""
        function("use_general_form")(self.handle)

    def solids(self, part, mass=None):
        """Solid parts of all cells in 1/4096, and of each column the mass of what floats; RuntimeError without room."""
        error = ctypes.create_string_buffer(500)
        part = np.ascontiguousarray(np.moveaxis(np.reshape(part, self.shape), 0, -1), np.uint16)
        mass = None if mass is None else np.ascontiguousarray(mass, np.float64).reshape(self.shape[1:])
        if function("solids")(self.handle, part, None if mass is None else mass.ctypes.data, error, len(error)):
            raise RuntimeError(error.value.decode())

    def pour(self, height, above=None):
        """Fill all spans of each column up to a height, where it is above another one."""
        height, above = (
            None if h is None else np.ascontiguousarray(np.broadcast_to(h, self.shape[1:]), np.float64) for h in (height, above)
        )
        function("pour")(self.handle, height, None if above is None else above.ctypes.data)

    def update(self, count=1, dt=0.1) -> float:
        """Update; the processor's time in seconds."""
        return function("update")(self.handle, dt, count)

    def set_velocities(self, u):
        """Velocities of links in their order."""
        function("set_velocities")(self.handle, np.ascontiguousarray(u, np.float64))

    @property
    def spans(self) -> Spans:
        """As they are now."""
        count = function("count_spans")(self.handle)
        numbers, heights, content = np.empty((count, 4), np.int32), np.empty((count, 4)), np.empty(count, np.int64)
        function("spans")(self.handle, numbers, heights, content)
        return Spans(*numbers.T, *heights.T, content)

    @property
    def links(self) -> Links:
        """As they are now."""
        count = function("count_links")(self.handle)
        numbers, values, units = np.empty((count, 3), np.int32), np.empty((count, 2)), np.empty(count, np.int64)
        function("links")(self.handle, numbers, values, units)
        return Links(*numbers.T, *values.T, units)

    @property
    def state(self) -> np.ndarray:
        """Everything that later updates depend on, as bytes."""
        found = np.empty(function("state_size")(self.handle), np.uint8)
        function("state")(self.handle, found)
        return found

    @state.setter
    def state(self, state):
        """RuntimeError when it is not of such a basin, or damaged; then nothing changes."""
        error = ctypes.create_string_buffer(500)
        state = np.ascontiguousarray(state, np.uint8)
        if function("set_state")(self.handle, state, len(state), error, len(error)):
            raise RuntimeError(error.value.decode())

    @property
    def surface(self) -> np.ndarray:
        """Head of the topmost wet span of each column."""
        return self._columns()[0]

    @property
    def volume(self) -> np.ndarray:
        """Liquid in each column, in cells."""
        return self._columns()[1]

    def _columns(self):
        head, volume = np.empty(self.shape[1:]), np.empty(self.shape[1:])
        function("surface")(self.handle, head, volume)
        return head, volume

    def forces(self, owner, bodies: int) -> np.ndarray:
        """Force on each body, (bodies, 3); `owner` tells whose each cell is, or is negative."""
        force = np.zeros((bodies, 3))
        function("add_forces")(self.handle, np.ascontiguousarray(owner, np.int32).reshape(self.shape), force)
        return force

    def walls(self, held):
        """Tell the held part of all cells, in 1/4096."""
        function("walls")(self.handle, np.ascontiguousarray(np.moveaxis(np.reshape(held, self.shape), 0, -1), np.uint16))

    def add_impulse(self, x, y):
        """Momentum along x and y for each column, in cells of liquid."""
        columns = (np.ascontiguousarray(np.broadcast_to(a, self.shape[1:]), np.float64) for a in (x, y))
        function("add_impulse")(self.handle, *columns)

    def take_momenta(self) -> np.ndarray:
        """Momentum now; what was lost, and what came, since this was asked last; each along x and y, shape (3, 2)."""
        found = np.empty((3, 2))
        function("momenta")(self.handle, found)
        return found

    @property
    def energy(self) -> np.ndarray:
        """Energy of height, and of motion along the links."""
        found = np.empty(2)
        function("energy")(self.handle, found)
        return found

    @property
    def fastest(self) -> float:
        """The largest velocity."""
        return float(np.abs(self.links.u).max(initial=0.0))

    @property
    def total(self) -> int:
        """Units in all spans."""
        return function("total")(self.handle)

    @property
    def at_rest(self) -> bool:
        """Whether nothing will move before a solid does."""
        return bool(function("at_rest")(self.handle))

    @property
    def counts(self) -> Counts:
        """Work done so far."""
        found = np.empty(6, np.int64)
        function("counts")(self.handle, found)
        return Counts(*map(int, found))
