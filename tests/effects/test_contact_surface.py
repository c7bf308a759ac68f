# SPDX-License-Identifier: GPL-2.0-only
"""Contact at the drawn surfaces: what LAMMPS is told, what the ledger, the bound and `check` say of it."""

import math

import numpy as np
import pytest
from mdanim_lammps import features
from mdanim_lammps.certificate import note_lines
from mdanim_lammps.effects import resolve
from mdanim_lammps.engine.commands import input_script
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.engine.sub_plan import SubPlans
from mdanim_lammps.errors import SceneError
from mdanim_lammps.features.contact.barrier import plane_stiffness
from mdanim_lammps.run.energy import ledger_terms, loss_terms
from mdanim_lammps.run.loop import simulate
from mdanim_lammps.scene.parse import parse_scene
from twin.lattice import CORNER

PILE = """gravity (0, 0, -9.81) m/s^2
ground z 0 m
walls from (-2, -2, -0.1) m to (2, 2, 3) m
object slab {{ shape box (40, 40, 10) cm  position (0, 0, 5) cm  density 1000  elasticity 1 MPa {slab} }}
repeat i in 1 .. 2 {{
  object cube[i] {{ shape box (10, 10, 10) cm  position (i/5 - 0.3, 0, {z}) m  density 1000  elasticity 400 kPa {cube} }}
}}
control {{ time 0.1 s  frames 100 fps  resolution 5 cm  contact-model surface  {control} }}
{more}
"""


def pile(more="", control="", slab="", cube="", z=0.15):
    """Two cubes, side by side on a slab that lies on the ground, faces touching."""
    return PILE.format(more=more, control=control, slab=slab, cube=cube, z=z)


POOL = """gravity (0, 0, -9.81) m/s^2
liquid w {{ basin from (0, 0, 0) m to (1, 0.8, 0.6) m  density 1000  level 0.25 m }}
object block {{ shape box (20, 20, 20) cm  position (0.5, 0.4, 0.4) m  density 500  elasticity 200 kPa }}
control {{ time 1 s  resolution 5 cm  contact-model surface {control} }}
{more}
"""


def commands(plan, name):
    """Commands that an effect of a plan writes for LAMMPS."""
    return next(e for e in plan.effects if e.name == name).commands(plan.context)


BARRIER = [
    "group inner type 1 2 5 6",
    "group boundary type 3 4 7 8",
    "fix barrier mobile mdanim/barrier boundary inner d_stiffness d_reach",
]

SOLID = "group solid type 1:8"
"""Objects that are laid aside leave this group."""


def test_objects_and_planes_in_lammps_terms(prepared):
    """Bodies, Young's modulus, friction; what objects touch; the short barrier behind the surfaces of objects."""
    plan = prepared(pile()).plan
    law = "mdanim/contact d_body d_young d_friction stiffness 1.0 among solid"
    assert commands(plan, "contact") == [SOLID, f"fix contact mobile {law} objects", *BARRIER]
    assert commands(plan, "ground") == [SOLID, f"fix ground mobile {law} plane z lo 0.0"]
    assert commands(plan, "walls") == [
        SOLID,
        f"fix walls mobile {law} plane x lo -2.0 plane x hi 2.0 plane y lo -2.0 plane y hi 2.0 plane z lo -0.1 plane z hi 3.0",
    ]
    basin = commands(prepared(POOL.format(control="", more="")).plan, "basin")
    assert basin == [SOLID, f"fix basin mobile {law} plane x lo 0.0 plane x hi 1.0 plane y lo 0.0 plane y hi 0.8 plane z lo 0.0"]


def test_stiffness_damping_and_pairs(prepared):
    """Settings of the scene that are not the usual ones are written once; pairs by molecules, lower one first."""
    more = "contact cube slab { friction 0.1 }\ncontact cube cube { contact-damping 0.7 }"
    plan = prepared(pile(more, "contact-stiffness 2 contact-damping 0.5 friction 0.25")).plan
    law = "mdanim/contact d_body d_young d_friction stiffness 2.0 damping 0.5 among solid"
    assert commands(plan, "contact")[1] == (
        f"fix contact mobile {law} objects pair 1 2 0.1 0.5 pair 1 3 0.1 0.5 pair 2 3 0.25 0.7"
    )
    assert commands(plan, "ground") == [SOLID, f"fix ground mobile {law} plane z lo 0.0"]


