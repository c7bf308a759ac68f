# SPDX-License-Identifier: GPL-2.0-only
"""Margins of the certificate: how far a scene stays from each of its limits."""

import json
import math

import pytest
from certificate_samples import box, margin, pile, pool
from mdanim_lammps import features
from mdanim_lammps.certificate import margin_lines


def test_every_object_has_its_own_bound(prepared):
    """Give each object's largest stable step; the smallest is the scene's."""
    c = prepared(pile(top="damping 0.3")).certificate
    bounds = [m for m in c.margins if m.name == "time step"]
    assert [m.object for m in bounds] == ["top", "foot"]
    assert bounds[0].limit == c.bound < bounds[1].limit
    assert all(m.value == c.timestep and m.severity == "ok" for m in bounds)
    stiff = prepared(pile(foot=1e5)).certificate
    assert margin(stiff, "time step", "foot").limit == stiff.bound < margin(stiff, "time step", "top").limit / 5


@pytest.mark.parametrize(("fraction", "severity"), [(0.65, "ok"), (0.75, "warning"), (0.999, "warning"), (1.01, "refused")])
def test_a_step_near_the_bound_is_told(prepared, fraction, severity, tmp_path):
    """Warn above 0.7 of the bound, where large motion may blow up; above the bound the user has insisted."""
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import load_scene

    bound = prepared(box()).certificate.bound
    (tmp_path / "near.txt").write_text(
        box(
            control=f"timestep {fraction * bound!r} s\n frames {1 / (fraction * bound)!r} fps\n time {100 * fraction * bound!r} s"
        ).replace("  time 1 s\n", "")
    )
    ready = prepare(load_scene(tmp_path / "near.txt"), allow_unstable=True)
    found = margin(ready.certificate, "time step")
    assert found.used == pytest.approx(fraction, rel=1e-9) and found.severity == severity
    assert [w.message.startswith("the time step") for w in ready.warnings] == [True] * (severity != "ok")


@pytest.mark.parametrize(("accuracy", "fraction"), [("preview", 0.7), ("balanced", 0.5), ("reference", 0.25)])
def test_accuracy_chooses_the_fraction(prepared, accuracy, fraction):
    """Take the accuracy's part of the bound; a target error counts as balanced."""
    c = prepared(box(control=f"accuracy {accuracy}\n frames 1000 fps")).certificate
    # As few steps per frame as will do.
    assert c.fraction <= fraction * (1 + 1e-12) < c.fraction * c.steps_per_frame / (c.steps_per_frame - 1)


@pytest.mark.parametrize(
    ("text", "stress"),
    [
        pytest.param(pile(), 1000 * 10 * 0.1 + 2000 * 10 * 0.2, id="all of what stands on it"),
        pytest.param(pile(x=5), 1000 * 10 * 0.1 + 2000 * 10 * 0.1, id="half of it is over it"),
        pytest.param(pile(x=11), 1000 * 10 * 0.1, id="beside it"),
        pytest.param(pile(wide=20), 1000 * 10 * 0.1 + 2000 * 10 * 0.2, id="what is over it of a wider one"),
    ],
)
def test_load_counts_what_stands_above(prepared, text, stress):
    """rho g H of the object and of the part of others over it, against 0.2 E."""
    c = prepared(text.replace("400 kPa", "40 MPa")).certificate  # so that the foot is the one that is nearest to its limit
    found = margin(c, "load")
    assert (found.object, found.limit) == ("foot", pytest.approx(0.2 * 100e3))
    assert found.value == pytest.approx(stress, rel=1e-9)


def test_a_foot_that_is_crushed_is_told(prepared):
    """Warn with an elasticity that will do."""
    ready = prepared(pile(foot=20))
    told = [w for w in ready.warnings if "crush strength" in w.message]
    assert len(told) == 1 and told[0].span.line == 7 and "write elasticity" in told[0].hint
    enough = float(told[0].hint.split()[2])
    assert margin(prepared(pile(foot=enough)).certificate, "load").severity == "ok"


