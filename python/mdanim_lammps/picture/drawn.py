# SPDX-License-Identifier: GPL-2.0-only
"""Additions of features to pictures and exports, which their modules ``picture`` declare (features/__init__.py)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field
from typing import TYPE_CHECKING

import numpy as np

from ..features import facets
from ..records import dataclass
from ..results.trajectory import Trajectory
from ..results.untrusted import check_places
from ..scene.render import Render

if TYPE_CHECKING:
    from .behind import Behind
    from .tank import Tank


@dataclass(frozen=True, eq=False)
class Drawn:
    """A thing that is drawn beside objects, as it is in every frame: of triangles, of lines, or of both. What is not there in a
    frame has all of its points in one place."""

    name: str
    points: Callable[[int], np.ndarray]
    """Its points in a frame of the trajectory, by number [m], shape (V, 3)."""
    triangle: np.ndarray = field(default_factory=lambda: np.zeros((0, 3), np.int32))
    """Numbers of points, counter-clockwise seen from outside, shape (T, 3). Only this side is drawn."""
    line: np.ndarray = field(default_factory=lambda: np.zeros((0, 2), np.int32))
    """Numbers of both points of each line, shape (L, 2); pictures have them, exports do not."""
    color: tuple[float, float, float] | None = None
    """Red, green, blue from 0 to 1, as a screen shows them; None is a grey that stands out."""
    normals: Callable[[int], np.ndarray] | None = None
    """Outward unit normals of the points in a frame, shape (V, 3); None for those of a smooth surface. Points at an edge are
    given once for each of its sides."""
    clear: bool = False
    """Whether one sees through it: exports have it with an opacity, pictures by its `Medium`."""


@dataclass(frozen=True)
class Medium:
    """How pictures draw what all else may be seen through, by shaders of its own; a scene has one at most."""

    bends: bool
    """Whether its surface shifts what is behind it, in final quality."""
    make: Callable[[bool, bool, Behind | None], Tank]
    """Its actors, by whether the background is dark, whether what hides the sky makes its floor darker, and what is behind."""


def drawn(trajectory: Trajectory) -> tuple[Drawn, ...]:
    """All that features add to a trajectory, in their order."""
    return tuple(one for facet in facets("picture") if hasattr(facet, "drawn") for one in facet.drawn(trajectory))


def medium(trajectory: Trajectory, render: Render) -> Medium | None:
    """The medium of a trajectory; None without one."""
    found = (facet.medium(trajectory, render) for facet in facets("picture") if hasattr(facet, "medium"))
    return next((one for one in found if one is not None), None)


def shape_of(one: Drawn, trajectory: Trajectory, frame: int) -> tuple[np.ndarray, np.ndarray]:
    """Points [m] and unit normals of what is drawn in a frame, each of shape (V, 3). Raises OutputError where a point is
    nowhere."""
    points = np.asarray(one.points(frame), float)
    check_places(trajectory.path, points, frame=frame)
    return points, _normals(points, one.triangle) if one.normals is None else one.normals(frame)


def _normals(points: np.ndarray, triangle: np.ndarray) -> np.ndarray:
    """Normals of a smooth surface: the sum over the triangles of a point, by their areas."""
    a, b, c = points[triangle].transpose(1, 0, 2)
    found = np.zeros_like(points)
    for corner in triangle.T:
        np.add.at(found, corner, np.cross(b - a, c - a))
    return found / np.maximum(np.linalg.norm(found, axis=1, keepdims=True), np.finfo(float).tiny)


class Additions:
    """Additions of features to the pictures of a trajectory, in the arrays of one mesh and of lines.

    Args:
        trajectory: what is drawn.
        dark: whether the background is.
    """

    def __init__(self, trajectory: Trajectory, dark: bool):
        from .pieces import MovingLines

        grey = (0.95 if dark else 0.15,) * 3
        self._trajectory, self._all = trajectory, [one for one in drawn(trajectory) if not one.clear]
        count = [len(one.points(0)) for one in self._all]
        self.first = np.concatenate([[0], np.cumsum(count)]).astype(np.int64)
        """First point of each, and their number."""
        shifted = [one.triangle + n for one, n in zip(self._all, self.first)]
        self.triangle = np.concatenate([np.zeros((0, 3), np.int64), *shifted])
        colors = [np.tile(np.rint(255.0 * np.array(one.color or grey)), (n, 1)) for one, n in zip(self._all, count)]
        self.color = np.concatenate([np.zeros((0, 3)), *colors]).astype(np.uint8)
        """Colours of the points, shape (V, 3)."""
        self._lines = [
            (n, MovingLines(count[n], one.line, one.color or grey, 2.0)) for n, one in enumerate(self._all) if len(one.line)
        ]
        self.actors = [lines.actor for _, lines in self._lines]
        """Actors of the lines."""

    def show(self, frame: int) -> tuple[np.ndarray, np.ndarray]:
        """Move lines to a frame, and give the points [m] and normals of everything, each of shape (V, 3)."""
        shapes = [shape_of(one, self._trajectory, frame) for one in self._all]
        for n, lines in self._lines:
            lines.move(shapes[n][0])
        return tuple(np.concatenate([np.zeros((0, 3)), *(shape[k] for shape in shapes)]) for k in (0, 1))
