# SPDX-License-Identifier: GPL-2.0-only
"""Where the camera stands: chosen so that the whole action is in the picture, or along the scene's path."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from ..errors import UsageError
from ..records import dataclass
from ..results.trajectory import Trajectory
from ..results.untrusted import check_places
from ..scene.keywords import did_you_mean
from ..scene.render import Camera
from .drawn import drawn
from .lens import ALL_OF_IT, Lens, Reserved, View, fit_view, lens_for
from .scenery import scenery

FALL, FAR = 0.25, 4.0
"""How far an object may fall, and go, before it leaves the picture, in sizes of the scene at its start."""
LARGER = 0.35
"""Value of a larger picture: one that shows everything 10 % larger may lose this much of 10 % of all movement."""
LEAST = 0.6
"""Share of the objects that move which is seen at any time."""
NEXT_SHARES = (0.995, 0.98, 0.95, 0.9, 0.8)
"""Shares of the visible movement that are tried as the next to be kept."""
MOMENT = 0.03
"""Share of the run for which the picture follows objects that come and go after they are worth it."""
LEAD = 1.0 / 3.0
"""Share of all movement in a stretch from which on an object leads it."""
STIR = 0.05
"""Share of the movement of the liveliest stretch up to which a stretch is at rest."""
NEAR = 0.1
"""Distance at which an object meets others, in sizes of its own."""
_BOXES = 50_000


@dataclass(frozen=True)
class Action:
    """Where things happen, over all frames."""

    low: np.ndarray
    """Lower corner of each object in each stretch of frames [m], shape (W, O, 3)."""
    high: np.ndarray
    """Upper corner [m], shape (W, O, 3)."""
    bounds: tuple[np.ndarray, np.ndarray]
    """Corners of the box that the picture shows [m]; objects that fly far off are left out of it."""
    escaped: bool
    """Whether some object falls out of it, there being no ground."""
    free: np.ndarray
    """Objects that are not held as a whole, bool, shape (O,)."""
    leads: np.ndarray
    """Objects that the picture must hold: they move most in a stretch and meet something then or later, bool, shape (W, O)."""
    hung: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    """Points of strings, joints and the like at the start, which the picture must hold [m], shape (P, 3)."""
    movers: np.ndarray = field(default_factory=lambda: np.zeros((0, 0), bool))
    """Objects that make a large part of all movement in a stretch, bool, shape (W, O)."""

    @property
    def size(self) -> float:
        """Diagonal of the box [m]."""
        return float(np.linalg.norm(self.bounds[1] - self.bounds[0]))

    @property
    def centre(self) -> np.ndarray:
        """[m], shape (3,)."""
        return (self.bounds[0] + self.bounds[1]) / 2


CRUMBS = 0.05
"""Part of the particles of what is torn that may fly off on each side."""


def action_of(trajectory: Trajectory, samples: int = 40) -> Action:
    """Bounds of all objects in all frames. Raises OutputError where a position is NaN or infinite.

    Centres are taken from every frame, extents about them from ``samples`` frames, so that a long trajectory
    need not be read whole. Left out is what would make everything else tiny: an object, where there is no
    ground, from when it has fallen out of the scene; of a crowd the outermost twentieth on each side and what
    lies farther from the start than four times its size; of few objects what lies ten times farther still; of
    what is torn the outermost twentieth of its particles on each side. Of a liquid alone it is the basin.
    """
    metadata, centers, there = trajectory.metadata, np.array(trajectory.centers), scenery(trajectory.metadata)
    if not metadata.names:
        nothing = np.zeros((1, 0, 3))
        bounds = tuple(np.array(corner, float) for corner in (there.liquid.low, there.liquid.high))
        return Action(nothing, nothing, bounds, False, ~metadata.still, np.zeros((1, 0), bool))
    frames = sorted(set(np.linspace(0, len(trajectory) - 1, samples).astype(int).tolist()))
    below = np.zeros(centers.shape[1:])
    above = np.zeros(centers.shape[1:])
    for frame in frames:
        position, torn = trajectory.position(frame), trajectory.gone(frame)
        least, most = metadata.skin.boxes(metadata.skin.vertices(position, torn))
        for m in () if torn is None else np.unique(metadata.object_of[torn[:, 0]]):
            own = position[metadata.first[m] : metadata.first[m + 1]]
            least[m], most[m] = np.quantile(own, [CRUMBS, 1.0 - CRUMBS], axis=0)
            centers[frame, m] = 0.5 * (least[m] + most[m])
        np.minimum(below, least - centers[frame], out=below)
        np.maximum(above, most - centers[frame], out=above)
    check_places(trajectory.path, centers, below, above)
    # A stretch is one frame, unless that makes more boxes than are worth looking at.
    stretches = np.array_split(np.arange(len(centers)), min(len(centers), max(1, _BOXES // len(metadata.names))))
    low = np.array([centers[s].min(axis=0) + below for s in stretches])
    high = np.array([centers[s].max(axis=0) + above for s in stretches])

    start_low, start_high = (centers[0] + below).min(axis=0), (centers[0] + above).max(axis=0)
    size = max(float(np.linalg.norm(start_high - start_low)), np.finfo(float).tiny)
    gone = np.zeros(low.shape[:2], dtype=bool)
    if there.ground is None:
        # Nothing falls out of a basin, which has a floor of its own.
        bottom = min(start_low[2], there.liquid.low[2]) if there.liquid else start_low[2]
        gone = np.maximum.accumulate(low[:, :, 2] < bottom - FALL * size, axis=0)
    lowest = np.where(gone[:, :, None], np.inf, low).min(axis=0)
    highest = np.where(gone[:, :, None], -np.inf, high).max(axis=0)
    # A stretch that lasts from the first one on has no bounds of its own.
    lowest, highest = np.minimum(lowest, start_high), np.maximum(highest, start_low)
    outer = len(metadata.names) // 20
    shown_low = np.partition(lowest, outer, axis=0)[outer]
    shown_high = -np.partition(-highest, outer, axis=0)[outer]
    # One among many may fly off; where there are few, the picture follows far.
    far = (FAR if outer else 10.0 * FAR) * size
    bounds = (
        np.maximum(np.minimum(shown_low, start_low), start_low - far),
        np.minimum(np.maximum(shown_high, start_high), start_high + far),
    )
    if there.liquid is not None:
        # The basin is seen whole, whatever happens in it.
        bounds = np.minimum(bounds[0], there.liquid.low), np.maximum(bounds[1], there.liquid.high)
    if there.ground is not None:
        bounds[0][2] = min(bounds[0][2], max(there.ground, start_low[2] - FAR * size))
    basin = (there.liquid.low, there.liquid.high) if there.liquid is not None else None
    path, moved = movement(low, high)
    leads, movers = what_leads(low, high, shares(moved), basin) & ~gone, what_moves(path, moved) & ~gone
    added = [np.asarray(one.points(0), float) for one in drawn(trajectory) if not one.clear]
    hung = np.clip(np.concatenate([np.zeros((0, 3)), *added]), start_low - far, start_high + far)
    check_places(trajectory.path, hung, frame=0)
    return Action(low, high, bounds, bool(gone.any()), ~metadata.still, leads, hung, movers)


def movement(low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Path of each object in a stretch [m], shape (W, O), and path times size [m^2], for boxes [m], each of shape (W, O, 3)."""
    if len(low) < 2:
        return np.zeros(low.shape[:2]), np.zeros(low.shape[:2])
    path = np.linalg.norm(np.gradient((low + high) / 2, axis=0), axis=-1)
    return path, path * np.linalg.norm(high - low, axis=-1)


