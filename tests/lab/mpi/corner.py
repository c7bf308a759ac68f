# SPDX-License-Identifier: GPL-2.0-only
"""Objects in a corner of the box, so that a rank has no particles: ``mpiexec -n N python corner.py FOLDER OUT.npz``."""

import sys
from pathlib import Path

import numpy as np
import plugin_lab as lab
from mpi.changed import instance, passes_of, state

BODY = lab.join(lab.shaken(lab.block((4, 3, 2)), 0.03), lab.shaken(lab.block((2, 2, 2), (6.0, 0.0, 0.0)), 0.03, 2))


def film(style: str, folder: Path, comm) -> tuple[np.ndarray, int, int]:
    """Positions, velocities and forces in tag order, shape (3, N, 3), passes, and this rank's particles."""
    processors = f"processors {comm.size} 1 1"
    with instance(
        BODY, folder, comm, [processors], ["change_box all boundary f f f x final -99 12 y final -9 9 z final -9 9"]
    ) as lmp:
        for command in ("fix pull all mdanim/gravity 0.001 -0.002 0.003", "fix run all mdanim/leapfrog", "timestep 0.2"):
            lmp.command(command)
        lmp.command(f"run_style {style}")
        lmp.command("run 100")
        return state(lmp, len(BODY.x), comm), passes_of(lmp), lmp.extract_setting("nlocal")


def main(folder: Path, out: str) -> None:
    """Film on all ranks with both run styles."""
    from mpi4py import MPI

    comm = MPI.COMM_WORLD
    plain, _, _ = film("verlet", folder, comm)
    ours, passes, own = film("verlet/mdanim", folder, comm)
    everywhere = comm.allgather((passes, own))
    if comm.rank == 0:
        np.savez(out, plain=plain, ours=ours, passes=[p for p, _ in everywhere], own=[n for _, n in everywhere])


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2])
