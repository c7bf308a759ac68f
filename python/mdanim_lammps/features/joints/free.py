# SPDX-License-Identifier: GPL-2.0-only
"""Stops and motors on the coordinate that a joint leaves free (docs/physics-joints.md, "Stops and motors").

With the row a of this coordinate in the motions of both objects, and the matrix J of those that the joint holds, a force of 1
accelerates it by y, and the joint bears lambda:

    y = a M^-1 a' + a M^-1 J' lambda,    J M^-1 J' lambda = -J M^-1 a'
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ...model.shapes import radius
from .ends import unit
from .preload import held_rows, motion_along

if TYPE_CHECKING:
    from ...effects.context import Context
    from .strength import Strength

SOFTER = 4.0
"""Frequency of the joint over that of its stops, between what does not deform: the joint does not spring back with its stop."""
CRITICAL = 1.0
"""Share of critical damping of stops without a `restitution`."""
MOST_DAMPED = CRITICAL
"""The largest one: a harder dashpot is a blow on the joint, which springs back by itself."""


CLOSE = 1e-12
"""Square of the frequency from which on a damped spring counts as critical."""


def stop_of(one: Strength) -> tuple[float, float, float]:
    """Stiffness and damping of the stops of a joint, and the mobility of the coordinate that they act on; 0 where they are those
    of the servo, because something deforms."""
    e = one.link.joint.restitution
    if one.link.joint.limits is None or ((found := _freedom(one)) is None and e is None):
        return 0.0, 0.0, 0.0
    share = CRITICAL if e is None else share_for(e)
    if found is None:
        return one.servo[0], share * one.servo[1], 4.0 * one.servo[0] / one.servo[1] ** 2
    y, _ = found
    k = (one.frequency / SOFTER) ** 2 / y
    return k, 2.0 * share * math.sqrt(k / y), y


def rise_of(context: Context, one: Strength, allowed: float) -> float:
    """Largest change of the speed of a motor without limit in a second: neither the joint nor the motor gives way by more than
    allowed [m] by it; infinite of all others."""
    motor = one.link.joint.motor
    if motor is None or motor.most is not None or (found := _freedom(one)) is None:
        return math.inf
    y, borne = found
    size = max(radius(context.scene.solids[b.object].shape) for b in one.bodies) if one.link.joint.kind == "hinge" else 1.0
    by_joint = one.stiffness * allowed / borne if borne > 0.0 else math.inf
    return y * min(by_joint, one.servo[0] * allowed / size)


def _freedom(one: Strength) -> tuple[float, float] | None:
    """y, and the force that the joint bears; None where something deforms."""
    if not all(body.rigid for body in one.bodies):
        return None
    axis, turns = unit(one.link.axis), one.link.joint.kind == "hinge"
    rows = held_rows(one)

    def whole(along: np.ndarray, about: bool) -> np.ndarray:
        parts = [s * motion_along(b, along, about) @ b.root for s, b in zip((1.0, -1.0), one.bodies)]
        return np.concatenate(parts)

    a, held = whole(axis, turns), np.array([whole(*row) for row in rows])
    borne = np.linalg.lstsq(held @ held.T, -held @ a, rcond=None)[0]
    force = sum((x * along for x, (along, about) in zip(borne, rows) if not about), np.zeros(3))
    return float(a @ a + a @ held.T @ borne), float(np.linalg.norm(force))


def share_for(e: float) -> float:
    """Share of critical damping with which a dashpot beside a spring that does not pull leaves a part e of the speed."""
    low, high = 0.0, MOST_DAMPED
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _left(middle) > e else (low, middle)
    return 0.5 * (low + high)


def _left(share: float) -> float:
    """Part of the speed that is left where the force of x'' + 2 b x' + x = 0 would begin to pull."""
    root = 1j * math.sqrt(max(1.0 - share * share, CLOSE))
    slow, fast = -share + root, -share - root
    # There x'' = 0: (fast/slow)^2 = exp((slow - fast) t).
    t = (2.0 * np.angle(fast / slow) % (2.0 * np.pi)) / abs(2.0 * root)
    speed = (slow * np.exp(slow * t) - fast * np.exp(fast * t)) / (slow - fast)
    return float(abs(speed))
