# SPDX-License-Identifier: GPL-2.0-only
"""Everything that is laid over a picture to tell what happens: arrows with their legend, trails, labels, captions, curves."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from ..records import dataclass
from ..results.trajectory import Trajectory
from ..scene.formatting import number
from ..scene.naming import labelled, objects_by_name
from ..scene.quantities import QUANTITIES
from ..scene.render import Render
from ..scene.shown import Arrows
from .camera import Action, corners
from .curves import Curves, covered
from .framing import pixels_per_metre, seen_at
from .layer import Color, InkLayer
from .lens import Reserved, View
from .run_values import RunValues
from .tones import Tones

LETTERS, SMALLEST, LARGEST = 0.028, 11.0, 0.055
"""Height of letters over that of a picture, the least [pixels], and the most of a small picture."""
WORDS = {False: 0.016, True: 0.075}
"""Share of the height that words below a picture take beyond the margin, without and with captions."""
BAR, ROW, MOST_ROOM = 7.5, 1.5, 0.16
"""Width of a scale of colours with its numbers, and height of a row of the legend, over that of letters; the most of a picture
that each of them is given."""
BESIDE, WIDTH = 0.4, 0.65
"""Distance of words from their object, and width of a bold letter, over the height of letters."""
LOOKS, FEWER = 12, 0.8
"""Moments of a run at which words are tried on both sides of their object, and the share of what they cover on the right below
which they stand on the left."""
APART = 1.2
"""Distance of words one above the other, at least, over the height of letters."""
FARTHEST = 3.0
"""Way of words from the height of their object, at most, over that distance: further away they would seem those of another."""
LEGEND = 4.5
"""Length of an arrow of the legend over that of letters, at most."""
SEEN = 2.0
"""Length of the longest arrow of a line from which on the legend has its scale [pixels]."""
USUAL, AMONG = 0.14, 0.95
"""Length of an arrow over the size of the scene, that of the value that this share of all values does not exceed."""
NOTHING = 1e-9
"""Values below this share of the largest have no arrow."""
COLORS: dict[str, Color] = {
    "velocity": (0.11, 0.40, 0.75),
    "force": (0.20, 0.20, 0.20),
    "contact": (0.80, 0.12, 0.14),
    "weight": (0.12, 0.52, 0.20),
}
"""Colours of arrows; the others have these in turn."""
OTHERS: tuple[Color, ...] = ((0.49, 0.28, 0.68), (0.85, 0.45, 0.05), (0.00, 0.50, 0.52), (0.75, 0.25, 0.55))


def letters_of(size: tuple[int, int], finer: int = 1) -> float:
    """Height of letters in a picture of this size [pixels], where ``finer`` of these along each side are drawn for one of it."""
    return max(LETTERS * size[1], min(SMALLEST * finer, LARGEST * size[1]))


def room_for(render: Render, size: tuple[int, int]) -> Reserved:
    """Room in a picture of this size [pixels] for all that is laid over it at fixed places."""
    letters = letters_of(size)
    left = min(BAR * letters / size[0], MOST_ROOM) if render.color_by else 0.0
    above = min(ROW * len(render.arrows) * letters / size[1], MOST_ROOM)
    return Reserved(left, 0.0, above, WORDS[bool(render.caption)], covered(render.plot, size[0] / size[1]))


@dataclass(frozen=True)
class _Vectors:
    """Arrows of a line of the scene."""

    word: str
    color: Color
    objects: tuple[int, ...]
    values: np.ndarray
    """Values of these objects at all frames, in SI units, shape (F, n, 3)."""
    scale: float
    """Length over value [m per unit]."""

    @property
    def unit(self) -> str:
        return QUANTITIES["NAME", f"{self.word}.x"].unit


class Overlay:
    """Layer of everything that a scene has laid over its pictures.

    Args:
        runs: what is drawn, and a run beside it, whose values are on the same axes and scales, or None.
        render: the scene's ``render`` block.
        size: of a picture as it is drawn, in pixels.
        dark: whether the background is.
        action: where things happen in both.
        own: where they happen in what is drawn.
        tones: colours that tell a quantity; None for none.
        finer: pixels that are drawn for one of the picture, along each side.
        view_at: gives the camera at a time [s].
        colors: of objects, uint8, shape (O, 3).

    Raises:
        UsageError: a quantity that the run has not recorded.
        OutputError: its scene cannot be read here.
    """

    def __init__(
        self,
        runs: tuple[Trajectory, Trajectory | None],
        render: Render,
        size: tuple[int, int],
        dark: bool,
        action: Action,
        own: Action,
        tones: Tones | None,
        finer: int,
        view_at: Callable[[float], View],
        colors: np.ndarray,
    ):
        self._trajectory = trajectory = runs[0]
        self._render, self._size, self._action = render, size, action
        self._layer = InkLayer(size, letters_of(size, finer), dark)
        self._tones, names = tones, list(trajectory.names)
        self._of_name = objects_by_name(names) if render.trail or render.label else {}
        self._words = [(g, one.text) for one in render.label for g in labelled(self._of_name[one.name], names)]
        self._reach = [_reach(trajectory.centers[0, group]) for group, _ in self._words]
        self._colors = colors / 255.0
        self._on_left = self._labels_on_left(own, view_at)
        told = [RunValues(run) for run in runs if run is not None]
        lines = [_vectors(render.arrows, values) for values in told]
        every = [one for found in lines for one in found]
        self._vectors = [one if one.scale else replace(one, scale=_usual(one.unit, every, action)) for one in lines[0]]
        of_objects = dict(zip(names, map(tuple, self._colors)))
        self._curves = Curves(self._layer, render.plot, told, of_objects) if render.plot else None

    def lay_on(self, picture: np.ndarray, view: View, frame: int, position: np.ndarray, gone: np.ndarray | None) -> None:
        """Lay it over a picture of a frame, uint8 RGBA, shape (height, width, 4), first row below; ``position`` and ``gone`` are
        those of the frame in the trajectory."""
        self._trails(view, frame)
        self._arrows(view, frame)
        if self._render.label:
            skin = self._trajectory.metadata.skin
            self._labels(view, frame, *skin.boxes(skin.vertices(position, gone)))
        self._captions(float(self._trajectory.times[frame]))
        if self._curves:
            self._curves.show(float(self._trajectory.times[frame]))
        if self._tones:
            self._bar()
        self._layer.lay_on(picture)

    def _trails(self, view: View, frame: int) -> None:
        times = self._trajectory.times
        for one in self._render.trail:
            begin = -math.inf if one.time is None else times[frame] - one.time
            shown = np.flatnonzero(times[: frame + 1] >= begin - 1e-12)
            for m in self._of_name[one.name]:
                points, ahead = seen_at(view, self._size, self._trajectory.centers[shown, m])
                points = points[ahead]
                if len(points) > 1:
                    strength = np.linspace(0.25 if one.time is not None else 0.9, 0.9, len(points) - 1)
                    self._layer.fading(points, tuple(0.8 * self._colors[m]), 0.2 * self._layer.letters, strength)

    def _arrows(self, view: View, frame: int) -> None:
        centers, width = self._trajectory.centers[frame], 0.32 * self._layer.letters
        for one in self._vectors:
            way = one.scale * one.values[frame]
            begin, seen = seen_at(view, self._size, centers[list(one.objects)])
            end, also = seen_at(view, self._size, centers[list(one.objects)] + np.nan_to_num(way))
            for n in np.flatnonzero(seen & also & np.isfinite(way).all(axis=1)):
                self._layer.arrow(begin[n], end[n], one.color, width)
        self._legend(view, width)

    def _legend(self, view: View, width: float) -> None:
        """An arrow of a round value for each line, as long as it would be in the middle of the scene across the line of sight."""
        letters, left = self._layer.letters, 1.2 * self._layer.letters
        top = self._size[1] - 1.4 * letters
        pixels = pixels_per_metre(view, self._size, self._action.centre)
        values = [_round_value(LEGEND * letters / max(pixels * one.scale, 1e-300)) for one in self._vectors]
        seen = [np.nanmax(np.abs(one.values), initial=0.0) * one.scale * pixels >= SEEN for one in self._vectors]
        rows = [(one, value, value * one.scale * pixels * s) for one, value, s in zip(self._vectors, values, seen)]
        widest = max((length for _, _, length in rows), default=0.0)
        for n, (one, value, length) in enumerate(rows):
            y = top - n * ROW * letters
            if length:
                self._layer.arrow(np.array([left, y]), np.array([left + length, y]), one.color, width)
            words = f"{one.word}  {number(value)} {one.unit}" if length else f"{one.word}: too small to be seen"
            self._layer.words((left + widest + 0.7 * letters, y), words, color=one.color)

    def _room(self, y: float) -> float:
        """Width of the picture at a height without that of curves [pixels]."""
        width, height = self._size
        across, along = covered(self._render.plot, width / height)
        return width * (1.0 - across * (y > height * (1.0 - along) - self._layer.letters))

    def _labels_on_left(self, own: Action, view_at: Callable[[float], View]) -> set[int]:
        """Numbers of words that cover less of others that move, and of room for curves, on the left of their object than on the
        right, over the run."""
        letters, free, words = self._layer.letters, np.flatnonzero(own.free), self._words
        parts = np.array_split(self._trajectory.times, len(own.low))
        shown = np.unique(np.linspace(0, len(parts) - 1, LOOKS).astype(int))
        covered = np.zeros((2, len(words)))
        for k in shown if words else ():
            boxes = corners(own.low[k], own.high[k])
            points, _ = seen_at(view_at(float(parts[k].mean())), self._size, boxes)
            points = points.reshape(8, -1, 2)
            low, high = points.min(axis=0), points.max(axis=0)
            for n, (group, text) in enumerate(words):
                wide, y = WIDTH * letters * len(text), points[:, group, 1].mean()
                right, first = high[group, 0].max() + BESIDE * letters, low[group, 0].min() - BESIDE * letters
                for side, left in enumerate((right, first - wide)):
                    across = np.minimum(high[free, 0], left + wide) - np.maximum(low[free, 0], left)
                    along = np.minimum(high[free, 1], y + 0.5 * letters) - np.maximum(low[free, 1], y - 0.5 * letters)
                    out = max(0.0, left + wide - self._room(y)) + max(0.0, -left)
                    covered[side, n] += (np.clip(across, 0.0, None) * np.clip(along, 0.0, None)).sum() + out * letters
        return {n for n in range(len(words)) if covered[1, n] < FEWER * covered[0, n]}

    def _labels(self, view: View, frame: int, low: np.ndarray, high: np.ndarray) -> None:
        """Words beside the boxes of objects, whose corners are ``low`` and ``high`` [m], shape (O, 3); out of the way of curves
        and of each other."""
        corner, letters = np.array(np.unravel_index(np.arange(8), (2, 2, 2))).T, self._layer.letters
        placed: list[tuple[float, float, float]] = []
        for n, (group, text) in enumerate(self._words):
            near = np.array(group)[_near(self._trajectory.centers[frame, group], self._reach[n])]
            points, ahead = seen_at(view, self._size, np.where(corner, high[near].max(axis=0), low[near].min(axis=0)))
            if ahead.all():
                # Beside it: arrows often point up or down.
                left, beside, wide = n in self._on_left, BESIDE * letters, WIDTH * letters * len(text)
                x = points[:, 0].min() - beside if left else points[:, 0].max() + beside
                begin = max(0.5 * beside, min(x - wide if left else x, self._room(points[:, 1].mean()) - wide - 0.5 * beside))
                y = free_height(points[:, 1].mean(), begin, begin + wide, placed, APART * letters)
                placed.append((begin, begin + wide, y))
                self._layer.words((begin + wide if left else begin, y), text, fontweight="bold", ha="right" if left else "left")

    def _captions(self, time: float) -> None:
        hair = 1e-9 * float(self._trajectory.times[-1])
        begun = (c for c in self._render.caption if (c.begin or 0.0) - hair <= time)
        for n, one in enumerate(reversed([c for c in begun if c.end is None or time <= c.end + hair])):
            at = (0.5 * self._size[0], (0.1 + 0.06 * n) * self._size[1])
            self._layer.words(at, one.text, size=1.25, ha="center", fontweight="bold", zorder=6)

    def _bar(self) -> None:
        """The colours of a quantity, with the values at their ends."""
        letters, tones = self._layer.letters, self._tones
        size = (0.9 * letters, 9.0 * letters)
        at = (1.2 * letters, 0.5 * self._size[1] - 0.5 * size[1])
        self._layer.image(at, size, tones.bar())
        x = at[0] + size[0] + 0.5 * letters
        self._layer.words((x, at[1]), "0")
        self._layer.words((x, at[1] + size[1]), f"≥ {number(tones.most)} {tones.unit}".rstrip())
        self._layer.words((at[0], at[1] + size[1] + 1.5 * letters), tones.name, fontweight="bold")


def free_height(y: float, begin: float, end: float, placed: Sequence[tuple[float, float, float]], apart: float) -> float:
    """The height nearest to y at which words from ``begin`` to ``end`` are ``apart`` from others, each of which is from a begin
    to an end at a height; y where all are too far. Words that were placed first stay, so that none jump to and fro."""
    met, above, below = sorted(height for low, high, height in placed if low < end and begin < high), y, y
    for height in met:
        above = height + apart if abs(above - height) < (1.0 - 1e-9) * apart else above
    for height in reversed(met):
        below = height - apart if abs(below - height) < (1.0 - 1e-9) * apart else below
    found = above if above - y < y - below else below
    return found if abs(found - y) <= FARTHEST * apart else y


def _reach(centres: np.ndarray) -> float:
    """How far from the middle of all of these places [m], shape (n, 3), one of them is at most."""
    return float(np.linalg.norm(centres - np.median(centres, axis=0), axis=1).max())


def _near(centres: np.ndarray, reach: float) -> np.ndarray:
    """Places that are about as near the middle of all as while these hang together, bool, shape (n,); one at least."""
    away = np.linalg.norm(centres - np.median(centres, axis=0), axis=1)
    return away <= max(1.3 * reach, away.min())


def _vectors(lines: tuple[Arrows, ...], run: RunValues) -> list[_Vectors]:
    """The arrows of all lines; those without a scale of their own still have none."""
    names, found, words = run.trajectory.names, [], dict.fromkeys(one.vector for one in lines)
    others = iter(OTHERS * len(words))
    colors = {word: COLORS.get(word) or next(others) for word in words}
    for one in lines:
        objects = one.objects(names)
        values = np.stack([run.vector(names[m], one.vector) for m in objects], axis=1)
        shown = np.isfinite(values).all(axis=2).any(axis=0)
        if one.name is None:
            shown &= ~run.trajectory.metadata.still
        chosen = tuple(m for m, is_shown in zip(objects, shown) if is_shown)
        found.append(_Vectors(one.vector, colors[one.vector], chosen, values[:, shown], one.scale or 0.0))
    return found


def _usual(unit: str, all_of_them: list[_Vectors], action: Action) -> float:
    """Metres per unit that show all values of a unit well."""
    sizes = [np.linalg.norm(one.values, axis=2).ravel() for one in all_of_them if one.unit == unit and not one.scale]
    sizes = np.concatenate([np.zeros(0), *sizes])
    sizes = sizes[np.isfinite(sizes)]
    sizes = sizes[sizes > NOTHING * sizes.max(initial=0.0)]
    return USUAL * action.size / float(np.quantile(sizes, AMONG)) if len(sizes) else 1.0


def _round_value(value: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above a value."""
    if not value > 0.0:
        return 1.0
    power = 10.0 ** math.floor(math.log10(value))
    return power * max(k for k in (1.0, 2.0, 5.0) if k * power <= value * (1 + 1e-12))
