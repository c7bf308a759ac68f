# SPDX-License-Identifier: GPL-2.0-only
"""Movies and stills of a trajectory; a movie lasts as long as what it shows."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from pathlib import Path

import numpy as np

from ..children import ChildLost, Workers
from ..errors import OutputError, SetupError, UsageError
from ..processes import cores, limited
from ..results.files import disk_errors, write_whole
from ..results.overwriting import MADE
from ..results.trajectory import Trajectory
from ..scene.render import Render
from .encoder import Yuv, encoder
from .marks import Marks
from .window import upright

MOST_PICTURES = 10_000_000
FASTEST = 60.0
"""Pictures per second of a time lapse; a movie at the speed of the simulated time has all of its frames."""
FRAMES_PER_PROCESS = 40
"""A process takes about two seconds to start; with fewer frames than this it does not pay."""


def render_still(
    trajectory: Trajectory | str | Path,
    frame: int,
    path: str | Path,
    render: Render = Render(),
    *,
    size: tuple[int, int] | None = None,
    marks: Marks = Marks(),
) -> Path:
    """Draw one frame as a PNG file.

    Args:
        trajectory: an open trajectory, or the folder of a run.
        frame: its number; negative ones count from the end.
        path: file to write.
        render: the scene's ``render`` block.
        size: width and height in pixels, instead of ``render.size``.
        marks: what is shown beside the surfaces.

    Raises:
        SetupError: this host cannot draw off screen.
        OutputError: the file cannot be written.
        UsageError: marks that this trajectory cannot have.
    """
    from .render import Painter

    if not isinstance(trajectory, Trajectory):
        with Trajectory(trajectory) as opened:
            return render_still(opened, frame, path, render, size=size, marks=marks)
    if not -len(trajectory) <= frame < len(trajectory):
        raise OutputError(f"{trajectory.path}: holds {len(trajectory)} frames, there is no frame {frame}")
    with Painter(trajectory, render, size=size, marks=marks) as painter:
        _save_png(painter.frame(range(len(trajectory))[frame]), Path(path))
    return Path(path)


def render_movie(
    trajectory: Trajectory | str | Path,
    render: Render,
    path: str | Path,
    *,
    size: tuple[int, int] | None = None,
    fps: float | None = None,
    processes: int | None = None,
    frames: str | Path | None = None,
    on_progress: Callable[[int, int], None] | None = None,
) -> Path:
    """Draw all frames as an H.264 movie (mp4, yuv420p) that runs at ``render.speed`` times the speed of the simulated time.

    Args:
        trajectory: an open trajectory, or the folder of a run.
        render: the scene's ``render`` block.
        path: file to write; it appears when it is whole.
        size: width and height in pixels, instead of ``render.size``; odd ones grow by one, as H.264 asks.
        fps: pictures per second, instead of the trajectory's; the nearest frames are shown.
        processes: how many draw at the same time; None takes as many as pay on this host.
        frames: a folder; also write every picture there, as ``frame-00000.png`` and so on.
        on_progress: called with (pictures done, pictures in all) after each.

    Raises:
        SetupError: this host cannot draw off screen, has no ffmpeg, or a process that draws was killed.
        OutputError: no frames, or the movie cannot be written.
    """
    if not isinstance(trajectory, Trajectory):
        with Trajectory(trajectory) as opened:
            return render_movie(
                opened, render, path, size=size, fps=fps, processes=processes, frames=frames, on_progress=on_progress
            )
    width, height = size or render.size
    size = (width + width % 2, height + height % 2)
    shown, rate = movie_frames(trajectory, fps, render.speed)
    processes = processes or processes_for(len(shown))
    # A library that finds no memory ends its process: not this one, where that is likely.
    pictures = _draw_here if processes == 1 and not limited() else _draw_apart
    with encoder(Path(path), size, rate) as encode:
        for done, picture in enumerate(pictures(trajectory, render, size, shown, processes, frames), start=1):
            encode(picture)
            if on_progress is not None:
                on_progress(done, len(shown))
    return Path(path)


def processes_for(pictures: int) -> int:
    """Number of processes that draw a movie of this number of pictures on this host."""
    return max(1, min(cores(), pictures // FRAMES_PER_PROCESS))


def movie_frames(trajectory: Trajectory, fps: float | None = None, speed: float = 1.0) -> tuple[np.ndarray, Fraction]:
    """Which frames a movie shows, one after the other, and how many a second.

    Args:
        trajectory: with at least one frame.
        fps: pictures per second; None takes every frame of the trajectory, but no more than FASTEST a second.
        speed: simulated time over the movie's.

    Raises:
        OutputError: the trajectory is empty.
    """
    times = trajectory.times
    if not len(times):
        raise OutputError(f"{trajectory.path}: holds no frame, nothing can be drawn; resume the run first")
    if len(times) == 1:
        return np.zeros(1, dtype=int), movie_rate(fps or 30.0)
    seconds = (times[-1] - times[0]) / speed
    own = (len(times) - 1) / seconds
    if fps is None and (speed == 1.0 or own <= FASTEST):
        return np.arange(len(times)), movie_rate(own)
    fps = fps or FASTEST
    if seconds * fps > MOST_PICTURES:
        raise UsageError(f"{fps:g} pictures per second for {seconds:g} s are too many; the limit is {MOST_PICTURES:,}")
    # A picture that falls on the last frame but for rounding is shown.
    wanted = np.arange(int(seconds * fps + 1e-6) + 1) / fps
    return np.clip(np.rint(wanted * own), 0, len(times) - 1).astype(int), movie_rate(fps)


def movie_rate(fps: float) -> Fraction:
    """A rate that movies can have; slow ones have the denominators that they need."""
    return Fraction(fps).limit_denominator(max(1001, round(1000.0 / fps)))


# --- drawing ----------------------------------------------------------------------------------------------


class _Drawing:
    """Pictures of a trajectory as the encoder takes them.

    Args:
        trajectory: what is drawn.
        render: how.
        size: in pixels.
        frames: a folder where each is kept too; None for none.
        action: bounds over all frames, if known already.
    """

    def __init__(self, trajectory: Trajectory, render: Render, size: tuple[int, int], frames, action=None):
        from .render import Painter

        self.painter, self._yuv = Painter(trajectory, render, size=size, action=action), Yuv()
        self._frames = None if frames is None else Path(frames)

    def picture(self, number: int, frame: int) -> np.ndarray:
        """The picture of this number, which shows this frame, as `Yuv` has it."""
        pixels = self.painter.pixels(frame)
        if self._frames:
            _save_png(upright(pixels), self._frames / f"frame-{number:05d}.png")
        return self._yuv.of(pixels)


def _draw_here(trajectory, render, size, shown: Sequence[int], _processes, frames=None) -> Iterator[np.ndarray]:
    drawing = _Drawing(trajectory, render, size, frames)
    with drawing.painter:
        for number, index in enumerate(shown):
            yield drawing.picture(number, int(index))


def _draw_apart(trajectory, render, size, shown: Sequence[int], processes: int, frames=None) -> Iterator[np.ndarray]:
    """Pictures in order, drawn by several processes that are a few pictures ahead."""
    from .camera import action_of

    task = (trajectory.path.absolute(), render, size, frames and Path(frames).absolute(), action_of(trajectory))
    # Software OpenGL starts as many threads per process as there are cores.
    threads = {"LP_NUM_THREADS": str(max(1, cores() // processes))}
    ahead: deque = deque()
    with Workers(processes, begin=(_begin_worker, task), more=threads) as workers:
        try:
            for number, index in enumerate(shown):
                ahead.append(workers.submit(_draw_in_worker, number, int(index)))
                if len(ahead) > 2 * processes:
                    yield ahead.popleft().result()
            while ahead:
                yield ahead.popleft().result()
        except ChildLost:
            raise SetupError(
                "a process that draws pictures was killed, perhaps because memory ran out; what it printed stands above. "
                "The frames are kept: render again, perhaps with a smaller --size"
            ) from None


_worker: dict = {}
"""State of a process that draws: its task, and what draws once there is one."""


def _begin_worker(task: tuple) -> None:
    _worker["task"] = task


def _draw_in_worker(number: int, frame: int) -> np.ndarray:
    if "drawing" not in _worker:
        path, *task = _worker["task"]
        _worker["drawing"] = _Drawing(Trajectory(path), *task)
    return _worker["drawing"].picture(number, frame)


# --- writing ----------------------------------------------------------------------------------------------


def _save_png(picture: np.ndarray, path: Path) -> None:
    from PIL import Image
    from PIL.PngImagePlugin import PngInfo

    with disk_errors(path):
        path.parent.mkdir(parents=True, exist_ok=True)
    words = PngInfo()
    words.add_text("Software", MADE)
    write_whole(path, lambda part: Image.fromarray(picture).save(part, format="png", compress_level=4, pnginfo=words))
