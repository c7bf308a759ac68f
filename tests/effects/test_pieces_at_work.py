# SPDX-License-Identifier: GPL-2.0-only
"""Objects with pieces in scenes: their words, what they are made of, how they move and break."""

from pathlib import Path

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.errors import SceneError
from mdanim_lammps.model import cut, cut_concave, shapes
from mdanim_lammps.model.inertia import tensor
from mdanim_lammps.model.mesh import MeshError
from mdanim_lammps.run.loop import simulate
from mdanim_lammps.scene.lock import lock_text
from mdanim_lammps.scene.parse import parse_scene
from mdanim_lammps.scene.scene import Box, Bricks, Cone, Cylinder, Ellipsoid, Mesh, Shell, Sphere, Torus, VoronoiCells

MESHES = Path(__file__).parents[2] / "scenes" / "meshes"
PLATE = """gravity (0, 0, -9.81) m/s^2
ground z 0 m
object plate {{
  shape {shape}  position (0, 0, 0.5) m  orientation axis (1, 0.3, 0) angle 20 deg  spin (1, 2, 3) rad/s
  {made}  friction 0.4  {pieces}
}}
control {{ time {time} s }}
{more}
"""


def scene(
    shape="box (30, 30, 1) cm", pieces="pieces 12  strength 40 MPa", made="density 2500  elasticity rigid", time=0.5, more=""
):
    """The text of a plate that falls."""
    return PLATE.format(shape=shape, pieces=pieces, made=made, time=time, more=more)


SHAPES = [Box((0.3, 0.2, 0.01)), Sphere(0.1), Cylinder(0.1, 0.2), Cone(0.1, 0.2), Ellipsoid((0.1, 0.2, 0.3))]


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: type(shape).__name__)
@pytest.mark.parametrize("number", [2, 30])
def test_pieces_are_the_whole(shape, number):
    """Together they have its volume, its centre, and moments of inertia to the part that flat sides take of round ones."""
    found = cut.division(shape, VoronoiCells(number), "1 a")
    assert len(found.pieces) == number == cut.count(shape, VoronoiCells(number), "1 a")
    assert found.volume == pytest.approx(shapes.volume(shape), rel=1e-7)
    volume = np.array([piece.surface.volume for piece in found.pieces])
    centre = np.array([piece.surface.centre for piece in found.pieces])
    size = shapes.radius(shape)
    assert volume @ centre / volume.sum() == pytest.approx(0.0, abs=1e-7 * size)
    assert min(volume) > 0.1 * volume.mean()
    spread = sum(v * (second(piece) + np.outer(c, c)) for v, c, piece in zip(volume, centre, found.pieces)) / volume.sum()
    assert np.allclose(spread, shapes.second_moments(shape), rtol=0.0, atol=(1e-9 if isinstance(shape, Box) else 5e-3) * size**2)


CONCAVE = [
    Torus(0.2, 0.05),
    Shell(Cylinder(0.06, 0.2), 0.005),
    Mesh(MESHES / "bowl.stl", 0.01),
    Mesh(MESHES / "bottle.stl", 0.01),
]


@pytest.mark.parametrize("shape", CONCAVE, ids=["ring", "tin", "bowl", "bottle"])
def test_what_is_not_convex_is_cut(shape):
    """Pieces fill it, and each hangs together with others by faces that are all of what was cut. There may be more than cells."""
    body, found = cut.concave(shape), cut.division(shape, VoronoiCells(9), "1 a")
    assert len(found.pieces) == cut.count(shape, VoronoiCells(9), "1 a") >= 9
    assert found.volume == pytest.approx(body.volume, rel=1e-6)
    centre = sum(p.surface.volume * p.surface.centre for p in found.pieces) / found.volume
    assert centre == pytest.approx(0.0, abs=1e-6 * np.ptp(body.points))
    cut_off = sum(p.surface.area for p in found.pieces) - body.area
    assert 2.0 * sum(face.area for face in found.faces) == pytest.approx(cut_off, rel=1e-5)
    assert {n for face in found.faces for n in (face.a, face.b)} == set(range(len(found.pieces)))


