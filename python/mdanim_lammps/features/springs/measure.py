# SPDX-License-Identifier: GPL-2.0-only
"""Quantities of springs that ``expect`` can ask for."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ...effects.measured import Glance, Measured, Of, Recorded
from ...errors import Problem
from ...model.system import System
from ...scene.once import once_for
from ...scene.scene import SceneRecord
from ..rigid.words import Rigid
from ..tearing.gone import gone_of
from ..yielding.bends import energy as energy_of_bends
from ..yielding.grown import grown_of


def kept(system: System, solid: int, gone: np.ndarray | None) -> np.ndarray:
    """Numbers of the springs of a solid without those that are ``gone``, bool, in the order of the solid's springs."""
    own = system.springs_of(solid)
    number = np.arange(own.start, own.stop)
    return number if gone is None else number[~gone]


def largest_strain(system: System, solid: int, position: np.ndarray, gone: np.ndarray | None = None) -> float:
    """Largest |r/r0 - 1| of the springs of a solid [-], for particle positions [m], shape (N, 3); r0 is the length in the body
    without load. Those that are ``gone`` do not count."""
    own = kept(system, solid, gone)
    if not len(own):
        return 0.0
    return float(np.abs(_lengths(system, own, position) / system.unloaded[own] - 1.0).max())


def _lengths(system: System, springs: np.ndarray, position: np.ndarray) -> np.ndarray:
    i, j = system.spring[springs].T
    return np.linalg.norm(position[i] - position[j], axis=1)


def _elastic(g: Glance) -> float:
    system = g.context.system
    gone = gone_of(system, g.solid, g.fields)
    own = kept(system, g.solid, gone)
    grown = grown_of(system, g.solid, g.fields)[~gone]
    stretch = _lengths(system, own, g.position) - system.rest[own] - grown
    energy = 0.5 * system.stiffness[own] * stretch**2 - system.preload_energy[own] + system.preload[own] * grown
    return float(energy.sum()) + energy_of_bends(g.context, g.solid, g.position, g.fields)


def _look(g: Glance) -> float:
    return largest_strain(g.context.system, g.solid, g.position, gone_of(g.context.system, g.solid, g.fields))


def stresses(
    system: System, solid: int, position: np.ndarray, gone: np.ndarray | None = None, grown: np.ndarray | None = None
) -> np.ndarray:
    """Stress of each particle of a solid by its springs [Pa], shape (n, 3, 3): half of sum F r^T over its volume, the virial,
    with the pull F of a spring beyond that in the body without load. Tension is above 0.

    Args:
        position: of all particles [m], shape (N, 3).
        gone: springs that hold no more, in the order of the solid's own; None for none.
        grown: growth of their rest lengths [m], in the same order; None for none.
    """
    first, springs = system.first, system.springs_of(solid)
    own = kept(system, solid, gone)
    i, j = system.spring[own].T
    way = position[j] - position[i]
    length = np.linalg.norm(way, axis=1)
    longer = np.zeros(len(own)) if grown is None else grown[own - springs.start]
    pull = system.stiffness[own] * (length - system.unloaded[own] - longer)
    parts = (0.5 * pull / length)[:, None] * np.stack([way[:, a] * way[:, b] for a, b in PAIRS], axis=1)
    start, count = int(first[solid]), int(first[solid + 1] - first[solid])
    sums = [np.bincount(i - start, part, count) + np.bincount(j - start, part, count) for part in parts.T]
    found = np.empty((count, 3, 3))
    for (a, b), total in zip(PAIRS, sums):
        found[:, a, b] = found[:, b, a] = total / system.volume[start : start + count]
    return found


PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def von_mises(stress: np.ndarray) -> np.ndarray:
    """Size of stresses [Pa], shape (n,), of (n, 3, 3): that of a pull along one axis, 0 under equal pressure from all sides."""
    apart = stress - np.trace(stress, axis1=1, axis2=2)[:, None, None] / 3.0 * np.eye(3)
    return np.sqrt(1.5 * np.einsum("nij,nij->n", apart, apart))


@once_for(lambda g: g)
def _stresses(g: Glance) -> np.ndarray:
    system = g.context.system
    gone, grown = gone_of(system, g.solid, g.fields), grown_of(system, g.solid, g.fields)
    return stresses(system, g.solid, g.position, gone, grown)


def _mean_stress(g: Glance, axis: int) -> float:
    return float(np.average(_stresses(g)[:, axis, axis], weights=g.context.system.volume[g.mine]))


def unmeasured(scene: SceneRecord, asked: Iterable[Of]) -> list[Problem]:
    """A problem for each stress of what is rigid: it does not deform, so nothing tells what is in it."""
    rigid = {solid.name for solid in scene.solids if isinstance(solid.elasticity, Rigid)}
    return [
        Problem(of.span, f"{of.subject} is rigid: its stress is not known", "write its elasticity, as in elasticity 1 MPa")
        for of in asked
        if of.quantity.startswith("stress.") and of.subject in rigid
    ]


MEASURES = {
    ("NAME", "stress.max"): Recorded("stress", lambda g: float(von_mises(_stresses(g)).max()), Measured.largest),
    **{
        ("NAME", f"stress.{letter}"): Recorded(f"stress.{letter}", lambda g, axis=axis: _mean_stress(g, axis))
        for axis, letter in enumerate("xyz")
    },
    ("NAME", "strain.max"): Recorded("strain", _look, Measured.largest),
    ("NAME", "elastic"): Recorded("elastic", _elastic),
}
