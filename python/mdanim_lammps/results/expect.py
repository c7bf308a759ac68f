# SPDX-License-Identifier: GPL-2.0-only
"""The scene's own checks: every ``expect`` line, measured after the run."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from ..model.grid import Grid
from ..model.model import Model
from ..model.system import System
from ..scene.formatting import number
from ..scene.scene import Expect
from .ledger import CREST, WAVES


@dataclass(frozen=True, slots=True)
class Outcome:
    """What an ``expect`` line asked for and what was found."""

    expect: Expect
    found: float

    @property
    def met(self) -> bool:
        # A NaN is never met; the last digit of a value read from text is forgiven.
        e = self.expect
        return abs(self.found - e.value) <= e.tolerance + 1e-12 * max(abs(e.value), e.tolerance)

    def __str__(self) -> str:
        e = self.expect
        when = "" if e.time is None else f" at {number(e.time, 6)} s"
        verdict = "met" if self.met else "MISSED"
        place = f"{e.span}: " if e.span else ""
        return (
            f"{place}expect {e.subject}.{e.quantity}{when} = {number(e.value, 6)} +- {number(e.tolerance, 6)}: "
            f"found {number(self.found, 6)}, {verdict}"
        )


@dataclass(frozen=True)
class Measured:
    """What a run has left to be measured; F frames of M solids."""

    names: tuple[str, ...]
    times: np.ndarray
    """[s], shape (F,)."""
    center: np.ndarray
    """Centres of mass [m], shape (F, M, 3)."""
    velocity: np.ndarray
    """Their velocities [m/s], shape (F, M, 3)."""
    residual: np.ndarray
    """Energy residual at each frame, shape (F,)."""
    penetration: float
    """Deepest penetration of the run [m]."""
    recorded: Mapping[tuple[str, str], np.ndarray] = field(default_factory=dict)
    """What `recorded` names, at each frame, each of shape (F,)."""
    cells: np.ndarray | None = None
    """Cells of liquid at each frame, to the unit, shape (F,); None without liquid."""
    due: np.ndarray | None = None
    """Those at the start, and what has come since; None where none does."""
    cell_volume: float = 0.0
    """[m^3]"""
    level: Callable[[], np.ndarray] | None = None
    """Gives the mean height of the liquid over the basin at each frame [m], shape (F,), for which all frames are read; None
    without liquid."""
    of_liquid: Mapping[str, np.ndarray] = field(default_factory=dict)
    """What `recorded_of_liquid` names, at each frame, each of shape (F,)."""


def evaluate(expects: tuple[Expect, ...], measured: Measured) -> list[Outcome]:
    """Measure every expectation. What needs a liquid is refused before a run that has none."""
    return [Outcome(e, _measure(e, measured)) for e in expects]


RECORDED = {"strain.max": "strain", "draft": "draft", "immersed": "immersed"}
"""Quantities of a solid that need all its particles at every frame, and what their ledger columns are called."""


OF_LIQUID = {"crest": CREST, "waves": WAVES}
"""Quantities of the liquid that frames do not hold, and their columns of the ledger."""


def recorded_of_liquid(expects: tuple[Expect, ...]) -> dict[str, str]:
    """Those that lines ask for, and their columns of the ledger, in the order of OF_LIQUID."""
    asked = {e.quantity for e in expects if e.subject == "liquid"}
    return {quantity: column for quantity, column in OF_LIQUID.items() if quantity in asked}


def recorded(expects: tuple[Expect, ...]) -> dict[tuple[str, str], str]:
    """What has to be recorded during the run: (solid, quantity) to the ledger's column, in order and once."""
    return {(e.subject, e.quantity): f"{RECORDED[e.quantity]}.{e.subject}" for e in expects if e.quantity in RECORDED}


def record(
    quantity: str, system: System, model: Model, position: np.ndarray, grid: Grid | None, height: np.ndarray | None
) -> float:
    """Measure one of RECORDED of a solid now.

    Args:
        position: of all particles [m], shape (N, 3).
        grid: cells of the liquid; None without liquid.
        height: smooth height z of the liquid over each column [m], shape (ny, nx); None without liquid.
    """
    solid = system.names.index(model.name)
    own = position[system.first[solid] : system.first[solid + 1]]
    match quantity:
        case "strain.max":
            return largest_strain(system, solid, position)
        case "draft":
            return immersed_depth(model.surface.vertices(own), grid, height)
        case "immersed":
            return immersed_share(own[model.hexahedron], grid, height)
    raise ValueError(f"{quantity} is not recorded")


