# SPDX-License-Identifier: GPL-2.0-only
"""Solids that surfaces with faults mean, at their default grid, and the winding number that decides what is inside."""

import numpy as np
import pytest
from mdanim_lammps import Scene, SceneError
from mdanim_lammps.model import shapes, winding
from mdanim_lammps.model.orientation import MeshError, outward
from mdanim_lammps.model.solid import solid
from mdanim_lammps.model.triangles import volume_and_centre
from mdanim_lammps.scene.scene import Box, Mesh, Sphere
from mesh_samples import joined


def ball() -> tuple[np.ndarray, np.ndarray]:
    """A ball of radius 1 m."""
    return shapes.surface(Sphere(1.0), 0.1)


def solid_angles(points, triangles, places) -> np.ndarray:
    """The winding number as the sum of solid angles of all triangles over 4 pi (van Oosterom and Strackee 1983)."""
    total = np.zeros(len(places))
    for corners in points[triangles]:
        a, b, c = (corners[k] - places for k in range(3))
        la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
        dot = lambda u, v: np.einsum("ij,ij->i", u, v)
        below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb
        total += 2.0 * np.arctan2(dot(a, np.cross(b, c)), below)
    return total / (4.0 * np.pi)


def test_winding_number_is_the_solid_angle():
    """A ball with a third of its triangles, at all nodes more than two cells from them."""
    points, triangles = ball()
    open_ = triangles[points[triangles].mean(axis=1)[:, 2] < -0.3]
    size = np.array([40, 41, 42])
    points = points * 12 + 20.0
    found = winding.winding_number(points, open_, size)
    nodes = np.stack(np.meshgrid(*map(np.arange, size), indexing="ij"), axis=-1).reshape(-1, 3)[::17].astype(float)
    away = np.array([np.linalg.norm(points[np.unique(open_)] - node, axis=1).min() for node in nodes])
    far = away > 3.0
    exact = solid_angles(points, open_, nodes[far])
    # Two cells from a surface a layer of dipoles a cell apart is even to exp(-4 pi) or 4e-6; the rest is the weights.
    assert np.abs(found[tuple(nodes[far].astype(int).T)] - exact).max() < 3e-3
    assert exact.max() > 0.4 and exact.min() < 1e-2


def test_what_is_closed_stays_to_the_bit():
    """Nothing was done."""
    points, triangles = ball()
    same, around, told = solid(points, triangles, "ball")
    assert np.array_equal(same, points) and np.array_equal(around, outward(points, triangles, "ball")) and told == ""


def test_a_gap_is_filled_flat():
    """A box without its upper side is the box, with its corners."""
    points, triangles = shapes.surface(Box((1.0, 2.0, 3.0)), 10.0)
    open_ = triangles[points[triangles][:, :, 2].min(axis=1) < 1.4]
    found, around, told = solid(points, open_, "box")
    assert len(open_) < len(triangles) and told == "1 gap is closed"
    assert volume_and_centre(found, around)[0] == pytest.approx(6.0, rel=1e-6)


def faces_inside_out(points, triangles):
    """Every third triangle."""
    turned = triangles.copy()
    turned[::3] = turned[::3, ::-1]
    return points, turned


def doubled(points, triangles):
    """Each triangle both ways, as programs write that draw both sides."""
    return points, np.concatenate([triangles, triangles[:, ::-1]])


def crossing(points, triangles):
    """A ball of 1 and one of 0.8 whose centres are 1 apart: the union by the lens's closed form."""
    return joined([(Sphere(1.0), (0, 0, 0), False), (Sphere(0.8), (1.0, 0, 0), False)])


def crossing_inside_out(points, triangles):
    """The same, the second one of which faces inward: what both have is inside all the same."""
    return joined([(Sphere(1.0), (0, 0, 0), False), (Sphere(0.8), (1.0, 0, 0), True)])


def crossing_with_a_cavity(points, triangles):
    """The same, and a ball of 0.3 inside the first one that faces inward."""
    cavity = (Sphere(0.3), (-0.5, 0, 0), True)
    return joined([(Sphere(1.0), (0, 0, 0), False), (Sphere(0.8), (1.0, 0, 0), False), cavity])


