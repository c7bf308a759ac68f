# SPDX-License-Identifier: GPL-2.0-only
"""Bodies in a basin for fix mdanim/liquid."""

from __future__ import annotations

import ctypes
from itertools import product

import numpy as np
import plugin_lab as lab
import state_lab
from mdanim_lammps.engine.plugin import folder

POOL = "fix water all mdanim/liquid basin 1.0 grid 20 20 16 level 10 gravity 0.01"
FALL = "fix gravity all gravity 0.01 vector 0 0 -1"
VECTOR = {"units": 0, "start": 1, "level": 2, "solid": 3, "sweeps": 4, "awake": 5, "lost": 6}
VECTOR |= {"crest": 12, "momentum.x": 13, "momentum.y": 14}
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


def value(lmp, name: str) -> float:
    """An entry of the fix's vector."""
    return lmp.extract_fix("water", 0, 1, VECTOR[name])


def cells(lmp, shape=(16, 20, 20)) -> np.ndarray:
    """Content of every cell, 255 where solid, shape (nz, ny, nx)."""
    out = np.empty(shape, np.uint8)
    call("liquid_cells", lmp, out.ctypes.data_as(ctypes.c_void_p))
    return out


def state(lmp) -> np.ndarray:
    """The fix's state as bytes."""
    return state_lab.pack(lmp, "water").record(0)


def take_up(lmp, stored: np.ndarray) -> None:
    """Take up these bytes; RuntimeError with the reason."""
    records = state_lab.Records(np.zeros((1, 2), np.int32), np.array([0, len(stored)]), stored)
    state_lab.put(lmp, "water", records)


def lattice(body: lab.Body, shape) -> list[str]:
    """Commands that give a block of lab.block its table of lattice cells."""
    nx, ny, nz = shape
    index = np.arange(len(body.x)).reshape(nz + 1, ny + 1, nx + 1) + 1
    commands = []
    for z, y, x in product(range(nz), range(ny), range(nx)):
        low, high = index[z], index[z + 1]
        ring = [(y, x + 1), (y + 1, x + 1), (y + 1, x)]
        tags = [low[c] for c in ring] + [high[y, x]] + [high[c] for c in ring]
        commands += [f"set atom {low[y, x]} i2_cell[{k}] {tag}" for k, tag in enumerate(tags, 1)]
    return commands


def block_in_pool(tmp_path, shape, corner, commands=(), density=0.5, pool=POOL, velocity=(0.0, 0.0, 0.0)):
    """An elastic block in the pool, ready to run."""
    body = lab.block(shape, corner, velocity)
    volume = body.mass.copy()  # share of cells: density 1
    body.mass[:] *= density
    return lab.load(
        body,
        tmp_path,
        [
            "fix table all property/atom i2_cell 7 ghost yes",
            *lattice(body, shape),
            *BASIN,
            FALL,
            f"{pool} cells i2_cell buoyancy d_volume drag 0.1 lambda d_lambda",
            "fix move all mdanim/leapfrog lambda d_lambda",
            "timestep 0.3",
            *commands,
        ],
        columns={"volume": volume, "lambda": np.zeros(len(body.x))},
    )
