# SPDX-License-Identifier: GPL-2.0-only
"""The plan for LAMMPS: the one record from which both data and input files and live instances are made."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..certificate import Certificate, strong_drag
from ..effects import Context, Effect
from ..effects.fields import Field, column
from ..model.contact_body import ContactBody
from ..model.grid import Grid
from ..model.springs import types
from ..model.system import System
from ..records import dataclass
from ..scene.scene import SceneRecord
from .columns import Places, most_bonds, places

HELD = 4
"""Atom types 1-4 are the layers of free particles (model.Layer), 5-8 those of particles that are held at the start."""


BODY = "body"
"""Column of the kinds of particles' bodies, model.system.System.contact_kind."""


DRIVEN = "driven"
"""Column of held particles that are driven: 1, others 0; only where there are some."""


class Ends(NamedTuple):
    """Springs as LAMMPS stores them with ``newton off``: at both ends, partners ascending."""

    first: np.ndarray
    """First entry of each particle, and 2 S at the end, int64, shape (N + 1,)."""
    partner: np.ndarray
    """Tags (from 1), int32, shape (2 S,)."""
    kind: np.ndarray
    """Bond types (from 1), int32, shape (2 S,)."""


@dataclass(frozen=True)
class Plan:
    """A scene in LAMMPS's terms: types, columns, bond types and the effects that are on.

    What depends on the scene as a whole is a field of its own, so that part.py can make a plan of some of the objects.
    """

    context: Context
    certificate: Certificate
    effects: tuple[Effect, ...]
    """Effects that are on, in the order in which their forces are summed."""
    columns: dict[str, np.ndarray]
    """Columns that some effect asks for, by name: values at the start of all particles, springs or objects, each of shape
    (N, ...), (S, ...) or (M, ...)."""
    fields: dict[str, Field]
    """The declarations of these columns."""
    slots: int
    """Springs that a column of springs has room for at each particle."""
    bonds: np.ndarray
    """Springs as 0-based pairs i < j, int32, shape (S, 2)."""
    bond_kind: np.ndarray
    """Bond type of each spring, from 1, unsigned integers, shape (S,)."""
    coefficients: np.ndarray
    """k [N/m], r0 [m], dashpot [N*s/m] of each bond type, shape (T, 3)."""
    asked: dict[str, tuple[str, ...]]
    """Columns that each effect asks for, by its name."""
    spacing: float
    """Longest cell edge of all solids of the scene [m]; skin and cutoffs follow from it."""
    exponential: bool
    """Whether drag is taken exponentially, certificate.strong_drag."""

    @property
    def scene(self) -> SceneRecord:
        return self.context.scene

    @property
    def system(self) -> System:
        """The solids as particles."""
        return self.context.system

    @property
    def grid(self) -> Grid | None:
        """Cells of the liquid; None where there is none, or it is switched off."""
        return self.context.grid

    @property
    def kind(self) -> np.ndarray:
        """Atom type of each particle, int32, shape (N,)."""
        return (self.system.layer + HELD * (self.system.held | self.system.pinned)).astype(np.int32)

    def ends(self) -> Ends:
        """The springs at both ends."""
        return both_ends(self.bonds, self.bond_kind, self.system.particles)

    @cached_property
    def places(self) -> Places:
        """Where both ends of each spring have its values."""
        return places(self.bonds, self.system.particles)

    @property
    def states(self) -> tuple[str, ...]:
        """Columns that are part of the state."""
        return tuple(name for name, field in self.fields.items() if field.state)

    def rows(self, per: str) -> np.ndarray:
        """First row of each object in an array of all particles, springs (``bond``) or objects, and behind the last, shape
        (M + 1,)."""
        objects = np.arange(len(self.system.names) + 1)
        if per == "bond":
            return np.searchsorted(self.system.object[self.bonds[:, 0]], objects)
        return self.system.first if per == "particle" else objects

    @property
    def name(self) -> str:
        """The scene's name as it may stand in a LAMMPS file name."""
        return re.sub(r"[^\w.+-]", "_", self.scene.name, flags=re.ASCII)

    @property
    def body_fixes(self) -> tuple[str, ...]:
        """IDs of the fixes that look up the undeformed bodies: those of effects that ask for the column ``body``."""
        return tuple(e.fix for e in self.effects if BODY in self.asked[e.name])

    @property
    def contact_bodies(self) -> dict[int, ContactBody]:
        """The bodies that `body_fixes` are given, by kind, ascending; without such fixes none, and none is made."""
        return self.system.contact_bodies if self.body_fixes else {}

    @cached_property
    def tables(self) -> dict[str, str]:
        """Texts of files that commands read, by name."""
        return {name: text for e in self.effects for name, text in e.tables(self.context).items()}

    @property
    def damped(self) -> bool:
        """Whether any bond type has a dashpot."""
        return bool(self.coefficients[:, 2].any())


