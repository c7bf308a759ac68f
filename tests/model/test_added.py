# SPDX-License-Identifier: GPL-2.0-only
"""Ballast: mass, centre and moments of inertia in closed form, of the shape and of the particles; and what is refused."""

import math

import ballast_cases
import numpy as np
import pytest
from mdanim_lammps.certificate import note_lines
from mdanim_lammps.errors import SceneError
from mdanim_lammps.model import shapes
from mdanim_lammps.model.added import centre_of, tensor_of
from mdanim_lammps.model.build import build_models
from mdanim_lammps.scene.lock import lock_text
from mdanim_lammps.scene.parse import parse_scene

CONTROL = "control { time 1 s  resolution 2 cm }\n"


def one(body: str):
    """The object of a scene of one, and its model."""
    scene = parse_scene(f"object a {{ {body} }}\n{CONTROL}")
    return scene.solids[0], build_models(scene)[0]


def moments(model) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass, centre and tensor of inertia about it of particles."""
    mass = model.mass.sum()
    centre = model.mass @ model.position / mass
    x = model.position - centre
    return mass, centre, np.einsum("n,nij->ij", model.mass, (x**2).sum(1)[:, None, None] * np.eye(3) - x[:, :, None] * x[:, None])


def of_boxes(parts) -> tuple[float, np.ndarray, np.ndarray]:
    """The same of cuboids along the axes: density, low and high each."""
    mass = [rho * np.prod(np.subtract(high, low)) for rho, low, high in parts]
    middle = [np.add(low, high) / 2.0 for _, low, high in parts]
    total, centre = sum(mass), sum(m * c for m, c in zip(mass, middle)) / sum(mass)
    tensor = np.zeros((3, 3))
    for m, c, (_, low, high) in zip(mass, middle, parts):
        second = np.diag(np.subtract(high, low) ** 2 / 12.0) + np.outer(c - centre, c - centre)
        tensor += m * (np.trace(second) * np.eye(3) - second)
    return total, centre, tensor


CUBOID = "shape box (0.2, 0.1, 0.3) m  position (1, 2, 3) m  density 500 kg/m^3"
LOW = "ballast 8000 kg/m^3 within box (0, 0, 0) m to (9, 9, 2.9) m"
EAST = "ballast 100 kg/m^3 within box (1.05, 0, 2.9) m to (9, 9, 9) m"
PARTS = {
    "rigid": [(8000, (0.9, 1.95, 2.85), (1.1, 2.05, 2.9)), (500, (0.9, 1.95, 2.9), (1.1, 2.05, 3.15))],
    "two": [(8000, (0.9, 1.95, 2.85), (1.1, 2.05, 2.9)), (100, (1.05, 1.95, 2.9), (1.1, 2.05, 3.15)),
            (500, (0.9, 1.95, 2.9), (1.05, 2.05, 3.15))],
}  # fmt: skip


@pytest.mark.parametrize("elasticity", ["rigid", "1 MPa"])
@pytest.mark.parametrize(("name", "words"), [("rigid", LOW), ("two", f"{LOW} {EAST}")])
def test_a_cuboid_of_several_densities(elasticity, name, words):
    """To rounding: the shape, and its particles, of which those of a rigid one have the mass and the centre alone."""
    solid, model = one(f"{CUBOID} elasticity {elasticity} {words}")
    mass, centre, tensor = of_boxes(PARTS[name])
    found = moments(model)
    assert shapes.mass(solid) == pytest.approx(mass, rel=1e-12) and found[0] == pytest.approx(mass, rel=1e-12)
    np.testing.assert_allclose(centre_of(solid) + solid.position, centre, rtol=0, atol=1e-13)
    np.testing.assert_allclose(found[1], centre, rtol=0, atol=1e-12)
    np.testing.assert_allclose(tensor_of(solid), tensor, rtol=0, atol=1e-12 * np.trace(tensor))
    if elasticity != "rigid":
        np.testing.assert_allclose(found[2], tensor, rtol=0, atol=1e-9 * np.trace(tensor))
    assert model.mass.min() > 0.0
    near = model.position[:, 2] < 2.9
    if elasticity != "rigid":  # most of the mass is where the ballast is
        assert model.mass[near].sum() > 0.6 * mass


@pytest.mark.parametrize(("r", "h"), [(0.1, 0.0), (0.03, -0.5), (2.0, 0.7)])
@pytest.mark.parametrize("elasticity", ["rigid", "1 MPa"])
def test_a_ball_with_a_heavy_cap(r, h, elasticity):
    """Caps of balls of several sizes: closed forms, to 1e-6, by two surfaces of triangles."""
    solid, model = one(
        f"shape sphere {r} m  position (0, 0, 0) m  density 700 kg/m^3  resolution {r / 4} m  elasticity {elasticity}"
        f"  ballast 2700 kg/m^3 within box (-9, -9, -9) m to (9, 9, {h * r}) m"
    )
    mass, z, moment = ballast_cases.of_ball(r, h * r, 700.0, 2700.0)
    assert shapes.mass(solid) == pytest.approx(mass, rel=1e-5)
    np.testing.assert_allclose(centre_of(solid), (0, 0, z), rtol=1e-5, atol=1e-9 * r)
    np.testing.assert_allclose(np.diag(tensor_of(solid))[:2], moment, rtol=1e-5)
    np.testing.assert_allclose(moments(model)[1], (0, 0, z), rtol=1e-5, atol=1e-9 * r)


def test_a_box_of_ballast_in_an_object_that_is_turned():
    """The box lies along the axes of the world: a cylinder on its side with its lower half heavy, as one that stands by an
    integral over its disc."""
    r, length, own, heavy = 0.05, 0.4, 300.0, 5000.0
    solid, _ = one(
        f"shape cylinder {r} m {length} m  position (0, 0, 0) m  orientation axis (0, 1, 0) angle 90 deg  density {own} kg/m^3"
        f"  elasticity rigid  ballast {heavy} kg/m^3 within box (-1, -1, -1) m to (1, 1, 0) m"
    )
    half = math.pi * r**2 * length / 2.0
    mass, first = own * 2 * half + (heavy - own) * half, -(heavy - own) * length * 2.0 * r**3 / 3.0
    assert shapes.mass(solid) == pytest.approx(mass, rel=1e-6)
    np.testing.assert_allclose(centre_of(solid), (0, 0, first / mass), rtol=1e-5, atol=1e-12)
    along = own * half * r**2 + (heavy - own) * half * r**2 / 2.0 - first**2 / mass
    assert tensor_of(solid)[0, 0] == pytest.approx(along, rel=1e-5)


def test_it_turns_about_its_centre_of_mass():
    """A spin gives that point no velocity, and particles the right ones."""
    for elasticity in ("rigid", "1 MPa"):
        solid, model = one(f"{CUBOID} elasticity {elasticity} {LOW} velocity (1, 0, 0) m/s spin (0, 3, 0) rad/s")
        mass, centre, _ = moments(model)
        np.testing.assert_allclose(model.mass @ model.velocity / mass, (1, 0, 0), atol=1e-12)
        spin = np.cross(solid.spin, model.position - centre)
        np.testing.assert_allclose(model.velocity, spin + (1, 0, 0), atol=1e-12)


def test_a_part_that_is_held_stays():
    """Velocities of what is held are 0; a mass in place of a density is that without ballast."""
    solid, model = one(
        f"{CUBOID.replace('density 500 kg/m^3', 'mass 3 kg')} elasticity 1 MPa {LOW} hold face -x spin (0, 3, 0) rad/s"
    )
    assert not model.velocity[model.held].any() and model.held.any()
    assert shapes.mass(solid) == pytest.approx(3.0 + 0.2 * 0.1 * 0.05 * (8000 - 500))


def test_it_goes_with_its_group_and_into_the_lock():
    """A group that is placed takes the box along."""
    group = f"group g {{ object a {{ {CUBOID} elasticity rigid {LOW} }} }}\nplace g {{ position (5, 0, 0) m }}\n{CONTROL}"
    scene = parse_scene(group)
    (solid,) = scene.solids
    assert solid.ballast[0].low == (5.0, 0.0, 0.0) and solid.ballast[0].high == (14.0, 9.0, 2.9)
    assert parse_scene(lock_text(scene), scene.name) == scene


MISTAKES = [
    (f"{CUBOID} elasticity rigid ballast 0 kg/m^3 within box (0, 0, 0) m to (9, 9, 9) m", "density above 0"),
    (f"{CUBOID} elasticity rigid ballast 9 kg/m^3 within box (0, 0, 0) m to (9, 0, 9) m", "has no volume"),
    (f"{CUBOID} elasticity rigid {LOW} ballast 9 kg/m^3 within box (0, 0, 2.8) m to (9, 9, 9) m", "share a part"),
    (f"{CUBOID} elasticity rigid hold all {LOW}", "is held as a whole"),
    (f"shape sheet (1, 1) m thickness 1 mm position (0, 0, 0) m density 300 kg/m^3 elasticity 1 MPa {LOW}", "part of a volume"),
]  # fmt: skip


@pytest.mark.parametrize(("body", "cause"), MISTAKES, ids=[cause for _, cause in MISTAKES])
def test_mistakes(body, cause):
    """Each at its place, with a way out."""
    with pytest.raises(SceneError) as error:
        parse_scene(f"object a {{ {body} }}\n{CONTROL}")
    (problem,) = error.value.problems
    assert cause in problem.message and problem.hint and problem.span.line == 1


def test_check_tells_where_the_centre_is_and_what_meets_nothing(prepared):
    """In the frame of the world."""
    ready = prepared(
        f"object a {{ {CUBOID} elasticity rigid {LOW} }}\n"
        f"object b {{ {CUBOID.replace('(1, 2, 3)', '(4, 2, 3)')} elasticity rigid ballast 9 kg/m^3 within box"
        " (0, 0, 0) m to (1, 1, 1) m }\n"
        "control { time 1 s }\n"
    )
    told = note_lines(ready.certificate)
    assert any("its centre of mass at (1, 2, 2.911) m" in text for text in told)
    assert any("the ballast of b meets nothing of it" in text for text in told)


@pytest.mark.parametrize("name", ballast_cases.CASES)
def test_it_agrees_with_the_closed_form(name):
    """At the defaults of the language."""
    case, most = ballast_cases.CASES[name]
    found, expected = case()
    assert found == pytest.approx(expected, rel=most)
