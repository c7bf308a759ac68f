# SPDX-License-Identifier: GPL-2.0-only
"""Layers on layers in runs: sheets that lie on each other, a sheet and a rope that fold, energy, what calls for it."""

import numpy as np
import pytest
from mdanim_lammps import Scene
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.features.folds.layers import pairs
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene
from scipy.spatial.distance import cdist

DOWN = "gravity (0, 0, -9.81) m/s^2\nground z 0 m\n"
CLOTH = "density 400 kg/m^3  elasticity 500 kPa  damping 0.3  friction 0.4"
ROPE = """object rope {{ shape rope from (0, 0, 0.03) m to (0.02, 0, 0.8) m thickness 1.5 cm  density 800  elasticity 1 MPa
  damping 0.2  friction 0.4  touches-itself {word} }}
"""


def sheet(name: str, size: str, place: str, thickness: str = "4 mm", more: str = "") -> str:
    return f"object {name} {{ shape sheet {size} m thickness {thickness}  position {place} m  {CLOTH}  {more} }}\n"


def ready_of(text: str, time: float = 1.0):
    return prepare(parse_scene(f"{text}control {{ time {time} s  accuracy preview }}\n"))


def moments(ready, time: float, count: int) -> list[np.ndarray]:
    """Places of all particles at moments until a time [s]."""
    found = []
    with Instance(ready.plan) as instance:
        instance.setup()
        for _ in range(count):
            instance.run(round(time / count / ready.certificate.timestep))
            found.append(instance.array("x").copy())
    return found


@pytest.mark.parametrize("thickness", [0.004, 0.03])
def test_two_sheets_lie_on_each_other(thickness):
    """The upper one lies above the lower one by the reach, which is the thickness or a third of a spacing, less what its weight
    presses; no particle is through."""
    layer = f"{thickness!r} m"
    text = DOWN + sheet("lower", "(0.4, 0.4)", "(0, 0, 0.03)", layer) + sheet("upper", "(0.3, 0.2)", "(0, 0.02, 0.08)", layer)
    ready = ready_of(text, 0.8)
    (x,) = moments(ready, 0.8, 1)
    first, (pair,) = ready.system.first, pairs(ready.context)
    assert pair.reach == pytest.approx(max(thickness, ready.system.spacing.max() / 3.0))
    gap = x[first[1] :, 2] - np.median(x[: first[1], 2])
    assert 0.8 * pair.reach < gap.min() and gap.max() < 1.05 * pair.reach


def stack(count: int, more: str = "") -> str:
    """Sheets over each other."""
    return DOWN + more + "".join(sheet(f"s{n}", "(0.12, 0.12)", f"(0, 0, {0.02 + 0.012 * n})") for n in range(count))


def test_many_sheets_take_the_step_of_three():
    """A particle has at most one over it and one below it; a step for all of them at once was 1/5 as long for 100."""
    three, many = (ready_of(stack(count)).certificate.timestep for count in (3, 12))
    assert many == three


def test_a_pressed_stack_keeps_its_energy(tmp_path):
    """A rigid block falls onto ten sheets. At twice this step, 1.2 times the bound, energies do not add up."""
    block = "object block { shape box (0.1, 0.1, 0.06) m  position (0, 0, 0.2) m  mass 3 kg  elasticity rigid }\n"
    (tmp_path / "stack.txt").write_text(stack(10, block) + "control { time 0.2 s  frames 25 fps  resolution 2 cm }\n")
    run = Scene.load(tmp_path / "stack.txt").run(tmp_path / "stack.out")
    assert run.ledger.residual < 1e-3


@pytest.mark.parametrize(
    ("block", "friction", "damping"),
    [
        ("", 0.4, 0.3),
        ("contact upper lower { friction 0.1 }", 0.1, 0.3),
        ("contact lower upper { friction 0 }", 0.0, 0.0),
        ("contact lower upper { contact-damping 0.7 }", 0.4, 0.7),
        ("contact upper other { friction 0.9 }", 0.4, 0.3),
    ],
)
def test_a_contact_block_holds_for_layers(block, friction, damping):
    """As it does for all other contact: the block counts in place of what follows from both objects."""
    text = "".join(sheet(name, "(0.2, 0.2)", f"(0, 0, {z})") for name, z in (("lower", 0.03), ("upper", 0.08), ("other", 0.13)))
    found = {(p.first, p.second): (p.friction, p.damping) for p in pairs(ready_of(DOWN + text + block + "\n").context)}
    assert found[0, 1] == pytest.approx((friction, damping)) and len(found) == 3


def nearest_parts(ready, x: np.ndarray) -> float:
    """Least distance of particles of the first object that are far from each other in the shape without load, over the reach."""
    (pair,) = pairs(ready.context)
    rest = cdist(ready.system.position, ready.system.position)
    return float(cdist(x, x)[rest > pair.apart + ready.system.spacing[0]].min() / pair.reach)


def test_a_sheet_that_folds_lies_on_itself():
    """A strip that falls edge first: parts of it come within reach, and no particle within half of it."""
    stands = "orientation axis (0, 1, 0) angle -80 deg  touches-itself yes"
    ready = ready_of(DOWN + sheet("strip", "(0.6, 0.1)", "(0, 0, 0.31)", "6 mm", stands))
    least = [nearest_parts(ready, x) for x in moments(ready, 1.0, 10)]
    assert 0.5 < min(least) < 1.5


def crossings(x: np.ndarray, reach: float) -> float:
    """Least distance of the middles of links that are not near each other along a rope, over the reach."""
    middle = 0.5 * (x[1:] + x[:-1])
    i, j = np.triu_indices(len(middle), 6)
    return float(np.linalg.norm(middle[i] - middle[j], axis=1).min() / reach)


def test_a_rope_that_coils_lies_on_itself():
    """Its links stay apart by its thickness; without the word they come nearer."""
    least = {}
    for word in ("yes", "no"):
        ready = ready_of(DOWN + ROPE.format(word=word))
        least[word] = min(crossings(x, 0.015) for x in moments(ready, 0.8, 16))
    assert least["no"] < 0.6 and least["yes"] > 0.8


def test_what_calls_for_it():
    """Sheets that may meet, and the word; neither one sheet alone, nor sheets far from each other, nor what is joined."""
    far = sheet("other", "(0.4, 0.4)", "(90, 0, 0.1)")
    one, other = sheet("one", "(0.4, 0.4)", "(0, 0, 0.1)"), sheet("other", "(0.4, 0.4)", "(0, 0, 0.3)")
    joint = "joint ball one other { at (0.2, 0.2, 0.2) m }\n"
    upright = other.replace("(0, 0, 0.3)", "(0.2, 0, 0.3)").replace(
        "friction", "orientation axis (0, 1, 0) angle 90 deg  friction"
    )
    cases = {
        one: False,
        one + far: False,
        one + other: True,
        one.replace("friction", "touches-itself yes  friction"): True,
        one.replace("0.1)", "0.2)") + upright.replace("0.3) m", "0.4) m") + joint: False,
    }
    for text, expected in cases.items():
        assert ready_of(DOWN + text, 0.2).resolved.on("folds") == expected, text


@pytest.mark.parametrize("more", ["hold all", "elasticity rigid"])
def test_what_does_not_deform_is_refused(more):
    box = "object box { shape box (10, 10, 10) cm  position (0, 0, 1) m  density 500  elasticity 1 MPa  touches-itself yes  "
    box += more + " }\n"
    box = box.replace("elasticity 1 MPa", "") if "rigid" in more else box
    with pytest.raises(Exception, match="does not deform, and never touches itself"):
        ready_of(box)