def shares(values: np.ndarray) -> np.ndarray:
    """Values over their sum in a stretch, shape (W, O)."""
    return values / np.maximum(values.sum(axis=1, keepdims=True), np.finfo(float).tiny)


def what_moves(path: np.ndarray, moved: np.ndarray) -> np.ndarray:
    """Objects that make a third of all movement in a stretch that is not at rest, or of all paths, as a stone beside the arm that
    has thrown it, bool, shape (W, O)."""
    total = moved.sum(axis=1, keepdims=True)
    return (total > STIR * total.max(initial=0.0)) & ((shares(moved) >= LEAD) | (shares(path) >= LEAD))


def what_leads(low: np.ndarray, high: np.ndarray, share: np.ndarray, basin=None) -> np.ndarray:
    """Objects that make most of the movement in a stretch, until they have last met another object or the basin;
    bool, shape (W, O).

    A ball that swings at a wall is one long before it is there, as nothing else moves; what flies off is none.

    Args:
        low, high: corners of each object in each stretch [m], shape (W, O, 3).
        share: of each object in all movement, shape (W, O).
        basin: corners of the liquid's basin.
    """
    leads = np.zeros(low.shape[:2], dtype=bool)
    for o in np.flatnonzero((share >= LEAD).any(axis=0)):
        near = NEAR * np.linalg.norm(high[:, [o]] - low[:, [o]], axis=-1, keepdims=True)
        meets = ((low <= high[:, [o]] + near) & (high >= low[:, [o]] - near)).all(axis=-1)
        meets[:, o] = False
        met = meets.any(axis=1)
        if basin is not None:
            met |= ((low[:, o] <= basin[1]) & (high[:, o] >= basin[0])).all(axis=-1)
        leads[:, o] = (share[:, o] >= LEAD) & np.logical_or.accumulate(met[::-1])[::-1]
    return leads


