# SPDX-License-Identifier: GPL-2.0-only
"""A liquid in its basin, what it does to solids, and what the basin does to them. Wcislo 1999, sec. 4."""

from __future__ import annotations

import math

import numpy as np

from ...bodies import all_held
from ...effects.context import Verdict
from ...effects.effect import Effect
from ...effects.fields import column
from ...effects.margin import Margin
from ...errors import Problem, SceneError
from ...model.planes import Plane, box_sides
from ...scene.formatting import number, say, whole
from ..contact.planes import Sides
from ..contact.surface import touching_planes
from ..drives.shift import motion_of
from . import frames
from .balance import UNEVEN, full_basin, load_energy, starting_energy
from .basin import check_basin, leaky_walls, liquid_level, open_hulls, plan_grid, too_large
from .forces import Buoyancy, LiquidDrag, free_solid
from .frames import FIX, FLOW, OCCUPANCY, OUTER, WAVES, WORK, is_wavy
from .ledger import CELLS, DUE
from .ledger import WAVES as ENERGY
from .record import LiquidModel
from .tables import lattice_cells, layers_of_cells

CELLS_OF = column("cell", "1", dtype="int32", shape=(7,), tags=7)
"""The further corners of the lattice cell of which a particle is the first one, see `lattice_cells`."""
CELLS_AND_LAYERS = column("cell", "1", dtype="int32", shape=(8,), tags=7)
"""The same, and the layers of cells around that one."""
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
"""Time in which waves die, over that of a long wave through the basin."""
ROUNDING = 1e-9
"""Share by which the density of a body, mass over volume of its cells, may miss the one that was written."""
SHALLOW = 4
"""Fewest cells of depth that show waves."""
LIGHT = 0.1
"""Density over that of the liquid below which a body shakes in waves and comes up late (docs/physics-liquid.md)."""
SWEEPS = 4
"""Fewest sweeps of the automaton for each cell that the fastest solid travels; 8 are better (docs/physics-liquid.md)."""


def moved(context) -> bool:
    """Whether something of what is held is driven."""
    return context.system.moved is not None


def top_of_reach(grid) -> float:
    """Height above which no solid matters to the liquid, however high it splashes in its basin [m]."""
    return grid.high[2] + NEAR * grid.cell[2]


class BasinSides(Sides):
    """Floor and side walls of a basin [m]; the walls go on upward, so that nothing falls beside the basin."""

    name = "basin"
    order = 70
    presses = False  # what floats may never touch it
    if_off = "objects fall through the floor of the basin"

    def called_for(self, scene):
        if scene.liquid is None:
            return Verdict(self.name, False, "no liquid in the scene")
        if free_solid(scene) is None:
            return Verdict(self.name, False, "nothing in the basin can move")
        return Verdict(self.name, True, f"the basin of {scene.liquid.name}", scene.liquid.spans.get("basin"))

    def planes(self, scene):
        if scene.liquid is None:
            return ()
        motion = motion_of(self.name, *_motion(scene))
        beyond = "below the floor of the basin"
        floor = Plane(self.name, "the basin", 2, 1, scene.liquid.low[2], beyond, motion=motion)
        return (*box_sides(self.name, scene.liquid, 2, "the basin", motion), floor)

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

    def doubts(self, context, run):
        return frames.overflow(context, run.times[-1], run.ledger)

    def weighed(self, scene, system):
        return full_basin(scene) if scene.liquid else 0.0

    def unsettled(self, scene, system):
        if not scene.liquid:
            return 0.0
        return UNEVEN * float(load_energy(scene, system).sum()) + starting_energy(scene, system)

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

    def warnings(self, context):
        return [*open_hulls(context.scene, context.models), *leaky_walls(context.scene, context.models, context.grid)]

    def columns(self, context):
        return {} if context.scene.liquid.model is LiquidModel.PAPER else {CELLS_OF: lattice_cells(context.system)}

    def clocks(self, readings):
        return {"flow": readings.fix_value(self.fix, FLOW), "occupancy": readings.fix_value(self.fix, OCCUPANCY)}

    def max_timestep(self, context):
        return PERIOD / EVERY * math.sqrt(min(context.grid.cell) / -context.scene.gravity[2])

    def words(self, scene, held: str) -> str:
        """Words of the command about the model; ``held`` are those about what is held."""
        model = "model paper" if scene.liquid.model is LiquidModel.PAPER else "cells i2_cell"
        return f"{model} {held} sweeps {scene.liquid.sweeps or 'auto'} every {EVERY} stride {STRIDE} period {PERIOD}"

    def commands(self, context):
        scene = context.scene
        liquid, grid = scene.liquid, context.grid
        fill = [f"region {name} {_block(low, high)}" for name, low, high in _filled(liquid)]
        if liquid.pool:
            fill.append(f"region fill union {len(fill)} {' '.join(name for name, *_ in _filled(liquid))}")
        words = [
            "fix liquid all mdanim/liquid liquid",
            repr(liquid.density),
            "grid",
            *map(str, grid.shape),
            f"volume {liquid.volume!r}" if liquid.volume is not None else f"level {liquid.level!r}",
            *(["fill fill"] if fill else []),
            f"gravity {-scene.gravity[2]!r}",
            self.words(scene, _held(context)),
            f"seed {scene.control.seed}",
        ]
        group = ["group held type 5:8", *(["group standing subtract held driven"] if moved(context) else [])]
        return [*group, f"region liquid {_block(liquid.low, liquid.high)}", *fill, " ".join(words)]


