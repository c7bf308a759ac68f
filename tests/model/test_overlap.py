# SPDX-License-Identifier: GPL-2.0-only
"""Objects that start inside each other or outside the scene: found, named, and freed by the offered move."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from mdanim_lammps import features
from mdanim_lammps.features.contact.words import ContactModel
from mdanim_lammps.features.liquid.record import Liquid
from mdanim_lammps.features.rigid.words import Rigid
from mdanim_lammps.features.walls.words import Walls
from mdanim_lammps.model import overlap, shapes
from mdanim_lammps.model.build import build_models
from mdanim_lammps.model.overlap import check_geometry
from mdanim_lammps.scene.scene import Box, Cylinder, Ellipsoid, HoldAll, Mesh, Sphere, Torus
from model_samples import MESHES, SHAPES, rotation, scene, shape_id, solid

CUBE = Box((1.0, 1.0, 1.0))
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001}
MOVES = {"up": (0, 0, 1), "down": (0, 0, -1), "to +x": (1, 0, 0), "to -x": (-1, 0, 0), "to +y": (0, 1, 0), "to -y": (0, -1, 0)}


BOTH = pytest.mark.parametrize("model", ContactModel, ids=lambda model: model.value)
PAPER = {"contact_model": ContactModel.PAPER}
"""Control word for the paper's contact: contact at the surfaces allows starts less than a quarter of a cell deep."""


def problems(*solids, h=0.25, **rest):
    """Problems of these solids, at spacing h."""
    made = scene(*solids, resolution=h, **rest)
    (contact,) = (e.of(made) for e in features.effects() if e.keeps_apart)
    return check_geometry(made, build_models(made), [p for e in features.effects() for p in e.planes(made)], contact)


def moved(body, hint):
    """The solid after the move that a hint asks for."""
    name, number, unit = re.fullmatch(r"move it (.+) by (\S+) (\w+)", hint).groups()
    step = np.array(MOVES[name]) * float(number) * UNITS[unit]
    return replace(body, position=tuple(body.position + step))


@pytest.mark.parametrize(
    ("position", "deep"),
    [
        pytest.param((0, 0, 1.0), None, id="one stands on the other"),
        pytest.param((0, 0, 1.5), None, id="apart"),
        pytest.param((1.0, 1.0, 1.0), None, id="corner to corner"),
        pytest.param((0.3, 0.2, 0.97), "3 cm", id="a little inside"),
        pytest.param((0, 0.5, 0), "50 cm", id="half inside"),
        pytest.param((0, 0, 0), "cm", id="the same place"),
    ],
)
@BOTH
def test_two_cubes(position, deep, model):
    """Let touching cubes be, and tell how deep others are; at the surfaces a start a little inside is one at rest."""
    found = problems(solid(CUBE, "a"), solid(CUBE, "b", position=position), contact_model=model)
    if deep is None or (deep == "3 cm" and model is ContactModel.SURFACE):
        assert not found
    else:
        (problem,) = found
        assert problem.message.startswith("b starts inside a, about ")
        assert problem.message.endswith(f"{deep} deep")
        assert problem.line == 3


def test_the_hint_is_the_shortest_way_out():
    """Offer to lift a cube that is 3 cm deep in the one below."""
    (problem,) = problems(solid(CUBE, "a"), solid(CUBE, "b", position=(0.1, 0, 0.97)), **PAPER)
    assert problem.hint == "move it up by 18 cm"  # and 0.6 of the spacing, so that contact holds no energy


def test_on_a_slope_the_move_is_short():
    """At its surface a block lies on a slope whose box it is in: 1.7 cm along the normal are 1.8 cm upward."""
    turned = rotation(0, np.radians(20.0), 0)
    ramp = solid(Box((2.0, 0.6, 0.1)), "ramp", rotation=turned)
    (problem,) = problems(ramp, solid(Box((0.2, 0.2, 0.2)), "block", position=(-0.6, -0.15, 0.36), rotation=turned), h=0.05)
    assert re.fullmatch(r"move it up by 1\.[89] cm", problem.hint)


