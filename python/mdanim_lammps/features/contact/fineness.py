# SPDX-License-Identifier: GPL-2.0-only
"""Whether the depth of what does not deform is known as far around it as ropes and sheets are thick."""

from __future__ import annotations

import numpy as np

from ...effects.context import Context
from ...errors import Problem
from ...scene.formatting import say


def too_thin(context: Context) -> list[Problem]:
    """A warning of the thinnest object that a rope or a sheet may meet which is too thick around its particles for it."""
    system, swept = context.system, context.reach.region
    frames = [system.frames[kind] for kind in system.contact_kind.tolist()]
    radius = np.array([frame.radius for frame in frames])
    known = np.array([frame.known_for for frame in frames])
    bare, hosts = np.flatnonzero(system.bare), np.flatnonzero(~system.bare & (known < radius.max()))
    for host in hosts[known[hosts].argsort(kind="stable")].tolist():
        near = ((swept.low[host] < swept.high[bare]) & (swept.low[bare] < swept.high[host])).all(axis=1)
        met = [m for m in bare[near & (radius[bare] > known[host])].tolist() if (min(m, host), max(m, host)) not in swept.passing]
        if met:
            thickest, thin = max(met, key=lambda m: radius[m]), system.names[host]
            name = system.names[thickest]
            cause = (
                f"{name} touches others {say(float(radius[thickest]), 'm')} from its particles, and the depth below the surface "
            )
            cause += f"of {thin} is known up to {say(float(known[host]), 'm')} from it: their contact gains energy"
            way_out = f"write a thicker {thin}, a thinner {name}, or a resolution with which particles of {name} are closer"
            return [Problem(context.scene.solids[host].spans.get("shape"), cause, way_out, severity="warning")]
    return []
