# SPDX-License-Identifier: GPL-2.0-only
"""Joints in frames: a row for each, with what it does."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ...effects.fields import Field, pair_rows
from .links import Link, links_of
from .words import KINDS, Joint

NUMBER, KIND, FORCE, TORQUE, WAY, RATE, DRIVING, GAP, BROKEN = range(9)
"""Columns of a row: its number in the scene and its kind in DRAWN, from 0; force [N] and torque [N m] of what it holds; angle
[rad], way or length [m], and its rate; torque or force of motor, friction and stops; gap [m]; 1 where it has broken."""
FIRST, SECOND = slice(9, 12), slice(12, 15)
"""Columns of its point in the first object and in the second [m]."""
SIZE = 15
"""Column with the thinnest part of what it joins [m]."""
WIDTH = 16
TOLD = 13
"""Columns from the force to the second point."""
DRAWN = (*KINDS, "line")
"""Kinds as they are drawn: a spring without a stiffness of its own, or that only pulls, is a line."""
FIELD = "joint"


def joint_field(scene) -> Field:
    """The field of joints of a scene; a row stands for both objects, of a joint with what never moves for the other one twice."""
    return Field(FIELD, "1", per="pair", counts=(max(1, len(links_of(scene).all)),), shape=(WIDTH,))


def rows_of_joints(joints: Sequence[tuple[Link, float]], told: np.ndarray, numbers: Mapping[int, int]) -> np.ndarray:
    """The rows of a frame from what is told of joints, shape (J, TOLD); they are given with the thinnest parts of what they join
    [m], and ``numbers`` are molecule IDs of objects."""
    found = np.empty(len(joints), pair_rows(Field(FIELD, "1", per="pair", shape=(WIDTH,))))
    for n, (link, thin) in enumerate(joints):
        ends = [numbers[m] - 1 for m in link.pair]
        found["a"][n], found["b"][n] = min(ends), max(ends)
        found["value"][n] = link.number, DRAWN.index(_drawn(link.joint)), *told[n], thin
    order = np.lexsort((found["value"][:, NUMBER], found["b"], found["a"]))
    return found[order]


def _drawn(joint: Joint) -> str:
    return "line" if joint.kind == "spring" and (joint.pulls or joint.stiffness is None) else joint.kind