@settings(max_examples=60, deadline=None)
@given(st.sampled_from(SHAPES), st.sampled_from(SHAPES), *[st.tuples(*[st.floats(-0.6, 0.6)] * 3)] * 2)
def test_an_offered_move_frees_any_two_bodies(first, second, shift, angles):
    """Do what the message says, and the two bodies are apart, whatever they are."""
    a, b = solid(first, "a"), solid(second, "b", position=shift, rotation=rotation(*np.multiply(angles, 5)))
    found = problems(a, b, h=0.12)
    assume(found)
    assert not problems(a, moved(b, found[0].hint), h=0.12)


@pytest.mark.parametrize(
    ("first", "second", "position"),
    [
        pytest.param(CUBE, Sphere(0.2), (0.1, 0, 0), id="a ball inside a cube"),
        pytest.param(Sphere(0.2), CUBE, (0.1, 0, 0), id="a cube around a ball"),
        pytest.param(Box((3.0, 0.3, 0.3)), Box((0.3, 0.3, 3.0)), (0.02, 0.03, 0.01), id="two bars that cross"),
        pytest.param(Box((3.0, 3.0, 0.2)), Cylinder(0.15, 4.0), (0.4, 0.4, 0.3), id="a rod through a plate"),
        pytest.param(Torus(1.0, 0.3), Sphere(0.4), (1.0, 0, 0), id="a ball on the ring's tube"),
        pytest.param(Mesh(MESHES / "cuboid.obj", 0.5), Sphere(0.2), (0.6, 0.4, 0.2), id="a ball inside a mesh"),
    ],
)
def test_overlaps_of_all_kinds_are_found(first, second, position):
    """Find bodies inside others, around others and through others."""
    assert len(problems(solid(first, "a"), solid(second, "b", position=position), h=0.1)) == 1


@pytest.mark.parametrize(
    ("first", "second", "position"),
    [
        pytest.param(Torus(1.0, 0.3), Sphere(0.5), (0, 0, 0), id="a ball in the hole of a ring"),
        pytest.param(Sphere(0.5), Sphere(0.5), (1.0, 0, 0), id="two balls that touch"),
        pytest.param(Sphere(0.5), Sphere(0.5), (0.71, 0.71, 0), id="bounding boxes overlap, balls do not"),
        pytest.param(CUBE, Sphere(0.5), (0, 0, 1.0), id="a ball on a cube"),
        pytest.param(Torus(1.0, 0.2), Torus(1.0, 0.2), (0, 0, 0.4), id="rings on each other"),
    ],
)
def test_bodies_that_only_touch_are_left_alone(first, second, position):
    """Look at true surfaces, not at boxes, nor at particles of the staircase."""
    assert not problems(solid(first, "a"), solid(second, "b", position=position), h=0.1)


def test_linked_rings_are_fine():
    """Let one ring pass through the hole of another."""
    ring = Torus(1.0, 0.2)
    assert not problems(solid(ring, "a"), solid(ring, "b", position=(1.0, 0, 0), rotation=rotation(np.pi / 2, 0, 0)), h=0.1)


def test_turned_cubes_that_touch_are_left_alone():
    """Forgive the round-off of two turned cubes that lie face on face."""
    turn = rotation(0.4, 0.7, -1.3)
    for axis in range(3):
        beside = tuple(np.array(turn)[:, axis])
        assert not problems(solid(CUBE, "a", rotation=turn), solid(CUBE, "b", rotation=turn, position=beside))


@pytest.mark.parametrize("order", [1, -1], ids=["corner second", "corner first"])
def test_a_corner_that_pokes_into_a_face_is_found(order):
    """Find the one vertex that is inside, whichever body comes first in the scene."""
    # A cube on its corner reaches sqrt(3)/2 down; the slab's face is at z = 0.
    on_corner = rotation(np.pi / 4, np.arctan(np.sqrt(0.5)), 0)
    cube = solid(CUBE, "cube", rotation=on_corner, position=(0.07, 0.03, np.sqrt(0.75) - 0.02))
    slab = solid(Box((3.0, 3.0, 1.0)), "slab", position=(0, 0, -0.5))
    (problem,) = problems(*(cube, slab)[::order], **PAPER)
    assert "about 2 cm deep" in problem.message


