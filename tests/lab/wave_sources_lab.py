# SPDX-License-Identifier: GPL-2.0-only
"""Drops and makers of waves on their own, for tests: they go with a `Waves` of waves_lab. Cell, g and density are 1."""

from __future__ import annotations

import ctypes

import numpy as np
from plugin_library import library
from waves_lab import DOUBLE, HANDLE, INT, INTS, LONG, LONGS, TEXT, Waves, array

BYTES = array(np.uint8)
FUNCTIONS = {
    "drops_new": (HANDLE, [INT, INT, DOUBLE, LONG]),
    "drops_free": (None, [HANDLE]),
    "drops_update": (None, [HANDLE, HANDLE, DOUBLE, LONG]),
    "drops_count": (LONG, [HANDLE]),
    "drops_state": (None, [HANDLE, BYTES]),
    "drops_set_state": (INT, [HANDLE, BYTES, LONG, TEXT, INT]),
    "makers_new": (HANDLE, [INT, INT]),
    "makers_free": (None, [HANDLE]),
    "makers_flow": (None, [HANDLE, INTS, DOUBLE, DOUBLE, DOUBLE, DOUBLE]),
    "makers_paddle": (None, [HANDLE, INT, DOUBLE, DOUBLE, DOUBLE]),
    "makers_current": (None, [HANDLE, INT, DOUBLE]),
    "makers_apply": (None, [HANDLE, HANDLE, DOUBLE]),
    "makers_account": (None, [HANDLE, LONGS]),
    "makers_state_size": (LONG, [HANDLE]),
    "makers_state": (None, [HANDLE, BYTES]),
    "makers_set_state": (INT, [HANDLE, BYTES, LONG, TEXT, INT]),
}
DROP = np.dtype([("x", float, 3), ("v", float, 3), ("units", np.int64)])
WEST, EAST, SOUTH, NORTH = range(4)


def function(name: str):
    """A plain C function of drops or makers, with its types."""
    found = getattr(library(), f"mdanim_{name}")
    found.restype, found.argtypes = FUNCTIONS[name]
    return found


def _set_state(kind: str, handle, state) -> None:
    error = ctypes.create_string_buffer(500)
    state = np.ascontiguousarray(state, np.uint8)
    if function(f"{kind}_set_state")(handle, state, len(state), error, len(error)):
        raise RuntimeError(error.value.decode())


class Drops:
    """Spray over some waves."""

    def __init__(self, w: Waves, share=1.0, most=4096):
        self.w, self.when = w, 0
        self.handle = function("drops_new")(w.shape[2], w.shape[1], share, most)

    def __del__(self):
        function("drops_free")(self.handle)

    def update(self, dt=0.1):
        """Act after an update of the waves."""
        self.when += 1
        function("drops_update")(self.handle, self.w.handle, dt, self.when)

    @property
    def all(self) -> np.ndarray:
        """Drops in their order, of type DROP."""
        return self.state.view(DROP)

    @property
    def total(self) -> int:
        """Units that fly."""
        return int(self.all["units"].sum())

    @property
    def state(self) -> np.ndarray:
        """Everything that later updates depend on, as bytes; setting it raises RuntimeError where it is damaged."""
        found = np.empty(function("drops_count")(self.handle) * DROP.itemsize, np.uint8)
        function("drops_state")(self.handle, found)
        return found

    @state.setter
    def state(self, state):
        _set_state("drops", self.handle, state)


class Makers:
    """Inflows, drains, paddles and currents of some waves."""

    def __init__(self, w: Waves):
        self.w = w
        self.handle = function("makers_new")(w.shape[2], w.shape[1])

    def __del__(self):
        function("makers_free")(self.handle)

    def flow(self, columns, rate, height=1e9, u=(0.0, 0.0)):
        """In at `rate` cells per time, or out where it is negative; columns (from x, to x, from y, to y)."""
        function("makers_flow")(self.handle, np.array(columns, np.int32), height, rate, *u)

    def paddle(self, side, amplitude, period, depth):
        """Waves from a side."""
        function("makers_paddle")(self.handle, side, amplitude, period, depth)

    def current(self, side, speed):
        """In at this side, out at the opposite one."""
        function("makers_current")(self.handle, side, speed)

    def update(self, count=1, dt=0.1):
        """Update the makers, then the waves."""
        for _ in range(count):
            function("makers_apply")(self.handle, self.w.handle, dt)
            self.w.update(dt=dt)

    @property
    def account(self) -> tuple[int, int]:
        """Units that came in and that went out."""
        found = np.empty(2, np.int64)
        function("makers_account")(self.handle, found)
        return int(found[0]), int(found[1])

    @property
    def state(self) -> np.ndarray:
        """As that of drops."""
        found = np.empty(function("makers_state_size")(self.handle), np.uint8)
        function("makers_state")(self.handle, found)
        return found

    @state.setter
    def state(self, state):
        _set_state("makers", self.handle, state)
