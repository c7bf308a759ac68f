# SPDX-License-Identifier: GPL-2.0-only
"""What LAMMPS is told: the one record from which both data and input files and live instances are made."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from ..certificate import Certificate
from ..effects import EFFECTS, Effect, Verdict
from ..model.basin import Grid
from ..model.system import System
from ..scene.scene import Scene

HELD = 4
"""Atom types 1-4 are the layers of free particles (model.Layer), 5-8 those of held ones."""


@dataclass(frozen=True)
class Plan:
    """A scene in LAMMPS's terms: types, columns, bond types and the effects that are on."""

    scene: Scene
    system: System
    certificate: Certificate
    effects: tuple[Effect, ...]
    """Those that are on, in the order in which their forces are summed."""
    kind: np.ndarray
    """Atom type of each particle, int32, shape (N,)."""
    columns: dict[str, np.ndarray]
    """Per-particle properties ``d_NAME`` that some effect asks for, each of shape (N,)."""
    tables: dict[str, np.ndarray]
    """Per-particle whole numbers ``i2_NAME`` that some effect asks for, int32, each of shape (N, K)."""
    bonds: np.ndarray
    """Springs as 0-based pairs i < j, int32, shape (S, 2)."""
    bond_kind: np.ndarray
    """Bond type of each spring, from 1, int32, shape (S,)."""
    coefficients: np.ndarray
    """k [N/m], r0 [m], dashpot [N*s/m] of each bond type, shape (T, 3)."""

    @property
    def name(self) -> str:
        """The scene's name as it may stand in a LAMMPS file name."""
        return re.sub(r"[^\w.+-]", "_", self.scene.name, flags=re.ASCII)

    @property
    def grid(self) -> Grid | None:
        """Cells of the liquid; None where there is none, or it is switched off."""
        return self.system.grid if any(e.name == "liquid" for e in self.effects) else None

    @property
    def damped(self) -> bool:
        """Whether any bond type has a dashpot."""
        return bool(self.coefficients[:, 2].any())


def make_plan(scene: Scene, system: System, verdicts: dict[str, Verdict], certificate: Certificate) -> Plan:
    """Gather what the effects that are on ask for."""
    effects = tuple(e for e in EFFECTS if verdicts[e.name].on)
    names = {e.name for e in effects}
    columns: dict[str, np.ndarray] = {}
    tables: dict[str, np.ndarray] = {}
    for effect in effects:
        columns.update(effect.columns(scene, system))
        tables.update(effect.tables(scene, system))
    if "springs" in names:
        dashpot = system.damping if "damping" in names else None
        bonds, kind, coefficients = system.spring, *bond_kinds(system.stiffness, system.rest, dashpot)
    else:
        bonds, kind, coefficients = system.spring[:0], np.zeros(0, np.int32), np.zeros((0, 3))
    return Plan(
        scene=scene, system=system, certificate=certificate, effects=effects,
        kind=(system.layer + HELD * system.held).astype(np.int32),
        columns=columns, tables=tables, bonds=bonds, bond_kind=kind, coefficients=coefficients,
    )


def bond_kinds(stiffness: np.ndarray, rest: np.ndarray, dashpot: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
    """Bond type of each spring (from 1, int32, shape (S,)) and the coefficients of each type, shape (T, 3).

    Springs are of one type when all bits of their coefficients agree; types are numbered by first appearance, so that they
    do not depend on a sort of floating-point numbers.
    """
    table = np.zeros((len(stiffness), 3))
    table[:, 0], table[:, 1] = stiffness, rest
    if dashpot is not None:
        table[:, 2] = dashpot
    # A mixed key per row is enough to find equal rows quickly; equality itself is checked on all bits below.
    bits = table.view(np.uint64)
    with np.errstate(over="ignore"):
        key = (bits[:, 0] * np.uint64(0x9E3779B97F4A7C15)) ^ (bits[:, 1] * np.uint64(0xC2B2AE3D27D4EB4F))
        key = (key ^ (key >> np.uint64(29))) + bits[:, 2] * np.uint64(0x165667B19E3779F9)
    _, first, inverse = np.unique(key, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty(len(order), np.int32)
    rank[order] = np.arange(1, len(order) + 1)
    kind, coefficients = rank[inverse.reshape(-1)], table[first[order]]
    if not np.array_equal(coefficients[kind - 1], table):  # two different rows with one key
        coefficients, inverse = np.unique(table, axis=0, return_inverse=True)
        kind = inverse.reshape(-1).astype(np.int32) + 1
    return kind, coefficients
