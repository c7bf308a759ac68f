# SPDX-License-Identifier: GPL-2.0-only
"""Walls and basins that move as a whole, without being turned: by the same words of ``fix mdanim/drive`` as objects."""

from __future__ import annotations

import bisect
import math
from typing import Any

import numpy as np

from ...model.planes import PlaneMotion
from ...records import dataclass
from ...scene.schema import Vector
from . import motion
from .words import DriveKey, DriveOscillation, DriveVelocity, ShiftKey


@dataclass(frozen=True)
class Shift:
    """A displacement as a function of time, with what `motion` asks of a driven object."""

    drive: tuple[DriveVelocity | DriveOscillation, ...]
    keys: tuple[ShiftKey, ...]
    position: Vector = (0.0, 0.0, 0.0)
    release: float | None = None

    @property
    def key_points(self) -> tuple[DriveKey, ...]:
        """Keys of a point that is at the origin at the start."""
        return tuple(DriveKey(key.time, key.by) for key in self.keys)

    def at(self, time: float) -> Vector:
        """Displacement at a time [m], as `fix mdanim/drive` has it to rounding."""
        found = motion.velocity_of(self) * time + _along(motion.keys_of(self), time)
        for one in motion.oscillations_of(self):
            angle = motion.TURN * one.frequency * time + one.phase
            found = found + np.array(one.way) * (math.sin(angle) - math.sin(one.phase))
        return tuple(found.tolist())

    def acceleration(self, time: float) -> float:
        """Largest acceleration until a time, along any direction [m/s^2]."""
        waves = sum((motion.TURN * one.frequency) ** 2 * math.hypot(*one.way) for one in motion.oscillations_of(self))
        keys = motion.keys_of(self)
        if len(keys) < 2 or keys[0].time >= time:
            return waves
        t = np.array([key.time for key in keys])
        value = np.array([key.at for key in keys])
        slope, h, way = motion.slopes(t, value), np.diff(t)[:, None], np.diff(value, axis=0)
        ends = [
            (6.0 * way - h * (4.0 * slope[:-1] + 2.0 * slope[1:])) / h**2,
            (h * (2.0 * slope[:-1] + 4.0 * slope[1:]) - 6.0 * way) / h**2,
        ]
        return waves + float(np.linalg.norm(np.concatenate(ends), axis=1).max())


def motion_of(name: str, drive: Any, keys: Any, time: float) -> PlaneMotion | None:
    """How the planes of a feature move until a time [s]; None where they stand. ``name`` is that of the feature."""
    if not drive and not keys:
        return None
    shift = Shift(tuple(drive), tuple(keys))
    low, high, speed = motion.displaced(shift, time)
    path = motion.KeyPath(motion.keys_of(shift), shift.position, time)
    return PlaneMotion(
        fix=f"drive_{name}",
        words=motion.words_of(shift),
        low=tuple((low + path.low).tolist()),
        high=tuple((high + path.high).tolist()),
        speed=float(speed + path.speed),
        quickest=motion.quickest(shift, time),
        at=shift.at,
    )


def _along(keys: tuple[DriveKey, ...], time: float) -> np.ndarray:
    """Displacement along a path through keys at a time [m], shape (3,)."""
    if not keys:
        return np.zeros(3)
    t = np.array([key.time for key in keys])
    value = np.array([key.at for key in keys], float)
    k = bisect.bisect_right(t.tolist(), time)
    if k in (0, len(keys)):
        return value[min(k, len(keys) - 1)]
    slope, h = motion.slopes(t, value), t[k] - t[k - 1]
    s = (time - t[k - 1]) / h
    r = 1.0 - s
    return value[k - 1] + s * s * (3.0 - 2.0 * s) * (value[k] - value[k - 1]) + h * s * r * (r * slope[k - 1] - s * slope[k])
