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


def lay_over(below: np.ndarray, above: np.ndarray) -> None:
    """Lay pixels, multiplied with what they cover, over others in place; both uint8 RGBA, shape (height, width, 4)."""
    cover = above[..., 3]
    full = cover == 255
    np.copyto(below.view(np.uint32), above.view(np.uint32), where=full[..., None])
    part = np.nonzero((cover > 0) & ~full)
    left = below[part].astype(np.uint16) * (255 - cover[part].astype(np.uint16))[:, None]
    below[part] = np.minimum(above[part] + (left + 127) // 255, 255)


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