def immersed_share(corners: np.ndarray, grid: Grid, height: np.ndarray) -> float:
    """Share of an object's volume that is below the liquid's surface [-], by 64 points in every lattice cell.

    They are spread evenly with no two at one height (a Kronecker sequence), so that a body that floats upright is cut
    as finely as one that is turned.

    Args:
        corners: of its lattice cells, in VTK order [m], shape (C, 8, 3).
        grid: cells of the liquid.
        height: smooth height z of the liquid over each column [m], shape (ny, nx).
    """
    u, v, w = np.modf(0.5 + np.outer(1.2207440846057596 ** -np.arange(1.0, 4.0), np.arange(64)))[0]
    weight = np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v])
    weight = np.concatenate([weight * (1 - w), weight * w])
    below = 0  # in pieces: 100 MB for a body of any size
    for start in range(0, len(corners), 4096):
        point = np.einsum("kp,ckd->cpd", weight, corners[start : start + 4096]).reshape(-1, 3)
        column = np.floor((point[:, :2] - grid.low[:2]) / grid.cell[:2]).astype(int)
        inside = ((column >= 0) & (column < grid.shape[:2])).all(axis=1)
        x, y = column[inside].T
        below += int(np.count_nonzero(point[inside, 2] < height[y, x]))
    return below / (len(corners) * len(u))


def immersed_depth(points: np.ndarray, grid: Grid, height: np.ndarray) -> float:
    """How deep an object is in the liquid: local level less its lowest point, at most its own height [m].

    The local level is the mean over the columns that the object's upright bounding box touches; the smooth height
    runs on below a body that fills its columns. An object beside the basin has a draft of 0.

    Args:
        points: of its surface, such as ``model.surface.vertices(position)`` [m], shape (n, 3).
        grid: cells of the liquid.
        height: smooth height z of the liquid over each column [m], shape (ny, nx).
    """
    low, high = points.min(axis=0), points.max(axis=0)
    columns = []
    for a, b, start, edge, count in zip(low, high, grid.low, grid.cell, grid.shape[:2]):
        first, last = int(np.floor((a - start) / edge)), int(np.floor((b - start) / edge))
        if last < 0 or first >= count:
            return 0.0
        columns.append(slice(max(first, 0), min(last, count - 1) + 1))
    across, along = columns
    level = float(np.mean(height[along, across], dtype=np.float64))
    return float(np.clip(level - low[2], 0.0, high[2] - low[2]))


def largest_strain(system: System, solid: int, position: np.ndarray) -> float:
    """Largest |r/r0 - 1| of the springs of a solid [-], for particle positions [m], shape (N, 3)."""
    low, high = np.searchsorted(system.spring[:, 0], system.first[solid : solid + 2])
    i, j = system.spring[low:high].T
    if not len(i):
        return 0.0
    r = np.linalg.norm(position[i] - position[j], axis=1)
    return float(np.abs(r / system.rest[low:high] - 1.0).max())


def _measure(expect: Expect, m: Measured) -> float:
    match expect.subject, expect.quantity:
        case "energy", "residual":
            return _largest(m, m.residual, expect.time)
        case "penetration", "max":
            return m.penetration
        case "liquid", "residual":
            return _largest(m, m.cells - (m.cells[0] if m.due is None else m.due), expect.time)
        case "liquid", "volume":
            return _at(m, m.cells, expect.time) * m.cell_volume
        case "liquid", "level":
            return _at(m, m.level(), expect.time)
        case "liquid", "crest":
            return float(_until(m, m.of_liquid["crest"], expect.time).max())
        case "liquid", quantity:
            return _at(m, m.of_liquid[quantity], expect.time)
        case name, "strain.max":
            return _largest(m, m.recorded[name, "strain.max"], expect.time)
        case name, ("draft" | "immersed") as quantity:
            return _at(m, m.recorded[name, quantity], expect.time)
        case name, quantity:
            kind, axis = quantity.split(".")
            position, velocity = _motion(m, m.names.index(name), expect.time)
            return float((position if kind == "position" else velocity)["xyz".index(axis)])


def _largest(m: Measured, values: np.ndarray, time: float | None) -> float:
    """Largest magnitude up to a time, or in the whole run."""
    return float(np.abs(_until(m, values, time)).max())


def _until(m: Measured, values: np.ndarray, time: float | None) -> np.ndarray:
    """Those of frames up to a time, or of the whole run."""
    return values if time is None else values[m.times <= time * (1 + 1e-9)]


def _at(m: Measured, values: np.ndarray, time: float | None) -> float:
    """The value at a time, straight between frames; without a time at the end."""
    return float(values[-1] if time is None else np.interp(time, m.times, values))


def _motion(m: Measured, solid: int, time: float | None) -> tuple[np.ndarray, np.ndarray]:
    """Centre of mass and its velocity; between two frames by the cubic that meets both positions and velocities."""
    x, v = m.center[:, solid], m.velocity[:, solid]
    if time is None:
        return x[-1], v[-1]
    after = min(int(np.searchsorted(m.times, time * (1 - 1e-9))), len(m.times) - 1)
    if after == 0 or abs(m.times[after] - time) <= 1e-9 * time:
        return x[after], v[after]
    before = after - 1
    dt = m.times[after] - m.times[before]
    s = (time - m.times[before]) / dt
    position = (
        (1 + 2 * s) * (1 - s) ** 2 * x[before]
        + s * (1 - s) ** 2 * dt * v[before]
        + s * s * (3 - 2 * s) * x[after]
        + s * s * (s - 1) * dt * v[after]
    )
    velocity = (
        6 * s * (1 - s) * (x[after] - x[before]) / dt + (1 - 4 * s + 3 * s * s) * v[before] + (3 * s * s - 2 * s) * v[after]
    )
    return position, velocity
