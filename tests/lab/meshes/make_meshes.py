# SPDX-License-Identifier: GPL-2.0-only
"""Make the mesh files of the tests: python make_meshes.py"""

from pathlib import Path

import numpy as np
import pyvista

HERE = Path(__file__).parent


def write_obj(name, points, faces):
    """A text mesh; faces count from 0 here."""
    lines = [f"v {x:g} {y:g} {z:g}" for x, y, z in points]
    lines += ["f " + " ".join(str(i + 1) for i in f) for f in faces]
    (HERE / name).write_text("\n".join(lines) + "\n", encoding="utf-8")


def cuboid(low, high):
    """Corners and triangles of a cuboid, facing outward."""
    corners = [(x, y, z) for z in (low[2], high[2]) for y in (low[1], high[1]) for x in (low[0], high[0])]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return corners, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]


if __name__ == "__main__":
    points, faces = cuboid((0, 0, 0), (4, 3, 2))
    write_obj("cuboid.obj", points, faces)
    write_obj("open.obj", points, faces[:-1])
    write_obj("inside-out.obj", points, [f[::-1] for f in faces])
    write_obj("mixed.obj", points, [f[::-1] if k % 3 == 0 else f for k, f in enumerate(faces)])
    more, other = cuboid((6, 0, 0), (8, 3, 2))
    write_obj("two-parts.obj", points + more, faces + [tuple(i + 8 for i in f) for f in other])
    write_obj("fin.obj", [*points, (5, 5, 5)], [*faces, (0, 1, 8)])
    # Two blocks joined by a neck of 0.2 that runs beside the middle, where rows of coarse cells miss it.
    outline = [(0, 0), (3, 0), (3, 1.6), (4.3, 1.6), (4.3, 0), (7.3, 0), (7.3, 3), (4.3, 3), (4.3, 1.8), (3, 1.8), (3, 3), (0, 3)]
    n = len(outline)
    sides = [(k, (k + 1) % n, n + (k + 1) % n, n + k) for k in range(n)]
    ends = [tuple(range(n))[::-1], tuple(range(n, 2 * n))]
    corners = [(*p, z) for z in (0, 3) for p in outline]
    write_obj("dumbbell.obj", corners, [*ends, *sides])
    # The same with a triangle of no area, at an edge.
    middle = 2 * n
    split = [(0, 1, middle), (0, middle, n), (middle, 1, n + 1), (middle, n + 1, n)]
    write_obj("sliver.obj", [*corners, (1.5, 0, 0)], [*ends, *split, *sides[1:]])
    u = np.linspace(0, 2 * np.pi, 90, endpoint=False)
    x, y, z = np.sin(u) + 2 * np.sin(2 * u), np.cos(u) - 2 * np.cos(2 * u), -np.sin(3 * u)
    centre = np.stack([x, y, z], axis=1) * 20
    tangent = np.roll(centre, -1, 0) - np.roll(centre, 1, 0)
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    side = np.cross(tangent, (0.0, 0.0, 1.0))
    side /= np.linalg.norm(side, axis=1)[:, None]
    up = np.cross(side, tangent)
    v = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    tube = centre[:, None] + 8 * (np.cos(v)[:, None] * side[:, None] + np.sin(v)[:, None] * up[:, None])
    i, j = np.meshgrid(np.arange(90), np.arange(12), indexing="ij")

    def at(i, j):
        return (i % 90) * 12 + j % 12

    quads = np.stack([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)], axis=-1).reshape(-1, 4)
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    pyvista.PolyData.from_regular_faces(tube.reshape(-1, 3), faces).save(HERE / "knot.ply")
