# SPDX-License-Identifier: GPL-2.0-only
"""How hard joints are, and their share in the bound on the time step (docs/physics-joints.md, "Stiffness" and "The time step").

Where something deforms, a joint is as hard as its material, k = f E h, and at a rope so hard, too, that its gap does not show.
Between what does not deform its gap under the expected load F is GAP of the thinnest part: k = F/(GAP s). The share in the bound
is exact for the six motions of a rigid body: with the motion q of a body and the matrix J of what a joint holds of it,
K <= blockdiag(s_A K_A, s_B K_B) with K_A = k J_A' J_A and s_A = 1 + lambda_B/lambda_A, by the mobilities of both ends; s is 1
where the other one never moves.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from ...effects.context import Context
from ...model.shapes import thickness
from ...records import dataclass
from ...scene.once import once_for
from ...scene.scene import Rope
from .ends import JointEnd, across, directions_of, lever, spin, unit
from .free import rise_of, stop_of, welds_of
from .links import NOTHING, Link, links_of
from .loads import loads
from .patches import Patch, patch_of, whole
from .preload import preloads

GAP = 0.005
"""Gap of a joint between rigid objects under LOAD times what hangs on it, over the thinnest part of both."""
AT_ROPES = 0.015
"""The same of a joint at a rope that is softer, under what hangs on it at rest: less than shows."""
STOPPED = 2.0
"""Times the frequency that a joint between rigid objects has with limits: its stops are softer than itself (free.py)."""
DAMPING = 0.02
"""Share of critical damping of the dashpots beside a joint: what a jerk has set ringing is gone after some ten periods."""
STIFFER = 4.0
"""Square of the frequency of what a joint holds against turning, over that of its gap: the most that arms make it."""


@dataclass(frozen=True)
class Strength:
    """A joint with all that follows for it."""

    link: Link
    first: JointEnd
    second: JointEnd | None
    """None for what never moves."""
    stiffness: float
    """k [N/m]"""
    damping: float
    """c beside it [N*s/m]"""
    arm: float
    """L: what is held against turning has the stiffness k L^2 [m]; 0 of what holds no direction."""
    servo: tuple[float, float]
    """Stiffness and damping of motor and friction."""
    across: np.ndarray
    """Direction across the axis of a hinge that the servo turns, shape (3,); zeros of all else."""
    load: float
    """Weight that hangs on it at rest [N]."""
    thin: float
    """Thinnest part of what it joins [m]."""
    preload: np.ndarray
    """Force [N] and torque [N m] on the first object that it bears from the start, shape (6,)."""
    stop: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Stiffness and damping of its stops, and the mobility of what they act on; 0 where they are those of the servo."""
    rise: float = math.inf
    """Change of the speed of a motor without limit in a second, at most."""

    @property
    def bodies(self) -> list[JointEnd]:
        return [self.first] if self.second is None else [self.first, self.second]

    @property
    def directions(self) -> np.ndarray:
        """Directions that it holds, shape (n, 3)."""
        return directions_of(self.link)

    @property
    def swings(self) -> bool:
        """Whether it is a spring with a stiffness of its own."""
        return self.link.joint.kind == "spring" and self.link.joint.stiffness is not None

    @property
    def frequency(self) -> float:
        """Frequency of its point on its spring [1/s]."""
        return math.sqrt(self.stiffness * sum(body.mobility for body in self.bodies))

    @property
    def gap(self) -> float:
        """How far it opens by what hangs on it at rest, of a slider at that end of its way where it is softer [m]."""
        return self.load * self.softening / self.stiffness

    @cached_property
    def softening(self) -> float:
        """Gap of a slider at the softer end of its way over that at the start, under the same load: it holds its second object
        there by a longer lever, at the rate that it has at the start. 1 of all else."""
        way, base = slide(self.link, self.bodies), [b for b in self.bodies if b.object == self.link.second]
        if way == 0.0 or not base:
            return 1.0
        start = sum(b.mobility for b in self.bodies)
        ends = (base[0].mobility_at(base[0].d + q * unit(self.link.axis)) for q in (-way, way))
        return max(1.0, 1.0 + (max(ends) - base[0].mobility) / start)

    @property
    def turns_over(self) -> bool:
        """Whether what it holds on to may turn over where it opens by its thickness: something soft, by its directions."""
        return self.link.joint.stiffness is None and bool(self.arm) and not all(body.rigid for body in self.bodies)

    def shares(self, mobilities: list[float]) -> list[float]:
        """s of each end."""
        total = sum(mobilities)
        return [total / one for one in mobilities]

    def add_to(self, rate: Sums) -> None:
        """Add its springs and dashpots to the sums of what they join."""
        bodies, n, k, ll = self.bodies, self.directions, self.stiffness, self.arm**2
        axis = None if self.link.axis is None else unit(self.link.axis)
        way = slide(self.link, self.bodies)
        for body, share in zip(bodies, self.shares([b.mobility for b in bodies])):
            points = [body.d] if way == 0.0 or axis is None else [body.d - way * axis, body.d + way * axis]
            for point in points:
                rate.point(body, point, share * k, share * self.damping)
        if len(n) and ll:
            for body, share in zip(bodies, self.shares([b.turning(n) for b in bodies])):
                rate.turning(body, n, share * k * ll, share * self.damping * ll)
        if self.servo[0] and axis is not None:
            own = self.link.joint.limits is not None and not self.stop[0]
            servo = (servos(self.link) + own) * self.servo[0] + self.stop[0]
            if self.link.joint.kind == "hinge":
                for body, share in zip(bodies, self.shares([b.about(axis, self.across) for b in bodies])):
                    rate.about(body, axis, self.across, share * servo)
            else:
                for body, share in zip(bodies, self.shares([b.mobility for b in bodies])):
                    rate.point(body, body.d, share * servo, 0.0)