@pytest.mark.parametrize(("x", "density", "told"), [(0, 1500, True), (0, 500, False), (50, 1500, False)])
def test_a_blow_on_what_yields_is_told(prepared, x, density, told):
    """Warn where the energy of motion by volume of what may land on it is above 0.15 E e; 1 m/s and a fall of 2 cm."""
    ready = prepared(
        f"""gravity (0, 0, -9.81)
ground z 0 m
object clay {{ shape box (6, 6, 4) cm position (0, 0, 2) cm density 1000 elasticity 0.2 MPa yield-strain 0.02 }}
object ball {{ shape sphere 3 cm position ({x}, 0, 9) cm density {density} elasticity rigid velocity (0, 0, -1) }}
control {{ time 0.2 s resolution 1 cm friction 0.4 }}
"""
    )
    found = [w for w in ready.warnings if "ball may hit clay" in w.message]
    assert len(found) == told
    assert not found or (found[0].span.line == 3 and "yield-strain 0.0" in found[0].hint)


def test_a_liquid_carries_its_share_of_the_load(prepared):
    """Count the weight less buoyancy: nothing for what floats."""
    assert margin(prepared(pool(density=500)).certificate, "load").value == 0.0
    half = margin(prepared(pool(density=2000, height=0.11)).certificate, "load")
    assert half.value == pytest.approx(1000 * 9.81 * 0.2, rel=1e-6)


@pytest.mark.parametrize(("thick", "cells", "severity"), [(2.5, 1, "warning"), (5, 2, "ok"), (10, 4, "ok")])
def test_a_thin_part_is_told(prepared, thick, cells, severity):
    """Count cells across the thinnest part; one cell is too stiff in bending."""
    found = margin(prepared(pile(high=thick, z=10.5 + thick / 2)).certificate, "thinnest part")
    assert found.object == ("top" if thick < 10 else "foot")
    assert found.value == pytest.approx(cells, rel=1e-6) and found.severity == severity


@pytest.mark.parametrize(
    ("top", "high", "speed", "limit", "severity"),
    [
        pytest.param("velocity (0, 0, -8)", 10, 8.0, 0.8, "ok", id="as fast as allowed almost"),
        pytest.param("velocity (0, 0, -20)", 10, 20.0, 0.8, "warning", id="faster"),
        pytest.param("velocity (3, 0, -4)", 2.5, 5.0, None, "ok", id="a sheet: less is allowed"),
        pytest.param("velocity (0, 0, -12)", 2.5, 12.0, None, "warning", id="a sheet, faster"),
    ],
)
@pytest.mark.parametrize(("model", "sheet"), [("paper", 0.5), ("surface", 0.35)])
def test_closing_speed_is_compared_with_tunnelling(prepared, top, high, speed, limit, severity, model, sheet):
    """Start and fall of two objects that may meet, against what the softer and thinner of them stops."""
    c = prepared(pile(top=top, high=high, z=10.5 + high / 2, control=f"contact-model {model}")).certificate
    limit = limit or sheet
    found = margin(c, "closing speed")
    fall = 2 * 10 * 0.105
    assert found.object == "top" and found.value == pytest.approx(math.sqrt(speed**2 + fall), rel=1e-6)
    assert found.limit == pytest.approx(min(0.8 * math.sqrt(120), limit * math.sqrt(240)), rel=1e-6)
    assert found.severity == severity


def test_objects_that_fly_towards_each_other_close_at_the_sum(prepared):
    """Add the speeds of two that meet head on."""
    c = prepared(pile(extra="velocity (0, 0, 4)", top="velocity (0, 0, -6)", high=10, z=15.5)).certificate
    assert margin(c, "closing speed").value == pytest.approx(math.sqrt(10.0**2 + 2 * 10 * 0.105), rel=1e-6)


