# SPDX-License-Identifier: GPL-2.0-only
"""The cost of the movie of a run: some pictures of its first steps are drawn, and all others are taken to cost as much."""

from __future__ import annotations

import statistics
import time
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from ..errors import SetupError
from ..picture.movie import movie_frames, processes_for
from ..results.trajectory import Trajectory
from ..run.prepare import Prepared

ENOUGH = 0.5
"""Seconds after which no more pictures are drawn."""
PICTURES = 1, 4
"""Fewest and most pictures that are drawn, the first not counted."""


def pictures(ready: Prepared) -> int:
    """How many pictures the movie of a run has. Raises UsageError where they are too many."""
    c = ready.certificate
    times = np.arange(c.last_frame + 1) * (c.steps_per_frame * c.timestep)
    return len(movie_frames(SimpleNamespace(times=times, path=""), None, ready.scene.render.speed)[0])


def movie_seconds(ready: Prepared, folder: Path) -> float | None:
    """Wall seconds of the movie, from the trajectory of the first steps in ``folder``; None where this host cannot draw.

    The first picture has what comes once: libraries, the window, the camera.
    """
    try:
        from ..picture.render import Painter

        wanted = pictures(ready)
        marks = [(time.perf_counter(), time.process_time())]
        with Trajectory(folder) as trajectory, Painter(trajectory, ready.scene.render) as painter:
            for k in range(1 + PICTURES[1]):
                painter.frame(min(k, len(trajectory) - 1))
                marks.append((time.perf_counter(), time.process_time()))
                if k >= PICTURES[0] and marks[-1][0] - marks[1][0] > ENOUGH:
                    break
    except SetupError:
        return None
    wall, own = (statistics.median(b[i] - a[i] for a, b in pairwise(marks[1:])) for i in (0, 1))
    once = max(0.0, marks[1][0] - marks[0][0] - wall)
    drawing = processes_for(wanted)
    # Several processes draw with one thread each; one draws with all of the host's.
    return once + wanted * (wall if drawing == 1 else own / drawing)
