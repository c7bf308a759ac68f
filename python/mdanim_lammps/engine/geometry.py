# SPDX-License-Identifier: GPL-2.0-only
"""Where objects are and whether they still are bodies: loops of the plugin over positions, fast enough for every frame."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..model.system import System
from .plugin import open_library


@dataclass(frozen=True)
class Geometry:
    """Questions about the positions of a system's particles; x and v are (N, 3), in tag order [m, m/s]."""

    system: System

    def not_finite(self, x: np.ndarray, v: np.ndarray) -> int | None:
        """First particle whose position or velocity is no finite number; None where all are."""
        first = self._library.mdanim_not_finite(ctypes.c_longlong(len(x)), _pointer(x), _pointer(v))
        return None if first < 0 else int(first)

    def boxes(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest corner of the box of each solid, eq. (3.14) [m], each of shape (M, 3)."""
        low, high = np.empty((2, len(self.system.names), 3))
        self._library.mdanim_boxes(ctypes.c_int(len(low)), _pointer(self._first), _pointer(x), _pointer(low), _pointer(high))
        return low, high

    def inverted(self, x: np.ndarray) -> np.ndarray:
        """Lattice cells that are turned inside out, bool, shape (C,); a mirrored body has all of them so."""
        found = np.zeros(len(self.system.hexahedron), np.uint8)
        self._library.mdanim_inverted(ctypes.c_longlong(len(found)), _pointer(self._corner), _pointer(x), _pointer(found))
        return found.view(bool)

    def sunk(self, x: np.ndarray) -> tuple[int, int] | None:
        """Two solids of which the first is inside the second, deeper than contact ever lets it; None where there are none.

        Boundary particles of the first are below the outermost layer of cells of the second, or the centre of the first is in the body
        of both. Solids that are held entirely may be in each other. Raises MemoryError.
        """
        pair = np.zeros(2, np.int32)
        found = self._library.mdanim_sunk(
            ctypes.c_int(len(self.system.names)), _pointer(self._first), _pointer(self._boundary), _pointer(self.first_cell),
            _pointer(self._corner), _pointer(self._deep), _pointer(self._spacing), _pointer(self._mass), _pointer(self._still),
            _pointer(x), _pointer(pair))
        if found < 0:
            raise MemoryError
        return (int(pair[0]), int(pair[1])) if found else None

    @cached_property
    def first_cell(self) -> np.ndarray:
        """First lattice cell of each solid, and C at the end, int64, shape (M + 1,)."""
        owner = self.system.hexahedron[:, 0]
        return np.ascontiguousarray(np.searchsorted(self.system.object[owner], np.arange(len(self.system.names) + 1)), np.int64)

    # --- arrays as the plugin takes them ----------------------------------------------------------------------------

    @cached_property
    def _library(self) -> ctypes.CDLL:
        library = open_library()
        for function in (library.mdanim_not_finite, library.mdanim_inverted, library.mdanim_sunk):
            function.restype = ctypes.c_longlong
        library.mdanim_boxes.restype = None
        return library

    @cached_property
    def _first(self) -> np.ndarray:
        return np.ascontiguousarray(self.system.first, np.int64)

    @cached_property
    def _corner(self) -> np.ndarray:
        return np.ascontiguousarray(self.system.hexahedron, np.int32)

    @cached_property
    def _boundary(self) -> np.ndarray:
        return self.system.boundary.astype(np.uint8)

    @cached_property
    def _deep(self) -> np.ndarray:
        return (~self.system.boundary[self.system.hexahedron].any(1)).astype(np.uint8)

    @cached_property
    def _spacing(self) -> np.ndarray:
        return np.cbrt(self.system.cell_volume)

    @cached_property
    def _mass(self) -> np.ndarray:
        return np.ascontiguousarray(self.system.mass, np.float64)

    @cached_property
    def _still(self) -> np.ndarray:
        return np.logical_and.reduceat(self.system.held, self.system.first[:-1]).astype(np.uint8)


def _pointer(array: np.ndarray) -> ctypes.c_void_p:
    if not array.flags.c_contiguous:
        raise ValueError("the plugin takes arrays without gaps")
    return array.ctypes.data_as(ctypes.c_void_p)
