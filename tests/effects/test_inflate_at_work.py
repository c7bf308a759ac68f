# SPDX-License-Identifier: GPL-2.0-only
"""Inflated sheets: closed forms, the gas law when they are pressed, books, and what is refused."""

import re

import inflate_cases
import numpy as np
import pytest
from air_cases import made, residual
from inflate_cases import CASES, OUTSIDE
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.errors import SceneError
from mdanim_lammps.run.energy import energies
from mdanim_lammps.scene.lock import lock_text
from mdanim_lammps.scene.parse import parse_scene
from scipy.optimize import brentq

SLOW = {"ball swells, 20 cm, 1 mm of 3 MPa, 1 kPa", "ball swells, 1 m, 2 mm of 20 MPa, nothing outside"}
DOWN = "gravity (0, 0, -9.81) m/s^2\n"
BALL = "object ball { shape sphere 10 cm sheet thickness 1 mm  position (0, 0, 0.101) m  material rubber  resolution 2.5 cm"


@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.soak] if n in SLOW else []) for n in CASES])
def test_it_agrees_with_the_closed_form(name):
    """At the defaults of the language."""
    case, most = CASES[name]
    found, expected = case()
    assert found == pytest.approx(expected, rel=most)


def test_a_ball_that_a_block_presses():
    """Isothermal: (p + p0) V stays, and p rises where the block is heavy; the ledger closes."""
    block = "object block { shape box (30, 30, 10) cm  position (0, 0, 0.27) m  density 600  elasticity rigid }\n"
    text = f"{DOWN}ground z 0\n{BALL} inflate 3 kPa }}\n{block}"
    ready = made(text, 0.3)
    steps = round(0.02 / ready.certificate.timestep)
    rows = []
    with Instance(ready.plan) as instance:
        instance.setup()
        for _ in range(15):
            rows.append(instance.fix_rows("inflate", 1, 2)[0])
            instance.run(steps)
    volume, pressure = np.array(rows).T
    np.testing.assert_allclose((pressure + OUTSIDE) * volume, (3000.0 + OUTSIDE) * volume[0], rtol=1e-12)
    assert pressure.max() > 1.2 * np.median(pressure[:3])


def test_the_ledger_closes():
    """A ball that swells, falls and bounces off the ground."""
    assert residual(f"{DOWN}ground z 0\n{BALL.replace('0.101', '0.2')} inflate 2 kPa }}\n", 0.3) < 1e-3


def test_a_box_and_a_cylinder_swell_alike_and_do_not_move():
    """Forces of the gas have neither a sum nor a torque, whatever the shape."""
    for shape in ("box (20, 12, 8) cm", "cylinder 6 cm 20 cm", "torus 10 cm 4 cm"):
        body = f"shape {shape} sheet thickness 1 mm  position (0, 0, 0) m  density 1000  elasticity 3 MPa  resolution 2.5 cm"
        ready = made(f"object bag {{ {body}  inflate 1 kPa }}\n", 0.02)
        with Instance(ready.plan) as instance:
            instance.setup()
            force, x = instance.array("f").copy(), ready.system.position
            before = instance.fix_rows("inflate", 1, 2)[0]
            instance.run(round(0.01 / ready.certificate.timestep))
            after = instance.fix_rows("inflate", 1, 2)[0]
            v = instance.array("v").copy()
        scale = np.abs(force).sum()
        assert np.abs(force.sum(axis=0)).max() < 1e-12 * scale and np.abs(np.cross(x, force).sum(axis=0)).max() < 1e-12 * scale
        assert before[1] == pytest.approx(1000.0) and after[0] > before[0] and after[1] < before[1]
        momentum = np.abs(ready.system.mass @ v).max()
        assert momentum < 1e-9 * (ready.system.mass @ np.abs(v)).max()


@pytest.mark.parametrize(("pressure", "outside"), [("3 kPa", ""), ("500 Pa", "outside 0 Pa")])
def test_a_balloon_that_pops(pressure, outside):
    """It falls onto the point of a cone: its pressure is 0 from the first link that is gone on, what the gas could still give is
    lost, and the ledger closes. A run that begins with what is torn has none."""
    skin = "shape sphere 15 cm sheet thickness 2 mm  position (2, 0, 40) cm  density 1000  elasticity 800 kPa  damping 0.1"
    cone = "object cone { shape cone 3 cm 20 cm  position (0, 0, 10) cm  density 1000  elasticity rigid  hold all }\n"
    gas = f"inflate {pressure} {outside}  tear-strain 0.08"
    body = f"object balloon {{ {skin}  resolution 2.5 cm  velocity (0, 0, -3) m/s  {gas} }}\n"
    ready = made(f"{DOWN}{cone}{body}", 0.2)
    steps, told, seen = round(2e-3 / ready.certificate.timestep), [], []
    with Instance(ready.plan) as instance:
        instance.setup()
        for _ in range(50):
            volume, p = instance.fix_rows("inflate", 1, 2)[0]
            told.append(energies(instance, ready.system.center_of_mass(instance.array("x"))))
            seen.append((bool(instance.column("torn").any()), volume, p))
            instance.run(steps)
        torn = instance.column("torn").copy()
    torn_at = [gone for gone, _, _ in seen].index(True)
    assert torn_at > 5 and all((p == 0.0) == (v == 0.0) == gone for gone, v, p in seen)
    assert told[torn_at - 1]["gas_loss"] == 0.0 and told[-1]["gas"] == 0.0
    assert told[-1]["gas_loss"] == told[torn_at]["gas_loss"]
    total, most = [sum(row.values()) for row in told], max(np.ptp([row[name] for row in told]) for name in told[0])
    assert np.ptp(total) < 1e-3 * most < 0.1 * abs(told[-1]["gas_loss"])
    ready.plan.columns["torn"][:] = torn
    with Instance(ready.plan) as instance:
        instance.setup()
        assert (instance.fix_rows("inflate", 1, 2) == 0.0).all()


