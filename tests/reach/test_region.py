# SPDX-License-Identifier: GPL-2.0-only
"""Where objects can get to: never less than where they do get to, and contact is off where no two can meet."""

import random

import numpy as np
import pytest
from mdanim_lammps import features
from mdanim_lammps.effects import acting, resolve
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.reach import Reach
from mdanim_lammps.reach.region import Sweeps, _overlaps
from mdanim_lammps.scene.parse import parse_scene

PAIR = """{top}
object a {{
  shape sphere 0.1
  position (0, 0, 1)
  density 1000
  elasticity 1e6
  {a}
}}
object b {{
  shape sphere 0.1
  position (2, 0, 1)
  density 1000
  elasticity 1e6
  {b}
}}
control {{
  time 0.5
  resolution 0.05
}}
"""
DOWN = "gravity (0, 0, -9.81)\n"
POOL = "liquid w {{ basin from (-1, -1, {z}) to (3, 1, {top}) density 1000 level {level} }}\n"


def reach(scene):
    """Reach of the effects that act on its objects."""
    return Reach(scene, acting(features.effects(), scene))


def pair(top="", a="", b=""):
    """Two balls of 10 cm, 2 m apart, for half a second; they meet when each has gone 0.9 m."""
    return parse_scene(PAIR.format(top=top, a=a, b=b))


@pytest.mark.parametrize(
    ("scene", "meet"),
    [
        pytest.param(pair(), False, id="at rest, without forces"),
        pytest.param(pair(a="velocity (5, 0, 0)"), True, id="thrown at the other: 2.5 m"),
        pytest.param(pair(a="velocity (-5, 0, 0)"), False, id="thrown away"),
        pytest.param(pair(a="velocity (5, 0, 0)", b="velocity (0, 6, 0)"), True, id="boxes meet, balls do not: may meet"),
        pytest.param(pair(a="velocity (2, 0, 0)"), False, id="too slow: 1 m of 1.8 m"),
        pytest.param(pair("gravity (20, 0, 0)", b="hold all"), True, id="falls onto a held one: 2.5 m"),
        pytest.param(pair("gravity (20, 0, 0)\neffects { gravity off }", b="hold all"), False, id="gravity is switched off"),
        pytest.param(pair("gravity (20, 0, 0)"), True, id="side by side they fall, but boxes do not know when"),
        pytest.param(pair(DOWN), False, id="fall side by side"),
        pytest.param(pair(DOWN + "ground z 0"), False, id="bounce side by side: the ground pushes up only"),
        pytest.param(pair(DOWN + "ground z 0", a="velocity (5, 0, 0)"), True, id="bounces over to the other"),
        pytest.param(
            pair(DOWN + "walls from (-0.15, -9, 0) to (9, 9, 9)", a="velocity (-5, 0, 0)"), True, id="comes back from a wall"
        ),
        pytest.param(
            pair(DOWN + "walls from (-9, -9, 0) to (2.15, 9, 9)", b="velocity (5, 0, 0)"),
            True,
            id="comes back from the other wall",
        ),
        pytest.param(
            pair(DOWN + "walls from (-0.15, -9, 0) to (9, 9, 9)\neffects { walls off }", a="velocity (-5, 0, 0)"),
            False,
            id="the wall is switched off",
        ),
        pytest.param(pair(DOWN + POOL.format(z=-2, top=0, level=-1)), True, id="a liquid pushes wherever it likes"),
        pytest.param(pair(DOWN + POOL.format(z=-9, top=-8, level=-8.5)), False, id="the liquid is out of reach"),
        pytest.param(pair(a="spin (0, 0, 4000)"), True, id="spins 11 times as fast as waves"),
        pytest.param(pair(a="spin (0, 0, 20)\n drag 1"), False, id="spins"),
        pytest.param(pair("effects { springs off }", a="spin (0, 0, 60)"), True, id="loose particles fly off by 3 m"),
    ],
)
def test_what_can_meet(scene, meet):
    """Tell pairs that may come within reach from those that cannot."""
    first, second, apart = reach(scene).closest()
    assert (apart == 0.0) == meet
    assert (first.name, second.name) == ("a", "b")


