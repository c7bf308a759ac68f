# SPDX-License-Identifier: GPL-2.0-only
"""Effects: on when the scene calls for them, with reason and line, and off without a trace."""

import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from every_effect import ELSEWHERE, with_every_effect
from mdanim_lammps import features
from mdanim_lammps.effects import resolve
from mdanim_lammps.engine.commands import input_script
from mdanim_lammps.engine.data_file import data_text
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.engine.sub_plan import SubPlans
from mdanim_lammps.features.contact.barrier import plane_stiffness
from mdanim_lammps.features.contact.words import ContactModel
from mdanim_lammps.features.liquid.tables import MOST_LAYERS, lattice_cells, layers_of_cells
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

FULL = """gravity (0, 0, -9.81)
ground z 0
walls from (-1, -1, 0) to (1, 1, 2)
object a {
  shape sphere 0.1
  position (0, 0, 1)
  mass 1
  elasticity 1e5
  damping 0.1
  drag 0.2
}
object b {
  shape sphere 0.1
  position (0, 0, 0.5)
  mass 1
  elasticity rigid
}
liquid w {
  basin from (-1, -1, 0) to (1, 1, 2)
  density 1000
  level 0.3
}
control { time 1 }
object c {
  shape sphere 0.1
  position (0.5, 0, 1.5)
  mass 1
  elasticity 1e5
  hold all
  drive velocity (0.1, 0, 0)
}
joint spring a b { }
air { }
"""
EVERY = with_every_effect(FULL)
"""The same with the words of all further effects, whose lines are those where they stand."""
ROPE = "object w { shape rope from (0.8, 0, 1) to (0.8, 0, 1.8) thickness 0.01 mass 1 elasticity 1e6\ntear-strain 0.1 }\n"
BAG = "object w { shape sphere 0.1 sheet thickness 0.01 position (0.8, 0, 1) mass 1 elasticity 1e6\ninflate 1e3 }\n"
PLATE = "object w { shape box (0.1, 0.1, 0.1) position (0.8, 0, 1) mass 1 elasticity rigid strength 1e6\npieces 3 }\n"
LUMP = "object w { shape sphere 0.1 position (0.8, 0, 1) mass 1 elasticity 1e6\nyield-strain 0.1 }\n"
BESIDE = {
    name: re.sub(r"liquid w \{[^}]*\}\n", text, FULL) for name, text in (("tearing", ROPE), ("inflate", BAG), ("yielding", LUMP))
}
BESIDE["pieces"] = re.sub(r"air \{[^}]*\}\n", "", re.sub(r"liquid w \{[^}]*\}\n", PLATE, FULL))
"""Scenes for effects that are not in EVERY."""
BARE = "object a {\n shape sphere 0.1\n position (0, 0, 0)\n mass 1\n elasticity 1e5\n}\ncontrol { time 1 }\n"
LINES = {
    "springs": 8,
    "damping": 9,
    "gravity": 1,
    "contact": 12,
    "ground": 2,
    "walls": 3,
    "air-drag": 10,
    "basin": 19,
    "liquid": 18,
    "buoyancy": 4,
    "liquid-drag": 4,
    "rigid": 16,
    "drives": 30,
    "joint": 32,
    "air": 33,
    "tearing": 19,
    "yielding": 19,
    "pieces": 19,
}


def verdicts(text):
    """Verdicts and warnings for a scene text."""
    found = resolve(features.effects(), parse_scene(text))
    return found.verdicts, found.warnings


@pytest.mark.parametrize("effect", [e.name for e in features.effects()])
def test_each_effect_is_called_for_by_its_line(effect):
    """Switch on with the line that calls for it."""
    verdict = verdicts(BESIDE.get(effect, EVERY))[0][effect]
    assert verdict.on and verdict.span.line == LINES.get(effect, verdict.span.line)


@pytest.mark.parametrize("effect", ["contact", "ground", "walls"])
def test_what_pushes_back_tells_an_unusual_stiffness(effect):
    """Show contact-stiffness beside what it changes, and only where it is not 1."""
    usual, told = (
        verdicts(re.sub(r"control \{", f"control {{ contact-stiffness {f}\n", FULL))[0][effect].reason for f in ("1", "2.5")
    )
    assert told != usual and told.replace(", 2.5 times as stiff as usual", "") == usual


