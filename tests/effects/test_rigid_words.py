# SPDX-License-Identifier: GPL-2.0-only
"""Messages on rigid objects: notes and their hints, words in the wrong place, what `explain` tells."""

from types import SimpleNamespace

import numpy as np
import pytest
from mdanim_lammps.errors import SceneError
from mdanim_lammps.features.rigid.effect import AT_REST, PROOF, RigidMotion
from mdanim_lammps.scene.explain import explain
from mdanim_lammps.scene.parse import parse_scene
from paths import MESHES

BALL = "object {name} {{ shape sphere 10 cm  position ({x}, 0, 0.5) m  mass 1 kg  {more} }}\n"
SCENE = "gravity (0, 0, -9.81) m/s^2\nground z 0 m\n{objects}control {{ time 1 s {more} }}\n"


def scene(*objects, more=""):
    """Balls with these settings, far from each other."""
    balls = "".join(BALL.format(name="abc"[n], x=2 * n, more=words) for n, words in enumerate(objects))
    return SCENE.format(objects=balls, more=more)


@pytest.mark.parametrize(
    ("objects", "control", "hint"),
    [
        (
            ["elasticity rigid"],
            "",
            "write friction 0.5 in control, or restitution 0.3: without either a rigid object that lands keeps hopping",
        ),
        (["elasticity rigid restitution 0.5"], "", "write friction 0.5 in control"),
        (["elasticity rigid"], "restitution 0", "write friction 0.5 in control"),
        (
            ["elasticity rigid", "elasticity 200 kPa"],
            "",
            "write friction 0.5 in control, and damping 0.2 in object b: without damping an object that lands keeps hopping",
        ),
        (
            ["elasticity rigid hold all drive velocity (1, 0, 0) m/s", "elasticity rigid"],
            "",
            "write friction 0.5 in control, or restitution 0.3: without either a rigid object that lands keeps hopping",
        ),
    ],
)
def test_no_damping_is_advised_for_rigid_objects(prepared, objects, control, hint):
    """Against hopping a rigid object has restitution; it refuses damping."""
    (note,) = [n for n in prepared(scene(*objects, more=control)).certificate.notes if "frictionless" in n.message]
    assert note.hint == hint


@pytest.mark.parametrize(("most", "told"), [(0.9, ""), (9.8, ""), (4.0 * AT_REST, "write a timestep of 0.5 of this one")])
def test_a_bound_with_which_things_come_to_rest_is_not_told(prepared, most, told):
    """The note comes above the largest sum that scenes came to rest with, at no place of a scene: nobody wrote the step."""
    context = prepared(scene("elasticity rigid", more="accuracy balanced")).context
    found = RigidMotion().doubts(context, SimpleNamespace(ledger={PROOF: np.array([0.0, most])}.__getitem__))
    assert [told in p.hint and p.span is None and p.severity == "note" for p in found] == [True] * bool(told)


@pytest.mark.parametrize("before", ["mass 1 kg ", "mass 1 kg\n"], ids=["on the line", "on a line of its own"])
def test_rigid_alone_is_one_error(before):
    """The word without its keyword: one error, which says where it belongs; no second one that elasticity is missing."""
    with pytest.raises(SceneError) as caught:
        parse_scene(scene("rigid").replace("mass 1 kg  ", before))
    (problem,) = caught.value.problems
    assert problem.hint == "it belongs to elasticity: write elasticity rigid"


@pytest.mark.parametrize(
    ("words", "hint"),
    [
        ("", "e.g. elasticity 200 kPa, or elasticity rigid"),
        ("elasticity stiff", "give it one before: let stiff = ...; elasticity is written as elasticity E | spring k | rigid"),
    ],
)
def test_the_forms_of_elasticity_are_told(words, hint):
    """Where it is missing, or has a word that it does not know."""
    with pytest.raises(SceneError) as caught:
        parse_scene(scene(words))
    assert [p.hint for p in caught.value.problems] == [hint]


@pytest.mark.parametrize(
    ("word", "told"),
    [
        ("rigid", "elasticity rigid   a form of elasticity in object"),
        ("elasticity rigid", "does not deform"),
        ("contact_bound", "a column of ledger.csv"),
        ("contact bound", "up to 1 proves that the step is stable"),
    ],
)
def test_rigid_words_are_explained(word, told):
    """The form of elasticity, also as one writes it, and the column of the ledger."""
    assert told in explain(word)


