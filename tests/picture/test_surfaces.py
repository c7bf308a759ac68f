# SPDX-License-Identifier: GPL-2.0-only
"""Shaded meshes: crisp where a shape has edges, smooth where it is round, right after any motion."""

from __future__ import annotations

import numpy as np
import pytest
from mdanim_lammps.picture.surfaces import shaded_mesh
from mdanim_lammps.results.trajectory_metadata import metadata_of
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene import scene as records
from mdanim_lammps.scene.parse import parse_scene
from picture_samples import ball, box, slab_scene, solid


def prepared(*models, pixel=None):
    """Mesh and positions of models at rest; a pixel may cover ``pixel`` [m] of each, or of one after the other."""
    scene = records.SceneRecord("s", records.Control(1.0), solids=tuple(solid(m, (0, 0, 0)) for m in models))
    position = np.concatenate([m.position for m in models])
    return shaded_mesh(metadata_of(scene, models), position, pixel and np.full(len(models), pixel)), position


def test_box_keeps_its_edges():
    """All normals of a box are those of its six faces; each corner is there three times."""
    mesh, position = prepared(box("box", (2, 1, 1), (4, 2, 2), (0, 0, 0)))
    vertices = mesh.vertices(position)
    normals = mesh.normals(vertices, position)
    # 26 of the 27 + 18 lattice points lie outside: 6 faces with (5*3, 5*3, 3*3) points each, all apart.
    assert len(vertices) == 2 * (5 * 3 + 5 * 3 + 3 * 3)
    np.testing.assert_allclose(np.abs(normals).max(axis=1), 1.0, rtol=0, atol=1e-12)
    assert (np.einsum("vd,vd->v", normals, vertices) > 0).all()
    assert (np.linalg.norm(vertices - [1.0, 0.5, 0.5], axis=1) < 1e-12).sum() == 3


def test_ball_is_smooth():
    """No vertex of a ball is doubled, and its normals point from the centre."""
    model = ball("ball", 0.5, 0.2, (3, 2, 1))
    mesh, position = prepared(model)
    vertices = mesh.vertices(position)
    assert len(vertices) == len(model.surface.index)
    radial = (vertices - [3, 2, 1]) / 0.5
    np.testing.assert_allclose(np.linalg.norm(radial, axis=1), 1.0, rtol=0, atol=1e-6)  # the sphere's float32
    # Facets of 7.5 degrees, long ones at the poles: their mean at a vertex is off by a quarter of one.
    assert np.einsum("vd,vd->v", mesh.normals(vertices, position), radial).min() > np.cos(np.radians(2.0))


def test_distant_ball_has_fewer_triangles_and_the_same_shading():
    """A ball 25 pixels wide: a closed surface of fewer triangles, whose normals are those of the deformed ball."""
    model = ball("ball", 0.5, 0.1, (0, 0, 0))
    fine, position = prepared(model)
    mesh, _ = prepared(model, pixel=0.04)
    assert len(mesh.coarse) == len(mesh.carry)
    assert len(mesh.triangle) < 0.5 * len(fine.triangle)
    edges = np.sort(np.concatenate([mesh.triangle[:, [0, 1]], mesh.triangle[:, [1, 2]], mesh.triangle[:, [2, 0]]]), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] % 2 == 0).all()
    stretch = np.array([1.3, 0.8, 1.0])
    vertices = mesh.vertices(position * stretch)
    normal = vertices / stretch**2  # of an ellipsoid
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    found = mesh.normals(vertices, position * stretch)
    assert np.einsum("vd,vd->v", found, normal).min() > np.cos(np.radians(2.0))