@pytest.mark.parametrize("effect", [e.name for e in features.effects() if e.name != "springs"])
def test_each_effect_is_off_without_cause(effect):
    """Stay off, with a reason, in a scene of one free ball."""
    verdict = verdicts(BARE)[0][effect]
    assert not verdict.on and verdict.reason


@pytest.mark.parametrize("effect", [e.name for e in features.effects()])
def test_a_needed_effect_switched_off_is_a_warning(effect):
    """Say what will look wrong."""
    found, warnings = verdicts(BESIDE.get(effect, EVERY) + f"effects {{ {effect} off }}\n")
    assert not found[effect].on
    assert [w.severity for w in warnings] == ["warning"]
    assert next(e for e in features.effects() if e.name == effect).if_off in warnings[0].hint


def test_a_needless_effect_cannot_be_switched_on():
    """Warn instead of inventing a ground."""
    found, warnings = verdicts(BARE + "effects { ground on }\n")
    assert not found["ground"].on and "no ground" in warnings[0].message


@pytest.mark.parametrize("text", [pytest.param(BARE.replace("mass 1\n", "mass 1\n hold all\n"), id="one held object")])
def test_held_objects_need_no_springs(text):
    """Leave springs out when nothing can deform."""
    assert not verdicts(text)[0]["springs"].on


# --- liquid -------------------------------------------------------------------------------------------------

POOL = """gravity (0, 0, -9.81) m/s^2
liquid w {{
  basin from (0, 0, 0) m to (1, 0.8, 0.6) m
  density 1000
  {liquid}
}}
object block {{
  shape box (20, 20, 20) cm
  position (0.5, 0.4, 0.4) m
  density 500
  elasticity 200 kPa
  {block}
}}
control {{
  time 1 s
  resolution 5 cm
  seed 3
}}
{top}
"""


def pool(liquid="level 0.25 m", block="", top=""):
    """A scene of a block that falls into a basin."""
    return POOL.format(liquid=liquid, block=block, top=top)


def commands(ready, name):
    """Commands that an effect writes for LAMMPS."""
    return next(e for e in features.effects() if e.name == name).commands(ready.context)


@pytest.mark.parametrize("effect", ["basin", "buoyancy", "liquid-drag"])
def test_what_is_held_reaches_no_liquid(effect):
    """Leave out basin, buoyancy and drag where nothing moves; the liquid itself still makes room for what stands in it."""
    found, _ = verdicts(pool(block="hold all"))
    assert not found[effect].on and "move" in found[effect].reason
    assert found["liquid"].on


def test_liquid_takes_what_needs_it_along():
    """Switch buoyancy and drag off with the liquid, but neither basin nor gravity."""
    found, warnings = verdicts(pool(top="effects { liquid off }"))
    assert [n for n in ("gravity", "basin", "liquid", "buoyancy", "liquid-drag") if found[n].on] == ["gravity", "basin"]
    assert found["buoyancy"].reason == "liquid is off" and len(warnings) == 1


def test_without_gravity_a_liquid_cannot_be():
    """Say so when gravity is switched off."""
    found, _ = verdicts(pool(top="effects { gravity off }"))
    assert not found["liquid"].on and found["liquid"].reason == "gravity is off"


def test_a_damped_object_that_boxes_hold_as_a_whole_has_no_dashpots(prepared):
    """Its springs are none, and beside it another object has some without dashpots."""
    ready = prepared(
        "object a { shape box (2, 2, 2) position (0, 0, 0) density 1000 elasticity 1 MPa damping 0.1 "
        "hold within box (-2, -2, -2) m to (2, 2, 2) m }\n"
        "object b { shape box (2, 2, 2) position (5, 0, 0) density 1000 elasticity 1 MPa }\n"
        "control { time 1 s }"
    )
    assert ready.verdicts["damping"].on and not ready.plan.damped
    assert 0.0 < ready.certificate.bound < 1.0


DAMPED = """
object a { shape box (2, 2, 2) m position (0, 0, 0) m mass 6 kg elasticity 1 MPa damping 0.1 drag 3 N*s/m }
object b { shape box (2, 2, 3) m position (5, 0, 0) m mass 8 kg elasticity 1 MPa }
object c { shape box (2, 2, 3) m position (9, 0, 0) m mass 8 kg elasticity 1 MPa damping 0.4 }
object d { shape box (2, 2, 2) m position (13, 0, 0) m mass 6 kg elasticity 1 MPa damping 0.1 drag 6 N*s/m }
control { time 1 s resolution 1 m }
"""


