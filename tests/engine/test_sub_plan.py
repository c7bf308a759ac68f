# SPDX-License-Identifier: GPL-2.0-only
"""A part of a plan evolves as the same objects do in the whole, to the last bit, as long as they meet none of the others."""

from dataclasses import fields, replace

import numpy as np
import pytest
from mdanim_lammps.engine.data_file import data_text
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.engine.plan import both_ends, make_plan
from mdanim_lammps.engine.state import State
from mdanim_lammps.engine.sub_plan import SubPlans
from mdanim_lammps.errors import SetupError
from mdanim_lammps.features.contact.words import ContactModel
from mdanim_lammps.model.system import System
from mdanim_lammps.run.energy import stored
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import load_scene
from scene_texts import POND, SHELF

ACCOUNTS = np.s_[16:48]
"""Bytes of a liquid's state that only tell energies, in the heads of plugin/liquid/automaton/automaton_basin_state.cpp and
wave_basin_state.cpp."""


def particles(system, objects) -> np.ndarray:
    """Their particles in the whole."""
    return np.concatenate([np.arange(system.first[m], system.first[m + 1]) for m in objects])


def cut(state: State, rows: np.ndarray, objects, liquid: bool) -> State:
    """The part of a state of the whole that belongs to these objects."""
    records = {fix: found.take(objects, liquid) for fix, found in state.records.items()}
    return State(state.x[rows], state.v[rows], state.f[rows], {fix: found for fix, found in records.items() if len(found)})


def evolve(instance, steps: int) -> State:
    """The state after these steps."""
    instance.run(steps)
    return instance.state()


def equal(a: State, b: State, what: object = "") -> None:
    """Compare every bit of what moves."""
    for name in ("x", "v", "f"):
        assert np.array_equal(getattr(a, name), getattr(b, name)), (name, what)
    kept, others = ({fix: found for fix, found in state.records.items() if len(found)} for state in (a, b))
    assert kept.keys() == others.keys(), what
    for fix, found in kept.items():
        if fix == "liquid":
            assert np.array_equal(*(np.delete(records.data, ACCOUNTS) for records in (found, others[fix]))), what
        else:
            assert found == others[fix], (fix, what)


def islands(low, high, gap) -> list[tuple[int, ...]]:
    """Objects whose boxes, each grown by its own half gap, hang together."""
    low, high, left, found = low - gap[:, None] / 2, high + gap[:, None] / 2, set(range(len(low))), []
    while left:
        island, edge = set(), {min(left)}
        while edge:
            m = edge.pop()
            island.add(m)
            edge |= {int(k) for k in np.flatnonzero((low <= high[m]).all(1) & (high >= low[m]).all(1))} - island
        left -= island
        found.append(tuple(sorted(island)))
    return found


def follow(plan, starts=(1, 500), steps=400):
    """Run the whole, and the islands that its own traces show; compare them. Gives the islands of each stretch."""
    parts, stretches = SubPlans(plan), []
    with Instance(plan) as whole:
        whole.setup()
        for start in starts:
            before = evolve(whole, start - whole.step)
            whole.trace.start()
            after = evolve(whole, steps)
            found = islands(*whole.trace.boxes(), parts.gap.max() * np.ones(len(parts.gap)))
            stretches.append(found)
            for island in found:
                rows = particles(plan.system, island)
                part = parts.part(island, False)
                with Instance(part) as instance:
                    instance.put(start, cut(before, rows, island, False))
                    equal(evolve(instance, steps), cut(after, rows, island, False), [plan.system.names[m] for m in island])
    return stretches


@pytest.mark.parametrize("model", ContactModel, ids=lambda model: model.value)
def test_islands_of_a_crowd(scenes, model):
    """Balls alone, pairs and clusters of them, taken out of the paper's crowd while they fly, meet and bounce."""
    scene = load_scene(scenes / "crowd.txt")
    plan = prepare(replace(scene, control=replace(scene.control, contact_model=model))).plan
    found = follow(plan, starts=(1, 1200), steps=300)
    assert len(found[0]) > 20 and any(1 < len(island) < 20 for island in found[1])


def test_damped_dragged_thin_and_held_objects(prepared):
    """Take out single objects and a pair that is not side by side in the scene, with walls, strong drag, dashpots
    and thin plates."""
    plan = prepared(SHELF).plan
    assert plan.exponential, "the feather must be dragged so strongly that drag is taken exponentially"
    found = follow(plan)
    assert (0, 2) in found[1] and (1, 4) in found[1] and (3,) in found[1] and (5,) in found[1]


