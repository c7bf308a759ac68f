# SPDX-License-Identifier: GPL-2.0-only
"""Closed triangle meshes from files: reading, checking, volume, inside or not.

pyvista (VTK) is needed only here and only for scenes that name a mesh; it is imported inside the functions.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from ..scene.formatting import say
from ..scene.scene import Mesh
from .mesh_reader import UnreadableMesh, read_polygons
from .nearest import Nearest, blocks
from .thickness import thickness
from .triangles import areas, spots

SUFFIXES = (".stl", ".obj", ".ply")
SIZES = 1e-9, 1e9
"""Least and largest measure of a shape [m]."""


class MeshError(Exception):
    """A mesh file that cannot become a solid; ``hint`` says how to correct it."""

    def __init__(self, message: str, hint: str):
        super().__init__(message)
        self.hint = hint


@dataclass(frozen=True, slots=True, eq=False)
class Triangles:
    """A closed surface around one solid, in metres, centre of mass (uniform density) at the origin."""

    points: np.ndarray
    """[m], shape (V, 3)."""
    triangles: np.ndarray
    """Counter-clockwise seen from outside, int32, shape (T, 3)."""
    volume: float
    """[m^3]"""
    thickness: float
    """Thickness of the thinnest part, an estimate [m]."""
    color: np.ndarray | None = None
    """RGB of the points, uint8, shape (V, 3); None where the file has none."""

    @property
    def area(self) -> float:
        """[m^2]"""
        return float(areas(self.points, self.triangles).sum())


def load(shape: Mesh) -> Triangles:
    """Read the file of a mesh shape once; raise MeshError where it is missing, unreadable or not closed."""
    path = Path(shape.path)
    if path.suffix.lower() not in SUFFIXES:
        raise MeshError(f"mesh {path.name}: unknown kind of file {path.suffix!r}", "use STL, OBJ or PLY")
    try:
        stamp = path.stat()
    except OSError as error:
        hint = "paths count from the folder of the scene file"
        raise MeshError(f"mesh {path}: {error.strerror}", hint) from None
    return _load(path, shape.scale, stamp.st_mtime_ns, stamp.st_size)


@lru_cache(maxsize=64)
def _load(path: Path, scale: float, changed: int, size: int) -> Triangles:
    points, triangles, color = _read(path)
    triangles = _outward(points, triangles, path.name)
    volume, centre = _volume_and_centre(points, triangles)
    size = float(np.ptp(points, axis=0).max()) * scale
    if not SIZES[0] <= size <= SIZES[1]:
        raise MeshError(
            f"mesh {path.name}: is {say(size, 'm')} long at scale {scale:g}; "
            f"{say(SIZES[0], 'm')} to {say(SIZES[1], 'm')} can be modelled",
            "'scale' is the length of a unit of the file; is an exponent wrong?",
        )
    points = (points - centre) * scale
    return Triangles(points, triangles, volume * scale**3, thickness(points, triangles, volume * scale**3), color)


def _read(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
    """Points in units of the file (V, 3), equal ones merged, triangles (T, 3), and colours of points (V, 3) if it has any."""
    import pyvista

    try:
        polygons, faces, color = read_polygons(path)
    except (OSError, UnreadableMesh) as error:
        raise MeshError(f"mesh {path.name}: {error}", "export it again as STL, OBJ or PLY") from None
    surface = pyvista.PolyData(polygons, faces=faces)
    if len(color):
        surface.point_data["color"] = color
    surface = surface.triangulate().clean(tolerance=1e-7, absolute=False)
    triangles = np.asarray(surface.faces).reshape(-1, 4)[:, 1:].astype(np.int32)
    points = np.asarray(surface.points, float)
    corners = np.sort(triangles, axis=1)
    triangles = triangles[(corners[:, 0] != corners[:, 1]) & (corners[:, 1] != corners[:, 2])]
    if not len(triangles):
        raise MeshError(f"mesh {path.name}: holds no triangle", "export a surface, not points or lines")
    if not np.isfinite(points).all():
        raise MeshError(f"mesh {path.name}: holds coordinates that are not finite", "export it again")
    return points, triangles, np.asarray(surface.point_data["color"]) if len(color) else None


def _edges(triangles: np.ndarray) -> np.ndarray:
    """Directed edges, shape (3 T, 2)."""
    return triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)


def _outward(points: np.ndarray, triangles: np.ndarray, name: str) -> np.ndarray:
    """Turn triangles so that all face outward; raise MeshError where the surface is not closed."""
    _, uses = np.unique(np.sort(_edges(triangles), axis=1), axis=0, return_counts=True)
    if (uses == 1).any():
        raise MeshError(
            f"mesh {name}: not closed, {np.count_nonzero(uses == 1)} edges belong to one triangle only",
            "fill its holes in a mesh editor (Blender: Select > Non Manifold, then Fill)",
        )
    if (uses > 2).any():
        raise MeshError(
            f"mesh {name}: {np.count_nonzero(uses > 2)} edges belong to more than two triangles",
            "remove inner faces and doubled triangles in a mesh editor",
        )
    if not _consistent(triangles):
        triangles = _reorient(points, triangles)
    if not _consistent(triangles):
        raise MeshError(f"mesh {name}: has no inside and outside", "a one-sided surface cannot be a solid")
    volume, _ = _volume_and_centre(points, triangles)
    size = np.ptp(points, axis=0).max()
    if abs(volume) <= 1e-9 * size**3:
        raise MeshError(f"mesh {name}: encloses no volume", "export a body, not a sheet")
    return triangles if volume > 0 else triangles[:, ::-1].copy()


def _consistent(triangles: np.ndarray) -> bool:
    """Whether neighbours run along their common edge in opposite directions."""
    edges = _edges(triangles)
    return len(np.unique(edges, axis=0)) == len(edges)


def _reorient(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    import pyvista

    surface = pyvista.PolyData.from_regular_faces(points, triangles).compute_normals(
        consistent_normals=True, auto_orient_normals=True, split_vertices=False, non_manifold_traversal=False
    )
    return np.asarray(surface.faces).reshape(-1, 4)[:, 1:].astype(np.int32)


def _volume_and_centre(points: np.ndarray, triangles: np.ndarray) -> tuple[float, np.ndarray]:
    """Signed volume and centre of mass, by summing the tetrahedra from one point to each triangle."""
    origin = points.mean(axis=0)
    a, b, c = np.moveaxis((points - origin)[triangles], 1, 0)
    six = np.einsum("td,td->t", a, np.cross(b, c))
    volume = six.sum() / 6
    if volume == 0:
        return 0.0, origin
    return float(volume), origin + (six[:, None] * (a + b + c)).sum(axis=0) / (24 * volume)


# --- inside or not ------------------------------------------------------------------------------------------


def contains(mesh: Triangles, points: np.ndarray) -> np.ndarray:
    """Whether points [m], shape (N, 3), are inside, bool, shape (N,): an odd number of triangles is below."""
    points = np.asarray(points, float).reshape(-1, 3)
    below = np.zeros(len(points), np.int64)
    for line, z in _crossings(mesh, points[:, :2]):
        below += np.bincount(line[z < points[line, 2]], minlength=len(points))
    return below % 2 == 1


def fill(mesh: Triangles, x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Whether the points of the grid x (nx,), y (ny,), z (nz,) [m] are inside, bool, shape (nz, ny, nx)."""
    lines = np.stack([np.tile(x, len(y)), np.repeat(y, len(x))], axis=1)
    toggles = np.zeros((len(z) + 1, len(lines)), np.uint8)
    for line, height in _crossings(mesh, lines):
        where = np.searchsorted(z, height) * len(lines) + line
        toggles += np.bincount(where, minlength=toggles.size).astype(np.uint8).reshape(toggles.shape)
    inside = np.add.accumulate(toggles[:-1], axis=0, dtype=np.uint8) & 1
    return inside.astype(bool).reshape(len(z), len(y), len(x))


