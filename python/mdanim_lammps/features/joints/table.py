# SPDX-License-Identifier: GPL-2.0-only
"""The file of joints of ``fix mdanim/joint`` (docs/fix_mdanim_joint.md)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

import numpy as np

from ...scene import units
from .ends import JointEnd, unit
from .patches import ALL
from .strength import Strength


def joints_text(joints: Iterable[Strength], number: Mapping[int, int]) -> str:
    """The file: a line for each joint; ``number`` are the molecule IDs of objects, by their numbers in the scene."""
    lines = (_line(one, number) for one in joints)
    return "# Joints, written by mdanim-lammps: kind, objects, words\n" + "".join(f"{line}\n" for line in lines)


def _line(one: Strength, number: Mapping[int, int]) -> str:
    link, joint = one.link, one.link.joint
    first = link.first
    second = "world" if link.second < 0 else number[link.second]
    words: list[object] = [joint.kind, number[first], second]
    if joint.kind == "spring":
        # The tension that a rod bears from the start: a force on the first object pulls it to the second.
        pull = float(one.preload[:3] @ unit(np.subtract(link.end, link.begin))) if one.preload.any() else 0.0
        words += ["from", *link.begin, "to", *link.end, "length", link.rest - pull / one.stiffness]
        words += ["pulls-only"] if joint.pulls else []
    else:
        words += ["at", *link.begin]
    if link.axis is not None:
        words += ["axis", *link.axis]
    patches = {body.object: _radius(body) for body in one.bodies}
    words += ["patch", patches.get(link.first, "all"), patches.get(link.second, "all")]
    words += ["stiffness", one.stiffness]
    words += ["arm", one.arm] if one.arm else []
    words += ["damping", one.damping] if one.damping else []
    words += ["servo", *one.servo] if one.servo[0] else []
    words += ["stop", *one.stop] if one.stop[0] else []
    words += ["rise", one.rise] if math.isfinite(one.rise) else []
    words += ["preload", *one.preload.tolist()] if one.preload.any() and joint.kind != "spring" else []
    if joint.motor is not None:
        words += ["motor", units.magnitude(joint.motor.speed), "none" if joint.motor.most is None else joint.motor.most]
    if joint.limits is not None:
        words += ["limits", *map(units.magnitude, joint.limits)]
    if joint.friction is not None:
        words += ["friction", units.magnitude(joint.friction)]
    if joint.breaks is not None:
        words += ["breaks", joint.breaks[0]]
        words += ["breaks-torque", joint.breaks[1]] if joint.breaks[1] is not None else []
    return " ".join(repr(float(word)) if isinstance(word, float) else str(word) for word in words)


def _radius(body: JointEnd) -> float | str:
    return "all" if body.patch is None or body.patch.radius == ALL else body.patch.radius
