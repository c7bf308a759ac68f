# SPDX-License-Identifier: GPL-2.0-only
"""How often fix mdanim/contact looks points up that touch nothing: what was seen of a point holds when lists are made again."""

from dataclasses import replace
from itertools import product
from random import Random

import pytest
from mdanim_lammps.engine.commands import SKIN
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import load_scene
from paths import SCENES

TOUCHING, BYTES_OF_PARTICLES, LOOKS = 5, 13, 14
"""Entries of the fix's vector."""
SOLID = "density 1000  elasticity 0.2 MPa"
PAIRS = {
    "boxes": ("box (6, 6, 6) cm  orientation axis (1, 1, 0) angle 5 deg", 6.6),
    "balls": ("sphere 3 cm", 6.3),
    "ball over box": ("sphere 3 cm", 6.3),
}
"""Shape of the upper object, and its height [cm]; the lower one has that of `LOWER`."""
END_OF_CUBE = "gravity (0, 0, -9.81)\ncontrol { time 1 s  resolution 1 cm }"
LOWER = {"boxes": "box (6, 6, 6) cm", "balls": "sphere 3 cm", "ball over box": "box (6, 6, 6) cm"}


def looks(prepared, name: str, speed: float) -> float:
    """Looks at two objects that rest near each other; far away another one flies off at this speed, which asks for new lists."""
    shape, height = PAIRS[name]
    text = (
        f"object a {{ shape {LOWER[name]}  position (0, 0, 0) cm  {SOLID} }}\n"
        f"object b {{ shape {shape}  position (0, 0, {height}) cm  {SOLID} }}\n"
        f"object c {{ shape box (3, 3, 3) cm  position (60, 0, 0) cm  {SOLID}  velocity ({speed}, 0, 0) }}\n"
        "control { time 1 s  frames 25 fps  resolution 1 cm }\n"
    )
    with Instance(prepared(text, f"at{speed:g}").plan) as instance:
        instance.setup()
        instance.run(2000)
        assert instance.fix_value("contact", 5) == 0.0 and instance.fix_value("contact", 6) == 1.0
        return instance.fix_value("contact", LOOKS)


@pytest.mark.parametrize("name", PAIRS)
def test_new_lists_alone_ask_for_no_look(prepared, name):
    """Looks at objects that come no nearer: no point is looked up more often than without."""
    still = looks(prepared, name, 0.0)
    assert still > 10.0
    assert looks(prepared, name, 2.0) < 1.5 * still


def film_of_crowd(resolution: float, frames: int, skins: float = 1.0, anew: int = 0) -> list[bytes]:
    """Frames of the crowd in cells of so many metres, with so many times the usual skin; every `anew` steps what is known of
    points without a contact is forgotten, as where a run is resumed."""
    scene = load_scene(SCENES / "crowd.txt")
    ready = prepare(replace(scene, expects=(), control=replace(scene.control, resolution=resolution)))
    steps, film = round(0.04 / ready.certificate.timestep), []
    with Instance(ready.plan) as instance:
        instance.lammps.lmp.command(f"neighbor {skins * SKIN * ready.plan.spacing!r} bin")
        instance.setup()
        for _ in range(frames):
            for begin in range(0, steps, anew or steps):
                if anew:
                    instance.put(instance.step, instance.state())
                instance.run(min(anew or steps, steps - begin))
            film.append(instance.array("x").tobytes() + instance.array("v").tobytes())
    return film


def test_contacts_begin_in_the_same_steps_however_often_lists_are_made():
    """Points of a ball lie outside of its cells: they go farther than its particles, which is counted until one is looked at."""
    assert film_of_crowd(0.04, 28) == film_of_crowd(0.04, 28, skins=0.7)


def test_what_is_lost_is_found_where_cells_are_now():
    """A blow turns coarse cells over, and points in contact with them are lost."""
    assert film_of_crowd(0.06, 45) == film_of_crowd(0.06, 45, skins=0.3)


def test_contacts_begin_in_the_same_cells_whatever_is_known_of_points():
    """Coarse cells are bent so much that a point may be in one of them and beyond another one, at another depth."""
    assert film_of_crowd(0.06, 16) == film_of_crowd(0.06, 16, anew=7)


SHAPES = ("box (9, 8, 7)", "sphere 4.5", "cylinder 4 cm 8", "ellipsoid (4, 4, 5)", "cone 5 cm 9", "torus 4 cm 1.8")


