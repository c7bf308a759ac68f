# SPDX-License-Identifier: GPL-2.0-only
"""Follow a scene on all ranks and write what rank 0 has seen: ``mpiexec -n N python follow.py together SCENE OUT.npz``."""

import sys
from pathlib import Path

import numpy as np
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.engine.state import State
from mdanim_lammps.features.liquid import frames as liquid
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import load_scene

FIRST, THEN = 15, 30
"""Steps before the state that is put again, and after it."""
LOOK_STEPS = 3
"""Steps from one look of the trace to the next, when steps are gone again."""
SIDE = np.array([9.0, 0.0, 3.0])
"""A place far from all objects, twice [m]."""


def seen(instance: Instance) -> dict[str, np.ndarray]:
    """Everything that a driver asks an instance for."""
    state, plan = instance.state(), instance.plan
    found = {name: getattr(state, name) for name in ("x", "v", "f")}
    found |= {fix: records.data for fix, records in state.records.items() if fix != "liquid"}
    if plan.grid:
        smooth, raw = liquid.heights(instance)
        found |= {"liquid": state.records["liquid"].data, "cells": liquid.cells(instance), "smooth": smooth, "raw": raw}
    if "lambda" in plan.columns:
        found["lambda"] = instance.array("d_lambda").copy()
    for name in "xvf":  # ranks have different particles, and all of them together all
        assert np.array_equal(instance.particles.here(name), found[name][instance.particles.rows()])
    assert instance.lammps.total(len(instance.particles.here("x"))) == plan.system.particles
    found["speed"] = instance.trace.top_speeds()
    energies = [effect.energy(instance) for effect in plan.effects if effect.ledger]
    losses = [loss for effect in plan.effects for loss in effect.lost(instance).items()]
    energies += [loss for term, loss in losses if term != "let_go"]  # nothing is let go where no cell is turned over
    return found | {
        "step": np.array(instance.step),
        "energies": np.array(energies),
        "depths": np.array([effect.penetration(instance) for effect in plan.effects]),
    }


def follow(path: Path, comm=None) -> dict[str, np.ndarray]:
    """Observations at the start, after some steps, after more, and after those were taken back and gone again,
    here and elsewhere."""
    plan = prepare(load_scene(path)).plan
    film: dict[str, np.ndarray] = {}

    def look(when: str) -> None:
        film.update({f"{when} {name}": value for name, value in seen(instance).items()})

    with Instance(plan, comm) as instance:
        instance.setup()
        look("start")
        instance.run(FIRST)
        kept = instance.state()
        instance.trace.start()
        instance.run(THEN)
        low, high = instance.trace.boxes()
        film |= {"low": low, "high": high}
        look("end")
        instance.put(FIRST, kept)
        instance.trace.start()
        instance.trace.look_every(LOOK_STEPS)
        instance.run(THEN)
        look("again")
        wider_low, wider_high = instance.trace.boxes()
        assert (wider_low <= low).all() and (wider_high >= high).all(), "a trace that looks less often leaves nothing out"
        clocks = [seconds for effect in plan.effects for seconds in effect.clocks(instance).values()]
        assert np.isfinite(clocks).all() and instance.bond_seconds() > 0.0
    with Instance(plan, comm) as instance:
        if plan.grid is None:
            # All particles far from the ranks that have them: a put is to bring them home from anywhere.
            mirror = State(SIDE - kept.x, -kept.v, -kept.f)
            instance.put(FIRST, mirror)
            film["far"] = instance.state().x
        instance.put(FIRST, kept)
        instance.run(THEN)
        look("new")
    return film


def together(scene: str, out: str) -> None:
    """All ranks follow one instance, and see the same."""
    from mpi4py import MPI

    comm = MPI.COMM_WORLD
    film = follow(Path(scene), comm)
    for name, own in film.items():
        root = comm.bcast(own)
        assert np.array_equal(own, root, equal_nan=True), f"rank {comm.rank} has another {name}"
    if comm.rank == 0:
        np.savez(out, **film)


def apart(scene: str, out: str) -> None:
    """Rank 0 follows its own instance while the others follow another one together, and write theirs."""
    from mpi4py import MPI

    comm = MPI.COMM_WORLD
    part = comm.Split(color=comm.rank == 0)
    film = follow(Path(scene), part)
    if part.rank == 0:
        np.savez(f"{out}{int(comm.rank > 0)}.npz", **film)


if __name__ == "__main__":
    {"together": together, "apart": apart}[sys.argv[1]](*sys.argv[2:])
