# SPDX-License-Identifier: GPL-2.0-only
"""Views that see places as large as they can be, in the part of a picture that words and curves leave."""

from __future__ import annotations

import numpy as np

from ..records import dataclass

FIELD_OF_VIEW = 30.0
"""Vertical angle of view [degrees]."""
MARGIN = 0.88
"""Share of the picture, across, that the action may fill."""
NEXT_TO = 0.5
"""Part of the margin that is between the action and a corner that is left free."""
WAYS = np.radians(np.linspace(0.0, 90.0, 9))
"""Angles of the normal of a line that cuts off such a corner, from the right upwards."""
ALONG = 1e-6
"""Sine of the angle between two directions that are one: rounding has a part in what is at right angles to both."""


@dataclass(frozen=True)
class View:
    """A camera at one moment."""

    eye: np.ndarray
    """[m], shape (3,)."""
    look: np.ndarray
    """[m], shape (3,)."""
    up: np.ndarray
    """As the scene has it, shape (3,)."""

    @property
    def upright(self) -> np.ndarray:
        """The direction that is up in the picture, shape (3,): ``up``, or, where that lies along the line of sight, z; looking
        along z, it is y, as on a map."""
        way = self.look - self.eye
        for up in (self.up, np.array([0.0, 0.0, 1.0])):
            if np.linalg.norm(np.cross(up, way)) > ALONG * np.linalg.norm(up) * np.linalg.norm(way):
                return up
        return np.array([0.0, 1.0, 0.0])


@dataclass(frozen=True)
class Reserved:
    """Shares of a picture's width and height that are left to words, scales and curves."""

    left: float = 0.0
    right: float = 0.0
    above: float = 0.0
    below: float = 0.0
    corner: tuple[float, float] = (0.0, 0.0)
    """Width and height of the upper right corner that is left, too."""

    def tangents(self, aspect: float) -> np.ndarray:
        """Tangents of the angles from the line of sight to the right, upper, left and lower side of what the action may fill,
        shape (4,); a side on the other side of the line of sight has a negative one. ``aspect`` is width over height."""
        first, last = np.array([self.left, self.below]), np.array([self.right, self.above])
        half, middle = MARGIN * (1.0 - first - last), first - last
        tangent = np.tan(np.radians(FIELD_OF_VIEW / 2)) * np.array([aspect, 1.0])
        return np.concatenate([tangent * (half + middle), tangent * (half - middle)])

    def of_corner(self, aspect: float) -> np.ndarray:
        """Tangents to the left and to the lower side of the corner, with some room before them, shape (2,)."""
        size = np.array(self.corner)
        within = 1.0 - 2.0 * size - NEXT_TO * (1.0 - MARGIN) * (1.0 - size)
        return np.tan(np.radians(FIELD_OF_VIEW / 2)) * np.array([aspect, 1.0]) * within


ALL_OF_IT = Reserved()
"""A picture of which nothing is left to words."""


class Lens:
    """A direction of view and what of the picture may be filled: what is inside of four sides, and below and left of a line
    through the lower left end of a corner that is left free.

    Args:
        forward: direction of view, unit length.
        aspect: width over height.
        room: what of the picture is left free.
        way: angle of the normal of that line, from the right upwards [rad].
    """

    def __init__(self, forward: np.ndarray, aspect: float, room: Reserved = ALL_OF_IT, way: float = 0.0):
        self.forward, self.tangent, self._normal = forward, room.tangents(aspect), np.zeros((0, 2))
        right = np.cross(forward, [0.0, 0.0, 1.0])
        # Straight down x is on the right, as `View.upright` has it.
        self.right = right / np.linalg.norm(right) if right.any() else np.array([1.0, 0.0, 0.0])
        self.up = np.cross(self.right, forward)
        if all(room.corner):
            self._normal = np.array([[np.cos(way), np.sin(way)]])
            self.tangent = np.append(self.tangent, self._normal @ room.of_corner(aspect))

    def sides(self, points: np.ndarray) -> np.ndarray:
        """How far points [m], shape (P, 3), push the right, upper, left and lower side of the picture and its line out, a - t c
        and so on [m], shape (P, 4) or (P, 5)."""
        across = points @ np.stack([self.right, self.up], axis=1)
        return (
            np.concatenate([across, -across, across @ self._normal.T], axis=1) - self.tangent * (points @ self.forward)[:, None]
        )

    def depth(self, most: np.ndarray) -> np.ndarray:
        """Where along the direction of view the nearest eye is whose sides are pushed out so far, of shape (..., 4) or (..., 5).

        Sides whose normals, so weighted, add up to nothing tell it: right and left, upper and lower, line, left and lower."""
        return (-self._closed(most) / self._closed(self.tangent)).min(axis=-1)

    def _closed(self, of: np.ndarray) -> np.ndarray:
        """Sums over sides whose normals add up to nothing, of numbers of each side, shape (..., 2) or (..., 3)."""
        return np.concatenate([of[..., :2] + of[..., 2:4], of[..., 4:] + of[..., 2:4] @ self._normal.T], axis=-1)

    @property
    def open(self) -> bool:
        """Whether something of the picture is left inside of its sides."""
        return bool((self._closed(self.tangent) > 0.0).all())

    def view(self, most: np.ndarray, middle: float) -> View:
        """The view of that eye, whose look is so far along the direction [m]."""
        # A single point has no size to stand back from.
        depth = min(float(self.depth(most)), middle - 1e-3)
        pushed = most + depth * self.tangent
        across = (pushed[:2] - pushed[2:4]) / 2
        for normal, least in zip(self._normal, pushed[4:]):
            free = -pushed[2:4] - across  # to the right and upwards
            short = least - normal @ across
            if short > 0.0:
                across = across + free * min(1.0, short / max(normal @ free, np.finfo(float).tiny))
        eye = across[0] * self.right + across[1] * self.up + depth * self.forward
        return View(eye, eye + (middle - depth) * self.forward, np.array([0.0, 0.0, 1.0]))


def lens_for(points: np.ndarray, forward: np.ndarray, aspect: float, room: Reserved) -> Lens:
    """The lens through which points [m], shape (P, 3), are seen from nearest: with a corner that is left free, the line beside or
    below which they are largest."""
    lenses = [Lens(forward, aspect, room, way) for way in (WAYS if all(room.corner) else WAYS[:1])]
    return max(
        (lens for lens in lenses if lens.open), key=lambda lens: lens.depth(lens.sides(points).max(axis=0)), default=lenses[0]
    )


def fit_view(points: np.ndarray, forward: np.ndarray, aspect: float, room: Reserved = ALL_OF_IT) -> View:
    """The nearest eye that looks along ``forward`` and sees all points inside the margin.

    A point (a, b, c) along right, up and forward is inside the picture of an eye (x, y, z) where
    ``a - x <= t (c - z)`` and ``x - a <= s (c - z)``, with the tangents t at the right and s at the left, and so for b and y;
    they give x, y and the largest z in closed form.

    Args:
        points: [m], shape (P, 3).
        forward: direction of view, unit length.
        aspect: width over height.
        room: what of the picture they may not take.
    """
    lens = lens_for(points, forward, aspect, room)
    along = points @ forward
    return lens.view(lens.sides(points).max(axis=0), (along.min() + along.max()) / 2)
