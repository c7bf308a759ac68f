# SPDX-License-Identifier: GPL-2.0-only
"""Objects with ``elasticity rigid``: how they are made, how they move, and what is refused."""

import re

import numpy as np
import pytest
from mdanim_lammps import Scene
from mdanim_lammps.effects.fields import Field, join_fields
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.errors import SceneError
from mdanim_lammps.features.contact.rigid_surfaces import frequency
from mdanim_lammps.features.rigid.shapes import polyhedron
from mdanim_lammps.features.rigid.touching import omega
from mdanim_lammps.model import shapes
from mdanim_lammps.model.spacing import plan_spacing
from mdanim_lammps.model.spin import spin
from mdanim_lammps.results.motion import MotionTable
from mdanim_lammps.run.energy import energies, tell
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene
from mdanim_lammps.scene.scene import Mesh
from model_samples import MESHES

BAR = """object bar {{
  shape box (10, 20, 30) cm
  position (0, 0, 1) m
  density 1000
  elasticity rigid
  {more}
}}
"""
CONCAVE = (
    f'object concave {{ shape mesh "{MESHES}/sliver.obj" scale 0.04 position (9, 0, 0.07) m density 500 elasticity rigid }}\n'
)
BLOCK = "object block { shape box (20, 20, 20) cm position (1, 0, 0.5) m density 500 elasticity 1 MPa }\n"
CONTROL = "control { time 0.5 s }\n"
M, MOMENTS = 6.0, 6.0 / 12 * np.array([0.2**2 + 0.3**2, 0.1**2 + 0.3**2, 0.1**2 + 0.2**2])
"""Mass and principal moments of the bar [kg], [kg m^2]."""


def bar(more="") -> str:
    return BAR.format(more=more)


def run(ready, steps, start=None):
    """Positions, velocities, kinetic energy at the start and at the end."""
    with Instance(ready.plan) as instance:
        instance.setup()
        begin = energies(instance, ready.system.center_of_mass(instance.array("x")))
        instance.run(steps)
        end = energies(instance, ready.system.center_of_mass(instance.array("x")))
        return instance.array("x").copy(), instance.array("v").copy(), begin, end


def test_it_has_few_particles_without_springs_and_sets_no_spacing(prepared):
    """Eight where features are all that acts, else two cells across; a soft object has the spacing that it has alone, and the
    rigid one none that is coarser."""
    alone = prepared(bar() + CONTROL)
    assert alone.system.particles == 8 and not len(alone.system.spring) and alone.system.rigid.all()
    assert np.diff(prepared(bar() + CONCAVE + CONTROL).system.first)[0] == 3 * 5 * 7
    card = "object card { shape box (20, 20, 0.4) cm position (0, 0, 3) m density 500 elasticity rigid }\n"
    ready = prepared(BLOCK + card + CONTROL)
    assert ready.context.spacing.h == prepared(BLOCK + CONTROL).context.spacing.h == pytest.approx(0.05)
    assert ready.context.spacing.of == pytest.approx((0.05, 0.002))


@pytest.mark.parametrize(("sizes", "cell"), [("10 cm 4 mm", 0.002), ("10 cm 12 cm", 0.03), ("1 cm 30 cm", 0.005)])
def test_a_disc_is_round_about_its_axis_alone(sizes, cell):
    """Two cells across the height of a coin beside something soft, four across a log."""
    coin = f"object coin {{ shape cylinder {sizes}  position (0, 0, 3) m  density 500  elasticity rigid }}\n"
    assert plan_spacing(parse_scene(BLOCK + coin + CONTROL)).of[1] == pytest.approx(cell)


def test_its_moments_are_those_of_its_shape(prepared):
    """Turned as the object is; the energy of a spin is w I w/2."""
    ready = prepared(bar("orientation axis (0, 0, 1) angle 90 deg  spin (3, 0, 0)") + CONTROL)
    np.testing.assert_allclose(ready.system.inertia[0], np.diag(MOMENTS[[1, 0, 2]]), rtol=1e-12, atol=1e-15)
    _, _, begin, _ = run(ready, 1)
    assert begin["kinetic"] == pytest.approx(0.5 * MOMENTS[1] * 9.0, rel=1e-12)


