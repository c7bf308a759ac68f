# SPDX-License-Identifier: GPL-2.0-only
"""scene.lock.txt: any scene, written out in full, reads back as the same scene."""

import math

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mdanim_lammps.errors import SceneError
from mdanim_lammps.features.contact.words import ContactModel, ContactPair
from mdanim_lammps.features.liquid import record as liquids
from mdanim_lammps.features.walls.words import Walls
from mdanim_lammps.scene import scene as records
from mdanim_lammps.scene.keywords import BLOCKS, KEYWORDS, STATEMENTS
from mdanim_lammps.scene.lock import lock_text
from mdanim_lammps.scene.parse import load_scene, parse_scene
from mdanim_lammps.scene.rotation import departure, rotation_about, rotation_euler
from mdanim_lammps.scene.scene import GLOBALS, QUANTITIES
from paths import SCENES

# Fixed examples, so that every run of the tests is the same run.
steady = settings(max_examples=150, derandomize=True, deadline=None, suppress_health_check=[HealthCheck.too_slow])


@pytest.mark.parametrize("name", ["beam", "float", "crowd"])
def test_scene_of_the_house(name):
    """The scenes of the language page survive, without a warning, even in strict mode."""
    scene = load_scene(SCENES / f"{name}.txt")
    again = parse_scene(lock_text(scene), scene.name, strict=True)
    assert again == scene
    assert again.warnings == ()
    assert lock_text(again) == lock_text(scene)


# --- scenes drawn at random: any floats that the rules allow ----------------------------------------------

numbers = st.floats(-1e6, 1e6)
positive = st.floats(1e-9, 1e9)
vectors = st.tuples(numbers, numbers, numbers)
lengths = st.floats(0.01, 1e9)  # positions up to 1e6 m are then exact enough
sizes = st.tuples(lengths, lengths, lengths)
movies = st.from_regex(r"[^\s/\"\x00-\x1f]{1,20}", fullmatch=True).filter(str.isprintable).map(lambda name: f"{name}.mp4")
frictions = st.none() | st.floats(0, 10)
dampings = st.none() | st.floats(0, 1)
colors = st.none() | st.from_regex(r"#[0-9a-f]{6}", fullmatch=True)
texts = st.text(st.characters(blacklist_characters='"\n\r\ufeff\0', blacklist_categories=("Cs",)), max_size=20)
words = st.from_regex(r"[a-zA-Z_][a-zA-Z0-9_]{0,8}", fullmatch=True)
names = st.builds(lambda w, i: w if i is None else f"{w}[{i}]", words, st.none() | st.integers(-5, 10**6)).filter(
    lambda n: n not in GLOBALS
)


@st.composite
def boxes(draw, kind):
    """Two corners, the lower one first."""
    low = draw(vectors)
    high = tuple(a + d for a, d in zip(low, draw(st.tuples(*[st.floats(1e-3, 1e3)] * 3))))
    return kind(low, high)


@st.composite
def rotations(draw):
    """A turn about any axis, or by any angles."""
    if draw(st.booleans()):
        return rotation_euler(draw(st.tuples(*[st.floats(-7, 7)] * 3)))
    axis = draw(vectors.filter(lambda v: math.hypot(*v) > 1e-3))
    return rotation_about(tuple(c / math.hypot(*axis) for c in axis), draw(st.floats(-7, 7)))


shapes = st.one_of(
    st.builds(records.Box, sizes),
    st.builds(records.Sphere, lengths),
    st.builds(records.Ellipsoid, sizes),
    st.builds(records.Cylinder, lengths, lengths),
    st.builds(records.Cone, lengths, lengths),
    st.builds(lambda r, t: records.Torus(r, r * t), lengths, st.floats(0.1, 0.9)),
)
holds = st.one_of(
    st.builds(records.HoldAll),
    boxes(records.HoldWithin),
    st.sampled_from(
        [records.HoldFaces((records.Side(f"-{a}"), records.Side(f"+{a}"))) for a in "xyz"]
        + [records.HoldFaces((side,)) for side in records.Side]
    ),
)


@st.composite
def solids(draw, name):
    """One object."""
    by_mass = draw(st.booleans())
    amount = draw(positive)
    return records.Solid(
        name=name,
        shape=draw(shapes),
        position=draw(vectors),
        rotation=draw(rotations()),
        elasticity=draw(st.builds(records.Young, positive) | st.builds(records.SpringConstant, positive)),
        mass=amount if by_mass else None,
        density=None if by_mass else amount,
        damping=draw(st.floats(0, 2)),
        velocity=draw(vectors),
        spin=draw(vectors),
        drag=draw(st.floats(0, 1e3)),
        friction=draw(frictions),
        hold=tuple(draw(st.lists(holds, max_size=2))),
        color=draw(colors),
    )


