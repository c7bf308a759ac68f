# SPDX-License-Identifier: GPL-2.0-only
"""Words in a picture, over all else."""

from __future__ import annotations

from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from .window import lay_over

VTK_FONT_FILE = 4
"""VTK's number for letters from a file."""


@lru_cache(maxsize=1)
def letters_file() -> Path:
    """The letters of curves and arrows, which come with matplotlib: those of VTK have an equals sign of one line where they are
    small."""
    return Path(find_spec("matplotlib").origin).parent / "mpl-data" / "fonts" / "ttf" / "DejaVuSans.ttf"


class Label:
    """Words that are laid over pictures.

    Args:
        at: pixel of the lower left corner, or of the lower right one; rows are counted from below.
        height: of a letter in pixels.
        color: red, green, blue from 0 to 1.
        right: whether ``at`` is on the right.
        halo: whether letters have a bright rim, or a dark one around bright letters, for what is not of one colour below them.
    """

    OPACITY, RIM = 0.85, 0.7

    def __init__(
        self, at: tuple[int, int], height: int, color: tuple[float, float, float], right: bool = False, halo: bool = False
    ):
        from vtkmodules.vtkRenderingCore import vtkTextProperty

        self._at, self._words = at, ""
        self._rim = max(1, round(0.1 * height)) if halo else 0
        self._paper = 255 if sum(color) < 1.5 else 0
        self._drawn, self._origin = np.zeros((0, 0, 4), np.uint8), (0, 0)
        self._look = vtkTextProperty()
        self._look.SetFontFamily(VTK_FONT_FILE)
        self._look.SetFontFile(str(letters_file()))
        self._look.SetFontSize(max(9, height))
        self._look.SetColor(color)
        self._look.SetOpacity(1.0 if halo else self.OPACITY)
        self._look.SetJustificationToRight() if right else self._look.SetJustificationToLeft()

    def lay_on(self, picture: np.ndarray, words: str) -> None:
        """Lay words over a picture, uint8 RGBA, shape (height, width, 4), first row below; what reaches out of it is cut."""
        if words != self._words:
            self._words = words
            self._draw()
        rows, columns = self._drawn.shape[:2]
        left, bottom = (a + b for a, b in zip(self._at, self._origin))
        x, y = max(0, left), max(0, bottom)
        right, top = min(picture.shape[1], left + columns), min(picture.shape[0], bottom + rows)
        if right > x and top > y:
            drawn = self._drawn[y - bottom : top - bottom, x - left : right - left]
            lay_over(picture[y:top, x:right], np.ascontiguousarray(drawn))

    def _draw(self) -> None:
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkCommonDataModel import vtkImageData
        from vtkmodules.vtkRenderingCore import vtkTextRenderer

        image, size = vtkImageData(), [0, 0]
        if not self._words.strip() or not vtkTextRenderer.GetInstance().RenderString(self._look, self._words, image, size, 72):
            self._drawn = np.zeros((0, 0, 4), np.uint8)
            return
        x0, x1, y0, y1, _, _ = image.GetExtent()
        drawn = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(y1 - y0 + 1, x1 - x0 + 1, 4)
        drawn = drawn[: size[1], : size[0]] if size[0] else drawn
        cover = drawn[..., 3:].astype(np.uint16)
        self._drawn = np.concatenate([(drawn[..., :3] * cover + 127) // 255, cover], axis=2).astype(np.uint8)
        self._origin = (x0 - self._rim, y0 - self._rim)
        if self._rim:
            self._drawn = self._with_rim(self._drawn)

    def _with_rim(self, drawn: np.ndarray) -> np.ndarray:
        """Letters over what is within a few pixels of them, uint8 RGBA, larger by these on each side."""
        k = self._rim
        drawn = np.pad(drawn, ((k, k), (k, k), (0, 0)))
        wide = np.pad(drawn[..., 3], k)
        rows, columns = drawn.shape[:2]
        disc = [(y, x) for y in range(-k, k + 1) for x in range(-k, k + 1) if x * x + y * y <= k * k + 1]
        around = self.RIM * np.max([wide[k + y : k + y + rows, k + x : k + x + columns] for y, x in disc], axis=0)
        left = around * (1.0 - drawn[..., 3] / 255.0)
        rim = np.stack([*3 * [left * self._paper / 255.0], left], axis=2)
        return np.minimum(drawn + np.rint(rim), 255).astype(np.uint8)
