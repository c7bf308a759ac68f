# SPDX-License-Identifier: GPL-2.0-only
"""How balls of few cells turn: ``python bench/turning.py [blow] [slope]``; figures of docs/physics-contact.md.

blow     spin after an oblique blow that slides, over that of a rigid ball, for eight attitudes and directions
slope    acceleration down a slope over 5/7 g sin, for three attitudes
"""

import math
import sys

import numpy as np
from contact_world import World
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
    rows = []
    for under, cells, young in (
        [("ground", 4, e) for e in (3, 30, 100)] + [("held slab", 4, 100)] + [("ground", 8, e) for e in (3, 100)]
    ):
        found = []
        for n, attitude in enumerate(attitudes(8).tolist()):
            way = np.array([math.cos(n), math.sin(n), 0.0])
            more = f"velocity ({ALONG * math.cos(n)!r}, {ALONG * math.sin(n)!r}, {-DOWN})"
            ball = world(young, cells, under, 0.002, attitude, more, "", MU)
            ball.run(0.05)
            rigid = 2.5 * (ALONG - ball.velocity @ way) / RADIUS
            axis = np.array([-way[1], way[0], 0.0])
            spin = ball.spin() / rigid
            found.append([spin @ axis, np.linalg.norm(spin - (spin @ axis) * axis)])
            ball.close()
        share, aside = np.array(found).T
        rows.append([under, cells, young, *(f"{x:.3f}" for x in (share.mean(), share.min(), share.max(), aside.max()))])
    return ["on", "cells across", "elasticity [MPa]", "mean", "least", "most", "about other axes"], rows


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


TABLES = {"blow": blow, "slope": slope}


if __name__ == "__main__":
    print_tables(TABLES, sys.argv[1:])
