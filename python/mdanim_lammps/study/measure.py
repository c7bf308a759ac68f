# SPDX-License-Identifier: GPL-2.0-only
"""One point of a study: a run without movie in a temporary folder; its track and its seconds are kept."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np

from ..records import dataclass
from ..results.files import read_json, scratch
from ..results.stored import SUMMARY
from ..results.trajectory import Trajectory
from ..run.loop import Progress, simulate
from ..run.prepare import prepare
from ..scene.formatting import say
from ..scene.scene import SceneRecord
from .setting import Setting, frames_only, with_setting

PACE_SECONDS = 0.5
"""Wall seconds [s] after which a run's own pace shows whether the run can end in time."""


@dataclass(frozen=True)
class Sample:
    """The results of one run of a point."""

    setting: Setting
    timestep: float
    """[s]"""
    steps: int
    particles: int
    seconds: float
    """Wall time of the simulation, without building models and writing files [s]."""
    wall: float
    """Wall time of everything [s]."""
    drift: float
    """Largest energy residual [-]."""
    penetration: float
    """Largest depth of any object in another object or behind a plane [m]."""
    found: tuple[float, ...]
    """Results of the scene's ``expect`` lines, in their order."""
    times: np.ndarray
    """Times of the frames [s], shape (F,)."""
    center: np.ndarray
    """Centres of mass [m], shape (F, M, 3)."""


class TooLong(Exception):
    """A run that would not end within its limit was stopped; ``seconds`` is what it would have taken."""

    def __init__(self, seconds: float):
        super().__init__(f"would take about {say(seconds, 's', 2)}")
        self.seconds = seconds


def measure(scene: SceneRecord, setting: Setting, folder: Path, *, limit: float = float("inf"), repeat: int = 0) -> Sample:
    """Run a scene with a setting in a temporary folder inside ``folder``.

    Raises TooLong when the run turns out to need more than ``limit`` seconds of wall time in all, and SceneError,
    RefusedError, DivergedError, OutputError and Interrupted as any run does.
    """
    start = time.perf_counter()
    ready = prepare(frames_only(with_setting(scene, setting, repeat=repeat)))
    last: list[Progress] = []

    def look(p: Progress) -> None:
        last[:] = [p]
        if (wall := time.perf_counter() - start) > PACE_SECONDS and p.step:
            needed = wall + p.seconds * (p.steps - p.step) / p.step
            if needed > limit:
                raise TooLong(needed)

    with scratch(folder, setting.key) as temporary:
        result = simulate(ready, temporary, on_progress=look)
        with Trajectory(temporary) as t:
            times, center = (np.array(a[:], float) for a in (t.times, t.centers))
        penetration = read_json(temporary / "summary.json", SUMMARY)["penetration"]
    c = ready.certificate
    return Sample(
        setting,
        c.timestep,
        c.steps,
        ready.system.particles,
        last[0].seconds,
        time.perf_counter() - start,
        result.ledger.residual,
        penetration,
        tuple(float(o.found) for o in result.outcomes),
        times,
        center,
    )
