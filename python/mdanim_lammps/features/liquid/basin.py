# SPDX-License-Identifier: GPL-2.0-only
"""The automaton's grid in a basin (Wcislo 1999, sec. 5.2), and whether liquid and solids fit into it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ...errors import Problem
from ...model import shapes
from ...model.grid import Grid
from ...model.model import Model
from ...processes import available_memory
from ...scene.formatting import at_least, estimate, number, say
from ...scene.scene import Mesh, SceneRecord, Solid, Torus, Vector
from .occupied import room
from .record import Liquid, LiquidModel

BYTES_PER_CELL = 20.0
MOST_STATE = 2.0**31 - 1
"""Bytes of state that LAMMPS can count in a restart file."""
"""Memory of fix mdanim/liquid per cell, measured 18 to 21: content, masks, counts of samples, marks."""
NARROWEST = 3
"""Fewest cells along a side: with two, no cell is off the walls, and a slope has no middle."""


def plan_grid(liquid: Liquid, h: float) -> Grid:
    """The grid of a basin at spacing h [m].

    A side that is not a multiple of h gets cells up to a tenth longer; where even that is too short for a whole
    number of cells (fewer than ten of them), cells as near to h as can be.
    """
    shape = []
    for a, b in zip(liquid.low, liquid.high):
        ratio = (b - a) / h * (1 + 1e-9)
        whole = math.floor(ratio)
        shape.append(whole if whole and ratio <= 1.1 * whole else max(1, round(ratio)))
    return Grid(liquid.low, liquid.high, tuple(shape))


def liquid_level(liquid: Liquid) -> float:
    """Height of the liquid in its basin when it has come to rest without any solid [m]."""
    low, high = liquid.fill or (liquid.low, liquid.high)
    volume = liquid.volume
    if volume is None:
        volume = (liquid.level - low[2]) * (high[0] - low[0]) * (high[1] - low[1])
    area = (liquid.high[0] - liquid.low[0]) * (liquid.high[1] - liquid.low[1])
    return liquid.low[2] + (volume + pooled(liquid)) / area


def pooled(liquid: Liquid) -> float:
    """Volume of all pools [m^3]."""
    return sum(math.prod(b - a for a, b in zip(pool.low, pool.high)) for pool in liquid.pool)


# --- whether all fits ---------------------------------------------------------------------------------------


def check_basin(scene: SceneRecord, models: Sequence[Model], grid: Grid, lifts: bool) -> list[Problem]:
    """Find a basin that is too narrow or too large, a liquid of no cell, and liquid and solids that do not fit into the basin.

    Solids that float need room for what they displace, others, and all where nothing ``lifts``, for all of their volume; those
    that are held, even in part, take the room that they have at the start.
    """
    problems = [*_unusable(scene.liquid, grid), *_too_fast(scene)]
    return problems or [*_too_full(scene, models, grid, lifts), *_too_snug(scene, models, grid)]


def too_large(liquid: Liquid, grid: Grid) -> list[Problem]:
    """Find a basin that does not fit into memory, or waves whose state no checkpoint can hold: it need not wait for the models
    of all solids."""
    needed, free = grid.cells * BYTES_PER_CELL, available_memory()
    has = f"the basin has {estimate(grid.cells)} cells of {say(max(grid.cell), 'm')}"
    if needed > free:
        over, cause = needed / free, f"{has}, which need {number(needed * 1e-9)} GB, {number(free * 1e-9)} GB are free"
    elif liquid.model is LiquidModel.WAVES and (kept := wave_state(grid)) > MOST_STATE:
        over, cause = kept / MOST_STATE, f"{has}; {estimate(grid.cells / (kept / MOST_STATE))} are the most that waves can have"
    else:
        return []
    coarser = 1.1 * max(grid.cell) * over ** (1 / 3)
    return [Problem(liquid.spans.get("basin"), cause, f"try resolution {say(coarser, 'm')}, or a smaller basin")]


def wave_state(grid: Grid) -> float:
    """Most bytes of state that a liquid with momentum has in a checkpoint, as WaveBasin::unusable counts them."""
    nx, ny, nz = grid.shape
    return 4.0 * nx * ny * nz + 200.0 * nx * ny


def _unusable(liquid: Liquid, grid: Grid) -> list[Problem]:
    """Faults of the grid itself."""
    place = liquid.spans.get("basin")
    axis = int(np.argmin(grid.shape))
    if grid.shape[axis] < NARROWEST:
        side, n = liquid.high[axis] - liquid.low[axis], grid.shape[axis]
        return [
            Problem(
                place,
                f"the basin is {n} cell{'' if n == 1 else 's'} wide along {'xyz'[axis]}, {say(side, 'm')}; "
                f"the least is {NARROWEST}",
                f"write resolution {say(0.9 * side / NARROWEST, 'm')} in control, or make the basin larger",
            )
        ]
    if found := too_large(liquid, grid):
        return found
    low, high = liquid.fill or (liquid.low, liquid.high)
    if not grid.cells_within(low, high):
        thinnest = min(b - a for a, b in zip(low, high))
        return [
            Problem(
                liquid.spans.get("fill"),
                f"no cell of the basin has its centre in the part to fill, which is {say(thinnest, 'm')} thin "
                f"where cells are {say(max(grid.cell), 'm')}",
                f"fill more of the basin, or write resolution {say(0.9 * thinnest, 'm')} in control",
            )
        ]
    for pool in liquid.pool:
        if not grid.cells_within(pool.low, pool.high):
            thinnest = min(b - a for a, b in zip(pool.low, pool.high))
            return [
                Problem(
                    liquid.spans.get("pool"),
                    f"no cell of the basin has its centre in the pool, which is {say(thinnest, 'm')} thin "
                    f"where cells are {say(max(grid.cell), 'm')}",
                    f"a larger pool, or resolution {say(0.9 * thinnest, 'm')} in control",
                )
            ]
    top = high if liquid.level is None else (high[0], high[1], min(high[2], liquid.level))
    volume = liquid.volume or math.prod(b - a for a, b in zip(low, top))
    if grid.units(volume) < 1:
        return [
            Problem(
                liquid.spans.get("volume" if liquid.volume is not None else "level"),
                f"{say(volume, 'm^3')} of liquid are less than half a cell of {say(grid.cell_volume, 'm^3')}",
                f"more liquid, or resolution {say(0.8 * volume ** (1 / 3), 'm')}",
            )
        ]
    return []


def _too_fast(scene: SceneRecord) -> list[Problem]:
    """Liquid that comes in faster than waves are let flow, WaveLaw::fastest in plugin/liquid/waves/law.h."""
    liquid = scene.liquid
    most = 4.0 * math.sqrt(math.hypot(*scene.gravity) * (liquid.high[2] - liquid.low[2]))
    speeds = [("current", c.speed) for c in liquid.current] + [("inflow", max(map(abs, f.velocity))) for f in liquid.inflow]
    return [
        Problem(
            liquid.spans.get(word),
            f"the {word} comes at {say(speed, 'm/s')}; in this basin liquid flows at {say(most, 'm/s')} at most, four "
            "times as fast as the longest waves of a full one",
            f"write at most {say(0.99 * most, 'm/s', 2)}, or make the basin higher",
        )
        for word, speed in speeds
        if 0.0 < most < speed
    ]


def _too_snug(scene: SceneRecord, models: Sequence[Model], grid: Grid) -> list[Problem]:
    """Bodies beside which there is no column of liquid that shows its height."""
    problems = []
    for solid, model in zip(scene.solids, models):
        gap = [
            (b - a) - float(np.ptp(model.position[:, axis]))
            for axis, (a, b) in enumerate(zip(scene.liquid.low[:2], scene.liquid.high[:2]))
        ]
        if model.held.any() or any(g >= 1.5 * c for g, c in zip(gap, grid.cell)):
            continue
        problems.append(
            Problem(
                solid.spans.get("shape") or solid.spans.get("object"),
                f"{solid.name} fills the basin from wall to wall but for {say(max(gap), 'm')}, less than one and a half cells of "
                f"{say(max(grid.cell), 'm')}: no liquid beside it tells how deep it floats",
                f"a smaller object, a wider basin, or resolution {say(max(gap) / 2, 'm')}"
                if max(gap) > 0.1 * min(grid.cell)
                else "a smaller object, or a wider basin",
            )
        )
    return problems


ROUNDING = 1e-6
"""Cells that a sum over cells may miss."""


def _open_cells(liquid: Liquid, models: Sequence[Model], volume: np.ndarray, grid: Grid, wanted: int) -> float:
    """Cells of liquid that find room at the start, in the part to fill and below the level [-].

    Where there is more than is wanted in any case, by volumes alone: all of a solid counts that is near the part to fill, and
    twice in an automaton, whose cells are solid from half of one on.
    """
    low, high = liquid.fill or (liquid.low, liquid.high)
    top = high[2] if liquid.level is None else min(high[2], liquid.level)
    box = (low, (high[0], high[1], top))
    near = [tuple(edge + sign * 2.0 * max(grid.cell) for edge in side) for side, sign in zip(box, (-1.0, 1.0))]
    solid = volume @ _within(models, *near) / grid.cell_volume
    plenty = grid.cells_within(*box) - (1 if liquid.model is LiquidModel.WAVES else 2) * solid
    return plenty if plenty > wanted else room(grid, models, liquid.model, low, high, liquid.level)


def _too_full(scene: SceneRecord, models: Sequence[Model], grid: Grid, lifts: bool) -> list[Problem]:
    """Liquid without room at the start, and bodies without room when they sink in."""
    liquid, cell = scene.liquid, grid.cell_volume
    volume = np.array([shapes.volume(s.shape) for s in scene.solids])
    low, high = liquid.fill or (liquid.low, liquid.high)
    if liquid.volume is not None:
        poured, amount = liquid.volume, say(liquid.volume, "m^3", 4)
    else:
        top = (high[0], high[1], min(high[2], liquid.level))
        poured = math.prod(b - a for a, b in zip(low, top)) - volume @ _within(models, low, top)
        amount = f"a level of {say(liquid.level, 'm', 4)}"
    place = liquid.spans.get("volume" if liquid.volume is not None else "level")
    wanted = 1 if liquid.volume is None else grid.units(liquid.volume)
    open_cells = _open_cells(liquid, models, volume, grid, wanted)
    if open_cells < wanted - ROUNDING:
        where = "the basin" if liquid.fill is None else "the part that is filled"
        return [
            Problem(
                place,
                f"{amount} of liquid: {where} has room for {say(open_cells * cell, 'm^3', 4)} beside what stands in it at the "
                "start",
                "less liquid, a larger basin, or objects that start above it",
            )
        ]

    standing = np.array([bool(m.held.any()) for m in models], bool)
    within = _within(models, liquid.low, liquid.high)
    free = grid.cells * cell - poured - pooled(liquid) - (volume * within)[standing].sum()
    sinks = np.where(standing, 0.0, volume * [_sunk(s, v, liquid) if lifts else 1.0 for s, v in zip(scene.solids, volume)])
    too_big = [
        Problem(
            solid.spans.get("shape") or solid.spans.get("object"),
            f"{solid.name} displaces up to {say(sunk, 'm^3', 4)} of liquid, and the basin has room for "
            f"{say(max(0.0, free), 'm^3', 4)} more",
            "a smaller object, less liquid, or a higher basin",
        )
        for solid, sunk in zip(scene.solids, sinks)
        if sunk > max(0.0, free)
    ]
    if not too_big and sinks.sum() > free:
        return [
            Problem(
                place,
                f"the objects together displace up to {say(sinks.sum(), 'm^3', 4)} of liquid, and the basin has room "
                f"for {say(free, 'm^3', 4)} more",
                "fewer objects, less liquid, or a higher basin",
            )
        ]
    return too_big


HOLLOW = 0.2
"""Room that a body encloses, over its own volume, above which the body counts as a hull."""


def open_hulls(scene: SceneRecord, models: Sequence[Model]) -> list[Problem]:
    """Warn of bodies that enclose air, because model surface ignores that air."""
    if scene.liquid.model is not LiquidModel.SURFACE:
        return []
    return [
        Problem(
            solid.spans.get("shape") or solid.spans.get("object"),
            f"{solid.name} is open and hollow: model surface lifts it by its material alone, not by the air in it",
            f"leave model surface out of liquid {scene.liquid.name}: in waves, the default, hulls float dry",
            severity="warning",
        )
        for solid, model in zip(scene.solids, models)
        if isinstance(solid.shape, Mesh) and not model.held.all() and enclosed(solid, model) > HOLLOW
    ]


TIGHT = 2.0
"""Thickness in cells from which a held wall of any attitude, and a hull, holds a liquid with momentum: some cell of each of its
columns is shut. A thinner hull may have planks of one lattice cell."""
STANDING, LAID = 1.0, 0.9
"""The same of held walls that stand upright, however they are turned about the vertical, and of those that lie."""
ESTIMATE = 0.99
"""Part of it that will do: the thickness of a mesh is an estimate."""
UPRIGHT = 1e-3
"""Cosine of the angle between the thin direction of a wall and the vertical, up to which the wall counts as upright."""
LYING = 0.76
"""The same from which it counts as lying: columns are cut where it passes."""


def leaky_walls(scene: SceneRecord, models: Sequence[Model], grid: Grid) -> list[Problem]:
    """Warn of walls, and of hulls, that are too thin for a liquid with momentum to stay on one side of them.

    Held walls that stand or lie hold it from one cell on, those that lean from two. What is thin in two directions has no sides.
    """
    liquid = scene.liquid
    if liquid.model is not LiquidModel.WAVES:
        return []
    cell = max(grid.cell)
    thin: dict[tuple, list[str]] = {}  # objects of a repeat are one problem
    for solid, model in zip(scene.solids, models):
        t, still = shapes.thickness(solid.shape), model.still
        enough = _enough(solid, TIGHT * cell, still) * cell
        if t < ESTIMATE * enough and not (still and _misses(model, grid)):
            thin.setdefault((solid.spans.get("shape") or solid.spans.get("object"), t, enough), []).append(solid.name)
    return [
        Problem(
            span,
            f"{names[0]}{f' and {len(names) - 1} more' if names[1:] else ''}: {say(t, 'm')} thick, {number(t / cell)} cells of "
            f"{liquid.name}, which leaks through what {_leaks(enough / cell)}",
            f"write resolution {say(0.9 * t * cell / enough, 'm')} in control, or make it {say(at_least(enough), 'm')} thick",
            severity="warning",
        )
        for (span, t, enough), names in thin.items()
    ]


def _leaks(cells: float) -> str:
    return f"leans and is thinner than {number(cells)} cells" if cells > 1.0 else "is thinner than a cell"


def _enough(solid: Solid, wide: float, still: bool) -> float:
    """Thickness from which a solid parts the liquid [cells]; 0 for a solid that is not a held wall at least ``wide`` [m] in two
    directions.

    A mesh may be a hull.
    """
    if isinstance(solid.shape, Mesh | Torus):
        return TIGHT if isinstance(solid.shape, Mesh) else 0.0
    low, high = shapes.extent(solid.shape)
    upward = abs(solid.rotation[2][int(np.argmin(high - low))])
    if not still or np.sort(high - low)[1] < wide:
        return 0.0
    if UPRIGHT < upward < LYING:
        return TIGHT
    return STANDING if upward <= UPRIGHT else LAID


def _misses(model: Model, grid: Grid) -> bool:
    """Whether a solid is outside of the basin."""
    return bool(((model.position.max(axis=0) <= grid.low) | (model.position.min(axis=0) >= grid.high)).any())


def enclosed(solid: Solid, model: Model) -> float:
    """Room in a body that would hold liquid poured in from above, its +z axis up, over the body's own volume [-].

    Empty cells of its lattice without a path to the outside in their layer or below: layer by layer from the bottom.
    """
    from scipy.ndimage import label

    body = (model.position - solid.position) @ np.array(solid.rotation)
    corner = body[model.hexahedron[:, 0]]
    at = np.rint((corner - corner.min(axis=0)) / model.cell).astype(int)
    filled = np.zeros(at.max(axis=0) + 3, bool)
    filled[tuple((at + 1).T)] = True
    holds, below = 0, np.zeros(filled.shape[:2], bool)  # cells of the layer below that keep liquid in
    for layer in np.moveaxis(filled, 2, 0)[1:-1]:
        region, _ = label(~layer)
        leaks = np.unique(np.concatenate([region[~layer & ~below & (region != region[0, 0])], [region[0, 0]]]))
        kept = ~layer & ~np.isin(region, leaks)
        holds += int(kept.sum())
        below = layer | kept
    return holds / len(at)


def _within(models: Sequence[Model], low: Vector, high: Vector) -> np.ndarray:
    """Part of each solid that starts in a box [m], by the centres of its lattice cells [-], shape (M,)."""
    parts = np.zeros(len(models))
    for k, model in enumerate(models):
        corner = model.hexahedron
        centre = (model.position[corner[:, 0]] + model.position[corner[:, 6]]) / 2
        parts[k] = ((centre > low) & (centre < high)).all(axis=1).mean()
    return parts


def _sunk(solid: Solid, volume: float, liquid: Liquid) -> float:
    """Part of a free solid that is below the surface at rest [-]: Archimedes."""
    if liquid.model is LiquidModel.PAPER:
        return 1.0
    density = solid.density if solid.density is not None else solid.mass / volume
    return min(1.0, density / liquid.density)
