# SPDX-License-Identifier: GPL-2.0-only
"""A liquid in its basin, what it does to solids, and what the basin does to them. Wcislo 1999, sec. 4."""

from __future__ import annotations

import math
from types import MappingProxyType

import numpy as np

from ...effects.context import Verdict
from ...effects.effect import Effect
from ...effects.fields import column
from ...effects.margin import Margin
from ...effects.readings import LEAPFROG
from ...errors import Problem, SceneError
from ...model.planes import Plane, box_sides
from ...model.system import System
from ...model.tensors import largest_eigenvalue
from ...scene.formatting import number, say, whole
from ...scene.scene import LiquidModel
from ..air_drag import effect as air_drag
from ..contact.planes import Boundary
from ..contact.surface import SurfacePlanes
from ..springs.effect import all_held
from . import frames
from .balance import UNEVEN, full_basin, load_energy
from .basin import check_basin, leaky_walls, liquid_level, open_hulls, plan_grid, too_large
from .frames import COUPLING, FLOW, OCCUPANCY, WAVES, is_wavy
from .ledger import CELLS, DUE
from .tables import lattice_cells, layers_of_cells

EVERY = 4
"""Steps after which the fix looks whether cells are to be updated."""
STRIDE = 0.25
"""Cells that a solid travels at most between updates."""
PERIOD = 0.06
"""Time between updates of a liquid that is not level, over sqrt(cell/g)."""
NEAR = 8.0
"""Cells above the liquid up to which the motion of solids counts for it; as in the fix."""
WAVE_PERIOD, WAVE_STRIDE = 0.15, 1.5
"""As PERIOD and STRIDE, of waves. With 0.05 and 0.25, two to three times the updates, a dive is as deep to 1 % of the body's size
and the body leaps as high to 2 %; with 0.2 and 2.0 these are 2 and 7 %: bodies with sides of 6 to 24 cells, as fast as if fallen
from their own height (bench/dives.py)."""
CALM = 50.0
"""Time in which waves die, over sqrt(depth/g)."""
WAVE_DRAG = 0.15
"""Part of the usual drag that is left where waves take energy away."""
DRAG_COEFFICIENT = 0.5
"""C of quadratic drag, F = C rho A v^2 / 2: that of a sphere."""
DRAGGING = 0.07
"""Part of the coupling's time that drag takes (bench/effects.py shares)."""
SHALLOW = 4
"""Fewest cells of depth that show waves."""
LIGHT = 0.1
"""Density over that of the liquid below which a body shakes in waves and comes up late (docs/physics-liquid.md)."""
SWEEPS = 4
"""Fewest sweeps of the automaton for each cell that the fastest solid travels; 8 are better (docs/physics-liquid.md)."""


def top_of_reach(grid) -> float:
    """Height above which no solid matters to the liquid, however high it splashes in its basin [m]."""
    return grid.high[2] + NEAR * grid.cell[2]


def free_solid(scene):
    """A solid that can reach the liquid, or None: gravity brings there all that is not held."""
    return next((s for s in scene.solids if not all_held(s)), None)


class Basin(Boundary):
    """Floor and side walls of a basin [m], by the law of `Boundary`; the walls go on upward, so that nothing falls beside the
    basin (docs/physics-contact.md).
    """

    name = fix = "basin"
    order = 70
    presses = False  # what floats may never touch it
    if_off = "objects fall through the floor of the basin"

    def called_for(self, scene, reach):
        if scene.liquid is None:
            return Verdict(self.name, False, "no liquid in the scene")
        if free_solid(scene) is None:
            return Verdict(self.name, False, "nothing in the basin can move")
        return Verdict(self.name, True, f"the basin of {scene.liquid.name}", scene.liquid.spans.get("basin"))

    def planes(self, scene):
        if scene.liquid is None:
            return ()
        floor = Plane(self.name, "the basin", 2, 1, scene.liquid.low[2], "below the floor of the basin")
        return (*box_sides(self.name, scene.liquid, 2, "the basin"), floor)

    def region(self, scene):
        (x0, y0, z0), (x1, y1, _) = scene.liquid.low, scene.liquid.high
        return f"block {x0!r} {x1!r} {y0!r} {y1!r} {z0!r} INF"


