# SPDX-License-Identifier: GPL-2.0-only
"""Where objects are and whether they still are bodies: loops of the plugin over positions, fast enough for every frame."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from ..model.system import System
from .plugin import open_library

NOT_FINITE, INVERTED = 1, 2
"""What a glance may find."""


class _Model(ctypes.Structure):
    """A system as the plugin takes it: Model in plugin/c_api/guard_c.cpp."""

    _fields_ = [
        ("count", ctypes.c_longlong),
        *(
            (name, ctypes.c_void_p)
            for name in ("first_particle", "boundary", "first_cell", "corner", "deep", "spacing", "mass", "still")
        ),
    ]


@dataclass(frozen=True)
class Geometry:
    """Questions about the positions of a system's particles; x and v are (N, 3), in tag order [m, m/s]."""

    system: System

    def glance(self, x: np.ndarray, v: np.ndarray) -> tuple[int, np.ndarray]:
        """NOT_FINITE where some number is not, INVERTED where some cell is, 0 where all is well; and how far each solid reaches.

        That is along x, y, z, -x, -y and -z, the corners of eq. (3.14) [m], shape (M, 6); valid until the next glance, and only
        where numbers are finite. A run asks it at every frame, so it is one call, with nothing made anew.
        """
        library, model, _, reach, address = self._own
        return library.mdanim_glance(model, _address(x), _address(v), address), reach

    def not_finite(self, x: np.ndarray, v: np.ndarray) -> int | None:
        """First particle whose position or velocity is no finite number; None where all are."""
        first = self._own[0].mdanim_not_finite(len(x), _address(x), _address(v))
        return None if first < 0 else int(first)

    def inverted(self, x: np.ndarray) -> np.ndarray:
        """Lattice cells that are turned inside out, bool, shape (C,); a mirrored body has all of them so."""
        found = np.zeros(len(self.system.hexahedron), np.uint8)
        library, _, arrays, *_ = self._own
        library.mdanim_inverted(len(found), _address(arrays["corner"]), _address(x), _address(found))
        return found.view(bool)

    def sunk(self, x: np.ndarray) -> tuple[int, int] | None:
        """Two solids of which the first is inside the second, deeper than contact ever lets it; None where there are none.

        Boundary particles of the first are below the outermost layer of cells of the second, but not those that stand out of the
        first one's drawn surface; or the centre of the first is in the body of both. Solids that are held entirely may be in each
        other. Raises MemoryError.
        """
        library, model, *_ = self._own
        pair = np.zeros(2, np.int32)
        found = library.mdanim_sunk(model, _address(x), _address(pair))
        if found < 0:
            raise MemoryError
        return (int(pair[0]), int(pair[1])) if found else None

    @cached_property
    def first_cell(self) -> np.ndarray:
        """First lattice cell of each solid, and C at the end, int64, shape (M + 1,)."""
        owner = self.system.hexahedron[:, 0]
        return np.ascontiguousarray(np.searchsorted(self.system.object[owner], np.arange(len(self.system.names) + 1)), np.int64)

    @cached_property
    def _own(self) -> tuple[ctypes.CDLL, object, dict[str, np.ndarray], np.ndarray, int]:
        """The plugin, the system as it takes it, the arrays of that, and room for reaches with its address."""
        system = self.system
        drawn = np.concatenate([system.frames[kind].drawn for kind in system.contact_kind.tolist()])
        arrays = {
            name: np.ascontiguousarray(array, kind)
            for name, array, kind in (
                ("first_particle", system.first, np.int64),
                ("boundary", system.boundary & drawn, np.uint8),
                ("first_cell", self.first_cell, np.int64),
                ("corner", system.hexahedron, np.int32),
                ("deep", ~system.boundary[system.hexahedron].any(1), np.uint8),
                ("spacing", np.cbrt(system.cell_volume), np.float64),
                ("mass", system.mass, np.float64),
                ("still", system.still, np.uint8),
            )
        }
        model = _Model(len(system.names), **{name: _address(array) for name, array in arrays.items()})
        reach = np.empty((len(system.names), 6))
        return _library(), ctypes.pointer(model), arrays, reach, _address(reach)


@lru_cache(maxsize=1)
def _library() -> ctypes.CDLL:
    """The plugin, with its functions declared."""
    library = open_library()
    number, array, model = ctypes.c_longlong, ctypes.c_void_p, ctypes.POINTER(_Model)
    for function, result, arguments in (
        (library.mdanim_glance, ctypes.c_int, [model, array, array, array]),
        (library.mdanim_not_finite, number, [number, array, array]),
        (library.mdanim_inverted, number, [number, array, array, array]),
        (library.mdanim_sunk, number, [model, array, array]),
    ):
        function.restype, function.argtypes = result, arguments
    return library


def _address(array: np.ndarray) -> int:
    if not array.flags.c_contiguous:
        raise ValueError("the plugin takes arrays without gaps")
    return array.ctypes.data
