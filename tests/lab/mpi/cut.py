# SPDX-License-Identifier: GPL-2.0-only
"""Print how many rows of a lattice each rank has parts of, and how many particles: ``mpiexec -n N python cut.py SCENE ROW``."""

import sys
from pathlib import Path

import numpy as np
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import load_scene
from mpi4py import MPI

comm = MPI.COMM_WORLD
plan = prepare(load_scene(Path(sys.argv[1]))).plan
with Instance(plan, comm) as instance:
    instance.setup()
    instance.run(10)
    rows, whole = instance.particles.rows(), instance.array("x")
    found = comm.gather((len(set((rows // int(sys.argv[2])).tolist())), len(rows)))
    start = plan.system.position
    assert np.abs(whole - start).max() < 0.01 * np.ptp(start), "particles are not where they belong"
if comm.rank == 0:
    print(*(f"{touched} {particles}" for touched, particles in found), sep="\n")