class LiquidAutomaton(Effect):
    """The automaton: whole cells of liquid that fall, spread, level and make room for solids, Wcislo 1999, sec. 4 (docs/physics-
    liquid.md, "The automaton"). It has no energy; its step must see solids often enough.
    """

    styles = (("fix", "mdanim/liquid"),)
    name = fix = "liquid"
    on_grid = True
    order = 90
    needs = ("gravity",)
    if_off = "the basin stays empty"

    def called_for(self, scene, reach):
        if scene.liquid is None:
            return Verdict(self.name, False, "no liquid in the scene")
        return Verdict(self.name, True, f"{scene.liquid.name} in a basin", scene.liquid.spans.get("liquid"))

    def of(self, scene):
        return LiquidWaves() if is_wavy(scene) else self

    def margins(self, envelope):
        """Sweeps for each cell that the fastest solid travels: it may go on for EVERY steps before the fix looks."""
        liquid, cell = envelope.scene.liquid, min(envelope.context.grid.cell)
        bottom = np.minimum.reduceat(envelope.system.position[:, 2], envelope.system.first[:-1])
        surface = liquid_level(liquid)
        # Fastest at the surface on its way down or up, or at the floor.
        rise = np.maximum(0.0, surface - bottom) * np.maximum(0.0, -envelope.reach.weight_left)
        fastest = envelope.reach.speed_after(np.maximum.reduce([bottom - surface, rise, envelope.reach.fall]))
        m = int(fastest.argmax())
        speed = float(fastest[m])
        stride = STRIDE + EVERY * envelope.dt * speed / cell
        each = 2.0 * SWEEPS if liquid.sweeps is None else liquid.sweeps / stride
        few = each < SWEEPS
        return [
            Margin(
                "sweeps",
                envelope.system.names[m],
                each,
                SWEEPS,
                "per cell",
                f"liquid is swept {number(each, 2)} times for each cell that {envelope.system.names[m]} "
                f"travels at {say(speed, 'm/s')}; below {SWEEPS} "
                f"it is pushed up before it can flow away, {2 * SWEEPS} are better",
                liquid.spans.get("sweeps") or liquid.spans.get("liquid"),
                "warning" if few else "ok",
                least=True,
                hint=f"write sweeps auto, or {math.ceil(2 * SWEEPS * stride)}",
            )
        ]

    def acts_on(self, context):
        return context.grid is not None

    def fields(self, scene):
        return frames.fields(scene)

    def tell(self, readings):
        return frames.tell(readings)

    def fault(self, scene, time, fields):
        return frames.fault(scene, time, fields)

    def doubts(self, context, time, ledger):
        return frames.overflow(context, time, ledger)

    def weighed(self, scene, system):
        return full_basin(scene) if scene.liquid else 0.0

    def unsettled(self, scene, system):
        return UNEVEN * float(load_energy(scene, system).sum()) if scene.liquid else 0.0

    def counted(self, context):
        grid, liquid = context.grid, context.scene.liquid
        if grid is None or liquid is None:
            return "", {"liquid": None}
        off, rounded = 0.0, ""
        if liquid.volume is not None:
            off = grid.units(liquid.volume) * grid.cell_volume / liquid.volume - 1.0
        if abs(off) > 1e-9:
            rounded = f", its volume rounded by {'+' * (off > 0.0)}{number(100 * off, 2)} %"
        told = f", 1 liquid ({whole(grid.cells)} cell{'' if grid.cells == 1 else 's'}{rounded})"
        return told, {"liquid": {"name": liquid.name, "cells": list(grid.shape), "cell": list(grid.cell)}}

    gains = "liquid residual"

    def gained(self, first, now):
        return now[CELLS] - now.get(DUE, first[CELLS])

    def summary(self, first, last):
        return {CELLS: last[CELLS], "liquid_residual": self.gained(first, last)}

    def matters_below(self, context):
        return top_of_reach(context.grid)

    def grid(self, scene, h):
        grid = plan_grid(scene.liquid, h)
        if problems := too_large(scene.liquid, grid):
            raise SceneError(problems)
        return grid

    def problems(self, resolved, models, grid):
        return check_basin(resolved.scene, models, grid, resolved.on(Buoyancy.name))

    def pushes_below(self, scene):
        # Waves rise up to the rim of the basin.
        return -math.inf if scene.liquid is None else scene.liquid.high[2]

    def most_push(self, scene, bodies):
        return 0.0 if scene.liquid is None else math.hypot(*scene.gravity) * (scene.liquid.density / bodies.density)

    def warnings(self, context):
        return [*open_hulls(context.scene, context.models), *leaky_walls(context.scene, context.models, context.grid)]

    tags_of = MappingProxyType({"cell": 7})

    def tables(self, context):
        return {} if context.scene.liquid.model is LiquidModel.PAPER else {"cell": lattice_cells(context.system)}

    def clocks(self, readings):
        return {"flow": readings.fix_value(self.fix, FLOW), "occupancy": readings.fix_value(self.fix, OCCUPANCY)}

    def max_timestep(self, context):
        return PERIOD / EVERY * math.sqrt(min(context.grid.cell) / -context.scene.gravity[2])

    def words(self, scene) -> str:
        """Words of the command about the model."""
        model = "model paper" if scene.liquid.model is LiquidModel.PAPER else "cells i2_cell"
        return f"{model} still held sweeps {scene.liquid.sweeps or 'auto'} every {EVERY} stride {STRIDE} period {PERIOD}"

    def commands(self, context):
        scene = context.scene
        liquid, grid = scene.liquid, context.grid
        fill = [f"region fill {_block(*liquid.fill)}"] if liquid.fill else []
        words = [
            "fix liquid all mdanim/liquid liquid",
            repr(liquid.density),
            "grid",
            *map(str, grid.shape),
            f"volume {liquid.volume!r}" if liquid.volume is not None else f"level {liquid.level!r}",
            *(["fill fill"] if fill else []),
            f"gravity {-scene.gravity[2]!r}",
            self.words(scene),
            f"seed {scene.control.seed}",
        ]
        return ["group held type 5:8", f"region liquid {_block(liquid.low, liquid.high)}", *fill, " ".join(words)]