def test_pairs_of_a_part_have_its_numbers(prepared):
    """A part counts its objects anew, and knows nothing of others."""
    plan = prepared(pile("contact cube slab { friction 0.1 }\ncontact cube cube { friction 0.2 }")).plan
    parts = SubPlans(plan)
    assert commands(parts.part([1, 2], False), "contact")[1].endswith(" objects pair 1 2 0.2 0.3")
    assert commands(parts.part([0, 2], False), "contact")[1].endswith(" objects pair 1 2 0.1 0.3")
    assert "contact" not in [e.name for e in parts.part([1], False).effects]


def test_columns(prepared):
    """Kind, modulus and friction of each particle's object; a plane that is named has a column of its own."""
    plan = prepared(pile("contact ground cube[2] { friction 0.9 }", "friction 0.25", slab="friction 0.64")).plan
    first = plan.system.first
    by_object = {name: column[first[:-1]].tolist() for name, column in plan.columns.items()}
    assert by_object.pop("body") == plan.system.contact_kind.tolist() == [0, 1, 1]
    assert by_object.pop("young") == [1e6, 4e5, 4e5]
    assert by_object.pop("friction") == [0.64, 0.25, 0.25]
    assert by_object.pop("friction_ground") == [0.64, 0.25, 0.9]
    assert by_object.keys() == {"stiffness", "reach"}
    short = np.where(plan.system.boundary, 0.0, 0.8 * plan.system.spacing[plan.system.object])
    np.testing.assert_allclose(plan.columns["reach"], short)
    assert "d_friction_ground" in commands(plan, "ground")[1] and "d_friction " in commands(plan, "walls")[1]


def test_a_scene_pays_for_what_it_calls_for(prepared):
    """The ledger has losses where there is friction and damping; each model of contact leaves no trace in the other."""

    def terms(text):
        plan = prepared(text).plan
        found = ledger_terms(plan)
        stored = ("kinetic", "elastic", "gravity", *["contact"] * ("contact off" not in text), "wall")
        assert sorted(found) == sorted((*stored, *loss_terms(plan)))
        return loss_terms(plan)

    assert terms(pile()) == ("let_go",)
    assert terms(pile(control="friction 0.1")) == ("friction_heat", "contact_damping_loss", "let_go")
    assert terms(pile(control="friction 0.1 contact-damping 0")) == ("friction_heat", "let_go")
    assert terms(pile("contact cube slab { friction 0 contact-damping 0.5 }")) == ("contact_damping_loss", "let_go")
    assert terms(pile("effects { contact off }", "friction 0.1")) == ("friction_heat", "contact_damping_loss")
    assert terms(pile("effects { contact off }\ncontact walls slab { friction 1 }")) == ("friction_heat", "contact_damping_loss")
    paper = prepared(pile(z=0.2).replace("contact-model surface", "contact-model paper")).plan
    assert loss_terms(paper) == () and paper.columns.keys() == {"stiffness", "reach"}
    assert "mdanim/contact" in input_script(prepared(pile()).plan) and "mdanim/contact" not in input_script(paper)
    assert "mdanim/wall" not in input_script(prepared(pile()).plan) and "mdanim/wall" in input_script(paper)


def test_the_energy_of_contact_is_that_of_surfaces_and_barrier(prepared):
    """Both fixes are in the column and in what LAMMPS prints; cubes are pressed so deep into the slab that the barrier acts."""
    ready = prepared(pile())
    assert "f_contact f_barrier f_ground" in input_script(ready.plan)
    (contact,) = (e for e in ready.plan.effects if e.name == "contact")
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.array("x")[ready.system.object > 0, 2] -= 0.02
        instance.setup()
        instance.run(1)
        found = contact.energy(instance)
        behind = instance.fix_scalar("barrier")
        assert behind > 0.0 and found == instance.fix_scalar("contact") + behind
        assert contact.penetration(instance) == pytest.approx(0.02, abs=0.005)
        assert contact.clocks(instance).keys() == {"contact", "barrier"} and min(contact.clocks(instance).values()) > 0.0


def test_the_effects_of_a_scene_are_those_of_its_model():
    """One effect of each name, whichever the model; the table stays as it is."""
    for model in ("paper", "surface"):
        scene = parse_scene(pile(z=0.2).replace("contact-model surface", f"contact-model {model}"))
        resolved = resolve(features.effects(), scene)
        names = [type(e).__name__ for e in resolved.effects if e.name in ("contact", "ground", "walls")]
        surface = model == "surface"
        assert names == [f"{'Surface' if surface else 'Barrier'}{of}" for of in ("Contact", "Planes", "Planes")]
    assert [e.name for e in features.effects()] == list(resolved.verdicts)