def depth(mesh: Triangles, points: np.ndarray) -> np.ndarray:
    """Distance of points [m], shape (N, 3), to the surface [m], shape (N,); negative outside."""
    import pyvista

    surface = pyvista.PolyData.from_regular_faces(mesh.points, mesh.triangles)
    cloud = pyvista.PolyData(np.asarray(points, float)).compute_implicit_distance(surface)
    return np.where(contains(mesh, points), 1.0, -1.0) * abs(np.asarray(cloud["implicit_distance"]))


def _crossings(mesh: Triangles, lines: np.ndarray, batch: int = 2_000_000) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Where vertical lines at (x, y) [m], shape (L, 2), meet triangles: (line numbers, heights), in batches.

    A line through a common edge counts for exactly one of its two triangles: both ask on which side of the
    edge it passes, in the same arithmetic.
    """
    if not len(lines):
        return
    low, high = mesh.points[:, :2].min(axis=0), mesh.points[:, :2].max(axis=0)
    # Slightly displaced, so that a line does not hit a vertex on a lattice of round numbers.
    lines = lines + 1e-9 * np.array([0.5772156649, 0.3819660113]) * (high - low)
    bins = int(np.clip(np.sqrt(len(lines)), 1, 1024))
    to_bin = bins / np.maximum(high - low, np.finfo(float).tiny)
    column, row = (((lines - low) * to_bin).clip(0, bins - 1).astype(np.int64)).T
    order = np.argsort(row * bins + column, kind="stable")
    first = np.searchsorted((row * bins + column)[order], np.arange(bins * bins + 1))

    corners = mesh.points[mesh.triangles][:, :, :2]
    c0, r0 = ((corners.min(axis=1) - low) * to_bin).clip(0, bins - 1).astype(np.int64).T
    c1, r1 = ((corners.max(axis=1) - low) * to_bin).clip(0, bins - 1).astype(np.int64).T
    # The bins of one row that a triangle may touch are one stretch of the sorted lines.
    triangle, row = _ranges(r0, r1 + 1)
    start, stop = first[row * bins + c0[triangle]], first[row * bins + c1[triangle] + 1]
    pairs = np.cumsum(stop - start)
    cuts = np.searchsorted(pairs, np.arange(0, pairs[-1], batch))
    for a, b in zip(cuts, np.append(cuts[1:], len(pairs))):
        stretch, at = _ranges(start[a:b], stop[a:b])
        yield _hits(mesh, lines, order[at], triangle[a:b][stretch])


def _ranges(start: np.ndarray, stop: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Write out the ranges start[k] .. stop[k] - 1: the number k of each element, and the element."""
    length = stop - start
    owner = np.repeat(np.arange(len(start)), length)
    return owner, np.arange(len(owner)) - np.repeat(np.cumsum(length) - length - start, length)