@dataclass(frozen=True)
class RigidPart:
    """Rigid objects that are welded together, or one alone."""

    centre: np.ndarray
    """[m], shape (3,)."""
    tensor: np.ndarray
    """Moments of inertia about it [kg m^2], shape (3, 3)."""
    root: np.ndarray
    """M^-1/2 of its six motions, shape (6, 6)."""

    @classmethod
    def of(cls, context: Context, members: Sequence[int]) -> RigidPart:
        """The body of these objects of a scene."""
        system, solids = context.reach.system, context.scene.solids
        if len(members) == 1:
            mass, centre, tensor = system.mass_of[members[0]], np.array(solids[members[0]].position), system.inertia[members[0]]
        else:
            masses, places = system.mass_of[list(members)], np.array([solids[m].position for m in members])
            mass = masses.sum()
            centre = masses @ places / mass
            arms = places - centre
            tensor = system.inertia[list(members)].sum(axis=0) + (masses * (arms**2).sum(axis=1)).sum() * np.eye(3)
            tensor = tensor - (masses[:, None] * arms).T @ arms
        values, axes = np.linalg.eigh(tensor)
        root = np.zeros((6, 6))
        root[:3, :3] = np.eye(3) / math.sqrt(mass)
        root[3:, 3:] = axes / np.sqrt(values) @ axes.T
        return cls(centre, tensor, root)


