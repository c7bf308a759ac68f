# SPDX-License-Identifier: GPL-2.0-only
"""The motion of a driven object: the words of ``fix mdanim/drive``, and how far and how fast it may go."""

from __future__ import annotations

import math
from itertools import pairwise, product
from typing import Any

import numpy as np

from ...bodies import all_held
from ...errors import Problem, SceneError, Span
from ...model import shapes
from ...model.boxes import box_pairs
from ...reach import Drive
from ...scene.formatting import in_full, whole
from ...scene.once import once_for
from .words import DriveKey, DriveOscillation, DriveSurface, DriveTurn, DriveVelocity

TURN = 2.0 * math.pi
MOST_PASSING = 10**5
"""Pairs of objects that go through each other: each is named to all that act between objects."""


def is_driven(solid: Any) -> bool:
    """Whether something moves what is held of an object, or lets it go."""
    return bool(solid.drive or solid.key_points or solid.release is not None)


def place_of(solid: Any) -> Span | None:
    """Where the scene says that it is driven."""
    return next((solid.spans[word] for word in ("drive", "key", "release") if word in solid.spans), None)


def velocity_of(solid: Any) -> np.ndarray:
    """Sum of all velocities of its drives [m/s], shape (3,)."""
    return sum((np.array(one.velocity) for one in solid.drive if isinstance(one, DriveVelocity)), np.zeros(3))


def belt_of(solid: Any) -> np.ndarray:
    """Velocity at which its surface runs over it [m/s], shape (3,)."""
    return sum((np.array(one.velocity) for one in solid.drive if isinstance(one, DriveSurface)), np.zeros(3))


def turn_of(solid: Any) -> tuple[np.ndarray, np.ndarray]:
    """Its angular velocity [rad/s], and the point about which it turns [m], each of shape (3,)."""
    turns = [one for one in solid.drive if isinstance(one, DriveTurn)]
    about = next((one.about for one in turns if one.about is not None), solid.position)
    return sum((np.array(one.rate) for one in turns), np.zeros(3)), np.array(about, float)


def oscillations_of(solid: Any) -> list[DriveOscillation]:
    """Its oscillations."""
    return [one for one in solid.drive if isinstance(one, DriveOscillation)]


def keys_of(solid: Any) -> tuple[DriveKey, ...]:
    """Its keys, from the start on; empty where there are none."""
    begins = () if not solid.key_points or solid.key_points[0].time == 0.0 else (DriveKey(0.0, solid.position),)
    return (*begins, *solid.key_points)


def words_of(solid: Any) -> str:
    """The motion in the words of the fix."""
    found = []
    if (velocity := velocity_of(solid)).any():
        found.append(f"velocity {in_full(velocity)}")
    rate, about = turn_of(solid)
    if rate.any():
        found.append(f"turn {in_full(rate)} {in_full(about)}")
    found += [f"oscillation {in_full(one.way)} {one.frequency!r} {one.phase / TURN!r}" for one in oscillations_of(solid)]
    if keys := keys_of(solid):
        found.append(f"pivot {in_full(solid.position)}")
        found += [f"key {k.time!r} {in_full(np.subtract(k.at, solid.position))} {in_full(k.rotation)}" for k in keys]
    found = found or ["velocity 0.0 0.0 0.0"]
    return " ".join(found if solid.release is None else [*found, f"until {solid.release!r}"])


# --- which go through each other ---


