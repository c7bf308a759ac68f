# SPDX-License-Identifier: GPL-2.0-only
"""The surfaces of rigid bodies: how hard they are where they touch, and their bound (docs/physics-rigid.md, "Contact").

A rigid body has no modulus from which the stiffness of a contact could follow. Its surface is as hard as one frequency of the
scene says: a contact of a body of the mobility lambda is a spring of Omega^2 / lambda, whatever the masses, and a blow at v goes
v/Omega deep.
"""

from __future__ import annotations

import math

import numpy as np

from ...effects.context import Context
from ...model import shapes
from ...model.boxes import overlaps_in_plan
from ...model.contact_body import FINE, ContactBody
from ...model.inertia import mobility
from ...model.largest import largest
from ...model.system import System
from ...reach import thrown_within
from ...records import dataclass
from ...scene.once import once_for
from ...scene.scene import Sphere

DEPTH = 0.02
"""How deep the fastest blow goes, over the thinnest part of all rigid bodies."""
LARGE, SMALL = 0.9, 5.0
"""Part of the volume of a body that its large parts have; how much deeper than others its small ones may be struck, as a sail or
a mast on a hull. Random blows go up to 3.4 times as deep as v/Omega: with 5 that is 0.34 of the thickness, and contact knows
sides up to half of it; a step at full speed is 0.035 of it, and edges begin up to 0.06 (plugin/rigid/touch_polyhedra.cpp)."""
WALL = 25.0
"""How much deeper than others what is held may be struck: half of its thickness, of which a step at full speed is a third."""
HARD = 1e20
"""Modulus of what is rigid and held [Pa]: the surface of its partner alone yields."""
THICKER = 2.0
"""How much thicker than the thinnest one others are that are told of beside it."""
STICK = 0.8
"""Stiffness of the stick spring of friction over that of the contact."""


@dataclass(frozen=True, slots=True)
class Frequency:
    """The frequency of the contacts of rigid bodies, and where it comes from."""

    omega: float
    """[1/s]"""
    thin: float
    """Thinnest part of all rigid bodies that move [m], see `_thickness`, and `WALL` times that of what is held."""
    thinnest: int
    """Number of the solid that has it."""
    speed: float
    """Closing speed of the fastest blow [m/s]; what pushes objects counts on their way to others and to planes."""
    load: float
    """Largest weight that a body bears, over its own, and one more for its own [-]."""
    thicker: float | None
    """Omega by those alone that are more than THICKER times as thick [1/s]; None without such."""


@once_for(lambda context: context.reach)
def frequency(context: Context) -> Frequency:
    """Omega = max(v, 2 sqrt(N g s)) / (DEPTH s): the fastest blow at v, and the load N at rest, sink in by DEPTH s at most.

    Of a scene in which rigid bodies move; also asked of the context of a part of it.
    """
    reach, system = context.reach, context.reach.system
    free = np.flatnonzero(system.rigid)
    held = _struck_by_corners(context, free)
    part = np.concatenate([_thickness(context, free), [WALL * shapes.thickness(context.scene.solids[m].shape) for m in held]])
    thinnest = int([*free.tolist(), *held][part.argmin()])
    thin, thicker = float(part.min()), float(part[part > THICKER * part.min()].min(initial=math.inf))
    thrown = _thrown_across(context, system) if reach.acting.throws else None
    speed = float(struck_at(context, system, thrown)[free].max())
    load = float(loads(system, free, reach.body).max())
    slowest = 2.0 * math.pi * context.scene.control.frames * DEPTH  # of what hardly moves, over a thickness
    hard = lambda s: float(max(speed, 2.0 * math.sqrt(load * reach.g * s), slowest * s)) / (DEPTH * s)
    return Frequency(hard(thin), thin, thinnest, speed, load, hard(thicker) if thicker < math.inf else None)


def _struck_by_corners(context: Context, free: np.ndarray) -> list[int]:
    """Numbers of the held solids that something else than balls may strike: a corner that is more than half through a wall after
    its first step below it goes on. A ball does not, as its middle stays outside."""
    solids = context.scene.solids
    if all(isinstance(solids[m].shape, Sphere) for m in free.tolist()):
        return []
    return np.flatnonzero(context.reach.system.held_whole & ~context.reach.system.bare).tolist()


def _thickness(context: Context, free: np.ndarray) -> np.ndarray:
    """Thickness of some solids, by number, that says how deep blows may go [m], shape (K,): their own, and of small parts of a
    body `SMALL` times that, up to the thinnest of its large parts."""
    solids, body = context.scene.solids, context.reach.hung[free]
    own = {shape: shapes.thickness(shape) for shape in {solids[m].shape for m in free.tolist()}}
    found = np.array([own[solids[m].shape] for m in free.tolist()])
    order = np.argsort(body, kind="stable")
    bodies = np.split(order, np.flatnonzero(np.diff(body[order])) + 1)
    for of in (of for of in bodies if len(of) > 1):
        large = of[largest([solids[m].shape for m in free[of].tolist()], LARGE)]
        small = np.setdiff1d(of, large)
        found[small] = np.maximum(found[small], np.minimum(SMALL * found[small], found[large].min()))
    return found


def struck_at(context: Context, system: System, thrown: np.ndarray | None = None) -> np.ndarray:
    """Speed of the fastest blow that each solid may give or get [m/s], shape (M,); ``thrown`` as in `Reach.closing`."""
    reach = context.reach
    fastest = np.maximum(reach.speed_after(reach.fall, thrown), reach.closing(reach.fall, thrown))
    return np.maximum(fastest, _toppled(context, system))


