# SPDX-License-Identifier: GPL-2.0-only
"""Remarks on joints: of ``check``, what is drawn apart at the start or hangs by points below its own centre of mass; of a run,
what has opened."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from itertools import islice

import numpy as np

from ...effects.context import Context
from ...effects.envelope import Envelope
from ...effects.measured import Measured
from ...errors import Problem
from ...model.shapes import radius
from ...scene.formatting import number, say, vector
from .links import NOTHING, Link, links_of
from .preload import torn
from .rows import BROKEN, FIELD, FORCE, GAP, NUMBER, SIZE
from .strength import GAP as AT_REST
from .strength import Strength, strengths
from .welds import arm_of, welds_here

HIGHER = 0.02
"""Height of a centre of mass over the points by which it hangs, in sizes of the body, above which it turns over soon."""
TORN = 0.01
"""Part of the largest speed at the start, at which a joint may be drawn apart there."""
SEEN = 0.1
"""Gap of a joint that is seen, over the thinnest part of what it joins."""
IN_LINE = 1e-3
"""Distance from a line within which points are on it, in sizes of the body."""


def notes(envelope: Envelope) -> list[Problem]:
    """Remarks on a scene in which something can move: the first hinge in the middle of the wrong object, and the first body that
    hangs upside down."""
    over = (_turns_over(envelope, *found) for found in _upside_down(envelope))
    return [*islice(_misplaced_hinges(envelope), 1), *islice(over, 1)]


def _misplaced_hinges(envelope: Envelope) -> Iterator[Problem]:
    """Hinges without a place, which are in the middle of the first object, where the second one is smaller and elsewhere."""
    solids = envelope.scene.solids
    for link in links_of(envelope.scene).all:
        joint, first, second = link.joint, solids[link.first], solids[link.named]
        if joint.kind != "hinge" or joint.at is not None or link.swapped or NOTHING in (link.second, link.named):
            continue
        size = radius(second.shape)
        if size < radius(first.shape) and math.dist(first.position, second.position) > size:
            cause = f"joint {joint.words} says no place, so it is in the middle of {first.name}, outside of {second.name}"
            way_out = f"name {second.name} first, joint hinge {second.name} {first.name}, or write at {vector(second.position)} m"
            yield Problem(joint.spans.get("joint"), cause, way_out, severity="note")


def _turns_over(envelope: Envelope, whole: list[int], height: float) -> Problem:
    """The note on a body that hangs by points so far [m] below its centre of mass."""
    names = [envelope.system.names[m] for m in whole]
    what = names[0] if len(whole) == 1 else f"what is welded of {', '.join(names[:3])}{' and more' if len(whole) > 3 else ''}"
    cause = f"{what} hangs by points that are {say(height, 'm')} below its centre of mass: it turns over"
    return Problem(envelope.place(whole[0], "shape"), cause, "join it above its centre of mass", severity="note")


def drawn_apart(context: Context) -> list[Problem]:
    """The object that moves against its joints at the start more than any other, where one does."""
    joined = [(one.link, one.arm) for one in strengths(context)]
    joined += [(link, arm_of(context.scene.solids, link)) for link in welds_here(context)]
    speeds = [(torn(context, *one), one[0]) for one in joined]
    if not speeds:
        return []
    speed, worst = max(speeds, key=lambda found: found[0])
    fastest = max(math.hypot(*s.velocity) + math.hypot(*s.spin) * radius(s.shape) for s in context.scene.solids)
    if speed <= TORN * fastest:
        return []
    names = [context.scene.solids[m].name for m in (worst.first, worst.named) if m != NOTHING]
    return [
        Problem(
            worst.joint.spans.get("joint"),
            f"joint {worst.joint.words}: what it holds together moves apart at {say(speed, 'm/s')} at the start, which "
            "begins with a blow",
            f"write a velocity and a spin of {' and '.join(names)} that belong together",
            severity="warning",
        )
    ]


def opened(joints: Iterable[Strength], run: Measured) -> list[Problem]:
    """The joint, of those that hold points together, that has opened most in the frames of a run, where that is seen."""
    holding = {one.link.number: one.link.joint for one in joints if one.link.joint.kind != "spring"}
    worst, when = None, 0.0
    for n, time in enumerate(run.times.tolist()):
        rows = run.trajectory.field(FIELD, n)["value"]
        rows = rows[np.isin(rows[:, NUMBER], list(holding)) & (rows[:, BROKEN] == 0.0)]
        if not len(rows):
            continue
        most = rows[np.nanargmax(rows[:, GAP] / rows[:, SIZE])]
        if worst is None or most[GAP] * worst[SIZE] > worst[GAP] * most[SIZE]:
            worst, when = most, time
    if worst is None or not worst[GAP] > SEEN * worst[SIZE]:
        return []
    joint, gap, force = holding[int(worst[NUMBER])], float(worst[GAP]), float(worst[FORCE])
    stiffness = number(force / (4.0 * AT_REST * float(worst[SIZE])), 2)
    cause = f"joint {joint.words} has opened by {say(gap, 'm', 2)} under {say(force, 'N', 2)}, at {say(when, 's', 3)}"
    way_out = f"write stiffness {stiffness} N/m in such joints; what is taut between fixed ends pulls less with some slack"
    return [Problem(joint.spans.get("stiffness") or joint.spans.get("joint"), cause, way_out, severity="warning")]


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
    bodies: dict[int, list[Link]] = {}  # by the first objects of what is welded
    for link in links.all:
        for m in link.ends:
            bodies.setdefault(links.whole_of.get(m, [m])[0], []).append(link)
    for first, own in bodies.items():
        whole = links.whole_of.get(first, [first])
        middle = np.average(centre[whole], axis=0, weights=weight[whole])
        size = max(np.linalg.norm(centre[m] - middle) + radius(scene.solids[m].shape) for m in whole)
        members = set(whole)
        points = [_hung(link, members, centre, up) for link in own if not {link.first, link.second} <= members]
        if not all(system.rigid[m] for m in whole) or not points or any(p is None for p in points):
            continue
        apart = np.array(points) - points[0]
        height = float(((middle - np.array(points)) @ up).min())
        if height > HIGHER * size and np.linalg.svd(apart, compute_uv=False)[1:].max(initial=0.0) <= IN_LINE * size:
            yield whole, height


def _hung(link: Link, whole: set[int], centre: np.ndarray, up: np.ndarray) -> np.ndarray | None:
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
