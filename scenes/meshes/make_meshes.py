# SPDX-License-Identifier: GPL-2.0-only
"""Make the meshes of the scenes: duck.stl, a plump bath duck of smoothly joined ellipsoids, and boat.stl, an open hull;
contoured and thinned out to small closed meshes.

Run ``python make_meshes.py`` in this folder; needs only what mdanim-lammps needs. Units are centimetres.
"""

from pathlib import Path

import numpy as np
import pyvista

PARTS = (
    # centre (x, y, z) [cm], half axes [cm]; the duck looks along +x and is 12 cm long
    ((0.0, 0.0, 0.0), (5.0, 3.7, 2.9)),  # body
    ((2.6, 0.0, 4.5), (2.5, 2.3, 2.3)),  # head
    ((1.9, 0.0, 2.6), (1.9, 1.8, 1.8)),  # neck
    ((5.1, 0.0, 4.1), (1.3, 1.2, 0.75)),  # beak
    ((-4.7, 0.0, 1.5), (1.7, 1.5, 1.1)),  # tail
    ((-0.8, 3.0, 0.6), (2.6, 1.1, 1.5)),  # wings
    ((-0.8, -3.0, 0.6), (2.6, 1.1, 1.5)),
)
BLEND = 0.35
"""Width of the fillet between two parts [cm]."""
TRIANGLES = 4000


def duck() -> pyvista.PolyData:
    """The duck as a closed triangle mesh [cm]."""
    step, low, high = 0.14, np.array([-7.0, -5.0, -3.6]), np.array([7.4, 5.0, 7.4])
    counts = ((high - low) / step).astype(int) + 1
    grid = pyvista.ImageData(dimensions=counts, spacing=(step,) * 3, origin=low)
    distance = [_distance(grid.points, np.array(centre), np.array(half)) for centre, half in PARTS]
    # Smooth minimum of all distances: -w log sum exp(-d / w).
    grid["distance"] = -BLEND * np.log(np.exp(-np.stack(distance) / BLEND).sum(axis=0))
    surface = grid.contour([0.0], scalars="distance").triangulate().clean()
    return surface.decimate(1 - TRIANGLES / surface.n_cells, volume_preservation=True).clean()


HULL = np.array([60.0, 26.0, 30.0])
"""Half length, half width and depth of the boat [cm]; it points along x and its rim lies at z = 0."""
THICK = 7.0
"""Thickness of its planks [cm]: two cells and more of the boat's scene."""


def boat() -> pyvista.PolyData:
    """The boat as a closed triangle mesh [cm]: the lower half of a full-bodied ellipsoid, less a smaller one."""
    step, low, high = 1.0, np.array([-63.0, -29.0, -33.0]), np.array([63.0, 29.0, 3.0])
    counts = ((high - low) / step).astype(int) + 1
    grid = pyvista.ImageData(dimensions=counts, spacing=(step,) * 3, origin=low)
    outer, inner = (_superellipsoid(grid.points, half) for half in (HULL, HULL - THICK))
    grid["distance"] = np.max([outer, -inner, grid.points[:, 2]], axis=0)
    surface = grid.contour([0.0], scalars="distance").triangulate().clean()
    return surface.decimate(1 - TRIANGLES / surface.n_cells, volume_preservation=True).clean()


def _superellipsoid(points: np.ndarray, half: np.ndarray) -> np.ndarray:
    """About the distance to the surface |x/a|^2.5 + |y/b|^2.5 + |z/c|^2.5 = 1: fuller than an ellipsoid."""
    f = (np.abs(points / half) ** 2.5).sum(axis=1) ** 0.4
    return (f - 1) * half.min()


def _distance(points: np.ndarray, centre: np.ndarray, half: np.ndarray) -> np.ndarray:
    """Distance to an ellipsoid to first order: f (f - 1) / |grad|, with f = |(p - c) / half|."""
    q = (points - centre) / half
    f = np.linalg.norm(q, axis=1)
    return f * (f - 1) / np.linalg.norm(q / half, axis=1).clip(1e-6)


if __name__ == "__main__":
    for make in (duck, boat):
        mesh = make()
        path = Path(__file__).with_name(f"{make.__name__}.stl")
        mesh.save(path, binary=True)
        size = path.stat().st_size
        print(f"{path.name}: {mesh.n_cells} triangles, open edges {mesh.n_open_edges}, {size} bytes")