def test_each_object_has_its_dashpots_and_its_drag(prepared):
    """2 zeta sqrt(k m_ij) with masses by cells, drag by masses; bond types by first appearance, equal ones once; so in a part."""
    ready = prepared(DAMPED)
    system, plan = ready.system, ready.plan
    mass = system.share * (np.array([6.0, 8.0, 8.0, 6.0]) / np.add.reduceat(system.share, system.first[:-1]))[system.object]
    i, j = system.spring.T
    zeta = np.array([0.1, 0.0, 0.4, 0.1])[system.object[i]]
    own = np.stack([system.stiffness, system.rest, 2 * zeta * np.sqrt(system.stiffness / (1 / mass[i] + 1 / mass[j]))], axis=1)
    np.testing.assert_allclose(plan.coefficients[plan.bond_kind - 1], own, rtol=1e-14)
    assert len(np.unique(plan.coefficients, axis=0)) == len(plan.coefficients)
    assert (np.diff([np.flatnonzero(plan.bond_kind == kind)[0] for kind in range(1, len(plan.coefficients) + 1)]) > 0).all()
    np.testing.assert_allclose(np.add.reduceat(ready.context.drag, system.first[:-1]), [3.0, 0.0, 0.0, 6.0])
    assert np.ptp((ready.context.drag / system.mass)[: system.first[1]]) < 1e-15
    part = SubPlans(plan).part((2,), False)
    np.testing.assert_array_equal(part.coefficients[part.bond_kind - 1], plan.coefficients[plan.bond_kind[(zeta == 0.4)] - 1])
    without = prepared(DAMPED + "effects { damping off  air-drag off }").plan
    assert not without.coefficients[:, 2].any() and "lambda" not in without.columns
    assert len(without.coefficients) == len(np.unique(own[:, :2], axis=0))


def test_drag_zero_is_off():
    """Leave no lambda for a liquid without drag."""
    found, _ = verdicts(pool("level 0.25 m\n drag 0"))
    assert not found["liquid-drag"].on and found["liquid-drag"].span.line == 6


def test_the_liquid_in_lammps_terms(prepared):
    """Write basin, cells, amount, gravity, models and seed, bit for bit."""
    assert commands(prepared(pool()), "liquid") == [
        "group held type 5:8",
        "region liquid block 0.0 1.0 0.0 0.8 0.0 0.6",
        "fix liquid all mdanim/liquid liquid 1000.0 grid 20 16 12 level 0.25 gravity 9.81 cells i2_cell still held "
        "sweeps auto every 4 stride 0.25 period 0.06 seed 3",
    ]
    fill, fix = commands(
        prepared(pool("volume 10 l\n fill from (0, 0, 0.1) m to (0.3, 0.8, 0.6) m\n model paper\n sweeps 7\n drag 2")), "liquid"
    )[2:]
    assert fill == "region fill block 0.0 0.3 0.0 0.8 0.1 0.6"
    assert fix == (
        "fix liquid all mdanim/liquid liquid 1000.0 grid 20 16 12 volume 0.01 fill fill gravity 9.81 model paper "
        "still held sweeps 7 every 4 stride 0.25 period 0.06 seed 3"
    )


def test_the_paper_needs_no_lattice_cells(prepared):
    """Carry the table of lattice cells only for the model that reads it."""
    assert "cell" in prepared(pool()).plan.columns
    assert "cell" not in prepared(pool("level 0.25 m\n model paper")).plan.columns


def test_walls_of_a_basin_go_on_upward(prepared):
    """Give the basin a floor and four walls, but no lid."""
    assert commands(prepared(pool()), "basin")[0] == "region basin block 0.0 1.0 0.0 0.8 0.0 INF"


@pytest.mark.parametrize(("model", "part"), [("waves", 0.06), ("surface", 1.0)])
def test_drag_of_a_liquid_is_a_rate(prepared, model, part):
    """Take gamma as it is written; by default sqrt(g/L) with the edge of the cube of equal volume, a part of it beside waves."""
    plan = prepared(pool(f"level 0.25 m\n model {model}")).plan
    np.testing.assert_allclose(plan.columns["gamma"], part * np.sqrt(9.81 / 0.2), rtol=1e-12)
    assert not plan.columns["lambda"].any() and "base" not in plan.columns
    plan = prepared(pool("level 0.25 m\n drag 4")).plan
    assert (plan.columns["gamma"] == 4.0).all() and "quadratic" not in plan.columns


