# SPDX-License-Identifier: GPL-2.0-only
"""Windows that are never on a screen, and the pixels in them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager

import numpy as np

from ..errors import SetupError


def off_screen_window(renderers: Iterable, size: tuple[int, int], samples: int, clear: bool = False):
    """A window of this size [pixels] with ``samples`` samples for each pixel; ``clear``: it tells how much is covered. Raises
    SetupError that names the missing library."""
    from vtkmodules.vtkRenderingCore import vtkRenderWindow

    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetSize(*size)
    window.SetMultiSamples(samples)
    window.SetAlphaBitPlanes(clear)
    # Pictures are read from the buffer that is drawn into; the other one is not used.
    window.SwapBuffersOff()
    for renderer in renderers:
        window.SetNumberOfLayers(max(window.GetNumberOfLayers(), renderer.GetLayer() + 1))
        window.AddRenderer(renderer)
    window.Initialize()
    if not window.SupportsOpenGL():
        raise SetupError(
            f"pictures need OpenGL 3.2, and {window.GetClassName()} found none on this host; install Mesa "
            "(Debian: apt install libegl1 libosmesa6), or run with --no-movie and render the folder elsewhere"
        )
    return window


def rgba(window) -> np.ndarray:
    """The drawn picture with how much of each pixel is covered, uint8, shape (height, width, 4), first row below."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkUnsignedCharArray

    width, height = window.GetSize()
    data = vtkUnsignedCharArray()
    window.GetRGBACharPixelData(0, 0, width - 1, height - 1, 0, data, 0)
    return vtk_to_numpy(data).reshape(height, width, 4)


PAIR, ONES = np.uint32(0x00FF00FF), np.uint32(0x00010001)
"""Two of the four numbers of a pixel, and one in each of these."""


def lay_over(below: np.ndarray, above: np.ndarray) -> None:
    """Lay pixels, multiplied with what they cover, over others in place; both uint8 RGBA, shape (height, width, 4)."""
    below_, above_ = below.view(np.uint32)[..., 0], above.view(np.uint32)[..., 0]
    cover = above[..., 3]
    np.copyto(below_, above_, where=cover == 255)
    part = (cover > 0) & (cover < 255)
    under, over = below_[part], above_[part]
    left = 255 - (over >> 24)
    # Two numbers of a pixel at once, each in half of 32 bits; a sum and what it is over 256 make a division by 255.
    laid = []
    for shift in (0, 8):
        rest = ((under >> shift) & PAIR) * left + 127 * ONES
        both = ((over >> shift) & PAIR) + (((rest + ONES + ((rest >> 8) & PAIR)) >> 8) & PAIR)
        laid.append((both | ((both >> 8) & ONES) * 255) & PAIR)
    below_[part] = laid[0] | (laid[1] << 8)


def upright(picture: np.ndarray) -> np.ndarray:
    """Uint8 RGB, first row on top, of a picture as `rgba` gives it."""
    found = np.empty((*picture.shape[:2], 3), np.uint8)
    for channel in range(3):  # a channel at once takes a quarter of the time
        found[..., channel] = picture[::-1, :, channel]
    return found


def fewer_pixels(picture: np.ndarray, by: int) -> np.ndarray:
    """One pixel for each ``by`` x ``by`` of them, their mean; uint8, shape (height, width, C)."""
    if by == 1:
        return picture
    height, width, colors = picture.shape
    total = np.full((height // by, width // by, colors), by * by // 2, dtype=np.uint16)
    for row in range(by):
        for column in range(by):
            total += picture[row::by, column::by]
    return (total // (by * by)).astype(np.uint8)


@contextmanager
def silent() -> Iterator[None]:
    """Silence VTK's message that there is no X server, which off-screen drawing does not need."""
    from vtkmodules.vtkCommonCore import vtkLogger

    before = vtkLogger.GetCurrentVerbosityCutoff()
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    try:
        yield
    finally:
        vtkLogger.SetStderrVerbosity(before)


def main() -> None:
    """Draw something, and print by which OpenGL."""
    import vtkmodules.vtkRenderingOpenGL2  # noqa: F401 - what draws
    from vtkmodules.vtkRenderingCore import vtkRenderer

    with silent():
        window = off_screen_window([vtkRenderer()], (8, 8), 0)
        window.Render()
    wanted = ("OpenGL version string", "OpenGL renderer string")
    said = [line.split(":")[1].strip() for line in window.ReportCapabilities().splitlines() if line.startswith(wanted)]
    print(", ".join(said))