def automatic_view(
    action: Action, aspect: float, walls=None, basin=None, forward: np.ndarray | None = None, room: Reserved = ALL_OF_IT
) -> View:
    """A view that shows what happens as large as it can be; the same for all frames.

    Without a direction it is a three-quarter view from slightly above, and what few objects do for a short time is left out where
    all else becomes much larger by that (`LARGER`, `LEAST`), but what leads is not. In a direction that is given all is shown.

    Args:
        action: what must be seen.
        aspect: width of the picture over its height.
        walls: corners of the scene's walls, shown too unless they are far larger than the action.
        basin: corners of the liquid's basin, always shown.
        forward: direction of view, unit length; None for the three-quarter view.
        room: what of the picture the action may not take.
    """
    everything, forward = forward is not None, three_quarters(action) if forward is None else forward
    return fit_view(worth_holding(action, aspect, walls, basin, forward, everything, room), forward, aspect, room)


def worth_holding(
    action: Action, aspect: float, walls, basin, forward: np.ndarray, everything: bool, room: Reserved
) -> np.ndarray:
    """Points that `automatic_view` holds [m], shape (P, 3)."""
    low, high = action.bounds
    boxes = np.clip(action.low, low, high), np.clip(action.high, low, high)
    # Where nothing has moved yet, the way down to the ground is shown, as objects will go there.
    fixed = [action.hung, corners(low, high) if len(action.low) == 1 else np.zeros((0, 3))]
    if walls is not None and np.linalg.norm(np.subtract(*walls)) < 2.0 * action.size:
        fixed.append(corners(*np.array(walls, dtype=float)))
    if basin is not None:
        fixed.append(corners(*np.array(basin, dtype=float)))
    fixed = np.concatenate(fixed)
    kept = (
        np.ones_like(action.leads)
        if everything or not action.leads.size
        else worth_seeing(*boxes, action, fixed, lens_for(np.concatenate([corners(*boxes), fixed]), forward, aspect, room))
    )
    return np.concatenate([corners(boxes[0][kept], boxes[1][kept]), fixed])


def three_quarters(action: Action) -> np.ndarray:
    """Direction in which the automatic camera looks, unit length, shape (3,)."""
    low, high = action.bounds
    extent = high - low
    flat = np.clip(1.0 - extent[2] / max(extent[:2].max(), np.finfo(float).tiny), 0.0, 1.0)
    elevation = np.radians(16.0 + 14.0 * flat)
    # The longer horizontal side lies across the picture.
    turn = np.radians(-65.0 if extent[0] >= extent[1] else -25.0)
    return -np.array([np.cos(elevation) * np.cos(turn), np.cos(elevation) * np.sin(turn), np.sin(elevation)])


def worth_seeing(low, high, action: Action, fixed: np.ndarray, lens: Lens) -> np.ndarray:
    """Which boxes a picture should hold so that it shows much of what happens, and shows it large; bool, shape (W, O).

    The score is the share of boxes that are inside times the size at which they are seen to the power of `LARGER`. From each
    of its sides the picture is made smaller as long as the score grows.

    Then what comes and goes is followed for a `MOMENT` more.

    Args:
        low, high: corners of each object in each stretch of frames [m], shape (W, O, 3).
        action: which objects move, and which boxes are inside in any case.
        fixed: points that are inside in any case [m], shape (P, 3).
        lens: direction of view and what of the picture they may take.
    """
    free, leads = action.free, action.leads
    side = lens.sides(corners(low, high)).reshape(8, *low.shape[:2], -1).max(axis=0)
    fixed_side = lens.sides(fixed).max(axis=0, initial=-np.inf)
    middle = float(((low + high) / 2 @ lens.forward).mean())

    def score(kept: np.ndarray) -> float:
        if free.any() and kept[:, free].mean(axis=1).min() < LEAST:
            return -np.inf
        most = np.maximum(side[kept].max(axis=0), fixed_side)
        away = middle - lens.depth(most)
        return float(np.log(kept.mean()) - LARGER * np.log(max(away, np.finfo(float).tiny)))

    kept = np.ones(low.shape[:2], dtype=bool)
    best = score(kept)
    while True:
        sides = [(side[..., k], np.quantile(side[kept, k], share)) for k in range(side.shape[-1]) for share in NEXT_SHARES]
        smaller = [leads | (kept & (reach <= most)) for reach, most in sides]
        scores = [score(s) for s in smaller]
        if max(scores) <= best + 1e-9:
            break
        best, kept = max(scores), smaller[int(np.argmax(scores))]
    moment = round(MOMENT * len(kept))
    return sliding_window_view(np.pad(kept, [(moment, moment), (0, 0)]), 2 * moment + 1, axis=0).any(axis=-1)


