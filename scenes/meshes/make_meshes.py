# SPDX-License-Identifier: GPL-2.0-only
"""Make the meshes of the scenes: duck.ply, a plump bath duck of smoothly joined ellipsoids, contoured and thinned out;
boat.stl, an open hull, and bottle.stl, of rings of points; stone.stl, a wedge of an arch;
barge.stl, a box without a lid; pipe.stl, a spiral pipe, and bowl.stl; hat.stl and lampshade.stl, open surfaces for sheets.

Run ``python make_meshes.py`` in this folder; needs only what mdanim-lammps needs. Units are centimetres.
"""

from pathlib import Path

import numpy as np
import pyvista
from mdanim_lammps.model.tessellate import revolve

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
YELLOW, ORANGE, WHITE, BLACK = (255, 205, 30), (240, 110, 20), (255, 255, 255), (20, 20, 25)
PAINT = (
    # centre (x, y, z) [cm], half axes [cm], colour; the later one covers
    ((5.35, 0.0, 4.05), (1.45, 1.6, 0.95), ORANGE),
    *(((4.35, side * 1.45, 5.35), (0.75, 0.75, 0.85), WHITE) for side in (-1, 1)),
    *(((4.5, side * 1.55, 5.4), (0.5, 0.5, 0.55), BLACK) for side in (-1, 1)),
)
RING = 0.08
"""Width within which one colour becomes another [cm]."""


def duck() -> pyvista.PolyData:
    """The duck as a closed triangle mesh [cm]."""
    step, low, high = 0.14, np.array([-7.0, -5.0, -3.6]), np.array([7.4, 5.0, 7.4])
    counts = ((high - low) / step).astype(int) + 1
    grid = pyvista.ImageData(dimensions=counts, spacing=(step,) * 3, origin=low)
    distance = [_distance(grid.points, np.array(centre), np.array(half)) for centre, half in PARTS]
    # Smooth minimum of all distances: -w log sum exp(-d / w).
    grid["distance"] = -BLEND * np.log(np.exp(-np.stack(distance) / BLEND).sum(axis=0))
    surface = grid.contour([0.0], scalars="distance").triangulate().clean()
    surface = surface.decimate(1 - TRIANGLES / surface.n_cells, volume_preservation=True).clean()
    return painted(surface)


def painted(surface: pyvista.PolyData) -> pyvista.PolyData:
    """The same surface with a colour at each point, cut on both sides of where colours meet."""
    for centre, half, _ in PAINT:
        for outer in (-2 * RING, 0.0, RING):
            surface["way"] = _distance(surface.points, np.array(centre), np.array(half)) - outer
            inside = surface.clip_scalar(scalars="way", value=0.0, both=True)
            surface = inside[0].append_polydata(inside[1]).triangulate().clean(tolerance=1e-6, absolute=True)
    color = np.tile(np.array(YELLOW, dtype=np.uint8), (surface.n_points, 1))
    for centre, half, found in PAINT:
        color[_distance(surface.points, np.array(centre), np.array(half)) < 0.5 * RING] = found
    surface.clear_data()
    surface["RGB"] = color
    return surface


HULL = np.array([60.0, 26.0, 30.0])
"""Half length, half width and depth of the boat [cm]; it points along x and its rim lies at z = 0."""
THICK = 7.0
"""Thickness of its planks [cm]: two cells and more of the boat's scene."""
FULL = 2.5
"""Exponent of its outlines: 2 is an ellipse, more is fuller."""
RINGS, FACETS = 14, 80
"""Of points from the keel to the rim, and points of each."""


