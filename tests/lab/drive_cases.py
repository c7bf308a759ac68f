# SPDX-License-Identifier: GPL-2.0-only
"""A plate that shakes: its scene, and the acceleration at which it loses what lies on it. Printed by bench/links.py."""

from __future__ import annotations

import math

import numpy as np
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

G = 9.81
GRAVITY = "gravity (0, 0, -9.81) m/s^2\n"


def plate(drive: str, size: str = "(40, 40, 4) cm", more: str = "") -> str:
    """A plate that is held as a whole and driven."""
    return (
        f"object plate {{ shape box {size} position (0, 0, -2) cm density 1000 elasticity 1 MPa hold all {more}\n  {drive}\n}}\n"
    )


def followed(ready, times, watch) -> list:
    """Results of ``watch(instance)`` at some times [s]."""
    found, dt = [], ready.certificate.timestep
    with Instance(ready.plan) as instance:
        instance.setup()
        for before, time in zip([0.0, *times], times):
            instance.run(round(time / dt) - round(before / dt))
            found.append(watch(instance))
    return found


def stays(factor: float, shape: str, elasticity: str, frequency: float) -> bool:
    """Whether an object presses on a shaking plate at all times; factor: largest acceleration of the plate over g. It is stiff
    beside its weight, so it follows the plate. Both start at the highest point, where it hardly weighs: put down at the lowest
    one it gets twice its weight at once, rings for periods, and an elastic ball then jumps off by 0.5 mm at 3 Hz."""
    amplitude = factor * G / (2 * math.pi * frequency) ** 2
    soft = "elasticity rigid" if elasticity == "rigid" else f"elasticity {elasticity} damping 0.5"
    top = 4 if shape.startswith("sphere") else 3
    thing = f"object it {{ shape {shape} position (0, 0, {top}) cm density 700 {soft} }}\n"
    shaken = plate(f"drive oscillation (0, 0, {amplitude}) m frequency {frequency} Hz phase 90 deg")
    ready = prepare(parse_scene(GRAVITY + shaken + thing + "control { time 1 s contact-damping 1 friction 0.3 }\n"))
    times = np.arange(0.7, 1.2, 0.01) / frequency  # around the next highest point
    fix = "rigid" if elasticity == "rigid" else "contact"
    return min(followed(ready, times, lambda instance: instance.fix_value(fix, "touching"))) > 0


def leaves(shape: str, elasticity: str, frequency: float, within: float = 0.0025) -> tuple[float, float]:
    """Largest acceleration of a plate at which an object leaves it, by halving between 0.9 g and 1.1 g, and g [m/s^2]."""
    low, high = 0.9, 1.1
    if not stays(low, shape, elasticity, frequency) or stays(high, shape, elasticity, frequency):
        return math.nan, G
    while high - low > 2 * within:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if stays(middle, shape, elasticity, frequency) else (low, middle)
    return 0.5 * (low + high) * G, G
