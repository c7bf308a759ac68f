# SPDX-License-Identifier: GPL-2.0-only
"""Remarks of ``check`` on materials: what is rigid because of what it is made of, masses that no material gives."""

from __future__ import annotations

from ...bodies import all_held
from ...effects.envelope import Envelope
from ...errors import Problem
from ...model import shapes
from ...scene.formatting import number, whole
from ...scene.naming import told_together
from ...scene.scene import Solid
from ..rigid.words import Rigid

MOST = 3
"""Materials that are told one by one."""
LIGHTEST, HEAVIEST = 0.05, 30_000.0
"""Densities between which those of all materials are [kg/m^3], with some room: hydrogen has 0.08, osmium 22 600."""


def notes(envelope: Envelope) -> list[Problem]:
    """On what is rigid by its material, and on masses that are likely mistyped."""
    return [*_rigid(envelope), *_masses(envelope)]


def _masses(envelope: Envelope) -> list[Problem]:
    """One on all objects that move and are heavier than any metal, or lighter than any gas."""
    found: list[tuple[Solid, float]] = []
    for solid in envelope.scene.solids:
        if not all_held(solid) and (volume := shapes.volume(solid.shape)) > 0.0:
            density = solid.density if solid.mass is None else solid.mass / volume
            if density is not None and not LIGHTEST <= density <= HEAVIEST:
                found.append((solid, density))
    if not found:
        return []
    solid, density = found[0]
    told, beside = number(density, 3), "air has 1.2"
    if density > HEAVIEST:
        told, beside = whole(round(density)), f"gold has {whole(19_300)}"
    cause = f"{told_together([s.name for s, _ in found])}: {told} kg/m^3, and {beside}"
    way_out = "mass is that of the whole object; density 1000 kg/m^3 is that of water"
    return [Problem(solid.spans.get("mass", solid.spans.get("density")), cause, way_out, severity="note")]


def _rigid(envelope: Envelope) -> list[Problem]:
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