def make_plan(context: Context, certificate: Certificate) -> Plan:
    """Gather what the effects that are on ask for."""
    system, effects = context.system, context.resolved.effects
    if any(e.binds for e in effects):
        bonds, (kind, coefficients) = system.spring, _bond_types(context)
    else:
        bonds, kind, coefficients = system.spring[:0], np.zeros(0, np.uint8), np.zeros((0, 3))
    columns, fields, asked = _columns(context, {"particle": system.particles, "bond": len(bonds), "object": len(system.names)})
    return Plan(
        context=context,
        certificate=certificate,
        effects=effects,
        columns={name: columns[name] for name in fields},
        fields=fields,
        slots=most_bonds(bonds) if any(field.per == "bond" for field in fields.values()) else 0,
        bonds=bonds,
        bond_kind=kind,
        coefficients=coefficients,
        asked=asked,
        spacing=float(max(system.spacing, default=context.spacing.h)),
        exponential=bool(strong_drag(context, certificate.timestep)),
    )


def _bond_types(context: Context) -> tuple[np.ndarray, np.ndarray]:
    """Type of each spring (from 1, shape (S,)) and k [N/m], r0 [m], dashpot [N*s/m] of each type, shape (T, 3), in the order in
    which they appear."""
    system, found = context.system, context.system.constants
    ratio, which = np.unique(context.damping_ratio, return_inverse=True)
    # Springs of one type of the system and one ratio are of one type.
    key = system.spring_type - 1
    if len(ratio) > 1:
        key = key + len(found) * which.reshape(-1)[system.object[system.spring[:, 0]]]
        first = np.full(len(found) * len(ratio), len(key))
        first[key[::-1]] = np.arange(len(key))[::-1]
        used = np.argsort(first)[: np.count_nonzero(first < len(key))]
        number = np.empty(len(first), np.intp)
        number[used] = np.arange(len(used))
        key, found, ratio = number[key], found[used % len(found)], ratio[used // len(found)]
    k, r0, reduced = found[:, :3].T
    merged, coefficients = types(np.stack([k, r0, 2.0 * ratio * np.sqrt(k * reduced)], axis=1))
    return merged[key], coefficients


def _columns(context: Context, counts: Mapping[str, int]) -> tuple[dict[str, np.ndarray], dict[str, Field], dict]:
    """Values and fields of all columns, by name, whole numbers last; and the names of those that each effect asks for. ``counts``
    are the things that there may be values of."""
    columns: dict[str, np.ndarray] = {}
    fields: dict[str, Field] = {}
    asked: dict[str, tuple[str, ...]] = {}
    for effect in context.resolved.effects:
        declared = effect.columns(context)
        for field, values in declared.items():
            what = f"{effect.name}: column {field.name} [{field.unit}]"
            if field.per not in counts or np.shape(values) != (counts[field.per], *field.shape):
                raise ValueError(f"{what} is per {field.per}, with values of shape {np.shape(values)}")
            if fields.setdefault(field.name, field) != field:
                raise ValueError(f"{what} is declared otherwise elsewhere: {fields[field.name]}")
            columns[field.name] = np.asarray(values, field.dtype)
        asked[effect.name] = tuple(field.name for field in declared)
    if (moved := context.system.moved) is not None:
        columns[DRIVEN], fields[DRIVEN] = moved.astype(float), column(DRIVEN, "1")
    return columns, dict(sorted(fields.items(), key=lambda item: np.dtype(item[1].dtype).kind == "i")), asked


def both_ends(bonds: np.ndarray, kind: np.ndarray, n: int) -> Ends:
    """Springs, 0-based pairs i < j sorted (S, 2), with their types (S,), at both ends of n particles."""
    count = np.bincount(bonds.ravel(), minlength=n)
    first = np.concatenate([[0], np.cumsum(count)]).astype(np.int64)
    i, j = bonds.T
    # Lower partners come first; a stable sort by owner keeps each half ascending because bonds are sorted by (i, j).
    owner = np.concatenate([j, i])
    order = np.argsort(owner, kind="stable")
    partner = np.concatenate([i, j])[order].astype(np.int32) + np.int32(1)
    return Ends(first, partner, np.concatenate([kind, kind])[order].astype(np.int32))
