# SPDX-License-Identifier: GPL-2.0-only
"""The certificate: a bound that is rigorous and not needlessly strict, and what binds it."""

import math
import re
from types import SimpleNamespace

import numpy as np
import pytest
from certificate_samples import BOX, box, margin, pile, pool
from mdanim_lammps import features
from mdanim_lammps.certificate import fit_steps
from mdanim_lammps.engine.commands import physics
from mdanim_lammps.errors import DivergedError, RefusedError, SceneError
from mdanim_lammps.features.contact.barrier import plane_stiffness
from mdanim_lammps.run.loop import simulate
from twin.lattice import CORNER


def highest_frequency(system) -> float:
    """Exact highest angular frequency of the spring network, from its dense stiffness matrix."""
    n = system.particles
    matrix = np.zeros((n, 3, n, 3))
    for (i, j), k in zip(system.spring, system.stiffness):
        d = system.position[i] - system.position[j]
        block = k * np.outer(d, d) / (d @ d)
        matrix[i, :, i] += block
        matrix[j, :, j] += block
        matrix[i, :, j] -= block
        matrix[j, :, i] -= block
    root = np.repeat(np.sqrt(system.mass), 3)
    return math.sqrt(np.linalg.eigvalsh(matrix.reshape(3 * n, 3 * n) / np.outer(root, root))[-1])


@pytest.mark.parametrize("size", [1, 2, 4])
def test_bound_is_below_the_exact_limit_and_near_it(prepared, size):
    """Stay below 2/omega_max of the network, and within 25 % of it (physics: 1.00 for one cell, 1.24 for larger boxes)."""
    ready = prepared(box(size))
    exact = 2.0 / highest_frequency(ready.system)
    assert exact / 1.25 <= ready.certificate.bound <= exact * (1 + 1e-12)


def test_corner_of_a_cube_sets_the_bound(prepared):
    """Give omega = 2.63 sqrt(E/rho)/h for a cube, whose corner binds."""
    c = prepared(box()).certificate
    assert c.bound == pytest.approx(2.0 / (math.sqrt(CORNER) * math.sqrt(1e5 / 1000) / 0.01), rel=1e-12)
    assert (c.object, c.cause) == ("a", "springs")
    assert c.timestep <= 0.5 * c.bound


def test_stiffest_object_binds(prepared):
    """Name the object that is 1000 times stiffer."""
    text = box().replace(
        "control", "object b {\n shape box (4, 4, 4) cm\n position (1, 0, 0) m\n density 1000\n elasticity 100 MPa\n}\ncontrol"
    )
    c = prepared(text).certificate
    assert c.object == "b"
    assert c.span.text.strip() == "elasticity 100 MPa"


TWO = BOX.replace(
    "control", "object b {{\n shape box (4, 4, 4) cm\n position (5, 0, 0) cm\n density 1000\n elasticity 100 kPa\n}}\ncontrol", 1
)


def two(model, control=""):
    """The cube and another one beside it."""
    return TWO.format(size=4, young=100, extra="", control=f"contact-model {model} {control}")


CONTACT = {"paper": 2 * plane_stiffness(1.6) * 0.4 * 8, "surface": 16 + 2 * plane_stiffness(0.8) * 0.4 * 8}
"""Addition of contact to CORNER (docs/physics-contact.md): the barrier; at surfaces 2 (3/4 + 1/4) 8, and the barrier behind."""
MODELS = pytest.mark.parametrize("model", CONTACT)


@MODELS
def test_contact_shortens_the_step(prepared, model):
    """Include contact once there are two objects that may meet."""
    alone, together = prepared(box()).certificate.bound, prepared(two(model)).certificate.bound
    assert together == pytest.approx(alone * math.sqrt(CORNER / (CORNER + CONTACT[model])), rel=1e-3)


