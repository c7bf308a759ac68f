# SPDX-License-Identifier: GPL-2.0-only
"""Panels of curves that grow with a film, one for each unit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..records import dataclass
from ..scene.quantities import Asked
from .layer import Color, InkLayer
from .palette import is_dark, luminance
from .plot import own_style, span_of
from .run_values import RunValues

WIDTH, MARGIN, GAP = 0.36, 0.02, 0.02
"""Width of a panel and its distance from the edges, in parts of the picture's width; from the next one, of its height."""
COVERED = WIDTH + MARGIN
"""Part of a picture's width that panels cover."""
HEIGHTS = (0.36, 0.31, 0.265)
"""Height of a panel where there is one, and where there are more, in parts of the picture's height."""
CURVES: tuple[Color, ...] = (
    (0.12, 0.47, 0.71), (0.84, 0.15, 0.16), (0.17, 0.55, 0.17), (0.58, 0.40, 0.74), (0.90, 0.50, 0.05), (0.45, 0.34, 0.29),
)  # fmt: skip
THIN, LETTER = 0.16, 0.62
"""Width of the topmost curve, and of a letter on average, over the height of letters."""
SMALLER, LINE = 0.91, 1.25
"""Height of letters of names, where they would not fit into a line, and of a line, over that of letters."""
COVERED_BY_NAMES = 0.5
"""Height of names in several lines, at most, over that of a panel."""
BRIGHTEST = 0.42
"""Luminance of curves at most on bright paper; on dark paper 1 less this is the least."""
PALE = 0.35
"""Opacity of the curves of a run beside the one that is drawn."""


def covered(plots: Sequence[Asked], aspect: float) -> tuple[float, float]:
    """Parts of a picture's width and height that panels of these quantities cover, from its upper right corner; ``aspect`` is
    width over height."""
    count = len({of.unit for of in plots})
    if not count:
        return 0.0, 0.0
    return COVERED, MARGIN * aspect + count * HEIGHTS[min(count, len(HEIGHTS)) - 1] + (count - 1) * GAP


@dataclass(frozen=True)
class _Curve:
    """A quantity over time."""

    of: Asked
    times: np.ndarray
    """Times of the frames [s], shape (F,)."""
    values: np.ndarray
    """shape (F,)."""
    is_mean: bool
    """Whether a value holds since the frame before."""

    def until(self, time: float) -> tuple[np.ndarray, np.ndarray]:
        """Its points up to a time [s]."""
        count = int(np.searchsorted(self.times, time * (1 + 1e-9), side="right"))
        t, y = self.times[:count], self.values[:count]
        return (np.repeat(t, 2)[1:-1], np.repeat(y[1:], 2)) if self.is_mean else (t, y)


