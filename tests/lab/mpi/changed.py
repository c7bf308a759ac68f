# SPDX-License-Identifier: GPL-2.0-only
"""Springs, objects and masses that change between two runs: ``mpiexec -n N python changed.py CASE FOLDER OUT.npz``."""

import ctypes
import sys
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import plugin_lab as lab
import plugin_path

EXACT = lab.join(
    lab.shaken(lab.block((10, 3, 2)), 0.03),
    lab.shaken(lab.block((3, 3, 2), (11.4, 0.6, 0.3), (-0.1, 0.0, 0.0)), 0.03, 2),
    lab.shaken(lab.block((2, 2, 2), (4.0, 4.4, 0.3), (0.0, -0.1, 0.0)), 0.03, 4),
)
BODIES = replace(EXACT, r0=EXACT.r0.round(3))
"""Molecule 1 is a beam that reaches over ranks, 2 and 3 are blocks that near its end and its side; springs of five types."""
STEPS = 40
RUN, RUN_ON = f"run {STEPS}", f"run {STEPS} pre no"


def twice(body: lab.Body, every: int, k: float, r0: float) -> lab.Body:
    """The same body with a second spring beside every n-th one, of another type."""
    more = body.bond[::every]
    return replace(
        body,
        bond=np.concatenate([body.bond, more]),
        k=np.concatenate([body.k, np.full(len(more), k)]),
        r0=np.concatenate([body.r0, np.full(len(more), r0)]),
    )


DOUBLED = twice(twice(BODIES, 3, 0.07, 1.1), 5, 0.03, 0.9)
"""Some pairs have two springs, some three."""


def tag(body: int, place: tuple[float, float, float]) -> int:
    """The tag of the particle of a molecule that lies next to a place."""
    apart = np.linalg.norm(BODIES.x - place, axis=1)
    return int(np.where(BODIES.molecule == body, apart, np.inf).argmin()) + 1


@dataclass(frozen=True)
class Case:
    """A scene that is run, changed, and run again."""

    changes: tuple[str, ...]
    """Commands after the first run, further runs among them."""
    body: lab.Body = BODIES
    style: str = "verlet/mdanim"
    """The run style with passes."""

    def unchanged(self) -> "Case":
        """The same runs with nothing else between them, or of springs that are not doubled where there is nothing else."""
        runs = tuple(c for c in self.changes if c.startswith("run "))
        return Case(runs, BODIES if runs == self.changes else self.body)


CASES = {
    # A third of the beam, and molecule 2.
    "delete_bonds": Case(("group g id 1:45", "delete_bonds g multi", RUN, RUN_ON)),
    "delete_bonds remove": Case(("group g molecule 2", "delete_bonds g multi remove", RUN, RUN_ON)),
    "delete_bonds and undo": Case(("group g id 1:45", "delete_bonds g multi", RUN, "delete_bonds g multi undo", RUN)),
    "set bond": Case(("group g id 20:90", "set group g bond 1", RUN, RUN_ON)),
    # Every third particle of the beam is another object's, and then the beam is whole again.
    # With eight lanes too few would have springs then.
    "set mol": Case(
        ("group g id 1:130:3", "set group g mol 4", RUN, "set group g mol 1", RUN), style="verlet/mdanim width common"
    ),
    "create_bonds": Case(
        (
            f"create_bonds single/bond 1 {tag(1, (10, 1, 1))} {tag(2, (11.4, 1.2, 1))} special no",
            f"create_bonds single/bond 2 {tag(1, (4, 3, 1))} {tag(3, (4, 4.4, 1))}",
            RUN,
            RUN_ON,
        )
    ),
    # Wants a pair style, and pairs with a spring left out of its lists.
    "create_bonds many": Case(
        (
            "pair_style zero 2.5",
            "pair_coeff * *",
            "special_bonds lj/coul 0 1 1",
            "group a molecule 1",
            "group b molecule 2 3",
            "create_bonds many a b 1 0.5 1.5",
            "pair_style none",
            "special_bonds lj/coul 1 1 1",
            RUN,
            RUN_ON,
        )
    ),
    "create_bonds within": Case(
        (f"create_bonds single/bond 1 {tag(2, (11.4, 0.6, 0.3))} {tag(2, (12.4, 1.6, 1.3))}", RUN, RUN_ON)
    ),
    "set mass": Case(("group g id 20:90", "set group g mass 1.7", RUN, RUN_ON)),
    "bond_coeff": Case(("bond_coeff 1 0.2 1.05", RUN, RUN_ON)),
    "second springs": Case((RUN,), DOUBLED),
    # A removed spring leaves its place to the last spring of a particle, so the two ends may have theirs in different orders.
    "second springs deleted": Case(("group g id 1:100", "delete_bonds g bond 1 remove", RUN), DOUBLED),
    "bond_coeff pre no": Case(("bond_coeff 1 0.2 1.05", RUN_ON, RUN)),
}