@pytest.mark.parametrize("pixel", [0.001, 0.04])
def test_what_shows_is_kept(pixel):
    """A ball seen from near keeps all its triangles, a box always."""
    parts = (box("box", (2, 1, 1), (4, 2, 2), (0, 0, 0)), ball("ball", 0.5, 0.2, (3, 2, 1)))[: 1 if pixel > 0.01 else 2]
    fine, _ = prepared(*parts)
    mesh, _ = prepared(*parts, pixel=pixel)
    assert len(mesh.coarse) == 0 and np.array_equal(mesh.triangle, fine.triangle)


@pytest.mark.filterwarnings("error")
def test_one_of_two_balls_is_coarse():
    """Beside a distant ball one of which a pixel covers nothing, as of what is painted, keeps all vertices; no warning."""
    mesh, _ = prepared(ball("far", 0.5, 0.1, (0, 0, 0)), ball("painted", 0.5, 0.1, (2, 0, 0)), pixel=[0.04, 0.0])
    fine, _ = prepared(ball("painted", 0.5, 0.1, (2, 0, 0)))
    assert 0 < len(mesh.coarse) < len(mesh.carry) == len(mesh.coarse) + len(fine.carry)


def test_creases_do_not_depend_on_the_frame():
    """A box bent into an arc keeps the same vertices, and turned bodies have turned normals."""
    mesh, position = prepared(box("box", (2, 1, 1), (4, 2, 2), (0, 0, 0)))
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    before = mesh.normals(mesh.vertices(position), position)
    after = mesh.normals(mesh.vertices(position @ turn.T), position @ turn.T)
    np.testing.assert_allclose(after, before @ turn.T, rtol=0, atol=1e-12)
    bent = position + np.stack([0 * position[:, 0], 0 * position[:, 0], position[:, 0] ** 2], axis=1)
    assert np.isfinite(mesh.normals(mesh.vertices(bent), bent)).all()


def test_many_objects_are_one_mesh():
    """Each vertex belongs to the object that carries it, and equals that object's own surface."""
    _, models = slab_scene()
    mesh, position = prepared(*models)
    moved = position * [1.1, 0.9, 1.0] + [0.3, 0.0, -0.2]
    vertices = mesh.vertices(moved)
    first = 0
    for index, model in enumerate(models):
        own = model.surface.vertices(moved[first : first + len(model.position)])
        mine = vertices[mesh.object_of_vertex == index]
        assert {tuple(v) for v in mine.round(9)} == {tuple(v) for v in own.round(9)}
        first += len(model.position)


@pytest.mark.parametrize("collapsed", [0.0, 1e-300])
def test_flat_triangles_give_no_nan(collapsed):
    """A body pressed to nothing has no normals, and no NaN either."""
    mesh, position = prepared(box("box", (1, 1, 1), (2, 2, 2), (0, 0, 0)))
    assert np.isfinite(mesh.normals(mesh.vertices(position * collapsed), position * collapsed)).all()


def test_a_layer_is_drawn_nearer_to_the_eye():
    """Vertices of a sheet move along their lines of sight by half of its spacing, h/2, so that the edge of a box between its
    particles does not show through; a solid stays."""
    scene = parse_scene(
        "object cloth { shape sheet (1, 0.8) m thickness 1 mm  position (0, 0, 1) m  density 300  elasticity 1 MPa"
        "  resolution 4 cm }\n"
        "object box { shape box (1, 1, 1) m  position (0, 0, 0) m  density 300  elasticity 1 MPa }\ncontrol { time 1 s }\n"
    )
    ready = prepare(scene)
    position, eye = ready.system.position, np.array([1.0, -2.0, 3.0])
    mesh = shaded_mesh(metadata_of(scene, ready.context.system_models), position)
    vertices = mesh.vertices(position)
    way = mesh.seen_from(eye, vertices) - vertices
    cloth = mesh.object_of_vertex == 0
    assert not way[~cloth].any()
    np.testing.assert_allclose(np.linalg.norm(way[cloth], axis=1), 0.5 * ready.system.spacing[0], rtol=0.1)
    assert np.abs(np.cross(way[cloth], eye - vertices[cloth])).max() < 1e-12