def _thrown_across(context: Context, system: System) -> np.ndarray:
    """Speed that pushes give to each solid on its way to the farthest other one or the farthest plane as they are at the start
    [m/s], shape (M,): how hard contacts are, and so a motion, depends not on how long a scene goes on."""
    low, high = system.bounds(system.position)
    way = np.zeros(len(low))
    for plane in (p for effect in context.resolved.effects for p in effect.planes(context.scene)):
        edge = low if plane.sign > 0 else high
        way = np.maximum(way, plane.sign * (edge[:, plane.axis] - plane.at))
    return np.maximum(context.reach.thrown_across, thrown_within(context.reach.acting, way))


def _toppled(context: Context, system: System) -> np.ndarray:
    """Speed at which the top of each solid that stands at the start may come down, as that of a thin rod that falls over on the
    floor, sqrt(3 g H) [m/s], shape (M,); none where all stand and nothing comes that might throw one over."""
    reach = context.reach
    if (reach.stands | ~reach.free).all():
        return np.zeros(len(system.names))
    height = system.bounds(system.position)[1][:, 2] - reach.heights[1]
    return np.where(reach.stands, np.sqrt(3.0 * reach.g * np.maximum(height, 0.0)), 0.0)


def loads(system: System, asked: np.ndarray, body: np.ndarray) -> np.ndarray:
    """Mass of the bodies of some solids, by number and ascending, shape (K,), and of all other free solids above each at the
    start, over that of its body [-], shape (K,); ``body`` has a number for the body of each solid, shape (M,)."""
    low, high = system.bounds(system.position)
    weight = np.where(system.held_whole, 0.0, system.mass_of)
    mass = np.bincount(body, system.mass_of, len(body))[body]
    found = np.ones(len(weight))
    for m, near in overlaps_in_plan(low, high, asked):
        above = near[(low[near, 2] + high[near, 2] > low[m, 2] + high[m, 2]) & (body[near] != body[m])]
        found[m] += weight[above].sum() / mass[m]
    return found[asked]


def moduli(context: Context) -> np.ndarray:
    """Young's modulus of each solid [Pa], shape (M,), with which it enters contact; of a rigid one it gives the hardness. Of the
    context of a whole scene.

    kappa = E/h = Omega^2 / (lambda s^2/4) [N/m^3] with its largest mobility lambda and thickness s, so that a corner or a patch
    of s^2/4 is a spring of Omega^2 / lambda.
    """
    system = context.system
    found = np.where(np.isfinite(system.young), system.young, HARD)
    if not system.rigid.any():
        return found
    omega = frequency(context).omega
    known: dict[tuple, float] = {}
    for m in np.flatnonzero(system.rigid).tolist():
        key = (int(system.contact_kind[m]), float(system.mass_of[m]))
        if key not in known:
            side = shapes.thickness(system.frames[key[0]].shape) / 2.0
            known[key] = omega**2 / (_largest_mobility(context, m) * side**2)
        found[m] = known[key] * float(np.cbrt(system.cell_volume[m]))
    return found


def spread_mobility(context: Context) -> np.ndarray:
    """Lambda of each rigid body that moves [m^2/kg], shape (M,), 0 of all others: largest eigenvalue of M^-1 sum_q w_q G_q G_q'
    over all points q of its surface, with areas w_q.

    Springs of kappa w at some points or at all have the squared frequency kappa Lambda at most. G has the normal, and with
    friction sqrt(STICK) along the surface.
    """
    system = context.system
    found, known = np.zeros(len(system.names)), {}
    for m in np.flatnonzero(system.rigid).tolist():
        key = (int(system.contact_kind[m]), float(system.mass_of[m]))
        if key not in known:
            known[key] = _spread_mobility(context, m)
        found[m] = known[key]
    return found


def _body(context: Context, m: int) -> tuple[ContactBody, np.ndarray, np.ndarray]:
    """Contact body of a solid, its points from the centre [m], shape (P, 3), and its tensor of inertia, both along its axes."""
    system = context.system
    kind, turn = int(system.contact_kind[m]), np.array(context.scene.solids[m].rotation)
    body = system.frames[kind].contact
    return body, system.frames[kind].cells.low + body.at * body.edge, turn.T @ system.inertia[m] @ turn


def _largest_mobility(context: Context, m: int) -> float:
    if isinstance(context.scene.solids[m].shape, Sphere):  # normals lead through its centre
        return float(1.0 / context.system.mass_of[m])
    body, point, tensor = _body(context, m)
    return float(mobility(tensor, float(context.system.mass_of[m]), point, body.normal).max())


def _spread_mobility(context: Context, m: int) -> float:
    body, point, tensor = _body(context, m)
    n, area = body.normal, np.where(body.kind == FINE, 0.0, body.area)  # fine points act in place of others, with equal areas
    push = STICK * np.eye(3) + (1.0 - STICK) * n[:, :, None] * n[:, None, :]
    arm = np.zeros((len(point), 3, 3))  # cross product with the arm, as a matrix
    arm[:, 0, 1], arm[:, 0, 2], arm[:, 1, 2] = -point[:, 2], point[:, 1], -point[:, 0]
    arm -= np.swapaxes(arm, 1, 2)
    lever = np.concatenate([np.broadcast_to(np.eye(3), arm.shape), arm], axis=1)  # motion of the body, transposed
    stiff = np.einsum("p,pik,pkl,pjl->ij", area, lever, push, lever)
    values, axes = np.linalg.eigh(tensor)
    root = np.zeros((6, 6))
    root[:3, :3] = np.eye(3) / math.sqrt(context.system.mass_of[m])
    root[3:, 3:] = axes / np.sqrt(values) @ axes.T
    return float(np.linalg.eigvalsh(root @ stiff @ root)[-1])