def one(body: str):
    return parse_scene(f"object a {{ {body} }}\ncontrol {{ time 1 s }}\n").solids[0]


CONTROL = "control { time 0.1 s }\n"
SHELL = "shape sphere 10 cm sheet thickness 1 mm position (0, 0, 1) m material rubber"
SOLID = "shape sphere 10 cm position (0, 0, 1) m material rubber"
FLAT = "shape sheet (1, 1) m thickness 1 mm position (0, 0, 1) m material rubber"
MISTAKES = [
    (f"{SOLID} inflate 2 kPa", "has no room for gas"),
    (f"{FLAT} inflate 2 kPa", "has no room for gas"),
    (f"{SHELL} inflate -2 kPa", "pressure above that outside"),
    (f"{SHELL} inflate 2 kPa outside -1 Pa", "a pressure outside of -1 Pa"),
    (f"{SHELL} inflate 0 kPa outside 0 Pa", "there is no gas"),
]


@pytest.mark.parametrize(("body", "cause"), MISTAKES, ids=[cause for _, cause in MISTAKES])
def test_mistakes(body, cause):
    """Each at its place, with a way out."""
    with pytest.raises(SceneError) as error:
        one(body)
    (problem,) = error.value.problems
    assert cause in problem.message and problem.hint and problem.span.line == 1


def test_words_and_lock():
    """The pressure outside is that of air where it is not said."""
    assert (one(f"{SHELL} inflate 2 kPa").inflate.pressure, one(f"{SHELL} inflate 2 kPa").inflate.outside) == (2000.0, OUTSIDE)
    assert one(f"{SHELL} inflate 2 kPa outside 0 Pa").inflate.outside == 0.0
    scene = parse_scene(f"object a {{ {SHELL} inflate 2 kPa outside 1 Pa }}\ncontrol {{ time 1 s }}\n")
    assert parse_scene(lock_text(scene), scene.name) == scene


def test_open_meshes_are_refused_and_thin_balloons_are_told(prepared, tmp_path):
    """Gas would go out of a bag with a hole; a sheet that is too thin swells without end."""
    (tmp_path / "bag.stl").write_text(inflate_cases.open_box())
    with pytest.raises(SceneError, match=r"the surface of bag is open at \d+ edges"):
        prepared(
            f'object bag {{ shape mesh "{tmp_path}/bag.stl" sheet thickness 1 mm  position (0, 0, 0) m  material rubber'
            "  inflate 1 kPa }\ncontrol { time 0.1 s }\n"
        )
    told = [prepared(f"object a {{ {SHELL} resolution 3 cm inflate {p} kPa }}\n{CONTROL}") for p in (1, 9, 150)]
    calm, soft, thin = ([w.message for e in r.context.resolved.effects for w in e.warnings(r.context)] for r in told)
    assert not any("swells" in text for text in (*calm, *soft))
    assert any("a swells to 1.3 times its size, as a ball" in text for text in thin), thin
    left = [note.message for note in told[1].certificate.notes]
    assert any("a swells to 1.024 times its size, and 1.4 kPa of 9 kPa are left" in text for text in left), left


@pytest.mark.parametrize(("r", "t", "p", "h"), [(0.15, 1e-3, 5e3, 0.03), (0.1, 5e-4, 9e3, 0.03), (0.3, 1e-3, 2e3, 0.05)])
def test_the_pressure_that_is_left_is_that_of_the_closed_form(prepared, r, t, p, h):
    """p left = 2 E t (s - 1)/((1 - nu) s^2 r), within 5 %: 2 for the corners of the ball, 3 for two digits."""
    ready = prepared(
        f"object a {{ shape sphere {r} m sheet thickness {t} m  position (0, 0, 0) m  material rubber  inflate {p} Pa }}\n"
        f"control {{ time 0.1 s  resolution {h} m }}\n"
    )
    stiff = 2.0 * ready.scene.solids[0].elasticity.modulus * t / ((1.0 - inflate_cases.NU) * r)
    s = brentq(lambda s: stiff * (s - 1.0) / s**2 - (p + OUTSIDE) / s**3 + OUTSIDE, 1.0, 1.9)
    (note,) = (note.message for note in ready.certificate.notes if "are left" in note.message)
    number, unit = re.search(r"and ([0-9.]+) (k?Pa) of", note).groups()
    assert float(number) * (1e3 if unit == "kPa" else 1.0) == pytest.approx(stiff * (s - 1.0) / s**2, rel=0.05)


@pytest.mark.parametrize(("size", "sheet", "told"), [
    ("(60, 40, 10) cm", "sheet thickness 1 mm  material rubber  inflate 2 kPa", True),
    ("(30, 30, 30) cm", "sheet thickness 1 mm  material rubber  inflate 2 kPa", True),
    ("(30, 30, 30) cm", "sheet thickness 5 mm  density 1000  elasticity 1 GPa  inflate 90 kPa", False),
])  # fmt: skip
def test_boxes_that_bulge_are_told(prepared, size, sheet, told):
    """Flat sides bear nothing until they bulge; of a pressure of two hundredths of that outside nearly all is lost."""
    ready = prepared(
        f"object a {{ shape box {size} {sheet}  position (0, 0, 0) m }}\ncontrol {{ time 0.1 s  resolution 5 cm }}\n"
    )
    assert any("flat sides of a bulge" in note.message for note in ready.certificate.notes) == told
