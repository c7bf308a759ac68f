# SPDX-License-Identifier: GPL-2.0-only
"""Parts of the sides of held cuboids that other held cuboids leave open."""

import numpy as np
import pytest
from mdanim_lammps.model.build import build_models
from mdanim_lammps.model.cover import AROUND
from mdanim_lammps.scene.parse import parse_scene

SLAB = "object {} {{ shape box ({}, {}, {}) cm  position ({}, {}, {}) cm  density 1000  elasticity 1 MPa  {} }}\n"


def slab(name, size, place, more="hold all"):
    return SLAB.format(name, *size, *place, more)


def frames(*slabs):
    """Frames of which contact bodies are made, with cells of 5 cm."""
    return [m.frame for m in build_models(parse_scene("".join(slabs) + "control { time 1 s  resolution 5 cm }"))]


def covered(frame, side, place):
    """Whether a place of a side, two lattice coordinates, is covered."""
    parts = np.zeros((0, 5)) if frame.open is None else frame.open
    parts = parts[parts[:, 0] == side]
    if not len(parts):
        return False
    a, b = place
    return not ((parts[:, 1] < a) & (a < parts[:, 2]) & (parts[:, 3] < b) & (b < parts[:, 4])).any()


LEFT, RIGHT = slab("left", (40, 40, 10), (-20, 0, -5)), slab("right", (40, 40, 10), (20, 0, -5))


def test_slabs_side_by_side_cover_one_side_of_each():
    """Also its edges, and what is sunk in there; the points of the covered side are left out, all others stay."""
    (left, right), (alone,) = frames(LEFT, RIGHT), frames(LEFT)
    for frame, side in ((left, 1), (right, 0)):
        assert frame.open[:, 0].tolist() == [side]
        assert all(covered(frame, side, place) for place in ((4, 1), (4, 2.0), (0, 0), (8, 2.01), (-0.1, 1.9)))
        normal = frame.contact.normal
        assert not (normal[:, 0] == 2 * side - 1).any() and len(normal) == len(alone.contact.normal) - 9 * 3
    assert alone.open is None


@pytest.mark.parametrize(
    "other",
    {
        "apart by 2 mm": slab("right", (40, 40, 10), (20.2, 0, -5)),
        "free": slab("right", (40, 40, 10), (20, 0, -5), "hold face -z"),
        "a ball": "object right { shape sphere 20 cm  position (20, 0, -5) cm  density 1000  elasticity 1 MPa  hold all }\n",
        "turned": slab("right", (40, 40, 10), (20, 0, -5), "hold all\n orientation axis (0, 0, 1) angle 10 deg"),
        "across the corner": slab("right", (40, 40, 10), (20, 40, -5)),
    }.items(),
    ids=lambda item: item[0],
)
def test_others_cover_nothing(other):
    """Neighbours that are not flush, can move, are not cuboids, are askew, or meet in an edge cover nothing."""
    assert all(frame.open is None for frame in frames(LEFT, other[1]))


@pytest.mark.parametrize("turn", ["angle 90 deg", "angle 180 deg", "angle 1e-10 deg"])
def test_turns_and_rounding_change_no_cover(turn):
    """Covers of bodies whose axes are along each other's stay the same when both are turned together."""
    left, _ = frames(LEFT, slab("right", (40, 40, 10), (20, 0, -5), f"hold all\n orientation axis (0, 0, 1) {turn}"))
    assert left.open.tolist() == frames(LEFT, RIGHT)[0].open.tolist()
    c, s = np.cos(np.radians(37)), np.sin(np.radians(37))
    askew = "hold all\n orientation axis (0, 0, 1) angle 37 deg"
    left, right = frames(*(slab(n, (40, 40, 10), (20 * k * c, 20 * k * s, -5), askew) for n, k in (("left", -1), ("right", 1))))
    assert (left.open[:, 0].tolist(), right.open[:, 0].tolist()) == ([1], [0])


def test_a_wider_slab_is_open_beside_its_neighbour():
    """Around the neighbour's side too, but not at the edges that are flush."""
    wide, _ = frames(slab("wide", (40, 80, 10), (-20, 0, -5)), RIGHT)  # y of the neighbour: 4 to 12 cells
    assert [covered(wide, 1, (y, 1.0)) for y in (3.9, 4 + 0.9 * AROUND, 5, 11, 12 - 0.9 * AROUND, 12.1)] == [0, 0, 1, 1, 0, 0]
    assert [covered(wide, 1, (y, 2.0)) for y in (3.9, 4.1, 11.9, 12.1)] == [False, True, True, False]


def test_a_higher_wall_is_open_above_its_neighbour():
    """From half a cell below the neighbour's upper edge on, where the lower edges of what lies on it are."""
    floor, wall = frames(LEFT, slab("wall", (10, 40, 25), (5, 0, 2.5)))
    assert covered(floor, 1, (4, 2.0)) and covered(wall, 0, (4, 1.0))
    assert [covered(wall, 0, (4, z)) for z in (2 - 1.1 * AROUND, 2 - 0.9 * AROUND, 2, 5)] == [True, False, False, False]


def test_two_neighbours_cover_a_side_together():
    """Two slabs that form a T leave no place open where they meet."""
    left, *_ = frames(LEFT, slab("one", (40, 20, 10), (20, 10, -5)), slab("two", (40, 20, 10), (20, -10, -5)))
    assert all(covered(left, 1, (y, z)) for y in np.linspace(0, 8, 17) for z in (0, 1, 2))


def test_what_stands_on_the_middle_of_a_floor_covers_only_itself():
    """The floor is met from above alone."""
    floor, post = frames(LEFT, slab("post", (10, 10, 20), (-20, 0, 10)))
    assert floor.open is None and post.open[:, 0].tolist() == [4] and covered(post, 4, (1, 1))


def test_equal_covers_share_a_body():
    """A row of tiles has three: its two ends, and all that are between."""
    row = frames(*(slab(f"tile{k}", (20, 20, 10), (20 * k, 0, -5)) for k in range(6)))
    assert len({id(frame) for frame in row}) == 3 and len({id(frame) for frame in row[1:-1]}) == 1