def test_the_host_is_asked_in_its_own_frame():
    """Find a ball at the end of a turned bar, and none where a bar turned the other way would be."""
    bar = solid(Box((4.0, 0.3, 0.3)), "bar", rotation=rotation(0, 0, 0.5))
    for sign, count in ((1, 1), (-1, 0)):
        at = (1.6 * np.cos(0.5), sign * 1.6 * np.sin(0.5), 0.0)
        assert len(problems(bar, solid(Sphere(0.1), "ball", position=at), h=0.1)) == count


@pytest.mark.parametrize(
    ("position", "words"),
    [
        pytest.param((0, 0, 0.5), None, id="stands on the ground"),
        pytest.param((0, 0, 0.47), ("3 cm below the ground", "move it up by 3 cm"), id="sunk"),
        pytest.param((1.6, 0, 1.0), ("10 cm outside the walls at +x", "move it to -x by 10 cm"), id="through"),
        pytest.param((0, -5.0, 1.0), ("3.5 m outside the walls at -y", "move it to +y by 3.5 m"), id="outside"),
    ],
)
@BOTH
def test_ground_and_walls(position, words, model):
    """Keep objects above the ground and within the walls."""
    walls = Walls((-2, -2, -9), (2, 2, 9))
    found = problems(solid(CUBE, "cube", position=position), ground=0.0, walls=walls, contact_model=model)
    if words is None or (position == (0, 0, 0.47) and model is ContactModel.SURFACE):
        assert not found
    else:
        (problem,) = found
        assert problem.message == f"cube is {words[0]}" and problem.hint == words[1] and problem.line == 3


def test_a_turned_cube_reaches_further_down():
    """Take a cube on its edge half a diagonal deep."""
    body = solid(CUBE, "cube", position=(0, 0, 0.6), rotation=rotation(np.pi / 4, 0, 0))
    (problem,) = problems(body, ground=0.0)
    assert problem.message == "cube is 10.7 cm below the ground"
    assert problem.hint == "move it up by 11 cm"
    assert not problems(moved(body, problem.hint), ground=0.0)


def test_a_basin_has_a_floor_and_walls_that_go_on_upward():
    """Refuse an object beside the basin or in its floor, not one above it."""
    water = Liquid("water", (-1, -1, 0), (1, 1, 1), 1000.0, level=0.5)
    assert not problems(solid(CUBE, position=(0, 0, 5.0)), liquid=water)
    (side,) = problems(solid(CUBE, "cube", position=(0.6, 0, 5.0)), liquid=water)
    assert side.message == "cube is 10 cm outside the basin at +x"
    (floor,) = problems(solid(CUBE, "cube", position=(0, 0, 0.4)), liquid=water)
    assert floor.message == "cube is 10 cm below the floor of the basin"


def test_no_move_into_the_ground_is_offered():
    """Send a cube up, not the shorter way down through the ground."""
    a, b = solid(CUBE, "a", position=(0, 0, 1.0)), solid(CUBE, "b", position=(0, 0, 0.5))
    walls = Walls((-0.5, -0.5, 0), (0.5, 0.5, 9))
    for model, way in ((ContactModel.PAPER, "1.7 m"), (ContactModel.SURFACE, "1.5 m")):
        (problem,) = problems(a, b, ground=0.0, walls=walls, contact_model=model)
        assert problem.hint == f"move it up by {way}"


def test_held_objects_may_overlap_and_stick_out():
    """Let the scene's architecture be built of overlapping held objects, but let nothing start inside it."""
    a, b = solid(CUBE, "a", hold=(HoldAll(),)), solid(CUBE, "b", position=(0.5, 0, 0), hold=(HoldAll(),))
    assert not problems(a, b, ground=0.0)
    ball = solid(Sphere(0.5), "ball", position=(1.0, 0, 0.6))
    (problem,) = problems(a, b, ball, ground=0.0)
    assert problem.message.startswith("ball starts inside b")


def test_candidates_are_those_of_all_pairs():
    """Find every bad pair among 200 balls, as a look at all pairs does."""
    rng = np.random.default_rng(5)
    centres = rng.uniform(0, 3, (200, 3))
    balls = [solid(Sphere(0.2), f"{i}", position=tuple(c)) for i, c in enumerate(centres)]
    names = re.compile(r"(\d+) starts inside (\d+)")
    found = {tuple(map(int, names.match(p.message).groups())) for p in problems(*balls, h=0.1, **PAPER)}
    distance = np.linalg.norm(centres[:, None] - centres, axis=2)
    i, j = np.nonzero(np.triu(distance < 0.4, 1))
    # Faceted balls do not notice an overlap below the height of a facet, 0.4 % of a radius.
    clear = distance[i, j] < 0.4 - 2e-3
    assert set(zip(j[clear], i[clear])) <= found <= set(zip(j, i))
    assert clear.sum() > 20


