# SPDX-License-Identifier: GPL-2.0-only
"""Objects that stand on each other at the start: what ``check`` tells of towers that will not stand."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ...effects.envelope import Envelope
from ...errors import Problem
from ...model.boxes import box_pairs
from ...model.overlap import BORN_AT_REST
from ...model.shapes import extent
from ...records import dataclass
from ...scene.formatting import at_least, say
from ...scene.scene import Box, Cylinder, Solid
from .resting import LEVEL, floors
from .words import ContactModel

GREENHILL = 7.837
"""m g H^2 over E I of the tallest uniform column that stands."""
TALL = 0.9
"""Part of that height from which a tower of cubes that are a little askew falls: ten and six cubes of two cells did from 0.92 on;
at 0.83 a tower swayed by a quarter of a side."""


def towers(envelope: Envelope) -> list[Problem]:
    """Towers that buckle under their own weight though they are drawn standing: the worst of all.

    A uniform column buckles at m g H^2 = 7.837 E I (Greenhill). Surfaces that lie on each other are as soft as half a spacing
    more of the column, and on a plane as a whole one.
    """
    g, scene = envelope.reach.g, envelope.scene
    if (
        not scene.solids
        or scene.control.contact_model is ContactModel.PAPER
        or g <= 0.0
        or envelope.reach.acting.changes
        or math.hypot(*scene.gravity[:2]) > LEVEL * g
    ):
        return []
    found = [t for t in _columns(envelope) if t.height > TALL * t.most]
    if not found:
        return []
    tower = max(found, key=lambda t: t.height / t.most)
    names = [envelope.system.names[m] for m in tower.members]
    what = f"{names[0]} to {names[-1]} stand" if names[1:] else f"{names[0]} stands"
    young = float(envelope.system.young[tower.members].min()) * (tower.height / (TALL * tower.most)) ** 3
    return [
        Problem(
            envelope.place(tower.members[0], "elasticity", "object"),
            f"{what} {say(tower.height, 'm')} high and will fall over: from {say(TALL * tower.most, 'm')} on its own weight "
            "makes such a tower buckle",
            f"write an elasticity of {say(at_least(young, 2), 'Pa')}, a lower density, or a lower tower",
            severity="note",
        )
    ]


@dataclass(frozen=True, slots=True)
class _Column:
    """Objects that stand on each other, one on one."""

    members: list[int]
    """From the lowest on."""
    height: float
    most: float
    """Height at which it buckles [m]."""


def _columns(envelope: Envelope) -> Iterator[_Column]:
    """Cuboids and cylinders with an axis upright, on a plane, on a solid that never moves, or held only at the foot."""
    system, moving = envelope.system, envelope.reach.moving
    low, high = _drawn(envelope.scene.solids)
    near = BORN_AT_REST * system.spacing
    pairs = list(box_pairs(low - near[:, None], high + near[:, None]))
    i, j = (np.concatenate([np.zeros(0, int), *(both[k] for both in pairs)]) for k in (0, 1))
    below, above = np.where(low[i, 2] < low[j, 2], i, j), np.where(low[i, 2] < low[j, 2], j, i)
    close = np.maximum(near[below], near[above])
    beside = np.maximum(low[below] - high[above], low[above] - high[below])[:, :2].max(axis=1)
    stands = (np.abs(high[below, 2] - low[above, 2]) <= close) & (beside <= close)
    below, above = below[stands], above[stands]
    bears, borne = (np.bincount(these, minlength=len(moving)) for these in (below, above))
    on = dict(zip(below.tolist(), above.tolist()))
    z = system.position[:, 2]
    bottom, top = system.bounds(system.position)
    lowest = np.minimum.reduceat(np.where(system.held, z, np.inf), system.first[:-1])
    highest = np.maximum.reduceat(np.where(system.held, z, -np.inf), system.first[:-1])
    floor = (lowest <= bottom[:, 2] + near) & (highest < top[:, 2] - near)
    for plane in floors(envelope):
        floor |= np.abs(low[:, 2] - plane.at) <= near
    floor[above[~moving[below]]] = True
    moving = moving & ~envelope.reach.acting.acted_on
    for m in np.flatnonzero(moving & floor).tolist():
        members = [m]
        while bears[members[-1]] == 1 and borne[on[members[-1]]] == 1 and moving[on[members[-1]]]:
            members.append(on[members[-1]])
        if bears[members[-1]] == 0 and (column := _column(envelope, members, float(high[members[-1], 2] - low[m, 2]))):
            yield column


def _drawn(solids: tuple[Solid, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Corners of boxes around what is drawn, (M, 3) [m], exact where the axes of a body are those of the world."""
    extents = {shape: np.array(extent(shape)) for shape in {s.shape for s in solids}}
    low, high = np.moveaxis(np.array([extents[s.shape] for s in solids]), 1, 0)
    turned = np.array([s.rotation for s in solids])
    middle = np.array([s.position for s in solids]) + np.einsum("mij,mj->mi", turned, 0.5 * (low + high))
    half = np.einsum("mij,mj->mi", np.abs(turned), 0.5 * (high - low))
    return middle - half, middle + half


def _column(envelope: Envelope, members: list[int], height: float) -> _Column | None:
    """The column of these objects, if all are of a kind that stands upright."""
    system = envelope.system
    bending = [_second_moment(envelope.scene.solids[m]) for m in members]
    if 0.0 in bending:
        return None
    stiffness = min(b * float(system.young[m]) for b, m in zip(bending, members))
    weight = float(system.mass_of[members].sum()) * envelope.reach.g
    h = system.spacing[members]
    joints = float(h[0]) + 0.5 * float(np.maximum(h[:-1], h[1:]).sum())
    most = height * (GREENHILL * stiffness / (weight * height * (height + joints))) ** (1 / 3)
    return _Column(members, height, most)


def _second_moment(solid: Solid) -> float:
    """Least of the horizontal section of a cuboid or cylinder that stands upright [m^4]; 0 for all else."""
    cosine = np.abs(np.array(solid.rotation))[2]
    axis = int(cosine.argmax())
    if cosine[axis] < 1.0 - LEVEL:
        return 0.0
    if isinstance(solid.shape, Cylinder) and axis == 2:
        return math.pi * solid.shape.radius**4 / 4.0
    if isinstance(solid.shape, Box):
        a, b = sorted(np.delete(np.array(solid.shape.size), axis).tolist())
        return b * a**3 / 12.0
    return 0.0
