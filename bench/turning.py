# SPDX-License-Identifier: GPL-2.0-only
"""How balls of few cells turn: ``python bench/turning.py [blow] [balls] [slope] [damping]``; figures of docs/physics-contact.md.

blow     spin after an oblique blow that slides, over that of a rigid ball, for eight attitudes and directions
balls    the same on a held ball
slope    acceleration down a slope over 5/7 g sin, for three attitudes
damping  the part that contact-damping takes of rolling and bouncing, and motion that is left at rest
"""

import math
import sys

import numpy as np
from contact_world import World, inertia
from timing import print_tables

G = 9.81
RADIUS = 0.1
"""Radius of the ball [m]."""
MU, ALONG, DOWN = 0.2, 2.0, 0.5
"""Friction of a blow, speed along the ground and towards it [m/s]."""
SLOPE, ROUGH = math.radians(15.0), 0.6
UNDER = {
    "ground": "ground z 0",
    "held slab": "object slab {{ shape box (200, 200, 10) cm  position (0, 0, -5) cm  density 1000 elasticity {} MPa hold all }}",
    "held ball": "object lower {{ shape sphere 10 cm  position (0, 0, -10) cm  density 1000  elasticity {} MPa hold all }}",
}


def world(young: float, cells: int, under: str, gap: float, attitude, more: str, gravity: str, friction: float) -> World:
    """A ball over something, turned by angles [deg]."""
    angles = ", ".join(f"{a!r}" for a in attitude)
    return World(
        f"{gravity}\n{UNDER[under].format(young)}\n"
        f"object ball {{ shape sphere 10 cm  position (0, 0, {100 * (RADIUS + gap)}) cm\n"
        f"orientation euler ({angles}) deg  density 1000  elasticity {young} MPa  {more} }}",
        f"resolution {200 * RADIUS / cells} cm  friction {friction}",
    )


def attitudes(n: int) -> np.ndarray:
    """The first is that of a ball as it is written, shape (n, 3) [deg]."""
    found = np.random.default_rng(1).uniform(0.0, 360.0, (n, 3)).round(1)
    found[0] = 0.0
    return found


def blow() -> tuple[list[str], list[list]]:
    """Spin after a blow that slides over that of a rigid ball with the same impulses, and what of it is about other axes."""
    return BLOWS, [
        blows(under, cells, young)
        for under, cells, young in [("ground", 4, e) for e in (3, 30, 100)]
        + [("held slab", 4, 100)]
        + [("ground", 8, e) for e in (3, 100)]
    ]


def balls() -> tuple[list[str], list[list]]:
    """Spin after a blow that slides on a held ball, as in `blow`."""
    return BLOWS, [blows("held ball", cells, young) for cells in (4, 8) for young in (3, 100)]


BLOWS = ["on", "cells across", "elasticity [MPa]", "mean", "least", "most", "about other axes"]


def blows(under: str, cells: int, young: float) -> list:
    """A row of BLOWS."""
    found = []
    for n, attitude in enumerate(attitudes(8).tolist()):
        way = np.array([math.cos(n), math.sin(n), 0.0])
        more = f"velocity ({ALONG * math.cos(n)!r}, {ALONG * math.sin(n)!r}, {-DOWN})"
        ball = world(young, cells, under, 0.002, attitude, more, "", MU)
        if under == "held ball":
            rigid, axis = spin_on_ball(ball)
        else:
            ball.run(0.05)
            rigid, axis = 2.5 * (ALONG - ball.velocity @ way) / RADIUS, np.array([-way[1], way[0], 0.0])
        spin = ball.spin() / rigid
        found.append([spin @ axis, np.linalg.norm(spin - (spin @ axis) * axis)])
        ball.close()
    share, aside = np.array(found).T
    return [under, cells, young, *(f"{x:.3f}" for x in (share.mean(), share.min(), share.max(), aside.max()))]


def spin_on_ball(ball: World) -> tuple[float, np.ndarray]:
    """The spin that the impulses of a blow on a held ball give a rigid ball, and its axis: each impulse acts where the line of
    centres is in its time."""
    middle, spin = np.array([0.0, 0.0, -RADIUS]), np.zeros(3)
    for _ in range(200):
        before, there = ball.velocity, ball.place
        ball.run(0.05 / 200)
        line = 0.5 * (there + ball.place) - middle
        spin -= np.cross(line / np.linalg.norm(line), ball.velocity - before) / (0.4 * RADIUS)
    size = float(np.linalg.norm(spin))
    return size, spin / size


