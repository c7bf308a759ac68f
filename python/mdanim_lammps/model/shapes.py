# SPDX-License-Identifier: GPL-2.0-only
"""The shapes of the scene language as geometry: volume, thickness, extent, inside or not, surface.

Body frame: origin in the centre of mass, axes of revolution along z. One class of formulas per shape; the
public functions look it up in ``LAWS``. Points on a surface are in spread.py, distances in distance.py; CONTRIBUTING.md lists all
places that a new shape has.
"""

from __future__ import annotations

from functools import lru_cache
from math import ceil, hypot, pi
from typing import Any, get_args

import numpy as np

from ..scene import scene as kinds
from . import mesh, shell
from .rope import RopeLaw
from .tessellate import ROUND, ellipsoid, facets, grid_box, polyline, revolve


class _Box:
    rolls, end = False, "flat"

    @staticmethod
    def volume(s):
        return float(np.prod(s.size))

    @staticmethod
    def area(s):
        a, b, c = s.size
        return 2 * (a * b + b * c + c * a)

    @staticmethod
    def thickness(s):
        return min(s.size)

    @staticmethod
    def moments(s):
        return np.array(s.size) ** 2 / 12

    @staticmethod
    def extent(s):
        half = np.array(s.size) / 2
        return -half, half

    @staticmethod
    def depth(s, x, y, z):
        a, b, c = np.array(s.size) / 2
        return np.minimum(np.minimum(a - abs(x), b - abs(y)), c - abs(z))

    @staticmethod
    def surface(s, size):
        return grid_box(s.size, size)

    @staticmethod
    def radius(s):
        return float(np.linalg.norm(np.array(s.size) / 2))

    @staticmethod
    def vertices(s, h):
        return _Box.area(s) / h**2


def _of_plate(formula):
    return staticmethod(lambda s, *more: formula(s.plate, *more))


class _Sheet:
    """A cuboid of its thickness."""

    rolls, end = False, "flat"
    volume, area, moments = _of_plate(_Box.volume), _of_plate(_Box.area), _of_plate(_Box.moments)
    extent, depth, radius = _of_plate(_Box.extent), _of_plate(_Box.depth), _of_plate(_Box.radius)

    @staticmethod
    def thickness(s):
        return s.thickness

    @staticmethod
    def surface(s, size):
        raise TypeError("the surface of a sheet is that of its particles")

    @staticmethod
    def vertices(s, h):
        return 2.0 * s.size[0] * s.size[1] / h**2


class _Ellipsoid:
    rolls, end = True, "pointed"

    @staticmethod
    def volume(s):
        return 4 / 3 * pi * float(np.prod(_radii(s)))

    @staticmethod
    def area(s):
        from scipy.special import elliprg

        a2, b2, c2 = _radii(s) ** 2
        return 4 * pi * float(elliprg(a2 * b2, b2 * c2, c2 * a2))  # Carlson, https://dlmf.nist.gov/19.33.E1

    @staticmethod
    def thickness(s):
        return 2 * min(_radii(s))

    @staticmethod
    def moments(s):
        return _radii(s) ** 2 / 5

    @staticmethod
    def extent(s):
        return -_radii(s), _radii(s)

    @staticmethod
    def depth(s, x, y, z):
        a, b, c = _radii(s)
        f = np.sqrt((x / a) ** 2 + (y / b) ** 2 + (z / c) ** 2)
        # Exact along the thinnest axis. The ellipsoid shrunk by f, widened by (1 - f) min, still lies inside.
        return (1 - f) * min(a, b, c)

    @staticmethod
    def surface(s, size):
        return ellipsoid(_radii(s), facets(2 * pi * max(_radii(s)), size))

    @staticmethod
    def radius(s):
        return float(max(_radii(s)))

    @staticmethod
    def vertices(s, h):
        return _around(max(_radii(s)), h) ** 2 / 2


class _Sphere(_Ellipsoid):
    end = "round"


def _radii(s) -> np.ndarray:
    return np.array(s.radii) if isinstance(s, kinds.Ellipsoid) else np.full(3, s.radius)


