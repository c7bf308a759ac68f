# SPDX-License-Identifier: GPL-2.0-only
"""Strength of a lattice: blows, loads, thin parts."""

from __future__ import annotations

from itertools import product

import numpy as np

from ...effects.envelope import Envelope
from ...effects.margin import Margin
from ...errors import Problem
from ...model.boxes import overlaps_in_plan
from ...model.cells import TooThin, end_share, fill_cells
from ...model.shapes import LAWS, thickness
from ...model.system import System
from ...reach import by, thrower_of
from ...scene.formatting import at_least, number, say
from ...scene.scene import Box, Solid

FOLDS = 0.2
"""Speed of an impact over the wave speed above which a lattice folds up and stays crumpled (docs/physics-solids.md)."""
FOLDS_ON_END, FOLDS_POWER = 0.5, 0.45
"""The same of a ball or a cone that lands on a plane, over a power of the part of its cells that its smallest end has: these
few bear the blow of all (docs/physics-solids.md)."""
FOLDS_AT_CORNER = 0.75
"""The same of a cuboid that lands on a corner or an edge, over that power of the part of it that is within a spacing of its
lowest point."""
CRUSH = 0.2
"""Load over Young's modulus above which a lattice is crushed (docs/physics-solids.md)."""
MOST_NAMED = 4
"""Objects up to which a cure has a number for each."""
CORNERS = np.array(list(product((0.0, 1.0), repeat=3)))
"""Corners of a unit cube, shape (8, 3)."""
SIGNS = (-1.0) ** CORNERS.sum(axis=1)
"""1 for an even number of ones in a corner, else -1, shape (8,)."""
INERTIA = 0.01
"""Error of a moment of inertia that is told."""
WELL_FITTED = 4
"""Cells across with which all shapes turn as they should (docs/physics-solids.md)."""
THINNEST = 2
"""Fewest cells across: one cell is 1.9 times too stiff in bending (docs/physics-solids.md)."""


def amplitude(env: Envelope) -> Margin:
    scene, system = env.scene, env.system
    meets = len(system.names) > 1 or len(env.planes) > 0
    ratio = np.where(meets & ~system.bare, env.reach.speed / env.reach.wave, 0.0)  # 0 of what is rigid
    hard = (len(env.planes) > 0 or not env.reach.moving.all()) and env.context.grid is None  # a liquid breaks the fall
    spot = spots(env) if hard else np.full(len(ratio), np.inf)
    limit = folds_at(spot)
    m = int(np.where(_soft(env), ratio / limit, -1.0).argmax())
    folds = ratio > limit
    others = int(folds.sum()) - 1
    weak = np.flatnonzero(folds).tolist() or [m]
    enough = {system.names[o]: at_least(system.young[o] * (ratio[o] / limit[o]) ** 2) for o in weak}
    what, coarser = "a soft object folds up", ""
    if spot[m] < FOLDS:
        what = f"one of {number(env.cells[m], 2)} cells across folds up at the spot where it lands"
        h = float(np.cbrt(system.cell_volume[m]))
        if others < 1 and ratio[m] < FOLDS and (h := _coarser(env, scene.solids[m], h, float(ratio[m]))):
            coarser = f", or resolution {say(h, 'm')}"
    thrower = thrower_of(env.reach.acting, m, float(env.reach.speed[m]))
    return Margin(
        "amplitude",
        system.names[m],
        float(ratio[m]),
        float(limit[m]),
        "",
        f"{system.names[m]}{f' and {others} more' if others > 0 else ''} may hit at {say(env.reach.speed[m], 'm/s', 2)}"
        f"{by(thrower)}, {ratio[m]:.2f} of the wave speed {say(env.reach.wave[m], 'm/s', 2)}; "
        f"above about {number(limit[m], 2)} {what} and stays crumpled",
        env.place(m, "elasticity"),
        "warning" if folds[m] else "ok",
        hint=f"write elasticity {_stiffer(enough)} or more{coarser}, or a lower density, height or speed"
        + (f"; or {thrower.way_out}" if thrower else ""),
    )


