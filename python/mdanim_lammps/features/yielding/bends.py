# SPDX-License-Identifier: GPL-2.0-only
"""Bends of sheets that stay, by rings and lines across them, as ``fix mdanim/yield`` reads them (docs/physics-yielding.md)."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...effects.context import Context
from ...effects.fields import BENT, Field, Fields, column
from ...model.bends import BendRings
from ...model.model import Model
from ...scene.once import once_for
from .words import yields

PLASTIC = 1.5
"""Moment of a rectangular section that yields all through, over that at which its outer fibre does."""
STIFFEST = 50.0
"""Stiffness of a ring by what it is bent for good, over sum c b w l/A of its lines, with the largest weight w and the longest
spoke l, at most: of random ones, up to folded flat, the largest is 33 (tests/effects/test_bends_that_stay.py)."""


def is_layer(solid: Any) -> bool:
    """Whether bends of an object stay: of a sheet that resists bending."""
    return yields(solid) and getattr(solid.shape, "bending", 0.0) > 0.0


def field_of(context: Context) -> Field | None:
    """The column of a scene, with room for the most lines that a particle has; None where no sheet yields."""
    most = max((_slots(model)[1] for m, model in enumerate(context.models) if is_layer(context.scene.solids[m])), default=0)
    return column(BENT, "1/m", shape=(most,), state=True) if most else None


@once_for(lambda model: model)
def rings(model: Model) -> BendRings:
    """The rings of an object that bend."""
    return BendRings(model.frame.rings(model.held))


@once_for(lambda model: model)
def _places(model: Model) -> tuple[np.ndarray, np.ndarray]:
    """The particle of each line, and the place of the line among its own, both of shape (L,)."""
    all_of, within = rings(model), np.array(_slots(model)[0], np.int64)
    return all_of.middle[all_of.of], within[all_of.of] + np.arange(len(all_of.of)) - all_of.first[all_of.of]


@once_for(lambda model: model)
def _slots(model: Model) -> tuple[list[int], int]:
    """The place of the first line of each ring among those of its middle particle, and the most lines of a particle."""
    used, found = [0] * len(model.position), []
    for ring in rings(model):
        found.append(used[ring.middle])
        used[ring.middle] += len(ring.lines)
    return found, max(used, default=0)


@once_for(lambda model: model)
def first_bends(model: Model) -> np.ndarray:
    """Curvatures along all lines at the start [1/m], shape (L,)."""
    return rings(model).curvatures(model.position)


def first_values(context: Context, field: Field) -> np.ndarray:
    """The column at the start, shape (N, L): without load a sheet that yields is as it is drawn."""
    system, found = context.system, np.zeros((context.system.particles, *field.shape))
    for m, (model, solid) in enumerate(zip(context.system_models, context.solids)):
        if is_layer(solid):
            own = _first_values(model)
            found[system.first[m] : system.first[m + 1], : own.shape[1]] = own
    return found


@once_for(lambda model: model)
def _first_values(model: Model) -> np.ndarray:
    """The same of one object, with room for its own lines, shape (n, K)."""
    found = np.zeros((len(model.position), _slots(model)[1]))
    found[_places(model)] = first_bends(model)
    return found


def rigidity(solid: Any) -> float:
    """E t^3 and the factor of its bending [N m], of which lines have their parts."""
    return solid.shape.bending * solid.elasticity.modulus * solid.shape.thickness**3


def table(context: Context, share: Any) -> str:
    """The file of rings: ``share`` gives the part of the yield-strain that what lies along a direction of an object bears."""
    lines = ["# Bends that stay, written by mdanim-lammps: object MOLECULE, rings and the lines across them\n"]
    for m, (model, solid) in enumerate(zip(context.system_models, context.solids)):
        if not is_layer(solid):
            continue
        stiff, most = rigidity(solid), PLASTIC * 2.0 * solid.yield_strain / solid.shape.thickness
        lines.append(f"object {m + 1}\n")
        begins = np.split(first_bends(model), rings(model).first[1:-1])
        for ring, slot, first in zip(rings(model), _slots(model)[0], begins):
            kind, around = "closed" if ring.closed else "open", " ".join(map(str, (ring.around + 1).tolist()))
            lines.append(f"ring {ring.middle + 1} {slot} {kind} {2.0 * ring.area!r} {around}\n")
            for line, bend in zip(ring.lines, first.tolist()):
                bears = most * float(share(context, m, line.direction[None])[0])
                of = " ".join(f"{p + 1} {float(w)!r}" for p, w in zip(line.particle, line.weight))
                lines.append(f"line {float(stiff * line.stiffness)!r} {bears!r} {bend!r} {of}\n")
    return "".join(lines) if len(lines) > 1 else ""


def energy(context: Context, m: int, position: np.ndarray, fields: Fields) -> float:
    """Energy of what lines of an object are bent by for good, beyond that of the springs [J] (plugin/tearing/bend_law.h)."""
    if fields.get(BENT) is None or not is_layer(context.solids[m]):
        return 0.0
    model, first = context.system_models[m], int(context.system.first[m])
    start, now = first_bends(model), rings(model).curvatures(position[first : first + len(model.position)])
    b = np.asarray(fields[BENT])[first:][_places(model)]
    return rigidity(context.solids[m]) * float(rings(model).stiffness @ (0.5 * (b**2 + start**2) - b * now))


def strain(context: Context, m: int, fields: Fields) -> float:
    """Largest strain of the faces of a sheet by what it is bent for good, t/2 times the change of a curvature [-]."""
    if fields.get(BENT) is None or not is_layer(context.solids[m]):
        return 0.0
    own, start = slice(*context.system.first[m : m + 2]), _first_values(context.system_models[m])
    change = np.asarray(fields[BENT])[own, : start.shape[1]] - start
    return 0.5 * context.solids[m].shape.thickness * float(np.abs(change).max(initial=0.0))


def stiffness(model: Model, solid: Any) -> np.ndarray:
    """Bound on the stiffness of particles by what is bent for good [N/m], shape (n,): lines may be folded, and bear the rest."""
    found = np.zeros(len(model.position))
    most = PLASTIC * 2.0 * solid.yield_strain / solid.shape.thickness
    for ring in rings(model):
        spoke = float(np.linalg.norm(model.position[ring.around] - model.position[ring.middle], axis=1).max())
        share = sum(line.stiffness * max(map(abs, line.weight)) * (line.sharpest + most) for line in ring.lines)
        share *= STIFFEST * spoke / (2.0 * ring.area)
        found[ring.middle] += share
        np.add.at(found, ring.around, share)
    return rigidity(solid) * found
