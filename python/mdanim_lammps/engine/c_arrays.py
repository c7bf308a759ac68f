# SPDX-License-Identifier: GPL-2.0-only
"""Arrays as arguments of the plugin's C functions."""

from __future__ import annotations

import ctypes

import numpy as np

from ..model.contact_body import ContactBody


def pointer(array: np.ndarray) -> ctypes.c_void_p:
    """Where the numbers of a contiguous array lie."""
    return array.ctypes.data_as(ctypes.c_void_p)


def body_arguments(kind: int, body: ContactBody) -> list:
    """The arguments of ``mdanim_contact_body`` that follow the ID of the fix (plugin/c_api/contact_c.cpp)."""
    return [
        ctypes.c_int(kind),
        *map(pointer, (body.count, body.edge)),
        ctypes.c_int(len(body.node)),
        *map(pointer, (body.node, body.filled)),
        ctypes.c_int(len(body.cell)),
        *map(pointer, (body.cell, body.at, body.centre, body.normal, body.area, body.kind)),
        None if body.depth is None else pointer(body.depth),
        ctypes.c_int64(0 if body.depth is None else len(body.depth)),
        ctypes.c_int(len(body.open)),
        pointer(body.open),
        *(None if array is None else pointer(array) for array in (body.frame, body.frame_at)),
        *map(ctypes.c_double, (body.radius, body.hardness, body.spread)),
        ctypes.c_int(len(body.sharer)),
        *map(pointer, (body.sharer, body.share)),
        ctypes.c_int(body.tears),
    ]