class LiquidWaves(LiquidAutomaton):
    """A liquid with momentum: columns of whole units move by their pressure rho g h [Pa] (docs/physics-liquid.md, "Waves")."""

    def tables(self, context):
        system = context.system
        cells = lattice_cells(system)
        layers = np.zeros((system.particles, 1), np.int32)
        layers[system.hexahedron[:, 0], 0] = layers_of_cells(system)
        return {"cell": np.hstack([cells, layers])}

    def margins(self, envelope):
        return []

    def max_timestep(self, context):
        return WAVE_PERIOD / EVERY * math.sqrt(min(context.grid.cell) / -context.scene.gravity[2])

    def columns(self, context):
        system = context.system
        return {column("softness", "m^3/Pa"): system.volume / system.young[system.object]}

    def words(self, scene):
        calm = scene.liquid.calm or calm_time(scene)
        solids = "cells i2_cell softness d_softness still held"
        drops = f" drops {scene.liquid.drops!r}" if scene.liquid.drops else ""
        pace = f"every {EVERY} stride {WAVE_STRIDE} period {WAVE_PERIOD}"
        return f"model waves calm {calm!r}{drops} {solids} {pace}{_makers(scene.liquid)}"

    def commands(self, context):
        regions = [f"region {name} {_block(flow.low, flow.high)}" for _, name, flow in _flows(context.scene.liquid)]
        return [*regions, *super().commands(context)]

    def warnings(self, context):
        scene, system = context.scene, context.system
        return [*_shallow(scene.liquid, context.grid.cell[2]), *_light(scene, system), *super().warnings(context)]


def _shallow(liquid, cell: float) -> list[Problem]:
    low, high = liquid.fill or (liquid.low, liquid.high)
    area = (high[0] - low[0]) * (high[1] - low[1])
    depth = (liquid.volume / area if liquid.level is None else liquid.level - low[2]) / cell
    if depth >= SHALLOW:
        return []
    return [
        Problem(
            liquid.spans.get("level") or liquid.spans.get("volume"),
            f"{liquid.name} is {number(depth, 2)} cells deep at the start; waves need {SHALLOW}",
            f"more liquid, or resolution {say(depth * cell / SHALLOW, 'm')}",
            severity="warning",
        )
    ]


def _light(scene, system) -> list[Problem]:
    """Solids that waves push late: one problem for all of them."""
    liquid, density = scene.liquid, system.density
    light = [m for m in np.flatnonzero(density < LIGHT * liquid.density).tolist() if not all_held(scene.solids[m])]
    if not light:
        return []
    m = min(light, key=density.__getitem__)
    spans = scene.solids[m].spans
    others = f" and {len(light) - 1} more" if light[1:] else ""
    return [
        Problem(
            spans.get("density") or spans.get("mass") or spans.get("object"),
            f"{system.names[m]}{others}: {number(density[m] / liquid.density, 2)} times as dense as {liquid.name}; what is "
            f"lighter than {LIGHT} shakes in waves, and comes up late",
            f"write a density of {number(LIGHT * liquid.density)} kg/m^3, or model surface in liquid {liquid.name}",
            severity="warning",
        )
    ]


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
        return "lift and drag of the liquid act as well, and frames do not tell them apart" if scene.liquid else ""

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
        return readings.fix_scalar(LiquidAutomaton.fix)

    def clocks(self, readings):
        drag = readings.context.on(LiquidDrag.name)
        return {"coupling": readings.fix_value(LiquidAutomaton.fix, COUPLING) * (1.0 - DRAGGING * drag)}


