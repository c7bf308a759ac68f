# SPDX-License-Identifier: GPL-2.0-only
"""Which side of a surface is outside: points [m] (V, 3), triangles (T, 3)."""

from __future__ import annotations

import numpy as np

from .boxes import box_pairs
from .crossings import crossings
from .triangles import connected, edge_keys, surface_of, volume_and_centre

LINES = 64
"""Lines along x and along y that look for what is enclosed twice."""
CROSSED = 0.01
"""Part of the inside that may be: volume and mass count it twice, and cells leave it out."""


CLOSE = "write solid in place of mesh to have all that it encloses"
FLAT = "write sheet thickness 1 mm behind it to have its surface as a sheet, mesh in place of solid, or export a body"


class MeshError(Exception):
    """A mesh file that cannot become a solid; ``hint`` says how to correct it."""

    def __init__(self, message: str, hint: str):
        super().__init__(message)
        self.hint = hint


def outward(points: np.ndarray, triangles: np.ndarray, name: str) -> np.ndarray:
    """Turn triangles so that all face outward, whichever way they faced. A closed part inside another one is a cavity, a part
    inside a cavity is solid again. Raise MeshError where the surface is not closed, and where its parts cross each other."""
    _, uses = np.unique(edge_keys(triangles), return_counts=True)
    if (uses == 1).any():
        raise MeshError(
            f"mesh {name}: not closed, {np.count_nonzero(uses == 1)} edges belong to one triangle only",
            f"{CLOSE}; or fill its holes in a mesh editor (Blender: Select > Non Manifold, then Fill)",
        )
    if (uses > 2).any():
        raise MeshError(
            f"mesh {name}: {np.count_nonzero(uses > 2)} edges belong to more than two triangles",
            f"{CLOSE}; or remove inner faces and doubled triangles in a mesh editor",
        )
    if not _consistent(triangles):
        triangles = _reorient(points, triangles)
    if not _consistent(triangles):
        raise MeshError(f"mesh {name}: has no inside and outside", f"{CLOSE}; a one-sided surface has no inside")
    triangles = _turned_by_part(points, triangles, np.ones(len(triangles), bool), True)
    volume, _ = volume_and_centre(points, triangles)
    if volume <= 1e-9 * np.ptp(points, axis=0).max() ** 3:
        raise MeshError(f"mesh {name}: encloses no volume", FLAT)
    if (twice := _enclosed_twice(points, triangles)) > CROSSED:
        raise MeshError(
            f"mesh {name}: its surface crosses itself, {100 * twice:.0f} % of the inside is enclosed more than once",
            f"{CLOSE}; or write an object for each part",
        )
    return triangles


def parts_outward(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Turn the triangles of closed parts outward, of parts that may cross. One that lies inside of an odd number of others stays
    as it is, and so does one with a gap."""
    edge, uses = np.unique(edge_keys(triangles), return_inverse=True, return_counts=True)[1:]
    open_ = (uses[edge.reshape(-1, 3)] != 2).any(axis=1)
    return _turned_by_part(points, triangles, ~open_, False)


def _turned_by_part(points: np.ndarray, triangles: np.ndarray, closed: np.ndarray, cavities: bool) -> np.ndarray:
    """The triangles of each connected part that is ``closed``, bool, shape (T,), turned: outward, where the part lies inside an
    odd number of others inward for ``cavities``, else as it is."""
    part = connected(triangles)
    parts = np.split(np.argsort(part, kind="stable"), np.cumsum(np.bincount(part))[:-1])
    parts = [rows for rows in parts if closed[rows].all()]
    turned = triangles.copy()
    inside = _depths(points, [triangles[rows] for rows in parts]) % 2 == 1
    for rows, within in zip(parts, inside):
        volume, _ = volume_and_centre(points, triangles[rows])
        if (volume > 0) == within and (cavities or not within):
            turned[rows] = turned[rows, ::-1]
    return turned


def _depths(points: np.ndarray, parts: list[np.ndarray]) -> np.ndarray:
    """In how many other parts each part lies, by its first point, int, shape (K,)."""
    depth = np.zeros(len(parts), int)
    if len(parts) < 2:
        return depth
    low, high = (np.array([f(points[p].reshape(-1, 3), axis=0) for p in parts]) for f in (np.min, np.max))
    first = points[[p[0, 0] for p in parts]]
    for i, j in box_pairs(low, high):
        for inner, outer in ((i, j), (j, i)):
            within = ((low[inner] >= low[outer]) & (high[inner] <= high[outer])).all(axis=1)
            for host in np.unique(outer[within]):
                guest, below = inner[within & (outer == host)], np.zeros(len(parts), int)
                for line, z, _ in crossings(points, parts[host], first[guest, :2]):
                    below[guest] += np.bincount(line[z < first[guest][line, 2]], minlength=len(guest))
                depth += below % 2
    return depth


def _enclosed_twice(points: np.ndarray, triangles: np.ndarray) -> float:
    """Part of what vertical lines have inside that is not enclosed exactly once [-]."""
    low, high = points.min(axis=0), points.max(axis=0)
    x, y = (a + (b - a) * (np.arange(LINES) + 0.5) / LINES for a, b in zip(low[:2], high[:2]))
    lines = np.stack([np.tile(x, LINES), np.repeat(y, LINES)], axis=1)
    found = list(crossings(points, triangles, lines))
    if not found:
        return 0.0  # so thin that no line meets it
    line, height, leaves = (np.concatenate(column) for column in zip(*found))
    order = np.lexsort((height, line))
    line, height = line[order], height[order]
    level = np.cumsum(np.where(leaves[order], -1, 1))  # 0 at the end of each line, as the surface is closed
    length = np.where(line[1:] == line[:-1], np.diff(height), 0.0)
    return float(length[(level[:-1] != 0) & (level[:-1] != 1)].sum() / max(length[level[:-1] != 0].sum(), np.finfo(float).tiny))


def _consistent(triangles: np.ndarray) -> bool:
    """Whether neighbours run along their common edge in opposite directions."""
    edge = edge_keys(triangles, directed=True)
    return len(np.unique(edge)) == len(edge)


def _reorient(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    import pyvista

    surface = pyvista.PolyData.from_regular_faces(points, triangles).compute_normals(
        consistent_normals=True, auto_orient_normals=True, split_vertices=False, non_manifold_traversal=False
    )
    return surface_of(surface)[1]
