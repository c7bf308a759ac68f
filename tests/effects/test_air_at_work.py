# SPDX-License-Identifier: GPL-2.0-only
"""Air against closed forms, its books, and light objects in storms; tests/lab/air_cases.py has the scenes."""

import air_cases
import numpy as np
import pytest
from air_cases import CASES, DOWN, made, residual
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.engine.sub_plan import SubPlans
from mdanim_lammps.features.air.effect import _skins

SLOW = {
    "plate face on, 1 MPa, 20 cm, 5 cm of 20 kg/m^3",
    "plate that turns, 1 MPa",
    "rope hangs in wind of 4 m/s",
    "windmill, 4 m/s",
}


@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.soak] if n in SLOW else []) for n in CASES])
def test_it_agrees_with_the_closed_form(name):
    """At the defaults of the language."""
    case, most = CASES[name]
    found, expected = case()
    assert found == pytest.approx(expected, rel=most)


@pytest.mark.parametrize(("shape", "area", "drag"), [
    ("box (0.2, 0.3, 0.4) m", 0.52, None), ("sphere 0.2 m", None, 0.6), ("cylinder 0.1 m 0.4 m", None, None),
    ("ellipsoid (0.1, 0.2, 0.3) m", None, None), ("cone 0.1 m 0.3 m", None, None),
])  # fmt: skip
@pytest.mark.parametrize("elasticity", ["rigid", "300 kPa"])
def test_panels_push_as_the_drawn_surface_does(shape, area, drag, elasticity):
    """The force on an object at rest in wind is the integral over its drawn surface, whatever it is made of; a ball has a drag
    coefficient of C/2."""
    turned = "position (5, 0, 0) m  orientation axis (1, 2, 0) angle 30 deg"
    one = f"object one {{ shape {shape}  {turned}  density 100  elasticity {elasticity} }}\n"
    ready = made(f"air {{ wind (2, 3, 6) m/s }}\n{one}", 0.1)
    with Instance(ready.plan) as instance:
        instance.setup()
        force = instance.fix_rows("air", 1, 3)[0]
    surface = ready.models[0].surface
    place = surface.vertices(ready.system.position)
    a, b, c = (place[corner] for corner in surface.triangle.T)
    normal = 0.5 * np.cross(b - a, c - a)
    size, wind = np.linalg.norm(normal, axis=1), np.array([2.0, 3.0, 6.0])
    u = np.minimum(normal @ wind / size, 0.0)
    expected = (-0.72 * (u**2)[:, None] * normal).sum(axis=0)
    np.testing.assert_allclose(force, expected, rtol=0.02, atol=0.01 * np.linalg.norm(expected))
    if drag is not None:
        assert 2 * len(_skins(ready.context)[0].parts[0].at) < len(surface.triangle)
        assert np.linalg.norm(force) == pytest.approx(0.6 * drag * np.pi * 0.2**2 * 49.0, rel=0.01)
    if area is not None:
        assert _skins(ready.context)[0].area == pytest.approx(area, rel=1e-9)


AT = "position (0, 0, 0) m"
BOOKS = {
    "a plate that falls and glides": f"{DOWN}air {{ wind (3, 0, 0) m/s }}\nobject plate {{ shape box (20, 20, 1) cm  {AT}"
    "  orientation axis (0, 1, 0) angle 20 deg  density 60  elasticity rigid  spin (1, 2, 3) rad/s }\n",
    "an elastic block in wind": f"air {{ wind (10, 2, 0) m/s }}\nobject block {{ shape box (20, 10, 10) cm  {AT}"
    "  density 20  elasticity 100 kPa  spin (0, 5, 0) rad/s }\n",
    "a held bar in gusts": "air { wind at 0 s (0, 0, 0) m/s\n wind at 0.1 s (20, 0, 0) m/s\n wind at 0.2 s (-5, 3, 0) m/s }\n"
    f"object bar {{ shape box (10, 10, 40) cm  {AT}  density 50  elasticity 200 kPa  hold face -z }}\n",
    "a driven plate": f"air {{ }}\nobject fan {{ shape box (40, 10, 2) cm  {AT}  density 500  elasticity rigid  hold all"
    "  drive turn (20, 0, 0) rad/s }\nobject ball { shape sphere 5 cm  position (0, 0, 1) m  density 10  elasticity rigid"
    "  velocity (0, 0, 20) m/s }\n",
}