def folds_at(spots: np.ndarray) -> np.ndarray:
    """Speed of a blow over the wave speed above which something folds up, shape (M,): by those of the `spots` where it lands."""
    return np.minimum(FOLDS, spots)


def strength(env: Envelope) -> list[Margin]:
    """Limits of lattices; none where no object is one and moves."""
    return [amplitude(env), *load(env), thinnest(env)] if _soft(env).any() else []


def _soft(env: Envelope) -> np.ndarray:
    """Solids that can move and deform as lattices do, bool, shape (M,)."""
    return env.reach.moving & np.isfinite(env.system.young) & ~env.system.bare


def _stiffer(enough: dict[str, float]) -> str:
    """Young's moduli [Pa] of objects in words; one for all of them where there are many."""
    if 1 < len(enough) <= MOST_NAMED:
        return ", ".join(f"{say(young, 'Pa')} for {name}" for name, young in enough.items())
    return say(max(enough.values()), "Pa") + (" for all of them" if len(enough) > 1 else "")


def spots(env: Envelope) -> np.ndarray:
    """Speed of a landing on what does not give way, over the wave speed, that folds up the spot where a solid lands, shape (M,).

    Infinite for shapes that are neither cuboids nor pointed."""
    system, known = env.system, {}
    found = np.full(len(system.names), np.inf)
    # At its drawn surface a ball is borne by more than its lowest cells.
    few = {"pointed", *["round"] * any(e.touches and not e.rests_inside for e in env.on)}
    for m in np.flatnonzero(env.reach.moving).tolist():
        solid = env.scene.solids[m]
        if isinstance(solid.shape, Box):
            found[m] = _folds_on_corner(env, solid, float(np.cbrt(system.cell_volume[m])))
        elif LAWS[type(solid.shape)].end in few:
            key = solid.shape, float(system.cell_volume[m])
            if key not in known:
                known[key] = folds_on_end(_filled(system, m, solid.rotation))
            found[m] = known[key]
    return found


def _filled(system: System, m: int, rotation: tuple) -> np.ndarray:
    """The cells of one solid in a grid, bool."""
    first = np.searchsorted(system.hexahedron[:, 0], system.first)
    middle = system.position[system.hexahedron[first[m] : first[m + 1]]].mean(axis=1) @ np.array(rotation)
    place = np.rint((middle - middle.min(axis=0)) / np.cbrt(system.cell_volume[m])).astype(int)  # voxels are cubes
    filled = np.zeros(place.max(axis=0) + 1, bool)
    filled[tuple(place.T)] = True
    return filled


def _folds_on_corner(env: Envelope, solid: Solid, h: float) -> float:
    """The same of a cuboid with this spacing [m], which lands as it is turned at the start; on a corner where it spins."""
    ways = [np.eye(3)[p.axis] for p in env.planes if p.sign * solid.velocity[p.axis] < 0.0]
    if env.reach.g > 0.0:
        ways.append(np.array([0.0, 0.0, 1.0]))
    turned = [np.ones(3) / np.sqrt(3.0)] if any(solid.spin) else [way @ np.array(solid.rotation) for way in ways]
    share = min((low_share(np.array(solid.shape.size), way, h) for way in turned), default=1.0)
    return FOLDS_AT_CORNER * share**FOLDS_POWER


def low_share(size: np.ndarray, normal: np.ndarray, depth: float) -> float:
    """Part of a cuboid with these edges [m], shape (3,), that is less than a depth [m] beyond its first point along a normal.

    The way along the normal is a sum of three evenly spread ones, so this is its distribution: a sum of cubes over all corners.
    """
    ways = np.maximum(np.abs(normal) * size, 1e-3 * depth)
    cubes = np.maximum(depth - CORNERS @ ways, 0.0) ** 3
    return min(1.0, float(SIGNS @ cubes / (6.0 * ways.prod())))


