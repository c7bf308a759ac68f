# SPDX-License-Identifier: GPL-2.0-only
"""Let a pile of cuboids fall together on all ranks and write what is there after every piece:
``mpiexec -n N python contact_pile.py SEED FRICTION OUT.npz``."""

import sys
from pathlib import Path

import numpy as np
from contact_lab import PILE, State, load, pile

PIECES, LENGTH = 4, 60
BALANCE = ("comm_style tiled", "balance 1.0 rcb")


def film(seed: int, friction: bool, folder: Path, comm=None) -> dict[str, np.ndarray]:
    """States after every piece, and what the fix tells but for seconds."""
    more = (*(BALANCE if comm is not None and comm.size > 1 else ()), *PILE["more"])
    lmp = load(pile(seed, friction), folder, comm=comm, **{**PILE, "more": more})
    found = {}
    for piece in range(PIECES):
        lmp.command(f"run {LENGTH} pre no post no")
        state = State.of(lmp)
        told = [lmp.extract_fix("contact", 0, 0), *(lmp.extract_fix("contact", 0, 1, n) for n in (0, 1, 2, 3, 4, 5, 6, 8, 9, 10))]
        parts = {"x": state.x, "v": state.v, "f": state.f, **state.contacts._asdict(), "told": np.array(told)}
        found |= {f"{name} {piece}": values for name, values in parts.items()}
    lmp.close()
    return found


def main(seed: str, friction: str, out: str) -> None:
    from mpi4py import MPI

    comm = MPI.COMM_WORLD
    found = film(int(seed), friction == "True", Path(out).parent, comm)
    for name, own in found.items():
        assert comm.bcast(own).tobytes() == own.tobytes(), f"rank {comm.rank} has another {name}"
    if comm.rank == 0:
        np.savez(out, **found)


if __name__ == "__main__":
    main(*sys.argv[1:])
