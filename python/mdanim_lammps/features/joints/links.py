# SPDX-License-Identifier: GPL-2.0-only
"""The joints of a scene one by one: what each connects, where, and how far what it holds may go."""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterable, Sequence
from functools import cached_property

import numpy as np

from ...bodies import all_held, driven, kind_of
from ...model import shapes
from ...reach import Leash
from ...records import dataclass
from ...scene import units
from ...scene.naming import objects_by_name
from ...scene.once import once_for
from ...scene.scene import PieceShape, Rope, SceneRecord, Sheet, Solid
from ...scene.schema import Vector
from ..rigid.shapes import is_known, is_rigid
from .planes import settled
from .words import WORLD, Joint

NOTHING = -1
"""In place of the number of an object: the world."""
STRETCH = 1.5
"""Largest growth of the arms of an object that deforms."""
HAIR = 1.01
"""Part of its length by which a leash is longer than the arms that it is made of: joints open a little."""


@dataclass(frozen=True, slots=True)
class Link:
    """A joint of two objects."""

    number: int
    """Among all joints of the scene, from 0."""
    joint: Joint
    first: int
    """Number of the object in the scene, from 0."""
    second: int
    """The same, or NOTHING for the world and for what never moves."""
    named: int
    """The same, of what never moves too."""
    begin: Vector
    """Its point in the first object at the start [m]."""
    end: Vector
    """The same in the second one; another one only of a spring."""
    axis: Vector | None
    """Axis about which the first one is seen from the second."""
    swapped: bool = False
    """Whether the scene names the second object first."""

    @property
    def ends(self) -> list[int]:
        """Numbers of what it joins that may move."""
        return [m for m in (self.first, self.second) if m != NOTHING]

    @property
    def length(self) -> float:
        """Distance of its two points at the start [m]."""
        return math.dist(self.begin, self.end)

    @property
    def rest(self) -> float:
        """Length of a spring without a force [m]."""
        return self.length if self.joint.length is None else self.joint.length

    @property
    def way(self) -> float:
        """Distance from the start within which a slider stays [m]; infinite without limits."""
        return math.inf if self.joint.limits is None else max(abs(units.magnitude(x)) for x in self.joint.limits)

    @property
    def pair(self) -> tuple[int, int]:
        """Both objects, the lower number first; of one that is joined to what never moves twice this one."""
        other = self.first if self.second == NOTHING else self.second
        return min(self.first, other), max(self.first, other)


