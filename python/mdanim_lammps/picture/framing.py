# SPDX-License-Identifier: GPL-2.0-only
"""Parts of a picture: where places are seen in it, and a camera that sees one part."""

from __future__ import annotations

import numpy as np

from ..records import dataclass
from .lens import FIELD_OF_VIEW, View

AROUND = 4
"""Pixels around what is seen that a part holds too, for widths of lines and soft edges."""


@dataclass(frozen=True)
class PicturePart:
    """A rectangle of pixels of a picture; rows are counted from below."""

    left: int
    bottom: int
    right: int
    top: int

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels; 0 for none."""
        return max(0, self.right - self.left), max(0, self.top - self.bottom)

    def of(self, picture: np.ndarray) -> np.ndarray:
        """Its pixels, a view of a picture (height, width, ...) whose first row is the lowest one."""
        return picture[self.bottom : self.top, self.left : self.right]


def whole(size: tuple[int, int]) -> PicturePart:
    """All of a picture of this width and height."""
    return PicturePart(0, 0, *size)


def part_around(view: View, size: tuple[int, int], points: np.ndarray, around: int = AROUND) -> PicturePart:
    """The part of a picture of this size in which places [m], shape (P, 3), are seen; all of it where one is beside or behind the
    eye, none without places."""
    if not len(points):
        return PicturePart(0, 0, 0, 0)
    pixels, before = seen_at(view, size, points)
    if not before.all():
        return whole(size)
    low = np.clip(np.floor(pixels.min(axis=0)).astype(int) - around, 0, size)
    high = np.clip(np.ceil(pixels.max(axis=0)).astype(int) + around, 0, size)
    return PicturePart(int(low[0]), int(low[1]), int(high[0]), int(high[1]))


def seen_at(view: View, size: tuple[int, int], points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where places [m], shape (P, 3), are seen in a picture of this size [pixels], counted from the lower left corner, shape
    (P, 2); and which of them are before the eye, bool, shape (P,)."""
    ahead, right, up = _axes(view)
    out = points - view.eye
    depth = out @ ahead
    before = depth > 1e-3 * np.linalg.norm(view.look - view.eye)
    across = np.stack([out @ right, out @ up], axis=1) * _distance(size) / np.where(before, depth, 1.0)[:, None]
    return across + 0.5 * np.array(size), before


def pixels_per_metre(view: View, size: tuple[int, int], place: np.ndarray) -> float:
    """How long a metre across the line of sight is seen at a place [pixels]; 0 beside or behind the eye."""
    depth = float((place - view.eye) @ _axes(view)[0])
    return _distance(size) / depth if depth > 0.0 else 0.0


def corner_rays(view: View, size: tuple[int, int]) -> np.ndarray:
    """Directions in which the corners of a picture of this size are seen, shape (4, 3)."""
    ahead, right, up = _axes(view)
    high = np.tan(np.radians(FIELD_OF_VIEW) / 2.0)
    wide = high * size[0] / size[1]
    return np.array([ahead + x * wide * right + y * high * up for x in (-1, 1) for y in (-1, 1)])


def _distance(size: tuple[int, int]) -> float:
    """Distance from the eye at which a picture of this size would fill the field of view [pixels]."""
    return 0.5 * size[1] / np.tan(np.radians(FIELD_OF_VIEW) / 2.0)


def _axes(view: View) -> np.ndarray:
    """Unit vectors ahead, right and up, shape (3, 3)."""
    ahead = view.look - view.eye
    ahead = ahead / np.linalg.norm(ahead)
    right = np.cross(ahead, view.upright)
    right /= np.linalg.norm(right)
    return np.array([ahead, right, np.cross(right, ahead)])


def aim(camera, view: View, size: tuple[int, int], part: PicturePart) -> None:
    """Have a VTK camera see what a part of a picture of this size shows."""
    camera.SetPosition(view.eye)
    camera.SetFocalPoint(view.look)
    camera.SetViewUp(view.upright)
    width, height = part.size
    tangent = np.tan(np.radians(FIELD_OF_VIEW) / 2.0) * height / size[1]
    camera.SetViewAngle(2.0 * np.degrees(np.arctan(tangent)))
    camera.SetWindowCenter((part.left + part.right - size[0]) / width, (part.bottom + part.top - size[1]) / height)
