# SPDX-License-Identifier: GPL-2.0-only
"""Time that words which features propose would save: the scene with them is forecast as the scene itself is."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

from ..effects.envelope import Envelope
from ..effects.proposal import Proposal
from ..errors import MdanimError
from ..features import facets
from ..records import dataclass
from ..results.cost import Cost
from ..results.trajectory import Trajectory
from ..run.prepare import Prepared, prepare
from .forecast import forecast

LEAST = 2.0
"""Seconds of a run from which on it is asked how it gets quicker."""
MOST = 0.5
"""Part of the time that is left, above which nothing is told."""


@dataclass(frozen=True, slots=True)
class Saving:
    """Words that save time."""

    proposal: Proposal
    now: float
    """Seconds of the run as it is, without loading and modelling [s]."""
    then: float
    """The same with these words."""

    def to_json(self) -> dict:
        """Plain data."""
        groups = [{"objects": name, "reason": why} for name, why in self.proposal.groups]
        return {"words": self.proposal.words, "how": self.proposal.how, "groups": groups, "now": self.now, "then": self.then}


def before_run(ready: Prepared, cost: object) -> list[Saving]:
    """Savings that are expected of a scene with this forecast. Raises SetupError."""
    if not isinstance(cost, Cost):
        return []
    envelope = Envelope(ready.context, {}, ready.certificate.timestep)
    return list(_savings(_run_seconds(cost), (facet.before(envelope) for facet in facets("proposal"))))


def after_run(ready: Prepared, folder: Path, cost: Cost) -> list[Saving]:
    """Savings that a run with its trajectory in a folder has shown. Raises SetupError, OutputError."""
    if _run_seconds(cost) < LEAST:
        return []
    with Trajectory(folder) as trajectory:
        proposals = [facet.after(ready.context, trajectory) for facet in facets("proposal")]
    return list(_savings(_run_seconds(cost), proposals))


def _run_seconds(cost: Cost) -> float:
    return cost.total - cost.other.get("setup", 0.0)


def _savings(now: float, proposals: Iterable[Proposal | None]) -> Iterator[Saving]:
    if now < LEAST:
        return
    for proposal in proposals:
        then = None if proposal is None else _forecast(proposal)
        if then is not None and then < MOST * now:
            yield Saving(proposal, now, then)


def _forecast(proposal: Proposal) -> float | None:
    """Seconds of the run of a proposal; None where it cannot be run, or not be forecast."""
    try:
        cost = forecast(prepare(proposal.scene), movie=False)
    except MdanimError:
        return None
    return _run_seconds(cost) if isinstance(cost, Cost) else None