@pytest.mark.parametrize("model", ["model waves", "model surface", "model paper"])
def test_what_is_in_the_liquid_and_what_is_not(prepared, model):
    """Take out the pond with what swims in it, and the two objects that fall far above it and meet."""
    plan = prepared(POND.replace("MODEL", model)).plan
    parts = SubPlans(plan)
    assert plan.system.position[particles(plan.system, (0, 2)), 2].min() > parts.grid_top
    with Instance(plan) as whole:
        whole.setup()
        before = evolve(whole, 60)
        after = evolve(whole, 300)
    for objects, liquid in (((1, 3), True), ((0, 2), False), ((0,), False), ((2,), False)):
        rows = particles(plan.system, objects)
        part = parts.part(objects, liquid)
        with Instance(part) as instance:
            instance.put(60, cut(before, rows, objects, liquid))
            equal(evolve(instance, 300), cut(after, rows, objects, liquid), objects)


def test_the_liquid_alone(prepared):
    """Run the pond without any object, as it goes on when all have left."""
    text = POND.replace("MODEL", "")
    for name in ("wall", "raft"):
        text = text[: text.index(f"object {name}")] + text[text.index("}", text.index(f"object {name}")) + 2 :]
    plan = prepared(text).plan
    with Instance(plan) as whole, Instance(SubPlans(plan).part((), True)) as alone:
        whole.setup()
        start = evolve(whole, 20)
        whole.run(300)
        alone.put(20, State(*np.zeros((3, 0, 3)), start.records))
        alone.run(300)
        assert np.array_equal(alone.records()["liquid"].data, whole.records()["liquid"].data)
        assert alone.fix_value("liquid", 4) > 0, "nothing has moved, so nothing is shown"


def test_the_liquid_alone_takes_one_process(prepared):
    """Refuse several ranks before LAMMPS hangs in cutting up an empty space."""

    class Two:
        def Get_size(self):
            return 2

    with pytest.raises(SetupError, match="run it on one process"):
        Instance(SubPlans(prepared(POND.replace("MODEL", "")).plan).part((), True), Two())


def test_float_from_the_start(scenes):
    """Take all that floats: the same numbers of particles, and the same pouring."""
    plan = prepare(load_scene(scenes / "float.txt")).plan
    with Instance(plan) as whole, Instance(SubPlans(plan).part((0,), True)) as part:
        whole.setup()
        part.setup()
        equal(evolve(part, 100), evolve(whole, 100))
        assert np.array_equal(part.records()["liquid"].data, whole.records()["liquid"].data)


def test_a_part_says_what_a_plan_of_its_own_would_say(prepared):
    """Slice to what the same objects give in a scene of their own: system, types, tables of tags, springs at both ends."""
    text = POND.replace("MODEL", "model waves")
    whole, name = prepared(text), "object higher"
    without = text[: text.index(name)] + text[text.index("}", text.index(name)) + 2 :]
    own = prepared(without)
    part = SubPlans(whole.plan).part((0, 1, 3), True)
    own_plan = make_plan(own.context, whole.certificate)
    # Types may be numbered otherwise, and kinds of bodies are numbered as in the whole.
    numbered = {"spring_type", "constants", "contact_kind", "frames"}
    for field in {field.name for field in fields(System)} - numbered | {"stiffness", "rest"}:
        a, b = getattr(part.system, field), getattr(own_plan.system, field)
        assert np.array_equal(a, b) if isinstance(b, np.ndarray) else a == b, field
    a, b = ([system.frames[k].shape for k in system.contact_kind] for system in (part.system, own_plan.system))
    assert a == b
    assert part.fields == own_plan.fields
    for name in part.fields.keys() - {"body"}:
        assert np.array_equal(part.columns[name], own_plan.columns[name]), name
    assert [e.name for e in part.effects] == [e.name for e in own_plan.effects]
    coefficients = part.coefficients[part.bond_kind - 1]
    assert np.array_equal(coefficients, own_plan.coefficients[own_plan.bond_kind - 1])
    assert len(part.coefficients) == len(np.unique(part.bond_kind))
    assert np.array_equal(part.kind, own_plan.kind) and np.array_equal(part.bonds, own_plan.bonds)
    for a, b in zip(part.ends(), both_ends(part.bonds, part.bond_kind, part.system.particles)):
        assert np.array_equal(a, b) and a.dtype == b.dtype
    assert len("".join(data_text(part))) > 1000


