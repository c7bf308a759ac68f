# SPDX-License-Identifier: GPL-2.0-only
"""Solids with ballast against closed forms, at the defaults of the language: cases of bench/ballast.py and of tests."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from air_cases import made
from mdanim_lammps.engine.instance import Instance

G = 9.81
DOWN = f"gravity (0, 0, -{G}) m/s^2\n"
LEAD = 11400.0


def of_ball(r: float, h: float, own: float, heavy: float) -> tuple[float, float, float]:
    """Mass [kg], height of the centre of mass above the middle [m], and moment of inertia about a level axis through it [kg m^2]
    of a ball whose part below the height h above its middle is heavy."""

    def up_to(z: float, n: int) -> float:
        """Integral of z^n (r^2 - z^2)."""
        return r**2 * z ** (n + 1) / (n + 1) - z ** (n + 3) / (n + 3)

    def fourth(z: float) -> float:
        """Integral of (r^2 - z^2)^2."""
        return r**4 * z - 2.0 * r**2 * z**3 / 3.0 + z**5 / 5.0

    volume, first, second = (math.pi * (up_to(h, n) - up_to(-r, n)) for n in range(3))
    disc = math.pi * (fourth(h) - fourth(-r)) / 4.0
    ball = 4.0 / 3.0 * math.pi * r**3
    mass = own * ball + (heavy - own) * volume
    z = (heavy - own) * first / mass
    return mass, z, 0.4 * own * ball * r**2 + (heavy - own) * (second + disc) - mass * z**2


def rocks(r: float, elasticity: str, own: float, heavy: float, h: float = 0.0) -> tuple[float, float]:
    """Period of a ball on the ground, heavy below [s]: 2 pi sqrt((I + m (r - d)^2)/(m g d)), d its centre below its middle, for
    angles of 0.05, which take 0.02 % longer."""
    mass, z, moment = of_ball(r, h * r, own, heavy)
    d = -z
    expected = 2.0 * math.pi * math.sqrt((moment + mass * (r - d) ** 2) / (mass * G * d))
    way = 2.0 * r
    words = f"""
  shape sphere {r} m  position (0, 0, {r}) m  density {own}  elasticity {elasticity}  friction 0.9
  spin (0, {0.05 * 2.0 * math.pi / expected!r}, 0) rad/s  velocity ({0.05 * 2.0 * math.pi / expected * (r - d)!r}, 0, 0) m/s
  ballast {heavy} kg/m^3 within box ({-way}, {-way}, {-way}) m to ({way}, {way}, {r + h * r}) m
"""
    text = f"{DOWN}ground z 0 m\nobject ball {{ {words} }}\n"
    ready = made(text, 2.0 * expected)
    turning = []
    steps = max(1, round(expected / 200.0 / ready.certificate.timestep))
    with Instance(ready.plan) as instance:
        instance.setup()
        for _ in range(330):
            instance.run(steps)
            x, v = instance.array("x"), instance.array("v")
            own_mass = ready.system.mass
            centre = own_mass @ x / own_mass.sum()
            spin = np.cross(x - centre, v - own_mass @ v / own_mass.sum())
            turning.append(own_mass @ spin[:, 1])
    turning = np.array(turning)
    where = np.flatnonzero(np.diff(np.sign(turning)))
    at = where + turning[where] / (turning[where] - turning[where + 1])
    return float(2.0 * np.diff(at).mean() * steps * ready.certificate.timestep), expected


CASES: dict[str, tuple[Callable[[], tuple[float, float]], float]] = {
    "ball rocks, rigid, 10 cm, pine and lead below a quarter": (lambda: rocks(0.1, "rigid", 500.0, LEAD, -0.5), 0.005),
    "ball rocks, rigid, 2 cm, lower half twice as dense": (lambda: rocks(0.02, "rigid", 1000.0, 2000.0), 0.005),
}  # fmt: skip
"""Cases by name, and by how much each may be off."""
