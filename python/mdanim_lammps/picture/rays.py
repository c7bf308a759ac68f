# SPDX-License-Identifier: GPL-2.0-only
"""Where light comes from, and how depth pictures are taken along it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..scene.render import Render

SKY_SIDE, SKY_PIXELS = 8, 256
"""Pictures of the sky along a side of the one that holds them all, and pixels of each along a side."""
ROOM = 1.02
"""Half side of a depth picture, in radii of what it shows."""
NEAR, FAR = 0.9, 3.1
"""Depths 0 and 1, in radii from a camera that is two radii from the middle."""


def direction(light: Sequence[float]) -> np.ndarray:
    """Unit vector towards a lamp, for ``render { light from ... }``."""
    vector = np.array(light, dtype=float)
    return vector / np.linalg.norm(vector)


LAMP = direction(Render().light)
"""Where the lamp is in a scene that does not say it."""


def axes(toward: np.ndarray) -> np.ndarray:
    """Right, up and towards the light, of a depth picture, shape (3, 3)."""
    right = np.cross([0.0, 1.0, 0.0] if abs(toward[1]) < 0.9 else [0.0, 0.0, 1.0], toward)
    right /= np.linalg.norm(right)
    return np.array([right, np.cross(toward, right), toward])


def sky_axes() -> np.ndarray:
    """`axes` of directions to parts of the sky of equal size, shape (K, 3, 3): a spiral from near the horizon to the zenith."""
    count = SKY_SIDE**2
    z = (np.arange(count) + 0.5) / count
    turn = np.pi * (3.0 - 5.0**0.5) * np.arange(count)
    flat = np.sqrt(1.0 - z**2)
    return np.array([axes(toward) for toward in np.stack([flat * np.cos(turn), flat * np.sin(turn), z], axis=1)])
