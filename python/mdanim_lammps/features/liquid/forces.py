# SPDX-License-Identifier: GPL-2.0-only
"""Forces of a liquid on solids: lift, the push of waves, drag. Wcislo 1999, sec. 4.2."""

from __future__ import annotations

import math

import numpy as np

from ...bodies import all_held, driven
from ...effects.context import Verdict
from ...effects.effect import Effect
from ...effects.fields import column
from ...effects.leapfrog import DRAG_LOSS, LAMBDA, drag_loss, drag_seconds
from ...model.system import System
from ...model.tensors import largest_eigenvalue
from .basin import liquid_level
from .frames import COUPLING, FIX, is_wavy

WAVE_DRAG = 0.06
"""Part of the usual drag that is left where waves take energy away, with which a sphere bobs as one in the sea."""
DRAG_COEFFICIENT = 0.5
"""C of quadratic drag, F = C rho A v^2 / 2: that of a sphere."""
DRAGGING = 0.07
"""Part of the coupling's time that drag takes (bench/effects.py shares)."""


def free_solid(scene):
    """A solid that can reach the liquid, or None: gravity brings there all that is not held."""
    return next((s for s in scene.solids if not all_held(s)), None)


def wet_solid(scene):
    """A solid that the liquid may push on, or None: one that is free, or driven."""
    moved = driven(scene)
    return next((s for m, s in enumerate(scene.solids) if m in moved or not all_held(s)), None)


class Buoyancy(Effect):
    """Archimedes, particle by particle: F = rho_l V_i s_i g upward [N] on the part s_i of a particle below the surface, Wcislo
    1999, sec. 4.2.

    In the bound it is a spring to the surface, rho_l V g/(h m) [1/s^2] (docs/physics-liquid.md, "Forces on solids").
    """

    name = "buoyancy"
    at_surfaces = True
    order = 100
    ledger = "buoyancy"
    has_arbitrary_zero = True
    needs = ("liquid",)
    if_off = "objects sink like stones"

    def of(self, scene):
        return WavePush() if is_wavy(scene) else self

    def called_for(self, scene, reach):
        return _reached(self.name, scene)

    def columns(self, context):
        return {column("volume", "m^3"): context.system.volume}

    def commands(self, context):
        return ["fix_modify liquid buoyancy d_volume"]

    def untold(self, scene):
        why = "lift and drag of the liquid act as well, and frames do not tell them apart"
        return dict.fromkeys(range(len(scene.solids)), why) if scene.liquid else {}

    def pushes_below(self, scene):
        # Waves rise up to the rim of the basin.
        return -math.inf if scene.liquid is None else scene.liquid.high[2]

    def most_push(self, scene, bodies):
        return 0.0 if scene.liquid is None else math.hypot(*scene.gravity) * (scene.liquid.density / bodies.density)

    def lift(self, scene, system):
        return 0.0 if scene.liquid is None else scene.liquid.density * np.add.reduceat(system.volume, system.first[:-1])

    def surface(self, scene):
        return None if scene.liquid is None else liquid_level(scene.liquid)

    def rate(self, context):
        scene, system = context.scene, context.system
        weight = scene.liquid.density * -scene.gravity[2]
        # s_i goes from 0 to 1 over the height of a cell: a spring to the surface, which does not move along.
        stiffness = weight * system.volume / context.grid.cell[2]
        return np.where(system.held, 0.0, stiffness / system.mass)

    def energy(self, readings):
        return readings.fix_scalar(FIX)

    def clocks(self, readings):
        drag = readings.context.on(LiquidDrag.name)
        return {"coupling": readings.fix_value(FIX, COUPLING) * (1.0 - DRAGGING * drag)}


class WavePush(Buoyancy):
    """Lift and push by the pressure of a liquid with momentum on parts of lattice cells (docs/physics-liquid.md, "Bodies in
    waves"). Its work is among the accounts of the waves.
    """

    ledger = ""
    has_arbitrary_zero = False

    def energy(self, readings):
        return 0.0

    def rate(self, context):
        # It acts on parts of lattice cells that are half as high; those of a particle at a face lie at one height.
        return 2.0 * super().rate(context)


