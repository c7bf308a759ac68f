# SPDX-License-Identifier: GPL-2.0-only
"""Rigid objects that start in each other are refused by the shapes with which they touch, whatever their shapes."""

import math
import re

import pytest
import rigid_meshes
from mdanim_lammps.errors import SceneError
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

SCENE = """gravity (0, 0, -9.81) m/s^2
object held {{ {held}  density 1000  elasticity rigid  hold all }}
object it {{ {it}  density 1000  elasticity rigid }}
control {{ time 0.1 s  friction 0.5 }}
"""
ACROSS = "orientation axis (1, 0, 0) angle 90 deg"
STAIRS = [(0, 0), (0.9, 0), (0.9, 0.2), (0.6, 0.2), (0.6, 0.4), (0.3, 0.4), (0.3, 0.6), (0, 0.6)]


def scene(folder, held: str, it: str) -> str:
    """The text of a scene; ``held`` may be stairs, or a bowl whose triangles are smooth patches."""
    meshes = {"stairs": lambda: rigid_meshes.profile(STAIRS, 1.0), "bowl": lambda: rigid_meshes.bowl(0.5, 0.05, 1.2, 24, 10)}
    if held in meshes:
        points, triangles = meshes[held]()
        rows = [f"v {x!r} {y!r} {z!r}\n" for x, y, z in points.tolist()] + [f"f {a} {b} {c}\n" for a, b, c in triangles + 1]
        (folder / "held.obj").write_text("".join(rows))
        held = 'shape mesh "held.obj" scale 1  origin file  position (0, 0, 0) m'
    return SCENE.format(held=held, it=it)


def problems(text: str) -> list:
    """Problems of a scene that can be read."""
    try:
        prepare(parse_scene(text))
    except SceneError as error:
        return list(error.problems)
    return []


def freed(text: str, hint: str) -> str:
    """The scene with the object moved as a hint tells."""
    way, far = re.fullmatch(r"move it (up|down|to [+-][xy]) by (\S+) mm", hint).groups()
    axis, sign = ("xyz".index(way[-1]), 1 if "+" in way else -1) if "to" in way else (2, 1 if way == "up" else -1)
    place = re.findall(r"position \(([^)]*)\)", text)[-1]
    x = [float(part) for part in place.split(",")]
    x[axis] += sign * float(far) * 1e-3
    return text.replace(place, ", ".join(map(repr, x)))


BAR = "shape cylinder 10 cm 80 cm  position (0, 0, 0) m"
CASES = {
    "cylinders that cross": (BAR, lambda d: f"shape cylinder 10 cm 90 cm  position ({0.2 - d!r}, 0.03, 0.02) m  {ACROSS}"),
    "a ring on a bar": (
        BAR.replace("0) m", f"0) m  {ACROSS}"),
        lambda d: f"shape torus 30 cm 6 cm  position (0, 0, {0.16 - d!r}) m",
    ),
    "eggs": (
        "shape ellipsoid (30, 20, 10) cm  position (0, 0, 0) m",
        lambda d: f"shape ellipsoid (10, 20, 30) cm  position (0, 0, {0.4 - d!r}) m",
    ),
    "a box across the edge of a step": (
        "stairs",
        lambda d: (
            f"shape box (10, 300, 10) cm  position ({0.6 + 0.05 - d!r}, 0, 0.45) m  orientation axis (1, 0, 0) angle 45 deg"
        ),
    ),
    "a ball in a bowl": (
        "bowl",
        lambda d: f"shape sphere 20 cm  position ({(0.3 + d) * math.sin(0.4)!r}, 0, {0.5 - (0.3 + d) * math.cos(0.4)!r}) m",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_depths_that_show_are_refused(tmp_path, monkeypatch, case):
    """From 1/1000 of the thinner one on, and the move that the message tells frees the object."""
    monkeypatch.chdir(tmp_path)
    held, it = CASES[case]
    text = lambda deep: scene(tmp_path, held, it(deep))
    assert not problems(text(1e-5))
    for deep in (1e-3, 5e-3):
        (found,) = problems(text(deep))
        told = re.fullmatch(r"it starts inside held, about (\S+) mm deep", found.message)
        assert told and float(told[1]) == pytest.approx(1e3 * deep, rel=0.15)
        assert not problems(freed(text(deep), found.hint))


def posed(place, q) -> str:
    """Words of a place [m] and of a rotation by a unit quaternion."""
    axis = ", ".join(map(repr, q[1:]))
    return f"position ({', '.join(map(repr, place))}) m  orientation axis ({axis}) angle {2 * math.acos(q[0])!r} rad"


APART = {
    "a bar and a cone": (
        "shape cylinder 10 cm 30 cm",
        (-0.08227546094667487, -0.13487158626060364, 0.5827939804344887, -0.7971145338750796),
        "shape cone 12 cm 25 cm",
        (0.13745059605308868, 0.13774045561621986, -0.20241478280309402),
        (-0.4382245727904903, 0.5174050557385859, -0.56782707068759, -0.4667158127737841),
    ),
    "a box and a can": (
        "shape box (30, 20, 15) cm",
        (0.32615428408434314, -0.31805492615310915, -0.7549900030014133, -0.4716508690691718),
        "shape cylinder 15 cm 10 cm",
        (-0.03102059055572441, 0.06589414102498155, -0.26493993265739885),
        (0.7447088255102811, -0.041136023270545954, 0.22034316742850862, 0.628621890618005),
    ),
}


@pytest.mark.parametrize("case", APART)
def test_round_shapes_that_are_apart_may_start(case):
    """By 0.3 mm: normals of their far rims are opposite, too, at depths of the size of both, where nothing touches."""
    held, turn, it, place, turned = APART[case]
    if "cone" in it:  # a cone is placed by its centre of mass, below its middle
        w, x, y, z = turned
        along = (2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y))
        place = tuple(a - 0.25 * 0.25 * b for a, b in zip(place, along))
    assert not problems(scene(None, f"{held}  {posed((0, 0, 0), turn)}", f"{it}  {posed(place, turned)}"))