@MODELS
@pytest.mark.parametrize("factor", [0.1, 4, 100])
def test_stiffer_contact_shortens_the_step_more(prepared, factor, model):
    """Scale the part of contact in the bound, and that of the ground, with what the scene says, by --set too."""
    told = two(model, f"contact-stiffness {factor}")
    usual, c = prepared(two(model)).certificate, prepared(told).certificate
    contact = CONTACT[model]
    assert c.bound == pytest.approx(usual.bound * math.sqrt((CORNER + contact) / (CORNER + factor * contact)), rel=1e-2)
    assert margin(c, "contact").limit == pytest.approx(margin(usual, "contact").limit / math.sqrt(factor), rel=1e-9)
    fallen = "gravity (0, 0, -9.81)\nground z -1\n"
    walls = [margin(prepared(fallen + text).certificate, "wall").limit for text in (two(model), told)]
    assert walls[1] == pytest.approx(walls[0] / math.sqrt(factor), rel=1e-9)


def test_soft_contact_is_passed_through_sooner(prepared):
    """Lower the speed that contact stops where it is softer, name the line to change;
    stiffer contact stops no more than usual."""
    texts = (pile(extra="velocity (0, 0, 4)", high=10, z=15.5, control=f"contact-stiffness {f}") for f in (0.125, 1, 8))
    soft, usual, stiff = (margin(prepared(text).certificate, "closing speed") for text in texts)
    assert soft.limit == pytest.approx(0.25 * usual.limit) and stiff.limit == usual.limit
    assert (soft.severity, usual.severity) == ("warning", "ok")
    assert "contact-stiffness" in soft.span.text and "contact-stiffness 1" in soft.hint


def test_damping_shortens_the_step(prepared):
    """Solve dt^2 a + 2 dt b = 4 with the dashpots' part."""
    bounds = [prepared(box(extra=f"damping {zeta}" if zeta else "")).certificate.bound for zeta in (0, 0.01, 0.1, 1)]
    assert bounds == sorted(bounds, reverse=True) and bounds[3] < 0.5 * bounds[0] < bounds[1]


def test_step_above_the_bound_is_refused(prepared):
    """Refuse, name the object and the way out; insist with allow_unstable."""
    bound = prepared(box()).certificate.bound
    with pytest.raises(RefusedError, match=r"above the certified bound.*set by a \(springs\)"):
        prepared(box(control=f"timestep {1.01 * bound!r} s"))
    assert prepared(box(control=f"timestep {bound!r} s")).certificate.timestep <= bound


def scene(time, frames=30.0):
    """Parts of a scene that fit_steps reads."""
    return SimpleNamespace(control=SimpleNamespace(time=time, frames=frames, spans={}))


@pytest.mark.parametrize(
    ("time", "frames", "longest", "expected"),
    [
        pytest.param(3.0, 30.0, 1e-3, (34, 90, 0), id="whole frames"),
        pytest.param(3.0, 30.0, 1 / 30, (1, 90, 0), id="step as long as a frame"),
        pytest.param(3.01, 30.0, 1e-3, (40, 90, 12), id="last frame shorter: a multiple of ten steps per frame"),
        pytest.param(0.01, 30.0, 1e-3, (40, 0, 12), id="shorter than one frame"),
        pytest.param(1.0, 30.0, math.inf, (1, 30, 0), id="nothing vibrates"),
    ],
)
def test_fit_steps(time, frames, longest, expected):
    """Meet frames and end with one time step."""
    per_frame, whole, last = fit_steps(scene(time, frames), longest)
    assert (per_frame, whole, last) == expected
    dt = 1.0 / (frames * per_frame)
    assert dt <= longest * (1 + 1e-12)
    assert (per_frame * whole + last) * dt == pytest.approx(time, rel=1e-12)