def test_drag_beside_waves_grows_with_speed(prepared):
    """C/2L with the longest edge of a solid, however it is turned; no part of the automaton."""
    ready = prepared(pool("level 0.25 m"))
    system = ready.system
    size = np.ptp(system.position, axis=0).max()
    away = system.position - system.center_of_mass(system.position)[0]
    moments = (system.volume[:, None, None] * away[:, :, None] * away[:, None, :]).sum(axis=0) / system.volume.sum()
    longest = np.sqrt(12.0 * np.linalg.eigvalsh(moments)[-1])
    # Particles carry volume by the cells around: their second moments are those of the cube but for (h/side)^2.
    assert longest == pytest.approx(size, rel=2.0 / round(size / system.spacing[0]) ** 2)
    # Powers of a matrix find its largest eigenvalue to 1 %.
    np.testing.assert_allclose(ready.plan.columns["quadratic"], 0.25 / longest, rtol=0.005)
    assert commands(ready, "liquid-drag") == ["fix_modify liquid drag d_gamma quadratic d_quadratic lambda d_lambda"]
    assert "quadratic" not in prepared(pool("level 0.25 m\n model surface")).plan.columns


def test_drags_of_air_and_liquid_add_up(prepared):
    """Hand lambda to the liquid, with that of the air as its base; switched off, air leaves nothing."""
    ready = prepared(pool(block="drag 3"))
    columns = ready.plan.columns
    np.testing.assert_allclose(columns["base"].sum(), 3.0, rtol=1e-12)
    assert np.array_equal(columns["lambda"], columns["base"])
    assert commands(ready, "liquid-drag") == ["fix_modify liquid drag d_gamma quadratic d_quadratic lambda d_lambda base d_base"]
    ready = prepared(pool(block="drag 3", top="effects { air-drag off }"))
    assert "base" not in ready.plan.columns and not ready.plan.columns["lambda"].any()
    assert commands(ready, "liquid-drag") == ["fix_modify liquid drag d_gamma quadratic d_quadratic lambda d_lambda"]


def test_every_lattice_cell_is_in_the_table(prepared):
    """Find each cell once, at its first corner, the others as tags in VTK order."""
    ready = prepared(pool(top="object ball { shape sphere 8 cm position (20, 20, 45) cm density 900 elasticity 100 kPa }"))
    system, table = ready.system, ready.plan.columns["cell"]
    owner = np.flatnonzero(table.any(axis=1))
    found = np.column_stack([owner, table[owner, :7] - 1])
    assert np.array_equal(found, system.hexahedron[np.argsort(system.hexahedron[:, 0])])
    assert len(found) == sum(len(m.hexahedron) for m in ready.models)
    assert table.dtype == np.int32 and table.min() == 0


def test_layers_of_cells_around_each(prepared):
    """Count from the nearest face of two blocks; a particle that is the corner of no cell has 0."""
    ready = prepared(
        pool(top="object slab { shape box (35, 30, 30) cm position (25, 25, 75) cm density 900 elasticity 100 kPa }")
    )
    system, table = ready.system, ready.plan.columns["cell"]
    layers = layers_of_cells(system)
    of_object = system.object[system.hexahedron[:, 0]]
    for m in range(2):
        corner = system.position[system.hexahedron[of_object == m, 0]]
        place = np.rint((corner - corner.min(axis=0)) / 0.05).astype(int)
        found = layers[of_object == m]
        assert np.array_equal(found, np.minimum(np.minimum(place, place.max(axis=0) - place).min(axis=1), MOST_LAYERS))
    assert layers.max() >= 2
    assert np.array_equal(table[system.hexahedron[:, 0], 7], layers) and table[:, 7].sum() == layers.sum()


def test_a_particle_owns_one_cell_at_most(prepared):
    """Refuse a lattice in which two cells start at one particle."""
    system = prepared(pool()).system
    twice = replace(system, hexahedron=np.concatenate([system.hexahedron, system.hexahedron[:1]]))
    with pytest.raises(ValueError, match="first corner of two"):
        lattice_cells(twice)


