# SPDX-License-Identifier: GPL-2.0-only
"""Quantities of a liquid, and of objects in it, that ``expect`` can ask for."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ...effects.measured import Glance, Mean, Measurable, Measured, Of, Recorded
from ...errors import Problem
from ...model.grid import Grid
from ...scene.scene import SceneRecord
from .kept import HEIGHT, WAY
from .ledger import CELLS, CREST, DUE, WAVES


def residual(m: Measured, of: Of) -> np.ndarray:
    """Cells more or fewer than there should be."""
    cells = m.ledger(CELLS)
    return cells - (m.ledger(DUE) if m.scene.liquid.fed else cells[0])


def height(m: Measured, of: Of) -> np.ndarray:
    """Height of the smooth surface at a place [m], linear between the middles of columns; in a basin that moves the place goes
    along."""
    return np.array([height_at(of.argument, m.grid, m.trajectory.liquid_height(k)) for k in range(len(m.times))])


def height_at(place: tuple[float, float], grid: Grid, heights: np.ndarray) -> float:
    """Height z of a surface at (x, y), bilinear between the middles of columns [m], from heights of shape (ny, nx)."""
    (i, s), (j, t) = (
        _between((x - low) / cell - 0.5, count) for x, low, cell, count in zip(place, grid.low, grid.cell, grid.shape)
    )
    corners = heights[np.ix_([j, min(j + 1, grid.shape[1] - 1)], [i, min(i + 1, grid.shape[0] - 1)])].astype(float)
    return float(np.array([1 - t, t]) @ corners @ np.array([1 - s, s]))


def _between(x: float, count: int) -> tuple[int, float]:
    """The column before a place, and how far the place is on the way to the next one; the outermost middles go on to the edge."""
    x = min(max(x, 0.0), count - 1.0)
    return int(x), x - int(x)


def _feeds(scene: SceneRecord, axis: int) -> list[tuple[float, float]]:
    """Parts of an axis where liquid comes or goes [m]."""
    return [(one.low[axis], one.high[axis]) for one in (*scene.liquid.inflow, *scene.liquid.drain)]


def _beyond(scene: SceneRecord, axis: int, place: float) -> float | None:
    """1 where nothing comes or goes beyond a plane, -1 where nothing does before it, None where it does on both sides."""
    feeds = _feeds(scene, axis)
    if all(high <= place for _, high in feeds):
        return 1.0
    return -1.0 if all(low >= place for low, _ in feeds) else None


def flow(m: Measured, of: Of, axis: int) -> np.ndarray:
    """Flow through a plane [m^3/s], shape (F,): what is on the side to which nothing else comes gets more by it, or less.

    The smooth surface encloses about a per cent more or less than the cells hold, so its volumes are scaled to these. A body
    that goes through the plane takes its displacement along. Volumes of a fast flow alternate from frame to frame around the
    true ones: a flow is that of its frame with half of that of the frames beside it, by which no liquid comes or goes."""
    side, grid = _beyond(m.scene, axis, of.argument), m.grid
    edges = grid.low[axis] + grid.cell[axis] * np.arange(grid.shape[axis] + 1)
    share = np.clip((edges[1:] - of.argument) / grid.cell[axis], 0.0, 1.0)
    share = share if side == 1.0 else 1.0 - share
    area = grid.cell[0] * grid.cell[1]
    lines = np.array(
        [(m.trajectory.liquid_height(k) - grid.low[2]).sum(axis=axis, dtype=np.float64) for k in range(len(m.times))]
    )
    total, held = area * lines.sum(axis=1), m.ledger(CELLS) * grid.cell_volume
    volume = area * (lines @ share) * (total[0] + held - held[0]) / total
    rate = np.pad(side * np.diff(volume) / np.diff(m.times), 1, mode="edge")
    return np.append(np.nan, 0.25 * rate[:-2] + 0.5 * rate[1:-1] + 0.25 * rate[2:])


def unmeasured(scene: SceneRecord, asked: Iterable[Of]) -> list[Problem]:
    """A problem for each flow that heights do not tell."""
    found = []
    for of in (of for of in asked if of.quantity.startswith("flow.")):
        cause = f"{of.what} is found from the liquid on one side of the plane"
        if scene.liquid.wave or scene.liquid.current:
            found.append(Problem(of.span, f"{cause}, and waves or a current come to both", "ask for liquid.height at two places"))
        elif _beyond(scene, "xy".index(of.quantity[-1]), of.argument) is None:
            found.append(
                Problem(of.span, f"{cause}, and liquid comes or goes on both", "put the plane to one side of all of these")
            )
    return found


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
    """How deep the lowest point of an object is below the surface [m], however deep the object lies; 0 of what is dry.

    The surface is the mean over the columns that the object's upright bounding box touches; the smooth height
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
    return max(0.0, level - float(low[2]))


def _draft(g: Glance) -> float:
    return immersed_depth(g.model.surface.vertices(g.own) - _way(g), g.context.grid, _height(g))


def _immersed(g: Glance) -> float:
    return immersed_share(g.own[g.model.hexahedron] - _way(g), g.context.grid, _height(g))


def _way(g: Glance) -> np.ndarray:
    """Displacement of the basin [m], shape (3,)."""
    return g.fields[WAY.name][0] if WAY.name in g.fields else np.zeros(3)


def _height(g: Glance) -> np.ndarray:
    """Smooth height z over each column [m], shape (ny, nx): out of reach that of a liquid that is nowhere."""
    grid = g.context.grid
    return g.fields[HEIGHT.name] if HEIGHT.name in g.fields else np.full(grid.shape[1::-1], grid.low[2])


MEASURES = {
    ("liquid", "height"): Measurable(height),
    **{("liquid", f"flow.{letter}"): Mean(lambda m, of, axis=axis: flow(m, of, axis)) for axis, letter in enumerate("xy")},
    ("liquid", "residual"): Measurable(residual, Measured.largest),
    ("liquid", "volume"): Measurable(lambda m, of: m.ledger(CELLS) * m.grid.cell_volume),
    ("liquid", "level"): Measurable(lambda m, of: np.asarray(m.trajectory.liquid_levels)),
    ("liquid", "crest"): Measurable(lambda m, of: m.ledger(CREST), Measured.highest),
    ("liquid", "waves"): Measurable(lambda m, of: m.ledger(WAVES)),
    ("NAME", "draft"): Recorded("draft", _draft),
    ("NAME", "immersed"): Recorded("immersed", _immersed),
}