def load(env: Envelope) -> list[Margin]:
    g = env.reach.g
    if not g:
        return []
    system = env.system
    stress = _stress(env, g)
    ratio = np.where(env.reach.moving & ~system.bare, stress / (CRUSH * system.young), 0.0)
    m = int(np.where(_soft(env), ratio, -1.0).argmax())
    strength = CRUSH * system.young[m]
    return [
        Margin(
            "load",
            system.names[m],
            float(stress[m]),
            float(strength),
            "Pa",
            f"{system.names[m]} bears about {say(stress[m], 'Pa')} at its foot by its weight and by what stands above it at the "
            f"start, {ratio[m]:.2f} of its crush strength 0.2 E = {say(strength, 'Pa')} (an estimate: evenly spread, at rest)",
            env.place(m, "elasticity"),
            "warning" if ratio[m] > 1.0 else "ok",
            hint=f"write elasticity {say(at_least(system.young[m] * ratio[m] * 1.5), 'Pa')} or more, "
            "or a lower density or height",
        )
    ]


def _stress(env: Envelope, g: float) -> np.ndarray:
    """rho g H of each solid and of the part of others that stands above it, less buoyancy [Pa], shape (M,)."""
    system = env.system
    low, high = system.bounds(system.position)
    size = np.maximum(high - low, 1e-300)
    weight = system.mass_of * g * np.maximum(0.0, env.reach.weight_left)
    above = np.zeros(len(weight))
    for m, near in overlaps_in_plan(low, high, np.flatnonzero(_soft(env))):
        near = near[low[near, 2] >= high[m, 2] - 0.25 * size[m, 2]]
        wide = np.minimum(high[m, :2], high[near, :2]) - np.maximum(low[m, :2], low[near, :2])
        above[m] = (wide / size[near, :2]).prod(axis=1) @ weight[near]  # nothing of a line that hangs there
    volume = np.add.reduceat(system.volume, system.first[:-1])
    return (weight + above) * size[:, 2] / volume


def thinnest(env: Envelope) -> Margin:
    cells = np.where(_soft(env), env.cells, np.inf)
    m = int(cells.argmin())
    few = round(float(cells[m])) < THINNEST
    h = float(np.cbrt(env.system.cell_volume[m]))
    return Margin(
        "thinnest part",
        env.system.names[m],
        float(cells[m]),
        THINNEST,
        "cells",
        f"{env.system.names[m]} is {number(cells[m], 2)} cells thin; one cell is 1.9 times too stiff in bending, two are not",
        env.place(m, "shape"),
        "warning" if few else "ok",
        least=True,
        hint=f"write resolution {say(0.5 * h * cells[m], 'm')} for two cells",
    )


def turning(env: Envelope) -> list[Problem]:
    """The worst of the solids that are free to turn and whose masses could not be fitted to the moments of their shape."""
    system = env.system
    free = ~np.logical_or.reduceat(system.held, system.first[:-1])
    error = np.where(free, system.inertia_error, 0.0)
    m, others = int(error.argmax()), np.count_nonzero(error > INERTIA) - 1
    if error[m] <= INERTIA:
        return []
    cells, h = float(env.cells[m]), float(np.cbrt(system.cell_volume[m]))
    return [
        Problem(
            env.place(m, "shape"),
            f"{system.names[m]}{f' and {others} more' if others else ''}: {number(cells, 2)} cells across, "
            f"a moment of inertia is {number(100.0 * error[m], 2)} % off that of the shape",
            f"write resolution {say(h * cells / WELL_FITTED, 'm')} where its spin matters",
            severity="note",
        )
    ]


def folds_on_end(filled: np.ndarray) -> float:
    """Speed of a landing over the wave speed above which the smallest end of a body of these cells stays folded up [-]."""
    return FOLDS_ON_END * end_share(filled) ** FOLDS_POWER


def _coarser(env: Envelope, solid: Solid, h: float, ratio: float) -> float | None:
    """The next coarser spacing [m] at which a landing at this part of the wave speed folds no end;
    None below three cells across."""
    for trial in (at_least(h * 1.05**k) for k in range(1, 40)):
        try:
            if thickness(solid.shape) / trial < 3.0:
                break
            cuboid = isinstance(solid.shape, Box)
            if ratio <= (_folds_on_corner(env, solid, trial) if cuboid else folds_on_end(fill_cells(solid.shape, trial).filled)):
                return trial
        except TooThin:
            continue
    return None