@once_for(lambda scene: scene)
def passing(scene: Any) -> list[tuple[int, int]]:
    """Pairs i < j of objects that are held as a whole, of which one is driven at least, and whose ways cross: neither gives way,
    so nothing acts between them. Those that are driven alike stay as far apart as they are at the start.

    Raises SceneError where they are more than MOST_PASSING.
    """
    held = [m for m, solid in enumerate(scene.solids) if all_held(solid)]
    if not any(is_driven(scene.solids[m]) for m in held):
        return []
    solids = [scene.solids[m] for m in held]
    corner = [_corners(solid) for solid in solids]
    way = [ways(scene).get(m, Drive((0.0,) * 3, (0.0,) * 3, 0.0)) for m in held]
    low, high = np.array([c.min(0) for c in corner]), np.array([c.max(0) for c in corner])
    driven = np.array([is_driven(solid) for solid in solids])
    straight = np.array([not solid.key_points and all(map(_is_straight, solid.drive)) for solid in solids])
    kinds: dict[Any, int] = {}
    kind = np.array([kinds.setdefault((solid.drive, solid.key_points), len(kinds)) for solid in solids])
    found: list[tuple[int, int]] = []
    for a, b in box_pairs(low + [one.low for one in way], high + [one.high for one in way]):
        apart = ((low[a] > high[b]) | (low[b] > high[a])).any(axis=1)
        crosses = (driven[a] | driven[b]) & ~((kind[a] == kind[b]) & straight[a] & apart)
        if len(found) + crosses.sum() > MOST_PASSING:
            cause = f"more than {whole(MOST_PASSING)} pairs of driven and held objects go through each other"
            place = place_of(solids[int(np.argmax(driven))])
            raise SceneError([Problem(place, cause, "drive fewer objects, or place them where their ways do not cross")])
        pairs = np.sort(np.array(held)[np.column_stack([a, b])[crosses]], axis=1)
        found += [(i, j) for i, j in pairs.tolist()]
    return sorted(found)


def _is_straight(drive: Any) -> bool:
    """Whether it moves all of an object alike."""
    return not isinstance(drive, DriveTurn)


# --- how far and how fast ---------------------------------------------------------------------------------------------


@once_for(lambda scene: scene)
def ways(scene: Any) -> dict[int, Drive]:
    """`bounds` of all driven objects until the end of a scene, by their numbers."""
    time = scene.control.time
    return {m: bounds(solid, _driven_until(solid, time)) for m, solid in enumerate(scene.solids) if is_driven(solid)}


def _driven_until(solid: Any, time: float) -> float:
    """How long an object is driven before this time [s]."""
    return time if solid.release is None else min(time, solid.release)


def bounds(solid: Any, time: float) -> Drive:
    """How far the box around the object may reach beyond that at the start until a time [s], and how fast any point of it may be;
    never too small. With a turn a point in the box may go farther than the box does.

    Along each axis the way of its displacements, and that of its rotations: of a turn no more than the box of the circle of each
    corner, and than the chord of the angle; of keys no more than the chord.
    """
    low, high, speed = displaced(solid, time)
    corner = _corners(solid)
    arm = np.linalg.norm(corner - solid.position, axis=1).max()
    path = KeyPath(keys_of(solid), solid.position, time)
    low, high, speed = low + path.low, high + path.high, speed + path.speed + path.turning * arm
    wide = _chord(arm, path.angle)
    low, high = low - wide, high + wide
    rate, about = turn_of(solid)
    if size := float(np.linalg.norm(rate)):
        more = wide + float(np.linalg.norm(np.maximum(-path.low, path.high)))  # by which keys move points from their first places
        swept = _swept(corner, about, rate / size, size * time, more)
        low, high = low + swept[0], high + swept[1]
        speed += size * (_from_axis(corner - about, rate / size).max() + more)
    speed += float(np.linalg.norm(belt_of(solid)))
    return Drive(tuple(low.tolist()), tuple(high.tolist()), float(speed), place_of(solid))


def quickest(solid: Any, time: float) -> float:
    """Highest frequency in its motion until a time [s]: of oscillations, of turns by drives and keys, and of keys, which are half
    a period apart [Hz]."""
    time = _driven_until(solid, time)
    keys = keys_of(solid)
    turning = float(np.linalg.norm(turn_of(solid)[0])) + KeyPath(keys, solid.position, time).turning
    between = [0.5 / (then.time - now.time) for now, then in pairwise(keys) if now.time < time]
    return max([turning / TURN, *between, *(one.frequency for one in oscillations_of(solid))])


