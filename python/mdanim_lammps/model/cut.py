# SPDX-License-Identifier: GPL-2.0-only
"""Shapes that are cut into pieces: Voronoi cells, or bricks, and the faces between them (docs/physics-pieces.md).

The points of the cells are chosen at random in the shape and moved to the middles of their cells a few times (Lloyd), so that no
piece is a splinter. Random numbers are those of a counter (Philox); its key is the seed of the scene and the name of the object.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

import numpy as np

from ..records import dataclass
from ..scene.formatting import number
from ..scene.limits import MOST_PIECES
from ..scene.scene import Box, Bricks, Cone, Cylinder, Ellipsoid, Mesh, PieceShape, Shape, Shell, Sphere, Torus, VoronoiCells
from . import mesh, shapes
from .mesh import MeshError, Triangles
from .orientation import outward
from .polyhedron import Polyhedron, is_clean
from .triangles import volume_and_centre

ROUNDS = 3
"""How often the points are moved to the middles of their cells."""
SAMPLES = 100
"""Places in the shape for each piece, by which the middles are found."""
NEAREST = 24
"""Other points by which a cell is cut at first."""
AROUND = 32
"""Sides of a round shape that is cut, around its axis: pieces have flat faces."""
CONVEX = 1e-6
"""Volume of the hull of a convex mesh beyond its own, over this."""
ONE_PLACE = 1.1e-6
"""Distance over the size of a piece below which two of its corners are one."""
LEAST_FACE = 3e-8
"""Area of a face over the square of the size of a piece below which its plane is left out: the piece is larger by a crumb."""


Inside = Callable[[np.ndarray], np.ndarray]
"""Tells which points [m], shape (N, 3), are inside, bool, shape (N,)."""


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """One piece of a shape."""

    surface: Triangles
    """Its ``centre`` is in the frame of the whole."""
    polyhedron: Polyhedron | None
    """None where it is not convex, or has too small faces."""
    beyond: tuple[int, ...]
    """The piece on the other side of each face of the polyhedron; below 0 for none."""


@dataclass(frozen=True, slots=True, eq=False)
class CommonFace:
    """Where two pieces were one."""

    a: int
    b: int
    """Pieces, a < b."""
    side_a: int
    side_b: int
    """Numbers of the face in their polyhedra; -1 where they have none."""
    at: np.ndarray
    """Its middle in the frame of the whole [m], shape (3,)."""
    axes: np.ndarray
    """Its normal from a to b, and the two main axes across, shape (3, 3)."""
    area: float
    """[m^2]"""
    second: tuple[float, float]
    """Second moments of area about both axes [m^4]."""
    section: tuple[float, float, float]
    """Section moduli about both axes, and about the normal [m^3]."""


@dataclass(frozen=True, slots=True, eq=False)
class Division:
    """A shape in pieces."""

    pieces: tuple[Piece, ...]
    faces: tuple[CommonFace, ...]
    alike: tuple[int, ...]
    """First piece that differs from each by its place alone."""

    @property
    def volume(self) -> float:
        """Sum over the pieces [m^3]."""
        return float(sum(p.surface.volume for p in self.pieces))


def piece(shape: PieceShape) -> Piece:
    """The piece that a shape is. Raises mesh.MeshError."""
    return division(shape.of, shape.how, shape.seed).pieces[shape.number]


def count(shape: Shape, how: VoronoiCells | Bricks, seed: str) -> int:
    """The number of pieces; of what is not convex there may be more than cells. Raises mesh.MeshError."""
    if isinstance(how, Bricks):
        return sum(len(row) - 1 for row in _rows(shape, how))
    return how.number if concave(shape) is None else len(division(shape, how, seed).pieces)


@lru_cache(maxsize=256)
def division(shape: Shape, how: VoronoiCells | Bricks, seed: str) -> Division:
    """A shape in pieces. Raises mesh.MeshError where it cannot be cut."""
    if isinstance(how, Bricks):
        return _bricks(shape, how)
    if (body := concave(shape)) is not None:
        from .cut_concave import pieces_of

        pieces, faces = pieces_of(body, how.number, seed)
        return Division(pieces, faces, tuple(range(len(pieces))))
    planes = convex_planes(shape)
    low, high = shapes.extent(shape)
    cells = voronoi(low, high, lambda some: (some @ planes[:, :3].T < planes[:, 3]).all(axis=1), planes, how.number, seed)
    pieces = tuple(_piece(corner, faces) for _, corner, faces in cells)
    return Division(pieces, tuple(_common_faces(pieces)), tuple(range(len(pieces))))


def concave(shape: Shape) -> Triangles | None:
    """The surface of a shape that is not convex; None of all others. Raises mesh.MeshError."""
    from scipy.spatial import ConvexHull

    if isinstance(shape, Shell):
        return _hollow(shape)
    if isinstance(shape, Torus):
        return _ring(shape)
    if not isinstance(shape, Mesh):
        return None
    body = mesh.load(shape)
    return body if ConvexHull(body.points).volume > (1.0 + CONVEX) * body.volume else None


def _hollow(shape: Shell) -> Triangles:
    """Gives what lies between two surfaces, half of the thickness outside of that of a shape and inside."""
    points, triangles, volume = np.zeros((0, 3)), [], 0.0
    for by in (0.5 * shape.thickness, -0.5 * shape.thickness):
        body = _surface(_grown(shape.shape, by))
        triangles.append((body.triangles if by > 0.0 else body.triangles[:, ::-1]) + len(points))
        points = np.concatenate([points, body.points])
        volume += math.copysign(body.volume, by)
    return Triangles(points, np.concatenate(triangles).astype(np.int32), volume, shape.thickness, np.zeros(3))


def _grown(shape: Shape, by: float) -> Shape:
    """A shape whose surface is farther out [m]."""
    match shape:
        case Box():
            return Box(tuple(a + 2.0 * by for a in shape.size))
        case Sphere():
            return Sphere(shape.radius + by)
        case Ellipsoid():
            return Ellipsoid(tuple(a + by for a in shape.radii))
        case Cylinder():
            return Cylinder(shape.radius + by, shape.height + 2.0 * by)
        case Torus():
            return Torus(shape.major, shape.minor + by)
    raise MeshError("only walls of boxes, spheres, ellipsoids, cylinders and rings are known", "take one of these, or a mesh")


def _surface(shape: Shape) -> Triangles:
    """The surface of a shape with flat sides."""
    from scipy.spatial import ConvexHull

    if isinstance(shape, Torus):
        return _ring(shape)
    points = _corners(shape)
    triangles = outward(points, ConvexHull(points).simplices, "the wall")
    return Triangles(points, triangles, shapes.volume(shape), shapes.thickness(shape), np.zeros(3))


def _ring(shape: Torus) -> Triangles:
    """A ring with flat sides that has the volume of the round one."""
    angle, around = (2.0 * np.pi * np.arange(n) / n for n in (AROUND, AROUND // 2))
    far = shape.major + shape.minor * np.cos(around)[None, :] + 0.0 * angle[:, None]
    points = np.stack(
        [far * np.cos(angle)[:, None], far * np.sin(angle)[:, None], shape.minor * np.sin(around) + 0.0 * far], axis=-1
    )
    number = np.arange(points[..., 0].size).reshape(far.shape)
    right, up, both = np.roll(number, -1, 0), np.roll(number, -1, 1), np.roll(number, (-1, -1), (0, 1))
    triangles = np.concatenate(
        [np.stack([number, right, both], -1).reshape(-1, 3), np.stack([number, both, up], -1).reshape(-1, 3)]
    )
    points = points.reshape(-1, 3)
    volume, _ = volume_and_centre(points, triangles)
    points *= (shapes.volume(shape) / volume) ** (1.0 / 3.0)
    return Triangles(points, triangles.astype(np.int32), shapes.volume(shape), 2.0 * shape.minor, np.zeros(3))


# --- cells of points ---------------------------------------------------------------------------------------------------


def voronoi(
    low: np.ndarray, high: np.ndarray, inside: Inside, planes: np.ndarray, number: int, seed: str
) -> list[tuple[np.ndarray, np.ndarray, dict[int, list[int]]]]:
    """The point of each cell [m], its corners [m] and its faces, by the piece beyond, below 0 for the planes around all; points
    lie ``inside`` the box from ``low`` to ``high``."""
    import hashlib

    from scipy.spatial import cKDTree

    key = np.frombuffer(hashlib.sha256(seed.encode()).digest()[:16], np.uint64)
    rng = np.random.Generator(np.random.Philox(key=key))
    point = _scattered(low, high, inside, number, rng)
    sample = _scattered(low, high, inside, SAMPLES * number, rng)
    for _ in range(ROUNDS):
        owner = cKDTree(point).query(sample)[1]
        own = np.bincount(owner, minlength=number)
        total = np.stack([np.bincount(owner, sample[:, k], number) for k in range(3)], axis=1)
        point = np.where(own[:, None] > 0, total / np.maximum(own, 1)[:, None], point)
    tree = cKDTree(point)
    return [(point[n], *_cell(point, tree, n, planes)) for n in range(number)]


def _scattered(low: np.ndarray, high: np.ndarray, inside: Inside, number: int, rng: np.random.Generator) -> np.ndarray:
    """Points at random inside [m], shape (number, 3)."""
    found, have = [], 0
    while have < number:
        some = low + (high - low) * rng.random((2 * number + 100, 3))
        some = some[inside(some)]
        found.append(some)
        have += len(some)
    return np.concatenate(found)[:number]


def _cell(point: np.ndarray, tree, n: int, planes: np.ndarray) -> tuple[np.ndarray, dict[int, list[int]]]:
    """The cell of a point: no point farther away than twice its farthest corner cuts it."""
    nearest = NEAREST
    while True:
        asked = min(nearest + 1, len(point))
        far, others = tree.query(point[n], asked)
        others = others[others != n]
        normal = point[others] - point[n]
        length = np.linalg.norm(normal, axis=1)
        normal = normal / length[:, None]
        between = np.column_stack([normal, np.einsum("kd,kd->k", normal, 0.5 * (point[others] + point[n]))])
        corner, faces = clipped(np.concatenate([planes, between]), point[n])
        if asked == len(point) or 2.0 * np.linalg.norm(corner - point[n], axis=1).max() < far[-1]:
            break
        nearest *= 2
    named = {k - len(planes): loop for k, loop in faces.items()}
    return corner, {int(others[k]) if k >= 0 else k: loop for k, loop in named.items()}


def clipped(planes: np.ndarray, inside: np.ndarray) -> tuple[np.ndarray, dict[int, list[int]]]:
    """Corners of what is within planes n.x <= d, rows (n, d) [m], shape (C, 3), and its faces by the numbers of planes: corners
    counter-clockwise from outside; ``inside`` is within. Planes of the smallest faces are left out."""
    from scipy.spatial import HalfspaceIntersection

    kept = np.arange(len(planes))
    while True:
        normal, off = planes[kept, :3], planes[kept, 3] - planes[kept, :3] @ inside
        size = float(np.median(off))
        found = HalfspaceIntersection(np.column_stack([normal, -off / size]), np.zeros(3)).intersections
        corner = _merged(size * found[np.isfinite(found).all(axis=1)])
        size = float(np.linalg.norm(np.ptp(corner, axis=0)))
        on = np.abs(corner @ normal.T - off) <= ONE_PLACE * size
        meet = np.flatnonzero(on.sum(axis=0) >= 3).tolist()
        loops = {k: _around(corner[on[:, k]], normal[k], np.flatnonzero(on[:, k])) for k in meet}
        small = [k for k, (_, area) in loops.items() if area <= LEAST_FACE * size**2]
        if not small:
            return corner + inside, {int(kept[k]): loop for k, (loop, _) in loops.items()}
        kept = np.delete(kept, small)


def _merged(points: np.ndarray) -> np.ndarray:
    """Points without those that are one with an earlier one."""
    near = ONE_PLACE * float(np.linalg.norm(np.ptp(points, axis=0)))
    apart = np.linalg.norm(points[:, None] - points[None], axis=2) > near
    return points[[k for k in range(len(points)) if apart[k, :k].all()]]


def _around(corner: np.ndarray, normal: np.ndarray, numbers: np.ndarray) -> tuple[list[int], float]:
    """Numbers of the corners of a flat face in order around its normal, and its area."""
    first = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    first /= np.linalg.norm(first)
    second = np.cross(normal, first)
    flat = np.stack([corner @ first, corner @ second], axis=1)
    away = flat - flat.mean(axis=0)
    order = np.argsort(np.arctan2(away[:, 1], away[:, 0]), kind="stable")
    x, y = flat[order].T
    return numbers[order].tolist(), 0.5 * float(abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)))


def convex_planes(shape: Shape) -> np.ndarray:
    """Planes n.x <= d that a convex shape is within, rows (n, d) [m], shape (K, 4). Round shapes get flat sides, and the volume
    that they have."""
    from scipy.spatial import ConvexHull

    corner = _corners(shape)
    hull = ConvexHull(corner)
    planes = np.column_stack([hull.equations[:, :3], -hull.equations[:, 3]])
    _, first = np.unique(np.round(planes / [1.0, 1.0, 1.0, np.abs(corner).max()], 6), axis=0, return_index=True)
    return planes[np.sort(first)]


def _corners(shape: Shape) -> np.ndarray:
    """Corners of a convex shape, of a round one of a polyhedron with its volume [m], shape (N, 3)."""
    if isinstance(shape, Box):
        return 0.5 * np.array(shape.size) * np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    from scipy.spatial import ConvexHull

    if isinstance(shape, Mesh):
        return mesh.load(shape).points
    angle = 2.0 * np.pi * np.arange(AROUND) / AROUND
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    if isinstance(shape, Cylinder | Cone):
        ring = ring * shape.radius * math.sqrt(2.0 * np.pi / AROUND / math.sin(2.0 * np.pi / AROUND))
        low = np.column_stack([ring, np.full(AROUND, -0.5 * shape.height)])
        if isinstance(shape, Cylinder):
            return np.concatenate([low, low * (1.0, 1.0, -1.0)])
        low[:, 2] = -0.25 * shape.height
        return np.concatenate([low, [(0.0, 0.0, 0.75 * shape.height)]])
    if isinstance(shape, Sphere | Ellipsoid):
        half = np.pi * np.arange(1, AROUND // 2) / (AROUND // 2)
        points = np.concatenate([
            *(np.column_stack([math.sin(a) * ring, np.full(AROUND, math.cos(a))]) for a in half.tolist()),
            [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)],
        ])  # fmt: skip
        points *= (4.0 / 3.0 * np.pi / ConvexHull(points).volume) ** (1.0 / 3.0)
        return points * (shape.radii if isinstance(shape, Ellipsoid) else shape.radius)
    raise TypeError(f"{shape!r} cannot be cut")


# --- bricks ------------------------------------------------------------------------------------------------------------


def _rows(shape: Shape, how: Bricks) -> list[np.ndarray]:
    """Where the bricks of each row end along x [m], from the lowest row on, each repeated for all rows along y."""
    if not isinstance(shape, Box):
        raise MeshError("only a box is made of bricks", "write shape box (lx, ly, lz), or pieces 20")
    along, deep, high = (max(1, round(whole / one)) for whole, one in zip(shape.size, how.size))
    if along * deep * high > MOST_PIECES.most:
        raise MeshError(f"it would have {along * deep * high} bricks, {number(MOST_PIECES.most)} at most", MOST_PIECES.way_out)
    whole = np.linspace(-0.5, 0.5, along + 1) * shape.size[0]
    half = np.concatenate([whole[:1], 0.5 * (whole[1:] + whole[:-1]), whole[-1:]])
    return [half if row % 2 else whole for row in range(high) for _ in range(deep)]


def _bricks(shape: Shape, how: Bricks) -> Division:
    """Bricks of two widths; a face of one may have several others beyond, of which it names none."""
    ends = _rows(shape, how)
    counts = [max(1, round(shape.size[k] / how.size[k])) for k in (1, 2)]
    y, z = (np.linspace(-0.5, 0.5, n + 1) * size for n, size in zip(counts, shape.size[1:]))
    low, high = [], []
    for place, x in enumerate(ends):
        row, layer = divmod(place, counts[0])
        low += [(left, y[layer], z[row]) for left in x[:-1]]
        high += [(right, y[layer + 1], z[row + 1]) for right in x[1:]]
    lows, highs = np.array(low), np.array(high)
    whole = float((highs - lows)[:, 0].max())
    size = np.array([whole, shape.size[1] / counts[0], shape.size[2] / counts[1]])
    half = (highs - lows)[:, 0] < 0.75 * whole
    kinds = [
        _piece(_corners(Box(size=tuple(size * (wide, 1.0, 1.0)))), dict(enumerate(BRICK, -len(BRICK)))) for wide in (1.0, 0.5)
    ]
    pieces = tuple(
        replace(kinds[kind], surface=replace(kinds[kind].surface, centre=middle))
        for kind, middle in zip(half.astype(int).tolist(), 0.5 * (lows + highs))
    )
    alike = np.where(half, half.argmax(), (~half).argmax())
    return Division(pieces, tuple(_between_bricks(lows, highs)), tuple(alike.tolist()))


BRICK = ([0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3])
"""Corners of the sides -x, +x, -y, +y, -z, +z."""


# --- pieces ------------------------------------------------------------------------------------------------------------


def _piece(corner: np.ndarray, faces: dict[int, list[int]]) -> Piece:
    triangles = np.array([(f[0], f[k], f[k + 1]) for f in faces.values() for k in range(1, len(f) - 1)], np.int32)
    volume, centre = volume_and_centre(corner, triangles)
    own = corner - centre
    solid = Polyhedron(own, tuple(map(tuple, faces.values())))
    deep = []
    for face in solid.faces:
        a, b, c = own[list(face[:3])]
        normal = np.cross(b - a, c - a)
        deep.append(float(((a - own) @ normal).max() / np.linalg.norm(normal)))
    surface = Triangles(own, triangles, volume, min(deep), centre)
    size = float(np.linalg.norm(np.ptp(own, axis=0)))
    return Piece(surface, solid if is_clean(solid, 1e-6 * size) else None, tuple(faces))


def _common_faces(pieces: tuple[Piece, ...]) -> list[CommonFace]:
    """Faces of Voronoi cells that have a piece beyond, each once."""
    found = []
    numbers = {(n, other): side for n, p in enumerate(pieces) for side, other in enumerate(p.beyond) if other >= 0}
    for (a, b), side in numbers.items():
        if a < b and (b, a) in numbers:
            own = pieces[a]
            loop = own.polyhedron.faces[side] if own.polyhedron else ()
            if loop:
                found.append(_common(a, b, side, numbers[b, a], own.surface.points[list(loop)] + own.surface.centre))
    return found


def _between_bricks(low: np.ndarray, high: np.ndarray) -> list[CommonFace]:
    """Faces where two bricks meet; both ends of bricks [m], shape (N, 3)."""
    from .boxes import box_pairs

    near = 1e-6 * float(np.min(high - low))
    found = []
    for some in box_pairs(low - near, high + near):
        a, b = np.sort(np.array(some), axis=0)
        start, end = np.maximum(low[a], low[b]), np.minimum(high[a], high[b])
        flat = end - start <= 2.0 * near
        met = np.flatnonzero(flat.sum(axis=1) == 1)
        axis = flat[met].argmax(axis=1)
        up = (low[b] > low[a])[met, axis]
        rows = zip(
            a[met].tolist(), b[met].tolist(), axis.tolist(), up.tolist(), (end - start)[met].tolist(), 0.5 * (start + end)[met]
        )
        found += [_rectangle(*row) for row in rows]
    return sorted(found, key=lambda face: (face.a, face.b))


def _rectangle(a: int, b: int, axis: int, up: bool, size: list[float], at: np.ndarray) -> CommonFace:
    """The face between two bricks across an axis, ``up`` where the second one is farther along it."""
    (short, along), (long, _) = sorted((size[k], k) for k in range(3) if k != axis)
    area = short * long
    second = area * long**2 / 12.0, area * short**2 / 12.0
    section = area * long / 6.0, area * short / 6.0, sum(second) / (0.5 * math.hypot(short, long))
    return CommonFace(a, b, 2 * axis + up, 2 * axis + (not up), at, AXES[axis, up, along], area, second, section)


def _axes(axis: int, up: bool, along: int) -> np.ndarray:
    """The normal of a face across an axis, one along, and the third."""
    normal, first = (1.0 if up else -1.0) * np.eye(3)[axis], np.eye(3)[along]
    return np.stack([normal, first, np.cross(normal, first)])


AXES = {
    (axis, up, along): _axes(axis, up, along) for axis in range(3) for up in (False, True) for along in range(3) if along != axis
}
"""Axes of faces of bricks, by the axis across, the side, and the axis of the shorter edges."""


def _common(a: int, b: int, side_a: int, side_b: int, loop: np.ndarray) -> CommonFace:
    """A face by its corners around the normal from a to b, shape (C, 3) [m]."""
    start = np.broadcast_to(loop.mean(axis=0), loop.shape)
    return common_face(a, b, int(side_a), int(side_b), np.stack([start, loop, np.roll(loop, -1, axis=0)], axis=1))


def common_face(a: int, b: int, side_a: int, side_b: int, corners: np.ndarray) -> CommonFace:
    """A flat face by triangles around the normal from a to b, shape (T, 3, 3) [m]."""
    twice = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal = twice.sum(axis=0)
    normal /= np.linalg.norm(normal)
    weight = 0.5 * twice @ normal
    area = float(weight.sum())
    at = weight @ corners.mean(axis=1) / area
    across = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    across /= np.linalg.norm(across)
    flat = np.stack([across, np.cross(normal, across)])
    own = (corners - at) @ flat.T
    ends = np.concatenate([own, own.sum(axis=1, keepdims=True)], axis=1)
    spread = np.einsum("t,tki,tkj->ij", weight / 12.0, ends, ends)
    _, main = np.linalg.eigh(spread)
    axes = main.T @ flat
    axes[1] = np.cross(normal, axes[0])
    places = (corners - at).reshape(-1, 3) @ axes.T
    moments = np.einsum("ki,ij,kj->k", main.T, spread, main.T)
    second = float(moments[1]), float(moments[0])  # about an axis: of the distance from it
    far = np.abs(places).max(axis=0)
    section = second[0] / far[1], second[1] / far[0], sum(second) / np.linalg.norm(places, axis=1).max()
    return CommonFace(a, b, side_a, side_b, at, np.vstack([normal, axes]), area, second, tuple(map(float, section)))
