# SPDX-License-Identifier: GPL-2.0-only
"""Energies of solids that hang in a liquid, and of the liquid itself, below which no account of a run is kept."""

from __future__ import annotations

import numpy as np

from ...model.system import System
from ...scene.scene import SceneRecord
from ..drives.motion import ways

UNEVEN = 200.0
"""Times `load_energy`: a vibration has up to 4 times that, and the account of the highest ones, at half of the bound, is off by
5 % of them; a class of accuracy is 0.001."""
IN_BALANCE = 0.02
"""Part by which the densities of a solid and of the liquid may differ: at 1 % already it sinks or rises with energies that have
an account."""


def full_basin(scene: SceneRecord) -> float:
    """Weight of a full basin times its height over the origin, at most [J]."""
    low, high = np.array(scene.liquid.low), np.array(scene.liquid.high)
    heights = np.abs(scene.gravity) * np.maximum(np.abs(low), np.abs(high))
    return scene.liquid.density * float(np.prod(high - low) * heights.sum())


def load_energy(scene: SceneRecord, system: System) -> np.ndarray:
    """Energy that weight and lift strain each solid by that hangs in the liquid, about: sum f_i^2 / (2 E h) [J], shape (M,).

    Weight acts on the fitted masses of particles, lift on their volumes by cells: f_i = g (m_i - rho V_i). A solid as dense as
    the liquid rests as a whole and vibrates by it; others sink, lie or float, with energies that are far larger: 0 for them.
    """
    hangs = np.abs(scene.liquid.density - system.density) <= IN_BALANCE * system.density
    load = np.linalg.norm(scene.gravity) * (system.mass - system.density[system.object] * system.volume)
    of_particles = np.where(system.held, 0.0, 0.5 * load**2 / (system.young * system.spacing)[system.object])
    return np.where(hangs, np.add.reduceat(of_particles, system.first[:-1]), 0.0)


def starting_energy(scene: SceneRecord, system: System) -> float:
    """Energy of motion of all driven objects and as much liquid, at most [J].

    Where an object is driven off, the accounts of the liquid and of the drive share the first step in different ways, by a part
    of this energy for one step; beside a liquid at rest nothing else may be in play.
    """
    mass = system.mass_of + scene.liquid.density * np.add.reduceat(system.volume, system.first[:-1])
    return 0.5 * sum(float(mass[m]) * way.speed**2 for m, way in ways(scene).items())
