# SPDX-License-Identifier: GPL-2.0-only
"""Output of fixes: entries of vectors by the names on the pages of those of the plugin (plugin/lammps/fix_base.h), and arrays."""

from __future__ import annotations

import ctypes

import numpy as np

from ..errors import SetupError


def output_names(library: ctypes.CDLL, handle: ctypes.c_void_p, fix: str) -> list[str]:
    """Names of the entries of a fix's vector, in their order; none of a fix that is not of the plugin."""
    told = library.mdanim_output_name
    told.restype, told.argtypes = ctypes.c_char_p, [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int]
    names: list[str] = []
    while name := told(handle, fix.encode(), len(names)):
        names.append(name.decode())
    return names


def output_place(library: ctypes.CDLL, handle: ctypes.c_void_p, fix: str, name: str) -> int:
    """Place of an entry in the vector of a fix, from 0. Raises SetupError for a name that is not there."""
    place = library.mdanim_output_place
    place.restype, place.argtypes = ctypes.c_int, [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_char_p]
    found = place(handle, fix.encode(), name.encode())
    if found < 0:
        raise SetupError(f"fix {fix} has no output {name}; it has {', '.join(output_names(library, handle, fix)) or 'nothing'}")
    return found


def output_rows(library: ctypes.CDLL, handle: ctypes.c_void_p, fix: str, rows: int, columns: int) -> np.ndarray:
    """The first rows of the array of a fix, shape (rows, columns). Raises SetupError where it has no such array."""
    told, found = library.mdanim_output_rows, np.empty((rows, columns))
    told.restype, told.argtypes = ctypes.c_int, [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_int, ctypes.c_void_p]
    if told(handle, fix.encode(), rows, columns, found.ctypes.data) < rows:
        raise SetupError(f"fix {fix} has no array of {rows} rows and {columns} columns")
    return found