@pytest.mark.parametrize("shape", SHAPES, ids=shape_id)
def test_a_body_overlaps_itself(shape):
    """Find two equal bodies at one place, of every shape."""
    h = shapes.thickness(shape) / 4
    assert len(problems(solid(shape, "a"), solid(shape, "b"), h=h)) == 1


def test_a_scene_without_solids_has_no_problem():
    """Have nothing to say about an empty scene."""
    assert check_geometry(scene(), ()) == []


@pytest.mark.parametrize("room", ["walls", "basin"])
def test_an_object_wider_than_its_room_is_told_once_an_axis(room):
    """No move helps, so none is offered: the width and the room are told, with a guess at the cause."""
    low, high = (-1.0, -1.0, 0.0), (1.0, 3.0, 9.0)
    where = {"walls": Walls(low, high)} if room == "walls" else {"liquid": Liquid("water", low, high, 1000.0, volume=1.0)}
    (found,) = problems(solid(Box((4.0, 3.0, 1.0)), "slab", position=(0.0, 1.0, 2.0), mass=1.0), **where)
    assert "slab is 4 m wide along x" in found.message and "only 2 m" in found.message
    assert "unit" in found.hint


def test_a_heap_of_objects_in_each_other_is_not_looked_at_in_full(monkeypatch):
    """40 balls at one place are 780 pairs: after 50 in each other the other 730 are counted."""
    asked, pair = [], overlap._pair
    monkeypatch.setattr(overlap, "MOST_PAIRS", 50)
    monkeypatch.setattr(overlap, "_pair", lambda *args: asked.append(args) or pair(*args))
    balls = scene(*(solid(Sphere(0.3), f"b{k}", position=(1e-3 * k, 0.0, 1.0)) for k in range(40)), resolution=0.1)
    problems = overlap.check_geometry(balls, build_models(balls))
    assert len(asked) == 50 and len(problems) == 51
    assert "b1 starts inside b0" in problems[0].message and "730 more pairs" in problems[-1].message


@pytest.mark.parametrize(
    ("shape", "place", "told", "hint"),
    [
        pytest.param(CUBE, (0.02, 0, 0.97), "b starts inside a, about 3 cm deep", "move it up by 3 cm", id="cubes"),
        pytest.param(CUBE, (0.1, 0, 0.93), "b starts inside a, about 7 cm deep", "move it up by 7 cm", id="cubes, deep"),
        pytest.param(Sphere(0.5), (0.1, 0, 0.99), "b starts inside a, about 1 cm deep", "move it up by 1 cm", id="a ball"),
        pytest.param(CUBE, (0.0, 0, 0.9995), None, None, id="half a millimetre"),
    ],
)
def test_rigid_objects_are_asked_by_their_shapes(shape, place, told, hint):
    """Rigid ones have few particles: their shapes tell whether they start in each other, and how deep."""
    found = problems(solid(CUBE, "a", elasticity=Rigid()), solid(shape, "b", position=place, elasticity=Rigid()))
    assert [(p.message, p.hint) for p in found] == ([] if told is None else [(told, hint)])


def test_the_move_is_the_shortest_of_all_directions():
    """A plank on a slant lies 5 mm in a roller as wide as itself: up is 5 mm over the cosine, along the roller is its width."""
    pivot = solid(Cylinder(0.05, 0.2), "pivot", rotation=rotation(math.pi / 2, 0, 0), elasticity=Rigid())
    place = tuple(0.06 * np.array([np.sin(0.35), 0.0, np.cos(0.35)]))
    plank = solid(Box((1.2, 0.2, 0.03)), "plank", position=place, rotation=rotation(0, 0.35, 0), elasticity=Rigid())
    (found,) = problems(pivot, plank)
    assert found.hint == "move it up by 5.4 mm"  # 5.32, rounded up


