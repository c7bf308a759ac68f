# SPDX-License-Identifier: GPL-2.0-only
"""Inflated sheets against closed forms, at the defaults of the language: cases of bench/inflate.py and of tests."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from air_cases import made
from bag_lab import FACES
from mdanim_lammps.engine.instance import Instance
from scipy.optimize import brentq

NU, OUTSIDE = 1.0 / 3.0, 101325.0
"""Poisson's ratio of sheets, and the pressure outside [Pa]."""


def volumes(text: str, time: float, looks: int) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] and volumes of the first object [m^3], from 0 on, each of shape (looks + 1,)."""
    ready = made(text, time)
    steps = max(1, round(time / looks / ready.certificate.timestep))
    found = []
    with Instance(ready.plan) as instance:
        instance.setup()
        found.append(instance.fix_rows("inflate", 1, 2)[0, 0])
        for _ in range(looks):
            instance.run(steps)
            found.append(instance.fix_rows("inflate", 1, 2)[0, 0])
    return np.arange(looks + 1) * steps * ready.certificate.timestep, np.array(found)


def ball(r: float, t: float, young: float, rho: float, p: float, outside: float, damping: float) -> str:
    """A ball that floats in space."""
    return (
        f"object ball {{ shape sphere {r} m sheet thickness {t} m  position (0, 0, 0) m  density {rho} kg/m^3"
        f"  elasticity {young} Pa  damping {damping}  inflate {p} Pa outside {outside} Pa }}\n"
    )


def swells(r: float, t: float, young: float, p: float, outside: float = OUTSIDE) -> tuple[float, float]:
    """By how much the radius of a ball grows, over the radius [-]: springs of a length s l0 pull with E t (s - 1)/(1 - nu) for
    each l0 across, so p = 2 E t (s - 1)/((1 - nu) s^2 r); p r (1 - nu)/2 E t where it is small."""
    rho = 1000.0
    stiff = 2.0 * young * t / ((1.0 - NU) * r)
    s = brentq(lambda s: stiff * (s - 1.0) / s**2 - (p + outside) / s**3 + outside, 1.0, 1.9)
    beat = 2.0 * math.pi / math.sqrt(stiff / (rho * t * r))
    _, found = volumes(ball(r, t, young, rho, p, outside, 0.5), 12.0 * beat, 24)
    return (found[-1] / found[0]) ** (1.0 / 3.0) - 1.0, s - 1.0


def breathes(r: float, t: float, young: float, outside: float = OUTSIDE) -> tuple[float, float]:
    """Period in which a ball swells and shrinks, by a small pressure [s]: of its mass with the stiffness 12 pi (p0 + p) r of the
    gas, and 8 pi E t/(1 - nu) of the sheet."""
    rho = 1000.0
    p = 1e-3 * 2.0 * young * t / ((1.0 - NU) * r)
    gas, sheet = 12.0 * math.pi * (outside + p) * r, 8.0 * math.pi * young * t / (1.0 - NU)
    expected = 2.0 * math.pi * math.sqrt(4.0 * math.pi * r**2 * rho * t / (gas + sheet))
    time, found = volumes(ball(r, t, young, rho, p, outside, 0.0), 3.0 * expected, 600)
    swings = found - found.mean()
    up = np.flatnonzero((swings[:-1] < 0) & (swings[1:] >= 0))
    at = time[up] - swings[up] * (time[up + 1] - time[up]) / (swings[up + 1] - swings[up])
    return float(np.diff(at).mean()), expected


def open_box() -> str:
    """The text of an STL file: a box of 20 cm without a lid."""
    corner = 0.2 * np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)])
    lines = ["solid bag"]
    for face in FACES[:2] + FACES[4:]:
        lines += ["facet normal 0 0 0", "outer loop", *(f"vertex {x} {y} {z}" for x, y, z in corner[list(face)])]
        lines += ["endloop", "endfacet"]
    return "\n".join([*lines, "endsolid bag"])


CASES: dict[str, tuple[Callable[[], tuple[float, float]], float]] = {
    "ball swells, 20 cm, 1 mm of 3 MPa, 1 kPa": (lambda: swells(0.2, 1e-3, 3e6, 1e3), 0.02),
    "ball swells, 5 cm, 0.5 mm of 2 MPa, 10 kPa": (lambda: swells(0.05, 5e-4, 2e6, 1e4), 0.02),
    "ball swells, 1 m, 2 mm of 20 MPa, nothing outside": (lambda: swells(1.0, 2e-3, 2e7, 5e3, 0.0), 0.02),
    "ball breathes, 20 cm, 1 mm of 3 MPa": (lambda: breathes(0.2, 1e-3, 3e6), 0.02),
    "ball breathes, 10 cm, 1 mm of 30 MPa, nothing outside": (lambda: breathes(0.1, 1e-3, 3e7, 0.0), 0.02),
}  # fmt: skip
"""Cases by name, and by how much each may be off."""
