# SPDX-License-Identifier: GPL-2.0-only
"""Remarks of ``check`` on materials: what is rigid because of what it is made of."""

from __future__ import annotations

from ...bodies import all_held
from ...effects.envelope import Envelope
from ...errors import Problem
from ...scene.formatting import say
from ...scene.naming import told_together
from ...scene.scene import Solid
from ..rigid.words import Rigid
from .resolve import STIFF
from .table import MATERIALS

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
    cause = (
        f"rigid by material: {', '.join(told[:MOST])}{more}: waves in it take {STIFF:g} m/s or more, so nobody would see it bend"
    )
    first = next(iter(found))
    figure = f"elasticity {say(MATERIALS[first].elasticity.value, 'Pa')}" if first in MATERIALS else "its elasticity"
    way_out = f"to see it bend all the same write {figure} beside material {first}"
    return [Problem(found[first][0].spans.get("material"), cause, way_out, severity="note")]


def _said(solid: Solid) -> bool:
    """Whether an object says itself that it is rigid: what follows from a material has the place that names the material."""
    return solid.spans.get("elasticity") != solid.spans.get("material")
