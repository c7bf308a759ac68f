# SPDX-License-Identifier: GPL-2.0-only
"""Strips of a sheet that yields, bent all at once, and what they keep."""

import numpy as np
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.features.yielding import bends
from mdanim_lammps.run.prepare import Prepared, prepare
from mdanim_lammps.scene.parse import parse_scene

THICK = 0.5e-3
NU = 1.0 / 3.0
STRIP = """object strip {{ shape sheet ({lx}, {ly}) cm thickness 0.5 mm  position (0, 0, 1) m  resolution 2.5 mm
  density 1000  elasticity 10 MPa  damping {damping}  yield-strain {e} }}
control {{ time 0.1 s }}
"""


def strip(e: float, axis: int, damping: float = 0.1) -> Prepared:
    """A strip of 5 cm by 1.5 cm, along x or y."""
    lx, ly = ((5, 1.5), (1.5, 5))[axis]
    return prepare(parse_scene(STRIP.format(e=e, lx=lx, ly=ly, damping=damping)))


def bent_along(x: np.ndarray, k: float, axis: int) -> np.ndarray:
    """Particles [m] of a sheet that is bent to a curvature [1/m] along an axis, and not across."""
    found = x.copy()
    found[:, axis] = np.sin(k * x[:, axis]) / k
    found[:, 2] = (1.0 - np.cos(k * x[:, axis])) / k
    return found


def plastic(e: float) -> float:
    """The curvature at which an elastic sheet has the moment of a section that yields all through [1/m]."""
    return 1.5 * 2.0 * e / THICK


def kept(ready: Prepared, k: float, axis: int) -> float:
    """The curvature at which a strip that was bent to another one [1/m], and not across, has least energy [1/m]."""
    system, context = ready.system, ready.plan.context
    middle = system.position.mean(0)
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.array("x")[:] = middle + bent_along(system.position - middle, k, axis)
        instance.run(1)
        fields = {name: instance.column(name).copy() for name in ("bent", "grown")}

    def stored(now: float) -> float:
        place = middle + bent_along(system.position - middle, now, axis)
        i, j = system.spring.T
        stretch = np.linalg.norm(place[i] - place[j], axis=1) - system.rest - fields["grown"]
        energy = 0.5 * system.stiffness * stretch**2 - system.preload_energy + system.preload * fields["grown"]
        return float(energy.sum()) + bends.energy(context, 0, place, fields)

    left, step = by_law(k, plastic(context.solids[0].yield_strain), axis), 0.02 * k
    for _ in range(4):
        low, there, high = (stored(left + part * step) for part in (-1.0, 0.0, 1.0))
        left += 0.5 * step * (low - high) / (low - 2.0 * there + high)
    return left


def by_law(k: float, yields: float, axis: int) -> float:
    """The same by the law of lines: along rows one family of them yields, across them two do."""
    return (1.0 - NU**2) * (k - yields) if axis == 0 else k - (1.0 - NU**2) * yields


def by_section(k: float, yields: float, axis: int) -> float:
    """The same of a section that yields from its faces on: its moment is (1 - (k_y/k)^2/3) of what it bears in the end."""
    return by_law(k, yields * (1.0 - (yields / 1.5 / k) ** 2 / 3.0), axis)