@pytest.mark.parametrize(
    ("time", "longest", "expected"),
    [
        pytest.param(math.sqrt(3.0), 1e-2, (4, 51, 0), id="no fraction of small numbers"),
        pytest.param(0.1234, 1e-2, (4, 3, 0), id="500 steps in a frame"),
        pytest.param(0.1234, 1e-4, (500, 3, 351), id="steps as short as that"),
        pytest.param(1.73333, 1e-2, (4, 52, 0), id="a rounded number of frames"),
    ],
)
def test_a_run_whose_time_no_step_fits_ends_with_the_last_whole_frame(time, longest, expected):
    """Steps are no more than four times as short for the sake of the last frame."""
    assert fit_steps(scene(time), longest) == expected


@pytest.mark.parametrize(
    ("elasticity", "timestep", "cause", "way_out"),
    [
        pytest.param("100 kPa", "1e-9 s", "steps of 1e-9 s", "a longer time step", id="of the scene"),
        pytest.param("1e15 Pa", "auto", "set by a", "a softer or less damped object", id="of the bound"),
    ],
)
def test_steps_that_would_take_years_are_refused(prepared, elasticity, timestep, cause, way_out):
    """Few frames may have more steps than any machine runs: say what sets the step."""
    text = (
        "object a {\n shape box (4, 4, 4) cm\n position (0, 0, 0) m\n density 1e-3\n"
        f" elasticity {elasticity}\n}}\ncontrol {{ time 1e7 s  frames 1 fps  timestep {timestep} }}"
    )
    with pytest.raises(RefusedError, match=cause) as refused:
        prepared(text)
    assert way_out in str(refused.value) and "time 1e7 s" in str(refused.value)


@pytest.mark.parametrize(
    ("young", "height", "warned"),
    [
        pytest.param("100 kPa", 0.6, True, id="soft ball from 60 cm: 0.29 of the wave speed"),
        pytest.param("1 MPa", 0.6, False, id="stiffer"),
        pytest.param("100 kPa", 0.12, False, id="lower"),
    ],
)
def test_a_landing_that_is_too_hard_is_told(prepared, young, height, warned):
    """Warn when a fall ends at more than 0.2 of the wave speed, with an elasticity that will do."""
    text = (
        f"gravity (0, 0, -9.81)\nground z 0\nobject ball {{\n shape sphere 0.1\n position (0, 0, {height})\n density 1000\n"
        f" elasticity {young}\n}}\ncontrol {{ time 1 s }}"
    )
    found = [w for w in prepared(text).warnings if "crumpled" in w.message]
    assert bool(found) == warned
    if warned:
        assert found[0].span.line == 7 and "write elasticity" in found[0].hint


BALL = """gravity (0, 0, -9.81)
ground z 0
object ball {{
  shape {shape}
  position (0, 0, 0.62)
  density 1000
  elasticity {young} kPa
  {extra}
}}
control {{ time 0.8 s  frames 100 fps  resolution {h} cm  contact-model {model} }}
"""
"""Hits the ground at 0.15 of the wave speed with 360 kPa."""


def dents(ready, folder):
    """Warning of a run with cells that have stayed inside out, whether it goes on or is stopped; empty if there are none."""
    try:
        return " ".join(w.message for w in simulate(ready, folder).warnings if "inside out" in w.message)
    except DivergedError as stopped:
        assert "inside out" in stopped.why
        return stopped.why


ON_CORNER = "orientation euler (45, 35.2644, 0) deg"
ON_EDGE = "orientation euler (45, 0, 0) deg"


