# SPDX-License-Identifier: GPL-2.0-only
"""Closed triangle meshes from files: reading, checking, volume, inside or not."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable
from contextlib import suppress
from functools import lru_cache
from pathlib import Path

import numpy as np

from ..records import dataclass
from ..scene.formatting import say
from ..scene.scene import Mesh, PieceShape, Shape
from . import vtk_surface
from .crossings import crossings
from .mesh_formats import Polygons, UnreadableMesh
from .mesh_parts import named_part, piece
from .nearest import Nearest, blocks
from .orientation import MeshError, outward
from .solid import solid
from .thickness import thickness
from .triangles import areas, edges, spots, volume_and_centre

SUFFIXES = (".stl", ".obj", ".ply")
SIZES = 1e-9, 1e9
"""Least and largest measure of a shape [m]."""
MOST_AHEAD = 2**26
"""Bytes of all mesh files of a scene up to which one process reads them together: beyond, its start is nothing beside that."""


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
    centre: np.ndarray
    """Centre of mass as the file has it [m], shape (3,)."""
    color: np.ndarray | None = None
    """RGB of the points, uint8, shape (V, 3); None where the file has none, or the surface is made anew."""
    mended: str = ""
    """Changes to the surface of the file, in words."""
    names: tuple[str, ...] = ()
    """Names of all parts of the file."""

    @property
    def area(self) -> float:
        """[m^2]"""
        return float(areas(self.points, self.triangles).sum())


def load(shape: Mesh) -> Triangles:
    """Read the file of a mesh shape once, or cut a piece; raise MeshError where it is missing, unreadable or not closed."""
    if isinstance(shape, PieceShape):
        from .cut import piece  # it needs the shapes that are cut

        return piece(shape).surface
    path, stamp = stamped(shape)
    return _load(path, shape.part, shape.scale, shape.mended, stamp.st_mtime_ns, stamp.st_size)


def stamped(shape: Mesh) -> tuple[Path, os.stat_result]:
    """The file of a mesh shape, with time and size of its last change. Raises MeshError."""
    path = Path(shape.path)
    if path.suffix.lower() not in SUFFIXES:
        raise MeshError(f"mesh {path.name}: unknown kind of file {path.suffix!r}", "use STL, OBJ or PLY")
    try:
        return path, path.stat()
    except OSError as error:
        hint = "paths count from the folder of the scene file"
        raise MeshError(f"mesh {path}: {error.strerror}", hint) from None


def read_ahead(shapes: Iterable[Shape]) -> None:
    """Read the files of those of these shapes that are meshes and were not read before by one process, for `load`. What it cannot
    read is left to `load`, which tells why."""
    found = {}
    for shape in dict.fromkeys(shapes):
        if isinstance(shape, Mesh) and not isinstance(shape, PieceShape):
            with suppress(MeshError):
                path, stamp = stamped(shape)
                found[path, stamp.st_mtime_ns, stamp.st_size] = path
    for key in found.keys() & _read_before:
        del found[key]
    if len(found) > 1 and sum(key[2] for key in found) < MOST_AHEAD:
        from .mesh_reader import read_together  # as in `_of_file`

        with suppress(OSError, UnreadableMesh):
            _ahead.update(zip(found, read_together(list(found.values()))))


_ahead: dict[tuple[Path, int, int], Polygons] = {}
"""Contents of files, with time and size of their last change, until they are loaded."""
_read_before: set[tuple[Path, int, int]] = set()
"""Files that were loaded."""


@lru_cache(maxsize=64)
def _load(path: Path, part: str | int | None, scale: float, mend: bool, changed: int, size: int) -> Triangles:
    points, triangles, color, names = read_file(path, part)
    read, mended = len(points), ""
    if mend:
        points, triangles, mended = solid(points, triangles, path.name)
    else:
        triangles = outward(points, triangles, path.name)
    volume, centre = volume_and_centre(points, triangles)
    check_size(points, scale, path.name)
    points = (points - centre) * scale
    color = color if len(points) == read else None
    volume *= scale**3
    return Triangles(points, triangles, volume, thickness(points, triangles, volume), centre * scale, color, mended, names)


def check_size(points: np.ndarray, scale: float, name: str) -> None:
    """Raises MeshError where points of a file, shape (V, 3), at a scale are too far from or too near to each other."""
    size = float(np.ptp(points, axis=0).max()) * scale
    if not SIZES[0] <= size <= SIZES[1]:
        raise MeshError(
            f"mesh {name}: is {say(size, 'm')} long at scale {scale:g}; "
            f"{say(SIZES[0], 'm')} to {say(SIZES[1], 'm')} can be modelled",
            "'scale' is the length of a unit of the file; is an exponent wrong?",
        )


def read_file(path: Path, part: str | int | None = None) -> tuple[np.ndarray, np.ndarray, np.ndarray | None, tuple[str, ...]]:
    """Points in units of the file (V, 3), equal ones merged, triangles (T, 3), colours of points (V, 3) if it has any, and the
    names of all its parts; of one part, or of all together. Raises MeshError."""
    try:
        found = _read(path, part is not None)
    except (OSError, UnreadableMesh) as error:
        raise MeshError(f"mesh {path.name}: {error}", "export it again as STL, OBJ or PLY") from None
    names = found.names
    if names and part is not None:
        found = named_part(found, part, path.name)
    faces = np.insert(found.index, np.cumsum(found.count) - found.count, found.count)
    surface = vtk_surface.polygons(found.points, faces)
    if len(found.color):
        vtk_surface.paint(surface, found.color)
    surface = vtk_surface.merged(vtk_surface.triangulated(surface), 1e-7)
    points, triangles = vtk_surface.arrays(surface)
    color = vtk_surface.paint_of(surface) if len(found.color) else None
    corners = np.sort(triangles, axis=1)
    triangles = triangles[(corners[:, 0] != corners[:, 1]) & (corners[:, 1] != corners[:, 2])]
    if not len(triangles):
        raise MeshError(f"mesh {path.name}: holds no triangle", "export a surface, not points or lines")
    if not np.isfinite(points).all():
        raise MeshError(f"mesh {path.name}: holds coordinates that are not finite", "export it again")
    if not names and part is not None:
        used, number = np.unique(piece(points, triangles, part, path.name), return_inverse=True)
        points, triangles = points[used], number.reshape(-1, 3).astype(np.int32)
        color = None if color is None else color[used]
    return points, triangles, color, names


def _read(path: Path, again: bool) -> Polygons:
    """Contents of a file; ``again`` says that those of other parts may be asked for soon."""
    stamp = path.stat()
    key = path, stamp.st_mtime_ns, stamp.st_size
    _read_before.add(key)
    return _kept(*key) if again else _of_file(*key)


@lru_cache(maxsize=1)
def _kept(path: Path, changed: int, size: int) -> Polygons:
    return _of_file(path, changed, size)


def _of_file(path: Path, changed: int, size: int) -> Polygons:
    from .mesh_reader import read_polygons  # what starts processes is loaded for scenes with a mesh alone

    ahead = _ahead.pop((path, changed, size), None)
    return read_polygons(path) if ahead is None else ahead


def second_moments(mesh: Triangles) -> np.ndarray:
    """Integral of x x' over the inside by the volume, about the centre of mass [m^2], shape (3, 3).

    Over the tetrahedron from the origin to a triangle a, b, c it is V/20 (aa' + bb' + cc' + ss') with s = a + b + c.
    """
    corners = mesh.points[mesh.triangles]
    a, b, c = np.moveaxis(corners, 1, 0)
    six = np.einsum("td,td->t", a, np.cross(b, c))
    ends = np.concatenate([corners, corners.sum(axis=1, keepdims=True)], axis=1)
    return np.einsum("t,tkd,tke->de", six, ends, ends) / (120 * mesh.volume)


# --- inside or not ------------------------------------------------------------------------------------------


def contains(mesh: Triangles, points: np.ndarray) -> np.ndarray:
    """Whether points [m], shape (N, 3), are inside, bool, shape (N,): an odd number of triangles is below."""
    points = np.asarray(points, float).reshape(-1, 3)
    below = np.zeros(len(points), np.int64)
    for line, z, _ in crossings(mesh.points, mesh.triangles, points[:, :2]):
        below += np.bincount(line[z < points[line, 2]], minlength=len(points))
    return below % 2 == 1


def fill(mesh: Triangles, x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Whether the points of the grid x (nx,), y (ny,), z (nz,) [m] are inside, bool, shape (nz, ny, nx)."""
    lines = np.stack([np.tile(x, len(y)), np.repeat(y, len(x))], axis=1)
    toggles = np.zeros((len(z) + 1, len(lines)), np.uint8)
    for line, height, _ in crossings(mesh.points, mesh.triangles, lines):
        where = np.searchsorted(z, height) * len(lines) + line
        toggles += np.bincount(where, minlength=toggles.size).astype(np.uint8).reshape(toggles.shape)
    inside = np.add.accumulate(toggles[:-1], axis=0, dtype=np.uint8) & 1
    return inside.astype(bool).reshape(len(z), len(y), len(x))