def test_it_falls_and_turns_freely(prepared):
    """The fall of a point, the shape unchanged, energy and angular momentum kept to rounding about a principal axis."""
    ready = prepared("gravity (0, 0, -9.81) m/s^2\n" + bar("spin (0, 0, 3)  velocity (1, 0, 2) m/s") + CONTROL)
    steps, dt = 200, ready.certificate.timestep
    x, v, begin, end = run(ready, steps)
    system, time = ready.system, steps * dt
    centre = system.center_of_mass(x)[0]
    np.testing.assert_allclose(centre, [time, 0, 1 + 2 * time - 0.5 * 9.81 * time**2], atol=1e-11)
    np.testing.assert_allclose(spin(system.mass, system.first[:-1], x, v)[0], [0, 0, 3], atol=1e-12)
    turn = 3.0 * time
    expected = system.position - [0, 0, 1]
    rotation = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    np.testing.assert_allclose(x - centre, expected @ rotation.T, atol=1e-9)
    assert end["kinetic"] + end["gravity"] == pytest.approx(begin["kinetic"] + begin["gravity"], rel=1e-12)


def test_a_soft_and_a_rigid_one_in_one_scene(prepared):
    """The leap-frog moves what is soft alone, fix mdanim/rigid the other; the ledger has the energy of both."""
    ready = prepared(BLOCK.replace("density", "velocity (0, 0, 2) m/s density") + bar("velocity (0, 1, 0) m/s") + CONTROL)
    _, _, begin, end = run(ready, 50)
    assert begin["kinetic"] == pytest.approx(0.5 * 4.0 * 4.0 + 0.5 * M, rel=1e-12)
    assert end["kinetic"] == pytest.approx(begin["kinetic"], rel=1e-12)


@pytest.mark.parametrize("other", [bar().replace("bar", "under").replace("0, 0, 1", "0, 0, 0.15"), "ground z 0 m\n"])
def test_it_comes_to_rest_on_what_it_falls_on(prepared, other):
    """On a rigid object that stands on the ground, and on the ground: it sinks in by no more than the rule says, and rests."""
    drop = 0.15 if "ground" in other else 0.45
    text = "gravity (0, 0, -9.81) m/s^2\n" + ("" if "ground" in other else "ground z 0 m\n") + other
    text += bar().replace("(0, 0, 1)", f"(0, 0, {drop + 0.005})") + "control { time 0.5 s  friction 0.5 }\n"
    ready = prepared(text)
    x, v, begin, end = run(ready, ready.certificate.steps)
    z = ready.system.center_of_mass(x)[-1, 2]
    contacts = 1 if "ground" in other else 2
    assert drop - contacts * 2e-3 * 0.1 < z <= drop and abs(v).max() < 1e-3
    gone = {term: end[term] for term in ("friction_heat", "contact_damping_loss", "contact", "wall") if term in end}
    assert sum(gone.values()) == pytest.approx(begin["gravity"] - end["gravity"], rel=5e-3)


def test_what_makes_no_sense_on_it_is_refused():
    """All of it in one pass, each with its place and a way out."""
    text = bar("damping 0.1\n  hold face -z") + CONTROL
    with pytest.raises(SceneError) as caught:
        parse_scene(text)
    told = {
        (p.span.line, re.match(r"bar is rigid: (\w+)|bar is rigid, so it cannot be (held)", p.message).group(0)[-6:])
        for p in caught.value.problems
    }
    assert {line for line, _ in told} == {6, 7} and all(p.hint for p in caught.value.problems)
    with pytest.raises(SceneError, match="the contact of the paper follows from the elasticity"):
        parse_scene(bar() + "control { time 1 s  contact-model paper }\n")


def test_held_it_is_a_wall(prepared):
    """With hold all nothing moves it, and a soft object on it yields alone: kappa is 2 E/h."""
    text = bar("hold all") + BLOCK.replace("1, 0, 0.5", "0, 0, 1.26")
    ready = prepared("gravity (0, 0, -9.81) m/s^2\n" + text + CONTROL)
    assert not ready.system.rigid.any() and not ready.resolved.on("rigid") and ready.system.still[0]
    young = ready.plan.columns["young"]
    assert 2.0 * young[-1] * young[0] / (young[-1] + young[0]) == pytest.approx(2.0 * young[-1], rel=1e-9)


SLOPE = 0.2
"""Angle of the slope [rad]."""
G = 9.81
ROLLING = {
    "ball": ("sphere 10 cm", "", 5 / 7),
    "cylinder": ("cylinder 10 cm 20 cm", "orientation axis (1, 0, 0) angle 90 deg", 2 / 3),
    "round ellipsoid": ("ellipsoid (10, 20, 10) cm", "", 5 / 7),
}