@st.composite
def scenes(draw):
    """A whole valid scene."""
    control = records.Control(
        time=draw(st.floats(1, 1e3)),
        frames=draw(st.floats(2, 1e3)),
        timestep=draw(st.none() | positive),
        resolution=draw(st.none() | positive),
        accuracy=draw(st.sampled_from(records.Accuracy)),
        contact_stiffness=draw(st.floats(0.1, 100.0)),
        contact_model=ContactModel.SURFACE,
        friction=draw(st.floats(0, 10)),
        contact_damping=draw(dampings),
        seed=draw(st.integers(0, 2**53 - 1)),
        save=draw(st.sampled_from(records.Save)),
        single=draw(st.booleans()),
    )
    bodies = tuple(draw(solids(n)) for n in draw(st.lists(names, min_size=1, max_size=3, unique=True)))
    wet = draw(st.booleans())
    liquid = None
    if wet:
        basin = draw(boxes(Walls))
        room = math.prod(b - a for a, b in zip(basin.low, basin.high))
        by_volume = draw(st.booleans())
        share = draw(st.floats(0.1, 0.9))
        taken = {b.name for b in bodies}
        model = draw(st.sampled_from(liquids.LiquidModel))
        waves = model is liquids.LiquidModel.WAVES
        liquid = liquids.Liquid(
            name=draw(words.filter(lambda w: w not in taken)),
            low=basin.low,
            high=basin.high,
            density=draw(positive),
            volume=room * share if by_volume else None,
            level=None if by_volume else basin.low[2] + share * (basin.high[2] - basin.low[2]),
            drag=draw(st.none() | st.floats(0, 100)),
            model=model,
            calm=draw(st.none() | positive) if waves else None,
            manning=draw(st.none() | st.floats(1e-4, 1.0)) if waves else None,
            drops=draw(st.sampled_from([0.0, 0.25, 1.0])) if waves else 0.0,
            wave=draw(st.sampled_from([(), (liquids.Wave("-x", 0.1, 2.0), liquids.Wave("+y", 0.02, 3.0))])) if waves else (),
            current=draw(st.sampled_from([(), (liquids.Current("+x", 0.3),)])) if waves else (),
            inflow=draw(st.sampled_from([(), (liquids.Inflow(basin.low, basin.high, 0.1, (0.1, -0.2, 0.0)),)])) if waves else (),
            drain=draw(st.sampled_from([(), (liquids.Drain(basin.low, basin.high, 0.1),)])) if waves else (),
            sweeps=None if waves else draw(st.none() | st.integers(1, 100)),
            fill=draw(st.none() | st.just((basin.low, basin.high))),
            color=draw(colors),
        )
    sides = st.lists(st.sampled_from([b.name for b in bodies]), min_size=2, max_size=2, unique=True)
    contacts = ()
    if len(bodies) > 1 and draw(st.booleans()):
        mu, beta = draw(st.tuples(frictions, dampings).filter(lambda both: both != (None, None)))
        contacts = (ContactPair(*draw(sides), mu, beta),)
    cameras = draw(
        st.lists(
            st.builds(records.Camera, vectors, vectors | st.sampled_from([b.name for b in bodies]), up=vectors.filter(any)),
            max_size=1,
        )
    )
    cameras = tuple(c for c in cameras if c.eye != c.look)
    expects = []
    for kind, quantity in draw(st.lists(st.sampled_from(sorted(QUANTITIES)), max_size=3)):
        if wet if kind == "liquid" else QUANTITIES[kind, quantity].needs in ("", "liquid" * wet):
            subject = kind if kind in GLOBALS else draw(st.sampled_from([b.name for b in bodies]))
            time = draw(st.none() | st.floats(0, control.time))
            others, takes = [b.name for b in bodies if b.name != subject], QUANTITIES[kind, quantity].takes
            if takes == "object" and not others:
                continue
            if takes == "joined":  # these scenes have no joints
                continue
            axis = quantity.endswith("y")
            argument = {
                "object": others and draw(st.sampled_from(others)),
                "touched": draw(st.sampled_from([None, *others])),
                "place": basin.low[:2] if wet else None,
                "cut": 0.5 * (basin.low[axis] + basin.high[axis]) if wet else None,
            }.get(takes)
            relation = draw(st.sampled_from(["=", "<", ">", "<=", ">="]))
            tolerance = draw(st.floats(0, 1e3)) if relation == "=" else 0.0
            expects.append(records.Expect(subject, quantity, draw(numbers), tolerance, time, relation, argument))
    return records.SceneRecord(
        name="scene",
        control=control,
        title=draw(texts),
        language=draw(st.sampled_from(["free", "strict"])),
        gravity=(0.0, 0.0, -draw(positive)) if wet else draw(vectors),
        solids=bodies,
        liquid=liquid,
        contacts=contacts,
        ground=draw(st.none() | numbers),
        walls=draw(st.none() | st.just(Walls((-2e6,) * 3, (2e6,) * 3))),
        effects=draw(st.dictionaries(st.sampled_from(sorted(KEYWORDS["effects"])), st.sampled_from(records.Switch), max_size=3)),
        render=records.Render(
            size=draw(st.tuples(*[st.integers(1, 4000)] * 2)),
            movie=draw(st.none() | movies),
            background=draw(colors),
            camera=cameras,
            liquid=draw(st.sampled_from(["smooth", "cells"])),
        ),
        expects=tuple(expects),
    )