def boat() -> pyvista.PolyData:
    """The boat as a closed triangle mesh [cm]: the lower half of a full-bodied ellipsoid, less a smaller one.

    Rings of points from the keel up to the rim, across it, and down inside: the rim is as smooth as its ring.
    """
    down = np.linspace(-np.pi / 2, 0.0, RINGS)
    outer, inner = np.stack([np.cos(down), np.sin(down)], axis=1), np.stack([np.cos(down), np.sin(down)], axis=1)[::-1]
    points, triangles = revolve(np.concatenate([outer, inner]), FACETS)
    half = np.repeat([HULL, HULL - THICK], [(RINGS - 1) * FACETS] * 2, axis=0)
    half = np.concatenate([half, [HULL, HULL - THICK]])  # the poles come last
    # Along each ray of an ellipsoid with these half axes, out to the fuller surface |x/a|^2.5 + |y/b|^2.5 + |z/c|^2.5 = 1.
    points /= (np.abs(points) ** FULL).sum(axis=1, keepdims=True) ** (1 / FULL)
    return pyvista.PolyData.from_regular_faces(points * half, triangles)


BOTTLE = ((0, 0), (10, 0), (10, 20), (6, 27), (6, 34), (2.7, 34), (2.7, 26), (7, 19), (7, 3), (0, 3))
"""Radius and height of the bottle's outline [cm], from the middle of its floor, up outside, over the mouth and down inside."""


def bottle() -> pyvista.PolyData:
    """The bottle as a closed triangle mesh [cm], around its axis along z."""
    points, triangles = revolve(np.array(BOTTLE, dtype=float), FACETS)
    return pyvista.PolyData.from_regular_faces(points, triangles)


STONES, INNER, OUTER, DEEP = 11, 60.0, 80.0, 30.0
"""Stones of half a circle, its radii and its depth [cm]."""


def stone() -> pyvista.PolyData:
    """A stone of the arch as a closed triangle mesh [cm]: its sides point to the origin, its top looks along z."""
    lean = np.tan(np.pi / (2 * STONES))
    low, high = (np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (lean * r, DEEP / 2) for r in (INNER, OUTER))
    points = np.concatenate([np.insert(low, 2, INNER, axis=1), np.insert(high, 2, OUTER, axis=1)])
    return _of_faces(points, [(3, 2, 1, 0), (4, 5, 6, 7), *((k, (k + 1) % 4, (k + 1) % 4 + 4, k + 4) for k in range(4))])


BARGE = np.array([120.0, 60.0, 30.0])
"""Length, width and height of the barge [cm]; its rim lies at z = 0."""
PLANK = 9.0
"""Thickness of its planks [cm]."""


def barge() -> pyvista.PolyData:
    """The barge as a closed triangle mesh [cm]: five planks as a box without a lid, whose ends lean outward."""
    ring = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    half, floor = BARGE[:2] / 2, BARGE[:2] / 2 - (BARGE[2] / 2, 0)
    rings = [(floor, -BARGE[2]), (half, 0.0), (half - PLANK, 0.0), (floor - PLANK / 2 * np.array((1, 2)), PLANK - BARGE[2])]
    points = np.concatenate([np.insert(ring * size, 2, z, axis=1) for size, z in rings])
    sides = [(4 * k + i, 4 * k + (i + 1) % 4, 4 * k + (i + 1) % 4 + 4, 4 * k + i + 4) for k in range(3) for i in range(4)]
    return _of_faces(points, [(3, 2, 1, 0), *sides, (12, 13, 14, 15)])


SPIRAL, DROP, TURNS = 15.0, 8.0, 2.25
"""Radius of the middle of the pipe about z, how far it comes down in a turn [cm], and its turns."""
PIPE = 2.0, 2.3
"""Radii of the pipe inside and outside [cm]."""


def pipe() -> pyvista.PolyData:
    """A pipe that winds down about z from (SPIRAL, 0, 0), as a closed triangle mesh [cm]."""
    along, across = 81, 18
    t, a = np.linspace(0, 2 * np.pi * TURNS, along), 2 * np.pi * np.arange(across) / across
    out = np.stack([np.cos(t), np.sin(t), 0 * t], axis=1)
    middle = SPIRAL * out - np.outer(DROP * t / (2 * np.pi), (0, 0, 1))
    way = np.stack([-SPIRAL * np.sin(t), SPIRAL * np.cos(t), np.full(along, -DROP / (2 * np.pi))], axis=1)
    up = np.cross(out, way / np.linalg.norm(way, axis=1)[:, None])
    circle = np.cos(a)[:, None] * out[:, None] + np.sin(a)[:, None] * up[:, None]
    rows = np.concatenate([middle[:, None] + PIPE[1] * circle, (middle[:, None] + PIPE[0] * circle)[::-1]])
    at = np.arange(rows[..., 0].size).reshape(rows.shape[:2])
    last, right = np.roll(at, -1, axis=0), np.roll(at, -1, axis=1)
    corner = np.roll(last, -1, axis=1)
    quads = np.stack([at, last, corner, right], axis=-1).reshape(-1, 4)
    return _of_faces(rows.reshape(-1, 3), quads)


