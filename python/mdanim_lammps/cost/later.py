# SPDX-License-Identifier: GPL-2.0-only
"""Costs at surfaces, which first steps do not tell, by the run in coarse cells: its surfaces touch when those of the run will."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

from ..errors import MdanimError
from ..model.spacing import scaled
from ..results.files import STOP
from ..run.prepare import Prepared, prepare
from ..scene.scene import Save

COARSER = (2.0, 1.5)
"""Spacings that are tried over the run's own: cost falls with the fourth power, and a thin object may not take the first."""
PATIENCE = 3.0
"""Processor seconds of the coarse run."""
LAST = 0.8
"""Part of a coarse run that was ended after which its steps cost as much as those that are left."""
POINTS = 0.8
"""Power with which the cost of surfaces grows with their particles: pairs of objects that are near each other have a cost of
their own, whatever number of points they have (docs/decisions/forecast.md)."""


def later(ready: Prepared, folder: Path) -> dict[str, float]:
    """Seconds by effect, of those `Effect.at_surfaces`, in a run of ``ready``; empty where nothing coarser can be run.

    The costs of a coarse run are scaled by the number of steps and, by a power, of particles at surfaces. ``folder`` holds
    temporary files.
    """
    coarse = _coarser(ready)
    if coarse is None:
        return {}
    try:
        whole = _whole(coarse, folder / "whole")
    except MdanimError:
        return {}  # what stops in coarse cells says nothing of the run
    steps = ready.certificate.steps / coarse.certificate.steps
    surface = float(ready.system.boundary.sum() / coarse.system.boundary.sum()) ** POINTS
    particles = ready.system.particles / coarse.system.particles  # what touches nothing acts on all of them, and has no pairs
    late = [e for e in ready.plan.effects if e.at_surfaces and e.name in whole]
    return {e.name: steps * (surface if e.touches else particles) * whole[e.name] for e in late}


def _coarser(ready: Prepared) -> Prepared | None:
    if not any(e.at_surfaces for e in ready.plan.effects):
        return None
    control = ready.scene.control
    for factor in COARSER:
        spacing = factor * ready.context.spacing.h
        coarse = replace(control, resolution=spacing, timestep=None, save=Save.BOUNDARY, single=True)
        try:
            return prepare(replace(scaled(ready.scene, factor), control=coarse))
        except MdanimError:
            continue
    return None


def _whole(coarse: Prepared, folder: Path) -> dict[str, float]:
    """Seconds by effect of the coarse run; where PATIENCE ended it, what was left would have cost as much as its last steps."""
    from ..run.loop import Interrupted, Progress, simulate

    folder.mkdir()
    start = time.perf_counter(), time.thread_time()
    marks: list[tuple[float, float]] = []

    def look(p: Progress) -> None:
        marks.append((p.step / p.steps, p.seconds))
        if time.thread_time() - start[1] > PATIENCE:
            (folder / STOP).touch()

    try:
        cost = simulate(coarse, folder, on_progress=look).cost
    except Interrupted as stopped:
        cost = stopped.cost
    if cost is None or not marks:
        raise MdanimError("no cost of the coarse run is known")
    # Clocks of effects tell wall time, of which other programs may have a part.
    own = min(1.0, (time.thread_time() - start[1]) / (time.perf_counter() - start[0]))
    found = {name: own * part.seconds for name, part in cost.effects.items()}
    done, simulated = marks[-1]
    at, before = next(m for m in (*reversed(marks[:-1]), (0.0, 0.0)) if m[0] <= LAST * done)
    # All other effects cost as much from the beginning on: if a step costs more, that is due to those at surfaces.
    more = own * ((simulated - before) / (done - at) - simulated / done)
    late = {e.name for e in coarse.plan.effects if e.at_surfaces}
    at_surfaces = sum(seconds for name, seconds in found.items() if name in late)
    growth = 1.0 + (1.0 - done) * max(1.0 / done + more / at_surfaces, 0.0) if at_surfaces else 1.0
    return {name: seconds * (growth if name in late else 1.0 / done) for name, seconds in found.items()}