def slope() -> tuple[list[str], list[list]]:
    """Acceleration of a ball down a slope of 15 degrees, mu 0.6, from 0.2 to 0.6 s, over 5/7 g sin."""
    rows = []
    gravity = f"gravity ({G * math.sin(SLOPE)!r}, 0, {-G * math.cos(SLOPE)!r})"
    for cells, young in ((4, 3), (4, 30), (8, 3)):
        found = []
        for attitude in attitudes(3).tolist():
            ball = world(young, cells, "ground", 0.0, attitude, "damping 0.1", gravity, ROUGH)
            ball.run(0.2)
            before = ball.velocity[0]
            ball.run(0.4)
            found.append((ball.velocity[0] - before) / 0.4 / (5 / 7 * G * math.sin(SLOPE)))
            ball.close()
        rows.append([cells, young, " ".join(f"{x:.3f}" for x in found)])
    return ["cells across", "elasticity [MPa]", "three attitudes"], rows


def damping() -> tuple[list[str], list[list]]:
    """The part that contact-damping takes: acceleration of a rolling body over that of a rigid one, speed after a blow over that
    before, and speed a second after objects without damping were put down (root of the mean square, mean of three places)."""
    rows = []
    for beta in (0.3, 0.1, 0.03, 0.0):
        control = f"contact-damping {beta}"
        row = [f"{rolls(shape, young, control):.3f}" for shape in ROUND for young in (3, 30)]
        row += [f"{bounce(shape, control):.3f}" for shape in (CUBE, ROUND["ball"])]
        rows.append([beta, *row, *(f"{at_rest(shape, control):.0e}" for shape in (CUBE, ROUND["ball"]))])
    titles = [f"{shape} rolls, {young} MPa" for shape in ROUND for young in (3, 30)]
    return ["contact-damping", *titles, "cube bounces", "ball", "cube at rest [m/s]", "ball"], rows


CUBE = "shape box (20, 20, 20) cm"
ROUND = {"ball": "shape sphere 10 cm", "cylinder": "shape cylinder 10 cm 20 cm  orientation axis (1, 0, 0) angle 90 deg"}


def put(shape: str, place, young: float, more: str, control: str, gravity: str = "") -> World:
    """An object of four cells over the ground; its place is in cm."""
    return World(
        f"{gravity}\nground z 0\nobject c {{ {shape}  position {place} cm  density 1000  elasticity {young} MPa  {more} }}",
        f"resolution 5 cm  friction {ROUGH}  {control}",
    )


def rolls(name: str, young: float, control: str) -> float:
    """Acceleration down the slope from 0.2 to 0.6 s over that of a rigid body with the moment of inertia of its particles."""
    gravity = f"gravity ({G * math.sin(SLOPE)!r}, 0, {-G * math.cos(SLOPE)!r})"
    body = put(ROUND[name], (0.1, 0.07, 10), young, "damping 0.1", control, gravity)
    arm = body.instance.array("x")[body.mine] - body.place
    share = inertia(body.mass, arm)[1, 1] / (body.mass.sum() * RADIUS**2)
    body.run(0.2)
    before = body.velocity[0]
    body.run(0.4)
    gained = (body.velocity[0] - before) / 0.4
    body.close()
    return gained / (G * math.sin(SLOPE) / (1.0 + share))


def bounce(shape: str, control: str) -> float:
    """Speed of the centre after a blow of 0.5 m/s, flat on the ground, over that before; 1 MPa, no other damping."""
    body = put(shape, (0.003, 0.002, 10.1), 1, f"velocity (0, 0, {-DOWN})", control)
    while body.velocity[2] <= 0.0 or body.place[2] < 0.1012:
        body.run(0.002)
    left = body.velocity[2] / DOWN
    body.close()
    return left


def at_rest(shape: str, control: str) -> float:
    """Root mean square velocity of an object of 1 MPa without damping, a second after it was put down [m/s]."""
    found = []
    for x, y in ((0.003, 0.002), (0.7, 0.4), (1.3, 1.9)):
        body = put(
            f"{shape}  orientation axis (0, 0, 1) angle {20.0 * x!r} deg", (x, y, 10), 1, "", control, f"gravity (0, 0, {-G})"
        )
        body.run(1.0)
        v = body.instance.array("v")[body.mine]
        found.append(math.sqrt(float(body.mass @ (v**2).sum(1)) / body.mass.sum()))
        body.close()
    return float(np.mean(found))


TABLES = {"blow": blow, "balls": balls, "slope": slope, "damping": damping}


if __name__ == "__main__":
    print_tables(TABLES, sys.argv[1:])