def film(case: Case, style: str, folder: Path, comm=None) -> tuple[np.ndarray, np.ndarray]:
    """Positions, velocities and forces in tag order after each run, shape (runs, 3, N, 3), and the passes of each, shape (runs,).

    On this process alone unless a communicator is given, whose processes all get them.
    """
    from mpi4py import MPI

    comm = comm or MPI.COMM_SELF
    passes, states = [0], []
    with instance(case.body, folder, comm) as lmp:
        for command in [
            "fix pull all mdanim/gravity 0.001 -0.002 0.003",
            "fix contact all mdanim/barrier boundary inner 0.8 1.3",
            "fix run all mdanim/leapfrog",
            "timestep 0.2",
            "thermo 1000",
            f"run_style {style}",
            RUN,
            *case.changes,
        ]:
            lmp.command(command)
            if command.startswith("run "):
                passes.append(passes_of(lmp))
                states.append(state(lmp, len(case.body.x), comm))
    return np.array(states), np.diff(passes)


@contextmanager
def instance(body: lab.Body, folder: Path, comm, before=(), after=()):
    """A LAMMPS instance with this body on all ranks of a communicator; more commands before its box is made and after that."""
    data = folder / "data.test"
    if comm.rank == 0:
        lab.write_data(body, data)
    comm.Barrier()
    lmp = plugin_path.lammps(comm=comm)
    for command in [
        *lab.prelude(),
        *before,
        f"read_data {data} fix model NULL Model extra/bond/per/atom 8 extra/special/per/atom 60",
        "mass * 1.0",
        *lab.springs(body),
        "group inner type 1",
        "group boundary type 2",
        *after,
    ]:
        lmp.command(command)
    yield lmp
    lmp.close()


def passes_of(lmp) -> int:
    """How many steps this rank has taken by passes."""
    library = ctypes.CDLL(plugin_path.folder() + "/mdanimplugin.so")
    library.mdanim_passes.restype = ctypes.c_longlong
    return library.mdanim_passes(ctypes.c_void_p(getattr(lmp.lmp, "value", lmp.lmp)))


def state(lmp, count: int, comm) -> np.ndarray:
    """Positions, velocities and forces in tag order, shape (3, N, 3), on all ranks."""
    found, here = np.zeros((3, count, 3)), lmp.extract_setting("nlocal")
    if here:
        for which, values in zip("xvf", found):
            values[lmp.numpy.extract_atom("id")[:here] - 1] = lmp.numpy.extract_atom(which)[:here]
    return comm.allreduce(found)


def main(name: str, folder: Path, out: str) -> None:
    """Film a case on all ranks with both run styles."""
    from mpi4py import MPI

    comm = MPI.COMM_WORLD
    plain, _ = film(CASES[name], "verlet", folder, comm)
    ours, passes = film(CASES[name], CASES[name].style, folder, comm)
    everywhere = comm.allgather(passes)
    if comm.rank == 0:
        np.savez(out, plain=plain, ours=ours, passes=everywhere)


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]), sys.argv[3])
