# SPDX-License-Identifier: GPL-2.0-only
"""Movies and stills of a trajectory; a movie lasts as long as what it shows."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from fractions import Fraction
from pathlib import Path

import numpy as np

from ..errors import MdanimError, OutputError, SetupError
from ..results.trajectory import Trajectory
from ..scene.scene import Render

FRAMES_PER_PROCESS = 40
"""A process takes about two seconds to start; with fewer frames than this it does not pay."""


def render_still(
    trajectory: Trajectory | str | Path,
    frame: int,
    path: str | Path,
    render: Render = Render(),
    *,
    size: tuple[int, int] | None = None,
) -> Path:
    """Draw one frame as a PNG file.

    Args:
        trajectory: an open trajectory, or the folder of a run.
        frame: its number; negative ones count from the end.
        path: file to write.
        render: the scene's ``render`` block.
        size: width and height in pixels, instead of ``render.size``.

    Raises:
        SetupError: this host cannot draw off screen.
        OutputError: the file cannot be written.
    """
    from .render import Painter

    if not isinstance(trajectory, Trajectory):
        with Trajectory(trajectory) as opened:
            return render_still(opened, frame, path, render, size=size)
    if not -len(trajectory) <= frame < len(trajectory):
        raise OutputError(f"{trajectory.path}: holds {len(trajectory)} frames, there is no frame {frame}")
    with Painter(trajectory, render, size=size) as painter:
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
    progress: Callable[[int, int], None] | None = None,
) -> Path:
    """Draw all frames as an H.264 movie (mp4, yuv420p) that runs at the speed of the simulated time.

    Args:
        trajectory: an open trajectory, or the folder of a run.
        render: the scene's ``render`` block.
        path: file to write; it appears when it is whole.
        size: width and height in pixels, instead of ``render.size``; odd ones grow by one, as H.264 asks.
        fps: pictures per second, instead of the trajectory's; the nearest frames are shown.
        processes: how many draw at the same time; None takes as many as pay on this host.
        frames: a folder; also write every picture there, as ``frame-00000.png`` and so on.
        progress: called with (pictures done, pictures in all) after each.

    Raises:
        SetupError: this host cannot draw off screen, or has no ffmpeg.
        OutputError: no frames, or the movie cannot be written.
    """
    if not isinstance(trajectory, Trajectory):
        with Trajectory(trajectory) as opened:
            return render_movie(opened, render, path, size=size, fps=fps, processes=processes, frames=frames, progress=progress)
    width, height = size or render.size
    size = (width + width % 2, height + height % 2)
    shown, rate = movie_frames(trajectory, fps)
    processes = processes or max(1, min(_cores(), len(shown) // FRAMES_PER_PROCESS))
    pictures = _draw_here if processes == 1 else _draw_apart
    with _encoder(Path(path), size, rate) as encode:
        for done, picture in enumerate(pictures(trajectory, render, size, shown, processes), start=1):
            encode(picture)
            if frames is not None:
                _save_png(picture, Path(frames) / f"frame-{done - 1:05d}.png")
            if progress is not None:
                progress(done, len(shown))
    return Path(path)


def movie_frames(trajectory: Trajectory, fps: float | None = None) -> tuple[np.ndarray, Fraction]:
    """Which frames a movie shows, one after the other, and how many a second.

    Args:
        trajectory: with at least one frame.
        fps: pictures per second; None takes every frame of the trajectory.

    Raises:
        OutputError: the trajectory is empty.
    """
    times = trajectory.times
    if not len(times):
        raise OutputError(f"{trajectory.path}: holds no frame, nothing can be drawn; resume the run first")
    if len(times) == 1:
        return np.zeros(1, dtype=int), _rate(fps or 30.0)
    own = (len(times) - 1) / (times[-1] - times[0])
    if fps is None:
        return np.arange(len(times)), _rate(own)
    # A picture that falls on the last frame but for rounding is shown.
    wanted = times[0] + np.arange(int((times[-1] - times[0]) * fps + 1e-6) + 1) / fps
    return np.clip(np.rint((wanted - times[0]) * own), 0, len(times) - 1).astype(int), _rate(fps)


def _cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _rate(fps: float) -> Fraction:
    return Fraction(fps).limit_denominator(1001)


# --- drawing ----------------------------------------------------------------------------------------------


def _draw_here(trajectory, render, size, shown: Sequence[int], _processes) -> Iterator[np.ndarray]:
    from .render import Painter

    with Painter(trajectory, render, size=size) as painter:
        for index in shown:
            yield painter.frame(int(index))


def _draw_apart(trajectory, render, size, shown: Sequence[int], processes: int) -> Iterator[np.ndarray]:
    """Every process draws each n-th picture; read in turn they come in order, and nobody runs far ahead."""
    from .camera import action_of

    action = action_of(trajectory)
    threads = max(1, _cores() // processes)
    # Software OpenGL would start as many threads per process as there are cores.
    environment = os.environ | {"LP_NUM_THREADS": str(threads), "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    workers = []
    try:
        for k in range(processes):
            worker = subprocess.Popen(
                [sys.executable, "-m", "mdanim_lammps.picture.worker"],
                env=environment,
                # A file, not a pipe: nobody reads it before the end.
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=(said := tempfile.TemporaryFile()),
            )
            worker.said = said
            workers.append(worker)
            task = (trajectory.path.absolute(), render, size, action, [int(i) for i in shown[k::processes]])
            worker.stdin.write(pickle.dumps(task))
            worker.stdin.close()
        width, height = size
        for turn in range(len(shown)):
            worker = workers[turn % processes]
            data = worker.stdout.read(width * height * 3)
            if len(data) < width * height * 3:
                raise _worker_error(worker)
            yield np.frombuffer(data, dtype=np.uint8).reshape(height, width, 3)
    finally:
        for worker in workers:
            worker.kill()
            worker.wait()
            worker.stdout.close()
            worker.said.close()


def _worker_error(worker: subprocess.Popen) -> MdanimError:
    code = worker.wait()
    worker.said.seek(0)
    said = worker.said.read().decode(errors="replace").strip().splitlines()
    reason = said[-1] if said else f"it ended with code {code}"
    return SetupError(f"a process that draws pictures failed: {reason}; `render --processes 1` shows more")


# --- writing ----------------------------------------------------------------------------------------------


@contextmanager
def _encoder(path: Path, size: tuple[int, int], rate: Fraction) -> Iterator[Callable[[np.ndarray], None]]:
    """Pipe pictures to ffmpeg; the movie gets its name at the end, an error leaves nothing behind."""
    part = path.with_name(path.name + ".part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        log = part.open("wb")
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror}; name another file or folder") from None
    log.close()
    ffmpeg = subprocess.Popen(
        [
            _ffmpeg(),
            "-loglevel",
            "error",
            "-y",
            "-f",
            "rawvideo",
            "-pix_fmt",
            "rgb24",
            "-s",
            f"{size[0]}x{size[1]}",
            "-r",
            str(rate),
            "-i",
            "-",
            "-an",
            "-vf",
            "scale=out_color_matrix=bt709:out_range=tv",
            "-c:v",
            "libx264",
            "-preset",
            "veryfast",
            "-crf",
            "17",
            "-pix_fmt",
            "yuv420p",
            "-colorspace",
            "bt709",
            "-color_primaries",
            "bt709",
            "-color_trc",
            "bt709",
            "-movflags",
            "+faststart",
            "-f",
            "mp4",
            str(part),
        ],
        stdin=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
    )

    def failed() -> OutputError:
        said = ffmpeg.stderr.read().decode(errors="replace").strip().splitlines()
        return OutputError(
            f"{path}: the movie cannot be written: {said[-1] if said else 'ffmpeg stopped'}; "
            "make room or name another file, then `render` again"
        )

    def encode(picture: np.ndarray) -> None:
        try:
            ffmpeg.stdin.write(picture)
        except OSError:
            raise failed() from None

    try:
        yield encode
        try:
            ffmpeg.stdin.close()
        except OSError:
            raise failed() from None
        if ffmpeg.wait():
            raise failed()
        os.replace(part, path)
    finally:
        ffmpeg.kill()
        ffmpeg.wait()
        ffmpeg.stderr.close()
        part.unlink(missing_ok=True)


def _ffmpeg() -> str:
    try:
        from imageio_ffmpeg import get_ffmpeg_exe

        return get_ffmpeg_exe()
    except (ImportError, RuntimeError) as error:
        raise SetupError(f"no ffmpeg for the movie ({error}); pip install imageio-ffmpeg, or run with --no-movie") from None


def _save_png(picture: np.ndarray, path: Path) -> None:
    from PIL import Image

    part = path.with_name(path.name + ".part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        Image.fromarray(picture).save(part, format="png", compress_level=4)
        os.replace(part, path)
    except OSError as error:
        with suppress(OSError):
            part.unlink()
        raise OutputError(f"{path}: cannot be written: {error.strerror or error}; make room or name another file") from None
