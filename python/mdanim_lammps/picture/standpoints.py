# SPDX-License-Identifier: GPL-2.0-only
"""Cameras of a scene: views in a given direction, after an object, or along a path."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..errors import UsageError
from ..results.trajectory import Trajectory
from ..scene.keywords import did_you_mean
from ..scene.render import Camera, Standpoint
from .camera import FIELD_OF_VIEW, Action, CameraPath, View, three_quarters

DIRECTIONS = {"top": (0.0, 0.0, -1.0), "side": (-1.0, 0.0, 0.0), "front": (0.0, 1.0, 0.0)}
"""Directions of view by the word of a camera."""
ROOM = 1.4
"""Half of the height of what is seen around an object that is followed, in its own sizes."""
CALM = 0.15
"""Time over which the way of an object is smoothed [s], on both sides."""


def direction_of(cameras: Sequence[Camera | Standpoint]) -> np.ndarray | None:
    """Direction in which a view of the whole run looks, shape (3,); None where the scene gives none."""
    first = cameras[0] if cameras else None
    return np.array(DIRECTIONS[first.place]) if isinstance(first, Standpoint) and first.place in DIRECTIONS else None


def path_of(cameras: Sequence[Camera | Standpoint], trajectory: Trajectory, action: Action) -> CameraPath | Following | None:
    """The camera of a scene that is not one view of the whole run. Raises UsageError for an object that there is not."""
    if not cameras or direction_of(cameras) is not None:
        return None
    first = cameras[0]
    if isinstance(first, Standpoint):
        return Following(str(first.name), trajectory, action)
    return CameraPath([one for one in cameras if isinstance(one, Camera)], trajectory)


class Following:
    """A camera that looks in the direction of the automatic one and goes along with an object, smoothly.

    Args:
        name: of the object.
        trajectory: with its way.
        action: where things happen.

    Raises UsageError where the trajectory does not hold the object.
    """

    still = False

    def __init__(self, name: str, trajectory: Trajectory, action: Action):
        if name not in trajectory.names:
            hint = did_you_mean(name, trajectory.names) or "name an object of the run"
            raise UsageError(f"a camera follows '{name}', which {trajectory.path} does not hold; {hint}")
        number = trajectory.names.index(name)
        self._times, way = trajectory.times, trajectory.centers[:, number]
        self._way = np.array([self._smooth(way, time) for time in self._times])
        size = np.linalg.norm(action.high[0, number] - action.low[0, number])
        self._back = -ROOM * size / np.tan(np.radians(FIELD_OF_VIEW) / 2.0) * three_quarters(action)

    def _smooth(self, way: np.ndarray, time: float) -> np.ndarray:
        """Place at a time on the straight line of least squares, weighted by a bell of the width CALM around it."""
        since = self._times - time
        weight = np.exp(-0.5 * (since / CALM) ** 2)
        weight /= weight.sum()
        mean, place = weight @ since, weight @ way
        spread = weight @ (since - mean) ** 2
        return place - mean * (weight * (since - mean)) @ way / spread if spread > 0.0 else place

    def at(self, time: float) -> View:
        """The view at a simulated time [s]."""
        look = np.array([np.interp(time, self._times, self._way[:, k]) for k in range(3)])
        return View(look + self._back, look, np.array([0.0, 0.0, 1.0]))