def test_ends_that_meet_none_are_refused():
    """They would not be glued: the piece would fall off."""
    corners = np.array([[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]])
    ends = {(0, 1): [(0, corners)], (1, 0): [(1, corners)]}
    assert len(cut_concave._met(ends, 1.0)) == 1
    with pytest.raises(MeshError, match="not alike"):
        cut_concave._met(ends | {(1, 0): [(1, 0.9 * corners)]}, 1.0)


def test_a_tin_of_glass_is_rigid(prepared):
    """A shell that breaks is made of rigid pieces, with the mass of its wall."""
    ready = prepared(scene(shape="cylinder 6 cm 20 cm sheet thickness 5 mm", made="material glass", pieces="pieces 9"))
    outer, inner = (np.pi * r**2 * h for r, h in ((0.0625, 0.205), (0.0575, 0.195)))
    assert ready.system.rigid.all() and ready.system.mass.sum() == pytest.approx(2470 * (outer - inner), rel=1e-6)


def test_pieces_of_a_mesh_file_have_the_name_of_the_whole():
    """In a scene that names the file as it is beside it: how many there are follows from the file."""
    text = scene(shape='mesh "meshes/bowl.stl" scale 0.01', pieces="pieces 5  strength 1 MPa", more="expect plate.pieces > 1")
    found = parse_scene(text, folder=MESHES.parent)
    assert found.solids[0].name == "plate.piece[1]" and found.expects[0].of == "NAMES"


def second(piece):
    """Second moments of a piece about its centre by its volume."""
    from mdanim_lammps.model.mesh import second_moments

    return second_moments(piece.surface)


@pytest.mark.parametrize(
    ("shape", "how"), [(Box((0.3, 0.2, 0.01)), VoronoiCells(30)), (Box((1, 0.2, 0.5)), Bricks((0.25, 0.1, 0.1)))], ids=str
)
def test_every_piece_is_glued_to_its_neighbours(shape, how):
    """The faces of a piece have no area left: glue and outside are all of it. Normals point from one to the other."""
    found = cut.division(shape, how, "1 a")
    glued = sum(2.0 * face.area for face in found.faces)
    surface = sum(piece.surface.area for piece in found.pieces)
    assert surface - glued == pytest.approx(shapes.area(shape), rel=1e-6)
    for face in found.faces:
        between = found.pieces[face.b].surface.centre - found.pieces[face.a].surface.centre
        assert between @ face.axes[0] > 0.0 and np.allclose(face.axes @ face.axes.T, np.eye(3))
        for piece, side, sign in ((found.pieces[face.a], face.side_a, 1.0), (found.pieces[face.b], face.side_b, -1.0)):
            corner = piece.polyhedron.corner[list(piece.polyhedron.faces[side])] + piece.surface.centre
            normal = np.cross(corner[1] - corner[0], corner[2] - corner[1])
            assert normal @ face.axes[0] * sign > 0.999 * np.linalg.norm(normal)


