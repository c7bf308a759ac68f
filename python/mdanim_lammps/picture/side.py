# SPDX-License-Identifier: GPL-2.0-only
"""Two runs in one movie, side by side: one camera, one clock, and the same axes and lengths of arrows in both halves."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from fractions import Fraction
from pathlib import Path

import numpy as np

from ..errors import OutputError, UsageError
from ..results.trajectory import Trajectory
from ..scene.naming import objects_by_name
from ..scene.render import Render
from .camera import Action, action_of
from .encoder import Yuv, encoder
from .movie import FASTEST, MOST_PICTURES, movie_rate
from .palette import colors_beside
from .render import Painter

LINE = 2
"""Width of the line between both halves [pixels]."""


def render_side_by_side(
    first: str | Path,
    second: str | Path,
    render: Render,
    path: str | Path,
    *,
    size: tuple[int, int] | None = None,
    fps: float | None = None,
    on_progress: Callable[[int, int], None] | None = None,
) -> Path:
    """Draw two runs beside each other as an H.264 movie, as `movie.render_movie` does one. The shorter one stops at its end.

    Args:
        first, second: folders of runs.
        render: how both are drawn.
        path: file to write.
        size: width and height of the whole picture in pixels, instead of ``render.size``.
        fps: pictures per second; None is that of the run with more frames, up to FASTEST.
        on_progress: called with (pictures done, pictures in all) after each.

    Raises:
        SetupError: this host cannot draw off screen, or has no ffmpeg.
        OutputError: a run has no frames, or the movie cannot be written.
        UsageError: names or quantities that one of the runs does not have, or a movie that is too long.
    """
    width, height = size or render.size
    half, height = max(2, width // 2), height + height % 2
    with ExitStack() as stack:
        runs = [stack.enter_context(Trajectory(folder)) for folder in (first, second)]
        for run in runs:
            if not len(run):
                raise OutputError(f"{run.path}: holds no frame, nothing can be drawn; resume the run first")
        moments, rate = _moments(runs, render.speed, fps)
        painters = [stack.enter_context(painter) for painter in _painters(runs, (first, second), render, (half, height))]
        with encoder(Path(path), (2 * half, height), rate) as encode:
            yuv = Yuv()
            for done, moment in enumerate(moments, 1):
                frames = [int(np.abs(run.times - moment).argmin()) for run in runs]
                picture = np.concatenate([painter.pixels(n) for painter, n in zip(painters, frames)], axis=1)
                picture[:, half - LINE // 2 : half + LINE // 2] = 128
                encode(yuv.of(picture))
                if on_progress is not None:
                    on_progress(done, len(moments))
    return Path(path)


def _painters(
    runs: list[Trajectory], folders: tuple[str | Path, str | Path], render: Render, size: tuple[int, int]
) -> list[Painter]:
    """A painter for each run; what both have in common is found from both."""
    named = [objects_by_name(run.names) for run in runs]
    for one in (*render.trail, *render.label, *(a for a in render.arrows if a.name)):
        for run, known in zip(runs, named):
            if one.name not in known:
                raise UsageError(f"{run.path} has no object {one.name}, which render names; take another render block by --scene")
    actions = [action_of(run) for run in runs]
    both = _together(*actions)
    colors = None, colors_beside(runs[1].metadata, runs[0].metadata)
    return [
        Painter(run, render, size=size, action=own, seen=both, beside=other, colors=color, name=Path(folder).resolve().name)
        for run, own, other, color, folder in zip(runs, actions, reversed(runs), colors, folders)
    ]


def _together(a: Action, b: Action) -> Action:
    """Where things happen in either of two runs; the one with fewer stretches stays as it is at its end."""
    stretches = max(len(a.low), len(b.low))
    last = lambda x: np.concatenate([x, np.repeat(x[-1:], stretches - len(x), axis=0)])
    low, high, leads = (np.concatenate([last(getattr(one, word)) for one in (a, b)], axis=1) for word in ("low", "high", "leads"))
    bounds = np.minimum(a.bounds[0], b.bounds[0]), np.maximum(a.bounds[1], b.bounds[1])
    free, hung = (np.concatenate([getattr(one, word) for one in (a, b)]) for word in ("free", "hung"))
    return Action(low, high, bounds, a.escaped or b.escaped, free, leads, hung)


def _moments(runs: list[Trajectory], speed: float, fps: float | None) -> tuple[np.ndarray, Fraction]:
    """Simulated times of the pictures [s], and how many of them a second has."""
    end = max(float(run.times[-1]) for run in runs)
    own = max(((len(run) - 1) / float(run.times[-1]) for run in runs if len(run) > 1), default=30.0) * speed
    fps = fps or min(own, FASTEST)
    count = int(end / speed * fps + 1e-6) + 1
    if count > MOST_PICTURES:
        raise UsageError(f"{count:,} pictures are too many; the limit is {MOST_PICTURES:,}")
    return np.arange(count) / fps * speed, movie_rate(fps)
