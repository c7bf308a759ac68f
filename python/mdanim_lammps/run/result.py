# SPDX-License-Identifier: GPL-2.0-only
"""What a run has left, for Python."""

from __future__ import annotations

from collections import deque
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from weakref import ref

from ..errors import MdanimError, Problem
from ..export import Exported, export
from ..picture.movie import render_still
from ..results.cost import Cost
from ..results.expect import Outcome
from ..results.html import THUMBNAIL, html_table
from ..results.ledger import Ledger
from ..results.trajectory import Trajectory
from ..scene.formatting import number
from ..scene.render import Render

STAY_OPEN = 32
"""Trajectories of results that stay open: a process has some 1000 files."""
_recent: deque[Trajectory] = deque(maxlen=STAY_OPEN)


@dataclass(repr=False)
class Result:
    """What a run has left."""

    folder: Path
    ledger: Ledger
    outcomes: list[Outcome] = field(default_factory=list)
    cost: Cost | None = None
    """Seconds per effect and per other piece of work."""
    warnings: list[Problem] = field(default_factory=list)
    """What was seen in the run that does not stop it."""
    values: dict[str, float | str] = field(default_factory=dict)
    """Values of the scene's ``let`` names that were given for this run."""
    _opened: ref[Trajectory] | None = field(default=None, compare=False)

    @property
    def missed(self) -> list[Outcome]:
        return [o for o in self.outcomes if not o.met]

    @property
    def trajectory(self) -> Trajectory:
        """The frames; opened when they are first asked for, and closed with nothing left that refers to them. The last few that
        were opened stay open. Raises OutputError."""
        if (found := self._opened and self._opened()) is None:
            found = Trajectory(self.folder)
            self._opened = ref(found)
            _recent.append(found)
        return found

    def __getstate__(self) -> dict:
        return self.__dict__ | {"_opened": None}

    def export(self, to: str, path: str | Path | None = None, **options) -> Exported:
        """Write the run as a file of another program; arguments and errors are those of `mdanim_lammps.export.export`."""
        return export(self.folder, to, path, **options)

    def __repr__(self) -> str:
        values = "".join(f"{name}={value}, " for name, value in self.values.items())
        missed = f", {len(self.missed)} of {len(self.outcomes)} expectations missed" if self.missed else ""
        residual = number(self.ledger.residual, 3)
        return f"<Result {self.folder}: {values}{len(self.ledger.rows)} frames, energy residual {residual}{missed}>"

    def _repr_html_(self) -> str:
        rows = [
            (
                f"{o.expect.subject}.{o.expect.quantity}",
                number(o.expect.value, 4),
                number(o.found, 4),
                "met" if o.met else "MISSED",
            )
            for o in self.outcomes
        ]
        picture = None
        with TemporaryDirectory(prefix="mdanim-picture-") as name, suppress(MdanimError):
            scene = self.trajectory.scene
            render = Render() if scene is None else scene.render
            picture = render_still(self.trajectory, -1, Path(name) / "end.png", render, size=THUMBNAIL).read_bytes()
        return html_table(repr(self)[1:-1], ("expected", "value", "found", ""), rows, picture)
