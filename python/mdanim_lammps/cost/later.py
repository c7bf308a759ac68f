# SPDX-License-Identifier: GPL-2.0-only
"""Costs that begin later than the first steps, by the run in coarse cells: its surfaces touch when those of the run will."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from ..errors import MdanimError
from ..model.spacing import choose_spacing
from ..results.cost import Cost
from ..results.files import STOP
from ..run.prepare import Prepared, prepare
from ..scene.scene import Save

LATER = ("contact", "ground", "walls", "basin", "buoyancy")
"""Effects at surfaces, which cost next to nothing until these meet something."""
COARSER = (2.0, 1.5)
"""Spacings that are tried over the run's own: cost falls with the fourth power, and a thin object may not take the first."""
PATIENCE = 3.0
"""Processor seconds of the coarse run."""


def later(ready: Prepared, folder: Path, first_steps: Callable[[Prepared, Path], Cost]) -> dict[str, float]:
    """Seconds by effect that first steps do not show, in a run of ``ready``; empty where nothing coarser can be run.

    A coarse run is made whole, and its first steps alone are taken for all as those of the run are; what the whole costs more is
    scaled by the number of steps and of particles at surfaces. ``folder`` holds temporary files.
    """
    coarse = _coarser(ready)
    if coarse is None:
        return {}
    try:
        (folder / "first").mkdir()
        told, whole = first_steps(coarse, folder / "first"), _whole(coarse, folder / "whole")
    except MdanimError:
        return {}  # what stops in coarse cells says nothing of the run
    surface = ready.system.boundary.sum() / coarse.system.boundary.sum()
    scale = float(ready.certificate.steps / coarse.certificate.steps * surface)
    parts = {name: whole[name] - told.parts[name] for name in LATER if name in whole}
    return {name: scale * more for name, more in parts.items() if more > 0.0}


def _coarser(ready: Prepared) -> Prepared | None:
    if not any(ready.verdicts[name].on for name in LATER):
        return None
    control = ready.scene.control
    for factor in COARSER:
        spacing = factor * choose_spacing(ready.scene)[0]
        try:
            return prepare(
                replace(ready.scene, control=replace(control, resolution=spacing, timestep=None, save=Save.BOUNDARY, single=True))
            )
        except MdanimError:
            continue
    return None


def _whole(coarse: Prepared, folder: Path) -> dict[str, float]:
    """Seconds by effect of the coarse run; where PATIENCE ended it, all of it is taken to cost as much as what was run."""
    from ..run.loop import Interrupted, Progress, simulate

    folder.mkdir()
    start, done = (time.perf_counter(), time.thread_time()), 0.0

    def look(p: Progress) -> None:
        nonlocal done
        done = p.step / p.steps
        if time.thread_time() - start[1] > PATIENCE:
            (folder / STOP).touch()

    try:
        cost = simulate(coarse, folder, on_progress=look).cost
    except Interrupted as stopped:
        cost = stopped.cost
    if cost is None or not done:
        raise MdanimError("no cost of the coarse run is known")
    # Clocks of effects tell wall time, of which other programs may have a part.
    own = min(1.0, (time.thread_time() - start[1]) / (time.perf_counter() - start[0]))
    return {name: own / done * part.seconds for name, part in cost.effects.items()}