def test_objects_that_fly_together_do_not_close(prepared):
    """Take the difference of velocities, not their size."""
    text = pile(extra="velocity (0, 0, 50)", top="velocity (0, 0, 50)").replace("gravity (0, 0, -10)", "")
    together = prepared(text).certificate
    assert margin(together, "closing speed").value == 0.0


@pytest.mark.parametrize(("sweeps", "severity"), [("", "ok"), ("sweeps 1", "warning"), ("sweeps 3", "ok")])
def test_sweeps_per_cell_travelled(prepared, sweeps, severity):
    """Divide the sweeps of an update by the cells that the fastest solid travels until then."""
    ready = prepared(pool(liquid=sweeps, young=1000, height=1.1))
    found = margin(ready.certificate, "sweeps")
    # A quarter of a cell of 5 cm, and what the cube falls in four more steps at the speed of half a metre's fall.
    stride = 0.25 + 4 * ready.certificate.timestep * math.sqrt(9.81) / 0.05
    assert found.value == pytest.approx(int(sweeps[-1]) / stride if sweeps else 8.0, rel=1e-6)
    assert found.severity == severity and found.least
    told = [w for w in ready.warnings if "is swept" in w.message]
    assert bool(told) == (severity == "warning")
    if told:
        assert told[0].hint == "write sweeps auto, or 3"


def test_drag_contact_and_wall_have_margins(prepared):
    """Give phi against 0.5, and what contact and walls alone would bear against the step."""
    ready = prepared(pile(extra="drag 2"))
    c = ready.certificate
    assert margin(c, "drag").value == pytest.approx(2 / 1.0 * c.timestep / 2, rel=1e-9) and margin(c, "drag").limit == 0.5
    rates = {e.name: e.of(ready.scene).rate(ready.context) for e in features.effects() if e.name in ("contact", "ground")}
    assert margin(c, "contact").limit == pytest.approx(2 / math.sqrt(rates["contact"].max()))
    assert margin(c, "wall").limit == pytest.approx(2 / math.sqrt(rates["ground"].max()))


def test_margins_are_only_of_what_is_on(prepared):
    """Leave out contact, walls, drag, liquid and falls where the scene has none."""
    assert {m.name for m in prepared(box()).certificate.margins} == {"time step", "amplitude", "thinnest part"}
    held = prepared(box(extra="hold all")).certificate
    assert not held.margins and held.to_json()["bound"] is None


def test_margins_are_plain_data(prepared):
    """Write each with its numbers, unit, severity and place; nothing that JSON has no word for."""
    stored = json.loads(json.dumps(prepared(pile()).certificate.to_json(), allow_nan=False))
    load = next(m for m in stored["margins"] if m["name"] == "load")
    assert load["unit"] == "Pa" and load["severity"] == "ok" and load["used"] == pytest.approx(load["value"] / load["limit"])
    assert load["span"].endswith("small.txt:7:14")


def test_margin_lines_tell_what_is_passed_and_sum_up_the_rest(prepared):
    """One line for each limit that is passed, with its place, and one for all that are kept."""
    *passed, kept = margin_lines(prepared(pile(foot=20)).certificate)
    assert len(passed) == 1 and "load" in passed[0] and "foot" in passed[0] and passed[0].endswith("small.txt:7:14]")
    assert kept.startswith("  kept ") and "time step 50 %" in kept and "load" not in kept
    assert len(margin_lines(prepared(box()).certificate)) == 1


def test_a_crowd_does_not_fill_the_certificate(prepared):
    """Tell the hundred smallest bounds."""
    text = (
        box()
        .replace("object a {", "repeat i in 0 .. 119 {\n object a[i] {")
        .replace("position (0, 0, 0) m", "position (i, 0, 0) m")
    )
    text = text.replace("elasticity 100 kPa\n  \n}", "elasticity (100 + i) * 1 kPa\n}\n}")
    bounds = [m for m in prepared(text).certificate.margins if m.name == "time step"]
    assert len(bounds) == 100 and bounds[0].object == "a[119]"
    assert [m.limit for m in bounds] == sorted(m.limit for m in bounds)