def test_faces_of_bricks_are_those_of_any_piece():
    """Sides, area, moments and section moduli as the faces of any two pieces have them; equal bricks share what they are."""
    found = cut.division(Box((1.0, 0.2, 0.5)), Bricks((0.25, 0.1, 0.11)), "")
    assert len(set(found.alike)) == 2 and found.alike[0] == 0
    for face in found.faces[::7]:
        one, other = (found.pieces[n].surface for n in (face.a, face.b))
        low, high = (np.array([end(p.points + p.centre, axis=0) for p in (one, other)]) for end in (np.min, np.max))
        start, end = low.max(axis=0), high.min(axis=0)
        u, v = (k for k in range(3) if end[k] - start[k] > 1e-9)
        loop = np.tile(0.5 * (start + end), (4, 1))
        loop[[1, 2], u], loop[[2, 3], v] = end[u], end[v]
        loop[[0, 3], u], loop[[0, 1], v] = start[u], start[v]
        twin = cut._common(face.a, face.b, face.side_a, face.side_b, loop)
        assert abs(twin.axes[0] @ face.axes[0]) == pytest.approx(1.0)
        assert (face.axes[0] @ (other.centre - one.centre)) > 0.0 and np.linalg.det(face.axes) == pytest.approx(1.0)
        assert (face.area, *face.second, *face.section) == pytest.approx((twin.area, *twin.second, *twin.section))
        assert face.at == pytest.approx(twin.at)
        loops = [found.pieces[n].polyhedron.faces[side] for n, side in ((face.a, face.side_a), (face.b, face.side_b))]
        along = int(np.abs(face.axes[0]).argmax())
        assert [float(np.ptp(p.points[list(loop), along])) for p, loop in zip((one, other), loops)] == pytest.approx([0.0, 0.0])


def test_a_face_has_the_moments_of_its_section():
    """A bar in two bricks: b h^2/6 about both axes of the section."""
    (face,) = cut.division(Box((1.0, 0.2, 0.1)), Bricks((0.5, 0.2, 0.1)), "").faces
    assert face.area == pytest.approx(0.02) and face.at == pytest.approx(0.0, abs=1e-12)
    assert sorted(face.section[:2]) == pytest.approx([0.2 * 0.1**2 / 6, 0.1 * 0.2**2 / 6])
    assert sum(face.second) / face.section[2] == pytest.approx(np.hypot(0.1, 0.05))


def test_the_seed_and_the_name_choose_the_pieces():
    """Each alone; the same text gives the same pieces."""
    first, again, seed, name = (
        cut.division(Box((0.3, 0.2, 0.01)), VoronoiCells(5), key).pieces[0].surface.points for key in ("1 a", "1 a", "2 a", "1 b")
    )
    assert np.array_equal(first, again)
    assert not any(other.shape == first.shape and np.allclose(other, first) for other in (seed, name))


def test_it_flies_as_the_whole(prepared):
    """Mass and moments to rounding, and so the motion: the same as that of a plate in one piece."""
    ready = prepared(scene(time=0.2))
    single = prepared(scene(pieces="", time=0.2))
    assert ready.system.mass.sum() == pytest.approx(single.system.mass.sum(), rel=1e-14)
    whole = single.scene.solids[0]
    arm = np.array([s.position for s in ready.scene.solids]) - whole.position
    parts = sum(
        tensor(s.shape, m, s.rotation) + m * (a @ a * np.eye(3) - np.outer(a, a))
        for s, m, a in zip(ready.scene.solids, ready.system.mass_of, arm)
    )
    assert np.allclose(parts, single.system.inertia[0], rtol=0.0, atol=1e-13 * np.abs(parts).max())
    found = []
    for one in (ready, single):
        with Instance(one.plan) as instance:
            instance.setup()
            instance.run(round(0.2 / one.certificate.timestep))
            found.append(instance.fix_value("rigid", "translation") + instance.fix_value("rigid", "rotation"))
    assert found[0] == pytest.approx(found[1], rel=1e-4)  # of steps that are not equally long


def test_it_breaks_where_it_falls(tmp_path, prepared):
    """Before the blow it is one part; energies add up with what glue has taken, and `expect` counts."""
    (tmp_path / "out").mkdir()
    run = simulate(
        prepared(
            scene(more="expect plate.pieces at 0.1 s = 1\nexpect plate.pieces > 2\nexpect plate.piece[3].position.z < 0.1 m")
        ),
        tmp_path / "out",
    )
    assert all(outcome.met for outcome in run.outcomes)