@pytest.mark.parametrize(
    ("shape", "h", "young", "extra", "limit", "model"),
    [
        pytest.param("sphere 0.12", 3, 360, "", 0.5 * (12 / 280) ** 0.45, "paper", id="8 cells: its lowest twelve fold"),
        pytest.param("sphere 0.12", 4, 400, "", 0.2, "paper", id="6 cells: 21 of 117 bear the blow"),
        pytest.param("sphere 0.12", 4, 215, "", 0.2, "paper", id="6 cells, nearly too fast for any lattice"),
        pytest.param("sphere 0.087", 3, 360, "", 0.5 * (4 / 88) ** 0.45, "paper", id="5.6 cells: 4 of 88 bear it"),
        pytest.param("sphere 0.12", 8, 360, "", 0.2, "paper", id="3 cells"),
        pytest.param("sphere 0.12", 3, 700, "", 0.5 * (12 / 280) ** 0.45, "paper", id="stiffer, so slower for its waves"),
        pytest.param("sphere 0.12", 3, 360, "damping 0.2", 0.5 * (12 / 280) ** 0.45, "paper", id="damped: no help"),
        pytest.param("ellipsoid (0.12, 0.12, 0.24)", 4, 360, "", 0.5 * (4 / 224) ** 0.45, "paper", id="pointed"),
        pytest.param("box (0.24, 0.24, 0.24)", 3, 360, "", 0.2, "paper", id="flat"),
        pytest.param("sphere 0.12", 3, 360, "", 0.2, "surface", id="8 cells, borne at the surface"),
        pytest.param("sphere 0.087", 3, 360, "", 0.2, "surface", id="5.6 cells, borne at the surface"),
        pytest.param("sphere 0.12", 3, 210, "damping 0.2", 0.2, "surface", id="8 cells, nearly too fast, at the surface"),
        pytest.param(
            "ellipsoid (0.12, 0.12, 0.24)", 4, 360, "", 0.5 * (4 / 224) ** 0.45, "surface", id="pointed, at the surface"
        ),
        pytest.param("box (0.24, 0.24, 0.24)", 3, 360, "", 0.2, "surface", id="flat, at the surface"),
    ],
)
def test_a_round_body_of_many_cells_folds_up_sooner(prepared, tmp_path, shape, h, young, extra, limit, model):
    """Warn of exactly the landings after which cells stay inside out, with a cure that cures."""
    ready = prepared(BALL.format(shape=shape, h=h, young=young, extra=extra, model=model))
    found = margin(ready.certificate, "amplitude")
    assert found.limit == pytest.approx(limit, rel=0.03)  # cells of a voxel body are a little smaller or larger than asked for
    assert found.used > 1.0 if found.severity == "warning" else found.used < 1.0
    if found.severity == "ok":
        assert not dents(ready, tmp_path)
        return
    assert found.span.line == 7 and "at the spot where it lands" in found.text
    assert found.text in dents(ready, tmp_path)
    told = re.search(r"write elasticity (\S+) (\wPa) or more, or resolution (\S+) (.m), or", found.hint)
    enough, kilo, coarser, size = told.groups()
    young_told = float(enough) * {"kPa": 1.0, "MPa": 1e3}[kilo]
    for cure in ({"young": young_told, "h": h}, {"young": young, "h": float(coarser) * {"cm": 1.0, "mm": 0.1}[size]}):
        cured = prepared(BALL.format(shape=shape, extra=extra, model=model, **cure))
        assert margin(cured.certificate, "amplitude").severity == "ok"
        assert not dents(cured, tmp_path)


@pytest.mark.parametrize(("turned", "share"), [(ON_CORNER, 0.75**0.5 / 8**3), (ON_EDGE, 1.0 / 8**2)], ids=["corner", "edge"])
def test_a_cube_folds_up_where_little_of_it_lands(prepared, tmp_path, turned, share):
    """On its corner or edge sooner than on its face; the cure cures. A cube that spins may land on its corner."""
    words = {"shape": "box (0.24, 0.24, 0.24)", "h": 3, "model": "surface"}
    ready = prepared(BALL.format(**words, young=360, extra=turned))
    found = margin(ready.certificate, "amplitude")
    assert found.limit == pytest.approx(0.75 * share**0.45, rel=1e-3) and found.severity == "warning"
    assert "inside out" in dents(ready, tmp_path)
    enough, kilo = re.search(r"write elasticity (\S+) (\wPa) or more", found.hint).groups()
    cured = prepared(BALL.format(**words, young=float(enough) * (1000 if kilo == "MPa" else 1), extra=turned))
    assert margin(cured.certificate, "amplitude").severity == "ok"
    assert not dents(cured, tmp_path)
    spins = prepared(BALL.format(**words, young=360, extra="spin (0, 0, 0.1)"))
    assert margin(spins.certificate, "amplitude").limit == pytest.approx(0.75 * (0.75**0.5 / 8**3) ** 0.45, rel=1e-3)