# --- the bound ------------------------------------------------------------------------------------------------------


def rate(ready, name):
    """The share of an effect in the bound, each of shape (N,)."""
    return next(e for e in ready.plan.effects if e.name == name).rate(ready.context)


def lightness(system):
    """Mass of each particle over what its cells have, shape (N,)."""
    return system.mass / (system.density * system.cell_volume)[system.object] / system.share


def test_bound_of_a_corner(prepared):
    """16 f E / rho h^2 from the surface and 0.4 * 16 times the curvature of the short barrier.

    Ground and a wall load the area that the surface does with 12 of its 16 by 6 each: they add nothing.
    """
    for factor in (1.0, 3.0):
        ready = prepared(pile(control=f"contact-stiffness {factor}", slab="elasticity 400 kPa").replace("elasticity 1 MPa", ""))
        unit = factor * 4e5 / 1000 / 0.05**2
        corner = ready.system.share == ready.system.share.min()
        short = 2 * plane_stiffness(0.8) * 0.4 * 8  # as in tests/test_certificate.py
        light = lightness(ready.system)[corner]
        np.testing.assert_allclose(rate(ready, "contact")[corner] / unit * light, 16 + short, rtol=1e-2)
        np.testing.assert_allclose(rate(ready, "ground")[corner] / unit * light, 6, rtol=1e-9)
        soft = (CORNER + factor * (16 + short)) / light.min()
        assert ready.certificate.bound == pytest.approx(2 / math.sqrt(soft * 4e5 / 1000 / 0.05**2), rel=1e-2)


def test_bound_takes_the_stiffest_partner(prepared):
    """kappa = 2 E_A E_B / (E_A + E_B) / h: the cubes have the slab, the slab has the cubes."""
    ready = prepared(pile())
    system, found = ready.system, rate(ready, "contact")
    assert system.young.tolist() == [1e6, 4e5, 4e5]
    mean = 2 * 1e6 * 4e5 / 1.4e6
    for m in range(3):
        i = system.first[m]  # a corner: a quarter of the stiffness of its face
        own, partner = 0.25 * system.young[m], (4e5, 1e6, 1e6)[m]
        short = 2 * plane_stiffness(0.8) * 8 * 2 * own * partner / (own + partner)
        assert found[i] * lightness(system)[i] == pytest.approx((16 * mean + short) / 1000 / 0.05**2, rel=1e-2)


@pytest.mark.parametrize(
    ("shape", "sides"),
    [
        pytest.param("box (40, 30, 10) cm", 2 * (0.4 * 0.3 + 0.4 * 0.1 + 0.3 * 0.1), id="cuboid: its surface, exactly"),
        pytest.param("sphere 20 cm", None, id="ball: no less than its surface"),
    ],
)
def test_particles_carry_the_surface(prepared, shape, sides):
    """The areas of all particles add up to that of the drawn surface; weights below 0 add to them."""
    text = f"object a {{ shape {shape} position (0, 0, 0) m mass 1 kg elasticity 1 MPa }}\ncontrol {{ time 1 s resolution 5 cm }}"
    (body,) = prepared(text).system.contact_bodies.values()
    carried = body.carried
    assert carried.shape == body.node.shape and (carried >= 0.0).all()
    if sides:
        assert carried.sum() == pytest.approx(sides, rel=1e-12)
        # A corner carries a quarter of a face on each of three sides.
        assert carried[0] == pytest.approx(0.75 * 0.05**2, rel=1e-12)
    else:
        assert 1.0 - 1e-9 < carried.sum() / body.area.sum() < 1.6
        assert 0 < np.count_nonzero(carried) < len(carried)


def test_more_than_the_usual_damping_shortens_the_step(prepared):
    """Up to 0.3 it is covered by what the rate counts twice; a pair's own counts too, and none without friction."""
    usual, same, more, pair, bare = (
        prepared(pile(about, control)).certificate.bound
        for about, control in (
            ("", "friction 0.5"),
            ("", "friction 0.5 contact-damping 0"),
            ("", "friction 0.5 contact-damping 1"),
            ("contact cube cube { contact-damping 1 }", "friction 0.5"),
            ("", "contact-damping 1"),
        )
    )
    assert usual == same == bare and more < pair < usual


