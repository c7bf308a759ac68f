# SPDX-License-Identifier: GPL-2.0-only
"""Meshes touch the ground: convex ones with rounded coordinates, nearly flat faces or tiny edges; others by their hulls."""

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.features.rigid.touching import STEP, omega
from mdanim_lammps.model.polyhedron import hull, polyhedron
from model_samples import rotation
from paths import SCENES
from scipy.spatial import ConvexHull

SCENE = """gravity (0, 0, -9.81) m/s^2
ground z 0 m
object it {{ shape mesh "{name}" scale 1  position (0, 0, {z!r}) m  density 1000  elasticity rigid }}
control {{ time 0.02 s  frames 100 fps }}
"""
EDGE = 0.1
CUBE = EDGE * (np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]) - 0.5)


def outward(points):
    """Triangles of a hull, counter-clockwise from outside."""
    hull = ConvexHull(points)
    corner = points[hull.simplices]
    turned = (np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]) * hull.equations[:, :3]).sum(axis=1) < 0
    return np.where(turned[:, None], hull.simplices[:, ::-1], hull.simplices)


TRIANGLES = outward(CUBE)


def raised(part):
    """A cube, one diagonal of its top raised, in parts of its edge."""
    return CUBE + np.array([(0, 0, part * EDGE * (k in (4, 7))) for k in range(8)]), None


def cut(length):
    """A cube without one corner."""
    return np.concatenate([CUBE[:7], CUBE[7] - length * np.eye(3)]), None


def drum(corners, digits):
    """A turned prism, written with some digits, or as float32 where 0; its top and bottom have many triangles."""
    angle = 2 * np.pi * np.arange(corners) / corners
    ring = 0.06 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points = (
        np.concatenate([np.column_stack([ring, np.full(corners, z)]) for z in (-0.04, 0.04)])
        @ np.array(rotation(0.3, -0.7, 1.1)).T
    )
    k = np.arange(corners - 2)
    top = np.column_stack([0 * k, k + 1, k + 2])
    n, m = np.arange(corners), np.roll(np.arange(corners), -1)
    sides = [np.column_stack([n, m, m + corners]), np.column_stack([n, m + corners, n + corners])]
    triangles = np.concatenate([top + corners, top[:, ::-1], *sides])
    return (np.float32(points).astype(float) if not digits else np.round(points, digits)), triangles


def halved(digits):
    """A turned cube with a corner in the middle of each edge and side, rounded."""
    points = EDGE * np.array([(x, y, z) for z in (-0.5, 0, 0.5) for y in (-0.5, 0, 0.5) for x in (-0.5, 0, 0.5)])
    at, triangles = np.arange(27).reshape(3, 3, 3), []
    for axis in range(3):
        for end in (0, 2):
            side = np.take(at, end, axis=axis)
            quads = [(side[i, j], side[i, j + 1], side[i + 1, j + 1], side[i + 1, j]) for i in (0, 1) for j in (0, 1)]
            for a, b, c, d in quads:
                for t in ((a, b, c), (a, c, d)):
                    p, q, r = points[list(t)]
                    triangles.append(t if np.cross(q - p, r - p) @ p > 0 else t[::-1])
    return np.round(points @ np.array(rotation(0.3, -0.7, 1.1)).T, digits), np.array(triangles)


BODIES = {
    **{f"raised by {part:g}": (raised(part), 6) for part in (1e-9, 1e-8, 1e-7, 1e-6)},
    "raised by 1e-5": (raised(1e-5), None),
    "raised by 1e-3": (raised(1e-3), 7),
    "cut by 0.1 um": (cut(1e-7), 6),
    "cut by 1 um": (cut(1e-6), None),
    "cut by 1 mm": (cut(1e-3), 7),
    "drum of 12, 7 digits": (drum(12, 7), 14),
    "drum of 30, float32": (drum(30, 0), 32),
    "drum of 5, exact": (drum(5, 17), 7),
    "halved cube, 7 digits": (halved(7), 6),
    "halved cube, 8 digits": (halved(8), 6),
}
"""Points, triangles or None for those of the hull, and the faces that the fix is told; None where it touches at points."""


@pytest.mark.parametrize("name", BODIES)
def test_nearly_flat_meshes_run(prepared, tmp_path, name):
    """The fix refuses faces at less than 4.5e-5 rad, without an area, and corners before a face. Its message is of a temporary
    table, so what it is told has none of these: faces and corners are merged up to 1e-6 of the size, what is left is no
    polyhedron. Each body lies on the ground, sinks in by 1 % at most, and does not jump; those on a corner begin to turn."""
    (points, triangles), faces = BODIES[name]
    triangles = outward(points) if triangles is None else triangles
    rows = [f"v {x!r} {y!r} {z!r}\n" for x, y, z in points.tolist()] + [
        f"f {a} {b} {c}\n" for a, b, c in (triangles + 1).tolist()
    ]
    (tmp_path / "it.obj").write_text("".join(rows))
    centre = 1e-4 - points[:, 2].min()
    ready = prepared(SCENE.format(name="it.obj", z=float(centre)))
    found = polyhedron(ready.scene.solids[0].shape)
    assert (found and len(found.faces)) == faces
    if faces:
        sides = sum(map(len, found.faces))
        assert len(found.corner) - sides // 2 + len(found.faces) == 2  # Euler
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(ready.certificate.steps)
        x = instance.array("x")
        centre = ready.system.center_of_mass(x)[0, 2] - ready.system.center_of_mass(ready.system.position)[0, 2]
        model = ready.models[0]
        assert model.surface.vertices(x)[:, 2].min() > -0.01 * EDGE and -0.01 * EDGE < centre < 1e-5  # it fell 0.1 mm: a tenth


def test_planes_touch_the_hull_of_a_concave_mesh(prepared):
    """A box without a lid falls by 1 cm on its edge, tips over and lies: by eight corners, in steps that features allow.
    At points of its surface it took 90 times as many."""
    text = f"""gravity (0, 0, -9.81) m/s^2
    ground z 0 m
    object barge {{ shape mesh "{SCENES}/meshes/barge.stl" scale 0.01  position (0, 0, 0.35) m
      orientation euler (10, 20, 0) deg  density 400  elasticity rigid }}
    control {{ time 1.5 s  friction 0.5 }}
    """
    ready = prepared(text)
    whole = hull(ready.scene.solids[0].shape)
    assert len(whole.corner) == 8 and len(whole.faces) == 6 and polyhedron(ready.scene.solids[0].shape) is None
    assert ready.certificate.timestep > 0.9 * STEP / omega(ready.context) and not ready.warnings
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(ready.certificate.steps)
        centre = ready.system.center_of_mass(instance.array("x"))[0, 2]
    assert centre == pytest.approx(-whole.corner[:, 2].min(), abs=1e-3)