class LiquidWaves(LiquidAutomaton):
    """A liquid with momentum: columns of whole units move by their pressure rho g h [Pa] (docs/physics-liquid.md, "Waves")."""

    ledger = ENERGY
    further_ledger = ("wave_loss",)
    has_arbitrary_zero = True

    def energy(self, readings):
        return readings.fix_value(FIX, WAVES)

    def further_energies(self, readings):
        # The energy that closes the sum with the work on solids, of which the scalar is the negative, and that on the liquid.
        outer = readings.fix_value(FIX, OUTER) if self.sources(readings.context.scene) else 0.0
        return {"wave_loss": readings.fix_scalar(FIX) + outer - readings.fix_value(FIX, WAVES)}

    def sources(self, scene):
        return (WORK,) if scene.liquid.moves or scene.liquid.fed else ()

    def lost(self, readings):
        return {term: readings.fix_value(FIX, term) for term in self.sources(readings.context.scene)}

    def margins(self, envelope):
        return []

    def max_timestep(self, context):
        return WAVE_PERIOD / EVERY * math.sqrt(min(context.grid.cell) / -context.scene.gravity[2])

    def columns(self, context):
        system = context.system
        layers = np.zeros((system.particles, 1), np.int32)
        layers[system.hexahedron[:, 0], 0] = layers_of_cells(system)
        return {
            column("softness", "m^3/Pa"): system.volume / system.young[system.object],
            CELLS_AND_LAYERS: np.hstack([lattice_cells(system), layers]),
        }

    def words(self, scene, held):
        calm = scene.liquid.calm or (0.0 if scene.liquid.manning else calm_time(scene))
        solids = f"cells i2_cell softness d_softness {held}"
        drops = f" drops {scene.liquid.drops!r}" if scene.liquid.drops else ""
        pace = f"every {EVERY} stride {WAVE_STRIDE} period {WAVE_PERIOD}"
        slows = "".join(f" {word} {value!r}" for word, value in (("calm", calm), ("manning", scene.liquid.manning)) if value)
        return f"model waves{slows}{drops} {solids} {pace}{_makers(scene.liquid)}"

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
    light = [
        m for m in np.flatnonzero(density < LIGHT * liquid.density * (1.0 - ROUNDING)).tolist() if not all_held(scene.solids[m])
    ]
    if not light:
        return []
    m = min(light, key=density.__getitem__)
    spans = scene.solids[m].spans
    others = f" and {len(light) - 1} more" if light[1:] else ""
    return [
        Problem(
            spans.get("density") or spans.get("mass") or spans.get("object"),
            f"{system.names[m]}{others}: {number(density[m] / liquid.density, 2)} times as dense as {liquid.name}; bodies "
            f"below {LIGHT} shake in waves, and come up late",
            f"write a density of {number(LIGHT * liquid.density)} kg/m^3, or model surface in liquid {liquid.name}",
            severity="warning",
        )
    ]


def calm_time(scene) -> float:
    """Time in which waves die where the scene does not tell it [s]: CALM times that of a long wave through the basin, or of a
    deep one through its depth."""
    depth = liquid_level(scene.liquid) - scene.liquid.low[2]
    longest = max(high - low for low, high in zip(scene.liquid.low[:2], scene.liquid.high[:2]))
    return CALM * max(longest, depth) / math.sqrt(-scene.gravity[2] * depth)


def _held(context) -> str:
    """Words about what is held, and about a basin that moves."""
    words = "still standing driven driven" if moved(context) else "still held"
    motion = motion_of(BasinSides.name, *_motion(context.scene))
    return f"{words} moving {motion.fix}" if motion else words


def _motion(scene):
    return scene.liquid.drive, scene.liquid.keys, scene.control.time


def _flows(liquid):
    """Flows of liquid in and out through boxes: the word, the name of the region, the record."""
    for word, flows in (("inflow", liquid.inflow), ("drain", liquid.drain)):
        for n, flow in enumerate(flows):
            yield word, f"{word}-{n}", flow


def _filled(liquid):
    """Boxes that liquid starts in: the name of the region, and its corners."""
    if liquid.fill:
        yield ("part-0" if liquid.pool else "fill", *liquid.fill)
    for n, pool in enumerate(liquid.pool, start=1):
        yield f"part-{n}", pool.low, pool.high


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


EFFECTS = (touching_planes(BasinSides()), LiquidAutomaton(), Buoyancy(), LiquidDrag())