class _Cylinder:
    rolls, end = False, "flat"

    @staticmethod
    def volume(s):
        return pi * s.radius**2 * s.height

    @staticmethod
    def area(s):
        return 2 * pi * s.radius * (s.radius + s.height)

    @staticmethod
    def thickness(s):
        return min(2 * s.radius, s.height)

    @staticmethod
    def moments(s):
        return np.array([s.radius**2 / 4, s.radius**2 / 4, s.height**2 / 12])

    @staticmethod
    def extent(s):
        high = np.array([s.radius, s.radius, s.height / 2])
        return -high, high

    @staticmethod
    def depth(s, x, y, z):
        return np.minimum(s.radius - np.hypot(x, y), s.height / 2 - abs(z))

    @staticmethod
    def surface(s, size):
        r, h = s.radius, s.height
        profile = polyline([(0, -h / 2), (r, -h / 2), (r, h / 2), (0, h / 2)], size)
        return revolve(profile, facets(2 * pi * r, size))

    @staticmethod
    def radius(s):
        return float(np.hypot(s.radius, s.height / 2))

    @staticmethod
    def vertices(s, h):
        return _around(s.radius, h) * ceil((2 * s.radius + s.height) / h)


class _Cone:
    rolls, end = False, "pointed"

    @staticmethod
    def volume(s):
        return pi * s.radius**2 * s.height / 3

    @staticmethod
    def area(s):
        return pi * s.radius * (s.radius + hypot(s.radius, s.height))

    @staticmethod
    def thickness(s):
        # The tip has no thickness; the largest ball inside determines the size of the cells.
        return 2 * s.radius * s.height / (s.radius + hypot(s.radius, s.height))

    @staticmethod
    def moments(s):
        return np.array([3 * s.radius**2 / 20, 3 * s.radius**2 / 20, 3 * s.height**2 / 80])

    @staticmethod
    def extent(s):
        r, h = s.radius, s.height
        return np.array([-r, -r, -h / 4]), np.array([r, r, 3 * h / 4])

    @staticmethod
    def depth(s, x, y, z):
        r, h = s.radius, s.height
        slant = (r * (3 * h / 4 - z) - h * np.hypot(x, y)) / hypot(r, h)
        return np.minimum(slant, z + h / 4)

    @staticmethod
    def surface(s, size):
        r, h = s.radius, s.height
        return revolve(polyline([(0, -h / 4), (r, -h / 4), (0, 3 * h / 4)], size), facets(2 * pi * r, size))

    @staticmethod
    def radius(s):
        return float(np.linalg.norm([s.radius, s.radius, 3 * s.height / 4]))  # a little more than it is

    @staticmethod
    def vertices(s, h):
        return _around(s.radius, h) * ceil((s.radius + hypot(s.radius, s.height)) / h)


class _Torus:
    rolls, end = True, "flat"

    @staticmethod
    def volume(s):
        return 2 * pi**2 * s.major * s.minor**2

    @staticmethod
    def area(s):
        return 4 * pi**2 * s.major * s.minor

    @staticmethod
    def thickness(s):
        return 2 * s.minor

    @staticmethod
    def moments(s):
        across = s.major**2 / 2 + 3 * s.minor**2 / 8
        return np.array([across, across, s.minor**2 / 4])

    @staticmethod
    def extent(s):
        high = np.array([s.major + s.minor, s.major + s.minor, s.minor])
        return -high, high

    @staticmethod
    def depth(s, x, y, z):
        return s.minor - np.hypot(np.hypot(x, y) - s.major, z)

    @staticmethod
    def surface(s, size):
        n = facets(2 * pi * s.minor, size, least=24)
        angle = 2 * pi * np.arange(n) / n
        profile = np.stack([s.major + s.minor * np.cos(angle), s.minor * np.sin(angle)], axis=1)
        return revolve(profile, facets(2 * pi * (s.major + s.minor), size), closed=True)

    @staticmethod
    def radius(s):
        return s.major + s.minor

    @staticmethod
    def vertices(s, h):
        return _around(s.major + s.minor, h) * _around(s.minor, h, 24)


