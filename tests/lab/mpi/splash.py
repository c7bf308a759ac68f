# SPDX-License-Identifier: GPL-2.0-only
"""A splash on all ranks with some threads each: ``mpiexec -n N python splash.py MODEL THREADS RESUME OUT.npz``."""

import sys

import numpy as np
from mpi4py import MPI
from splash_lab import splash

if __name__ == "__main__":
    told = splash(sys.argv[1], int(sys.argv[2]), MPI.COMM_WORLD, resume=sys.argv[3] == "1")
    if MPI.COMM_WORLD.rank == 0:
        np.savez(sys.argv[4], **told)
