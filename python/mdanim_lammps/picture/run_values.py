# SPDX-License-Identifier: GPL-2.0-only
"""Values of quantities that pictures tell, from the frames and the ledger of a run."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

import numpy as np

from ..effects.measured import Measured, Of, Recorded
from ..errors import OutputError, UsageError
from ..results.files import read_json
from ..results.ledger import Ledger
from ..results.quantities import quantity_of, series
from ..results.stored import SUMMARY
from ..results.trajectory import Trajectory
from ..scene.naming import objects_by_name
from ..scene.quantities import GLOBALS, PLANES, Asked


class RunValues:
    """Quantities of a run at all of its frames.

    Args:
        trajectory: of the run; one that has only its start has no ledger, and no values that need one.
        columns: of its ledger, each of shape (F,); None reads ledger.csv when it is needed.
    """

    def __init__(self, trajectory: Trajectory, columns: Mapping[str, np.ndarray] | None = None):
        self.trajectory, self.times = trajectory, trajectory.times
        if columns is not None:
            self._columns = columns

    def series(self, of: Of) -> np.ndarray:
        """Values in SI units, shape (F,), NaN where there are none.

        Raises UsageError for a quantity that the run has not recorded, or of an object that it does not have, OutputError where
        its scene cannot be read here.
        """
        other = [of.argument] if of.kind.takes in ("object", "touched") and of.argument not in (None, *PLANES) else []
        for name in ([] if of.subject in GLOBALS else [of.subject]) + other:
            if name not in (self._by_name if of.of == "NAMES" else self.trajectory.names):
                raise UsageError(f"{self.trajectory.path} has no object {name}, and {of.what} is to be shown")
        quantity = quantity_of(of)
        if isinstance(quantity, Recorded) and not self.has(quantity.column_of(of)):
            missing = f"the run has not recorded {of.quantity} of {of.subject}"
            raise UsageError(f"{missing}; write it in the scene, record {of.what}, and run it again")
        return series(of, self._measured)

    @cached_property
    def _by_name(self) -> dict[str, list[int]]:
        return objects_by_name(self.trajectory.names)

    @property
    def end(self) -> float:
        """Time of the last frame; of a run that has only its start the time that its scene asks for [s]."""
        last, scene = float(self.times[-1]), self.trajectory.scene
        return last if last > 0.0 or scene is None else scene.control.time

    def is_mean(self, of: Of) -> bool:
        """Whether the value of a frame is the mean since the frame before."""
        return quantity_of(of).since

    def vector(self, name: str, word: str) -> np.ndarray:
        """The three components of a vector of an object, shape (F, 3)."""
        return np.stack([self.series(Asked(name, f"{word}.{axis}")) for axis in "xyz"], axis=1)

    @cached_property
    def _measured(self) -> Measured:
        t = self.trajectory
        if t.scene is None:
            raise OutputError(f"{t.path}: the scene of this run, or one of its meshes, cannot be read here")
        grid = next((kept.grid for kept in t.metadata.kept.values() if hasattr(kept, "grid")), None)
        deepest = self._deepest()
        return Measured(t.scene, t.names, grid, t.times, t.centers, t.center_velocities, deepest, self._column, t, self.has)

    def _deepest(self) -> float:
        """Deepest penetration of a run that has ended [m]; NaN of others."""
        path = self.trajectory.path.parent / "summary.json"
        found = read_json(path, SUMMARY).get("penetration") if path.exists() else None
        return np.nan if found is None else found

    def has(self, column: str) -> bool:
        """Whether the ledger of the run has a column; OutputError where it is damaged."""
        return self._columns is None or column in self._columns

    def _column(self, name: str) -> np.ndarray:
        """A column of the ledger. Raises UsageError where it has none of this name."""
        if self._columns is None:
            return np.full(1, np.nan)
        if not self.has(name):
            raise UsageError(f"the ledger of the run has no column {name}, which a quantity of the pictures is found from")
        return self._columns[name][: len(self.trajectory)]

    @cached_property
    def _columns(self) -> Mapping[str, np.ndarray] | None:
        """None where a run has only its start."""
        path = self.trajectory.path.parent / "ledger.csv"
        if len(self.trajectory) == 1 and not path.exists():
            return None
        ledger = Ledger.read(path, most=len(self.trajectory))
        return {name: ledger.array(name) for name in ledger.columns}