class Sums:
    """Sums of K and C over the joints of each body: six motions of a rigid one, particles of all others."""

    def __init__(self, context: Context):
        self.system = context.system
        self.bodies: dict[int, tuple[JointEnd, np.ndarray, np.ndarray]] = {}
        self.rate, self.drag = np.zeros(self.system.particles), np.zeros(self.system.particles)

    def point(self, body: JointEnd, d: np.ndarray, k: float, c: float) -> None:
        if body.patch is None:
            self._rigid(body, lever(d), k, c)
        else:
            self._particles(body.patch, body.patch.of_point(body.patch.centre + d), k, c)

    def turning(self, body: JointEnd, directions: np.ndarray, k: float, c: float) -> None:
        if body.patch is None:
            self._rigid(body, spin(directions), k, c)
        else:
            for e in directions:
                self._particles(body.patch, body.patch.of_direction(e), k, c)

    def about(self, body: JointEnd, axis: np.ndarray, turned: np.ndarray, k: float) -> None:
        if body.patch is None:
            self._rigid(body, np.concatenate([np.zeros(3), axis])[None], k, 0.0)
        else:
            self._particles(body.patch, body.patch.of_direction(turned), k, 0.0)

    def _rigid(self, body: JointEnd, rows: np.ndarray, k: float, c: float) -> None:
        _, stiff, drag = self.bodies.setdefault(body.body, (body, np.zeros((6, 6)), np.zeros((6, 6))))
        stiff += k * rows.T @ rows
        drag += c * rows.T @ rows

    def _particles(self, patch: Patch, weight: np.ndarray, k: float, c: float) -> None:
        share = np.abs(weight).sum() * np.abs(weight) / patch.mass
        self.rate[patch.rows] += k * share
        self.drag[patch.rows] += c * share

    def of_particles(self) -> tuple[np.ndarray, np.ndarray]:
        """Shares in the bound of each particle, of stiffness [1/s^2] and of damping [1/s], each of shape (N,)."""
        rate, drag = self.rate.copy(), self.drag.copy()
        for body, stiff, damped in self.bodies.values():
            own_rate, own_drag = (np.linalg.eigvalsh(body.root @ sum_ @ body.root)[-1] for sum_ in (stiff, damped))
            for m in body.members:
                own = slice(self.system.first[m], self.system.first[m + 1])
                rate[own] += own_rate
                drag[own] += own_drag
        return rate, drag


def slide(link: Link, bodies: list[JointEnd]) -> float:
    """How far a slider may get from its start [m]: its limits, or the sizes of what it joins."""
    if math.isfinite(rail := _rail(link)):
        return rail
    return max(float(np.linalg.norm(b.d)) + (b.patch.size if b.patch else 0.0) for b in bodies)


def servos(link: Link) -> int:
    """How many springs of its servo a joint has: motor and friction have one each."""
    return sum(one is not None for one in (link.joint.motor, link.joint.friction))


def _rail(link: Link) -> float:
    """Distance from the point of a joint within which it holds on to what deforms, at least [m]: the way of a slider, all of a
    body without limits. A patch that ends before the way does turns over under what slides there."""
    return link.way if link.joint.kind == "slider" else 0.0


@once_for(lambda context: context.reach)
def strengths(context: Context) -> list[Strength]:
    """All joints of a scene; also asked of the context of a part of it."""
    system, scene, links = context.reach.system, context.scene, links_of(context.scene)
    pull, springs = loads(context, links), {link.number for link in links.springs}
    rigid: dict[int, RigidPart] = {}
    thin = [thickness(solid.shape) for solid in scene.solids]

    def body(m: int, point, rail: float) -> JointEnd | None:
        if m == NOTHING or system.held[system.first[m] : system.first[m + 1]].all():
            return None
        at = np.array(point, float)
        if not system.rigid[m]:
            patch = patch_of(system, m, at, rail)
            return JointEnd(m, at - patch.centre, patch, np.zeros((0, 0)), np.zeros((3, 3)), (m,))
        members = tuple(links.whole_of.get(m, [m]))
        if members[0] not in rigid:
            rigid[members[0]] = RigidPart.of(context, members)
        part = rigid[members[0]]
        return JointEnd(m, at - part.centre, None, part.root, part.tensor, members)

    found = []
    for link, (load, most) in zip(links.all, pull):
        if link.number not in springs:
            continue
        rail = _rail(link)
        first, second = body(link.first, link.begin, rail), body(link.second, link.end, rail)
        if first is None:  # held, and driven
            first, second = second, None
        if first is None:
            continue
        found.append(_strength(context, link, first, second, load, most, thin))
    welded = welds_of(found)
    stopped = {n for one, welds in zip(found, welded) if one.link.joint.limits is not None for n in welds}
    found = [_harder(one) if n in stopped else one for n, one in enumerate(found)]

    def whole_one(one: Strength, load: np.ndarray, numbers: list[int]) -> Strength:
        welds = [found[n] for n in numbers]
        return replace(one, preload=load, stop=stop_of(one, welds), rise=rise_of(context, one, GAP * one.thin, welds))

    return [whole_one(*more) for more in zip(found, preloads(context, found), welded)]