def depth(mesh: Triangles, points: np.ndarray) -> np.ndarray:
    """Distance of points [m], shape (N, 3), to the surface [m], shape (N,); negative outside."""
    return np.where(contains(mesh, points), 1.0, -1.0) * away(mesh, points)


def away(mesh, points: np.ndarray) -> np.ndarray:
    """Distance of points [m], shape (N, 3), to the surface of a mesh [m], shape (N,)."""
    return abs(quick_depth(mesh)(points))


@lru_cache(maxsize=4)
def quick_depth(mesh):
    """A function: `depth` of some places [m], shape (N, 3), [m], in a hundredth of the time, whose sign may be wrong beside
    edges. To make it takes as long as some thousand places."""
    return vtk_surface.depth_below(mesh.points, mesh.triangles)


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
    edge = mesh.points[edges(mesh.triangles)]
    if np.linalg.norm(edge[:, 0] - edge[:, 1], axis=1).max() <= 2 * size:
        return mesh.points, mesh.triangles
    # The filters' limits of lengths and areas are numbers without a unit: here the size is near 1, and no bit is lost.
    unit = 2.0 ** math.frexp(size)[1]
    fine = vtk_surface.surface(mesh.points / unit, mesh.triangles)
    for _ in range(12):  # a pass for each call: Ctrl-C is answered between them
        before = fine.GetNumberOfCells()
        fine = vtk_surface.subdivided(fine, 2 * size / unit)
        if fine.GetNumberOfCells() == before:
            break
    points, triangles = vtk_surface.arrays(vtk_surface.merged(fine, 1e-9))
    return unit * points, triangles
