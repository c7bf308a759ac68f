# SPDX-License-Identifier: GPL-2.0-only
"""Objects that start inside each other, below the ground or outside the walls."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import Problem
from ..scene.scene import Scene, Solid
from ..scene.wording import say
from . import shapes
from .model import Model

HAIR = 1e-6
"""Part of a spacing that two touching objects may seem to overlap by round-off."""


def check_geometry(scene: Scene, models: tuple[Model, ...]) -> list[Problem]:
    """Find every object that starts in another one, below the ground, or outside walls or basin.

    Each problem stands at the position of the (second) object and tells how deep it is in and which move
    frees it. Objects that are held entirely may overlap each other and stick out: they are the scene's
    architecture.
    """
    problems = []
    if not models:
        return problems
    bodies = _Bodies(models, [m.surface.vertices(m.position) for m in models])
    problems += _outside(scene, bodies)
    for i, j in zip(*_candidates(scene, bodies)):
        found = _pair(scene, bodies, int(i), int(j))
        if found is not None:
            problems.append(found)
    return problems


class _Bodies:
    """Bounding boxes of all objects: low, high [m], shape (n, 3), from the true surfaces."""

    def __init__(self, models, vertices):
        self.models = models
        self.vertices = vertices
        self.low = np.array([v.min(axis=0) for v in vertices])
        self.high = np.array([v.max(axis=0) for v in vertices])
        self.fixed = np.array([bool(m.held.all()) for m in models])
        self.hair = HAIR * max(m.spacing for m in models)

    def cells(self, i: int) -> np.ndarray:
        """Centres of the cells of one body [m], shape (C, 3)."""
        model = self.models[i]
        return (model.position[model.hexahedron[:, 0]] + model.position[model.hexahedron[:, 6]]) / 2


# --- ground, walls, basin -----------------------------------------------------------------------------------

_MOVES = {(0, 1): "to +x", (0, -1): "to -x", (1, 1): "to +y", (1, -1): "to -y", (2, 1): "up", (2, -1): "down"}


@dataclass(frozen=True, slots=True)
class _Limit:
    """A plane that objects stay above (sign +1) or below (sign -1) along one axis."""

    axis: int
    sign: int
    at: float
    what: str


def _limits(scene: Scene) -> list[_Limit]:
    limits = []
    if scene.ground is not None:
        limits.append(_Limit(2, 1, scene.ground, "below the ground"))
    if scene.walls is not None:
        for axis in range(3):
            limits.append(_Limit(axis, 1, scene.walls.low[axis], f"outside the walls at -{'xyz'[axis]}"))
            limits.append(_Limit(axis, -1, scene.walls.high[axis], f"outside the walls at +{'xyz'[axis]}"))
    if scene.liquid is not None:
        for axis in range(2):
            limits.append(_Limit(axis, 1, scene.liquid.low[axis], f"outside the basin at -{'xyz'[axis]}"))
            limits.append(_Limit(axis, -1, scene.liquid.high[axis], f"outside the basin at +{'xyz'[axis]}"))
        limits.append(_Limit(2, 1, scene.liquid.low[2], "below the floor of the basin"))
    return limits


def _rooms(scene: Scene) -> list[tuple[str, tuple, tuple]]:
    """What has a wall on both sides along x and y: its name, lower and upper corner [m]."""
    rooms = [("the space between the walls is", scene.walls)] if scene.walls is not None else []
    rooms += [("the basin is", scene.liquid)] if scene.liquid is not None else []
    return [(what, box.low, box.high) for what, box in rooms]


def _outside(scene: Scene, bodies: _Bodies) -> list[Problem]:
    problems = []
    too_wide = np.zeros((len(bodies.models), 3), bool)  # no move helps along these axes
    for what, low, high in _rooms(scene):
        room = np.subtract(high, low)[:2]
        size = (bodies.high - bodies.low)[:, :2]
        for i, axis in zip(*np.nonzero((size > room + bodies.hair) & ~bodies.fixed[:, None])):
            solid, too_wide[i, axis] = scene.solids[i], True
            problems.append(
                Problem(
                    solid.spans.get("shape") or _span(solid),
                    f"{solid.name} is {say(size[i, axis], 'm')} wide along {'xyz'[axis]}, {what} only {say(room[axis], 'm')}",
                    "make it smaller (is a unit missing?), or the room larger",
                )
            )
    for limit in _limits(scene):
        edge = bodies.low if limit.sign > 0 else bodies.high
        out = limit.sign * (limit.at - edge[:, limit.axis])
        for i in np.flatnonzero((out > bodies.hair) & ~bodies.fixed & ~too_wide[:, limit.axis]):
            solid = scene.solids[i]
            problems.append(
                Problem(
                    _span(solid),
                    f"{solid.name} is {say(out[i], 'm')} {limit.what}",
                    f"move it {_MOVES[limit.axis, limit.sign]} by {say(_enough(out[i]), 'm')}",
                )
            )
    return problems


# --- pairs --------------------------------------------------------------------------------------------------


def _candidates(scene: Scene, bodies: _Bodies) -> tuple[np.ndarray, np.ndarray]:
    """Pairs i < j whose bounding boxes overlap and whose bounding balls do: sort and sweep along one axis."""
    low, high = bodies.low + bodies.hair, bodies.high
    centre = np.array([s.position for s in scene.solids])
    radius = np.array([np.linalg.norm(v - c, axis=1).max() for v, c in zip(bodies.vertices, centre)])
    axis = int(np.argmax(np.ptp(centre, axis=0)))
    order = np.argsort(low[:, axis], kind="stable")
    stop = np.searchsorted(low[order, axis], high[order, axis])
    found_i, found_j = [], []
    for first in range(0, len(order), 1000):
        here = np.arange(first, min(first + 1000, len(order)))
        count = np.maximum(stop[here] - here - 1, 0)
        a = np.repeat(here, count)
        b = a + 1 + np.arange(len(a)) - np.repeat(np.cumsum(count) - count, count)
        i, j = order[a], order[b]
        meet = (low[i] < high[j]).all(axis=1) & (low[j] < high[i]).all(axis=1)
        meet &= ~(bodies.fixed[i] & bodies.fixed[j])
        i, j = i[meet], j[meet]
        near = np.linalg.norm(centre[i] - centre[j], axis=1) < radius[i] + radius[j]
        found_i.append(np.minimum(i, j)[near])
        found_j.append(np.maximum(i, j)[near])
    i, j = np.concatenate(found_i), np.concatenate(found_j)
    by_scene = np.lexsort((j, i))
    return i[by_scene], j[by_scene]


def _pair(scene: Scene, bodies: _Bodies, i: int, j: int) -> Problem | None:
    first, second = scene.solids[i], scene.solids[j]
    # Vertices of the true surfaces find most overlaps; two bars that cross share no vertex but the centres of
    # cells. Those of the body with fewer cells do, and spare a large floor from being looked through for
    # every pebble.
    small, large = (i, j) if len(bodies.models[i].hexahedron) <= len(bodies.models[j].hexahedron) else (j, i)
    deepest = max(
        _deepest(bodies.vertices[i], bodies, j, second),
        _deepest(bodies.vertices[j], bodies, i, first),
        _deepest(bodies.cells(small), bodies, large, scene.solids[large]),
    )
    if deepest <= bodies.hair:
        return None
    direction, step = _way_out(scene, bodies, i, j)
    return Problem(
        _span(second),
        f"{second.name} starts inside {first.name}, about {say(deepest, 'm')} deep",
        f"move it {direction} by {say(_enough(step), 'm')}",
    )


def _deepest(points: np.ndarray, bodies: _Bodies, host: int, solid: Solid) -> float:
    """How deep the deepest of points [m], shape (N, 3), lies in an object [m]; 0 where all are outside."""
    points = points[((points > bodies.low[host]) & (points < bodies.high[host])).all(axis=1)]
    if not len(points):
        return 0.0
    points = (points - solid.position) @ np.array(solid.rotation)
    points = points[shapes.contains(solid.shape, points)]
    return float(shapes.depth(solid.shape, points).max()) if len(points) else 0.0


def _way_out(scene: Scene, bodies: _Bodies, i: int, j: int) -> tuple[str, float]:
    """Direction and step [m] of object j that part the bounding boxes; the shortest that stays inside."""
    limits = _limits(scene)
    ways = []
    for (axis, sign), name in _MOVES.items():
        ahead, behind = (bodies.high, bodies.low) if sign > 0 else (bodies.low, bodies.high)
        step = sign * (ahead[i, axis] - behind[j, axis])
        arrival = ahead[j, axis] + sign * step
        blocked = any(
            limit.axis == axis and limit.sign == -sign and sign * (arrival - limit.at) > bodies.hair for limit in limits
        )
        ways.append((blocked, step, name))
    _, step, name = min(ways)
    return name, step


def _enough(step: float) -> float:
    """The step rounded up to two digits, so that doing what the message says helps."""
    digit = 10.0 ** (np.floor(np.log10(step)) - 1)
    return float(np.ceil(round(step / digit, 6)) * digit)


def _span(solid: Solid):
    return solid.spans.get("position") or solid.spans.get("object")
