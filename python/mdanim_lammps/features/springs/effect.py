# SPDX-License-Identifier: GPL-2.0-only
"""Springs between neighbours in a solid, Wcislo 1999, eq. (3.6), (3.7), and their dashpots where a solid is damped."""

from __future__ import annotations

import numpy as np

from ...bodies import all_held, kind_of
from ...effects.context import Context, Verdict
from ...effects.effect import Effect
from ...model.nearest import blocks
from ..tearing.gone import change_of_energy
from ..yielding.grown import energy_of_growth
from .strength import strength, turning

DASHPOTS = 0.44
"""Part of the time of damped springs that goes to their dashpots (bench/effects.py shares)."""


def time_of_dashpots(context: Context) -> float:
    """Time of dashpots, over the time of all springs without them."""
    own = np.diff(np.searchsorted(context.system.spring[:, 0], context.system.first))
    return DASHPOTS / (1.0 - DASHPOTS) * own[context.damping_ratio > 0.0].sum() / max(1, own.sum())


def block_norm(pair: np.ndarray, weight: np.ndarray, direction: np.ndarray, particles: int) -> np.ndarray:
    """Largest eigenvalue of D_i = sum over i's bonds of w n n^T, for every particle; shape (N,), unit of ``weight``.

    ``pair`` (S, 2), ``weight`` (S,), ``direction`` unit vectors (S, 3). K <= 2 blockdiag(D_i) makes the bound rigorous.
    """
    block = np.empty((particles, 3, 3))
    for a in range(3):
        for b in range(a, 3):
            term = weight * direction[:, a] * direction[:, b]
            total = np.bincount(pair[:, 0], term, particles) + np.bincount(pair[:, 1], term, particles)
            block[:, a, b] = block[:, b, a] = total
    norm = np.empty(particles)
    for start in range(0, particles, 1 << 18):  # eigvalsh copies its input: keep the copy small
        part = slice(start, start + (1 << 18))
        norm[part] = np.linalg.eigvalsh(block[part])[:, -1]
    return norm


class Springs(Effect):
    """Springs between neighbours in a lattice: F = -k (r - r0) along the line of two particles [N], Wcislo 1999, eq. (3.6),
    (3.7).

    Their constants k [N/m] follow from Young's modulus [Pa] and the lattice (docs/physics-solids.md, "Springs"). The share in
    the bound is a_i = 2 lambda_max(D_i)/m_i [1/s^2] with D_i = sum k n n^T over the springs of a particle (docs/physics-
    solids.md, "The bound on the time step").
    """

    styles = (("bond", "mdanim/harmonic"),)
    name = "springs"
    order = 10
    ledger = "elastic"
    binds = True
    if_off = "solids fall apart into loose particles"

    def called_for(self, scene, reach):
        for solid in scene.solids:
            if kind_of(solid).deforms and not all_held(solid):
                return Verdict(self.name, True, f"{solid.name} can move and deform", solid.spans.get("elasticity"))
        free = [solid for solid in scene.solids if not all_held(solid)]
        none = "no object that is free deforms" if free else "every object is held"
        return Verdict(self.name, False, none if scene.solids else "no objects")

    def rate(self, context):
        system = context.system
        if not (preload := np.abs(system.preload)).any():
            return 2.0 * spring_norm(system, system.stiffness) / system.mass
        return 2.0 * (spring_norm(system, system.stiffness) + turned_norm(system, preload / system.unloaded)) / system.mass

    def margins(self, envelope):
        return strength(envelope)

    def notes(self, envelope):
        return turning(envelope)

    def weighed(self, scene, system):
        """Give what springs store that hold each other without load [J]; the energy is told without it."""
        return float(system.preload_energy.sum())

    def energy(self, readings):
        stored = self.weighed(readings.context.scene, readings.system)
        return readings.elastic_energy() - stored + change_of_energy(readings) + energy_of_growth(readings)

    def clocks(self, readings):
        return {"springs": readings.bond_seconds() / (1.0 + time_of_dashpots(readings.context))}


def spring_norm(system, weight: np.ndarray) -> np.ndarray:
    """``block_norm`` of the springs of a system with these weights; shape (N,)."""
    if not len(system.spring):
        return np.zeros(system.particles)
    direction = np.empty((len(system.spring), 3))
    for rows in blocks(len(direction)):
        i, j = system.spring[rows].T
        between = system.position[i] - system.position[j]
        direction[rows] = between / np.linalg.norm(between, axis=1)[:, None]
    return block_norm(system.spring, weight, direction, system.particles)


def turned_norm(system, pull: np.ndarray) -> np.ndarray:
    """Bound on the largest eigenvalue of sum |F|/r (1 - n n^T) over the springs of each particle, which hold each other under
    load where the body has none; shape (N,), from |F|/r of each [N/m], shape (S,)."""
    i, j = system.spring.T
    return np.bincount(i, pull, system.particles) + np.bincount(j, pull, system.particles)


EFFECTS = (Springs(),)
