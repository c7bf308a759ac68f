# SPDX-License-Identifier: GPL-2.0-only
"""How what joints do is measured for ``expect``."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np

from ...effects.measured import Measurable, Measure, Measured, Of
from ...errors import Problem
from ...scene.formatting import say, with_article
from ...scene.scene import SceneRecord
from .links import Link, links_of
from .rows import DRIVING, FIELD, FORCE, GAP, NUMBER, RATE, TORQUE, WAY
from .words import HAVING, KINDS, QUANTITIES

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


def joints_between(scene: SceneRecord, subject: str, other: str, quantity: str) -> list[Link]:
    """The joints of both objects that have a quantity, ``joint.force`` or ``joint.spring.force``, in the order of the scene."""
    *kind, what = quantity.removeprefix("joint.").split(".")
    own = links_of(scene).of_names.get(subject, ())
    return [link for name, link in own if name == other and link.joint.kind in (kind or HAVING[what])]


def unmeasured(scene: SceneRecord, asked: Iterable[Of]) -> list[Problem]:
    """A problem for everything asked about a joint that is not there, or that could be that of joints of several kinds."""
    found = []
    for e in (e for e in asked if e.quantity.startswith("joint.")):
        kinds = dict.fromkeys(link.joint.kind for link in joints_between(scene, e.subject, str(e.argument), e.quantity))
        *kind, what = e.quantity.removeprefix("joint.").split(".")
        if len(kinds) == 1:
            continue
        if kinds:
            cause = f"{' and '.join(map(with_article, kinds))} connect {e.subject} and {e.argument}: {e.quantity} of which?"
            way_out = "write " + " or ".join(f"{e.subject}.joint.{one}.{what}({e.argument})" for one in kinds)
        else:
            wanted = kind or (HAVING[what] if len(HAVING[what]) < len(KINDS) else ["joint"])
            cause = f"no {' or '.join(wanted)} connects {e.subject} and {e.argument}"
            own = links_of(scene).of_names.get(e.subject, ())
            others = [other for other, _ in own if joints_between(scene, e.subject, other, e.quantity)]
            way_out = "write the names of what is joined, or another quantity"
            way_out = f"write {e.subject}.{e.quantity}({others[0]})" if others else way_out
        found.append(Problem(e.span, cause, way_out))
    return found


def first_of_several(scene: SceneRecord) -> list[Problem]:
    """Warnings of what is asked about joints of one kind of which several join the same objects; angles and ways along one
    direction are those of all."""
    found = []
    for e in {e.what: e for e in scene.asked if e.quantity.startswith("joint.")}.values():
        joints = joints_between(scene, e.subject, str(e.argument), e.quantity)
        if len(joints) < 2 or (e.quantity.endswith((".angle", ".way")) and _one_direction(joints)):
            continue
        at = ", ".join(say(x, "m", 3) for x in joints[0].begin)
        cause = f"{e.what} is that of the first of {len(joints)} joints {joints[0].joint.kind} of both, at ({at})"
        way_out = "to ask for another one, write that one first, or join it to a small object that is welded on"
        found.append(Problem(e.span, cause, way_out, severity="warning"))
    return found


def _one_direction(joints: Sequence[Link]) -> bool:
    """Whether all have one axis: about its opposite an angle has the other sign."""
    axes = [link.axis for link in joints]
    return None not in axes and all(math.dist(axis, axes[0]) < 1e-9 for axis in axes)


def _along(what: str) -> Measure:
    def measure(m: Measured, e: Of) -> np.ndarray:
        link = next(iter(joints_between(m.scene, e.subject, str(e.argument), e.quantity)), None)
        values = np.full(len(m.times), np.nan)
        for frame in range(len(m.times)):
            rows = m.trajectory.field(FIELD, frame)["value"]
            own = rows[rows[:, NUMBER] == link.number] if link is not None else rows[:0]
            values[frame] = own[0, COLUMNS[what]].prod() if len(own) else np.nan
        return values

    return measure


MEASURES = {of: Measurable(_along(of[1].rpartition(".")[2])) for of in QUANTITIES}