class LiquidDrag(Effect):
    """F = -(gamma + k |v|) rho_l V_i s_i v on the part of a particle below the surface [N]; the leap-frog takes gamma's with all
    other drag.

    gamma = sqrt(g/L) [1/s] and k = C/2L [1/m] of a body of size L [m], unless ``drag`` says otherwise (docs/physics-
    liquid.md, "Forces on solids").
    """

    name = "liquid-drag"
    order = 110
    needs = ("liquid", "buoyancy")  # which gives the fix the volumes
    if_off = "floating objects bob for a long time"

    def called_for(self, scene, reach):
        if scene.liquid is not None and scene.liquid.drag == 0.0:
            return Verdict(self.name, False, f"{scene.liquid.name} has drag 0", scene.liquid.spans.get("drag"))
        return _reached(self.name, scene)

    def columns(self, context):
        scene, system = context.scene, context.system
        dry = np.zeros(system.particles) if context.drag is None else context.drag
        quadratic = {column("quadratic", "1/m"): per_length(system)} if _has_quadratic_drag(scene) else {}
        base = {} if context.drag is None else {column("base", "N s/m"): dry}
        return {column("gamma", "1/s"): gamma(scene, system), **quadratic, LAMBDA: dry, **base}

    def friction(self, context):
        # Quadratic drag is not part of it: a step takes a particle less than a tenth of a spacing, so k v dt is small.
        scene, system = context.scene, context.system
        return gamma(scene, system) * scene.liquid.density * system.volume

    def commands(self, context):
        base = "" if context.drag is None else " base d_base"
        quadratic = " quadratic d_quadratic" if _has_quadratic_drag(context.scene) else ""
        return [f"fix_modify liquid drag d_gamma{quadratic} lambda d_lambda{base}"]

    def losses(self, scene):
        return (DRAG_LOSS,)

    def lost(self, readings):
        return drag_loss(self, readings)

    def clocks(self, readings):
        # Where particles are immersed is looked up for buoyancy in any case; drag adds this to it,
        # and makes the leap-frog slower.
        return {"coupling": DRAGGING * readings.fix_value(FIX, COUPLING), **drag_seconds(self, readings)}


def gamma(scene, system: System) -> np.ndarray:
    """Drag rate of each particle [1/s], shape (N,); ``auto`` is sqrt(g/L), L^3 the volume of its solid, or a part of that."""
    if scene.liquid.drag is not None:
        return np.full(system.particles, scene.liquid.drag)
    part = WAVE_DRAG if is_wavy(scene) else 1.0
    return part * np.sqrt(-scene.gravity[2] / _size(system))[system.object]


def per_length(system: System) -> np.ndarray:
    """Quadratic drag of each particle over its immersed mass of liquid and its speed squared [1/m], shape (N,): C/2L.

    L is the longest edge of the box with the second moments of its solid, as what is long mostly moves that way.
    """
    first = system.first[:-1]
    total = np.add.reduceat(system.volume, first)
    away = system.position - system.center_of_mass(system.position)[system.object]
    squares = (system.volume[:, None, None] * away[:, :, None] * away[:, None, :]).reshape(-1, 9)
    moments = (np.add.reduceat(squares, first) / total[:, None]).reshape(-1, 3, 3)
    return (0.5 * DRAG_COEFFICIENT / np.sqrt(12.0 * largest_eigenvalue(moments)))[system.object]


def _has_quadratic_drag(scene) -> bool:
    return is_wavy(scene) and scene.liquid.drag is None


def _size(system: System) -> np.ndarray:
    """Edge of the cube of equal volume of each object [m], shape (M,)."""
    return np.cbrt(np.add.reduceat(system.volume, system.first[:-1]))


def _reached(name: str, scene) -> Verdict:
    """On where a solid can reach the liquid."""
    if scene.liquid is None:
        return Verdict(name, False, "no liquid in the scene")
    solid = wet_solid(scene)
    if solid is None:
        return Verdict(name, False, "nothing that can move reaches the liquid")
    return Verdict(name, True, f"{solid.name} can reach {scene.liquid.name}", solid.spans.get("object"))
