# SPDX-License-Identifier: GPL-2.0-only
"""What a run will cost, told before it: the work that every effect expects, times what this machine needs for it."""

from __future__ import annotations

import numpy as np

from ..effects import Load
from ..effects.air_drag import LEAPFROG, leapfrog_rate
from ..effects.envelope import Envelope
from ..effects.springs import fullness
from ..engine.commands import SKIN
from ..results.cost import Cost, CostShare
from ..results.expect import recorded
from ..results.trajectory_file import trajectory_bytes
from ..run.prepare import Prepared
from .calibration import lanes
from .meetings import meetings

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
        moves(ready),
        meetings(ready),
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
    return min(float(ready.certificate.steps), fastest(ready) * ready.scene.control.time / _half_skin(ready))


def moves(ready: Prepared) -> float:
    """How often an object moves by half the skin: vibrations that only single particles have are no way."""
    return CALMED * float(_reachable(ready).max()) * ready.scene.control.time / _half_skin(ready)


def _half_skin(ready: Prepared) -> float:
    return 0.5 * SKIN * float(ready.system.spacing.max())


def _reachable(ready: Prepared) -> np.ndarray:
    """Speed that each solid may reach by its start and its fall [m/s], shape (M,)."""
    return Envelope(ready.resolved, ready.system, {}, ready.certificate.timestep).speed


def fastest(ready: Prepared) -> float:
    """Mean speed of the fastest particle over the whole run [m/s], roughly: of flights the mean of their ends, else what it may
    reach by start and fall, times what that is on average."""
    scene, system, on = ready.scene, ready.system, {e.name for e in ready.plan.effects}
    if on & {"contact", "ground", "walls", "basin"}:
        usual = WET if "buoyancy" in on else CALMED if on & {"damping", "air-drag"} else RINGING
        return usual * float(_reachable(ready).max())
    free = ~np.logical_or.reduceat(system.held, system.first[:-1])[system.object]
    gained = scene.control.time * np.array(scene.gravity) * ("gravity" in on)
    ends = [np.linalg.norm(system.velocity[free] + gain, axis=1).max(initial=0.0) for gain in (0.0, gained)]
    return 0.5 * float(sum(ends))
