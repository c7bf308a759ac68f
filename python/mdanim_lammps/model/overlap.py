# SPDX-License-Identifier: GPL-2.0-only
"""Objects that start inside each other, below the ground or outside the walls."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Iterator, Sequence
from typing import Protocol

import numpy as np

from ..errors import Problem
from ..scene.formatting import say, whole
from ..scene.scene import Mesh, PieceShape, SceneRecord, Solid
from . import mesh, shapes
from .boxes import box_pairs
from .convex import bounds, depth_by_supports, overlap, placed, support
from .model import Model
from .planes import Plane

HAIR = 1e-6
"""Part of a spacing that two touching objects may seem to overlap by round-off."""
MOST_PAIRS = 1000
"""Pairs in each other after which no more are looked at: a ball in a ball takes 2 ms."""
BORN_AT_REST = 0.25
"""Part of a spacing by which surfaces may start below each other without stress, where contact is at the surfaces: what starts
so deep is where contact begins. The law takes twice as much."""

RIGID_AT_REST = 1e-3
"""Part of the thinnest part of a rigid object by which it may start in something: coordinates of a few digits. A start so deep
holds less than what bears a load at rest, and does not show."""


class Contact(Protocol):
    """Contact of solids at the start, effects.Effect."""

    rests_inside: float

    def clearance(self, first: Model, second: Model) -> float:
        """Gap between the boxes of two solids from which it has no energy [m]."""


class Features(Protocol):
    """Contact by features, engine.overlaps.Overlaps."""

    def known(self, i: int, j: int) -> bool:
        """Whether two objects touch each other so."""

    def depths(self, pairs: np.ndarray, moved: np.ndarray) -> np.ndarray:
        """Depth of each pair [m], shape (K,), when the second one is moved by these vectors [m], shape (K, 3)."""


def check_geometry(
    scene: SceneRecord,
    models: tuple[Model, ...],
    planes: Iterable[Plane] = (),
    contact: Contact | None = None,
    passing: Container[tuple[int, int]] = (),
    features: Features | None = None,
) -> list[Problem]:
    """Find every object that starts in another one, below the ground, or outside walls or basin.

    ``planes`` push objects back, ``contact`` keeps them apart. Each problem stands at the position of the (second) object and
    tells how deep it is in and which move frees it, so far that contact holds no energy afterwards. ``features`` is asked of
    rigid objects that are neither cuboids, balls nor polyhedra. Objects that are held
    entirely may overlap each other and extend beyond the walls: such objects are the scene's architecture. Others may overlap by
    ``contact.rests_inside``, and those of the pairs i < j in ``passing`` as they like. Pairs after the first MOST_PAIRS in each
    other are not looked at.
    """
    problems = []
    if not models:
        return problems
    planes = tuple(planes)
    bodies = _BoundingBoxes(models, scene.solids, [m.surface.vertices(m.position) for m in models], contact, features)
    problems += _outside(scene, bodies, planes)
    first, second = _candidates(scene, bodies)
    apart = np.array([not _are_glued(scene.solids[i], scene.solids[j]) for i, j in zip(first, second)], bool)
    first, second = first[apart], second[apart]
    bodies.find_features(first, second, passing)
    inside = 0
    for looked, (i, j) in enumerate(zip(first, second), 1):
        found = None if (int(i), int(j)) in passing else _pair(scene, bodies, planes, int(i), int(j))
        if found is not None:
            problems.append(found)
            inside += 1
        if inside == MOST_PAIRS and looked < len(first):
            left = f"{whole(len(first) - looked)} more pairs of objects are close and were not looked at"
            return [*problems, Problem(None, left, "fix these first")]
    return problems


def _are_glued(one: Solid, other: Solid) -> bool:
    """Whether two solids are pieces of one object, which share faces."""
    a, b = one.shape, other.shape
    return isinstance(a, PieceShape) and isinstance(b, PieceShape) and a.whole is b.whole


class _BoundingBoxes:
    """Bounding boxes of all objects: low, high [m], shape (n, 3), from the true surfaces."""

    def __init__(self, models, solids, vertices, contact: Contact | None, features: Features | None):
        self.models, self.solids, self.contact, self.features = models, solids, contact, features
        self.felt: dict[tuple[int, int], float] = {}
        """Depths by features of the pairs that have them [m]."""
        self.vertices = vertices
        self.low = np.array([v.min(axis=0) for v in vertices])
        self.high = np.array([v.max(axis=0) for v in vertices])
        self.fixed = np.array([m.still for m in models])
        self.bare = np.array([m.frame.bare for m in models])
        spacing = max(m.spacing for m in models)
        self.hair = HAIR * spacing
        inside = contact.rests_inside if contact else 0.0
        self.on_surfaces = contact is None or inside > 0.0
        """Whether contact acts at the surfaces, not before them."""
        self.allowed = max(inside, HAIR) * np.array([m.spacing for m in models])
        """Depth of a start in a plane that is no problem [m], shape (n,)."""
        self._exact_shapes()
        self.outer_low, self.outer_high = self.low, self.high
        if self.on_surfaces:
            return
        # Cells of a lattice may extend beyond the true surface.
        self.outer_low = np.minimum(self.low, [m.position.min(axis=0) for m in models])
        self.outer_high = np.maximum(self.high, [m.position.max(axis=0) for m in models])

    def _exact_shapes(self) -> None:
        """Take rigid objects as their shapes: the spacing of their few particles says nothing of what shows."""
        self.rigid = np.array([m.inertia is not None for m in self.models])
        self.hard = self.rigid | (self.fixed & self.rigid.any())
        self.placed = [placed(solid) if hard else None for solid, hard in zip(self.solids, self.hard.tolist())]
        """Bodies of what is rigid or never moves; None of all else, and of shapes that are not known so."""
        thin = [shapes.thickness(solid.shape) if r else np.inf for solid, r in zip(self.solids, self.rigid.tolist())]
        self.rounded = RIGID_AT_REST * np.array(thin)
        """Depth of the start of a rigid object that is no problem [m], shape (n,)."""
        self.smooth = np.array(
            [h and p is None and isinstance(s.shape, Mesh) for h, p, s in zip(self.hard, self.placed, self.solids)]
        )
        """Whether contact with an object is at smooth patches over its triangles, which are below them by their height."""
        self.in_another = self.allowed.copy()
        """Depth of a start in another object that is no problem, of two the larger one [m], shape (n,)."""
        for m in np.flatnonzero(self.rigid).tolist():
            body = self.placed[m]
            if (box := body.box() if body else bounds(self.solids[m])) is not None:
                self.low[m], self.high[m] = box
            self.allowed[m] = self.rounded[m]
        exact = self.rigid & ~self.smooth
        self.in_another[exact] = self.rounded[exact]

    def exact(self, i: int, j: int) -> Callable[[np.ndarray], float] | None:
        """The exact depth of two objects in each other, as `convex.overlap`; None where contact acts at points of surfaces."""
        first, second = self.placed[i], self.placed[j]
        if first is None or second is None or not (self.rigid[i] or self.rigid[j]):
            return None
        return overlap(first, second)

    def find_features(self, first: np.ndarray, second: np.ndarray, passing: Container[tuple[int, int]]) -> None:
        """Take the depths by features of all of some pairs that have them."""
        hard = self.hard[first] & self.hard[second] & (self.rigid[first] | self.rigid[second])
        pairs = [
            (i, j)
            for i, j in zip(first[hard].tolist(), second[hard].tolist())
            if self.features and (self.placed[i] is None or self.placed[j] is None) and (i, j) not in passing
            if self.features.known(i, j)
        ]
        if self.features and pairs:
            depths = self.features.depths(np.array(pairs), np.zeros((len(pairs), 3)))
            self.felt = dict(zip(pairs, depths.tolist()))

    def by_supports(self, i: int, j: int) -> Callable[[np.ndarray], float] | None:
        """The same of two convex objects that touch by features, of which one is round."""
        if (i, j) not in self.felt:
            return None
        first, second = support(self.solids[i]), support(self.solids[j])
        if first is None or second is None:
            return None
        return lambda moved: depth_by_supports(first, lambda n: second(n) + moved)

    def with_features(self, i: int, j: int, others: Callable[[np.ndarray], float]) -> Callable[[np.ndarray], float]:
        """Another depth of two objects, and that by features where it is 0."""

        def deepest(moved: np.ndarray) -> float:
            assert self.features is not None
            return others(moved) or float(self.features.depths(np.array([(i, j)]), moved[None])[0])

        return deepest

    def forgiven(self, i: int, j: int) -> float:
        """Depth of the start of two objects in each other that is no problem [m]: by their shapes where none is elastic."""
        exact = self.hard & ~self.smooth
        if exact[i] and exact[j] and (self.rigid[i] or self.rigid[j]):
            return float(min(self.rounded[i], self.rounded[j]))
        return float(max(self.in_another[i], self.in_another[j]))

    def clearance(self, i: int, j: int) -> float:
        """Gap between the boxes of two bodies at which contact has no energy [m]."""
        return self.contact.clearance(self.models[i], self.models[j]) if self.contact else 0.0

    def resolved(self, i: int) -> int:
        """Cells of one body, as it is resolved."""
        model = self.models[i]
        if not len(model.hexahedron):
            return int(model.frame.cells.filled.sum())
        one = len(model.hexahedron) == 1
        cells = model.frame.cells
        return int(np.rint(cells.count * cells.edge / model.cell).prod()) if one else len(model.hexahedron)

    def cells(self, i: int) -> np.ndarray:
        """Centres of the cells of one body [m], shape (C, 3), as it is resolved."""
        model = self.models[i]
        if model.frame.bare:
            return model.position
        if len(model.hexahedron) == 1:
            cells, corner = model.frame.cells, model.position[model.hexahedron[0, [0, 1, 3, 4]]]
            size = cells.count * cells.edge
            parts = [(np.arange(n) + 0.5) / n for n in np.rint(size / model.cell).astype(int)]
            t = np.stack(np.meshgrid(*parts, indexing="ij"), axis=-1).reshape(-1, 3)
            t = t[shapes.contains(model.frame.shape, cells.low + t * size)]
            return corner[0] + t @ (corner[1:] - corner[0])
        if not len(model.hexahedron):  # cells as large as the shape is thick may have their centres outside
            cells, solid = model.frame.cells, self.solids[i]
            centre = cells.low + (np.stack(np.nonzero(cells.filled)[::-1], axis=1) + 0.5) * cells.edge
            return centre[shapes.contains(model.frame.shape, centre)] @ np.array(solid.rotation).T + solid.position
        return (model.position[model.hexahedron[:, 0]] + model.position[model.hexahedron[:, 6]]) / 2


# --- ground, walls, basin -----------------------------------------------------------------------------------

_MOVES = {(0, 1): "to +x", (0, -1): "to -x", (1, 1): "to +y", (1, -1): "to -y", (2, 1): "up", (2, -1): "down"}


def _rooms(planes: Iterable[Plane]) -> Iterator[tuple[str, int, float]]:
    """Rooms with a wall on both sides along x or y: name, axis, and width along it [m]."""
    sides = {(p.room, p.axis, p.sign): p.at for p in planes if p.room}
    for (room, axis, sign), at in sides.items():
        if sign > 0 and axis < 2 and (room, axis, -1) in sides:
            yield room, axis, sides[room, axis, -1] - at


def _outside(scene: SceneRecord, bodies: _BoundingBoxes, planes: tuple[Plane, ...]) -> list[Problem]:
    problems = []
    too_wide = np.zeros((len(bodies.models), 3), bool)  # no move helps along these axes
    for room, axis, width in _rooms(planes):
        size = (bodies.high - bodies.low)[:, axis]
        for i in np.flatnonzero((size > width + bodies.hair) & ~bodies.fixed).tolist():
            solid, too_wide[i, axis] = scene.solids[i], True
            problems.append(
                Problem(
                    solid.spans.get("shape") or _span(solid),
                    f"{solid.name} is {say(size[i], 'm')} wide along {'xyz'[axis]}, {room} is only {say(width, 'm')}",
                    "make it smaller (is a unit missing?), or the room larger",
                )
            )
    for limit in planes:
        edge = bodies.low if limit.sign > 0 else bodies.high
        out = limit.sign * (limit.at - edge[:, limit.axis])
        outer = bodies.outer_low if limit.sign > 0 else bodies.outer_high
        step = limit.sign * (limit.at - outer[:, limit.axis])
        deeper = np.flatnonzero((out > bodies.allowed) & ~bodies.fixed & ~too_wide[:, limit.axis])
        for i, more in _whole_ones(scene.solids, deeper, out):
            solid = scene.solids[i]
            problems.append(
                Problem(
                    _span(solid),
                    f"{solid.name} is {say(out[i], 'm')} {limit.beyond}{more}",
                    f"move it {_MOVES[limit.axis, limit.sign]} by {say(_enough(step[i]), 'm')}",
                )
            )
    return problems


def _whole_ones(solids: Sequence[Solid], found: np.ndarray, out: np.ndarray) -> Iterator[tuple[int, str]]:
    """Some solids, by number and ascending, of the pieces of one object the farthest out alone, and words for the others."""
    pieces: dict[int, list[int]] = {}
    for i in found.tolist():
        shape = solids[i].shape
        pieces.setdefault(id(shape.whole) if isinstance(shape, PieceShape) else -i, []).append(i)
    for several in pieces.values():
        farthest = max(several, key=lambda i: (out[i], -i))
        others = len(several) - 1
        yield farthest, f", and {whole(others)} more of its pieces {'are' if others > 1 else 'is'}" if others else ""


# --- pairs --------------------------------------------------------------------------------------------------


def _candidates(scene: SceneRecord, bodies: _BoundingBoxes) -> tuple[np.ndarray, np.ndarray]:
    """Pairs i < j whose bounding boxes overlap and whose bounding balls do."""
    centre = np.array([s.position for s in scene.solids])
    radius = np.array([np.linalg.norm(v - c, axis=1).max() for v, c in zip(bodies.vertices, centre)])
    found = [np.zeros((2, 0), np.intp)]
    for i, j in box_pairs(bodies.low + bodies.hair, bodies.high):
        near = ~(bodies.fixed[i] & bodies.fixed[j]) & ~(bodies.bare[i] & bodies.bare[j])
        near &= np.linalg.norm(centre[i] - centre[j], axis=1) < radius[i] + radius[j]
        found.append(np.sort([i[near], j[near]], axis=0))
    i, j = np.concatenate(found, axis=1)
    by_scene = np.lexsort((j, i))
    return i[by_scene], j[by_scene]


def _pair(scene: SceneRecord, bodies: _BoundingBoxes, planes: tuple[Plane, ...], i: int, j: int) -> Problem | None:
    first, second = scene.solids[i], scene.solids[j]
    deepest = bodies.exact(i, j) or _at_points(scene, bodies, i, j)
    depth, by_features = deepest(np.zeros(3)), bodies.felt.get((i, j), 0.0)
    if not (too_deep := depth > bodies.forgiven(i, j)) and by_features <= min(bodies.rounded[i], bodies.rounded[j]):
        return None
    if (sure := bodies.by_supports(i, j)) is not None:
        deepest, depth = sure, sure(np.zeros(3))
        if depth <= bodies.forgiven(i, j):
            return None
    elif (i, j) in bodies.felt:  # triangles may be below the smooth surface
        deepest, depth = bodies.with_features(i, j, deepest), max(by_features, depth if too_deep else 0.0)
    axis, sign, step = _way_out(planes, bodies, i, j, deepest)
    return Problem(
        _span(second),
        f"{second.name} starts inside {first.name}, about {say(depth, 'm')} deep",
        f"move it {_MOVES[axis, sign]} by {say(_enough(step), 'm')}",
    )


def _at_points(scene: SceneRecord, bodies: _BoundingBoxes, i: int, j: int) -> Callable[[np.ndarray], float]:
    """Largest depth [m] of points of one of two objects in the other one when j is moved by a vector [m]."""
    first, second = scene.solids[i], scene.solids[j]
    # Vertices of the true surfaces find most overlaps; two bars that cross share no vertex but the centres of
    # cells. The cells of the smaller body are enough, so the cells of a large floor are not searched for
    # every pebble.
    small = i if bodies.resolved(i) <= bodies.resolved(j) else j
    of_first, of_second = (
        np.concatenate([bodies.vertices[m], bodies.cells(m)]) if m == small else bodies.vertices[m] for m in (i, j)
    )

    def deepest(moved: np.ndarray) -> float:
        return max(_deepest(of_second + moved, bodies, i, first), _deepest(of_first - moved, bodies, j, second))

    return deepest


def _deepest(points: np.ndarray, bodies: _BoundingBoxes, host: int, solid: Solid) -> float:
    """Largest depth of points [m], shape (N, 3), in an object [m]; 0 where all are outside."""
    points = points[((points > bodies.low[host]) & (points < bodies.high[host])).all(axis=1)]
    points, shape = (points - solid.position) @ np.array(solid.rotation), solid.shape
    if not len(points) or not len(points := points[shapes.contains(shape, points)]):
        return 0.0
    return float((mesh.away(mesh.load(shape), points) if isinstance(shape, Mesh) else shapes.depth(shape, points)).max())


def _way_out(
    planes: tuple[Plane, ...], bodies: _BoundingBoxes, i: int, j: int, deepest: Callable[[np.ndarray], float]
) -> tuple[int, int, float]:
    """Axis, sign and step [m] of a move of object j after which contact has no energy, the shortest between the planes.

    A step that parts the boxes always does. Where contact acts at the surfaces, which may touch where boxes overlap, it is
    shortened, that of another axis only where what is shorter frees the object too: five looks more for each pair.
    """
    gap = bodies.clearance(i, j)

    def boxed(axis: int, sign: int) -> float:
        ahead, behind = (bodies.outer_high, bodies.outer_low)[::sign]
        return sign * (ahead[i, axis] - behind[j, axis]) + gap

    def blocked(axis: int, sign: int, step: float) -> bool:
        arrival = (bodies.outer_high if sign > 0 else bodies.outer_low)[j, axis] + sign * step
        return any(p.axis == axis and p.sign == -sign and sign * (arrival - p.at) > bodies.hair for p in planes)

    ways = sorted((blocked(*way, step), step, *way) for way in _MOVES for step in [boxed(*way)])
    stuck, best, axis, sign = ways[0]
    if not bodies.on_surfaces:
        return axis, sign, best
    best = _shortened(deepest, axis, sign, best)
    for _, step, *way in ways[1:]:
        shorter = step if stuck else min(step, (1.0 - _STEP_ERROR) * best)
        if not blocked(*way, shorter) and deepest(shorter * way[1] * np.eye(3)[way[0]]) == 0.0:
            stuck, (axis, sign), best = False, way, _shortened(deepest, *way, shorter)
    return axis, sign, best


_STEP_ERROR = 0.02
"""Error of a step out of an object, over its length."""


def _shortened(deepest: Callable[[np.ndarray], float], axis: int, sign: int, step: float) -> float:
    """The shortest step that frees an object along an axis, within its error, of one that does [m]."""
    way, short = sign * np.eye(3)[axis], 0.0
    while step - short > _STEP_ERROR * step:
        middle = 0.5 * (short + step)
        short, step = (short, middle) if deepest(middle * way) == 0.0 else (middle, step)
    return step


def _enough(step: float) -> float:
    """The step rounded up to two digits, so that the step in the message is sufficient."""
    digit = 10.0 ** (np.floor(np.log10(step)) - 1)
    return float(np.ceil(round(step / digit, 6)) * digit)


def _span(solid: Solid):
    return solid.spans.get("position") or solid.spans.get("object")
