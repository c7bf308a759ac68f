# SPDX-License-Identifier: GPL-2.0-only
"""Fields of a liquid in a frame: its surface, its drops, and its accounts."""

from __future__ import annotations

import ctypes
from collections.abc import Callable

import numpy as np

from ...effects.context import Context
from ...effects.fields import Field, Fields
from ...effects.readings import Readings
from ...errors import Problem, SetupError
from ...model.grid import Grid
from ...scene.formatting import exact, number, say
from ...scene.scene import SceneRecord
from .kept import DROPS, HEIGHT, MOST_DROPS, RAW, WAY
from .ledger import CELLS, CREST, DUE, MOMENTA
from .ledger import WAVES as ENERGY
from .record import LiquidModel

NOW, AT_START, WAVES, HIGHEST = "cells", "cells_at_start", "waves", "crest"
FLOW, OCCUPANCY, COUPLING = "flow_seconds", "occupancy_seconds", "coupling_seconds"
"""In the fix's vector: cells of liquid now and before step 0, to the unit, three clocks [s], the energy of a liquid with momentum
since then [J], its highest point [m]."""
MOMENTUM, TO_BASIN = ("momentum_x", "momentum_y"), ("basin_impulse_x", "basin_impulse_y")
TO_SOLIDS, CAME = ("solid_impulse_x", "solid_impulse_y"), ("came_x", "came_y")
"""In the fix's vector, along x and y [N s]: the liquid's momentum; the impulses that it has given to its basin with all that is
held, and to what moves; the momentum that came with liquid, less what went with it."""
ALONG = ("way_x", "way_y")
"""In the fix's vector: displacement of the basin from where it is at the start [m]."""
OUTER, WORK = "outer", "work"
"""In the fix's vector: energy from outside, of liquid that comes and goes and of the acceleration of a basin that moves,
since the start of the liquid, and since that of an instance [J]."""
CLOCK = "clock"
"""In the fix's vector: time that a liquid with momentum has gone through, or has slept at rest [s]."""
OVERFLOW = 0.05
"""Part of what inflows bring that may be missing without a word: updates lag behind."""
CLOCK_ROUNDING = 1e-9
"""Part by which two sums of a million times may differ [-]."""
FIX = "liquid"
TIME = "liquid_clock"
"""Field: the time that a liquid with momentum has gone through."""


def is_wavy(scene: SceneRecord) -> bool:
    """Whether the liquid has momentum."""
    return scene.liquid is not None and scene.liquid.model is LiquidModel.WAVES


def fields(scene: SceneRecord) -> tuple[Field, ...]:
    """Cells to the unit: whole ones of an automaton, whole 2^-20 of one of waves. The highest liquid is a column of the ledger
    where an ``expect`` asks for it; so is the energy of waves of an automaton, 0, as others have it among their energies."""
    asked = {e.quantity for e in scene.asked if e.subject == "liquid"}
    return (
        Field(CELLS, "1", ledger=True, whole=True),
        Field(DUE, "1", ledger=scene.liquid.fed, whole=True),
        Field(CREST, "m", ledger="crest" in asked),
        Field(ENERGY, "J", ledger="waves" in asked and not is_wavy(scene)),
        *(Field(name, "N s", ledger=True) for name in MOMENTA if is_wavy(scene)),
        *(Field(TIME, "s") for _ in range(is_wavy(scene))),
        HEIGHT,
        RAW,
        *(DROPS for _ in range(bool(scene.liquid.drops))),
        *(WAY for _ in range(scene.liquid.moves)),
    )


def tell(readings: Readings) -> Fields:
    """The values of these fields."""
    scene = readings.context.scene
    found = {
        CELLS: readings.fix_value(FIX, NOW),
        DUE: readings.fix_value(FIX, AT_START),
        CREST: readings.fix_value(FIX, HIGHEST),
        ENERGY: readings.fix_value(FIX, WAVES),
        **dict(zip((HEIGHT.name, RAW.name), heights(readings))),
    }
    if scene.liquid.drops:
        found[DROPS.name] = drops(readings)
    if scene.liquid.moves:
        found[WAY.name] = np.array([[*(readings.fix_value(FIX, n) for n in ALONG), 0.0]])
    if is_wavy(scene):
        found[TIME] = readings.fix_value(FIX, CLOCK)
        found |= dict(zip(MOMENTA, momenta(readings)))
    return found


def momenta(readings: Readings) -> tuple[float, ...]:
    """MOMENTA of the ledger now [N s], each along x and y."""
    liquid, basin, solids, came = (
        np.array([readings.fix_value(FIX, n) for n in entries]) for entries in (MOMENTUM, TO_BASIN, TO_SOLIDS, CAME)
    )
    return tuple(np.concatenate([liquid, basin, solids, liquid + basin + solids - came]).tolist())


def fault(scene: SceneRecord, time: float, fields: Fields) -> str:
    """Cells that have come or gone by themselves, and a liquid in slow motion."""
    if fields[CELLS] != fields[DUE]:
        come = " and come since" if scene.liquid.fed else ""
        return f"{exact(fields[CELLS])} cells of liquid, {exact(fields[DUE])} at the start{come}"
    gone = fields.get(TIME)
    if gone is not None and not abs(gone - time) <= CLOCK_ROUNDING * time:
        return f"{scene.liquid.name} has gone through {number(gone, 9)} s"
    return ""


def overflow(context: Context, time: float, ledger: Callable[[str], np.ndarray]) -> list[Problem]:
    """Warn where inflows found no room in this time [s]; only where liquid comes and goes in no other way."""
    liquid = context.scene.liquid
    if not liquid.inflow or liquid.drain or liquid.wave or liquid.current:
        return []
    due = ledger(DUE)
    asked, came = sum(flow.rate for flow in liquid.inflow) * time, (due[-1] - due[0]) * float(np.prod(context.grid.cell))
    if came > (1.0 - OVERFLOW) * asked:
        return []
    return [
        Problem(
            liquid.spans.get("inflow"),
            f"{liquid.name}: {say(came, 'm^3')} of {say(asked, 'm^3')} came in; the basin was full, or the place of the inflow",
            "write a higher basin, a drain at the height of the rim, or another place",
            severity="warning",
        )
    ]


# --- what the plugin is asked ---------------------------------------------------------------------------------------


def heights(readings: Readings) -> np.ndarray:
    """Height of every column of cells [m], shape (2, ny, nx): the surface that solids feel, and the topmost liquid.

    The second is NaN where a body hides it, minus infinity where one keeps the column dry below the surface, as a
    hull does its inside. Raises SetupError without a liquid.
    """
    found = np.empty((2, *_grid(readings).shape[1::-1]))
    readings.call("tell the surface", "mdanim_liquid_heights", FIX, *found)
    return found


def drops(readings: Readings) -> np.ndarray:
    """Middle and radius of each drop that flies [m], shape (D, 4), oldest first. Raises SetupError without a liquid."""
    rows, count = np.empty((MOST_DROPS, 4)), ctypes.c_int()
    readings.call("tell drops", "mdanim_liquid_drops", FIX, MOST_DROPS, rows, ctypes.byref(count))
    return rows[: count.value]


def cells(readings: Readings) -> np.ndarray:
    """Content of every cell, 255 where it is solid; uint8, shape (nz, ny, nx). Raises SetupError without a liquid."""
    found = np.empty(_grid(readings).shape[::-1], np.uint8)
    readings.call("tell cells", "mdanim_liquid_cells", FIX, found)
    return found


def _grid(readings: Readings) -> Grid:
    if readings.context.grid is None:
        raise SetupError("the scene has no liquid, or it is switched off")
    return readings.context.grid
