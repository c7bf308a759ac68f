# SPDX-License-Identifier: GPL-2.0-only
"""Random scenes in which rigid, held and elastic objects of all shapes fall, meet, pile up and float."""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np
from scipy.spatial import ConvexHull

CELL = 0.24
"""Distance of objects at the start [m]; the ball around each is smaller."""
KINDS = ("fall", "fall", "fall", "bin", "stack", "space", "space", "pool")
"""Kinds of scenes, by turns: onto the ground; into a bin; stacks that are struck; without gravity; into a liquid."""


def scene(seed: int, folder: Path) -> tuple[str, str]:
    """Kind and text of a scene; meshes go into the folder."""
    chance, kind = random.Random(seed), KINDS[seed % len(KINDS)]
    text = {"space": _space, "stack": _stack, "pool": _pool}.get(kind, _fall)(chance, folder, kind)
    friction = chance.choice(("", "friction 0.2", "friction 0.5", "friction 1"))
    restitution = chance.choice(("", "", "restitution 0.3", "restitution 0.8"))
    return kind, f"{text}control {{ time 0.4 s  frames 50 fps  seed {seed}  {friction}  {restitution} }}\n"


def _fall(chance: random.Random, folder: Path, kind: str) -> str:
    """Objects on a grid above the ground, in two or three layers; some of the lowest are held."""
    text = "gravity (0, 0, -9.81) m/s^2\nground z 0 m\n"
    if kind == "bin":
        text += f"walls from (-{CELL}, -{CELL}, -1) m to ({CELL}, {CELL}, 9) m\n"
    places = [(i, j, k) for k in range(3) for i in (-0.5, 0.5) for j in (-0.5, 0.5)]
    for n, (i, j, k) in enumerate(places[: chance.randint(3, len(places))]):
        state = "held" if k == 0 and chance.random() < 0.2 else "soft" if chance.random() < 0.1 else "rigid"
        text += _object(chance, folder, n, (i * CELL, j * CELL, (0.6 + k) * CELL), state, speed=1.0)
    return text


def _stack(chance: random.Random, folder: Path, kind: str) -> str:
    """Boxes on each other, each turned a little, and one that comes."""
    text, height = "gravity (0, 0, -9.81) m/s^2\nground z 0 m\n", 0.0
    for n in range(chance.randint(2, 7)):
        size = [chance.uniform(0.08, 0.14) for _ in range(3)]
        at = (chance.uniform(-0.01, 0.01), chance.uniform(-0.01, 0.01), height + size[2] / 2)
        turn = f"axis (0, 0, 1) angle {chance.uniform(-20, 20):.0f} deg"
        text += _words(n, f"box {_vector(size)} m", at, turn, "rigid", chance.choice((300, 900, 2700)), (0, 0, 0), (0, 0, 0))
        height += round(size[2], 6)
    speed = chance.uniform(1.0, 4.0)
    return text + _object(chance, folder, 99, (-0.5, 0.0, chance.uniform(0.15, height + 0.1)), "rigid", (speed, 0.0, 0.5))


def _space(chance: random.Random, folder: Path, kind: str) -> str:
    """Two to five objects that fly at each other."""
    text, count = "", chance.randint(2, 5)
    for n in range(count):
        way = np.array([chance.gauss(0, 1) for _ in range(3)])
        way[0] = (1 if n % 2 else -1) * (0.3 + abs(way[0]))
        at = (0.2 if n % 2 else -0.2, (n // 2 - 0.5) * CELL, chance.uniform(-0.02, 0.02))
        speed = -np.sign(at[0]) * chance.uniform(0.5, 2.0)
        state = "soft" if n == 4 else "rigid"
        text += _object(chance, folder, n, at, state, (speed, 0.1 * way[1], 0.1 * way[2]), spin=8.0)
    return text


def _pool(chance: random.Random, folder: Path, kind: str) -> str:
    """Two boxes or balls that fall into a liquid; shapes that touch its basin at points would take too many steps."""
    text = "gravity (0, 0, -9.81) m/s^2\n"
    text += "liquid water { basin from (-0.3, -0.3, 0) m to (0.3, 0.3, 0.8) m  density 1000 kg/m^3  level 0.2 m }\n"
    for n in range(2):
        at, state = ((n - 0.5) * CELL, 0.0, 0.36), "soft" if n and chance.random() < 0.5 else "rigid"
        text += _object(chance, folder, n, at, state, shapes=("box", "sphere"), speed=0.3)
    return text


SHAPES = ("box", "box", "sphere", "cylinder", "cone", "ellipsoid", "torus", "mesh")


def _object(chance, folder, n, at, state, velocity=None, *, shapes=SHAPES, speed=0.0, spin=5.0) -> str:
    """An object of a random shape, size and attitude that fits into a cell."""
    big = chance.uniform(0.05, 0.105)
    form = chance.choice(shapes)
    if state == "soft" and form == "mesh":
        form = "box"
    match form:
        case "box":
            size = np.array([chance.uniform(0.4, 1.0) for _ in range(3)])
            words = f"box {_vector(2.0 * big * size / np.linalg.norm(size))} m"
        case "sphere":
            words = f"sphere {big:.4f} m"
        case "cylinder" | "cone":
            lean = chance.uniform(0.5, 1.1)
            high = {"cylinder": 2.0, "cone": 1.2}[form] * big * np.cos(lean)
            words = f"{form} {big * np.sin(lean):.4f} m {high:.4f} m"
        case "ellipsoid":
            words = f"ellipsoid {_vector([big * chance.uniform(0.5, 1.0) for _ in range(3)])} m"
        case "torus":
            words = f"torus {0.68 * big:.4f} m {0.3 * big:.4f} m"
        case "mesh":
            words = f'mesh "{_mesh(chance, folder, n, big)}"'
    axis = _vector([chance.gauss(0, 1) for _ in range(3)])
    turn = f"axis {axis} angle {chance.uniform(0, 180):.1f} deg"
    velocity = [chance.uniform(-speed, speed) for _ in range(3)] if velocity is None else velocity
    turns = [chance.uniform(-spin, spin) for _ in range(3)]
    return _words(n, words, at, turn, state, chance.choice((300, 900, 2700)), velocity, turns)


def _words(n, shape, at, turn, state, density, velocity, spin) -> str:
    hold = state == "held"
    moves = "" if hold else f"velocity {_vector(velocity)} m/s  spin {_vector(spin)} rad/s"
    stuff = "elasticity 1 MPa  damping 0.1" if state == "soft" else "elasticity rigid"
    return (
        f"object o{n} {{ shape {shape}  position {_vector(at)} m  orientation {turn}\n"
        f"  density {density} kg/m^3  {stuff}  {'hold all' if hold else moves} }}\n"
    )


def _mesh(chance, folder: Path, n: int, big: float) -> str:
    """A file with the hull of eight to sixteen points in a ball."""
    points = np.array([[chance.gauss(0, 1) for _ in range(3)] for _ in range(chance.randint(8, 16))])
    points *= 0.95 * big / np.linalg.norm(points, axis=1).max()
    hull = ConvexHull(points)
    middle = points.mean(axis=0)
    lines = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in points]
    for a, b, c in hull.simplices.tolist():
        out = np.cross(points[b] - points[a], points[c] - points[a]) @ (points[a] - middle) > 0.0
        lines.append("f " + " ".join(str(k + 1) for k in ((a, b, c) if out else (a, c, b))))
    (folder / f"hull{n}.obj").write_text("\n".join(lines) + "\n")
    return f"hull{n}.obj"


def _vector(numbers) -> str:
    return "(" + ", ".join(f"{x:.6f}" for x in numbers) + ")"
