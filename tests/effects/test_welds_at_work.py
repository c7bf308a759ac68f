# SPDX-License-Identifier: GPL-2.0-only
"""Welds between rigid objects: they move as one body, and rows of joints tell what a weld bears, as statics has it."""

from pathlib import Path

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.errors import SceneError
from mdanim_lammps.features.joints.links import links_of
from mdanim_lammps.features.joints.rows import FIRST, FORCE, GAP, NUMBER, TORQUE
from mdanim_lammps.features.joints.welds import hung_by
from mdanim_lammps.run.energy import tell

G = 9.81
MESHES = Path(__file__).parents[2] / "scenes" / "meshes"
CONTROL = "gravity (0, 0, -9.81) m/s^2\nground z 0\ncontrol { time 1 s friction 0.5 }\n"
LAMP = """object foot {{ shape box (20, 20, 10) cm position (0, 0, {low}) m density 2000 elasticity rigid }}
object post {{ shape box (4, 4, 30) cm position (0, 0, {low} + 0.2) m density 500 elasticity rigid }}
object arm {{ shape box (16, 4, 4) cm position (0.1, 0, {low} + 0.33) m density 1000 elasticity rigid }}
joint weld arm post {{ at (0.02, 0, {low} + 0.33) m }}
joint weld foot post {{ at (0, 0, {low} + 0.05) m }}
"""
FOOT, POST, ARM = 8.0, 0.24, 0.256  # kg


def rows_after(ready, seconds):
    """Rows of joints, in the order of the scene, and particles after some time."""
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(round(seconds / ready.certificate.timestep))
        told = tell(instance)["joint"]["value"]
        return told[np.argsort(told[:, NUMBER])], instance.array("x").copy()


def test_welds_bear_what_hangs_on_them(prepared):
    """A lamp that stands: its arm by its root, arm and post at the foot."""
    ready = prepared(CONTROL + LAMP.format(low=0.05))
    rows, _ = rows_after(ready, 0.5)
    assert rows[:, FORCE] == pytest.approx([ARM * G, (POST + ARM) * G], rel=1e-6)
    # The foot sinks in more on the side of the arm: the lamp leans by 4e-6.
    assert rows[:, TORQUE] == pytest.approx([ARM * G * 0.08, ARM * G * 0.1], rel=3e-5)
    assert rows[:, GAP].tolist() == [0.0, 0.0]
    assert rows[:, FIRST] == pytest.approx(np.array([(0.02, 0.0, 0.38), (0.0, 0.0, 0.1)]), abs=1e-4)


def test_a_weld_bears_nothing_in_a_fall_and_what_turns_its_part(prepared):
    """A cube that spins about the weld pulls at it by m w^2 r."""
    text = "".join(
        f"object end[{k}] {{ shape box (10, 10, 10) cm position ({0.05 * (2 * k - 3)}, 0, 5) m density 1000 elasticity rigid "
        f"velocity (0, {0.05 * (2 * k - 3) * 20}, 0) m/s spin (0, 0, 20) rad/s }}\n"
        for k in (1, 2)
    )
    ready = prepared(CONTROL + text + "joint weld end[1] end[2] { at (0, 0, 5) m }\n")
    rows, x = rows_after(ready, 0.1)
    assert rows[0, FORCE] == pytest.approx(1.0 * 20.0**2 * 0.05, rel=1e-5)
    assert rows[0, TORQUE] == pytest.approx(0.0, abs=1e-9)
    middle = ready.system.center_of_mass(x)
    assert np.linalg.norm(middle[1] - middle[0]) == pytest.approx(0.1, abs=1e-12)


def test_welds_of_a_ring_share_what_they_bear(prepared):
    """Two welds side by side bear half each, in any place of the body; of three parts in a ring, what hangs on both others."""
    cube = "object {} {{ shape box (20, 20, 20) cm position (0, 0, {}) cm density 1000 elasticity rigid velocity (0, {}, 0) m/s "
    cube += "spin (3, 0, 0) rad/s }}\n"
    pair = cube.format("a", 100, 0) + cube.format("b", 80, 0.6)
    welds = "".join(f"joint weld a b {{ at (0, {y}, 90) cm }}\n" for y in (-8, 8))
    rows, _ = rows_after(prepared(CONTROL.replace("-9.81", "0") + pair + welds), 0.3)
    assert rows[:, FORCE] == pytest.approx(np.full(2, 0.5 * 8.0 * 3.0**2 * 0.1), rel=1e-5)
    turned, middle = np.array([(0.0, np.cos(0.9), np.sin(0.9))]), np.array([(0.0, 0.3 * 0.3, 0.9)])
    assert rows[:, FIRST] == pytest.approx(np.concatenate([middle - 0.08 * turned, middle + 0.08 * turned]), abs=1e-5)
    rows, _ = rows_after(prepared(CONTROL + LAMP.format(low=0.05) + "joint weld arm foot { at (0.02, 0, 0.3) m }\n"), 0.5)
    assert (rows[:, FORCE] > 0.01 * ARM * G).all() and (rows[:, FORCE] < (POST + ARM) * G).all()


