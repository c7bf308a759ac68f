# SPDX-License-Identifier: GPL-2.0-only
"""From drawn pictures to an H.264 movie."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from fractions import Fraction
from pathlib import Path

import numpy as np

from ..children import DEVNULL, PIPE, start
from ..errors import OutputError, SetupError
from ..processes import cores
from ..results.files import scratch, sync
from ..results.overwriting import MADE

INPUT = ("-f", "rawvideo", "-pix_fmt", "yuv420p")
BT709 = "range=tv:colorspace=bt709:color_primaries=bt709:color_trc=bt709"
OUTPUT = (
    *("-vf", f"setparams={BT709}", "-codec", "libx264", "-preset", "veryfast", "-subq", "1", "-crf", "17"),
    *("-movflags", "+faststart", "-metadata", f"comment={MADE}"),
)
"""H.264 that browsers and slides play."""
BAND = 32
"""Rows that are compared with those of the last picture at once."""
LUMA, BLUE, RED = (11966, 40254, 4064), (-6596, -22189, 28785), (28785, -26145, -2640)
"""Shares of red, green and blue in the three numbers of BT.709, whose range is 16 to 235 and 16 to 240, times 65536."""


class Yuv:
    """Pictures as the encoder takes them: brightness of each pixel, colours of each 2 x 2. Only what differs from the last
    picture is worked out."""

    def __init__(self) -> None:
        self._last = np.zeros((0, 0), np.uint32)
        self._planes = np.zeros(0, np.uint8)

    def of(self, picture: np.ndarray) -> np.ndarray:
        """One picture, uint8 RGBA, shape (height, width, 4) with even sides, first row below, as uint8 YUV 4:2:0, first row on
        top, shape (height * width * 3 / 2,); it is the caller's until the next one."""
        pixels = np.ascontiguousarray(picture).view(np.uint32)[..., 0]
        height, width = pixels.shape
        if pixels.shape != self._last.shape:
            self._last, self._planes = ~pixels, np.empty(height * width * 3 // 2, np.uint8)
        changed = pixels != self._last
        for bottom in range(0, height, BAND):
            rows = slice(bottom, min(bottom + BAND, height))
            across = np.flatnonzero(changed[rows].any(axis=0))
            if len(across):
                columns = slice(across[0] & ~1, (across[-1] | 1) + 1)
                self._last[rows, columns] = pixels[rows, columns]
                self._work_out(rows, columns)
        return self._planes

    def _work_out(self, rows: slice, columns: slice) -> None:
        height, width = self._last.shape
        luma = self._planes[: height * width].reshape(height, width)[::-1]
        colours = self._planes[height * width :].reshape(2, height // 2, width // 2)[:, ::-1]
        pixels = self._last[rows, columns]
        each = [pixels & 255, (pixels >> 8) & 255, (pixels >> 16) & 255]
        luma[rows, columns] = _mixed(each, LUMA, 16, 16)
        twice = [one[0::2] + one[1::2] for one in each]
        four = [(one[:, 0::2] + one[:, 1::2]).view(np.int32) for one in twice]
        place = slice(rows.start // 2, rows.stop // 2), slice(columns.start // 2, columns.stop // 2)
        for plane, shares in zip(colours, (BLUE, RED)):
            plane[place] = _mixed(four, shares, 128, 18)


def _mixed(each: list[np.ndarray], shares: tuple[int, int, int], middle: int, bits: int) -> np.ndarray:
    """Sum of shares of red, green and blue, over two to the power of ``bits``, and the middle, rounded."""
    total = shares[0] * each[0]
    for share, one in zip(shares[1:], each[1:]):
        total += share * one
    total += (middle << bits) + (1 << (bits - 1))
    total >>= bits
    return total


@contextmanager
def encoder(path: Path, size: tuple[int, int], rate: Fraction) -> Iterator[Callable[[np.ndarray], None]]:
    """Send pictures to ffmpeg, as `Yuv` gives them; the movie gets its name at the end, an error leaves nothing."""
    try:
        import imageio_ffmpeg

        program = imageio_ffmpeg.get_ffmpeg_exe()
    except (ImportError, RuntimeError) as error:
        raise SetupError(f"no ffmpeg for the movie ({error}); pip install imageio-ffmpeg, or run with --no-movie") from None
    with ExitStack() as stack:
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            part = stack.enter_context(scratch(path.parent, "movie")) / "movie.mp4"
        except OSError as error:
            raise OutputError(f"{path}: cannot be written: {error.strerror}; name another file or folder") from None
        said = stack.enter_context(tempfile.TemporaryFile())
        of_input = (*INPUT, "-s", f"{size[0]}x{size[1]}", "-r", str(rate), "-i", "-")
        # With more threads the same pictures take more processor time: 15 ms each in place of 11.
        command = [program, "-y", "-loglevel", "error", *of_input, *OUTPUT, "-threads", str(max(1, cores() // 2)), str(part)]
        child = start(command, text=False, stdin=PIPE, stdout=DEVNULL, stderr=said, start_new_session=True)
        stack.callback(child.wait)
        stack.callback(child.kill)

        def failed() -> OutputError:
            child.wait()
            said.seek(0)
            words = said.read().decode(errors="replace").strip().splitlines()
            return OutputError(
                f"{path}: the movie cannot be written: {words[-1] if words else 'ffmpeg stopped'}; "
                "make room or name another file, then `render` again"
            )

        def encode(picture: np.ndarray) -> None:
            try:
                child.stdin.write(picture)
            except OSError:
                raise failed() from None

        yield encode
        try:
            child.stdin.close()
            if child.wait():
                raise failed()
            sync(part)
            os.replace(part, path)
        except OSError:
            raise failed() from None
