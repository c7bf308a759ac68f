# SPDX-License-Identifier: GPL-2.0-only
"""Welds between rigid objects: these move as one body of ``fix mdanim/rigid`` (docs/physics-joints.md, "Welds of rigid
objects")."""

from __future__ import annotations

import math

import numpy as np

from ...effects.context import Context
from ...model.shapes import thickness
from ...scene.once import once_for
from ...scene.scene import SceneRecord
from ..rigid.touching import AT, BEARS_FORCE, BEARS_TORQUE, told_of_bodies
from .links import Link, Links, links_of
from .rows import TOLD


def welds_here(context: Context) -> list[Link]:
    """The welds of a context that make one body of two objects."""
    names = set(context.system.names)
    solids = context.scene.solids
    return [link for link in links_of(context.scene).welds if solids[link.first].name in names] if context.scene.joints else []


def thin_of(scene: SceneRecord, link: Link) -> float:
    """Thinnest part of what a weld joins [m]."""
    return min(thickness(scene.solids[m].shape) for m in link.ends)


def arm_of(scene: SceneRecord, link: Link) -> float:
    """Distance of a weld from the farther one of the centres of what it joins [m]."""
    return max(math.dist(scene.solids[m].position, link.begin) for m in link.ends)


def told_of_welds(readings) -> np.ndarray:
    """Columns that rows of joints tell of the welds of a context, shape (J, TOLD). A weld that closes a ring bears nothing."""
    context = readings.context
    here = welds_here(context)
    found = np.zeros((len(here), TOLD))
    if not here:
        return found
    names = {solid.name: m for m, solid in enumerate(context.scene.solids)}
    rows = {names[context.system.names[m]]: row for m, row in told_of_bodies(readings).items()}
    hangs = hung_by(links_of(context.scene))
    for n, link in enumerate(here):
        row = rows[hangs.get(link.number, link.first)]
        if link.number in hangs:
            found[n, 0] = np.linalg.norm(row[BEARS_FORCE])
            found[n, 1] = np.linalg.norm(row[BEARS_TORQUE])
            found[n, 7:] = np.tile(row[AT], 2)
        else:
            found[n, 7:] = np.nan
    return found


@once_for(lambda links: links)
def hung_by(links: Links) -> dict[int, int]:
    """The object that hangs on the first one of its body by a weld, by the number of the weld. Welds that close rings are not
    among them."""
    at: dict[int, list[Link]] = {}
    for link in links.welds:
        for m in link.ends:
            at.setdefault(m, []).append(link)
    found: dict[int, int] = {}
    for first in sorted({part[0] for part in links.whole_of.values()}):
        reached, todo = {first}, [first]
        for m in todo:
            for link in at[m]:
                other = link.first if link.second == m else link.second
                if other not in reached:
                    reached.add(other)
                    todo.append(other)
                    found[link.number] = other
    return found