def _hits(mesh: Triangles, lines: np.ndarray, line: np.ndarray, triangle: np.ndarray):
    """Pairs (line, triangle) that intersect: line numbers and heights [m]."""
    corner = mesh.triangles[triangle]
    px, py = lines[line].T
    sides = []
    for i, j in ((0, 1), (1, 2), (2, 0)):
        a, b = corner[:, i], corner[:, j]
        u, v = mesh.points[np.minimum(a, b)], mesh.points[np.maximum(a, b)]
        left = (v[:, 0] - u[:, 0]) * (py - u[:, 1]) >= (v[:, 1] - u[:, 1]) * (px - u[:, 0])
        sides.append(left == (a < b))
    meets = (sides[0] == sides[1]) & (sides[1] == sides[2])
    line, corner, px, py = line[meets], corner[meets], px[meets], py[meets]
    a, b, c = np.moveaxis(mesh.points[corner], 1, 0)
    n = np.cross(b - a, c - a)
    with np.errstate(divide="ignore", invalid="ignore"):
        z = a[:, 2] - (n[:, 0] * (px - a[:, 0]) + n[:, 1] * (py - a[:, 1])) / n[:, 2]
    heights = np.stack([a[:, 2], b[:, 2], c[:, 2]])
    # An almost vertical triangle has no exact height; any height between its corners is valid.
    return line, np.where(np.isfinite(z), z, a[:, 2]).clip(heights.min(axis=0), heights.max(axis=0))


# --- surface ------------------------------------------------------------------------------------------------


def scatter(mesh: Triangles, spacing: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Samples about ``spacing`` [m] apart: places [m] (K, 3), triangles (K,) and areas [m^2] (K,), which sum to that of the mesh.

    Every triangle has at least one.
    """
    area = areas(mesh.points, mesh.triangles)
    count = np.ceil(area / spacing**2).clip(min=1).astype(np.int64)
    triangle = np.repeat(np.arange(len(area)), count)
    place = np.empty((len(triangle), 3))
    for rows in blocks(len(triangle)):
        place[rows] = spots(mesh.points[mesh.triangles[triangle[rows]]], first=rows.start)
    return place, triangle, (area / count)[triangle]


def colors_at(mesh: Triangles, points: np.ndarray) -> np.ndarray | None:
    """Colours of the points of the file that are nearest to these [m], shape (N, 3): uint8, (N, 3); None where it has none."""
    if mesh.color is None:
        return None
    return mesh.color[Nearest(mesh.points)(points)[1]]


def refined_surface(mesh: Triangles, size: float) -> tuple[np.ndarray, np.ndarray]:
    """Points [m] (V, 3) and triangles (T, 3) of the surface, with no edge much longer than ``size`` [m]."""
    import pyvista

    edge = mesh.points[_edges(mesh.triangles)]
    if np.linalg.norm(edge[:, 0] - edge[:, 1], axis=1).max() <= 2 * size:
        return mesh.points, mesh.triangles
    # The filters' limits of lengths and areas are numbers without a unit: here the size is near 1, and no bit is lost.
    unit = 2.0 ** math.frexp(size)[1]
    fine = pyvista.PolyData.from_regular_faces(mesh.points / unit, mesh.triangles)
    for _ in range(12):  # a pass for each call: Ctrl-C is answered between them
        before = fine.n_cells
        fine = fine.subdivide_adaptive(max_edge_len=2 * size / unit, max_tri_area=1e30, max_n_passes=1)
        if fine.n_cells == before:
            break
    fine = fine.clean(tolerance=1e-9)
    return unit * np.asarray(fine.points, float), np.asarray(fine.faces).reshape(-1, 4)[:, 1:].astype(np.int32)
