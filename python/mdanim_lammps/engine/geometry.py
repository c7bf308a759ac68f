# SPDX-License-Identifier: GPL-2.0-only
"""Where objects are and whether they still are bodies: loops of the plugin over positions, fast enough for every frame."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from functools import cached_property, lru_cache

import numpy as np

from ..model.faces import faces_of_solids
from ..model.system import System, side_by_side
from ..records import dataclass
from .hosts import Hosts
from .plugin import open_library

NOT_FINITE, INVERTED = 1, 2
"""Possible findings of a glance."""


class _Model(ctypes.Structure):
    """A system as the plugin takes it: Model in plugin/c_api/frame_checks_c.cpp."""

    _fields_ = [
        ("count", ctypes.c_longlong),
        *(
            (name, ctypes.c_void_p)
            for name in ("first_particle", "boundary", "first_cell", "corner", "deep", "spacing", "mass", "still")
        ),
        ("pairs", ctypes.c_longlong),
        ("passing", ctypes.c_void_p),
        ("faces", ctypes.c_void_p),
        ("face", ctypes.c_void_p),
    ]


_IsBelow = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_int, ctypes.c_int)


@dataclass(frozen=True)
class Geometry:
    """Questions about the positions of a system's particles; x and v are (N, 3), in tag order [m, m/s].

    ``solids``, from 0 and ascending, int64, shape (m,), are those that a question is about; None is all. Rows of others are not
    read. Of the pairs i < j of solids in ``passing``, ascending, both may be in each other.
    """

    system: System
    passing: Sequence[tuple[int, int]] = ()

    def glance(self, x: np.ndarray, v: np.ndarray, solids: np.ndarray | None = None) -> tuple[int, np.ndarray]:
        """NOT_FINITE where some number is not, INVERTED where some cell is, 0 where all is well; and how far each solid reaches.

        That is along x, y, z, -x, -y and -z, the corners of eq. (3.14) [m], shape (m, 6), and only where numbers are finite.
        """
        count, which = self._which(solids)
        reach = np.empty((count, 6))
        library, model, _ = self._own
        return library.mdanim_glance(model, count, _address(which), _address(x), _address(v), _address(reach)), reach

    def largest_components(self, v: np.ndarray, solids: np.ndarray | None = None) -> np.ndarray:
        """Largest component of the velocities of each solid, without its sign [m/s], shape (m,)."""
        count, which = self._which(solids)
        speed = np.empty(count)
        library, model, _ = self._own
        library.mdanim_largest_components(model, count, _address(which), _address(v), _address(speed))
        return speed

    def not_finite(self, x: np.ndarray, v: np.ndarray) -> int | None:
        """First particle whose position or velocity is not a finite number; None where all are."""
        first = self._own[0].mdanim_not_finite(len(x), _address(x), _address(v))
        return None if first < 0 else int(first)

    def inverted(self, x: np.ndarray, solids: np.ndarray | None = None) -> np.ndarray:
        """Lattice cells that are turned inside out, bool, shape (C,); a mirrored body has all of them so."""
        found = np.zeros(len(self.system.hexahedron), np.uint8)
        library, _, arrays = self._own
        which = self._which(solids)[1]
        for (cells,) in side_by_side(np.diff(self.first_cell)[which], self.first_cell[which]):
            corner, some = arrays["corner"][cells], found[cells]
            library.mdanim_inverted(len(some), _address(corner), _address(x), _address(some))
        return found.view(bool)

    def sunk(self, x: np.ndarray, solids: np.ndarray | None = None) -> tuple[int, int] | None:
        """Two solids of which the first is inside the second, deeper than contact ever lets it; None where there are none.

        Boundary particles of the first are below the outermost layer of cells of the second, but not those that stand out of the
        first one's drawn surface; or the centre of the first is in cells of both, and in the shape of the second (model/faces.py,
        engine/hosts.py). Solids that are held entirely may be in each other. Raises MemoryError, mesh.MeshError.
        """
        library, model, _ = self._own
        count, which = self._which(solids)
        pair = np.zeros(2, np.int32)
        faults: list[BaseException] = []

        def is_below(guest: int, host: int) -> int:
            try:
                return int(self._hosts.holds_centre(x, guest, host))
            except BaseException as fault:  # none passes through C, nor Ctrl-C
                faults.append(fault)
                return 0

        found = library.mdanim_sunk(model, count, _address(which), _address(x), _IsBelow(is_below), _address(pair))
        if faults:
            raise faults[0]
        if found < 0:
            raise MemoryError
        return (int(pair[0]), int(pair[1])) if found else self._hosts.sunk(x, solids)

    @cached_property
    def _hosts(self) -> Hosts:
        return Hosts(self.system, {(int(i), int(j)) for i, j in self.passing}, self.first_cell)

    @cached_property
    def first_cell(self) -> np.ndarray:
        """First lattice cell of each solid, and C at the end, int64, shape (M + 1,)."""
        owner = self.system.hexahedron[:, 0]
        return np.ascontiguousarray(np.searchsorted(self.system.object[owner], np.arange(len(self.system.names) + 1)), np.int64)

    def _which(self, solids: np.ndarray | None) -> tuple[int, np.ndarray]:
        """How many, and their numbers as the plugin takes them."""
        which = np.arange(len(self.system.names), dtype=np.int32) if solids is None else np.ascontiguousarray(solids, np.int32)
        return len(which), which

    @cached_property
    def _own(self) -> tuple[ctypes.CDLL, object, dict[str, np.ndarray]]:
        """The plugin, the system as it takes it, and the arrays of that."""
        system = self.system
        rows, face = faces_of_solids(system, self.first_cell)
        drawn = np.concatenate([np.zeros(0, bool), *(system.frames[kind].drawn for kind in system.contact_kind.tolist())])
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
                ("passing", np.array(self.passing).reshape(-1, 2), np.int32),
                ("faces", rows, np.int64),
                ("face", face, np.float64),
            )
        }
        addresses = {name: _address(array) for name, array in arrays.items()}
        model = _Model(len(system.names), **addresses, pairs=len(self.passing))
        return _library(), ctypes.pointer(model), arrays


@lru_cache(maxsize=1)
def _library() -> ctypes.CDLL:
    """The plugin, with its functions declared."""
    library = open_library()
    number, count, array, model = ctypes.c_longlong, ctypes.c_int, ctypes.c_void_p, ctypes.POINTER(_Model)
    for function, result, arguments in (
        (library.mdanim_glance, ctypes.c_int, [model, count, array, array, array, array]),
        (library.mdanim_largest_components, None, [model, count, array, array, array]),
        (library.mdanim_not_finite, number, [number, array, array]),
        (library.mdanim_inverted, number, [number, array, array, array]),
        (library.mdanim_sunk, number, [model, count, array, array, _IsBelow, array]),
    ):
        function.restype, function.argtypes = result, arguments
    return library


def _address(array: np.ndarray) -> int:
    if not array.flags.c_contiguous:
        raise ValueError("the plugin takes arrays without gaps")
    return array.ctypes.data
