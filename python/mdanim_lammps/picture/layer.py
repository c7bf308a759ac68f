# SPDX-License-Identifier: GPL-2.0-only
"""A transparent layer of lines and words that is laid over pictures, drawn by matplotlib's own rasteriser."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from .plot import own_style

Color = tuple[float, float, float]
"""Red, green, blue from 0 to 1."""
HEAD, HALF = 3.2, 0.42
"""Length of an arrow's head over the width of its shaft, and half of its width over its length."""


class InkLayer:
    """A layer of the size of a picture; places are pixels, counted from the lower left corner.

    Args:
        size: width and height in pixels.
        letters: height of letters in pixels.
        dark: whether what is below is dark.
    """

    def __init__(self, size: tuple[int, int], letters: float, dark: bool):
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        self.size, self.letters = size, letters
        self.ink: Color = (0.95, 0.96, 0.97) if dark else (0.13, 0.16, 0.20)
        self.paper: Color = (0.12, 0.14, 0.17) if dark else (1.0, 1.0, 1.0)
        with own_style():
            # A point is a pixel at 72 of them per inch.
            self.figure = Figure(figsize=(size[0] / 72.0, size[1] / 72.0), dpi=72)
        self.figure.patch.set_alpha(0.0)
        self._canvas = FigureCanvasAgg(self.figure)
        self._still: Any = None
        self._moving: list[Any] = []

    def add(self, artist: Any) -> None:
        """Draw something, in pixels, in this picture alone."""
        artist.set_figure(self.figure)
        self._moving.append(artist)

    def lay_on(self, picture: np.ndarray) -> None:
        """Lay all that was added over a picture, uint8 RGBA, shape (height, width, 4), first row below, and forget it; axes of
        ``figure`` stay."""
        with own_style():
            if self._still is None:
                self._canvas.draw()
                self._still = self._canvas.copy_from_bbox(self.figure.bbox)
            self._canvas.restore_region(self._still)
            renderer = self._canvas.get_renderer()
            for artist in sorted(self._moving, key=lambda one: one.get_zorder()):
                artist.draw(renderer)
        self._moving.clear()
        drawn = np.asarray(self._canvas.buffer_rgba())[::-1]
        here = np.nonzero(drawn[..., 3])
        above = drawn[here].astype(np.uint16)
        cover = above[:, 3:]
        picture[here] = (above * cover + picture[here] * (255 - cover) + 127) // 255
        picture[..., 3][here] = 255

    # --- what can be added ----------------------------------------------------------------------------------------------

    def words(self, at: Sequence[float], text: str, *, size: float = 1.0, color: Color | None = None, **more: Any) -> None:
        """Words with an outline of the paper's colour; ``size`` over that of letters."""
        from matplotlib.patheffects import withStroke
        from matplotlib.text import Text

        own = {"fontsize": size * self.letters, "color": color or self.ink, "ha": "left", "va": "center", "zorder": 5} | more
        drawn = Text(float(at[0]), float(at[1]), text, parse_math=False, **own)
        drawn.set_path_effects([withStroke(linewidth=0.25 * self.letters, foreground=(*self.paper, 0.85))])
        self.add(drawn)

    def line(self, points: np.ndarray, color: Color, width: float, alpha: float = 1.0, zorder: float = 2.0) -> None:
        """A line through points, shape (P, 2)."""
        from matplotlib.lines import Line2D

        own = {"color": color, "linewidth": width, "alpha": alpha, "zorder": zorder, "solid_capstyle": "round"}
        self.add(Line2D(points[:, 0], points[:, 1], **own))

    def fading(self, points: np.ndarray, color: Color, width: float, strength: np.ndarray) -> None:
        """A line whose pieces have a strength each, from 0 to 1, shape (P - 1,)."""
        from matplotlib.collections import LineCollection

        pieces = np.stack([points[:-1], points[1:]], axis=1)
        colors = np.column_stack([np.tile(color, (len(pieces), 1)), strength])
        self.add(LineCollection(pieces, colors=colors, linewidths=width, capstyle="butt", zorder=1.5))

    def arrow(self, begin: np.ndarray, end: np.ndarray, color: Color, width: float) -> None:
        """An arrow with an outline; one that is shorter than its head is a smaller head."""
        from matplotlib.patches import Polygon

        way = end - begin
        length = float(np.hypot(*way))
        if not length > 1.0:
            return
        ahead = way / length
        across = np.array([-ahead[1], ahead[0]])
        head = min(HEAD * width, length)
        neck, half = end - head * ahead, 0.5 * width * min(1.0, length / (HEAD * width))
        wing = HALF * head
        corners = [begin + half * across, neck + half * across, neck + wing * across, end]
        corners += [neck - wing * across, neck - half * across, begin - half * across]
        look = {"facecolor": color, "edgecolor": (*self.paper, 0.9), "linewidth": 0.3 * width, "joinstyle": "round"}
        self.add(Polygon(np.array(corners), closed=True, zorder=3.0, **look))

    def box(self, at: Sequence[float], size: Sequence[float], color: Color, alpha: float, zorder: float = 1.0) -> None:
        """A filled rectangle."""
        from matplotlib.patches import Rectangle

        self.add(Rectangle((at[0], at[1]), *size, facecolor=color, alpha=alpha, edgecolor="none", zorder=zorder))

    def image(self, at: Sequence[float], size: Sequence[int], colors: Iterable[Color]) -> None:
        """An upright bar of colours, the first one below."""
        rows = list(colors)
        for n, color in enumerate(rows):
            self.box((at[0], at[1] + n * size[1] / len(rows)), (size[0], size[1] / len(rows) + 1.0), color, 1.0)