@pytest.mark.parametrize("name", BOOKS)
def test_the_ledger_closes(name):
    """With the work of the wind and what the air takes."""
    assert residual(BOOKS[name], 0.5) < 1e-3


@pytest.mark.parametrize("elasticity", ["rigid", "100 kPa"])
def test_a_light_plate_in_a_storm(elasticity):
    """Foil of 80 g/m^2 and a block of foam in a wind of 60 m/s: no speed above that of the wind along it."""
    size = "(20, 20, 0.1) cm" if elasticity == "rigid" else "(10, 10, 5) cm"
    density = 80 if elasticity == "rigid" else 5
    block = f"object foil {{ shape box {size}  position (0, 0, 0) m  orientation axis (0, 1, 0) angle 80 deg  density {density}"
    ready = made(f"air {{ wind (60, 0, 0) m/s }}\n{block}  elasticity {elasticity} }}\n", 0.05)
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(round(0.05 / ready.certificate.timestep))
        v = air_cases.mean(ready, instance.array("v"))
    assert np.isfinite(v).all() and 10.0 < v[0] < 60.0 and np.linalg.norm(v - [60.0, 0, 0]) < 60.0


def test_ropes_of_one_shape_tear_each_by_its_own_strain(prepared):
    """Air goes through links beyond 1.3 times the strain at which they tear: 1 cm, by 0.1 and by 2."""
    rope = "object {} {{ shape rope from (0, 0, 1) m to (0, 0.5, 1) m thickness 1 cm density 900 elasticity 1 MPa {} }}\n"
    text = "air { wind (5, 0, 0) m/s }\n" + rope.format("weak", "tear-strain 0.1") + rope.format("strong", "tear-strain 2")
    table = prepared(text + "control { time 0.1 s }\n").plan.tables["air"].splitlines()
    first = [line.split()[-1] for line in table if line.startswith("cylinder 1 2 ")]
    assert [float(most) for most in first] == pytest.approx([0.0113, 0.036])


WINDY = """gravity (0, 0, -9.81) m/s^2
ground z 0
air { wind (20, 0, 0) m/s }
object sled { shape box (40, 20, 10) cm  position (0, 0, 0.05) m  density 125  elasticity 300 kPa  velocity (1, 0, 0) m/s }
object load { shape box (10, 10, 10) cm  position (0, 0, 0.15) m  density 500  elasticity 300 kPa  velocity (1, 0, 0) m/s }
"""


def test_friction_does_not_depend_on_how_long_the_wind_may_blow(prepared):
    """A load stays on its sled in a wind of 20 m/s, in a scene of any length: friction was off in long ones."""
    found = []
    for seconds in (0.2, 3.0):
        ready = prepared(WINDY + f"control {{ time {seconds} s  friction 0.5 }}")
        with Instance(ready.plan) as instance:
            instance.setup()
            instance.run(round(0.2 / ready.certificate.timestep))
            found.append(ready.system.center_of_mass(instance.array("v")))
    sled, load = found[0][:, 0]
    assert load == pytest.approx(sled, abs=0.2)  # it slipped off at 1.2 m/s
    np.testing.assert_allclose(found[1], found[0], atol=0.02)
    told = {m.name: m for m in ready.certificate.margins}["closing speed"]
    assert told.severity == "warning" and "by the wind" in told.text and "wind at T" in told.hint and told.span.line == 3


def test_parts_of_a_scene_have_the_skins_of_the_whole(prepared):
    """Equal objects share one, whose last digits depend on where the first of them stands, also in an executor without that."""
    box = "object box[{n}] {{ shape box (8, 8, 8) cm position ({x}, 0.17, {x}/3) m density 300 elasticity rigid }}\n"
    text = "".join(box.format(n=n, x=x) for n, x in enumerate((0.1, 0.7, 1.9)))
    ready = prepared(text + "air { wind (4, 0, 0) m/s }\ncontrol { time 0.1 s }\n")
    one, whole = SubPlans(ready.plan).part([2], False).tables["air"], ready.plan.tables["air"]
    assert "like 1" in whole and one == whole[: whole.index("object 2 like 1")]
