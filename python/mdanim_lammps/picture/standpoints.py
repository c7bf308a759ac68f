# SPDX-License-Identifier: GPL-2.0-only
"""Cameras of a scene: views in a given direction, after an object, or along a path."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from ..errors import UsageError
from ..results.trajectory import Trajectory
from ..scene.keywords import did_you_mean
from ..scene.render import Camera, Standpoint
from .camera import Action, CameraPath, automatic_view, corners, three_quarters, worth_holding
from .lens import ALL_OF_IT, FIELD_OF_VIEW, Lens, Reserved, View, lens_for
from .scenery import scenery

DIRECTIONS = {"top": (0.0, 0.0, -1.0), "side": (-1.0, 0.0, 0.0), "front": (0.0, 1.0, 0.0)}
"""Directions of view by the word of a camera."""
ROOM = 1.4
"""Half of the height of what is seen around an object that is followed, in its own sizes."""
WIDEST = 4.0
"""Distance to which the automatic camera goes back for an object at most, over that from which it sees what is worth seeing."""
SLIGHT = 1.1
"""The same up to which it stands there from the start."""
EASE = 0.4
"""Time over which it goes [s], on both sides."""
CALM = 0.15
"""Time over which the way of an object is smoothed [s], on both sides."""


def direction_of(cameras: Sequence[Camera | Standpoint]) -> np.ndarray | None:
    """Direction in which a view of the whole run looks, shape (3,); None where the scene gives none."""
    first = cameras[0] if cameras else None
    return np.array(DIRECTIONS[first.place]) if isinstance(first, Standpoint) and first.place in DIRECTIONS else None


def camera_of(
    cameras: Sequence[Camera | Standpoint],
    trajectory: Trajectory,
    action: Action,
    aspect: float,
    room: Reserved = ALL_OF_IT,
    *,
    fixed: bool = False,
) -> CameraPath | Following | Standing | Widening:
    """The camera of a scene, or the automatic one. Raises UsageError for an object that there is not.

    Args:
        cameras: of the scene.
        trajectory: of the run.
        action: where things happen.
        aspect: width of the picture over its height.
        room: what of the picture the automatic camera leaves free.
        fixed: whether the automatic camera has to stand still.
    """
    first, forward = cameras[0] if cameras else None, direction_of(cameras)
    if isinstance(first, Camera):
        return CameraPath([one for one in cameras if isinstance(one, Camera)], trajectory)
    if first is not None and forward is None:
        return Following(str(first.name), trajectory, action)
    _, walls, pool = scenery(trajectory.metadata)
    basin = (pool.low, pool.high) if pool else None
    if fixed or forward is not None or len(action.movers) < 2:
        return Standing(automatic_view(action, aspect, walls, basin, forward, room))
    forward = three_quarters(action)
    points = worth_holding(action, aspect, walls, basin, forward, False, room)
    wider = Widening(action, trajectory.times, points, lens_for(points, forward, aspect, room))
    return wider if not wider.still else Standing(wider.at(0.0))


class Standing:
    """A camera that stands still."""

    still = True

    def __init__(self, view: View):
        self._view = view

    def at(self, time: float) -> View:
        """The view, at any time."""
        return self._view


class Widening:
    """The automatic camera: a view that holds what is worth seeing, and goes back for what moves most where that leaves it.

    It goes along its line of sight, smoothly; an object for which it would have to go more than `WIDEST` times as far is left.
    Where a little more is enough for the whole run, it stands still there.

    Args:
        action: where things happen, in two stretches at least.
        times: of all frames [s], shape (F,).
        points: what is worth seeing [m], shape (P, 3).
        lens: direction and room.
    """

    def __init__(self, action: Action, times: np.ndarray, points: np.ndarray, lens: Lens):
        self._lens, along = lens, points @ lens.forward
        self._middle = float((along.min() + along.max()) / 2)
        stretches = np.array_split(times, len(action.low))
        self._times = np.array([part.mean() for part in stretches])
        base = lens.sides(points).max(axis=0)
        away = lambda sides: self._middle - lens.depth(sides)
        near = max(float(away(base)), 1e-3)
        when, objects = np.nonzero(action.movers)
        boxes = (np.clip(bound[when, objects], *action.bounds) for bound in (action.low, action.high))
        pushed = np.maximum(lens.sides(corners(*boxes)).reshape(8, len(when), len(base)).max(axis=0), base)
        followed = away(pushed) <= WIDEST * near
        needed = np.tile(base, (len(stretches), 1))
        np.maximum.at(needed, when[followed], pushed[followed])
        self._sides = _eased(needed, max(1, round(EASE / max(self._times[1] - self._times[0], 1e-9))))
        self.still = bool(away(self._sides).max() <= SLIGHT * near)
        if self.still:
            self._sides[:] = self._sides.max(axis=0)

    def at(self, time: float) -> View:
        """The view at a simulated time [s]."""
        sides = np.array([np.interp(time, self._times, self._sides[:, k]) for k in range(self._sides.shape[1])])
        return self._lens.view(sides, self._middle)


def _eased(values: np.ndarray, half: int) -> np.ndarray:
    """Rows that change smoothly over ``half`` rows to both sides, and nowhere fall short of these, shape (W, n)."""
    windows = lambda rows: sliding_window_view(np.pad(rows, [(half, half), (0, 0)], mode="edge"), 2 * half + 1, axis=0)
    bell = np.hanning(2 * half + 3)[1:-1]
    return windows(windows(values).max(axis=-1)) @ (bell / bell.sum())


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