DROP = """gravity (1, 0, -9.81) m/s^2
ground z 0 m
object low {{ shape box (20, 20, 20) cm  position (0, 0, 0.1) m  density 1000  elasticity 1 MPa }}
object high {{ shape box (20, 20, 20) cm  position (0.03, 0.02, 0.36) m  orientation axis (1, 2, 0) angle 25 deg  density 1000
  elasticity 1 MPa  velocity (0, 0, -2) m/s }}
control {{ time 0.1 s  contact-model surface  friction 0.4  resolution 5 cm  contact-damping {damping}  {step} }}
"""


@pytest.mark.parametrize("damping", [0.3, 1.0])
def test_a_damped_blow_is_stable_up_to_the_bound(prepared, tmp_path, damping):
    """With all of the damping, at 0.95 of the bound, nothing is gained; heat and dashpots have their columns."""
    bound = prepared(DROP.format(damping=damping, step="")).certificate.bound
    ready = prepared(DROP.format(damping=damping, step=f"timestep {0.95 * bound} s"))
    result = simulate(ready, tmp_path)
    last = result.ledger.rows[-1]
    assert result.ledger.residual < 0.02
    assert last["friction_heat"] > 0.1 and last["contact_damping_loss"] > 0.1
    assert last["kinetic"] < 0.7 * result.ledger.rows[0]["kinetic"]


# --- what check says ------------------------------------------------------------------------------------------------


def test_a_barrier_does_not_bear_what_is_round(prepared):
    """Unless it is fast: the cells of a ball stand out of its surface, so that it would roll on their corners."""
    ball = "object ball { shape sphere 10 cm  position (0, 0, 0.5) m  density 1000  elasticity 400 kPa  VELOCITY }"
    slow, quick = (prepared(pile(ball.replace("VELOCITY", f"velocity (0, 0, {v}) m/s"))) for v in (-1, -15))
    for ready, bears in ((slow, False), (quick, True)):
        stiffness = ready.plan.columns["stiffness"]
        round_one = ready.system.object == ready.system.names.index("ball")
        assert stiffness[round_one].all() == stiffness[round_one].any() == bears
        assert stiffness[~round_one].all()
    assert rate(slow, "contact")[slow.system.object == slow.system.names.index("ball")].min() > 0.0


def test_fast_objects_keep_the_full_reach(prepared):
    """Above 0.3 of the wave speed of the softest the barrier has its full reach there, which the bound and `check` tell."""
    slow, quick = (prepared(pile(cube=f"velocity (0, 0, {-v})", z=0.3)) for v in (6.0, 6.6))
    assert 6.0 < 0.3 * math.sqrt(1.2 * 400) < 6.6
    own = [np.maximum.reduceat(r.plan.columns["reach"], r.system.first[:-1]) / r.system.spacing for r in (slow, quick)]
    assert own[0] == pytest.approx([0.8, 0.8, 0.8]) and own[1] == pytest.approx([1.6, 1.6, 1.6])
    assert quick.certificate.bound < 0.99 * slow.certificate.bound
    (note,) = [n for n in quick.certificate.notes if "full reach" in n.message]
    assert note.message.startswith("slab and 2 more may meet others at more than 0.3") and note.severity == "note"
    assert not [n for n in slow.certificate.notes if "full reach" in n.message]


PLATE = """object plate {{ shape box (120, 60, 10) cm  position (0, 0, -5) cm  density 1000  elasticity 1 MPa  hold faces x }}
object block {{ shape box ({w}, 50, 50) cm  position (5, 5, {z}) cm  density 1000  elasticity 1 MPa
  velocity (0, 0, {v}) m/s }}
control {{ time 0.4 s  frames 10 fps  resolution 10 cm  contact-model surface }}
"""
WAVE = math.sqrt(1.2e6 / 1000.0)


def test_a_thin_plate_stops_a_fast_block(prepared):
    """Half a cell off centre at half of the wave speed, where the surfaces alone let it pass: cells of the plate turn over."""
    ready = prepared(PLATE.format(w=50, z=33, v=-0.5 * WAVE))
    block = ready.system.object == 1
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(ready.certificate.steps)
        x, v = (instance.array(name)[:, 2] for name in "xv")
        assert x[block].mean() > x[~block].mean() + 0.3 and v[block].mean() > 0.1 * WAVE


