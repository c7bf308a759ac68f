# SPDX-License-Identifier: GPL-2.0-only
"""Expected loads of joints: the weights of what hangs on each, spread over all ways to what never moves."""

from __future__ import annotations

import math

import numpy as np

from ...effects.context import Context
from ...model.shapes import radius
from ...scene.units import magnitude
from .links import NOTHING, Link, Links, parts

LOAD = 4.0
"""Load in motion, over that at rest: that of a rod that falls from above its hinge."""


def loads(context: Context, links: Links) -> list[tuple[float, float]]:
    """Load of each joint at rest, and the most that is expected [N].

    The objects that hang together are nodes, joints the springs of a net, all alike; what never moves is its ground. The weights
    flow to the ground along them: in a tree each joint bears what hangs on it, in a net they share. Where nothing holds the
    objects, half of all their weight is taken for each joint. The most is LOAD times the weights, and the forces that keep
    objects on their way at the start, m v^2/r, or drive the heavier one of a joint about as fast as motors turn, m w^2 r. What
    pushes objects from outside, as air does, counts like a weight.
    """
    if not links.all:
        return []
    system, g = context.reach.system, context.reach.g
    mass, moving = system.mass_of, _accelerations(context, links)
    pushed = context.reach.acting.thrown_by
    ground = np.logical_or.reduceat(system.held, system.first[:-1])
    ends = [[m for m in (link.first, link.second) if m != NOTHING and not ground[m]] for link in links.all]
    rest, most = np.zeros(len(links.all)), np.zeros(len(links.all))
    groups = parts(filter(None, ends))
    of_part = {m: n for n, part in enumerate(groups) for m in part}
    own: list[list[int]] = [[] for _ in groups]
    for n, end in enumerate(ends):
        if end:
            own[of_part[end[0]]].append(n)
        else:  # both are held in a part, and deform
            rest[n] = most[n] = mass[[m for m in (links.all[n].first, links.all[n].second) if m != NOTHING]].sum() * g
    for part, numbers in zip(groups, own):
        weights = np.stack([mass[part] * (g + pushed[part]), mass[part] * (LOAD * g + pushed[part] + moving[part])])
        if any(len(ends[n]) == 1 for n in numbers):
            rest[numbers], most[numbers] = _flow(part, [ends[n] for n in numbers], weights)
        else:
            rest[numbers], most[numbers] = 0.5 * weights.sum(axis=1)
        if driven := max(_drives(context, links.all[n]) for n in numbers):
            most[numbers] += driven * np.array([max(mass[m] for m in ends[n]) for n in numbers])
    for n, link in enumerate(links.all):
        if (motor := link.joint.motor) is not None and motor.most is not None:
            most[n] += motor.most if link.joint.kind == "slider" else motor.most / _size(context, link)
    return list(zip(rest.tolist(), most.tolist()))


def _drives(context: Context, link: Link) -> float:
    """Acceleration that the motor of a hinge gives to what hangs together with it, w^2 r [m/s^2]."""
    if link.joint.motor is None or link.joint.kind != "hinge":
        return 0.0
    return magnitude(link.joint.motor.speed) ** 2 * _size(context, link)


def _flow(part: list[int], ends: list[list[int]], weights: np.ndarray) -> np.ndarray:
    """Flows along joints [N], shape (2, J), of weights of the objects of a part, shape (2, n)."""
    from scipy.sparse import coo_array  # both take 0.2 s
    from scipy.sparse.linalg import spsolve

    number = {m: n for n, m in enumerate(part)}
    rows, columns, values = [], [], []
    for end in ends:
        i = [number[m] for m in end]
        rows += i
        columns += i
        values += [1.0] * len(i)
        if len(i) == 2:
            rows += i
            columns += i[::-1]
            values += [-1.0, -1.0]
    net = coo_array((values, (rows, columns)), shape=(len(part), len(part))).tocsc()
    height = np.atleast_2d(spsolve(net, weights.T).T) if len(part) > 1 else weights / net.toarray()[0, 0]
    at = np.array([[number[m] for m in (end if len(end) == 2 else end * 2)] for end in ends])
    flows = height[:, at[:, 0]] - np.where([len(end) == 2 for end in ends], height[:, at[:, 1]], 0.0)
    return np.abs(flows)


def _accelerations(context: Context, links: Links) -> np.ndarray:
    """v^2/r of each object by its motion at the start [m/s^2], shape (M,)."""
    scene = context.scene
    found = np.zeros(len(scene.solids))
    for link in links.all:
        for m, point in ((link.first, link.begin), (link.second, link.end)):
            if m == NOTHING:
                continue
            solid = scene.solids[m]
            r = max(radius(solid.shape), math.dist(solid.position, point))
            speed = math.hypot(*solid.velocity) + math.hypot(*solid.spin) * r
            found[m] = max(found[m], speed**2 / r)
    return found


def _size(context: Context, link: Link) -> float:
    """Radius of the smaller object of a joint [m]."""
    return min(radius(context.scene.solids[m].shape) for m in (link.first, link.second) if m != NOTHING)