def apart(points, triangles):
    """No triangle shares a point with another, and all have shrunk by a hundredth: gaps along all edges."""
    corners = points[triangles]
    middle = corners.mean(axis=1, keepdims=True)
    return (middle + 0.99 * (corners - middle)).reshape(-1, 3), np.arange(3 * len(triangles), dtype=np.int32).reshape(-1, 3)


def lens(r, s, d) -> float:
    """Volume that two balls share."""
    return np.pi * (r + s - d) ** 2 * (d**2 + 2 * d * (r + s) - 3 * (r - s) ** 2) / (12 * d)


def volumes() -> list:
    """A fault, the volume that it means, and what is told."""
    whole = 4 / 3 * np.pi
    two = whole * (1 + 0.8**3) - lens(1.0, 0.8, 1.0)
    return [
        pytest.param(faces_inside_out, whole, "", id="inside out"),
        pytest.param(doubled, whole, "what is doubled or crosses is united", id="doubled"),
        pytest.param(crossing, two, "what is doubled or crosses is united, its surface is made anew", id="crossing"),
        pytest.param(crossing_inside_out, two, "united, its surface is made anew", id="crossing and inside out"),
        pytest.param(crossing_with_a_cavity, two - whole * 0.3**3, "united, its surface is made anew", id="a cavity"),
        pytest.param(apart, whole, "gaps are closed, its surface is made anew", id="apart"),
    ]


@pytest.mark.parametrize(("fault", "volume", "told"), volumes())
def test_volume_of_what_is_enclosed(fault, volume, told):
    """Within 1 %: the facets of the balls take 0.7 %."""
    points, triangles, done = solid(*fault(*ball()), "ball")
    assert volume_and_centre(points, outward(points, triangles, "ball"))[0] == pytest.approx(volume, rel=1e-2)
    assert done.endswith(told)


def test_a_sheet_encloses_nothing():
    """Half of the sides of a box that are one plane."""
    points, triangles = shapes.surface(Box((1.0, 1.0, 1.0)), 10.0)
    flat = triangles[points[triangles][:, :, 2].max(axis=1) < 0]
    with pytest.raises(MeshError, match="encloses no volume"):
        solid(points, flat, "sheet")


def test_what_stays_open_is_not_told_to_become_a_solid(monkeypatch):
    """It is one already: the way out is a sheet."""

    def never(*_):
        raise MeshError("not closed", "write solid in place of mesh")

    points, loose = np.eye(4, 3), np.array([[0, 1, 2], [0, 1, 3]])
    monkeypatch.setattr("mdanim_lammps.model.solid.outward", never)
    monkeypatch.setattr("mdanim_lammps.model.solid.enclosing", lambda points, triangles: (points, triangles))
    with pytest.raises(MeshError, match="encloses no solid, not even with its surface made anew") as error:
        solid(points, loose, "soup.stl")
    assert error.value.hint.startswith("write sheet thickness")


def test_a_scene_says_what_was_done(tmp_path):
    """The word, its way back into text, and the note of check; a mesh of the same file is refused and names the word."""
    import pyvista

    points, triangles = shapes.surface(Box((0.2, 0.2, 0.1)), 1.0)
    open_ = triangles[points[triangles][:, :, 2].min(axis=1) < 0.04]
    pyvista.PolyData.from_regular_faces(points, open_).save(tmp_path / "tray.stl")
    text = 'object tray {{ shape {} "tray.stl" density 500 elasticity 1 MPa position (0, 0, 0) m }}\n'
    text += "control {{ time 0.1 s accuracy preview }}\n"
    (tmp_path / "a.txt").write_text(text.format("solid"))
    (tmp_path / "b.txt").write_text(text.format("mesh"))
    scene = Scene.load(tmp_path / "a.txt")
    assert scene.record.solids[0].shape == Mesh(tmp_path / "tray.stl", 1.0, True)
    assert [str(n.message) for n in scene.certificate.notes] == ["tray: in tray.stl 1 gap is closed; it encloses 4 l"]
    with pytest.raises(SceneError, match="not closed") as caught:
        print(Scene.load(tmp_path / "b.txt").certificate)
    assert "write solid in place of mesh" in str(caught.value)