def on_slope(prepared, shape, more, friction, tangent=None, z=10):
    """Acceleration along the slope in the second half of half a second [m/s^2], and the end: place, velocity, spin."""
    angle = SLOPE if tangent is None else np.arctan(tangent)
    ready = prepared(
        f"gravity ({G * np.sin(angle)}, 0, {-G * np.cos(angle)}) m/s^2\nground z 0 m\n"
        f"object it {{ shape {shape} position (0, 0, {z}) cm density 1000 elasticity rigid {more} }}\n"
        f"control {{ time 0.5 s  friction {friction} }}\n"
    )
    system, half = ready.system, ready.certificate.steps // 2
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(half)
        before = system.center_of_mass(instance.array("v"))[0]
        instance.run(half)
        x, v = instance.array("x").copy(), instance.array("v").copy()
    end = system.center_of_mass(x)[0], system.center_of_mass(v)[0], spin(system.mass, system.first[:-1], x, v)[0]
    return (end[1] - before)[0] / (half * ready.certificate.timestep), *end


@pytest.mark.parametrize("name", ROLLING)
def test_it_rolls_down_a_slope(prepared, name):
    """5/7 g sin of a full ball, 2/3 of a full cylinder, to 1e-5, as the moments are those of the shape; no way to the side; it
    rolls on what is left of its radius where it sinks in."""
    shape, more, part = ROLLING[name]
    a, x, v, w = on_slope(prepared, shape, more, 0.5)
    assert a == pytest.approx(part * G * np.sin(SLOPE), rel=1e-5)
    assert abs(x[1]) < 1e-12 and abs(v[1]) < 1e-12
    assert w[1] * 0.1 == pytest.approx(v[0], rel=3e-3)


ON_BOX = {
    "full cylinder": ("cylinder 10 cm 10 cm", "orientation axis (1, 0, 0) angle 90 deg", 10, 2 / 3),
    "coin": ("cylinder 10 cm 1 cm", "orientation axis (1, 0, 0) angle 90 deg", 10, 2 / 3),
    "ring": ("torus 10 cm 3 cm", "orientation axis (1, 0, 0) angle 90 deg", 13, 1 / (1 + (0.1**2 + 0.75 * 0.03**2) / 0.13**2)),
    "ellipsoid": ("ellipsoid (10, 20, 10) cm", "", 10, 5 / 7),
}


@pytest.mark.parametrize("name", ON_BOX)
def test_it_rolls_on_a_held_box(prepared, name):
    """On a slope, by features: nothing takes a part. At points of surfaces a cylinder had 0.98 of this, and a ring drifted."""
    shape, more, z, part = ON_BOX[name]
    ready = prepared(
        f"gravity ({G * np.sin(SLOPE)}, 0, {-G * np.cos(SLOPE)}) m/s^2\n"
        "object ramp { shape box (4, 1, 0.2) m  position (1, 0, -0.1) m  density 1000  elasticity rigid  hold all }\n"
        f"object it {{ shape {shape}  position (0, 0, {z}) cm  {more}  density 1000  elasticity rigid }}\n"
        f"control {{ time 0.5 s  friction 0.5 }}\n"
    )
    half, speeds = ready.certificate.steps // 2, []
    with Instance(ready.plan) as instance:
        instance.setup()
        for _ in range(2):
            instance.run(half)
            speeds.append(ready.system.center_of_mass(instance.array("v"))[1])
    a = (speeds[1] - speeds[0]) / (half * ready.certificate.timestep)
    assert a[0] == pytest.approx(part * G * np.sin(SLOPE), rel=1e-5) and abs(speeds[1][1]) < 1e-9


def test_it_slides_and_stays(prepared):
    """g (sin - mu cos) of a box; and below the angle of friction it stays, to the last digit."""
    a, *_ = on_slope(prepared, "box (10, 10, 4) cm", "", 0.1, z=2)
    assert a == pytest.approx(G * (np.sin(SLOPE) - 0.1 * np.cos(SLOPE)), rel=1e-5)
    a, x, v, _ = on_slope(prepared, "box (10, 10, 4) cm", "", 0.5, tangent=0.48, z=2)
    assert abs(v).max() < 1e-12 and abs(x[0]) < 1e-4