class CameraPath:
    """The scene's cameras as a smooth path in time.

    Between two of them eye, look and up follow a cubic Hermite curve whose slopes are those of the neighbours
    (Catmull-Rom); before the first and after the last the camera stands still. ``look NAME`` follows it.

    Args:
        cameras: at least one; without a time: 0 s.
        trajectory: for the centres of objects that are followed.

    Raises:
        UsageError: a camera looks at an object that the trajectory does not hold.
    """

    def __init__(self, cameras: Sequence[Camera], trajectory: Trajectory):
        order = sorted(cameras, key=lambda camera: camera.time or 0.0)
        self._times = np.array([camera.time or 0.0 for camera in order])
        self._eye = np.array([camera.eye for camera in order], dtype=float)
        self._up = np.array([camera.up for camera in order], dtype=float)
        self._look = [camera.look for camera in order]
        self._trajectory = trajectory
        for look in self._look:
            if isinstance(look, str) and look not in trajectory.names:
                hint = did_you_mean(look, trajectory.names)
                raise UsageError(
                    f"a camera looks at '{look}', which {trajectory.path} does not hold; {hint or 'name an object of the run'}"
                )

    @property
    def still(self) -> bool:
        """Whether the camera never moves."""
        return len(self._look) == 1 and not isinstance(self._look[0], str)

    def at(self, time: float) -> View:
        """The view at a simulated time [s]."""
        weight = hermite_weights(self._times, time)
        look = np.array([self._target(look, time) for look in self._look])
        return View(weight @ self._eye, weight @ look, weight @ self._up)

    def _target(self, look, time: float) -> np.ndarray:
        if not isinstance(look, str):
            return np.asarray(look, dtype=float)
        track = self._trajectory.objects[look].center_of_mass
        return np.array([np.interp(time, self._trajectory.times, track[:, k]) for k in range(3)])


def hermite_weights(times: np.ndarray, time: float) -> np.ndarray:
    """How much each point of a path counts at a time: a smooth curve through all points, shape (K,).

    Args:
        times: of the points, ascending [s], shape (K,).
        time: [s]; outside of ``times`` the nearest end counts.
    """
    count = len(times)
    unit = np.eye(count)
    time = float(np.clip(time, times[0], times[-1]))
    i = int(np.clip(np.searchsorted(times, time, side="right") - 1, 0, max(count - 2, 0)))
    if count == 1 or times[i + 1] == times[i]:
        return unit[i]
    # Slopes at the ends are zero: the camera starts and stops gently.
    slope = np.zeros((count, count))
    for k in range(1, count - 1):
        span = times[k + 1] - times[k - 1]
        if span > 0.0:
            slope[k] = (unit[k + 1] - unit[k - 1]) / span
    h = times[i + 1] - times[i]
    s = (time - times[i]) / h
    return (
        (1 + 2 * s) * (1 - s) ** 2 * unit[i]
        + s * (1 - s) ** 2 * h * slope[i]
        + s**2 * (3 - 2 * s) * unit[i + 1]
        - s**2 * (1 - s) * h * slope[i + 1]
    )


def corners(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """The eight corners of each box, shape (8 n, 3)."""
    box = np.stack([low.reshape(-1, 3), high.reshape(-1, 3)])
    x, y, z = np.meshgrid([0, 1], [0, 1], [0, 1])
    return np.stack([box[x.ravel(), :, 0], box[y.ravel(), :, 1], box[z.ravel(), :, 2]], axis=-1).reshape(-1, 3)