def test_a_cure_has_a_number_for_each_object(prepared):
    """Numbers of the cure, written for each object in one pass, leave no warning; of many objects all have one number."""
    cube = BALL.format(shape="box (0.24, 0.24, 0.24)", h=3, model="surface", young=360, extra=ON_CORNER)
    ball = "object ball[1] { shape sphere 0.05 position (1, 0, 2) density 1000 elasticity 40 kPa }\n"
    found = margin(prepared(cube + ball).certificate, "amplitude")
    assert " and 1 more may hit" in found.text and "resolution" not in found.hint
    cube_needs, unit, ball_needs = re.match(
        r"write elasticity (\S+) (\wPa) for ball, (\S+) kPa for ball\[1\] or more", found.hint
    ).groups()
    cured = cube.replace("360 kPa", f"{cube_needs} {unit}") + ball.replace("40 kPa", f"{ball_needs} kPa")
    assert margin(prepared(cured).certificate, "amplitude").severity == "ok"
    many = "".join(ball.replace("[1]", f"[{n}]").replace("(1,", f"({n},") for n in range(1, 6))
    assert re.match(
        r"write elasticity \S+ \wPa for all of them or more", margin(prepared(cube + many).certificate, "amplitude").hint
    )


@pytest.mark.parametrize(("held", "severity"), [("hold all", "warning"), ("", "ok")])
def test_a_held_body_breaks_no_fall(prepared, held, severity):
    """A cube that falls on its corner folds up on a held slab as on the ground, not on one that is thrown back."""
    slab = f"object slab {{ shape box (0.48, 0.48, 0.24)  position (0, 0, -0.24)  density 1000  elasticity 360 kPa  {held} }}"
    cube = BALL.format(shape="box (0.24, 0.24, 0.24)", h=3, model="surface", young=360, extra=ON_CORNER)
    ready = prepared(cube.replace("ground z 0", slab))
    assert "ground" not in {e.name for e in ready.plan.effects}
    assert margin(ready.certificate, "amplitude").severity == severity


@pytest.mark.parametrize(("model", "floor"), [("paper", 2), ("surface", 6)])
def test_buoyancy_is_a_spring_to_the_surface(prepared, model, floor):
    """Add rho_l V_i g/m_i over the height of a cell to every particle's rate, (rho_l/rho_s) g at corners, and no more: a rigid
    body bobs more slowly."""
    ready = prepared(pool(density=250))
    found = next(e for e in features.effects() if e.name == "buoyancy").rate(ready.context)
    system = ready.system
    np.testing.assert_allclose(found, 1000 * 9.81 / 0.05 * system.volume / system.mass, rtol=1e-12)
    texts = (pool(density=250, young=0.05, more=more) for more in ("", "effects { buoyancy off }"))
    soft, dry = (prepared(t.replace("control {", f"control {{ contact-model {model} ")).certificate for t in texts)
    # Corner: from springs, and from the floor: a quarter of E h on an eighth of a cell's mass is 2, the areas of three sides 6.
    # Middle of a face, whose fitted mass is below that of half a cell: 5.025 from springs, and 2 from the floor.
    middle = (system.volume / system.mass * 250)[system.share == 0.5].max()
    unit, lift = 50 / (250 * 0.05**2), 4 * 9.81 / 0.05
    for found, by_liquid in ((dry, 0.0), (soft, lift)):
        most = max((CORNER + floor) * unit + by_liquid, middle * (7.025 * unit + by_liquid))
        assert found.bound == pytest.approx(2.0 / math.sqrt(most), rel=1e-12)


