# SPDX-License-Identifier: GPL-2.0-only
"""Programs one after the other in one start of MPI: ``mpiexec -n N python -m mpi4py stand_by.py FOLDER``.

Each rank reads jobs from a pipe of its own, FOLDER/RANK, and waits there without taking time. A job is a line of JSON: a program,
its arguments, the number of ranks that are its world, and the seconds after which all of them tell where they are. Rank 0 answers
with a line of JSON, all that was printed. Where a program raises, all ranks end.
"""

import faulthandler
import gc
import io
import json
import os
import runpy
import sys
from contextlib import redirect_stdout
from pathlib import Path

from mpi4py import MPI


def main(folder: Path) -> None:
    """Do jobs until the process that gives them has ended."""
    everyone, environment = MPI.COMM_WORLD, dict(os.environ)
    with (folder / str(everyone.rank)).open() as jobs:
        for line in jobs:
            job = json.loads(line)
            world = everyone.Split(0 if everyone.rank < job["ranks"] else MPI.UNDEFINED, everyone.rank)
            if world != MPI.COMM_NULL:
                said = world.gather(printed(world, **job))
                world.Free()
                if everyone.rank == 0:
                    print(json.dumps("".join(said)), flush=True)
            for name in set(os.environ) - set(environment):
                del os.environ[name]
            os.environ.update(environment)


def printed(world: MPI.Comm, program: str, arguments: list[str], ranks: int, seconds: float) -> str:
    """Run a program, to which these ranks are the world, and return what it prints."""
    whole, MPI.COMM_WORLD, sys.argv[:] = MPI.COMM_WORLD, world, [program, *arguments]
    faulthandler.dump_traceback_later(seconds)
    with redirect_stdout(io.StringIO()) as said:
        runpy.run_path(program, run_name="__main__")
    faulthandler.cancel_dump_traceback_later()
    MPI.COMM_WORLD = whole
    gc.collect()
    return said.getvalue()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