THICK = [Sphere(0.1), Cylinder(0.1, 0.2), Ellipsoid((0.1, 0.1, 0.1)), Box((0.2, 0.2, 0.2))]
"""Shapes with a thickness of 20 cm."""


@pytest.mark.parametrize("shape", THICK, ids=shape_id)
@pytest.mark.parametrize(("height", "told"), [(0.09, "body is 1 cm below the ground"), (0.0999, None)])
def test_a_rigid_object_in_the_ground(shape, height, told):
    """A ball of 10 cm that starts 1 cm in the ground is refused, by a tenth of a millimetre it is not."""
    found = problems(solid(shape, position=(0, 0, height), elasticity=Rigid()), ground=0.0)
    assert [p.message for p in found] == ([] if told is None else [told])


def star(tmp_path, corners):
    """A prism of 20 cm in depth about the origin over corners (x, z) around it, as a mesh."""
    count = len(corners)
    points = [(0, y, 0) for y in (-0.1, 0.1)] + [(x, y, z) for y in (-0.1, 0.1) for x, z in corners]
    faces = []
    for k in range(count):
        a, b = 2 + k, 2 + (k + 1) % count
        faces += [(0, a, b), (1, b + count, a + count), (a, a + count, b), (b, a + count, b + count)]
    lines = [f"v {x} {y} {z}" for x, y, z in points] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    (tmp_path / "star.obj").write_text("\n".join(lines))
    return Mesh(tmp_path / "star.obj", scale=1.0)


DIAMOND = [(0.3, 0.0), (0.0, 0.3), (-0.3, 0.0), (0.0, -0.3)]
FOUR_POINTS = [p for (x, z), (u, w) in zip(DIAMOND, DIAMOND[1:] + DIAMOND[:1]) for p in ((x, z), (0.3 * (x + u), 0.3 * (z + w)))]
"""A star with the corners of the diamond and others nearer to the middle."""


@pytest.mark.parametrize("h", [0.02, 0.05, 0.2])
@pytest.mark.parametrize("corners", [DIAMOND, FOUR_POINTS], ids=["convex", "concave"])
@pytest.mark.parametrize(("deep", "told"), [(0.01, True), (0.002, True), (0.00002, False), (-0.001, False)])
def test_a_rigid_mesh_in_the_ground(tmp_path, corners, h, deep, told):
    """Whether a mesh starts in the ground follows from its corners, whatever the resolution, with creases or without."""
    body = solid(star(tmp_path, corners), position=(0, 0, 0.3 - deep), elasticity=Rigid())
    found = problems(body, ground=0.0, h=h)
    assert [p.message for p in found] == (
        [f"body is {1000 * deep:.3g} mm below the ground".replace("10 mm", "1 cm")] if told else []
    )


@pytest.mark.parametrize("h", [0.02, 0.05, 0.2])
@pytest.mark.parametrize("turn", [(0.0, 0.0, 0.0), (0.4, 0.7, -1.3), (np.pi / 2, 0.0, 0.0)])
def test_a_rigid_ring_in_the_ground(h, turn):
    """A ring reaches R sin(a) + r down where its axis is tilted by a: 2 mm more are refused, a hundredth of 1 mm is not."""
    turned = rotation(*turn)
    low = 0.5 * np.hypot(*np.array(turned)[2, :2]) + 0.1
    for deep, told in ((0.002, ["body is 2 mm below the ground"]), (0.00001, [])):
        body = solid(Torus(0.5, 0.1), position=(0, 0, low - deep), rotation=turned, elasticity=Rigid())
        assert [p.message for p in problems(body, ground=0.0, h=h)] == told


@pytest.mark.parametrize("h", [0.02, 0.05, 0.2])
@pytest.mark.parametrize("shape", THICK, ids=shape_id)
def test_a_rigid_object_in_a_held_floor(shape, h):
    """A floor that never moves is as the ground: 2 mm are refused at any resolution, a tenth of a millimetre is not."""
    floor = solid(Box((1.0, 1.0, 0.2)), "floor", position=(0, 0, -0.1), hold=(HoldAll(),))
    for deep, told in ((0.002, ["b starts inside floor, about 2 mm deep"]), (0.0001, [])):
        body = solid(shape, "b", position=(0, 0, 0.1 - deep), elasticity=Rigid())
        assert [p.message for p in problems(floor, body, h=h)] == told