class WavePush(Buoyancy):
    """Lift and push by the pressure of a liquid with momentum on parts of lattice cells (docs/physics-liquid.md, "Bodies in
    waves").
    """

    ledger = "waves"
    further_ledger = ("wave_loss",)

    def rate(self, context):
        # It acts on parts of lattice cells that are half as high; those of a particle at a face lie at one height.
        return 2.0 * super().rate(context)

    def energy(self, readings):
        return readings.fix_value(LiquidAutomaton.fix, WAVES)

    def further_energies(self, readings):
        # The energy that closes the sum with the work on solids, of which the scalar is the negative.
        return {"wave_loss": readings.fix_scalar(LiquidAutomaton.fix) - readings.fix_value(LiquidAutomaton.fix, WAVES)}


class LiquidDrag(Effect):
    """F = -(gamma + k |v|) rho_l V_i s_i v on the part of a particle below the surface [N]; the leap-frog takes gamma's with the
    drag of air.

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
        air = system.drag if context.on(air_drag.AirDrag.name) else None
        dry = np.zeros(system.particles) if air is None else air
        quadratic = {column("quadratic", "1/m"): per_length(system)} if _has_quadratic_drag(scene) else {}
        still_air = {} if air is None else {column("air", "N s/m"): air}
        return {column("gamma", "1/s"): gamma(scene, system), **quadratic, air_drag.LAMBDA: dry, **still_air}

    def friction(self, context):
        # Quadratic drag is not part of it: a step takes a particle less than a tenth of a spacing, so k v dt is small.
        scene, system = context.scene, context.system
        return gamma(scene, system) * scene.liquid.density * system.volume

    def commands(self, context):
        base = " base d_air" if context.on(air_drag.AirDrag.name) else ""
        quadratic = " quadratic d_quadratic" if _has_quadratic_drag(context.scene) else ""
        return [f"fix_modify liquid drag d_gamma{quadratic} lambda d_lambda{base}"]

    def losses(self, scene):
        return (air_drag.DRAG_LOSS,)

    def lost(self, readings):
        # Where air drag is on, that effect tells it.
        return {air_drag.DRAG_LOSS: 0.0 if readings.context.on(air_drag.AirDrag.name) else readings.fix_scalar("leapfrog")}

    def clocks(self, readings):
        # Where particles are immersed is looked up for buoyancy in any case; drag adds this to it,
        # and makes the leap-frog slower.
        coupling = {"coupling": DRAGGING * readings.fix_value(LiquidAutomaton.fix, COUPLING)}
        if readings.context.on(air_drag.AirDrag.name):
            return coupling
        return coupling | {LEAPFROG: air_drag.slowed_share(readings) * readings.fix_seconds("leapfrog")}


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


def calm_time(scene) -> float:
    """Time in which waves die where the scene does not tell it [s]."""
    return CALM * math.sqrt((liquid_level(scene.liquid) - scene.liquid.low[2]) / -scene.gravity[2])


def _reached(name: str, scene) -> Verdict:
    """On where a solid can reach the liquid."""
    if scene.liquid is None:
        return Verdict(name, False, "no liquid in the scene")
    solid = free_solid(scene)
    if solid is None:
        return Verdict(name, False, "nothing that can move reaches the liquid")
    return Verdict(name, True, f"{solid.name} can reach {scene.liquid.name}", solid.spans.get("object"))


def _flows(liquid):
    """Flows of liquid in and out through boxes: the word, the name of the region, the record."""
    for word, flows in (("inflow", liquid.inflow), ("drain", liquid.drain)):
        for n, flow in enumerate(flows):
            yield word, f"{word}-{n}", flow


def _makers(liquid) -> str:
    """Words of the fix for what makes waves."""
    words = [f" wave {w.side} {w.amplitude!r} {w.period!r}" for w in liquid.wave]
    words += [f" current {c.side} {c.speed!r}" for c in liquid.current]
    for word, name, flow in _flows(liquid):
        velocity = f" {flow.velocity[0]!r} {flow.velocity[1]!r}" if word == "inflow" else ""
        words.append(f" {word} {name} {flow.rate!r}{velocity}")
    return "".join(words)


def _block(low, high) -> str:
    return "block " + " ".join(f"{a!r} {b!r}" for a, b in zip(low, high))


class SurfaceBasin(SurfacePlanes, Basin):
    """The same by the law of `SurfacePlanes` (docs/physics-contact.md)."""


EFFECTS = (Basin(SurfaceBasin()), LiquidAutomaton(), Buoyancy(), LiquidDrag())