class _Mesh:
    rolls, end = False, "flat"

    @staticmethod
    def volume(s):
        return mesh.load(s).volume

    @staticmethod
    def area(s):
        return mesh.load(s).area

    @staticmethod
    def thickness(s):
        return mesh.load(s).thickness

    @staticmethod
    def moments(s):
        return mesh.second_moments(mesh.load(s))

    @staticmethod
    def extent(s):
        points = mesh.load(s).points
        return points.min(axis=0), points.max(axis=0)

    @staticmethod
    def depth(s, x, y, z):
        points = np.stack(np.broadcast_arrays(x, y, z), axis=-1)
        return mesh.depth(mesh.load(s), points.reshape(-1, 3)).reshape(points.shape[:-1])

    @staticmethod
    def surface(s, size):
        return mesh.refined_surface(mesh.load(s), size)

    @staticmethod
    def radius(s):
        return float(np.linalg.norm(mesh.load(s).points, axis=1).max())

    @staticmethod
    def vertices(s, h):
        return mesh.load(s).area / h**2


FINE = 16
"""Facets along a shape that stand for its surface where that is a sheet."""


@lru_cache(maxsize=256)
def _of_shape(shape) -> shell.ShellSurface:
    low, high = extent(shape)
    return shell.about_middle(*surface(shape, float((high - low).max()) / FINE), True)


def shell_surface(s: kinds.Shell) -> shell.ShellSurface:
    """The surface that is a sheet. Raises mesh.MeshError."""
    return shell.of_file(s.shape) if isinstance(s.shape, kinds.Mesh) else _of_shape(s.shape)


class _Shell:
    """A surface of a thickness."""

    rolls, end = False, "flat"

    @staticmethod
    def volume(s):
        return (shell_surface(s).area if isinstance(s.shape, kinds.Mesh) else area(s.shape)) * s.thickness

    @staticmethod
    def area(s):
        return 2.0 * _Shell.volume(s) / s.thickness

    thickness = staticmethod(lambda s: s.thickness)
    moments = staticmethod(lambda s: shell_surface(s).moments)

    @staticmethod
    def extent(s):
        points, half = shell_surface(s).points, 0.5 * s.thickness
        return points.min(axis=0) - half, points.max(axis=0) + half

    @staticmethod
    def depth(s, x, y, z):
        points = np.stack(np.broadcast_arrays(x, y, z), axis=-1)
        away = mesh.away(shell_surface(s), points.reshape(-1, 3))
        return (0.5 * s.thickness - away).reshape(points.shape[:-1])

    @staticmethod
    def surface(s, size):
        raise TypeError("the surface of a sheet is that of its particles")

    @staticmethod
    def radius(s):
        return float(np.linalg.norm(shell_surface(s).points, axis=1).max()) + 0.5 * s.thickness

    @staticmethod
    def vertices(s, h):
        return _Shell.area(s) / h**2


LAWS: dict[type, Any] = {
    kinds.Box: _Box,
    kinds.Sphere: _Sphere,
    kinds.Ellipsoid: _Ellipsoid,
    kinds.Cylinder: _Cylinder,
    kinds.Cone: _Cone,
    kinds.Torus: _Torus,
    kinds.Mesh: _Mesh,
    kinds.PieceShape: _Mesh,
    kinds.Rope: RopeLaw,
    kinds.Sheet: _Sheet,
    kinds.Shell: _Shell,
}
FORMULAS = ("volume", "area", "thickness", "moments", "extent", "depth", "surface", "radius", "vertices", "rolls", "end")
"""Formulas that each has. ``rolls``: whether it rolls down a slope before it slides; ``end``: the part with which it may land
first, ``flat``, ``round``, or ``pointed``, of few cells; the functions below say what the others are."""


def check_laws() -> None:
    """Raises TypeError where a kind of shape lacks a formula."""
    for kind in get_args(kinds.Shape):
        if lacks := [name for name in FORMULAS if not hasattr(LAWS.get(kind), name)]:
            raise TypeError(f"{kind.__name__} lacks {', '.join(lacks)} in LAWS of model/shapes.py")


check_laws()


def volume(shape: kinds.Shape) -> float:
    """Volume [m^3]. Raises mesh.MeshError for a mesh that encloses none."""
    return LAWS[type(shape)].volume(shape)


