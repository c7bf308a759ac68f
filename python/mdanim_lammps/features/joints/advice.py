# SPDX-License-Identifier: GPL-2.0-only
"""Remarks of ``check`` on joints: what hangs by points below its own centre of mass."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ...effects.envelope import Envelope
from ...errors import Problem
from ...model.shapes import radius
from ...scene.formatting import say
from .links import NOTHING, Link, links_of

HIGHER = 0.02
"""Height of a centre of mass over the points by which it hangs, in sizes of the body, above which it turns over soon."""
IN_LINE = 1e-3
"""Distance from a line within which points are on it, in sizes of the body."""


def notes(envelope: Envelope) -> list[Problem]:
    """Remarks on a scene in which something can move: the first body that hangs upside down."""
    found = next(_upside_down(envelope), None)
    if found is None:
        return []
    whole, height = found
    names = [envelope.system.names[m] for m in whole]
    what = names[0] if len(whole) == 1 else f"what is welded of {', '.join(names[:3])}{' and more' if len(whole) > 3 else ''}"
    cause = f"{what} hangs by points that are {say(height, 'm')} below its centre of mass: it turns over"
    return [Problem(envelope.place(whole[0], "shape"), cause, "join it above its centre of mass", severity="note")]


def _upside_down(envelope: Envelope) -> Iterator[tuple[list[int], float]]:
    """Bodies, as numbers of objects that are welded, all of whose joints hang on what is above, on a line below their centre of
    mass; how far below [m]."""
    scene, system, links = envelope.scene, envelope.system, links_of(envelope.scene)
    g = math.hypot(*scene.gravity)
    if not links.all or g == 0.0:
        return
    up = -np.array(scene.gravity) / g
    weight = np.add.reduceat(system.mass, system.first[:-1])
    centre = np.add.reduceat(system.mass[:, None] * system.position, system.first[:-1]) / weight[:, None]
    bodies: dict[tuple[int, ...], list[Link]] = {}
    for link in links.all:
        for m in link.ends:
            bodies.setdefault(tuple(links.whole_of.get(m, [m])), []).append(link)
    for whole, own in bodies.items():
        middle = np.average(centre[list(whole)], axis=0, weights=weight[list(whole)])
        size = max(np.linalg.norm(centre[m] - middle) + radius(scene.solids[m].shape) for m in whole)
        points = [_hung(link, whole, centre, up) for link in own if not {link.first, link.second} <= set(whole)]
        if not all(system.rigid[m] for m in whole) or not points or any(p is None for p in points):
            continue
        apart = np.array(points) - points[0]
        height = float(((middle - np.array(points)) @ up).min())
        if height > HIGHER * size and np.linalg.svd(apart, compute_uv=False)[1:].max(initial=0.0) <= IN_LINE * size:
            yield list(whole), height


def _hung(link: Link, whole: tuple[int, ...], centre: np.ndarray, up: np.ndarray) -> np.ndarray | None:
    """The point by which a joint carries a body from above; None for another joint."""
    first = link.first in whole
    point, other = (link.begin, link.second) if first else (link.end, link.first)
    if link.joint.kind == "spring":
        above = link.end if first else link.begin
    elif link.joint.kind == "ball" and other != NOTHING:
        above = centre[other]
    else:
        return None
    return np.array(point) if (np.array(above) - point) @ up > 0.0 else None