def test_contact_is_off_with_the_nearest_pair():
    """Name the nearest two, what is left between them, and the scene line."""
    verdict = resolve(features.effects(), pair(DOWN)).verdicts["contact"]
    assert not verdict.on and verdict.span.line == 10
    # 2 m less two radii with a tenth of slack, less 2.5 spacings of reach for each.
    assert "nearest are a and b, with 1.53 m to spare" in verdict.reason
    verdict = resolve(features.effects(), pair(DOWN, a="velocity (9, 0, 0)")).verdicts["contact"]
    assert verdict.on and verdict.reason == "a and b may meet; no object has friction" and verdict.span.line == 10
    verdict = resolve(features.effects(), pair(DOWN, a="velocity (9, 0, 0)\n friction 0.3")).verdicts["contact"]
    assert verdict.on and verdict.reason == "a and b may meet"


def test_a_parabola_is_exact():
    """Sweep up to the apex and down to the end, and no further."""
    scene = pair(DOWN, a="velocity (1, 0, 3)")
    swept, radius = reach(scene).region, 0.1 * 1.1 + 2.5 * 0.05
    np.testing.assert_allclose(swept.low[0], np.array([0, 0, min(1, 1 + 1.5 - 9.81 / 8)]) - radius, atol=1e-12)
    np.testing.assert_allclose(swept.high[0], np.array([0.5, 0, 1 + 9 / 2 / 9.81]) + radius, atol=1e-12)


def test_what_bounces_may_fall_into_a_liquid():
    """Bound a ball that hits a wall by its speed on every axis where a liquid lies below its parabola."""
    walls = DOWN + "walls from (-0.15, -9, -9) to (9, 9, 9)\n"
    dry, wet = (reach(pair(walls + pool, a="velocity (-5, 0, 0)")).region for pool in ("", POOL.format(z=-2, top=-1, level=-1.5)))
    assert dry.high[0, 1] < 0.6 and wet.high[0, 1] > 1.0  # the basin's wall is at 1 m
    assert (wet.high[1] == dry.high[1]).all()


def test_held_beams_side_by_side_do_not_meet():
    """Leave contact out for clamped bars a little apart, unless they are so soft that they sag into each other's box."""
    text = (
        DOWN
        + "".join(
            f"object bar{k} {{ shape box (1, 0.1, 0.1) position (0, {0.6 * k}, 0) density 1000 elasticity MODULUS "
            "hold face -x }\n"
            for k in range(2)
        )
        + "control { time 1 }\n"
    )
    assert reach(parse_scene(text.replace("MODULUS", "1e9"))).closest()[2] > 0.0
    assert reach(parse_scene(text.replace("MODULUS", "1e5"))).closest()[2] == 0.0


# --- pairs --------------------------------------------------------------------------------------------------


