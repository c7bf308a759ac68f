# SPDX-License-Identifier: GPL-2.0-only
"""How deep objects start in each other, as contact by features finds it."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import lru_cache

import numpy as np

from ..errors import SetupError
from .c_arrays import pointer
from .plugin import open_lammps


class Overlaps:
    """Depths of pairs of objects in each other, by the plugin's own contact."""

    def __init__(self, outline: Callable[[int], str | None]):
        """``outline`` gives an object, by number, as a file of shapes has it after the molecule ID (docs/fix_mdanim_rigid.md);
        None of objects that have no features."""
        self._outline = lru_cache(maxsize=None)(outline)

    def known(self, i: int, j: int) -> bool:
        """Whether two objects touch each other by features."""
        return self._outline(i) is not None and self._outline(j) is not None

    def depths(self, pairs: np.ndarray, moved: np.ndarray) -> np.ndarray:
        """Depth of the deepest contact of each pair of `known` objects, shape (K, 2), when the second one is moved by these
        vectors [m], shape (K, 3); 0 of pairs that are apart [m], shape (K,). Raises SetupError."""
        found = np.zeros(len(pairs))
        if not len(pairs):
            return found
        text = "".join(f"{m + 1} {self._outline(m)}\n" for m in np.unique(pairs).tolist())
        error = ctypes.create_string_buffer(1024)
        given = np.ascontiguousarray(pairs + 1, np.int32), np.ascontiguousarray(moved, float)
        arguments = (text.encode(), ctypes.c_int(len(found)), *map(pointer, (*given, found)), error, ctypes.c_int(len(error)))
        if _library().mdanim_rigid_overlaps(*arguments):
            raise SetupError(f"the plugin could not find overlaps: {error.value.decode(errors='replace')}")
        return found


@lru_cache(maxsize=1)
def _library() -> ctypes.CDLL:
    """The plugin, which needs the library of LAMMPS, not an instance of it."""
    lmp, library = open_lammps()
    lmp.close()
    return library
