# SPDX-License-Identifier: GPL-2.0-only
"""What a run will cost, told before it: the work that every effect expects, times what this machine needs for it."""

from __future__ import annotations

import numpy as np

from ..effects import Load
from ..effects.air_drag import LEAPFROG, leapfrog_rate
from ..effects.springs import fullness
from ..engine.commands import SKIN
from ..model.basin import liquid_level
from ..results.cost import Cost, CostShare
from ..results.expect import recorded
from ..results.trajectory_file import trajectory_bytes
from ..run.prepare import Prepared
from .calibration import lanes

RINGING = 2.5
"""Mean speed of the fastest particle over the speed of an impact, where nothing damps what the impact sets off."""
CALMED = 0.6
"""The same where something damps it."""
WET = 0.12
"""The same where all that moves is in a liquid."""


def forecast(ready: Prepared, rates: dict[str, float], *, setup: float | None = None) -> Cost:
    """The expected cost of a run; ``rates`` as in cost/calibration.py.

    ``setup`` is what loading and modelling have taken already [s]; None estimates that too.
    """
    scene, system, c = ready.scene, ready.system, ready.certificate
    n, control = system.particles, scene.control
    load = Load(
        scene,
        system,
        frozenset(e.name for e in ready.plan.effects),
        c.steps,
        rebuilds(ready),
        fullness(system.spring, lanes(ready.plan.damped)),
    )
    alone = load.mobile if "buoyancy" in load.on else 0
    effects = {}
    for effect in ready.plan.effects:
        span = ready.verdicts[effect.name].span
        effects[effect.name] = CostShare(effect.forecast(load, rates), str(span) if span else None)
    frames = 1 + len(c.lengths)
    size = trajectory_bytes(ready.models, frames, control.save, control.single, ready.plan.grid)
    looked_at = sum(
        len(ready.models[system.names.index(name)].hexahedron)
        for name, quantity in recorded(scene.expects)
        if quantity == "immersed"
    )
    modelled = rates["model"] * n if setup is None else setup
    other = {
        LEAPFROG: c.steps * load.mobile * leapfrog_rate(load, rates),
        "rest of the step": c.steps * (rates["step"] + n * rates["particle"] + alone * rates["lone particle"])
        + load.rebuilds * n * rates["rebuild"],
        "setup": modelled + rates["load"] + n * rates["insert"],
        "output": frames * (rates["frame"] + looked_at * rates["immersed"]) + size * rates["byte"],
    }
    wall = sum(other.values()) + sum(part.seconds for part in effects.values())
    return Cost(wall, c.steps, n, effects, other)


def rebuilds(ready: Prepared) -> float:
    """How often LAMMPS will rebuild its lists: whenever the fastest particle has moved by half the skin, at most every step."""
    c, way = ready.certificate, 0.5 * SKIN * float(ready.system.spacing.max())
    return min(float(c.steps), fastest(ready) * ready.scene.control.time / way)


def fastest(ready: Prepared) -> float:
    """Mean speed of the fastest particle over the whole run [m/s], roughly: from speeds at the start and the heights of falls."""
    scene, system = ready.scene, ready.system
    on = {e.name for e in ready.plan.effects}
    velocity = np.array([s.velocity for s in scene.solids], float)
    around = np.sqrt(
        np.maximum.reduceat(
            ((system.velocity - velocity[system.object]) ** 2 * ~system.held[:, None]).sum(axis=1), system.first[:-1]
        )
    )
    held = np.logical_or.reduceat(system.held, system.first[:-1])
    velocity[held] = 0.0
    g = np.array(scene.gravity) * ("gravity" in on)
    if not on & {"contact", "ground", "walls", "basin"}:
        when = np.linspace(0.0, scene.control.time, 33)[:, None, None]
        flight = np.linalg.norm(velocity + when * g * ~held[:, None], axis=2)
        return float((flight + around).max(axis=1).mean())
    bottom = np.minimum.reduceat(system.position[:, 2], system.first[:-1])
    if "buoyancy" in on:
        way = np.abs(bottom - liquid_level(scene.liquid))  # down to the surface, or up to it
    else:
        way = bottom - min([float(bottom.min()), *([] if scene.ground is None else [scene.ground])])
    start = np.linalg.norm(velocity, axis=1) + around
    impact = float(np.sqrt(start**2 + 2.0 * np.linalg.norm(g) * np.where(held, 0.0, way)).max())
    return impact * (WET if "buoyancy" in on else CALMED if on & {"damping", "air-drag"} else RINGING)