@pytest.mark.parametrize(
    ("gamma", "drag", "told"),
    [
        pytest.param(4, "", "", id="weak"),
        pytest.param(4000, "", "liquid drag is strong", id="liquid"),
        pytest.param(600, "drag 5000", "air drag and liquid drag is strong", id="strong together"),
    ],
)
def test_strong_drag_of_the_liquid_is_told(prepared, gamma, drag, told):
    """Count gamma rho_l V_i with the drag of air, and take the exponential form where phi is above 0.5."""
    ready = prepared(pool(liquid=f"drag {gamma}").replace("density 500", f"density 500\n  {drag}"))
    found = [w for w in ready.warnings if "is strong" in w.message]
    assert [w.message.startswith(told) for w in found] == [True] * bool(told)
    assert ("drag exp" in "\n".join(physics(ready.plan))) == bool(told)
    if told:
        lightest = (ready.system.volume / ready.system.mass).max()
        most = (gamma * 1000 * lightest + (5000 / 0.008 / 500 if drag else 0)) * ready.certificate.timestep / 2
        assert f"phi = {most:.2g}" in found[0].message


@pytest.mark.parametrize(
    ("density", "height", "level", "more", "speed"),
    [
        pytest.param(500, 1.1, 0.01, "", 4.41, id="light, shallow: to the floor"),
        pytest.param(500, 1.1, 0.5, "", None, id="light, deep: never reaches the floor"),
        pytest.param(2000, 1.6, 0.5, "", 4.95, id="heavy: down to the floor, with half its weight in the liquid"),
        pytest.param(2000, 1.6, 0.5, "effects { buoyancy off }", 5.42, id="no buoyancy: as through air"),
        pytest.param(
            500,
            1.6,
            0.2,
            "object raft { shape box (20, 20, 20) cm position (0.3, 0.3, 0.1) density 900 elasticity 1 MPa }",
            5.06,
            id="light, with another floating: to the surface",
        ),
    ],
)
def test_a_liquid_breaks_a_fall(prepared, density, height, level, more, speed):
    """Count a fall through air down to the surface, and from there what the liquid leaves of the weight."""
    found = [w for w in prepared(pool(density, height, 20, level, more=more)).warnings if "crumpled" in w.message]
    if speed is None:
        assert not found
    else:
        assert f"may hit at {speed:.2g} m/s" in found[0].message


@pytest.mark.parametrize(("time", "frames"), [(0.7777, 30), (1.0001, 24), (0.123456789, 60), (5.4321, 29.97)])
def test_a_run_that_ends_early_says_so(prepared, time, frames):
    """Where no time step fits both time and frames, a note tells the last frame. The time that is advised gives the same run."""
    text = (
        "object a {{ shape sphere 10 cm  position (0, 0, 1) m  density 1000 kg/m^3  elasticity 100 kPa }}\n"
        "control {{ time {} s  frames {} fps }}\n{}"
    )
    early = prepared(text.format(time, frames, "")).certificate
    whole = math.floor(time * frames)
    assert (early.frames, early.last_steps) == (whole, 0)
    note = next(n for n in early.notes if "no time step fits" in n.message)
    advised = re.fullmatch(r"write 'time (\S+) s'", note.hint)[1]
    assert f"the run ends with frame {whole}, at {advised} s" in note.message and note.severity == "note"
    assert float(advised) == pytest.approx(whole / frames, rel=1e-5)
    with pytest.raises(SceneError, match=f"is after the last whole frame, at {advised} s"):
        prepared(text.format(time, frames, f"expect a.position.z at {time} s = 0 +- 1 m"))
    exact = prepared(text.format(advised, frames, "")).certificate
    assert (exact.frames, exact.last_steps, exact.timestep) == (whole, 0, early.timestep)
    assert not any("no time step fits" in n.message for n in exact.notes)