def test_drag_slows_motion_and_spin(prepared):
    """The fall and the spin of a ball with m dv/dt = m g - lambda v, dL/dt = -lambda L/m, and what drag takes."""
    text = "object ball { shape sphere 10 cm position (0, 0, 5) m mass 2 elasticity rigid drag 3 spin (0, 0, 5) }\n"
    ready = prepared("gravity (0, 0, -9.81) m/s^2\n" + text + "control { time 1 s  timestep 1 ms }\n")
    _, _, begin, end = run(ready, ready.certificate.steps)
    rate, time = 3.0 / 2.0, ready.certificate.steps * ready.certificate.timestep
    speed, turning = 9.81 / rate * (1 - np.exp(-rate * time)), 5 * np.exp(-rate * time)
    assert end["kinetic"] == pytest.approx(0.5 * 2 * speed**2 + 0.5 * 0.4 * 2 * 0.01 * turning**2, rel=1e-5)
    assert end["drag_loss"] == pytest.approx(sum(begin[k] - end[k] for k in ("kinetic", "gravity")), rel=1e-9)


def test_it_floats_as_deep_as_archimedes_says(prepared):
    """Half immersed; its particles are as close as those of an elastic one, though it would do with few."""
    text = """gravity (0, 0, -9.81) m/s^2
object block { shape box (20, 20, 20) cm  position (0, 0, 0.42) m  density 500  elasticity rigid }
liquid water { basin from (-0.5, -0.5, 0) m to (0.5, 0.5, 1) m  density 1000  level 0.4 m  model surface }
control { time 2 s  frames 5 fps }
"""
    ready = prepared(text)
    assert ready.system.particles == 125
    x, *_ = run(ready, ready.certificate.steps)
    assert ready.system.center_of_mass(x)[0, 2] == pytest.approx(0.4, abs=1e-3)


def test_check_tells_how_deep_things_sink(prepared):
    """A blow by v/Omega, 2 % of the thinnest part, and rest by less than 1/1000; softer contact warns. A run finds them."""
    text = "gravity (0, 0, -9.81) m/s^2\nground z 0 m\n" + bar() + "control { time 0.6 s  friction 0.5  frames 50 fps MORE }\n"
    ready = prepared(text.replace("MORE", ""))
    told = {m.name: m for m in ready.certificate.margins}
    speed = ready.context.reach.speed[0]
    assert told["blow depth"].value == pytest.approx(0.02 * 0.1, rel=1e-9) and f"{speed:.3g}" in told["blow depth"].text
    assert 0.0 < told["rest depth"].value < 1e-3 * 0.1 and not ready.warnings
    softer = prepared(text.replace("MORE", "contact-stiffness 0.1"))
    assert [w.message for w in softer.warnings if "deep" in w.message]
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(ready.certificate.steps)
        deepest, bound = (instance.fix_value("rigid", entry) for entry in ("deepest", "worst_bound"))
        assert 0.0 < bound < 2.0 and tell(instance)["contact_bound"] == bound
    assert 0.3 * told["blow depth"].value < deepest < told["blow depth"].value


def test_parts_of_a_scene_have_the_largest_of_a_bound():
    """A field per run is the sum of its parts, or the largest of them."""
    sums, bounds = Field("count", "1"), Field("bound", "1", largest=True)
    parts = [(np.array([m]), {"count": value, "bound": value}) for m, value in enumerate((1.0, 3.0, 2.0))]
    found = join_fields((sums, bounds), lambda per: np.arange(4), np.zeros(3, bool), parts, {})
    assert found == {"count": 6.0, "bound": 3.0}


def test_tables_have_the_energy_of_the_shape(tmp_path):
    """Kinetic energies of objects add up to that of the ledger, whichever way a rigid one is turned."""
    more = "orientation axis (1, 2, 3) angle 50 deg  spin (3, 1, -2)  velocity (1, 0, 0) m/s"
    text = bar(more) + BLOCK.replace("density", "velocity (0, 0, 2) m/s density") + CONTROL
    run = Scene.from_text(text, "two").run(tmp_path / "o")
    with run.trajectory as trajectory:
        table = MotionTable(trajectory, np.arange(2))
        column = table.columns.index("kinetic") - 3
        found = [table.numbers(frame)[:, column].sum() for frame in range(len(trajectory))]
    np.testing.assert_allclose(found, run.ledger.array("kinetic"), rtol=1e-9)