def test_plane_stiffness_bounds_every_depth():
    """Be at least the curvature of a particle at the surface (1.18) and below twice the pair's stiffness."""
    assert 1.5 < plane_stiffness(1.6) < 1.75
    assert plane_stiffness(1.9) > plane_stiffness(1.6)


@pytest.mark.parametrize("reach", [1.6, 4.0, 8.0, 13.0])
def test_plane_stiffness_has_all_layers_within_reach(reach):
    """Curvature along the normal over a half-space of particles, by differences of energy: no more than the bound, which is not
    far above it. 13 is beyond the reach up to which the bound is a sum."""
    wide = np.arange(-15, 16)
    below = np.stack(np.meshgrid(wide, wide, -np.arange(15), indexing="ij"), -1).reshape(-1, 3)

    def energy(x, y, z):
        distance = np.linalg.norm(below - [x, y, z], axis=1)
        return (reach**2 / 3.0 * np.maximum(0.0, 1.0 - distance / reach) ** 3).sum()

    def curvature(x, y, z, h=1e-3):
        return (energy(x, y, z + h) - 2.0 * energy(x, y, z) + energy(x, y, z - h)) / h**2

    most = max(curvature(x, y, z) for x in (0.0, 0.3, 0.5) for y in (0.0, 0.5) for z in (0.3, 0.9, 0.35 * reach))
    assert 0.9 * plane_stiffness(reach) < most < plane_stiffness(reach) * (1.0 + 1e-5)


# --- off leaves nothing -------------------------------------------------------------------------------------

ALL = """gravity (0, 0, -9.81)
ground z 0
walls from (-1, -1, 0) to (1, 1, 3)
object a { shape sphere 0.1 position (0, 0, 1.2) mass 1 elasticity 1e5 damping 0.1 drag 0.2 }
object b { shape sphere 0.1 position (0, 0, 0.9) mass 1 elasticity 1e5 }
liquid w { basin from (-1, -1, 0) to (1, 1, 3) density 1000 level 0.3 }
control { time 0.1  resolution 0.1  contact-model MODEL }
"""
MODELS = ("surface", "paper")
TRACES = {
    "springs": ["bond_style", "Bonds", "Bond Coeffs"],
    "damping": ["vel yes"],
    "gravity": ["fix gravity"],
    "contact": ["mdanim/barrier", "d_reach", " reach", "group boundary", "group inner", "group thin"],
    "ground": ["region ground", "fix ground"],
    "walls": ["region walls", "fix walls"],
    "basin": ["region basin", "fix basin"],
    "air-drag": ["d_base"],
    "liquid": ["mdanim/liquid", "region liquid", "i2_cell", "group held"],
    "buoyancy": ["modify liquid buoyancy", "d_volume"],
    "liquid-drag": ["modify liquid drag", "d_gamma"],
}
"""Words of the built files that stand there for one effect alone, under the contact of the paper."""
ON_SURFACES = {
    "contact": ["fix contact mobile mdanim/contact", "mdanim/barrier", "d_reach", " reach", "group boundary", "group inner"],
    "ground": ["fix ground mobile mdanim/contact"],
    "walls": ["fix walls mobile mdanim/contact"],
    "basin": ["fix basin mobile mdanim/contact"],
}
"""The same where contact is at the surfaces, as far as it is another."""
TAKES_ALONG = {
    "springs": {"damping"},
    "gravity": {"liquid", "buoyancy", "liquid-drag"},
    "liquid": {"buoyancy", "liquid-drag"},
    "buoyancy": {"liquid-drag"},
}
"""Effects that cannot be without another."""


def written(ready) -> str:
    """All that LAMMPS reads, without the comments."""
    lines = (input_script(ready.plan) + "".join(data_text(ready.plan))).splitlines()
    return "\n".join(line for line in lines if not line.startswith("#"))


def live_fixes(ready) -> set[str]:
    """LAMMPS's own list of the fixes of a live instance, but for the particles' columns and the integrator."""
    with Instance(ready.plan) as instance:
        return set(instance.lammps.lmp.available_ids("fix")) - {"model", "leapfrog"}


