# SPDX-License-Identifier: GPL-2.0-only
"""Air, by ``fix mdanim/air``."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...bodies import all_held
from ...effects.context import Context, Verdict
from ...effects.effect import Effect
from ...effects.facets import StandardSteps
from ...effects.fields import Field
from ...errors import Problem
from ...model import shapes
from ...reach import Throw
from ...scene.formatting import say
from ...scene.once import once_for
from .skin import AirSkin, skin_of

LOSS, WORK = "air_loss", "work"
"""Columns of the ledger."""
FORCE = "air_force"
SKINS = "air"
"""Table of surfaces."""
LAST = 4.0
"""Force of the air on what has fallen edge on and turns its face to the air, over its weight, about."""
IN_A_STEP = 0.01
"""Largest part of a motion relative to the air that the air may take in a step: an explicit step is wrong by half of it."""


class Air(StandardSteps, Effect):
    """Pressure on each triangle of the drawn surface, F = rho/2 C A |u| u n with the velocity u = n (w - v) of the air along the
    normal: at the outer side of solids and closed sheets where the air comes to it, at both sides of other sheets; links
    of ropes as cylinders (docs/physics-air.md).
    """

    styles = (("fix", "mdanim/air"),)
    name = fix = "air"
    order = 85
    if_off = "nothing is slowed by air, and no wind blows"

    def called_for(self, scene, reach):
        if scene.air is None:
            return Verdict(self.name, False, "the scene has no air")
        span = scene.air.spans.get("air")
        if all(map(all_held, scene.solids)):
            return Verdict(self.name, False, "nothing can move", span)
        speed = _wind(scene)
        wind = f", wind of up to {say(speed, 'm/s')}" if speed else ""
        return Verdict(self.name, True, f"air of {say(scene.air.density, 'kg/m^3')}{wind}", span)

    # --- where things may be ------------------------------------------------------------------------------------------

    def throws(self, scene):
        return _throws(scene) if scene.air is not None else {}

    def untold(self, scene):
        why = "air pushes at objects, and frames do not tell its forces from those of contact"
        return dict.fromkeys(range(len(scene.solids)), why) if scene.air is not None else {}

    # --- what it brings into a run ------------------------------------------------------------------------------------

    def acts_on(self, context):
        return bool(_pushed(context))

    def commands(self, context):
        air = context.scene.air
        path = air.wind_path or ((0.0, air.wind),)
        wind = " ".join(f"{t!r} {x!r} {y!r} {z!r}" for t, (x, y, z) in path)
        level = context.reach.acting.surface
        above = "" if level is None else f" above {float(level)!r}"
        words = f"{air.density!r} {air.coefficient!r} path {wind}{above} skins table:{SKINS}"
        return [f"fix {self.fix} {context.pushed} mdanim/air {words}"]

    def tables(self, context):
        first: dict[int, int] = {}
        lines = ["# Surfaces that air pushes at, written by mdanim-lammps: object MOLECULE outer|both, or like another one\n"]
        for m in _pushed(context):
            skin = _skins(context)[m]
            if id(skin) in first:
                lines.append(f"object {m + 1} like {first[id(skin)]}\n")
                continue
            first[id(skin)] = m + 1
            lines += [f"object {m + 1} {'both' if skin.both else 'outer'}\n", skin.text()]
        return {SKINS: "".join(lines)}

    def drag_rate(self, context):
        """2 (2 u) rho C/2 A_i/m_i at the largest relative velocity u, by the area A_i that a particle carries."""
        system, speed = context.system, _speeds(context)
        found = np.zeros(system.particles)
        for m in _pushed(context):
            own = slice(system.first[m], system.first[m + 1])
            carried = _skins(context)[m].carried(len(system.mass[own]))
            found[own] = 4.0 * speed[m] * _half(context.scene) * carried / system.mass[own]
        return found

    def max_timestep(self, context):
        """The air takes IN_A_STEP of the motion of an object at most."""
        rates = (_half(context.scene) * one * u for one, u in zip(_loads(context), _speeds(context)))
        return min((IN_A_STEP / rate for rate in rates if rate), default=math.inf)

    # --- accounts and frames ------------------------------------------------------------------------------------------

    def losses(self, scene):
        return (LOSS,)

    def sources(self, scene):
        return (WORK,) if scene.air is not None and _wind(scene) else ()

    def lost(self, readings):
        scene = readings.context.scene
        return {term: readings.fix_value(self.fix, term) for term in (*self.losses(scene), *self.sources(scene))}

    def fields(self, scene):
        return (force_field(scene),)

    def tell(self, readings):
        pushed = _pushed(readings.context)
        force = np.zeros((len(readings.system.names), 3))
        force[pushed] = readings.fix_rows(self.fix, len(pushed), 3)
        return {FORCE: force}

    # --- advice -------------------------------------------------------------------------------------------------------

    def warnings(self, context):
        """An object that air slows twice."""
        for solid in context.scene.solids:
            if solid.drag and not all_held(solid):
                cause = f"{solid.name} has drag, and air pushes at its surface: it is slowed twice"
                return [Problem(solid.spans.get("drag"), cause, "take drag out, or the air block", severity="warning")]
        return []


def force_field(scene: Any) -> Field:
    """The force of the air on each object."""
    return Field(FORCE, "N", per="object", shape=(3,), counts=(len(scene.solids),))


@once_for(lambda scene: scene)
def _throws(scene: Any) -> dict[int, Throw]:
    """The speed that a plate of half of the surface gets, face on and at rest at first: w p/(1 + p) with the wind w and
    p = rho C A w t/2 m; the force on it at the speed of the wind and of the start, and LAST weights after a fall."""
    wind, found = _wind(scene), {}
    for m, solid in enumerate(scene.solids):
        if not all_held(solid):
            speed = wind + math.hypot(*solid.velocity) + math.hypot(*solid.spin) * shapes.radius(solid.shape)
            rate = _half(scene) * 0.5 * shapes.area(solid.shape) / shapes.mass(solid)
            part = rate * wind * scene.control.time
            push = rate * speed**2
            found[m] = Throw(
                wind * part / (1.0 + part),
                push + LAST * math.hypot(*scene.gravity),
                wind,
                push,
                "the wind",
                "write a lower wind, or one that ends, with 'wind at T'",
                scene.air.spans.get("wind") or scene.air.spans.get("air"),
            )
    return found


def _wind(scene: Any) -> float:
    """Largest speed of the wind [m/s]."""
    return max(math.hypot(*w) for _, w in scene.air.wind_path or ((0.0, scene.air.wind),))


def _half(scene: Any) -> float:
    """rho C/2 [kg/m^3]"""
    return 0.5 * scene.air.density * scene.air.coefficient


def _loads(context: Context) -> np.ndarray:
    """Area that faces the air over the mass of each solid of a context, the same from either side [m^2/kg], shape (M,)."""
    skins, found = _skins(context), np.zeros(len(context.system.names))
    for m, skin in skins.items():
        found[m] = skin.area * (1.0 if skin.both else 0.5) / context.system.mass_of[m]
    return found


def _speeds(context: Context) -> np.ndarray:
    """Largest velocity of the air relative to each solid of a context [m/s], shape (M,): of a fall no more than that at which its
    weight and the air are in balance."""
    scene, load = context.scene, _loads(context)
    g = math.hypot(*scene.gravity)
    last = np.sqrt(g / np.maximum(_half(scene) * load, 1e-300))
    of = dict(zip((solid.name for solid in scene.solids), context.reach.speed.tolist()))
    reached = np.array([of[name] for name in context.system.names])
    return np.maximum(reached, np.minimum(g * scene.control.time, last)) + _wind(scene)


def _pushed(context: Context) -> list[int]:
    """Solids of a context that air pushes at: those of which something moves."""
    return np.flatnonzero(~context.system.still).tolist()


def _skins(context: Context) -> dict[int, AirSkin]:
    """Surfaces of the solids that air pushes at, by their numbers in the context."""
    found = _all_skins(context)
    return {m: found[context.system.names[m]] for m in _pushed(context)}


@once_for(lambda context: context.reach)
def _all_skins(context: Context) -> dict[str, AirSkin]:
    """The same of a whole scene, by names. Equal objects share that of the first one of all: its last digits depend on where this
    stands, and each part of the scene has to have the same ones."""
    made: dict[tuple, AirSkin] = {}
    found = {}
    for m in np.flatnonzero(~context.reach.system.still).tolist():
        model, solid = context.models[m], context.scene.solids[m]
        key = (id(model.surface), solid.shape, solid.tear_strain)
        if key not in made:
            made[key] = skin_of(model, solid)
        found[solid.name] = made[key]
    return found


EFFECTS = (Air(),)
