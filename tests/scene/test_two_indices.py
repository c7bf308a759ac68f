# SPDX-License-Identifier: GPL-2.0-only
"""Names with an index for each of two nested repeats, wherever a name is said."""

import pytest
from mdanim_lammps.errors import SceneError
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.lock import lock_text
from mdanim_lammps.scene.naming import objects_by_name
from mdanim_lammps.scene.parse import parse_scene

NET = """gravity (0, 0, -9.81) m/s^2
repeat i in 1 .. 2 { repeat j in 1 .. 3 {
  object b[i][j] { shape box (9, 9.99, 9) cm position (10*i, 10*j, 50) cm density 1000 elasticity rigid }
} }
repeat i in 1 .. 2 { repeat j in 1 .. 2 { joint ball b[i][j] b[i][j + 1] { at (10*i, 10*j + 5, 50) cm } } }
joint spring b[1][1] world { to (10, 10, 80) cm stiffness 100 N/m }
"""
MORE = """contact b[1] b[2][3] { friction 0.7 }
expect b[2][3].position.z < 1 m
expect b[1][1].joint.force(world) < 100 N
record b[1][2].velocity.z
render { trail b[1]  label b[2][3] "free" }
control { time 0.1 s }
"""


def told(text: str) -> list:
    """Problems of a scene."""
    with pytest.raises(SceneError) as e:
        prepare(parse_scene(text))
    return e.value.problems


def test_objects_have_them():
    """Names are those of the indices, in joints and expects too, and the lock says the same."""
    scene = parse_scene(NET + MORE)
    assert [s.name for s in scene.solids] == [f"b[{i}][{j}]" for i in (1, 2) for j in (1, 2, 3)]
    prepare(scene)
    again = parse_scene(lock_text(scene, {}))
    assert [s.name for s in again.solids] == [s.name for s in scene.solids]
    assert again.joints == scene.joints and again.contacts == scene.contacts


def test_a_name_with_fewer_indices_stands_for_a_row_or_for_all():
    """As the name of a repeat stands for all of it."""
    found = objects_by_name(["b[1][1]", "b[1][2]", "b[2][1]", "c[4].d[1][2]"])
    assert found["b"] == [0, 1, 2] and found["b[1]"] == [0, 1] and found["b[2]"] == [2] and found["b[2][1]"] == [2]
    assert found["c[4].d[1]"] == found["c[4].d"] == found["c.d"] == found["c[4]"] == found["c"] == [3]


@pytest.mark.parametrize(("text", "cause", "way_out"), [
    (NET + "joint ball b[1][4] world { }\n", "b[1][4]", "did you mean 'b[1][3]'"),
    (NET + "contact b[7][1] b[1][2] { friction 1 }\n", "b[7][1]", "did you mean"),
    (NET + "expect b[1][9].position.z < 1 m\n", "b[1][9]", "did you mean"),
    (NET + "expect b[1, 2].position.z < 1 m\n", "each bracket of b has one index, found ','", "write b[i][j]"),
    (NET + "expect b[1][1.5].position.z < 1 m\n", "an index is a whole number, found 1.5", ""),
    (NET.replace("b[i][j] {", "b[j] {"), "the name b[1] is given twice", "b[i][j]"),
    ("expect b[1]" + 20 * "[1]" + ".position.z < 1 m\n" + NET, "indices", "100*i + j"),
])  # fmt: skip
def test_mistakes(text, cause, way_out):
    """With what was meant."""
    found = told(text + "control { time 1 s }\n")
    assert any(cause in p.message and way_out in p.hint and p.span.line for p in found), [(p.message, p.hint) for p in found]