def even_mass(solid: kinds.Solid) -> float:
    """Mass of a solid of an even density [kg], by its density where it has one. Raises mesh.MeshError as `volume` does."""
    return solid.mass if solid.mass is not None else solid.density * volume(solid.shape)


def mass(solid: kinds.Solid) -> float:
    """The same with what features add (model/added.py)."""
    from .added import added  # it needs shapes

    more = added(solid)
    return even_mass(solid) if more is None else even_mass(solid) + more.mass


def mended(shape: kinds.Shape) -> str:
    """Changes to the surface of a file, in words; "" where it is as it was, and of other shapes. Raises mesh.MeshError."""
    return mesh.load(shape).mended if isinstance(shape, kinds.Mesh) else ""


def centre_in_file(shape: kinds.Mesh | kinds.Shell) -> np.ndarray:
    """Centre of mass of a mesh, or of its surface as a sheet, as the file has it [m], shape (3,). Raises mesh.MeshError."""
    return mesh.load(shape).centre if isinstance(shape, kinds.Mesh) else shell_surface(shape).centre


def area(shape: kinds.Shape) -> float:
    """Surface area [m^2] in closed form; of a mesh, the sum of its triangles. Raises mesh.MeshError as `volume` does."""
    return LAWS[type(shape)].area(shape)


def thickness(shape: kinds.Shape) -> float:
    """Thickness of the thinnest part [m]; for a mesh an estimate, for a cone the largest ball inside."""
    return LAWS[type(shape)].thickness(shape)


@lru_cache(maxsize=4096)
def radius(shape: kinds.Shape) -> float:
    """Distance of the outermost point from the centre of mass [m]; of a cone slightly more."""
    return LAWS[type(shape)].radius(shape)


@lru_cache(maxsize=4096)
def vertices(shape: kinds.Shape, h: float) -> float:
    """About how many vertices the drawn surface has at a spacing of h [m]."""
    return LAWS[type(shape)].vertices(shape, h)


def second_moments(shape: kinds.Shape) -> np.ndarray:
    """Integral of x x' over the body by its volume, about its centre of mass, body frame [m^2], shape (3, 3).

    In closed form; of a mesh exactly that of its triangles. Raises mesh.MeshError as `volume` does.
    """
    found = np.asarray(LAWS[type(shape)].moments(shape), float)
    return found if found.ndim == 2 else np.diag(found)


def extent(shape: kinds.Shape) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper corner of the bounding box, body frame [m], each of shape (3,)."""
    return LAWS[type(shape)].extent(shape)


def depth(shape: kinds.Shape, points: np.ndarray) -> np.ndarray:
    """Depth of points [m], shape (N, 3), below the surface [m], shape (N,); negative outside.

    The sign is exact. Inside, the value is the distance to the surface (of ellipsoids a lower bound).
    """
    x, y, z = np.asarray(points, float).T
    return LAWS[type(shape)].depth(shape, x, y, z)


def contains(shape: kinds.Shape, points: np.ndarray) -> np.ndarray:
    """Whether points [m], shape (N, 3), are inside, bool, shape (N,)."""
    if isinstance(shape, kinds.Mesh):
        return mesh.contains(mesh.load(shape), points)
    return depth(shape, points) > 0


def fill(shape: kinds.Shape, x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Whether the points of the grid x (nx,), y (ny,), z (nz,) [m] are inside, bool, shape (nz, ny, nx)."""
    if isinstance(shape, kinds.Mesh):
        return mesh.fill(mesh.load(shape), x, y, z)
    return LAWS[type(shape)].depth(shape, x[None, None, :], y[None, :, None], z[:, None, None]) > 0


def surface(shape: kinds.Shape, size: float) -> tuple[np.ndarray, np.ndarray]:
    """Points [m], shape (V, 3), and triangles, int32, shape (T, 3), of a closed surface that faces outward.

    Facets are about ``size`` [m] long, and fine enough to look round.
    """
    return LAWS[type(shape)].surface(shape, size)


def _around(radius: float, h: float, least: int = ROUND) -> int:
    """Vertices around a circle at a spacing of h [m]."""
    return max(least, ceil(2 * pi * radius / h))