def displaced(solid: Any, time: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Displacement by velocities and oscillations until a time, at least and at most [m], each of shape (3,), and the largest
    speed [m/s]."""
    velocity = velocity_of(solid)
    low, high = np.minimum(velocity, 0.0) * time, np.maximum(velocity, 0.0) * time
    speed = float(np.linalg.norm(velocity))
    for one in oscillations_of(solid):
        quickest = TURN * one.frequency
        far = np.abs(one.way) * min(1.0 + abs(math.sin(one.phase)), quickest * time)
        low, high = low - far, high + far
        speed += quickest * math.hypot(*one.way)
    return low, high, speed


def _corners(solid: Any) -> np.ndarray:
    """Corners of the box around an object along its own axes [m], shape (8, 3)."""
    ends = np.array(shapes.extent(solid.shape), float)
    own = np.array([[ends[e, d] for d, e in enumerate(corner)] for corner in product((0, 1), repeat=3)])
    return own @ np.array(solid.rotation, float).T + solid.position


def _chord(arm: float, angle: float) -> float:
    return 2.0 * arm * math.sin(0.5 * min(angle, math.pi))


def _from_axis(arm: np.ndarray, axis: np.ndarray) -> np.ndarray:
    return np.linalg.norm(np.cross(arm, axis), axis=1)


def _swept(corner: np.ndarray, about: np.ndarray, axis: np.ndarray, angle: float, more: float):
    """Ways along each axis of the world, at least and at most, of points that turn about an axis [m], each of shape (3,)."""
    arm = corner - about
    across = np.sqrt(np.maximum(0.0, 1.0 - axis**2))
    far = _from_axis(arm, axis)[:, None] + more
    middle = about + np.outer(arm @ axis, axis)
    chord = _chord(float(far.max()), angle) * across
    low = np.maximum((middle - far * across).min(0) - more - corner.min(0), -chord)
    high = np.minimum((middle + far * across).max(0) + more - corner.max(0), chord)
    return np.minimum(low, 0.0), np.maximum(high, 0.0)


def slopes(time: np.ndarray, value: np.ndarray) -> np.ndarray:
    """Slopes at keys, shape (K, n), of values of this shape at times that ascend, shape (K,): those of the neighbours, but at
    most three times that to either of them (Fritsch and Carlson 1980), and 0 at both ends and where a component turns back."""
    mean = np.diff(value, axis=0) / np.diff(time)[:, None]
    across = (value[2:] - value[:-2]) / (time[2:] - time[:-2])[:, None]
    found = np.zeros_like(value)
    found[1:-1] = _least(across, 3.0 * _least(mean[:-1], mean[1:]))
    return found


def _least(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The one next to 0 of two numbers of the same sign, else 0."""
    return np.maximum(np.minimum(a, b), 0.0) + np.minimum(np.maximum(a, b), 0.0)


class KeyPath:
    """Bounds on a path through keys: displacements [m], the largest rotation [rad], speed [m/s], rate of rotation [rad/s]."""

    def __init__(self, keys: tuple[DriveKey, ...], start: Any, time: float):
        self.low = self.high = np.zeros(3)
        self.angle = self.speed = self.turning = 0.0
        if len(keys) < 2:
            return
        t = np.array([key.time for key in keys])
        value = np.array([[*np.subtract(key.at, start), *key.rotation] for key in keys])
        slope = slopes(t, value)
        h = np.diff(t)[:, None]
        # Between two keys as a polynomial of s, 0 to 1: a + b s + c s^2 + d s^3.
        a, b = value[:-1], h * slope[:-1]
        c = 3.0 * (value[1:] - a) - h * (2.0 * slope[:-1] + slope[1:])
        d = 2.0 * (a - value[1:]) + h * (slope[:-1] + slope[1:])
        s = np.linspace(0.0, 1.0, 65)[:, None, None]
        rate = np.abs((b + s * (2.0 * c + 3.0 * s * d)) / h)
        between = (np.abs(2.0 * c) + np.abs(6.0 * d)) / 64.0  # by which the derivative changes from one s to the next
        rate = (rate + between / h).reshape(-1, 6)
        # No component leaves the interval between two keys.
        self.low, self.high = np.minimum(value.min(0), 0.0)[:3], np.maximum(value.max(0), 0.0)[:3]
        widest = np.maximum(np.abs(value[:-1, 3:]), np.abs(value[1:, 3:]))
        self.angle = float(np.linalg.norm(widest, axis=1).max())
        self.speed = float(np.linalg.norm(rate[:, :3], axis=1).max())
        self.turning = float(np.linalg.norm(rate[:, 3:], axis=1).max())
