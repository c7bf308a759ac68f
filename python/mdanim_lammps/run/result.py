# SPDX-License-Identifier: GPL-2.0-only
"""The result of a simulation, beside the files that it has written."""

from __future__ import annotations

from dataclasses import field
from pathlib import Path

from ..errors import Problem
from ..records import dataclass
from ..results.cost import Cost
from ..results.expect import Outcome
from ..results.ledger import Ledger


@dataclass
class Result:
    """The result of a simulation."""

    folder: Path
    ledger: Ledger
    outcomes: list[Outcome] = field(default_factory=list)
    cost: Cost | None = None
    """Seconds per effect and per other piece of work."""
    warnings: list[Problem] = field(default_factory=list)
    """Problems seen in the run that do not stop it."""

    @property
    def missed(self) -> list[Outcome]:
        """Outcomes of ``expect`` lines that were not met."""
        return [o for o in self.outcomes if not o.met]
