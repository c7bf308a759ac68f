# SPDX-License-Identifier: GPL-2.0-only
"""Remarks of ``check`` on materials: what is rigid because of what it is made of."""

from __future__ import annotations

from ...bodies import all_held
from ...effects.envelope import Envelope
from ...errors import Problem
from ...scene.naming import told_together
from ...scene.scene import Solid
from ..rigid.words import Rigid

MOST = 3
"""Materials that are told one by one."""


def notes(envelope: Envelope) -> list[Problem]:
    """One on all objects that move and are rigid by their materials."""
    found: dict[str, list[Solid]] = {}
    for solid in envelope.scene.solids:
        if solid.material and isinstance(solid.elasticity, Rigid) and not all_held(solid) and not _said(solid):
            found.setdefault(solid.material, []).append(solid)
    if not found:
        return []
    told = [f"{told_together([s.name for s in of])} ({name})" for name, of in found.items()]
    more = f" and objects of {len(told) - MOST} more" if len(told) > MOST else ""
    cause = f"rigid by material: {', '.join(told[:MOST])}{more}"
    return [Problem(next(iter(found.values()))[0].spans.get("material"), cause, severity="note")]


def _said(solid: Solid) -> bool:
    """Whether an object says itself that it is rigid: what follows from a material has the place that names the material."""
    return solid.spans.get("elasticity") != solid.spans.get("material")