def thrown(seed: int, young: str) -> str:
    """Twelve soft objects that are thrown onto the ground and each other, so hard that cells are crushed."""
    random, lines = Random(seed), ["gravity (0, 0, -9.81)", "ground z 0 m", "walls from (-20, -20, -5) cm to (20, 20, 200) cm"]
    for z, x, y in product((8, 22, 36), (-9, 9), (-9, 9)):
        shape = random.choice(SHAPES)
        place = f"({x + random.uniform(-2, 2):.3f}, {y + random.uniform(-2, 2):.3f}, {z:.3f})"
        turn = f"({random.uniform(0, 90):.2f}, {random.uniform(0, 90):.2f}, {random.uniform(0, 90):.2f})"
        speed = f"({random.uniform(-1, 1):.3f}, {random.uniform(-1, 1):.3f}, {-random.uniform(0, 3):.3f})"
        spin = f"({random.uniform(-9, 9):.2f}, 0, {random.uniform(-9, 9):.2f})"
        lines.append(
            f"object o{len(lines)} {{ shape {shape} cm  position {place} cm  orientation euler {turn} deg  density 800"
            f"  elasticity {young}  friction 0.4  velocity {speed}  spin {spin} rad/s }}"
        )
    return "\n".join([*lines, "control { time 0.5 s  frames 50 fps  resolution 2 cm }\n"])


def film_of_thrown(plan, frames: int, anew: int) -> list[bytes]:
    """Frames of a scene; every `anew` steps its state is put."""
    steps, film = plan.certificate.steps_per_frame, []
    with Instance(plan) as instance:
        instance.setup()
        for _ in range(frames):
            for begin in range(0, steps, anew or steps):
                if anew:
                    instance.put(instance.step, instance.state())
                instance.run(min(anew or steps, steps - begin))
            film.append(instance.array("x").tobytes() + instance.array("v").tobytes())
    return film


@pytest.mark.parametrize(("seed", "young", "frames"), [(1, "0.2 MPa", 3), (4, "0.03 MPa", 5)])
def test_contacts_of_what_is_hit_hard_follow_from_the_state(prepared, seed, young, frames):
    """Earlier looks at a point decided in which of several cells it was, and with what energy its contact began."""
    plan = prepared(thrown(seed, young), f"thrown{seed}").plan
    assert film_of_thrown(plan, frames, 0) == film_of_thrown(plan, frames, 7)


def film_of_stairs(skins: float) -> list[bytes]:
    """Frames of the cube that tumbles down held stairs, with so many times the usual skin."""
    ready = prepare(replace(load_scene(SCENES / "stairs.txt"), expects=()))
    film = []
    with Instance(ready.plan) as instance:
        instance.lammps.lmp.command(f"neighbor {skins * SKIN * ready.plan.spacing!r} bin")
        instance.setup()
        for _ in range(45):
            instance.run(ready.certificate.steps_per_frame)
            film.append(instance.array("x").tobytes())
    return film


def test_contacts_with_what_is_held_begin_in_the_same_steps_however_often_lists_are_made():
    """The normal of a point is known before it comes to a side of the host."""
    assert film_of_stairs(1.0) == film_of_stairs(0.4)


def test_on_the_ground_a_cube_takes_part_with_its_lowest_particles(prepared):
    """A point of a cuboid is a particle. With all that is near the ground a cube of 6^3 cells would take twice the room."""
    ready = prepared(f"ground z 0\nobject a {{ shape box (6, 6, 6) cm position (0, 0, 3) cm {SOLID} }}\n{END_OF_CUBE}")
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(2)
        assert instance.fix_value("ground", TOUCHING) == 7 * 7 + 4 * 7
        assert instance.fix_value("ground", BYTES_OF_PARTICLES) < 18_000


def test_points_of_balls_that_fly_past_each_other_are_put_off_without_a_look(prepared):
    """A cell is left between them; each look at a point of one takes a search for the nearest cell of the other."""
    ball = f"shape sphere 3 cm  {SOLID}  spin (0, 0, 40) rad/s"
    text = (
        f"object a {{ {ball}  position (-4, 0, 0) cm  velocity (1, 0, 0) }}\n"
        f"object b {{ {ball}  position (4, 7, 0) cm  velocity (-1, 0, 0) }}\n"
        "control { time 1 s  resolution 1 cm }\n"
    )
    with Instance(prepared(text).plan) as instance:
        instance.setup()
        instance.run(400)
        assert instance.fix_value("contact", 6) == 1.0  # near
        assert instance.fix_value("contact", LOOKS) < 100.0
