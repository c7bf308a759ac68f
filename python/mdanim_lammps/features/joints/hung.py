# SPDX-License-Identifier: GPL-2.0-only
"""Groups of objects that hang together by joints that do not break, and how far each may come down in its group."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from ...bodies import kind_of
from ...model import shapes
from ...reach import Hung
from ...scene import units
from ...scene.schema import Vector
from .links import Link, Links, parts, play

ANGLES = 181
"""Angles of a hinge with limits at which heights are looked up."""


def hung(links: Links) -> list[Hung]:
    """The groups of rigid objects that can move."""
    held = [link for link in links.all if _holds(links, link)]
    groups = parts(link.ends for link in held)
    return [_group(links, part, [link for link in held if link.first in part]) for part in groups]


def _holds(links: Links, link: Link) -> bool:
    """Whether a joint keeps two rigid objects that can move at each other for good."""
    if len(link.ends) < 2 or link.joint.breaks is not None or play(link) == math.inf:
        return False
    return not any(kind_of(links.solids[m]).deforms or links.solids[m].hold for m in link.ends)


def _group(links: Links, part: list[int], held: Iterable[Link]) -> Hung:
    """From its heaviest object on, joint by joint: each turns about the last joint that is not a weld, which comes down, too."""
    solids, ways = links.solids, {m: [] for m in part}
    for link in held:
        ways[link.first].append((link.second, link))
        ways[link.second].append((link.first, link))
    first = max(part, key=lambda m: shapes.mass(solids[m]))
    turns: dict[int, tuple[float, Link | None, bool]] = {first: (0.0, None, False)}

    def sunk(m: int, point: Vector) -> float:
        own, link, is_first = turns[m]
        return own + (_sunk(link, is_first, point) if link is not None else 0.0)

    waiting = [first]
    for m in waiting:
        for other, link in ways[m]:
            if other not in turns:
                is_first = other == link.first
                foot = link.end if is_first else link.begin
                turns[other] = turns[m] if link.joint.kind == "weld" else (sunk(m, foot), link, is_first)
                waiting.append(other)
    return Hung(first, {m: sunk(m, solids[m].position) for m in part})


def _sunk(link: Link, is_first: bool, point: Vector) -> float:
    """How far a point of one object that a joint holds at another may come down, if that one stays [m]."""
    foot, top = (link.end, link.begin) if is_first else (link.begin, link.end)
    if link.joint.kind == "slider":
        return play(link)
    if link.joint.kind != "hinge" or link.axis is None:
        return max(0.0, point[2] - foot[2] + play(link) + math.dist(point, top))
    axis = np.array(link.axis) / np.linalg.norm(link.axis) * (1.0 if is_first else -1.0)
    arm = np.subtract(point, top)
    across = arm - (arm @ axis) * axis
    low, high = (-math.pi, math.pi) if link.joint.limits is None else (units.magnitude(x) for x in link.joint.limits)
    angle = np.linspace(low, high, ANGLES)
    height = across[2] * np.cos(angle) + np.cross(axis, across)[2] * np.sin(angle)
    return max(0.0, float(across[2] - height.min()))
