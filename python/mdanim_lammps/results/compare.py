# SPDX-License-Identifier: GPL-2.0-only
"""Where two runs part: the first frame and object whose bits differ, and by how many metres."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..effects.fields import OF_OBJECTS
from ..effects.kept import kinds
from ..errors import OutputError
from ..records import dataclass
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
    """Object, or record of a feature, that differs most there."""
    distance: float = 0.0
    """By how much [m]; 0 when only velocities differ."""
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
        records = first.metadata.kept, second.metadata.kept
        for name, kind in kinds().items():
            if kind.UNLIKE and records[0].get(name) != records[1].get(name):
                raise OutputError(f"{a} and {b} hold different {kind.UNLIKE}: there is nothing to compare")
        fields = first.metadata.fields
        if fields != second.metadata.fields:
            raise OutputError(f"{a} and {b} hold frames with different fields: there is nothing to compare")
        found = None
        largest = 0.0
        for i in range(len(first)):
            x, y = first.position(i), second.position(i)
            told = [{field.name: t.field(field.name, i) for field in fields} for t in (first, second)]
            unlike = [f for f in fields if not _equal(*(values[f.name] for values in told))]
            bodies = not np.array_equal(x, y) or not np.array_equal(first.velocity(i), second.velocity(i))
            if not bodies and not unlike:
                continue
            apart = [part for record in records[0].values() if (part := record.apart(*told)) is not None]
            if bodies or not apart or any(f.per in OF_OBJECTS for f in unlike):
                distance = np.linalg.norm(x - y, axis=1)
                worst = int(distance.argmax())
                apart.insert(0, (first.names[first.metadata.object_of[worst]], float(distance[worst])))
            name, by = max(apart, key=lambda part: part[1])
            largest = max(largest, by)
            found = found or (i, float(first.times[i]), name, by)
        if found is None:
            return Difference(len(first))
        return Difference(len(first), *found, largest)


def _equal(a: np.ndarray, b: np.ndarray) -> bool:
    """Whether two arrays have the same values; NaN is equal to NaN."""
    if a.dtype.names:
        return a.shape == b.shape and all(_equal(a[name], b[name]) for name in a.dtype.names)
    return np.array_equal(a, b, equal_nan=True)
