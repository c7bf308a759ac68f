# SPDX-License-Identifier: GPL-2.0-only
"""Colours of objects, floor and background."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..results.trajectory_metadata import TrajectoryMetadata
from ..scene.render import Floor, Render

# Twelve colours of one family: bold enough to tell apart, light enough to show shading.
OBJECTS = (
    "#e8743b",
    "#3b8fc4",
    "#f2b134",
    "#4fae7b",
    "#d3557a",
    "#7a6fc9",
    "#54b8b3",
    "#c9884a",
    "#9bbf4a",
    "#e58aa8",
    "#5f86d6",
    "#b5654f",
)
STILL = "#a3a9b0"
"""Objects that are held as a whole."""
LIQUID = "#2a8fb8"
LOW, HIGH = "#dfe5ea", "#f8fafb"
"""Background, at the bottom and at the top."""


def rgb(color: str) -> np.ndarray:
    """``#rrggbb`` as three numbers from 0 to 1."""
    return np.frombuffer(bytes.fromhex(color.lstrip("#")), dtype=np.uint8) / 255.0


def object_colors(chosen: Sequence[str], still: np.ndarray, begin: int = 0) -> np.ndarray:
    """Colour of each object, uint8, shape (O, 3): the scene's own, grey for what is held, else by index.

    Args:
        chosen: ``#rrggbb`` or empty, one per object.
        still: objects that never move, bool, shape (O,).
        begin: number of the first colour.
    """
    free = begin + np.cumsum(~np.asarray(still, dtype=bool)) - 1
    names = [color or (STILL if held else OBJECTS[index % len(OBJECTS)]) for color, held, index in zip(chosen, still, free)]
    return np.array([np.round(255 * rgb(name)) for name in names], dtype=np.uint8).reshape(-1, 3)


def colors_beside(metadata: TrajectoryMetadata, first: TrajectoryMetadata) -> np.ndarray:
    """Colour of each object of a run that is shown beside a first one, uint8, shape (O, 3): that of the object with its name
    there; what is not there has the colours that follow."""
    known = dict(zip(first.names, object_colors(first.colors, first.still)))
    new = [m for m, name in enumerate(metadata.names) if name not in known]
    begin = int(np.count_nonzero(~first.still))
    more = iter(object_colors([metadata.colors[m] for m in new], metadata.still[new], begin))
    return np.array([known[name] if name in known else next(more) for name in metadata.names], np.uint8).reshape(-1, 3)


def vertex_colors(metadata: TrajectoryMetadata, of_objects: np.ndarray | None = None) -> np.ndarray:
    """Colour of each vertex of the skin, uint8, shape (V, 3): its object's, or else that of the mesh file. ``of_objects``, of
    shape (O, 3), are colours of objects in place of `object_colors`."""
    skin = metadata.skin
    of_objects = object_colors(metadata.colors, metadata.still) if of_objects is None else of_objects
    color = of_objects[skin.object_of_vertex]
    chosen = np.array([bool(name) for name in metadata.colors], bool)[skin.object_of_vertex]
    color[skin.painted & ~chosen] = skin.paint[~chosen[skin.painted]]
    return color


SKIES = {Floor.GRASS: ("#d6e6f2", "#7fb2e0"), Floor.STUDIO: ("#eeecea", "#f7f6f5"), Floor.WOOD: ("#ebe5dd", "#f8f5f1")}
"""Backgrounds that go with floors, as LOW and HIGH with all others."""


def background_colors(render: Render) -> tuple[np.ndarray, np.ndarray]:
    """Colours at the bottom and at the top of the picture; the scene's own gets a gentle gradient too."""
    if render.background is None:
        low, high = SKIES.get(render.floor, (LOW, HIGH))
        return rgb(low), rgb(high)
    base = rgb(render.background)
    return 0.94 * base, np.minimum(1.0, base + 0.03)


def is_dark(color: np.ndarray) -> bool:
    """Whether light writing reads better on this colour (relative luminance below one half)."""
    return luminance(color) < 0.5


def luminance(color: np.ndarray) -> float:
    """How bright a colour is to the eye, from 0 to 1; red, green and blue are from 0 to 1."""
    return float(color @ [0.2126, 0.7152, 0.0722])