class Links:
    """All joints of a scene, which it does not hold."""

    def __init__(self, scene: SceneRecord):
        self.solids = scene.solids
        by_name = objects_by_name(s.name for s in scene.solids)
        moved = driven(scene) if any(all_held(s) for s in scene.solids) else set()
        self.still = np.array([all_held(s) and m not in moved for m, s in enumerate(scene.solids)], bool)
        ends = [
            (joint, i, j)
            for joint in scene.joints
            for i in by_name[joint.first]
            for j in ([NOTHING] if joint.second == WORLD else by_name[joint.second])
            if i != j
        ]
        self.all = [self._link(number, *end) for number, end in enumerate(ends)]

    def _link(self, number: int, joint: Joint, first: int, second: int) -> Link:
        centre = self.solids[first].position
        if joint.kind == "spring":
            begin = joint.begin or centre
            end = joint.end or self.solids[second].position
        else:
            begin = end = joint.at or centre
        axis = joint.axis
        swapped = second != NOTHING and bool(self.still[first]) and not self.still[second]
        if swapped:
            # A thing that never moves stands second, as the world does. The angle of one seen from the other is that of the other
            # seen from the one about the opposite axis.
            first, second, begin, end = second, first, end, begin
            axis = None if axis is None else tuple(-x for x in axis)
        fixed = second == NOTHING or bool(self.still[second])
        if joint.kind == "spring":
            begin, end = self._settled([first], begin), self._settled([second], end)
        else:
            begin = end = self._settled([first, second], begin)
        return Link(number, joint, first, NOTHING if fixed else second, second, begin, end, axis, swapped)

    def sheets(self, objects: Iterable[int]) -> list[int]:
        """Sheets among these objects whose particles hold a joint: they move, or parts of them do."""
        return [m for m in objects if m != NOTHING and isinstance(self.solids[m].shape, Sheet) and not self.still[m]]

    def rope(self, objects: Iterable[int]) -> str | None:
        """Name of the first of these objects that is a line of particles."""
        return next((self.solids[m].name for m in objects if m != NOTHING and isinstance(self.solids[m].shape, Rope)), None)

    def _settled(self, objects: list[int], point: Vector) -> Vector:
        """A place in the planes of sheets that hold it, where it is there but for a rounding; a rope has it at its line."""
        sheets = [self.solids[m] for m in self.sheets(objects)]
        return settled(sheets, point) if sheets and self.rope(objects) is None else point

    @cached_property
    def welds(self) -> list[Link]:
        """Welds that make one rigid body of both objects, in the order of joints."""
        return [link for link in self.all if _makes_one(link, self.solids)]

    @cached_property
    def springs(self) -> list[Link]:
        """All others, which springs hold together."""
        numbers = {link.number for link in self.welds}
        return [link for link in self.all if link.number not in numbers]

    @cached_property
    def whole_of(self) -> dict[int, list[int]]:
        """All objects of its body, ascending, for each object that is welded to others."""
        return {m: part for part in parts(link.ends for link in self.welds) for m in part}

    @cached_property
    def of_names(self) -> dict[str, list[tuple[str, Link]]]:
        """Joints of each object by its name, with the name of the other one, in the order of joints."""
        found: dict[str, list[tuple[str, Link]]] = {}
        for link in self.all:
            ends = [WORLD if m == NOTHING else self.solids[m].name for m in (link.first, link.named)]
            for one, two in (ends, ends[::-1]):
                found.setdefault(one, []).append((two, link))
        return found

    @cached_property
    def pairs(self) -> list[tuple[int, int]]:
        """Pairs of objects that one process has to simulate, i < j."""
        return sorted({link.pair for link in self.all if link.second != NOTHING})

    @cached_property
    def passing(self) -> list[tuple[int, int]]:
        """Pairs of objects, i < j, between which no contact acts: one of their joints says so, and none asks for it."""
        off, asked = set(), set()
        for link in (link for link in self.all if link.named != NOTHING):
            pair = min(link.first, link.named), max(link.first, link.named)
            if not link.joint.touches:
                off.add(pair)
            elif link.joint.contact is not None:
                asked.add(pair)
        return sorted(off - asked)

    @cached_property
    def leashes(self) -> dict[int, Leash]:
        """How far the centre of each joined object may go from a point that never moves, and the speed that it may be given."""
        found, given = self._distances(), self._speeds()
        nowhere = (0.0, 0.0, 0.0), math.inf
        joined = {m for link in self.all for m in (link.first, link.second) if m != NOTHING and not self.still[m]}
        return {m: Leash(*found.get(m, nowhere), given.get(m, 0.0)) for m in sorted(joined)}

    # --- how far ------------------------------------------------------------------------------------------------------

    def _arm(self, m: int, point: Vector) -> float:
        """Largest distance of a point of an object from its centre [m]."""
        solid = self.solids[m]
        return math.dist(solid.position, point) * (STRETCH if kind_of(solid).deforms else 1.0) * HAIR

    def _distances(self) -> dict[int, tuple[Vector, float]]:
        """The nearest point that never moves, along joints, and the sum of arms to the centre of each object [m]."""
        ways: dict[int, list[tuple[int, float]]] = {}
        heap: list[tuple[float, int, Vector]] = []
        for link in self.all:
            if link.joint.breaks is not None or (more := play(link)) == math.inf:
                continue
            own = self._arm(link.first, link.begin) + more
            if link.second == NOTHING:
                heap.append((own, link.first, link.end))
            else:
                far = own + self._arm(link.second, link.end)
                ways.setdefault(link.first, []).append((link.second, far))
                ways.setdefault(link.second, []).append((link.first, far))
        heapq.heapify(heap)
        found: dict[int, tuple[Vector, float]] = {}
        while heap:
            far, m, point = heapq.heappop(heap)
            if m in found:
                continue
            found[m] = point, far
            for other, more in ways.get(m, ()):
                if other not in found:
                    heapq.heappush(heap, (far + more, other, point))
        return found

    def _speeds(self) -> dict[int, float]:
        """Speed that motors and springs may give to each object [m/s]: the sum over all that it hangs together with."""
        own: dict[int, float] = {}
        for link in self.all:
            ends = [m for m in (link.first, link.second) if m != NOTHING]
            own[min(ends)] = own.get(min(ends), 0.0) + self._given(link, ends)
        if not any(own.values()):
            return {}
        found = {}
        for part in parts(ends for link in self.all if (ends := [m for m in (link.first, link.second) if m != NOTHING])):
            total = sum(own.get(m, 0.0) for m in part)
            found |= dict.fromkeys(part, total)
        return found

    def _given(self, link: Link, ends: list[int]) -> float:
        joint, solids = link.joint, self.solids
        if joint.motor is not None:
            speed = abs(units.magnitude(joint.motor.speed))
            if joint.kind == "slider":
                return speed
            return speed * min(shapes.radius(solids[m].shape) + math.dist(solids[m].position, link.begin) for m in ends)
        if joint.kind == "spring" and joint.stiffness is not None:
            lightest = min(shapes.mass(solids[m]) for m in ends)
            return abs(link.length - link.rest) * math.sqrt(joint.stiffness / lightest)
        return 0.0


def _makes_one(link: Link, solids: Sequence[Solid]) -> bool:
    """Whether a joint is a weld of two objects that move as one rigid body: nothing else moves or holds them, and contact knows
    their shapes, as it has to know that they do not touch each other."""
    joint = link.joint
    if joint.kind != "weld" or link.second == NOTHING or joint.stiffness is not None or joint.breaks is not None:
        return False
    return all(
        is_rigid(s) and not s.hold and not s.drag and not isinstance(s.shape, PieceShape) and is_known(s)
        for s in (solids[m] for m in link.ends)
    )


def play(link: Link) -> float:
    """How far both points of a joint may come apart [m]."""
    joint = link.joint
    if joint.kind == "slider":
        return link.way
    if joint.kind == "spring":  # a rod or a cable is as hard as a joint
        return math.inf if joint.stiffness is not None else HAIR * link.rest
    return 0.0


def parts(groups: Iterable[list[int]]) -> list[list[int]]:
    """Numbers that hang together by groups of them, each part ascending."""
    root: dict[int, int] = {}

    def find(m: int) -> int:
        while root.setdefault(m, m) != m:
            root[m] = root[root[m]]
            m = root[m]
        return m

    for first, *others in groups:
        find(first)
        for other in others:
            a, b = find(first), find(other)
            root[max(a, b)] = min(a, b)
    found: dict[int, list[int]] = {}
    for m in sorted(root):
        found.setdefault(find(m), []).append(m)
    return list(found.values())


@once_for(lambda scene: scene)
def links_of(scene: SceneRecord) -> Links:
    """The joints of a scene, found once."""
    return Links(scene)
