# SPDX-License-Identifier: GPL-2.0-only
"""What a run has left, for Python."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from ..errors import Problem
from ..export import Exported, export
from ..results.cost import Cost
from ..results.expect import Outcome
from ..results.ledger import Ledger
from ..results.trajectory import Trajectory


@dataclass
class Result:
    """What a run has left."""

    folder: Path
    ledger: Ledger
    outcomes: list[Outcome] = field(default_factory=list)
    cost: Cost | None = None
    """Seconds per effect and per other piece of work."""
    warnings: list[Problem] = field(default_factory=list)
    """What was seen in the run that does not stop it."""

    @property
    def missed(self) -> list[Outcome]:
        return [o for o in self.outcomes if not o.met]

    @cached_property
    def trajectory(self) -> Trajectory:
        """The frames. Raises OutputError."""
        return Trajectory(self.folder)

    def export(self, to: str, path: str | Path | None = None, **options) -> Exported:
        """Write the run as a file of another program; arguments and errors are those of `mdanim_lammps.export.export`."""
        return export(self.folder, to, path, **options)