def test_effects_with_nothing_to_act_on_are_left_out(prepared):
    """Keep walls and ground; drop contact of one object, and of the liquid all traces in what is dry."""
    parts = SubPlans(prepared(SHELF).plan)
    assert [e.name for e in parts.part((0,), False).effects] == ["springs", "damping", "gravity", "ground", "walls", "air-drag"]
    assert "reach" not in parts.part((0,), False).columns and "reach" in parts.part((0, 2), False).columns
    pond = SubPlans(prepared(POND.replace("MODEL", "model surface")).plan)
    dry = pond.part((0, 2), False)
    assert [e.name for e in dry.effects] == ["springs", "damping", "gravity", "contact", "basin", "air-drag"]
    bodies = {"body", "young", "friction"}
    assert set(dry.columns) == {*bodies, "stiffness", "reach", "lambda"} and dry.grid is None
    assert set(pond.part((0,), True).columns) == {*bodies, "lambda", "volume", "gamma", "base", "cell"}


@pytest.mark.parametrize(
    ("objects", "liquid", "why"),
    [
        pytest.param((2, 0), False, "must ascend", id="another order"),
        pytest.param((1, 1), False, "must ascend", id="one of them twice"),
        pytest.param((1, 6), False, "within 0 and 5", id="not there"),
        pytest.param((-1, 2), False, "within 0 and 5", id="counted from the end"),
        pytest.param((0,), True, "no grid", id="no liquid"),
        pytest.param((), False, "needs an object", id="nothing"),
    ],
)
def test_parts_that_are_refused(prepared, objects, liquid, why):
    """Say what is wrong."""
    with pytest.raises(ValueError, match=why):
        SubPlans(prepared(SHELF).plan).part(objects, liquid)


@pytest.mark.parametrize("text", [pytest.param(SHELF, id="solids"), pytest.param(POND.replace("MODEL", ""), id="liquid")])
def test_a_state_is_put_again_and_again(prepared, text):
    """Take back steps on a live instance, as often as wanted, and get the same bits each time."""
    with Instance(prepared(text).plan) as instance:
        instance.setup()
        start = evolve(instance, 300)
        first = evolve(instance, 150)
        for steps in (70, 150):
            instance.put(300, start)
            equal(instance.state(), start)
            again = evolve(instance, steps)
        equal(first, again)
        assert instance.step == 450


def test_a_state_of_other_particles_is_refused(prepared):
    """Say how many there are."""
    parts = SubPlans(prepared(SHELF).plan)
    with Instance(parts.part((0,), False)) as one, Instance(parts.part((2,), False)) as other:
        other.setup()
        with pytest.raises(ValueError, match=r"shape \(64, 3\), the plan has \d+ particles"):
            one.put(0, other.state())


def test_solids_that_are_laid_aside(prepared):
    """Two that have met are laid aside, one in the way of the rest: that evolves, and holds energy, as it does without them."""
    plan = prepared(SHELF).plan
    parts, names = SubPlans(plan), plan.system.names
    gone, rest = (0, 2), tuple(m for m in range(len(names)) if m not in (0, 2))
    with Instance(plan) as instance:
        instance.setup()
        start = evolve(instance, 200)
        instance.lay_aside(gone)
        after = evolve(instance, 400)
        rows, others = particles(plan.system, rest), particles(plan.system, gone)
        whole = stored(instance)
        assert np.ptp(after.v[others]) == 0.0
    with Instance(parts.part(rest, False)) as alone:
        alone.put(200, cut(start, rows, rest, False))
        equal(evolve(alone, 400), cut(after, rows, rest, False), rest)
        part = stored(alone)
    assert whole.keys() == part.keys()
    np.testing.assert_allclose(list(whole.values()), list(part.values()), rtol=1e-12, atol=1e-12 * whole["kinetic"])


def test_what_is_laid_aside_touches_nothing(prepared):
    """Two objects are about to collide. One is laid aside where it began, and the other one flies through it."""
    plan = prepared("""
object left { shape box (10, 10, 10) cm  position (0, 0, 0) cm  mass 1 kg  elasticity 100 kPa  velocity (2, 0, 0) m/s }
object right { shape box (10, 10, 10) cm  position (15, 0, 0) cm  mass 1 kg  elasticity 100 kPa }
control { time 0.2 s  frames 50 fps  resolution 5 cm }
""").plan
    with Instance(plan) as instance:
        instance.setup()
        instance.run(1)
        instance.lay_aside([1])
        instance.run(plan.certificate.steps - 1)
        np.testing.assert_allclose(instance.array("v")[particles(plan.system, (0,))], [[2.0, 0.0, 0.0]] * 27, atol=1e-9)
        assert instance.array("x")[particles(plan.system, (0,)), 0].min() > 0.3
