# SPDX-License-Identifier: GPL-2.0-only
"""Contact by features: which objects touch so, and what ``fix mdanim/rigid`` is told of them (docs/fix_mdanim_rigid.md).

Rigid faces do not bend, so corners, edges and balls bear all of a contact, each as one spring. Objects whose shape the fix does
not know touch by fix mdanim/contact.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from ...bodies import all_held
from ...effects.context import Context
from ...effects.envelope import Envelope
from ...effects.margin import Margin
from ...effects.readings import Readings
from ...model.planes import Plane
from ...model.shapes import thickness
from ...model.system import System
from ...records import dataclass
from ...scene.formatting import in_full, number, say
from ...scene.naming import objects_by_name, pairs_of
from ...scene.scene import Shape, Solid
from ..contact.pairs import belts, damping, frictions
from ..contact.planes import word_of
from ..contact.restitution import damping_for
from ..contact.rigid_surfaces import frequency
from ..contact.words import ContactPair
from .shapes import hidden, in_file, is_known, is_rigid, on_objects, on_planes, only_balls_move
from .words import Sleep

ONSET = 0.005
"""Depth up to which a contact begins gently, over the thinnest part."""
DEEP, SUNK = 0.05, 0.005
"""Depths of a blow and of a load at rest, over the thinnest part, above which they show."""
STEP = 0.35
"""Time step of `balanced`, half of the bound, times the frequency: what stacks and heaps were at rest with (an estimate)."""
CALM, BALANCED = 1e-4, 1e-3
"""Largest speed of what is calm over sqrt(g s), with the thinnest part s of all, and acceleration over g."""

FIXES = ("rigid", "rigid_rest")
"""Fixes of what touches objects by its features, and of all else."""
COLUMNS = 24
"""Columns of the array of a fix, a row for each body."""
OF_WHOLE, BEARS_FORCE, BEARS_TORQUE, AT, STRESS = 13, slice(14, 17), slice(17, 20), slice(20, 23), 23
"""Columns of the first object that a body is glued together with; of what it bears where it hangs on that; of the place; of the
largest stress that its glue bore."""


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """The bodies of one fix."""

    fix: str
    bodies: np.ndarray
    """Solids that it moves, bool, shape (M,)."""
    shapes: np.ndarray
    """Solids that it knows by their features, bool, shape (M,): some of these, and some that never move."""
    objects: bool
    """Whether they touch each other."""


def parts(context: Context) -> list[Part]:
    """The fixes of a context that move some bodies."""
    system = context.system
    known = _known(system)
    first = Part(FIXES[0], system.rigid & known, meets_objects(context) | (meets_planes(context) & known), objects_touch(context))
    rest = Part(FIXES[1], system.rigid & ~known, meets_planes(context) & ~known, False)
    return [part for part in (first, rest) if part.bodies.any()]


def told_of_bodies(readings: Readings) -> dict[int, np.ndarray]:
    """Rows that the first fix tells of its bodies, shape (COLUMNS,) each, by the numbers of the solids in its context."""
    bodies = [m for part in parts(readings.context) if part.fix == FIXES[0] for m in np.flatnonzero(part.bodies).tolist()]
    return dict(zip(bodies, readings.fix_rows(FIXES[0], len(bodies), COLUMNS)))


def meets_objects(context: Context) -> np.ndarray:
    """Solids that touch each other by their features, bool, shape (M,): those that are rigid, or never move, of a shape that the
    fix knows. Where others cover a side of a held cuboid, its edges there are none: the file says so. Those that are covered in
    part are known to balls alone, others catch."""
    whole = context.reach.system
    if not objects_touch(context) or not (_known(whole) & whole.rigid).any():
        return np.zeros(len(context.system.names), bool)  # the same in all parts of a scene
    system = context.system
    uncovered = np.array([frame.open is None or not len(frame.open) for frame in system.frames])[system.contact_kind]
    everywhere = only_balls_move(context.scene.solids) or hidden(context.scene) is not None
    return _known(system) & (system.rigid | ((system.still | guided(context)) & (uncovered | everywhere)))


def guided(context: Context) -> np.ndarray:
    """Solids that are held as a whole and driven by a fix that tells where they are, bool, shape (M,)."""
    names = {context.scene.solids[m].name for m in context.reach.acting.guided}
    return context.system.held_whole & np.array([name in names for name in context.system.names], bool)


def released(context: Context, part: Part) -> bool:
    """Whether a fix moves some of the bodies of a part until it lets them go."""
    pinned = np.logical_or.reduceat(context.system.pinned, context.system.first[:-1])
    return bool((part.bodies & pinned).any())


def guides(context: Context) -> list[str]:
    """Words that name the fixes that tell where driven solids are."""
    return [f"drive {fix}" for fix in sorted(set(context.reach.acting.guided.values()))]


def meets_planes(context: Context) -> np.ndarray:
    """Solids that move and touch planes by their features, bool, shape (M,)."""
    system = context.system
    return _are(system, system.rigid, on_planes) & bool(planes_of(context))


def _known(system: System) -> np.ndarray:
    """Solids whose features the fix knows, bool, shape (M,)."""
    return _are(system, system.rigid, on_objects) | _are(system, ~system.rigid, lambda shape: on_objects(shape, moves=False))


def _are(system: System, asked: np.ndarray, known: Callable[[Shape], bool]) -> np.ndarray:
    """Some solids whose shapes are known, bool, shape (M,): others are not asked, which may take long."""
    kinds = np.unique(system.contact_kind[asked]).tolist()
    found = np.zeros(len(system.frames), bool)
    found[kinds] = [known(system.frames[kind].shape) for kind in kinds]
    return asked & found[system.contact_kind]


def planes_of(context: Context) -> list[Plane]:
    """The planes of all effects that are on."""
    return [plane for effect in context.resolved.effects for plane in effect.planes(context.scene)]


def objects_touch(context: Context) -> bool:
    """Whether objects touch each other."""
    return any(effect.keeps_apart for effect in context.resolved.effects)


def may_meet(context: Context, what: str) -> bool:
    """Whether objects touch ``planes``, or else each other."""
    return bool(planes_of(context)) if what == "planes" else objects_touch(context)


def omega(context: Context) -> float:
    """Frequency of a contact, with the stiffness that the scene asks for [1/s]."""
    return frequency(context).omega * math.sqrt(context.scene.control.contact_stiffness)


def depths(envelope: Envelope) -> list[Margin]:
    """How deep the fastest blow goes, and how deep things sink in at rest, beside the thinnest part."""
    context, found, frequency_of = envelope.context, frequency(envelope.context), omega(envelope.context)
    solids = context.scene.solids
    thinnest = found.thinnest
    own = thickness(solids[thinnest].shape)
    place = context.scene.control.spans.get("contact-stiffness") or envelope.place(thinnest, "shape")
    blow = found.speed / frequency_of
    stiffness = context.scene.control.contact_stiffness
    rest = math.sqrt(2.0 * ONSET * found.thin * found.load * context.reach.g) / frequency_of
    return [
        Margin(
            name,
            solids[thinnest].name,
            value,
            part * found.thin,
            "m",
            f"{what} {say(value, 'm')} deep, {number(100.0 * value / own, 2)} % of {say(own, 'm')}, the "
            f"thickness of {solids[thinnest].name}, which says how hard contacts are",
            place,
            "warning" if value > part * found.thin * (1.0 + 1e-9) else "ok",
            hint=f"write contact-stiffness {number(stiffness * max(1.0, value / (part * found.thin)) ** 2 * 1.05, 2)} in control",
        )
        for name, value, part, what in (
            ("blow depth", blow, DEEP, f"the fastest blow, {say(found.speed, 'm/s')}, goes"),
            ("rest depth", rest, SUNK, "what bears most sinks in at rest by"),
        )
    ]


def words(context: Context, part: Part, shapes: str) -> str:
    """Words of the command of a fix, with its file of shapes."""
    planes, scene = planes_of(context), context.scene
    found = [f"shapes {shapes} contact {omega(context)!r} {ONSET * frequency(context).thin!r}"]
    found += ["objects"] if part.objects else []
    found += sleeps(context)
    found += map(word_of, planes)
    found += belts(context, part.shapes) if part.objects else []
    if part.objects and (guided(context) & part.shapes).any() and not released(context, part):
        found += guides(context)
    if part.objects:
        found += [f"exclude {i + 1} {j + 1}" for i, j in context.passing if part.shapes[i] and part.shapes[j]]
        found += [f"pair {i + 1} {j + 1} {mu!r} {beta!r}" for (i, j), (mu, beta) in _pair_laws(context, part).items()]
        found += [f"rolling {i + 1} {j + 1} {c.rolling!r}" for c, i, j in _pairs(context, part) if c.rolling is not None]
    own, usual = _of(context, frictions(scene)), dampings(context)
    free = np.flatnonzero(part.shapes & part.bodies).tolist()
    for k, plane in enumerate(planes, 1):
        there = _of(context, frictions(scene, plane.effect))
        blows = _restitution_at(context, plane.effect)
        for m in free:
            law = there[m], _damping(context, there[m], blows[m])
            if law != (own[m], usual[m]):
                found.append(f"pair {m + 1} plane{k} {law[0]!r} {law[1]!r}")
        found += [f"rolling {m + 1} plane{k} {r!r}" for m, r in _rolling_at(context, plane.effect).items() if m in free]
    return " ".join(found)


def sleeps(context: Context) -> list[str]:
    """The rule of sleep, if the scene asks for it. In the time for which a body has to be calm it moved by less than CALM of the
    thinnest part of all, and the forces on it are in balance to BALANCED of its weight."""
    g, thin = context.reach.g, frequency(context).thin
    if context.scene.control.sleep is Sleep.OFF or g == 0.0:
        return []
    return [f"sleep {CALM * math.sqrt(g * thin)!r} {BALANCED * g!r} {math.sqrt(thin / g)!r}"]


def shapes_text(context: Context, part: Part) -> str:
    """The file of shapes: a line for each solid that a fix knows by its features."""
    own, shares, solids = _of(context, frictions(context.scene)), dampings(context), _solids(context)
    blows = _restitutions(context)
    given = any(e is not None for e in blows)
    lines = ["# Shapes, written by mdanim-lammps: molecule mu beta [usual] free|held|driven  place  quaternion  shape\n"]
    driven, covered = guided(context), hidden(context.scene) or {}
    for m in np.flatnonzero(part.shapes).tolist():
        place, shape = in_file(solids[m], covered.get(solids[m].name, ()))
        pose = [*place, *quaternion(np.array(solids[m].rotation))]
        kind = "free" if part.bodies[m] else "driven" if driven[m] else "held"
        kind = f"rolling {solids[m].rolling!r} {kind}" if solids[m].rolling else kind
        kind = f"usual {kind}" if given and blows[m] is None else kind  # where one of two has a restitution, it counts alone
        lines.append(f"{m + 1} {in_full([own[m], shares[m]])} {kind} {in_full(pose)} {shape}\n")
    return "".join(lines)


def outline(solid: Solid) -> str | None:
    """A solid that is rigid or never moves as the file of shapes has it, held and without friction; None of all others."""
    if not (is_rigid(solid) or all_held(solid)) or not is_known(solid):
        return None
    place, shape = in_file(solid)
    return f"0 0 held {in_full([*place, *quaternion(np.array(solid.rotation))])} {shape}"


def _solids(context: Context) -> list[Solid]:
    """The solids of a context, which may be that of a part of the scene."""
    of = {solid.name: solid for solid in context.scene.solids}
    return [of[name] for name in context.system.names]


def _of(context: Context, values: Sequence[float]) -> list[float]:
    """Values of the solids of a context, from those of all solids of the scene."""
    of = {solid.name: float(value) for solid, value in zip(context.scene.solids, values)}
    return [of[name] for name in context.system.names]


def _restitutions(context: Context) -> list[float | None]:
    """Coefficient of restitution of each solid of a context, its own or that of the scene [-]; None where neither is given."""
    usual = context.scene.control.restitution
    return [usual if solid.restitution is None else solid.restitution for solid in _solids(context)]


def _restitution_at(context: Context, plane: str) -> list[float | None]:
    """The same at a plane."""
    found = _restitutions(context)
    by_name = objects_by_name(context.system.names)
    for contact in context.scene.contacts:
        if contact.restitution is not None and plane in (contact.first, contact.second):
            for m in (*by_name.get(contact.first, ()), *by_name.get(contact.second, ())):
                found[m] = contact.restitution
    return found


def _damping(context: Context, friction: float, restitution: float | None) -> float:
    """Share of critical damping [-]: from the restitution, or else the usual one where there is friction."""
    if restitution is not None:
        return damping_for(restitution)
    return float(damping(context.scene)) if friction > 0.0 else 0.0


def dampings(context: Context) -> list[float]:
    """Share of critical damping of the contacts of each solid [-]; of two the larger one counts."""
    return [_damping(context, mu, e) for mu, e in zip(_of(context, frictions(context.scene)), _restitutions(context))]


def _pairs(context: Context, part: Part) -> Iterator[tuple[ContactPair, int, int]]:
    """Pairs i < j of solids of a part that contact blocks name, with the block."""
    by_name = objects_by_name(context.system.names) if context.scene.contacts else {}
    for contact in context.scene.contacts:
        for i, j in pairs_of(by_name.get(contact.first, ()), by_name.get(contact.second, ())):
            if part.shapes[i] and part.shapes[j]:
                yield contact, i, j


def _pair_laws(context: Context, part: Part) -> dict[tuple[int, int], tuple[float, float]]:
    """Friction and damping of pairs that contact blocks name."""
    own, blows = _of(context, frictions(context.scene)), _restitutions(context)
    found = {}
    for contact, i, j in _pairs(context, part):
        mu = math.sqrt(own[i] * own[j]) if contact.friction is None else float(contact.friction)
        given = [e for e in (blows[i], blows[j]) if e is not None]
        e = min(given, default=None) if contact.restitution is None else contact.restitution
        beta = contact.contact_damping
        found[i, j] = mu, _damping(context, mu, e) if beta is None else float(beta)
    return found


def _rolling_at(context: Context, plane: str) -> dict[int, float]:
    """Arms of what resists rolling at a plane, where contact blocks say so [m]."""
    by_name, blocks = objects_by_name(context.system.names), context.scene.contacts
    told = [c for c in blocks if c.rolling is not None and plane in (c.first, c.second)]
    return {m: float(c.rolling) for c in told for m in (*by_name.get(c.first, ()), *by_name.get(c.second, ()))}


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
