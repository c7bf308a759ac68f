# SPDX-License-Identifier: GPL-2.0-only
"""Where two runs part: the first frame and object whose bits differ, and by how many metres."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import OutputError
from ..scene.formatting import number, say
from .trajectory import Trajectory
from .untrusted import check_folder


@dataclass(frozen=True, slots=True)
class Difference:
    """The result of `compare`."""

    frames: int
    """Frames compared."""
    frame: int | None = None
    """First frame that differs."""
    time: float = 0.0
    """[s]"""
    object: str = ""
    """Object, or liquid, that differs most there."""
    distance: float = 0.0
    """By how much [m], of a liquid the heights; 0 when only velocities differ."""
    largest: float = 0.0
    """Largest distance in any frame [m]."""

    @property
    def equal(self) -> bool:
        return self.frame is None

    def __str__(self) -> str:
        if self.equal:
            return f"equal    {self.frames} frames, every bit"
        return (
            f"differ   first at frame {self.frame} (t = {number(self.time, 4)} s): {self.object} by "
            f"{say(self.distance, 'm')}; largest in {self.frames} frames {say(self.largest, 'm')}"
        )


def compare(a: Path, b: Path) -> Difference:
    """Compare all frames of two output folders. Raises OutputError when they do not hold the same objects or frames."""
    for folder in (a, b):
        check_folder(folder)
    with Trajectory(a) as first, Trajectory(b) as second:
        if not len(first) or not len(second):
            raise OutputError(f"{a if not len(first) else b} holds no frame yet: there is nothing to compare")
        if first.names != second.names or first.position(0).shape != second.position(0).shape:
            raise OutputError(f"{a} and {b} hold different objects or resolutions: there is nothing to compare")
        # Times are multiples of each run's own time step: equal ones differ by the rounding of the products.
        if len(first) != len(second) or not np.allclose(first.times, second.times, rtol=1e-12, atol=0.0):
            raise OutputError(
                f"{a} has {len(first)} frames and {b} {len(second)}, or their times differ: "
                "run both scenes with the same control block"
            )
        fields = first.metadata.fields
        if fields != second.metadata.fields:
            raise OutputError(f"{a} and {b} hold frames with different fields: there is nothing to compare")
        if first.liquid != second.liquid:
            raise OutputError(f"{a} and {b} hold different liquids or basins: there is nothing to compare")
        found = None
        largest = 0.0
        for i in range(len(first)):
            x, y = first.position(i), second.position(i)
            same = np.array_equal(x, y) and np.array_equal(first.velocity(i), second.velocity(i))
            same = same and all(np.array_equal(*(t.field(f.name, i) for t in (first, second)), equal_nan=True) for f in fields)
            rise = _rise(first, second, i)
            if same and rise is None:
                continue
            distance = np.linalg.norm(x - y, axis=1)
            largest = max(largest, float(distance.max()), rise or 0.0)
            if found is None:
                worst = int(distance.argmax())
                name, by = first.names[first.metadata.object_of[worst]], float(distance[worst])
                if same or (rise or 0.0) > by:
                    name, by = first.liquid.name, rise
                found = (i, float(first.times[i]), name, by)
        if found is None:
            return Difference(len(first))
        return Difference(len(first), *found, largest)


def _rise(first: Trajectory, second: Trajectory, frame: int) -> float | None:
    """Largest difference between the liquids' heights in a frame [m]; None where they are equal, or there is none."""
    if first.liquid is None:
        return None
    pairs = [(t.liquid_height(frame), t.liquid_raw(frame)) for t in (first, second)]
    drops = [t.liquid_drops(frame) for t in (first, second)]
    if all(np.array_equal(x, y, equal_nan=True) for x, y in (*zip(*pairs), drops)):
        return None
    # A raw height that only one of them has (NaN, minus infinity) is not a height.
    both = [np.isfinite(x) & np.isfinite(y) for x, y in zip(*pairs)]
    return float(max(np.abs(x[b] - y[b]).max(initial=0.0) for x, y, b in zip(*pairs, both)))