def test_the_lock_is_the_scene():
    """With the object as it was written, once."""
    first = parse_scene(scene(), "scene")
    text = lock_text(first)
    again = parse_scene(text, "scene")
    assert text.count("object ") == 1 and "pieces" in text
    assert again.solids == first.solids and len(again.solids) == 12


def test_pieces_have_names():
    """In contacts and joints: each, or all of them by the name of the whole."""
    more = "contact plate ground { friction 0.1 }\ncontact plate.piece[2] plate.piece[3] { friction 0.2 }"
    found = parse_scene(scene(more=more), "scene")
    assert [s.name for s in found.solids[:2]] == ["plate.piece[1]", "plate.piece[2]"]


def test_pieces_in_the_ground_are_one_problem(prepared):
    """The deepest of them, and how many more."""
    with pytest.raises(SceneError) as found:
        prepared(scene().replace("ground z 0 m", "ground z 1.1 m"))
    (problem,) = found.value.problems
    assert "below the ground, and" in problem.message and "more of its pieces are" in problem.message


MISTAKES = {
    "pieces 1  strength 1 MPa": "must be a whole number >= 2, found 1",
    "pieces 5": "plate has pieces and no strength",
    "pieces 5  strength 1 MPa  hold all": "plate is held as a whole, so it never breaks",
    "pieces bricks (10, 0, 10) cm  strength 1 MPa": "the edges of a brick must be > 0",
    "pieces 5  strength 1 MPa  velocity (0, 0, 1) m/s  drive velocity (0, 0, 1) m/s": "drive",
}


@pytest.mark.parametrize("pieces", MISTAKES)
def test_what_cannot_break_is_refused(pieces):
    """With the place, the cause and a way out."""
    with pytest.raises(SceneError) as found:
        parse_scene(scene(pieces=pieces), "scene")
    problem = next(p for p in found.value.problems if MISTAKES[pieces] in p.message)
    assert problem.span is not None and problem.hint


@pytest.mark.parametrize(
    ("shape", "made", "cause"),
    [
        ("cone 5 cm 9 cm sheet thickness 3 mm", "material glass", "plate is the sheet of a cone, which is not cut into pieces"),
        ("sheet (1, 1) m thickness 1 cm", "density 2500  elasticity 1 MPa", "plate is a sheet, which is not cut into pieces"),
        ("cylinder 4 cm 12 cm sheet thickness 5 cm", "material glass", "plate is not hollow: its wall is 5 cm thick"),
        ("box (10, 10, 10) cm", "density 2500  elasticity 1 MPa", "only rigid objects are cut into pieces"),
        ("sphere 10 cm", "density 2500  elasticity rigid  pieces bricks (1, 1, 1) cm", "only a box is made of bricks"),
        (
            "box (10, 10, 10) cm",
            "density 2500  elasticity rigid  pieces bricks (1, 1e-9, 1) cm",
            "it would have 1000000000000 bricks",
        ),
    ],
)
def test_shapes_that_cannot_break_are_refused(shape, made, cause):
    """With the place, the cause and a way out."""
    pieces = "strength 1 MPa" if "pieces" in made else "pieces 5  strength 1 MPa"
    with pytest.raises(SceneError) as found:
        parse_scene(scene(shape=shape, made=made, pieces=pieces), "scene")
    problem = next(p for p in found.value.problems if cause in p.message)
    assert problem.span is not None and problem.hint


def test_a_material_has_a_strength():
    """Glass that is written as such; what has no pieces has no use for it."""
    found = parse_scene(scene(made="material glass", pieces="pieces 5"), "scene")
    assert {s.strength for s in found.solids} == {33e6}
    assert parse_scene(scene(made="material glass", pieces=""), "scene").solids[0].strength is None


def test_a_strength_without_pieces_is_told():
    """As a warning: nothing breaks."""
    found = parse_scene(scene(pieces="strength 1 MPa"), "scene")
    assert [w.message for w in found.warnings if "plate has a strength and no pieces" in w.message]