def test_eight_particles_move_as_many_do(prepared):
    """A box that falls, turned, on another one, whether particles are two cells apart or at corners alone: a mesh with a
    triangle of no area, far away, makes the difference. It would make contact harder, too, but for `contact-stiffness`."""
    text = "gravity (0, 0, -9.81) m/s^2\nground z 0 m\n" + bar("orientation axis (1, 1, 0) angle 20 deg").replace(
        "0, 0, 1", "0, 0, 0.6"
    )
    text += bar().replace("bar", "under").replace("0, 0, 1", "0, 0, 0.15")
    control = "control { time 0.25 s  friction 0.5  timestep 0.05 ms }\n"
    few, many = prepared(text + control), prepared(text + CONCAVE + control)
    softer = (omega(few.context) / omega(many.context)) ** 2
    many = prepared(text + CONCAVE + control.replace("}", f"contact-stiffness {softer!r} }}"))
    assert np.diff(few.system.first).tolist() == [8, 8] and np.diff(many.system.first)[:2].tolist() == [105, 105]
    ends = []
    for ready in (few, many):
        x, v, *_ = run(ready, ready.certificate.steps)
        ends.append([ready.system.center_of_mass(x)[:2], ready.system.center_of_mass(v)[:2]])
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-3)


def test_planks_that_cross_are_seen():
    """Two that are in each other have no corner and no middle in the other."""
    plank = "object {name} {{ shape box ({size}) cm position ({x}, 0, 0) m density 500 elasticity rigid }}\n"
    text = plank.format(name="a", size="100, 4, 4", x=0.2) + plank.format(name="b", size="4, 100, 4", x=0) + CONTROL
    with pytest.raises(SceneError, match="b starts inside a"):
        prepare(parse_scene(text))


def test_a_convex_mesh_is_a_polyhedron():
    """Corners and faces without the diagonals of its triangles; what is not convex, or has too many corners, is not one."""
    cuboid = polyhedron(Mesh(MESHES / "cuboid.obj"))
    assert len(cuboid.corner) == 8 and sorted(map(len, cuboid.faces)) == [4] * 6
    for face in cuboid.faces:
        a, b, c = (cuboid.corner[k] for k in face[:3])
        assert np.cross(b - a, c - b) @ a > 0.0  # seen from outside, with the centre of mass inside
    assert polyhedron(Mesh(MESHES / "dumbbell.obj")) is None and polyhedron(Mesh(MESHES / "knot.ply")) is None


def test_a_mesh_of_a_cuboid_moves_as_the_cuboid(prepared):
    """It falls on the ground, turned, by the same contact."""
    low, high = shapes.extent(Mesh(MESHES / "cuboid.obj"))
    size = ", ".join(repr(float(x)) for x in high - low)
    ends = []
    for shape in (f"box ({size}) m", f'mesh "{MESHES / "cuboid.obj"}"'):
        top = float(np.linalg.norm(high)) + 0.05
        text = f"object it {{ shape {shape} position (0, 0, {top}) m density 1000 elasticity rigid "
        text += "orientation axis (1, 2, 0) angle 30 deg spin (0, 0, 1) }\n"
        control = "control { time 0.4 s  friction 0.5  timestep 0.1 ms }\n"
        ready = prepared("gravity (0, 0, -9.81) m/s^2\nground z 0 m\n" + text + control)
        assert ready.resolved.on("rigid") and "shapes-rigid" in ready.plan.tables
        x, v, *_ = run(ready, ready.certificate.steps)
        ends.append([ready.system.center_of_mass(x)[0], ready.system.center_of_mass(v)[0]])
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-6)


def test_what_may_fall_over_makes_contact_harder(prepared):
    """Where a ball comes, the top of a domino that stands may come down at sqrt(3 g H); where all stand, none does."""
    text = "gravity (0, 0, -9.81) m/s^2\nground z 0 m\n"
    text += "object domino { shape box (6, 20, 40) cm  position (0, 0, 0.2) m  density 600  elasticity rigid }\n"
    ball = "object ball { shape sphere 5 cm  position (-1, 0, 0.05) m  density 1000  elasticity rigid  velocity (1, 0, 0) m/s }\n"
    alone, hit = (frequency(prepared(t + "control { time 1 s  friction 0.5 }\n").context) for t in (text, text + ball))
    assert alone.speed == 0.0 and alone.omega == pytest.approx(2.0 * np.sqrt(9.81 * 0.06) / (0.02 * 0.06))
    assert hit.speed == pytest.approx(np.sqrt(3.0 * 9.81 * 0.4)) and hit.omega == pytest.approx(hit.speed / (0.02 * 0.06))
