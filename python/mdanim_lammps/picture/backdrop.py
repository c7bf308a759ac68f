# SPDX-License-Identifier: GPL-2.0-only
"""Background and floor, which have no edges: drawn with one sample for each pixel, and only where they change."""

from __future__ import annotations

from contextlib import nullcontext

import numpy as np

from .floor import FloorPlane
from .framing import PicturePart, aim, part_around, whole
from .lens import View
from .window import off_screen_window, rgba


class Backdrop:
    """Pictures of background and floor behind everything else.

    Args:
        size: width and height of pictures in pixels.
        background: red, green, blue of the background below and above.
        floor: what is drawn before it; None for no floor.
        still: whether the camera never moves.
        everywhere: whether all of the floor may change, and not only what is in shadow.
        cover: hides what of the floor is never seen; None for nothing.
    """

    def __init__(
        self,
        size: tuple[int, int],
        background: tuple[np.ndarray, np.ndarray],
        floor: FloorPlane | None,
        still: bool,
        everywhere: bool,
        cover=None,
    ):
        from vtkmodules.vtkRenderingCore import vtkRenderer

        self._size, self._background, self._floor = size, background, floor
        self._still, self._everywhere = still, everywhere
        self._renderer = vtkRenderer()
        self._renderer.GradientBackgroundOn()
        if floor:
            if cover:
                self._renderer.AddActor(cover)
            self._renderer.AddActor(floor.actor)
        self._window = off_screen_window([self._renderer], size, samples=0)
        self._lit: np.ndarray | None = None

    def picture(self, view: View, shade, changing: np.ndarray) -> np.ndarray:
        """The picture, uint8 RGBA, shape (height, width, 4), first row below.

        Args:
            view: where the camera is.
            shade: `FloorShade` of the floor; None without one.
            changing: places around which the floor looks other than in full light [m], shape (P, 3), besides shadows.
        """
        if self._floor and (not self._still or self._everywhere):
            return self._draw(view, whole(self._size)).copy()
        if self._lit is None:
            with shade.lifted() if shade else nullcontext():
                self._lit = self._draw(view, whole(self._size)).copy()
        found = self._lit.copy()
        if self._floor and shade:
            part = part_around(view, self._size, np.concatenate([shade.corners, changing]))
            if all(part.size):
                part.of(found)[:] = self._draw(view, part)
        return found

    def _draw(self, view: View, part: PicturePart) -> np.ndarray:
        low, high = self._background
        bottom, top = (low + (high - low) * row / self._size[1] for row in (part.bottom, part.top))
        self._renderer.SetBackground(bottom)
        self._renderer.SetBackground2(top)
        self._renderer.SetGradientBackground(not (self._floor and self._floor.covers(view, self._size)))
        aim(self._renderer.GetActiveCamera(), view, self._size, part)
        self._renderer.ResetCameraClippingRange()
        if self._floor:
            self._floor.start_at(part.bottom)
        self._window.SetSize(*part.size)
        self._window.Render()
        return rgba(self._window)

    def close(self) -> None:
        """Release the window."""
        self._window.Finalize()
