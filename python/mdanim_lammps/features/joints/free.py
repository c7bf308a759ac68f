# SPDX-License-Identifier: GPL-2.0-only
"""Stops and motors on the coordinate that a joint leaves free (docs/physics-joints.md, "Stops and motors").

With the row a of this coordinate in the motions of both objects and of all that is welded to them, and the matrix J of those that
the joint and these welds hold, a force of 1 accelerates it by y, and joint and welds bear lambda, by which they give way by C:

    y = a M^-1 a' + a M^-1 J' lambda,    J M^-1 J' lambda = -J M^-1 a',    C = sum lambda^2/k
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ...model.shapes import radius
from ..contact.restitution import damping_for
from .ends import unit
from .preload import held_rows, motion_along

if TYPE_CHECKING:
    from ...effects.context import Context
    from .strength import Strength

SOFTER = 4.0
"""Frequency of the joint over that of its stops, between what does not deform: the joint does not spring back with its stop."""
STIFF = 40.0
"""Energy in a stop over that in the springs of its joint and of welds, at least: the dashpot begins with its full force, and they
give a part of this blow back."""
CRITICAL = 1.0
"""Share of critical damping of stops without a `restitution`."""
STILL = 1e-9
"""Part of the mobility of the ends alone, below which welds leave no motion."""


def stop_of(one: Strength, welds: Sequence[Strength] = ()) -> tuple[float, float, float]:
    """Stiffness and damping of the stops of a joint, and the mobility of the coordinate that they act on; 0 where they are those
    of the servo, because something deforms or nothing moves."""
    e = one.link.joint.restitution
    if one.link.joint.limits is None or ((found := _freedom(one, welds)) is None and e is None):
        return 0.0, 0.0, 0.0
    share = CRITICAL if e is None else damping_for(e)
    if found is None:
        return one.servo[0], share * one.servo[1], 4.0 * one.servo[0] / one.servo[1] ** 2
    y, _, gives = found
    k = (_frequency(one, welds) / SOFTER) ** 2 / y
    k /= max(1.0, STIFF * gives * k)
    return k, 2.0 * share * math.sqrt(k / y), y


def rise_of(context: Context, one: Strength, allowed: float, welds: Sequence[Strength] = ()) -> float:
    """Largest change of the speed of a motor without limit in a second: neither the joint nor the motor gives way by more than
    allowed [m] by it; infinite of all others."""
    motor = one.link.joint.motor
    if motor is None or motor.most is not None or (found := _freedom(one, welds)) is None:
        return math.inf
    y, borne, _ = found
    size = max(radius(context.scene.solids[b.object].shape) for b in one.bodies) if one.link.joint.kind == "hinge" else 1.0
    by_joint = one.stiffness * allowed / borne if borne > 0.0 else math.inf
    return y * min(by_joint, one.servo[0] * allowed / size)


def welds_of(joints: Sequence[Strength]) -> list[list[int]]:
    """Numbers of the welds that join rigid objects to either end of each joint with a motor or limits, directly and by other
    welds. One with a stiffness of its own that is softer than the joint is left out: what it joins lags behind."""
    at: dict[int, list[int]] = {}
    for n, one in enumerate(joints):
        if one.link.joint.kind == "weld" and all(body.rigid for body in one.bodies):
            for body in one.bodies:
                at.setdefault(body.body, []).append(n)

    def met(one: Strength) -> list[int]:
        found: set[int] = set()
        todo = [body.body for body in one.bodies]
        while todo:
            for n in at.get(todo.pop(), []):
                weld = joints[n]
                if n in found or (weld.link.joint.stiffness is not None and weld.frequency < one.frequency):
                    continue
                found.add(n)
                todo += [body.body for body in weld.bodies]
        return sorted(found)

    return [met(one) if one.link.joint.limits is not None or one.link.joint.motor is not None else [] for one in joints]


def _freedom(one: Strength, welds: Sequence[Strength]) -> tuple[float, float, float] | None:
    """y, the force that the joint bears, and how far its springs and those of the welds give way to a force of 1 [m/N], of a
    hinge to a torque of 1; None where something deforms, or welds leave no motion."""
    if not all(body.rigid for body in one.bodies):
        return None
    axis, turns = unit(one.link.axis), one.link.joint.kind == "hinge"
    rows, place = held_rows(one.link), _places(one, welds)
    a = _motion(one, axis, turns, place)
    held = np.array([_motion(joint, *row, place) for joint in (one, *welds) for row in held_rows(joint.link)])
    borne = np.linalg.lstsq(held @ held.T, -held @ a, rcond=None)[0]
    force = sum((x * along for x, (along, about) in zip(borne, rows) if not about), np.zeros(3))
    y = float(a @ a + a @ held.T @ borne)
    springs = np.array([_spring(joint, *row) for joint in (one, *welds) for row in held_rows(joint.link)])
    gives = float((borne**2 / springs).sum())
    return (y, float(np.linalg.norm(force)), gives) if y > STILL * float(a @ a) else None


def _frequency(one: Strength, welds: Sequence[Strength]) -> float:
    """Frequency of a joint on its spring [1/s], with what is welded to its ends."""
    if not welds:
        return one.frequency
    place = _places(one, welds)
    held = np.array([_motion(weld, *row, place) for weld in welds for row in held_rows(weld.link)])
    point = np.array([_motion(one, e, False, place) for e in np.eye(3)])
    free = point - np.linalg.lstsq(held.T, point.T, rcond=None)[0].T @ held
    return math.sqrt(one.stiffness * float(np.linalg.eigvalsh(free @ free.T)[-1]))


def _spring(one: Strength, along: np.ndarray, about: bool) -> float:
    """Stiffness with which a joint holds a direction of its point [N/m], or against turning about one [N m]."""
    turned = len(one.directions) - float(((one.directions @ along) ** 2).sum())
    return one.stiffness * one.arm**2 * turned if about else one.stiffness


def _places(one: Strength, welds: Sequence[Strength]) -> dict[int, int]:
    """Places of objects among all that a joint and welds join."""
    found: dict[int, int] = {}
    for body in (body for joint in (one, *welds) for body in joint.bodies):
        found.setdefault(body.body, len(found))
    return found


def _motion(one: Strength, along: np.ndarray, about: bool, place: dict[int, int]) -> np.ndarray:
    """Row of a direction of a joint in the motions of all objects, each times the root of its mass, shape (6 n,)."""
    row = np.zeros((len(place), 6))
    for s, body in zip((1.0, -1.0), one.bodies):
        row[place[body.body]] = s * motion_along(body, along, about) @ body.root
    return row.ravel()
