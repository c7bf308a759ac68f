# SPDX-License-Identifier: GPL-2.0-only
"""Bodies in a basin for fix mdanim/liquid."""

from __future__ import annotations

import ctypes

import numpy as np
import plugin_lab as lab
from mdanim_lammps.engine.plugin import folder

BASIN = ["region basin block -10 10 -10 10 0 16"]


def library():
    """The plugin's plain C functions."""
    return ctypes.CDLL(f"{folder()}/mdanimplugin.so")


def handle(lmp):
    """LAMMPS's own pointer."""
    return ctypes.c_void_p(ctypes.cast(lmp.lmp, ctypes.c_void_p).value)


def call(name, lmp, *arguments) -> None:
    """Call one of the plugin's functions on the liquid; RuntimeError with its message."""
    error = ctypes.create_string_buffer(200)
    if getattr(library(), f"mdanim_{name}")(handle(lmp), b"water", *arguments, error, 200):
        raise RuntimeError(error.value.decode())


def one(z: float, mass=0.5, v=0.0) -> lab.Body:
    """A single particle over the middle of the basin."""
    return lab.particles([[0.3, -0.2, z]], v=[[0.0, 0.0, v]], mass=np.array([mass]))