SEESAW = """gravity (0, 0, -9.81) m/s^2
ground z 0 m
object pivot {{ shape {pivot}  orientation axis (1, 0, 0) angle 90 deg  position (0, 0, 0.1) m
  density 1000  elasticity rigid  hold all }}
object plank {{ shape box (200, 25, 4) cm  position (0, 0, 0.2201) m  density 600  elasticity rigid }}
object heavy {{ shape box (20, 20, 20) cm  position (0.8, 0, 1.2) m  mass 10 kg  elasticity {heavy} }}
control {{ time 0.5 s  friction 0.6 {more} }}
"""


UNCLEAN = f'mesh "{MESHES}/sliver.obj" scale 0.0666  resolution 2 cm'


def test_a_plank_on_a_cylinder_takes_the_steps_of_one_on_a_box(prepared):
    """At points of its surface it took 22 times as many."""
    cylinder, box = (
        prepared(SEESAW.format(pivot=pivot, heavy="rigid", more="")).certificate
        for pivot in ("cylinder 10 cm 30 cm", "box (20, 20, 30) cm")
    )
    assert not [n for n in cylinder.notes if "sets the time step" in n.message]
    assert cylinder.steps == pytest.approx(box.steps, rel=5e-3)


def test_check_names_the_shape_that_makes_steps_short(prepared):
    """A plank on a mesh with a triangle of no area takes many times the steps of one on a box: the pair, the way out, and the
    steps with it, which are those of the scene with a box."""
    certificate = prepared(SEESAW.format(pivot=UNCLEAN, heavy="rigid", more="")).certificate
    (note,) = [n for n in certificate.notes if "sets the time step" in n.message]
    assert note.message.startswith("contact of pivot with plank") and "this mesh" in note.message
    told = float("".join(note.hint.rpartition(":")[2].removesuffix("steps").split()))
    with_box = prepared(SEESAW.format(pivot="box (20, 20, 30) cm", heavy="rigid", more="")).certificate
    assert not [n for n in with_box.notes if "sets the time step" in n.message]
    # Steps fit a whole number of times into each frame: one of about 500 is more.
    assert told == pytest.approx(with_box.steps, rel=5e-3) and told < 0.1 * certificate.steps


@pytest.mark.parametrize(
    ("heavy", "more"), [("5 GPa", ""), ("rigid", "timestep 1e-6 s")], ids=["something soft", "a step of its own"]
)
def test_it_is_not_named_where_another_shape_would_not_help(prepared, heavy, more):
    """Where a soft object needs as short steps, or the step was written."""
    certificate = prepared(SEESAW.format(pivot=UNCLEAN, heavy=heavy, more=more)).certificate
    assert not [n for n in certificate.notes if "sets the time step" in n.message]


def test_it_is_not_named_beside_held_cuboids_in_touch(prepared):
    """A side that is hidden in part keeps features off, so boxes touch at points of surfaces there, too, and the steps stay
    short."""
    seam = (
        "object floor[i] { shape box (40, 40 - 20*i, 10) cm  "
        "position (2 + 0.4*i, 2, 0.05) m  density 1  elasticity rigid  hold all }"
    )
    text = SEESAW.format(pivot=UNCLEAN, heavy="rigid", more="")
    certificate = prepared(text + f"repeat i in 0 .. 1 {{ {seam} }}\n").certificate
    assert not [n for n in certificate.notes if "sets the time step" in n.message]


@pytest.mark.parametrize(("size", "is_refused"), [("2, 1, 0.000001", True), ("2, 1, 0.00001", False)])
@pytest.mark.parametrize("how", ["elasticity rigid", "elasticity rigid  hold all", "elasticity 1 MPa  hold all"])
def test_a_box_too_thin_for_its_corners_is_refused(size, is_refused, how):
    """Corners that are nearer than 1e-6 of the diagonal are one: the fix stopped with its own error."""
    text = f"object plate {{ shape box ({size}) m  position (0, 0, 0) m  density 500  {how} }}\n"
    text = scene("elasticity rigid") + text
    if not is_refused:
        parse_scene(text)
        return
    with pytest.raises(SceneError, match=r"plate is 0\.001 mm thin, less than a millionth of its size") as caught:
        parse_scene(text)
    (problem,) = caught.value.problems
    assert (problem.span.line, problem.span.column) == (5, 26) and "0.00226 mm" in problem.hint


def test_a_thin_box_is_no_fault_where_nothing_rigid_moves():
    """Features are not asked for there."""
    text = "object plate { shape box (2, 1, 0.000001) m  position (0, 0, 0) m  density 500  elasticity rigid  hold all }\n"
    parse_scene(text + "control { time 1 s }\n")