def test_step_is_that_of_the_body(prepared):
    """A table with a heavy crate: legs bear it as a part of the table, not each alone."""
    text = (
        "object top { shape box (100, 60, 4) cm position (0, 0, 0.72) m density 600 elasticity rigid }\n"
        "object crate { shape box (40, 40, 40) cm position (0, 0, 0.94) m density 600 elasticity rigid }\n"
    )
    for k, (x, y) in enumerate(((0.4, 0.2), (-0.4, 0.2), (0.4, -0.2), (-0.4, -0.2))):
        text += f"object leg[{k}] {{ shape box (4, 4, 70) cm position ({x}, {y}, 0.35) m density 600 elasticity rigid }}\n"
        text += f"joint weld leg[{k}] top {{ at ({x}, {y}, 0.7) m MORE }}\n"
    steps = [prepared(CONTROL + text.replace("MORE", more)).certificate.timestep for more in ("", "stiffness 1e6 N/m")]
    assert steps[0] > 1.5 * steps[1]


@pytest.mark.parametrize(
    ("more", "count"),
    [("", 3), ("joint weld arm foot { at (0.02, 0, 0.3) m }", 4), ("joint weld arm world { at (0.1, 0, 0.38) m }", 3)],
)
def test_which_welds_make_one_body(prepared, more, count):
    """Welds between objects that are free do, also where they close a ring; not those with the world."""
    hook = "object hook { shape sphere 2 cm position (0.19, 0, 0.35) m density 100 elasticity rigid }\njoint weld hook arm { }\n"
    links = links_of(prepared(CONTROL + LAMP.format(low=0.05) + hook + more).scene)
    assert len(links.welds) == count and len(hung_by(links)) == 3
    assert set(links.whole_of) == {0, 1, 2, 3}


def test_parts_of_one_body_may_overlap(prepared):
    """Also where no weld joins both; a knob at the post is in the foot, too. What is not of the body may not."""
    knob = "object knob { shape sphere 4 cm position (0, 0, 0.12) m density 100 elasticity rigid }\n"
    text = CONTROL + LAMP.format(low=0.05) + knob
    prepared(text + "joint weld knob post { at (0, 0, 0.14) m }\n")
    with pytest.raises(SceneError, match="knob starts inside"):
        prepared(text)


def test_rows_are_told_beside_what_another_fix_moves(prepared):
    """A mesh whose features contact does not know stands first, and has no row in the fix of welds."""
    shape = f'shape mesh "{MESHES / "bottle.stl"}" scale 0.01 resolution 1.5 cm'
    bottle = f"object bottle {{ {shape} position (3, 0, 1) m density 300 elasticity rigid }}\n"
    rows, _ = rows_after(prepared(CONTROL + bottle + LAMP.format(low=0.05)), 1e-3)
    assert rows[:, FIRST] == pytest.approx(np.array([(0.02, 0.0, 0.38), (0.0, 0.0, 0.1)]), abs=1e-4)


def test_welds_of_what_moves_apart_are_warned_of(prepared):
    """As one body, both lose their motion against each other at the start."""
    text = "object a {{ shape box (1, 1, 1) m position (0, 0, 5) m density 1000 elasticity rigid velocity ({v}, 0, 0) m/s }}\n"
    other = text.replace("a {{", "b {{").replace("(0, 0, 5)", "(1, 0, 5)")
    weld = "joint weld a b { at (0.5, 0, 5) m }\n"
    assert not prepared(CONTROL + text.format(v=2) + other.format(v=2) + weld).warnings
    (told,) = prepared(CONTROL + text.format(v=2) + other.format(v=-1) + weld).warnings
    assert "joint weld a b: what it holds together moves apart at 3 m/s" in str(told.message)


@pytest.mark.parametrize("own", ["stiffness 1e5 N/m", "breaks 100 N"])
def test_what_a_weld_says_of_itself_makes_it_a_spring(prepared, own):
    """It gives way, or breaks."""
    text = LAMP.format(low=0.05).replace("at (0.02, 0, 0.05 + 0.33) m", f"at (0.02, 0, 0.05 + 0.33) m {own}")
    links = links_of(prepared(CONTROL + text).scene)
    assert [link.number for link in links.welds] == [1] and [link.number for link in links.springs] == [0]