def test_only_what_may_be_met_fast_is_a_barrier_where_it_is_thin(prepared):
    """Not what is slow or touches at the start, where faces coincide; needles earlier, and `check` expects less of them."""
    for v, z, w, guards, limit in ((6, 33, 50, 0, 0.35), (12, 33, 50, 1, 0.5), (12, 25, 50, 0, 0.35), (6, 33, 10, 0, 0.35)):
        ready = prepared(PLATE.format(w=w, z=z, v=-v))
        assert ready.plan.columns["thin"].sum() == guards * 2 * 13 * 7
        assert {m.name: m.limit for m in ready.certificate.margins}["closing speed"] == pytest.approx(limit * WAVE)
    text = PLATE.format(w=10, z=33, v=-6).replace("(10, 50, 50)", "(10, 10, 50)")
    ready = prepared(text)
    assert ready.plan.columns["thin"][ready.system.object == 1].all()
    assert {m.name: m.limit for m in ready.certificate.margins}["closing speed"] == pytest.approx(0.2 * WAVE)


FREE, SLIDES = "contacts are frictionless", "objects slide off what they stand or lie on"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        pytest.param(pile(), f"{FREE}: {SLIDES}; write friction 0.5 in control", id="surface"),
        pytest.param(
            pile(z=0.2).replace("contact-model surface", "contact-model paper"),
            f"{FREE}, as in the paper: {SLIDES}; write friction 0.5 in control in place of contact-model paper",
            id="paper",
        ),
        pytest.param(pile(control="friction 0.1"), "", id="friction"),
        pytest.param(pile("contact cube slab { friction 0.1 }"), "", id="friction of a pair"),
        pytest.param(pile("effects { gravity off }"), "", id="no gravity"),
        pytest.param(pile(slab="hold all", cube="hold all"), "", id="nothing moves"),
        pytest.param(
            pile("effects { ground off walls off }", slab="hold faces x"), f"{FREE}: {SLIDES}; write", id="a held slab below"
        ),
        pytest.param(pile("effects { ground off walls off }"), "", id="all fall"),
        pytest.param(pile("effects { ground off walls off contact off }", slab="hold all"), "", id="all fall through the slab"),
        pytest.param(POOL.format(control="", more=""), "", id="floats"),
        pytest.param(POOL.format(control="", more="").replace("500 ", "1500 "), FREE, id="sinks to the floor of a basin"),
    ],
)
def test_frictionless_is_told_once(prepared, text, told):
    """Where objects may come to rest and nothing has friction: one line, and no warning."""
    ready = prepared(text)
    lines = [line for line in note_lines(ready.certificate) if FREE in line]
    assert len(lines) == bool(told) and all(line.startswith(f"  note     {told}") for line in lines)
    assert not [w for w in ready.warnings if FREE in w.message]
    assert len(ready.certificate.to_json()["notes"]) == len(ready.certificate.notes)


def test_what_hops_for_ever_is_told_with_both_lines(prepared, capfd):
    """Without friction and damping: what to write and where, before a run as in `check`; no word of damping where some is."""
    from mdanim_lammps.cli.steps import announce

    ready = prepared(pile())
    (line,) = [line for line in note_lines(ready.certificate) if FREE in line]
    name = ready.system.names[int(np.flatnonzero(~ready.system.still)[0])]
    assert (
        f"friction 0.5 in control, and damping 0.2 in object {name}: without damping an object that lands keeps hopping" in line
    )
    announce(ready, quiet=False, verbose=False)
    assert line in capfd.readouterr().out
    (line,) = [line for line in note_lines(prepared(pile(cube="damping 0.1")).certificate) if FREE in line]
    assert "for ever" not in line


SLOPE = """gravity ({x}, 0, -10) m/s^2
ground z -1 m
object slab {{ shape box (80, 80, 10) cm  position (0, 0, 0) m  orientation axis (0, 1, 0) angle {angle} deg
  density 1000  elasticity 1 MPa  friction 0.4  hold all }}
object a {{ shape {shape}  position ({beside}, 0, 0.5) m  density 1000  elasticity 1 MPa  friction 0.1 }}
object b {{ shape box (10, 10, 10) cm  position (0, 0, 1) m  density 1000  elasticity 1 MPa }}
control {{ time 1 s  resolution 5 cm  contact-model surface  friction 0.9 }}
{more}
"""


def slope(angle=0, x=0, shape="box (10, 10, 10) cm", beside=0.2, more=""):
    """A held slab, and two objects above it: with 0.4 the pairs have 0.2 and 0.6."""
    return SLOPE.format(angle=angle, x=x, shape=shape, beside=beside, more=more)