def traces(ready) -> dict[str, list[str]]:
    """TRACES under the scene's model of contact; of an effect that is not listed, its fixes and the columns that it alone has."""
    told = TRACES if ready.scene.control.contact_model is ContactModel.PAPER else TRACES | ON_SURFACES
    further = [e for e in ready.plan.effects if e.name not in told]
    own = {e.name: [f"fix {fix} " for fix in e.fixes] + [f"d_{name}" for name in ready.plan.asked[e.name]] for e in further}
    return told | own


def fixes(ready, gone=()) -> set[str]:
    """IDs of the fixes of all effects but some."""
    return {fix for e in ready.plan.effects if e.name not in gone for fix in e.fixes}


@pytest.mark.parametrize("model", MODELS)
def test_what_is_on_is_there(prepared, model):
    """Find every trace where all effects are on."""
    ready = prepared(with_every_effect(ALL.replace("MODEL", model)))
    text = written(ready)
    assert {v.name for v in ready.verdicts.values() if not v.on} == ELSEWHERE
    assert not [word for words in traces(ready).values() for word in words if word not in text]
    assert live_fixes(ready) == fixes(ready) >= {"gravity", "contact", "ground", "walls", "basin", "liquid"}
    assert ("barrier" in fixes(ready)) == (model == "surface")


ready_of = cache(lambda text: prepare(parse_scene(text)))


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("effect", [e.name for e in features.effects() if e.name not in ELSEWHERE])
def test_what_is_off_leaves_nothing(prepared, effect, model):
    """Find no trace of an effect that is off, nor of those that need it, and all traces of the others."""
    every = with_every_effect(ALL.replace("MODEL", model))
    whole, ready = ready_of(every), prepared(every + f"effects {{ {effect} off }}\n")
    gone = {effect} | TAKES_ALONG.get(effect, set())
    assert {v.name for v in ready.verdicts.values() if not v.on} == gone | ELSEWHERE
    text, words_of = written(ready), traces(whole)
    assert not [word for name in gone for word in words_of[name] if word in text]
    shared = set() if "liquid-drag" not in gone else {"d_base"}  # what air hands to the liquid
    assert not [word for name in words_of.keys() - gone for word in words_of[name] if word not in text and word not in shared]
    assert live_fixes(ready) == fixes(whole, gone)
    names = next(line for line in input_script(ready.plan).splitlines() if line.startswith("# Effects:"))
    assert not gone & set(names.removeprefix("# Effects: ").rstrip(".").split(", "))


def test_a_scene_of_nothing_is_nothing(prepared):
    """Leave springs, the integrator and nothing else to a free ball: no column, no group, no neighbourhood of another's."""
    ready = prepared(BARE)
    assert live_fixes(ready) == set()
    assert not ready.plan.columns
    lines = [line for line in written(ready).splitlines() if line.startswith(("fix ", "group ", "region ", "fix_modify "))]
    assert lines == [
        "fix model all property/atom rmass ghost yes",
        "group mobile type 1:4",
        "fix leapfrog mobile mdanim/leapfrog",
        "fix balance all balance 1000 1.1 rcb",
    ]


def test_contact_that_cannot_be_leaves_nothing(prepared):
    """Leave no barrier to two objects that fall side by side."""
    apart = prepared(
        "gravity (0, 0, -9.81)\n"
        + "".join(f"object o{k} {{ shape box (0.1, 0.1, 0.1) position ({k}, 0, 1) mass 1 elasticity 1e6 }}\n" for k in range(2))
        + "control { time 0.1 }\n"
    )
    assert live_fixes(apart) == {"gravity"}
    assert not [word for of_model in (TRACES, ON_SURFACES) for word in of_model["contact"] if word in written(apart)]


def test_declarations_of_motion_may_be_asked_of_any_scene(prepared):
    """Effects declare how they move solids for a scene without a ground, a liquid or gravity, too."""
    ready = prepared(FULL[FULL.index("object a") : FULL.index("liquid w")] + "control { time 1 }")
    for effect in (e.of(ready.scene) for e in features.effects()):
        pulls = effect.acceleration(ready.scene)
        assert len(effect.planes(ready.scene)) == 0 and (pulls is None or not pulls.any())
        assert effect.surface(ready.scene) is None and np.all(effect.lift(ready.scene, ready.system) == 0.0)
        assert effect.pushes_below(ready.scene) == -np.inf