BOWL, THICK, RIM = 30.0, 1.0, 0.75
"""Radius of the inside of the bowl and its thickness [cm]; the angle of its rim [rad]."""


def bowl() -> pyvista.PolyData:
    """A part of a hollow ball whose inside begins at the origin, as a closed triangle mesh [cm]."""
    angle = np.linspace(0, RIM, 13)
    inside = np.stack([BOWL * np.sin(angle), BOWL * (1 - np.cos(angle))], axis=1)
    outside = np.stack([(BOWL + THICK) * np.sin(angle), BOWL - (BOWL + THICK) * np.cos(angle)], axis=1)
    points, triangles = revolve(np.concatenate([outside, inside[::-1]]), 48)
    return pyvista.PolyData.from_regular_faces(points, triangles)


HAT = ((20, 0), (16, 0.5), (12, 1), (11, 4), (10.5, 8), (9, 11), (6, 12.5), (3, 13), (0, 13.1))
LAMPSHADE = ((15, 0), (14, 5), (12, 10), (10, 15), (8, 20))
"""Radius and height of their outlines [cm], from the border up."""


def hat() -> pyvista.PolyData:
    """A hat with a brim as a triangle mesh with one border [cm]."""
    return _turned(HAT)


def lampshade() -> pyvista.PolyData:
    """A lampshade, open above and below [cm]."""
    return _turned(LAMPSHADE)


def _turned(outline: tuple[tuple[float, float], ...], count: int = 32) -> pyvista.PolyData:
    """An open surface around the axis z, outward; an outline may end on the axis."""
    turn = np.arange(count) * (2.0 * np.pi / count)
    rings = [r for r in outline if r[0] > 0]
    points = [(r * np.cos(a), r * np.sin(a), z) for r, z in rings for a in turn]
    faces = []
    for low in range(0, (len(rings) - 1) * count, count):
        for n in range(count):
            a, b = low + n, low + (n + 1) % count
            faces += [(a, b, b + count), (a, b + count, a + count)]
    if outline[-1][0] == 0:
        last = len(points) - count
        points.append((0.0, 0.0, outline[-1][1]))
        faces += [(last + n, last + (n + 1) % count, last + count) for n in range(count)]
    return pyvista.PolyData.from_regular_faces(np.array(points), faces)


def _of_faces(points: np.ndarray, faces: list[tuple[int, ...]]) -> pyvista.PolyData:
    """A triangle mesh of faces of four corners."""
    return pyvista.PolyData.from_regular_faces(points, [(a, b, c) for a, b, c, _ in faces] + [(a, c, d) for a, _, c, d in faces])


def _distance(points: np.ndarray, centre: np.ndarray, half: np.ndarray) -> np.ndarray:
    """Distance to an ellipsoid to first order: f (f - 1) / |grad|, with f = |(p - c) / half|."""
    q = (points - centre) / half
    f = np.linalg.norm(q, axis=1)
    return f * (f - 1) / np.linalg.norm(q / half, axis=1).clip(1e-6)


if __name__ == "__main__":
    for make in (duck, boat, bottle, stone, barge, pipe, bowl, hat, lampshade):
        mesh = make()
        colored = "RGB" in mesh.point_data
        path = Path(__file__).with_name(make.__name__ + (".ply" if colored else ".stl"))
        mesh.save(path, binary=True, texture="RGB" if colored else None)
        size = path.stat().st_size
        print(f"{path.name}: {mesh.n_cells} triangles, open edges {mesh.n_open_edges}, {size} bytes")