class Curves:
    """Panels of curves in the upper right corner of a layer.

    Args:
        layer: where they are drawn.
        plots: the quantities.
        runs: their values in the run that is drawn, and in a run beside it, whose curves are pale.
        of_objects: colours of objects by their names.
    """

    def __init__(self, layer: InkLayer, plots: Sequence[Asked], runs: Sequence[RunValues], of_objects: Mapping[str, Color]):
        self._layer, self._of_objects = layer, of_objects
        self._end = max(run.end for run in runs)
        panels: dict[str, list[list[_Curve]]] = {}
        for of in plots:
            curves = [_Curve(of, run.times, run.series(of), run.is_mean(of)) for run in runs]
            panels.setdefault(of.unit, []).append(curves)
        self._curves: list[tuple[Any, _Curve, Color, float, bool]] = []
        with own_style():
            for n, (unit, curves) in enumerate(panels.items()):
                self._panel(n, HEIGHTS[min(len(panels), len(HEIGHTS)) - 1], unit, curves)

    def _panel(self, n: int, share: float, unit: str, curves: list[list[_Curve]]) -> None:
        layer, (width, height) = self._layer, self._layer.size
        letters = layer.letters
        left, top = 1.0 - WIDTH - MARGIN, 1.0 - MARGIN * width / height - n * (share + GAP)
        ground = layer.figure.add_axes((left, top - share, WIDTH, share), facecolor=(*layer.paper, 0.78))
        ground.set_xticks([])
        ground.set_yticks([])
        for side in ground.spines.values():
            side.set_color((*layer.ink, 0.25))
        names = [both[0].of for both in curves]
        colors = tints([of.subject for of in names], self._of_objects, layer.paper, n)
        above = self._names(ground, names, colors, unit, (WIDTH * width, share * height))
        # Room for numbers at the left and below, for names above.
        inner = (left + 4.4 * letters / width, top - share + 1.9 * letters / height)
        size = (left + WIDTH - 0.9 * letters / width - inner[0], top - above / height - inner[1])
        axes = layer.figure.add_axes((*inner, *size), facecolor="none")
        low, high = span_of([one.values for both in curves for one in both], unit)
        axes.set_xlim(0.0, self._end)
        axes.set_ylim(low, high)
        axes.locator_params(axis="x", nbins=5)
        axes.locator_params(axis="y", nbins=4)
        lines = {"length": 0.3 * letters, "width": 0.08 * letters, "pad": 0.25 * letters}
        axes.tick_params(labelsize=0.9 * letters, colors=layer.ink, **lines)
        axes.ticklabel_format(useOffset=False)
        axes.yaxis.get_offset_text().set_fontsize(0.8 * letters)
        axes.grid(True, color=(*layer.ink, 0.15), linewidth=0.07 * letters)
        for word, side in axes.spines.items():
            side.set_color((*layer.ink, 0.6))
            side.set_linewidth(0.09 * letters)
            side.set_visible(word in ("left", "bottom"))
        time = {"fontsize": 0.9 * letters, "color": layer.ink, "ha": "left", "va": "bottom"}
        corner = 0.35 * letters / (WIDTH * width), 0.35 * letters / (share * height)
        ground.text(*corner, "t [s]", transform=ground.transAxes, **time)
        for k, (color, both) in enumerate(zip(colors, curves)):
            # Curves below are wider, so that all are seen where they lie on each other.
            width = THIN * (1.0 + 0.9 * (len(curves) - 1 - k))
            self._curves += [(axes, one, color, width, beside) for beside, one in enumerate(both)]

    def _names(self, ground: Any, names: list[Asked], colors: list[Color], unit: str, panel: tuple[float, float]) -> float:
        """Draw the names of the curves in their colours, the unit behind the last one; all that they have in common stands once.
        Those that do not fit into the width of the ``panel``, (width, height) [pixels], go on in the next line; they are smaller
        where it has no room for these. Returns the height that they take [pixels]."""
        from matplotlib.offsetbox import AnchoredOffsetbox, HPacker, TextArea, VPacker

        common = len(names) > 1 and len({(of.quantity, of.argument) for of in names}) == 1
        words = [of.subject if common else of.what for of in names]
        plain = {"color": self._layer.ink, "fontweight": "bold"}
        row = [(f"{names[0].quantity}", plain)] if common else []
        row += [(word, {"color": color, "fontweight": "bold"}) for word, color in zip(words, colors)]
        row += [(f"[{unit}]", {"color": self._layer.ink})] if unit else []
        letters, lengths = self._layer.letters, [len(word) + 1 for word, _ in row]
        room, size = panel[0] - letters, letters
        most = 1 + max(0, int((COVERED_BY_NAMES * panel[1] - 1.9 * letters) / (LINE * letters)))
        lines = in_lines(lengths, room / (LETTER * size))
        while len(lines) > 1 and (size > SMALLER * letters or len(lines) > most):
            size *= SMALLER
            lines = in_lines(lengths, room / (LETTER * size))
        sizes = [min(size, room / (LETTER * sum(lengths[line]))) for line in lines]
        boxes = [
            [TextArea(word, textprops=look | {"fontsize": own}) for word, look in row[line]] for line, own in zip(lines, sizes)
        ]
        packed = VPacker(children=[HPacker(children=line, pad=0, sep=0.7 * size) for line in boxes], pad=0, sep=0.25 * size)
        ground.add_artist(AnchoredOffsetbox("upper left", child=packed, frameon=False, pad=0.0, borderpad=0.35))
        return (1.9 + LINE * (len(lines) - 1)) * letters

    def show(self, time: float) -> None:
        """Add the curves up to a time [s], with a point where they are then."""
        from matplotlib.lines import Line2D

        letters = self._layer.letters
        for axes, curve, color, width, beside in self._curves:
            pixels = axes.transData.transform(np.column_stack(curve.until(time)))
            pixels = pixels[np.isfinite(pixels).all(axis=1)]
            look = {"color": color, "alpha": PALE if beside else 1.0, "zorder": 3.9 if beside else 4.0}
            self._layer.add(Line2D(*pixels.T, linewidth=width * letters, solid_capstyle="round", **look))
            if len(pixels) and not beside:
                size = (0.35 + width) * letters
                self._layer.add(Line2D(*pixels[-1:].T, marker="o", markersize=size, markeredgewidth=0, linestyle="", **look))


def in_lines(lengths: Sequence[int], most: float) -> list[slice]:
    """Words of these lengths one after the other, in lines that are no longer than ``most`` or one word."""
    begins, used = [0], 0.0
    for n, length in enumerate(lengths):
        if used + length > most and n > begins[-1]:
            begins.append(n)
            used = 0.0
        used += length
    return [slice(*line) for line in zip(begins, [*begins[1:], len(lengths)])]


def tints(subjects: Sequence[str], of_objects: Mapping[str, Color], paper: Color, n: int = 0) -> list[Color]:
    """Colours of curves in the n-th panel: those of their objects where no two have the same, else some that differ."""
    own = [of_objects.get(subject) for subject in subjects]
    if None not in own and len(set(own)) == len(own):
        return [_legible(color, paper) for color in own if color is not None]
    return [CURVES[(n + k) % len(CURVES)] for k in range(len(subjects))]


def _legible(color: Color, paper: Color) -> Color:
    """A colour that stands out from the paper: darker where the paper is bright, brighter where it is dark."""
    bright = luminance(np.array(color))
    if is_dark(np.array(paper)):
        return tuple(x + (1.0 - x) * max(0.0, (1.0 - BRIGHTEST - bright) / (1.0 - bright)) for x in color)
    return tuple(x * min(1.0, BRIGHTEST / max(bright, 1e-9)) for x in color)