@steady
@given(scenes())
def test_any_scene_survives(scene):
    """Write any valid scene and read the same records back, to the last bit, in strict mode."""
    assert parse_scene(lock_text(scene), "scene", strict=True) == scene


@steady
@given(rotations())
def test_rotations_are_rotations(rows):
    """Every turn is orthonormal and right-handed to rounding (three matrices, 1e-16 each)."""
    assert departure(rows) < 1e-14


def test_joints_without_settings_survive():
    """Their place follows from what they join, so that nothing need be written in them."""
    box = "object {} {{ shape box (10, 10, 10) cm  position ({}, 0, 0) cm  density 500  elasticity rigid }}\n"
    text = box.format("a", 0) + box.format("b", 10) + "joint weld a b {}\njoint spring a b {}\ncontrol { time 1 s }\n"
    scene = parse_scene(text, "scene")
    assert len(scene.joints) == 2
    assert parse_scene(lock_text(scene), "scene", strict=True) == scene


def test_names_that_are_words_of_the_language_survive():
    """An object may be called mass, box, or repeat."""
    text = "".join(
        f"object {w} {{ shape sphere 1 m position (0, 0, 0) m mass 1 kg elasticity 1 MPa }}\n"
        for w in ("mass", "box", "auto", *(set(BLOCKS) - set(GLOBALS)), *STATEMENTS)
    )
    scene = parse_scene(text + "control { time 1 s }")
    assert parse_scene(lock_text(scene)) == scene


def test_mesh_path_is_absolute(tmp_path):
    """A mesh is found from anywhere."""
    (tmp_path / "a b.stl").write_bytes(b"solid")
    shape = 'shape mesh "a b.stl" scale 0.001'
    text = f"object a {{ {shape} position (0, 0, 0) m mass 1 kg elasticity 1 MPa }}\ncontrol {{ time 1 s }}"
    scene = parse_scene(text, folder=tmp_path)
    assert parse_scene(lock_text(scene)) == scene


def test_a_quote_cannot_be_written():
    """Refuse a text that the language cannot hold, rather than write a file that does not read back."""
    scene = records.SceneRecord("s", records.Control(1.0), title='say "hello"')
    with pytest.raises(ValueError, match="no quote"):
        lock_text(scene)


ROW = """repeat i in 1 .. {} {{ object b[i] {{ shape sphere 1 cm position (i, 0, 0) m mass 1 kg elasticity 1 MPa }} }}
control {{ time 1 s }}
"""


def test_lock_may_be_larger_than_a_scene(tmp_path, monkeypatch):
    """A lock is read by its name: it has every object of a repeat, and so more bytes than any scene may have."""
    monkeypatch.setattr("mdanim_lammps.scene.parse.MOST_BYTES", 10_000)
    scene = parse_scene(ROW.format(100))
    for name in ("scene.lock.txt", "scene.txt"):
        (tmp_path / name).write_text(lock_text(scene))
    assert load_scene(tmp_path / "scene.lock.txt").solids == scene.solids
    with pytest.raises(SceneError, match="is larger than"):
        load_scene(tmp_path / "scene.txt")


@pytest.mark.soak
@pytest.mark.timeout(3600)
def test_lock_of_many_objects(tmp_path):
    """220 000 objects are more than 64 MiB, and read back."""
    scene = parse_scene(ROW.format(220_000))
    (tmp_path / "scene.lock.txt").write_text(lock_text(scene))
    assert (tmp_path / "scene.lock.txt").stat().st_size > 64 * 2**20
    assert load_scene(tmp_path / "scene.lock.txt").solids == scene.solids
