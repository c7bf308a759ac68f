# SPDX-License-Identifier: GPL-2.0-only
"""How what joints do is measured for ``expect``."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ...effects.measured import Measurable, Measure, Measured, Of
from ...errors import Problem
from ...scene.scene import SceneRecord
from .links import Link, links_of
from .rows import DRIVING, FIELD, FORCE, GAP, NUMBER, RATE, TORQUE, WAY

COLUMNS = {
    "angle": (WAY,),
    "way": (WAY,),
    "force": (FORCE,),
    "torque": (TORQUE,),
    "gap": (GAP,),
    "drive": (DRIVING,),
    "power": (DRIVING, RATE),
}
"""Columns of a row whose product each quantity is."""


KINDS = {
    "angle": ("hinge",),
    "way": ("slider", "spring"),
    "torque": ("weld", "hinge", "slider"),
    "drive": ("hinge",),
    "power": ("hinge", "slider"),
}
"""Kinds of joints that have a quantity; all have the others."""


def joint_between(scene: SceneRecord, subject: str, other: str, what: str) -> Link | None:
    """The joint that an ``expect`` is about: the first one of both objects that has the quantity."""
    kinds = KINDS.get(what)
    own = links_of(scene).of_names.get(subject, ())
    return next((link for name, link in own if name == other and (kinds is None or link.joint.kind in kinds)), None)


def unmeasured(scene: SceneRecord, asked: Iterable[Of]) -> list[Problem]:
    """A problem for everything asked about a joint that is not there."""
    found = []
    for e in asked:
        what = e.quantity.removeprefix("joint.")
        if e.quantity == what or joint_between(scene, e.subject, str(e.argument), what) is not None:
            continue
        kinds = KINDS.get(what, ("joint",))
        cause = f"no {' or '.join(kinds)} connects {e.subject} and {e.argument}"
        own = links_of(scene).of_names.get(e.subject, ())
        others = [other for other, _ in own if joint_between(scene, e.subject, other, what) is not None]
        way_out = (
            f"write {e.subject}.{e.quantity}({others[0]})" if others else "write the names of what is joined, or another quantity"
        )
        found.append(Problem(e.span, cause, way_out))
    return found


def _along(what: str) -> Measure:
    def measure(m: Measured, e: Of) -> np.ndarray:
        link = joint_between(m.scene, e.subject, str(e.argument), what)
        values = np.full(len(m.times), np.nan)
        for frame in range(len(m.times)):
            rows = m.trajectory.field(FIELD, frame)["value"]
            own = rows[rows[:, NUMBER] == link.number] if link is not None else rows[:0]
            values[frame] = own[0, COLUMNS[what]].prod() if len(own) else np.nan
        return values

    return measure


MEASURES = {("NAME", f"joint.{what}"): Measurable(_along(what)) for what in COLUMNS}
