# SPDX-License-Identifier: GPL-2.0-only
"""The state of fixes as records, through the plugin's plain C functions."""

from __future__ import annotations

import ctypes
from typing import NamedTuple

import numpy as np
from mdanim_lammps.engine.plugin import folder


class Records(NamedTuple):
    """The records of one fix."""

    key: np.ndarray
    """Objects (a, b) that each is of, int32, shape (R, 2); (a, 0) of one, (0, 0) of the whole."""
    first: np.ndarray
    """Where the bytes of each begin, int64, shape (R + 1,)."""
    data: np.ndarray
    """All bytes, uint8."""

    def same(self, other: Records) -> bool:
        """Whether all bytes are the same."""
        return all(np.array_equal(a, b) for a, b in zip(self, other))

    def record(self, a: int, b: int = 0) -> np.ndarray:
        """The bytes of one record."""
        (n,) = np.flatnonzero((self.key == (a, b)).all(axis=1))
        return self.data[self.first[n] : self.first[n + 1]]

    def without(self, a: int, b: int = 0) -> Records:
        """All records but one."""
        rest = [n for n, key in enumerate(self.key.tolist()) if key != [a, b]]
        parts = [self.data[self.first[n] : self.first[n + 1]] for n in rest]
        first = np.concatenate([[0], np.cumsum([len(p) for p in parts])]).astype(np.int64)
        return Records(self.key[rest], first, np.concatenate([*parts, self.data[:0]]))


def _library() -> ctypes.CDLL:
    return ctypes.CDLL(f"{folder()}/mdanimplugin.so")


def _handle(lmp) -> ctypes.c_void_p:
    return ctypes.c_void_p(ctypes.cast(lmp.lmp, ctypes.c_void_p).value)


def _pointer(array: np.ndarray) -> ctypes.c_void_p:
    return array.ctypes.data_as(ctypes.c_void_p)


def _call(function, *arguments) -> None:
    error = ctypes.create_string_buffer(1024)
    if function(*arguments, error, ctypes.c_int(len(error))):
        raise RuntimeError(error.value.decode())


def stateful(lmp) -> list[str]:
    """IDs of the fixes that have a state of their own."""
    found, name = [], ctypes.c_char_p()
    while True:
        _call(_library().mdanim_stateful, _handle(lmp), len(found), ctypes.byref(name))
        if name.value is None:
            return found
        found.append(name.value.decode())


def pack(lmp, fix: str) -> Records:
    """The state of a fix; RuntimeError with the plugin's message."""
    records, size = ctypes.c_longlong(), ctypes.c_longlong()
    _call(_library().mdanim_state_pack, _handle(lmp), fix.encode(), ctypes.byref(records), ctypes.byref(size))
    found = Records(np.empty((records.value, 2), np.int32), np.empty(records.value + 1, np.int64), np.empty(size.value, np.uint8))
    _call(_library().mdanim_state_get, _handle(lmp), fix.encode(), *map(_pointer, found))
    return found


def put(lmp, fix: str, records: Records) -> None:
    """Take up a state; RuntimeError with the plugin's message."""
    key, first, data = map(np.ascontiguousarray, records, (np.int32, np.int64, np.uint8))
    size = ctypes.c_longlong(len(key))
    _call(_library().mdanim_state_put, _handle(lmp), fix.encode(), size, *map(_pointer, (key, first, data)))
