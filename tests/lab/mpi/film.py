# SPDX-License-Identifier: GPL-2.0-only
"""Film a scene on all ranks with run_style verlet/mdanim: ``mpiexec -n N python film.py SCENE OUT.npz [COMMAND …]``."""

import sys
from pathlib import Path

import numpy as np
from filming import film
from mpi4py import MPI

if __name__ == "__main__":
    frames, energies, trace, taken = film(Path(sys.argv[1]).read_text(), "verlet/mdanim", comm=MPI.COMM_WORLD, more=sys.argv[3:])
    everywhere = MPI.COMM_WORLD.allgather(taken)
    if MPI.COMM_WORLD.rank == 0:
        np.savez(sys.argv[2], frames=frames, energies=energies, trace=trace, taken=everywhere)
