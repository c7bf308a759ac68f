# SPDX-License-Identifier: GPL-2.0-only
"""Contact by features: which objects touch so, and what ``fix mdanim/rigid`` is told of them (docs/fix_mdanim_rigid.md).

Rigid faces do not bend, so corners, edges and balls bear all of a contact, each as one spring. Objects whose shape the fix does
not know touch by fix mdanim/contact.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ...effects.context import Context
from ...model.planes import Plane
from ...model.system import System
from ...scene.scene import Box, Shape, Solid, Sphere
from ..contact.pairs import damping, frictions, pair_rules
from ..contact.rigid_surfaces import frequency

ONSET = 0.005
"""Depth up to which a contact begins gently, over the thinnest part."""
STEP = 0.35
"""Time step of `balanced`, half of the bound, times the frequency: what stacks and heaps were at rest with (an estimate)."""


def by_features(system: System) -> np.ndarray:
    """Solids that touch each other and planes by their features, bool, shape (M,): those that are rigid, or never move, of a
    shape that the fix knows. Where others cover a side of a held cuboid, its edges there are none."""
    uncovered = np.array([frame.open is None or not len(frame.open) for frame in system.frames])[system.contact_kind]
    known = np.array([isinstance(frame.shape, Box | Sphere) for frame in system.frames])[system.contact_kind]
    return known & (system.rigid | (system.still & uncovered))


def planes_of(context: Context) -> list[Plane]:
    """The planes of all effects that are on."""
    return [plane for effect in context.resolved.effects for plane in effect.planes(context.scene)]


def objects_touch(context: Context) -> bool:
    """Whether objects touch each other."""
    return any(effect.keeps_apart for effect in context.resolved.effects)


def is_on(context: Context) -> bool:
    """Whether a body that moves may touch something by its features; the same in all parts of a scene."""
    whole = context.reach.system
    chosen = by_features(whole)
    return bool((chosen & whole.rigid).any()) and (bool(planes_of(context)) or (objects_touch(context) and chosen.sum() > 1))


def omega(context: Context) -> float:
    """Frequency of a contact, with the stiffness that the scene asks for [1/s]."""
    return frequency(context).omega * math.sqrt(context.scene.control.contact_stiffness)


def words(context: Context, shapes: str) -> str:
    """Words of the command, with the file of shapes."""
    planes = planes_of(context)
    found = [f"shapes {shapes} contact {omega(context)!r} {ONSET * frequency(context).thin!r}"]
    found += ["objects"] if objects_touch(context) else []
    found += [f"plane {'xyz'[p.axis]} {'lo' if p.sign > 0 else 'hi'} {p.at!r}" for p in planes]
    chosen, scene = by_features(context.system), context.scene
    for i, j, mu, beta in pair_rules(scene, context.system.names):
        if chosen[i] and chosen[j]:
            found.append(f"pair {i + 1} {j + 1} {mu!r} {beta!r}")
    own, free = _of(context, frictions(scene)), np.flatnonzero(chosen & context.system.rigid).tolist()
    for k, plane in enumerate(planes, 1):
        there = _of(context, frictions(scene, plane.effect))
        found += [f"pair {m + 1} plane{k} {there[m]!r} {_damping(context, there[m])!r}" for m in free if there[m] != own[m]]
    return " ".join(found)


def shapes_text(context: Context) -> str:
    """The file of shapes: a line for each solid of `by_features`."""
    system, own = context.system, _of(context, frictions(context.scene))
    solids = _solids(context)
    lines = ["# Shapes, written by mdanim-lammps: molecule mu beta free|held  place  quaternion  shape\n"]
    for m in np.flatnonzero(by_features(context.system)).tolist():
        solid = solids[m]
        numbers = [own[m], _damping(context, own[m])]
        pose = [*map(float, solid.position), *quaternion(np.array(solid.rotation))]
        kind = "free" if system.rigid[m] else "held"
        lines.append(f"{m + 1} {_digits(numbers)} {kind} {_digits(pose)} {_shape(solid.shape)}\n")
    return "".join(lines)


def _solids(context: Context) -> list[Solid]:
    """The solids of a context, which may be that of a part of the scene."""
    of = {solid.name: solid for solid in context.scene.solids}
    return [of[name] for name in context.system.names]


def _of(context: Context, values: Sequence[float]) -> list[float]:
    """Values of the solids of a context, from those of all solids of the scene."""
    of = {solid.name: float(value) for solid, value in zip(context.scene.solids, values)}
    return [of[name] for name in context.system.names]


def _damping(context: Context, friction: float) -> float:
    """Share of critical damping: contacts without friction have none."""
    return float(damping(context.scene)) if friction > 0.0 else 0.0


def _digits(numbers: Sequence[float]) -> str:
    return " ".join(map(repr, numbers))


def _shape(shape: Shape) -> str:
    """A shape as the file has it."""
    return f"box {_digits(tuple(map(float, shape.size)))}" if isinstance(shape, Box) else f"ball {float(shape.radius)!r}"


def quaternion(turn: np.ndarray) -> list[float]:
    """The unit quaternion (w, x, y, z) of a rotation matrix, shape (3, 3), by its largest component."""
    xx, yy, zz = np.diag(turn)
    squares = np.array([1 + xx + yy + zz, 1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz])
    k = int(squares.argmax())
    (xy, xz), (yx, yz), (zx, zy) = turn[0, 1:], turn[1, [0, 2]], turn[2, :2]
    rows = [
        [squares[0], zy - yz, xz - zx, yx - xy],
        [zy - yz, squares[1], yx + xy, xz + zx],
        [xz - zx, yx + xy, squares[2], zy + yz],
        [yx - xy, xz + zx, zy + yz, squares[3]],
    ]
    found = np.array(rows[k]) / math.sqrt(np.square(rows[k]).sum())
    return found.tolist()
