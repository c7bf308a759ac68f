# SPDX-License-Identifier: GPL-2.0-only
"""Thickness of meshes: tips and edges do not count, thin parts do; what is made of a mesh is the same at every size."""

from pathlib import Path

import numpy as np
import pytest
from mdanim_lammps.model import mesh, shapes
from mdanim_lammps.model.distance import grid_distance
from mdanim_lammps.model.nearest import BLOCK, Nearest
from mdanim_lammps.model.spacing import plan_spacing
from mdanim_lammps.scene.parse import load_scene
from mdanim_lammps.scene.scene import Box, Cone, Cylinder, Ellipsoid, Mesh, Sphere, Torus
from model_samples import MESHES

REGULAR = (
    np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]) / 8**0.5,
    np.array([(0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2)]),
)
"""A regular tetrahedron with edges of 1: the largest ball inside has a diameter of 1 / 6^0.5."""


def saved(path: Path, points: np.ndarray, triangles: np.ndarray) -> Path:
    import pyvista

    pyvista.PolyData.from_regular_faces(points, triangles).save(path)
    return path


@pytest.mark.parametrize(
    ("shape", "off"),
    [
        # Facets lie below the true surface, by 1 - cos(pi / 48) = 0.2 %; a ball stops where it grows by less than SLOPE.
        (Sphere(0.5), 0.01),
        (Box((1.0, 0.5, 0.3)), 0.001),
        (Cylinder(0.1, 1.0), 0.01),
        (Torus(0.5, 0.1), 0.02),
        (Ellipsoid((0.5, 0.3, 0.1)), 0.02),
        (Cone(0.5, 0.5), 0.08),
        (Cone(0.5, 1.0), 0.08),
        (Cone(0.1, 1.0), 0.08),
    ],
    ids=lambda x: type(x).__name__ + str(getattr(x, "height", "")) if not isinstance(x, float) else "",
)
def test_a_mesh_is_as_thick_as_the_shape_that_it_draws(tmp_path, shape, off):
    """At two scales; for cones and ellipsoids rays alone find an eighth to a half of it, at their edges and tips."""
    path = saved(tmp_path / "drawn.stl", *shapes.surface(shape, 0.2))
    for scale in (1e-3, 1e3):
        assert shapes.thickness(Mesh(path, scale)) == pytest.approx(scale * shapes.thickness(shape), rel=off)


def test_a_tetrahedron_of_four_triangles_is_as_thick_as_the_ball_inside(tmp_path):
    path = saved(tmp_path / "tetrahedron.stl", *REGULAR)
    assert shapes.thickness(Mesh(path)) == pytest.approx(6**-0.5, rel=0.1)


def test_a_scene_with_a_tetrahedron_is_small(tmp_path):
    """One that is 30 cm high, of 4 cells across: a few hundred particles, where tips asked for 159 000."""
    saved(
        tmp_path / "tet.stl",
        np.concatenate([np.zeros((1, 3)), np.eye(3)]),
        np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]),
    )
    (tmp_path / "s.txt").write_text(
        'object a { shape mesh "tet.stl" scale 0.3  position (0, 0, 0.5) m  density 500 elasticity 1 MPa } control { time 0.1 s }'
    )
    assert 100 < plan_spacing(load_scene(tmp_path / "s.txt")).total < 1000


def test_thin_parts_count_beside_thick_ones(tmp_path):
    """A ball of 1 m on a rod of 10 cm, which has a seventh of the surface, beside a cone whose tip has no thickness."""
    path = tmp_path / "parts.stl"
    parts = [shapes.surface(s, 0.2) for s in (Sphere(0.5), Cylinder(0.05, 2.0), Cone(0.3, 0.6))]
    points = np.concatenate([p + (2.0 * i, 0.0, 0.0) for i, (p, _) in enumerate(parts)])
    first = np.cumsum([0, *(len(p) for p, _ in parts)])
    saved(path, points, np.concatenate([t + at for (_, t), at in zip(parts, first)]))
    assert shapes.thickness(Mesh(path)) == pytest.approx(0.1, rel=0.01)


@pytest.mark.parametrize("scale", [1e-6, 1e3, 1e6])
def test_a_surface_is_divided_alike_at_every_scale(scale):
    """Triangles are as many in a file that is read in micrometres as in one of kilometres."""
    one, other = (mesh.refined_surface(mesh.load(Mesh(MESHES / "cuboid.obj", s)), 0.3 * s) for s in (1.0, scale))
    np.testing.assert_array_equal(one[1], other[1])
    np.testing.assert_allclose(one[0], other[0] / scale, atol=1e-6)


def test_distances_far_from_a_flat_side(tmp_path):
    """42 cells from end to end: exact within two cells, and no further off than 5 % beyond."""
    body = Mesh(saved(tmp_path / "tetrahedron.stl", *REGULAR), 60.0)
    axes = [np.arange(low - 3.3, high + 3.3) for low, high in zip(*shapes.extent(body))]
    found = grid_distance(body, *axes).ravel()
    points = np.stack(np.meshgrid(*axes[::-1], indexing="ij")[::-1], axis=-1).reshape(-1, 3)
    corner = mesh.load(body).points[mesh.load(body).triangles]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    below = ((corner[:, 0] * normal).sum(axis=1) - points @ normal.T).min(axis=1)
    inside = below > 0
    np.testing.assert_array_equal(found > 0, inside)
    np.testing.assert_allclose(found[inside], below[inside], rtol=0.05)
    near = inside & (below < 2)
    np.testing.assert_allclose(found[near], below[near], atol=1e-6)
    assert np.count_nonzero(inside & (below > 6)) > 20


def test_the_nearest_of_many():
    """More points than a block has, against one call of the tree; none within reach is told as such."""
    from scipy.spatial import cKDTree

    rng = np.random.default_rng(6)
    places, points = rng.random((500, 3)), rng.random((2 * BLOCK + 7, 3))
    for count, within in ((1, np.inf), (4, 0.05)):
        for ours, theirs in zip(
            Nearest(places)(points, count, within=within), cKDTree(places).query(points, count, distance_upper_bound=within)
        ):
            np.testing.assert_array_equal(ours, theirs)
