# SPDX-License-Identifier: GPL-2.0-only
"""The level rule and the surface filter, from Python."""

from __future__ import annotations

import ctypes
from functools import cache

import numpy as np
from plugin_library import library

BYTES = np.ctypeslib.ndpointer(np.uint8, flags="C_CONTIGUOUS")
DOUBLES = np.ctypeslib.ndpointer(np.float64, flags="C_CONTIGUOUS")


@cache
def functions() -> ctypes.CDLL:
    """The test library with the functions declared."""
    found = library()
    handle, i, word = ctypes.c_void_p, ctypes.c_int, ctypes.c_uint64
    for name, result, *arguments in (
        ("level_new", handle, i, i, i),
        ("level_delete", None, handle),
        ("level_set", None, handle, BYTES, BYTES),
        ("level_get", None, handle, BYTES),
        ("level_move", ctypes.c_long, handle, word, word, ctypes.c_double, ctypes.c_long),
        ("level_heights", i, handle, DOUBLES, i),
        ("smooth_surface", None, i, i, DOUBLES, BYTES, DOUBLES),
    ):
        function = getattr(found, f"mdanim_{name}")
        function.restype, function.argtypes = result, arguments
    return found


class Pool:
    """Cells with a leveller; ``solid`` (nz, ny, nx): 0 open, 1 solid, 2 solid and still."""

    def __init__(self, content, solid):
        self.shape = np.shape(content)
        self.handle = functions().mdanim_level_new(*self.shape[::-1])
        self.set(content, solid)

    def __del__(self):
        functions().mdanim_level_delete(self.handle)

    def set(self, content, solid) -> None:
        """Write all cells."""
        content, solid = (np.ascontiguousarray(a, np.uint8) for a in (content, solid))
        functions().mdanim_level_set(self.handle, content, solid)

    @property
    def content(self) -> np.ndarray:
        """Units per cell (nz, ny, nx)."""
        cells = np.empty(self.shape, np.uint8)
        functions().mdanim_level_get(self.handle, cells)
        return cells

    def move(self, seed=1, when=0, rate=0.25, at_least=0) -> int:
        """One call of the rule; units moved."""
        return functions().mdanim_level_move(self.handle, seed, when, rate, at_least)

    def heights(self, just_moved=False) -> tuple[np.ndarray, bool]:
        """Heights (ny, nx) in cells, and whether all is level."""
        height = np.empty(self.shape[1:])
        return height, bool(functions().mdanim_level_heights(self.handle, height, just_moved))


def smooth(height, blocked=None) -> np.ndarray:
    """The smooth surface of heights (ny, nx)."""
    height = np.ascontiguousarray(height, float)
    blocked = np.zeros(height.shape, np.uint8) if blocked is None else np.ascontiguousarray(blocked, np.uint8)
    result = np.empty_like(height)
    functions().mdanim_smooth_surface(*height.shape[::-1], height, blocked, result)
    return result
