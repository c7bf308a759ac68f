# SPDX-License-Identifier: GPL-2.0-only
"""A rigid body that hangs by points below its centre of mass is told before the run, a joint that has opened after it."""

import pytest
from mdanim_lammps import Scene
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

SWING = """gravity (0, 0, -9.81) m/s^2
repeat k in 1 .. 2 {
  let y = (2*k - 3)*24 cm
  object rod[k] { shape box (2, 2, 156) cm  position (0, y, 132 cm)  density 2000  elasticity rigid }
  joint ball rod[k] world { at (0, y, 2.1 m) }
  joint ball rod[k] seat { at (0, y, 0.54 m) }
}
object seat { shape box (24, 56, 4) cm  position (0, 0, 0.52) m  density 600  elasticity rigid }
"""
RIDER = "object rider { shape box (20, 30, 50) cm  position (0, 0, 0.79) m  density 300  elasticity rigid }\n"
WELD = "joint weld rider seat {}\n"


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ("", False),
        (RIDER + WELD, True),
        (RIDER + WELD + "joint ball rod[1] rider { at (0, -0.24, 1) m }\n", False),
        (RIDER + WELD + "joint weld rod[1] seat {}\n", False),
    ],
    ids=["a seat alone", "with a rider", "held above him too", "stiff"],
)
def test_a_swing_below_its_rider(more, told):
    """By two points below the centre of mass it turns over; a third one above, or a weld, keeps it."""
    notes = [note.message for note in prepare(parse_scene(SWING + more + "control { time 1 s }\n")).certificate.notes]
    said = [note for note in notes if "hangs by points" in note]
    assert [note.split(" below")[0] for note in said] == ["what is welded of seat, rider hangs by points that are 17.9 cm"][:told]


@pytest.mark.parametrize(
    ("pair", "told"),
    [("body wheel", True), ("wheel body", False), ("body wheel { at (0.3, 0.2, 0.1) m }", False), ("body lid", False)],
)
def test_a_hinge_in_the_middle_of_the_wrong_object(pair, told):
    """A wheel that is named second, without a place, is held by the middle of the car; a lid of its size may be meant so."""
    text = f"""object body {{ shape box (80, 30, 10) cm  position (0, 0, 0.2) m  mass 5 kg  elasticity rigid }}
object wheel {{ shape cylinder 10 cm 4 cm  position (0.3, 0.2, 0.1) m  orientation axis (1, 0, 0) angle 90 deg  mass 1 kg
  elasticity rigid }}
object lid {{ shape box (80, 30, 11) cm  position (0, 0, 0.5) m  mass 5 kg  elasticity rigid }}
joint hinge {pair if "{" in pair else pair + " {}"}
control {{ time 1 s }}
""".replace("{}", "{ axis (0, 1, 0) }").replace("m }\n", "m  axis (0, 1, 0) }\n")
    said = [note for note in prepare(parse_scene(text)).certificate.notes if "says no place" in note.message]
    assert [note.hint for note in said] == ["name wheel first, joint hinge wheel body, or write at (0.3, 0.2, 0.1) m"][:told]


@pytest.mark.parametrize(("more", "told"), [("", True), ("stiffness 4e6 N/m", False)])
def test_a_joint_that_has_opened(tmp_path, more, told):
    """Three bars without slack between fixed ends pull far harder at their joints than their weights, which `check` counts on."""
    text = f"""gravity (0, 0, -9.81) m/s^2
repeat i in 1 .. 3 {{ object bar[i] {{ shape box (31, 4, 1) cm position (0.32*(i - 2), 0, 1) density 2000 elasticity rigid }} }}
repeat i in 1 .. 2 {{ joint ball bar[i] bar[i + 1] {{ at (0.32*(i - 1.5), 0, 1) {more} }} }}
joint ball bar[1] world {{ at (-0.48, 0, 1) {more} }}
joint ball bar[3] world {{ at (0.48, 0, 1) {more} }}
control {{ time 0.3 s }}
"""
    (tmp_path / "bars.txt").write_text(text)
    said = [p for p in Scene.load(tmp_path / "bars.txt").run(tmp_path / "bars.out").warnings if "has opened by" in p.message]
    assert len(said) == told
    assert not said or ("joint ball bar[" in said[0].message and "write stiffness" in said[0].hint)
