# SPDX-License-Identifier: GPL-2.0-only
"""Output of fixes of the plugin in their vectors, by the names on their pages (plugin/lammps/fix_base.h)."""

from __future__ import annotations

import ctypes

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