@pytest.mark.parametrize(
    ("text", "told", "hint"),
    [
        pytest.param(slope(), "", "", id="level"),
        pytest.param(slope(11), "", "", id="less than friction"),
        pytest.param(slope(12), "a will slide on slab: its slope has a tangent of 0.21, friction is 0.2", "", id="more"),
        pytest.param(slope(-12), "a will slide on slab", "contact slab a { friction 0.3 }", id="the other way"),
        pytest.param(slope(12, shape="sphere 10 cm"), "", "", id="a ball rolls"),
        pytest.param(slope(12, beside=0.9), "", "", id="not above it"),
        pytest.param(slope(35, beside=0.9), "b will slide on slab: its slope has a tangent of 0.7", "slab b", id="another"),
        pytest.param(slope(12, more="contact slab a { friction 0.3 }"), "", "", id="a pair with more"),
        pytest.param(slope(3, more="contact a slab { friction 0.04 }"), "a will slide on slab", "contact slab a", id="less"),
        pytest.param(slope(12, more="contact a slab { friction 0 }"), "", "", id="meant to slide"),
        pytest.param(slope(0, x=0.9), "", "", id="gravity aslant, less than friction"),
        pytest.param(slope(0, x=2.1), "a will slide on the ground", "contact ground a { friction 0.3 }", id="aslant, more"),
    ],
)  # fmt: skip
def test_what_will_slide_is_told(prepared, text, told, hint):
    """The slope that is steepest for its friction, with what would hold; nothing where all stays, rolls, or is meant to slide."""
    notes = [n for n in prepared(text).certificate.notes if "slide" in n.message]
    assert len(notes) == bool(told)
    assert all(told in n.message and hint in n.hint for n in notes)


# --- starts that touch ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("deep", [0.0, 0.2])
def test_a_touching_start_is_free_of_stress(prepared, deep):
    """Faces that touch, and such as overlap by a little: no warning, and no energy at the start."""
    ready = prepared(pile(z=0.15 - 0.05 * deep, control="friction 0.5"))
    assert ready.warnings == ()
    with Instance(ready.plan) as instance:
        instance.setup()
        assert sum(e.energy(instance) for e in ready.plan.effects if e.ledger in ("contact", "wall")) < 1e-4


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        pytest.param(pile(z=0.15 - 0.3 * 0.05), 6, "cube[1] starts inside slab, about 1.5 cm deep", id="two objects"),
        pytest.param(pile().replace("(0, 0, 5) cm", "(0, 0, 3) cm"), 4, "slab is 2 cm below the ground", id="ground"),
    ],
)
def test_a_start_that_is_too_deep_is_refused(prepared, text, place, words):
    """Name the pair, the depth, and a move that cures it."""
    with pytest.raises(SceneError) as error:
        prepared(text)
    found = error.value.problems[0]
    assert (found.message, found.line) == (words, place)
    assert found.hint == ("move it up by 1.5 cm" if place == 6 else "move it up by 2 cm")


def test_the_paper_allows_no_overlap(prepared):
    """As before: what it calls a start inside each other is not changed."""
    with pytest.raises(SceneError, match=r"cube\[1\] starts inside slab"):
        prepared(pile(z=0.145).replace("contact-model surface", "contact-model paper"))


# --- contact that cannot be -----------------------------------------------------------------------------------------

ROLL = """gravity (0, 0, -9.81) m/s^2
ground z 0 m
object a {{ shape sphere 20 cm  position (0, 0, 0.3) m  density 1000  elasticity 1 MPa  spin (0, 200, 0) rad/s {a} }}
object b {{ shape sphere 20 cm  position (4, 0, 0.3) m  density 1000  elasticity 1 MPa  hold all }}
control {{ time 1 s  contact-model surface  {control} }}
"""


@pytest.mark.parametrize(
    ("a", "control", "on"),
    [
        pytest.param("", "", False, id="slides"),
        pytest.param("", "friction 0.5", True, id="rolls"),
        pytest.param("friction 0", "friction 0.5", False, id="slides in a scene with friction"),
        pytest.param("friction 0", "} contact a ground { friction 0.5", True, id="rolls by a pair"),
    ],
)
def test_friction_may_bring_objects_together(a, control, on):
    """A spinning ball stays where it is on ice and rolls to another on rough ground."""
    resolved = resolve(features.effects(), parse_scene(ROLL.format(a=a, control=control)))
    assert resolved.verdicts["contact"].on == on
