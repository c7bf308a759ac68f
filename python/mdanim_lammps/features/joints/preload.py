# SPDX-License-Identifier: GPL-2.0-only
"""Loads that joints between rigid objects bear from the start, so that nothing begins with a jerk (docs/physics-joints.md, "The
start").

With the matrix J of all motions that joints hold, the accelerations a of the bodies without them, and what turns at the start,
the loads lambda keep J q'' + J' q' = 0:

    J M^-1 J' lambda = -J a - J' q'

Where joints share a load, as two hinges of a door do, the least loads are taken.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ...effects.context import Context
from .ends import JointEnd, both_across, directions_of, skew, unit
from .links import NOTHING, Link

if TYPE_CHECKING:
    from .strength import Strength

SHARED = 1e-9
"""Part of the mean of the diagonal that is added to it: loads that other joints could bear as well are the least ones."""


def preloads(context: Context, joints: Sequence[Strength]) -> np.ndarray:
    """Force [N] and torque [N m] on the first object of each joint at the start, shape (J, 6); zeros where something deforms, and
    of springs."""
    from scipy.sparse import coo_array, diags_array  # both take 0.2 s
    from scipy.sparse.linalg import spsolve

    found = np.zeros((len(joints), 6))
    held = [(n, row) for n, one in enumerate(joints) if all(b.rigid for b in one.bodies) for row in held_rows(one.link)]
    if not held:
        return found
    number: dict[int, int] = {}
    for n, _ in held:
        for body in joints[n].bodies:
            number.setdefault(body.body, len(number))
    scene, free = context.scene, np.zeros((len(number), 6))
    spin = {m: np.array(scene.solids[m].spin) for m in number}
    free[:, :3] = context.reach.acting.acceleration
    inverse, tensors = {}, {}
    for one in joints:
        for body in (b for b in one.bodies if b.body in number and b.rigid):
            inverse[body.body], tensors[body.body] = body.root @ body.root, body.tensor
    for m, k in number.items():
        tensor = tensors[m]
        free[k, 3:] = -np.linalg.solve(tensor, np.cross(spin[m], tensor @ spin[m]))
    _add_springs(joints, number, inverse, free)
    rows, columns, values, wanted = [], [], [], []
    for k, (n, (along, turns)) in enumerate(held):
        one, right = joints[n], 0.0
        for sign, body in zip((1.0, -1.0), one.bodies):
            j = motion_along(body, along, turns)
            right -= sign * (j @ free[number[body.body]] + _turning(body, along, turns, spin[body.body]))
            rows += [k] * 6
            columns += range(6 * number[body.body], 6 * number[body.body] + 6)
            values += (sign * j).tolist()
        if turns and len(one.bodies) == 2:
            a, b = (spin[body.body] for body in one.bodies)
            right -= float((a - b) @ np.cross(b, along))
        wanted.append(right)
    held_motions = coo_array((values, (rows, columns)), shape=(len(held), 6 * len(number))).tocsr()
    blocks = [inverse[m] for m in number]
    mobility = coo_array(
        (
            np.concatenate([b.ravel() for b in blocks]),
            (
                np.concatenate([np.repeat(np.arange(6 * k, 6 * k + 6), 6) for k in range(len(blocks))]),
                np.concatenate([np.tile(np.arange(6 * k, 6 * k + 6), 6) for k in range(len(blocks))]),
            ),
        ),
        shape=(6 * len(number), 6 * len(number)),
    ).tocsr()
    net = held_motions @ mobility @ held_motions.T
    diagonal = net.diagonal()
    loads = np.atleast_1d(
        spsolve((net + diags_array(SHARED * diagonal.mean() * np.ones(len(diagonal)))).tocsc(), np.array(wanted))
    )
    for (n, (along, turns)), load in zip(held, loads.tolist()):
        found[n, 3 * turns : 3 * turns + 3] += load * along
    return found


def torn(context: Context, link: Link, arm: float) -> float:
    """Speed at which what a joint holds together moves apart at the start [m/s]: points, and directions one arm [m] long."""

    def motion(m: int) -> tuple[np.ndarray, np.ndarray]:
        if m == NOTHING:
            return np.zeros(3), np.zeros(3)
        solid = context.scene.solids[m]
        d = np.subtract(link.begin if m == link.first else link.end, solid.position)
        return np.array(solid.velocity) + skew(np.array(solid.spin)) @ d, np.array(solid.spin)

    (v, w), (u, s) = motion(link.first), motion(link.second)
    return max(
        (abs(float(along @ (w - s))) * arm if turns else abs(float(along @ (v - u))) for along, turns in held_rows(link)),
        default=0.0,
    )


def held_rows(link: Link) -> list[tuple[np.ndarray, bool]]:
    """Directions in which a joint holds its point, and about which it holds its objects."""
    match link.joint.kind:
        case "spring":
            hard = link.joint.stiffness is None and link.length > 0.0 and link.joint.length is None
            return [(unit(np.subtract(link.end, link.begin)), False)] if hard else []
        case "slider":
            return [*((e, False) for e in both_across(unit(link.axis))), *((e, True) for e in np.eye(3))]
        case "hinge":
            return [*((e, False) for e in np.eye(3)), *((e, True) for e in both_across(unit(link.axis)))]
    return [*((e, False) for e in np.eye(3)), *((e, True) for e in directions_of(link))]


def motion_along(body: JointEnd, along: np.ndarray, turns: bool) -> np.ndarray:
    """Part of the six motions of a body along a direction, or about it."""
    return np.concatenate([np.zeros(3), along] if turns else [along, skew(body.d) @ along])


def _turning(body: JointEnd, along: np.ndarray, turns: bool, spin: np.ndarray) -> float:
    """Acceleration of its point along a direction because it turns."""
    around = skew(spin)
    return 0.0 if turns else float(along @ around @ around @ body.d)


def _add_springs(joints: Sequence[Strength], number: dict[int, int], inverse: dict[int, np.ndarray], free: np.ndarray) -> None:
    """Accelerations by springs that have a stiffness of their own."""
    for one in joints:
        link = one.link
        if link.joint.kind != "spring" or not link.length or (more := link.length - link.rest) == 0.0:
            continue
        force = one.stiffness * (max(0.0, more) if link.joint.pulls else more)
        way = unit(np.subtract(link.end, link.begin))
        for sign, body in zip((1.0, -1.0), one.bodies):
            if body.body in number:
                free[number[body.body]] += inverse[body.body] @ motion_along(body, sign * force * way, False)