def _harder(weld: Strength) -> Strength:
    """A weld of what a stop stops, with the frequency of a joint with limits, where the scene does not tell its stiffness."""
    k = weld.stiffness * (STOPPED**2 if weld.link.joint.stiffness is None else 1.0)
    c = weld.damping * (math.sqrt(k / weld.stiffness) if weld.link.joint.damping is None else 1.0)
    return replace(weld, stiffness=k, damping=c)


def _strength(context: Context, link: Link, first: JointEnd, second: JointEnd | None, load: float, most: float, thin) -> Strength:
    joint, bodies = link.joint, [b for b in (first, second) if b is not None]
    mobility = sum(b.mobility for b in bodies)
    sides = [thin[b.object] for b in bodies]
    slowest = (2.0 * math.pi * context.scene.control.frames) ** 2 / mobility
    if joint.stiffness is not None:
        k = joint.stiffness
    elif soft := [b for b in bodies if not b.rigid]:
        k = max(slowest, min(_of_material(context, b.object) for b in soft))
        if all(isinstance(context.scene.solids[b.object].shape, Rope) for b in soft):
            k = max(k, load / (AT_ROPES * min(sides)))
    else:
        k = max(slowest, most / (GAP * min(sides))) * (1.0 if joint.limits is None else STOPPED**2)
    usual = 2.0 * DAMPING * math.sqrt(k / mobility)
    if joint.kind == "spring" and joint.stiffness is not None:
        usual = 0.0
    c = usual if joint.damping is None else joint.damping
    arm = _arm(link, bodies, mobility)
    turned = _turned(context, link, bodies)
    return Strength(
        link, first, second, k, c, arm, _servo(link, bodies, turned, k, mobility), turned, load, min(sides), np.zeros(6)
    )


def _of_material(context: Context, m: int) -> float:
    """E h of an object, with the factor of contact [N/m]."""
    system = context.reach.system
    return float(context.scene.control.contact_stiffness * system.young[m] * np.cbrt(system.cell_volume[m]))


def _arm(link: Link, bodies: list[JointEnd], mobility: float) -> float:
    """L, as long as the longest arm of what it joins, but no longer than gives STIFFER times the square of the frequency."""
    directions = directions_of(link)
    if not len(directions):
        return 0.0
    turning = sum(b.turning(directions) for b in bodies)
    longest = max(b.patch.size if b.patch is not None else float(np.linalg.norm(b.d)) for b in bodies)
    most = math.sqrt(STIFFER * mobility / turning)
    return min(longest, most) if longest > 0.25 * most else 0.5 * most


def _turned(context: Context, link: Link, bodies: list[JointEnd]) -> np.ndarray:
    """The direction that the servo of a hinge turns, as the fix chooses it from the particles that each end holds on to."""
    if link.joint.kind != "hinge":
        return np.zeros(3)
    patches = {body.object: body.patch.inverse for body in bodies if body.patch is not None}
    ends = [m for m in (link.first, link.second) if m != NOTHING]
    return across(unit(link.axis), [patches[m] if m in patches else whole(context.reach.system, m).inverse for m in ends])


def _servo(link: Link, bodies: list[JointEnd], turned: np.ndarray, k: float, mobility: float) -> tuple[float, float]:
    """Spring and dashpot of motor and friction: of the frequency of the gap, and critically damped."""
    if not servos(link) and link.joint.limits is None:
        return 0.0, 0.0
    own = sum(b.about(unit(link.axis), turned) for b in bodies) if link.joint.kind == "hinge" else mobility
    stiff = k * mobility / own
    return stiff, 2.0 * math.sqrt(stiff / own)