def boxes(n: int, size: float, seed: int) -> Sweeps:
    """Boxes at random places in a cube; a third of them is held. Corners are whole numbers, so that many boxes just touch.
    A third are ropes, some pairs are joined, and some objects are parts of one body."""
    draw = np.random.default_rng(seed)
    low = np.floor(20 * draw.random((n, 3)))
    high, fixed = low + np.floor(20 * size * draw.random((n, 3))), draw.random(n) < 1 / 3
    i, j = np.sort(draw.integers(n, size=(2, n)), axis=0)
    passing = frozenset((a, b) for a, b in zip(i.tolist(), j.tolist()) if a < b and n > 2)
    return Sweeps(low, high, fixed, passing, draw.random(n) < 1 / 3, np.arange(n) // 3)


@pytest.mark.parametrize(("n", "size"), [(2, 1.0), (40, 0.05), (40, 0.4), (300, 0.1)])
def test_pairs_are_those_of_the_naive_way(n, size, monkeypatch):
    """Find each pair of overlapping boxes once, in blocks of any size."""
    swept = boxes(n, size, n)
    naive = {
        (i, j)
        for i in range(n)
        for j in range(i + 1, n)
        if (swept.low[i] <= swept.high[j]).all()
        and (swept.low[j] <= swept.high[i]).all()
        and not (swept.fixed[i] and swept.fixed[j])
        and not (swept.bare[i] and swept.bare[j])
        and (i, j) not in swept.passing
        and swept.body[i] != swept.body[j]
    }
    for block in (1, 50, 1 << 20):
        monkeypatch.setattr("mdanim_lammps.model.boxes.BLOCK", block)
        found = [tuple(p) for pairs in _overlaps(swept) for p in pairs.tolist()]
        assert len(found) == len(set(found)) and set(found) == naive


@pytest.mark.parametrize("n", [1, 2, 3, 4])
@pytest.mark.parametrize("seed", range(20))
def test_a_pair_is_there_as_in_the_naive_way(n, seed):
    """Pairs that are both held, both ropes, joined or of one body do not count."""
    draw = np.random.default_rng(seed)
    fixed, lines = draw.random((2, n)) < 0.6
    passing = frozenset((i, j) for i in range(n) for j in range(i + 1, n) if draw.random() < 0.4)
    body = np.arange(n) // draw.integers(1, n + 1)
    naive = any(
        not (fixed[i] and fixed[j]) and not (lines[i] and lines[j]) and (i, j) not in passing and body[i] != body[j]
        for i in range(n)
        for j in range(i + 1, n)
    )
    assert Sweeps(np.zeros((n, 3)), np.ones((n, 3)), fixed, passing, lines, body).any_pair == naive


def test_ten_thousand_objects_are_looked_through():
    """Find no pair, and the nearest, among 10^4 balls that fall side by side."""
    text = DOWN + (
        "ground z 0\nrepeat i in 0 .. 99 {\n repeat j in 0 .. 99 {\n object c[i*100 + j] { shape sphere 0.05 "
        "position (0.5*i, 0.5*j, 1) mass 1 elasticity 1e6 }\n }\n}\ncontrol { time 2 }\n"
    )
    scene = parse_scene(text.replace("(0.5*i, 0.5*j, 1)", "(0.5*i - 0.02*max(0, i - 98)*max(0, 1 - j), 0.5*j, 1)"))
    first, second, apart = reach(scene).closest()
    assert (first.name, second.name) == ("c[9800]", "c[9900]") and 0.2 < apart < 0.3


# --- never too small ----------------------------------------------------------------------------------------


def random_scene(draw: random.Random) -> str:
    """Two objects of any kind that fly, fall, swim, hang or spin, with contact switched off."""
    gravity = draw.choice(["(0, 0, -9.81)", "(0, 0, -9.81)", "(0, 0, 0)", "(1, -2, -4)"])
    text = f"gravity {gravity}\n"
    text += draw.choice(["", "ground z 0\n"]) + draw.choice(["", "walls from (-1.5, -1.5, -0.5) to (1.5, 1.5, 2.5)\n"])
    if gravity == "(0, 0, -9.81)" and draw.random() < 0.4:
        text += f"liquid w {{ basin from (-1.5, -1.5, -0.5) to (1.5, 1.5, 2) density 1000 level {draw.uniform(0.2, 1.2):.3f} }}\n"
    for k, x in enumerate((-0.9, 0.9)):
        shape = draw.choice(
            ["sphere 0.15", "box (0.3, 0.2, 0.4)", "torus 0.15 0.06", "cylinder 0.1 0.3", "box (0.6, 0.15, 0.15)"]
        )
        held = shape.startswith("box") and draw.random() < 0.3
        velocity = [0.0 if held else draw.choice([0, 1]) * draw.uniform(-2, 2) for _ in range(3)]
        spin = [0.0 if held else draw.choice([0, 0, 1]) * draw.uniform(-8, 8) for _ in range(3)]
        text += (
            f"object o{k} {{\n shape {shape}\n density {draw.choice([200, 800, 3000])}\n"
            f" elasticity {draw.choice([2e4, 1e5, 1e6])}\n"
            f" position ({x}, {draw.uniform(-0.6, 0.6)}, {draw.uniform(0.5, 1.6)})\n"
            f" orientation euler ({draw.uniform(-90, 90)}, {draw.uniform(-90, 90)}, 0) deg\n"
            f" velocity ({', '.join(map(str, velocity))})\n spin ({', '.join(map(str, spin))})\n"
            f" {'hold face -x' if held else draw.choice(['', 'drag 2', 'damping 0.2'])}\n}}\n"
        )
    return text + f"control {{ time {draw.uniform(0.1, 0.5):.2f}\n frames 100\n resolution 0.06 }}\neffects {{ contact off }}\n"


@pytest.mark.parametrize("seed", range(12))
def test_nothing_gets_out_of_its_box(prepared, seed):
    """Run random scenes without contact: every particle, with half the reach of a barrier, stays in its object's box."""
    ready = prepared(random_scene(random.Random(seed)))
    swept, system, c = reach(ready.scene).region, ready.system, ready.certificate
    around = 0.8 * system.spacing.max()
    with Instance(ready.plan) as instance:
        instance.setup()
        for _ in range(c.frames):
            x = instance.array("x")
            low, high = (f.reduceat(x, system.first[:-1]) for f in (np.minimum, np.maximum))
            assert (swept.low <= low - around).all() and (high + around <= swept.high).all()
            instance.run(c.steps_per_frame)
