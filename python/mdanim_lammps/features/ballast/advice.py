# SPDX-License-Identifier: GPL-2.0-only
"""Remarks of ``check`` on ballast: where it meets nothing, and where the centre of mass is."""

from __future__ import annotations

import numpy as np

from ...bodies import all_held
from ...effects.envelope import Envelope
from ...errors import Problem
from ...model.added import centre_of
from ...scene.formatting import say
from .masses import in_box

HAIR = 1e-9
"""Part of a way below which a component of it is told as 0."""


def notes(envelope: Envelope) -> list[Problem]:
    """One on each object with ballast."""
    found = []
    for solid in envelope.scene.solids:
        if not solid.ballast or all_held(solid):
            continue
        place = solid.spans.get("ballast")
        for n, one in enumerate(solid.ballast, 1):
            if in_box(solid.shape, tuple(solid.position), solid.rotation, one)[0] <= 0.0:
                which = f"the {n}. ballast of {solid.name}" if len(solid.ballast) > 1 else f"the ballast of {solid.name}"
                cause = f"{which} meets nothing of it: the object is around {_point(solid.position)}"
                found.append(Problem(place, cause, "write corners in the frame of the world, at the start", severity="warning"))
        mass = float(envelope.system.mass_of[envelope.system.names.index(solid.name)])
        off = float(np.linalg.norm(centre_of(solid)))
        at = _point(np.asarray(solid.position) + np.where(np.abs(centre_of(solid)) < HAIR * off, 0.0, centre_of(solid)))
        cause = (
            f"with its ballast {solid.name} has {say(mass, 'kg')} and its centre of mass at {at}, {say(off, 'm')} off its middle"
        )
        found.append(Problem(place, cause, severity="note"))
    return found


def _point(x) -> str:
    return f"({', '.join(f'{c:.4g}' for c in x)}) m"
