# SPDX-License-Identifier: GPL-2.0-only
"""Actions on the solids of a scene from outside, as effects declare them: forces that pull, stop, slow and carry solids."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from functools import cached_property
from typing import Protocol

import numpy as np

from ..errors import Span
from ..model.planes import Plane, closest, innermost
from ..model.system import System
from ..records import dataclass
from ..scene.scene import SceneRecord
from ..scene.schema import Vector


class Bodies(Protocol):
    """Data of M solids that are known before their models are made."""

    radius: np.ndarray
    """Radius of a sphere around the centre of mass that holds each solid [m], shape (M,)."""
    density: np.ndarray
    """[kg/m^3], shape (M,)."""
    mass: np.ndarray
    """[kg], shape (M,)."""


@dataclass(frozen=True, slots=True)
class Drive:
    """Bounds of a motion that an effect gives the held particles of a solid."""

    low: tuple[float, float, float]
    """How far the box around them may reach beyond that at the start, at least along each axis [m]."""
    high: tuple[float, float, float]
    """The same at most [m]."""
    speed: float
    """Largest speed of any of them [m/s]."""
    span: Span | None = None
    """Where the scene says so; None where it stands nowhere."""


@dataclass(frozen=True, slots=True)
class Leash:
    """Bounds of the motion of a solid that something holds."""

    point: tuple[float, float, float]
    """A point that never moves [m]."""
    length: float
    """Its centre of mass is no farther from that point [m]; infinite where it may go anywhere."""
    speed: float
    """Speed that it may be given besides that of its start and its fall [m/s]."""


@dataclass(frozen=True, slots=True)
class Hung:
    """Solids that hang together for good."""

    first: int
    """The heaviest of them."""
    sinks: Mapping[int, float]
    """Height of the fall in which each would get the energy that joints let all of them lose if that one stays as it is [m]."""


@dataclass(frozen=True, slots=True)
class Throw:
    """Bounds of what forces that act wherever a solid is give to it."""

    speed: float
    """Speed that they give any point of it until the end [m/s]."""
    acceleration: float
    """Largest acceleration of any point of it by them [m/s^2]."""
    lasting: float = math.inf
    """Speed that they give it however long the scene goes on [m/s]."""
    push: float = math.inf
    """Largest acceleration by which they give it that speed [m/s^2]; infinite where it has the speed at once."""
    cause: str = ""
    """Words for what it gets the speed by; empty where nothing is told of it."""
    way_out: str = ""
    """Words that give it a lower speed."""
    span: Span | None = None
    """Where the scene says so."""

    def within(self, way: float) -> float:
        """Speed that they give to it within a way [m] from rest: v^2 = 2 a s at most [m/s]."""
        return self.lasting if math.isinf(self.push) else min(self.lasting, math.sqrt(2.0 * self.push * way))


def by(thrower: Throw | None) -> str:
    """Words for what gives a speed, after the speed; empty for none."""
    return f" by {thrower.cause}" if thrower else ""


class Motion:
    """How an effect moves solids; all of it may be asked of any scene."""

    guides = ""
    """ID of its fix mdanim/drive, which tells other fixes where held objects are that it drives; empty where it drives nothing,
    or where particles alone show where these are."""
    binds = False
    """Whether it holds the particles of a solid together."""

    def acceleration(self, scene: SceneRecord) -> np.ndarray | None:
        """Acceleration that it gives to everything that is free to move [m/s^2], shape (3,); None for nothing."""
        return None

    def accelerations(self, scene: SceneRecord) -> tuple[np.ndarray, np.ndarray] | None:
        """Least and largest `acceleration` along each axis until the end [m/s^2], each of shape (3,); None for nothing."""
        a = self.acceleration(scene)
        return None if a is None else (a, a)

    def swing(self, scene: SceneRecord) -> float:
        """Speed that an acceleration that changes gives besides that of a fall [m/s]: the most between any two moments."""
        return 0.0

    def planes(self, scene: SceneRecord) -> tuple[Plane, ...]:
        """The planes that push solids back, whether the effect is on or not."""
        return ()

    def slows(self, scene: SceneRecord) -> np.ndarray | None:
        """Solids that it slows down wherever they are, bool, shape (M,)."""
        return None

    def rough(self, scene: SceneRecord) -> np.ndarray | None:
        """Solids that its planes may push along themselves, bool, shape (M,)."""
        return None

    def pushes_below(self, scene: SceneRecord) -> float:
        """Height below which it may push solids in any direction [m]; minus infinity where it does so nowhere."""
        return -math.inf

    def most_push(self, scene: SceneRecord, bodies: Bodies) -> np.ndarray | float:
        """Largest force of that kind on each solid over its mass [m/s^2], shape (M,)."""
        return 0.0

    def throws(self, scene: SceneRecord) -> Mapping[int, Throw]:
        """Solids that it pushes in any direction wherever they are, by number, and how fast they may get by that."""
        return {}

    def surface(self, scene: SceneRecord) -> float | None:
        """Height below which solids are immersed in it [m]; None where it immerses nothing."""
        return None

    def lift(self, scene: SceneRecord, system: System) -> np.ndarray | float:
        """Part of the mass of each immersed solid that it carries [kg], shape (M,)."""
        return 0.0

    def impulses(self, scene: SceneRecord, mass: np.ndarray, times: np.ndarray, center: np.ndarray) -> np.ndarray | None:
        """Momentum that it has given to each solid up to each frame [N s], shape (F, M, 3), where that follows from masses [kg],
        shape (M,), times [s], shape (F,), and centres of mass [m], shape (F, M, 3), alone; None for nothing."""
        return None

    def untold(self, scene: SceneRecord) -> Mapping[int, str]:
        """Solids, by number, of which frames do not tell its forces from those of contact, each with the reason."""
        return {}

    def mutual(self, scene: SceneRecord) -> Collection[int]:
        """Solids among those of `untold`, by number, on which its forces add up to zero."""
        return ()

    def joins(self, scene: SceneRecord) -> Iterable[tuple[int, int]]:
        """Pairs of solids, by number, that it couples wherever they are: one process simulates both."""
        return ()

    def unites(self, scene: SceneRecord) -> Iterable[Sequence[int]]:
        """Groups of solids, by number and ascending, of which each moves as one rigid body at all times."""
        return ()

    def holds(self, scene: SceneRecord) -> Mapping[int, Leash | None]:
        """Solids that it holds at each other or at something that never moves, by number, and how far they may go, where that is
        known."""
        return {}

    def hangs(self, scene: SceneRecord) -> Iterable[Hung]:
        """Groups of solids that it holds together; what it unites is in one of them."""
        return ()

    def passes(self, scene: SceneRecord) -> Iterable[tuple[int, int]]:
        """Pairs of solids i < j, by number, that may be in each other because of it: no contact acts between them."""
        return ()

    def drives(self, scene: SceneRecord) -> Mapping[int, Drive]:
        """Motions that it gives to the held particles of solids, by number. Its fix, in the group `Context.pushed`, sets their
        positions and velocities, and counts the work that they do."""
        return {}

    def belts(self, scene: SceneRecord) -> Mapping[int, Vector]:
        """Velocities at which surfaces run over solids that it holds, by number [m/s]; friction sees them."""
        return {}


class Acting:
    """The declarations of several effects together."""

    def __init__(self, scene: SceneRecord, effects: Iterable[Motion]):
        self.scene, self.effects = scene, tuple(effects)
        self.planes = tuple(p for e in self.effects for p in e.planes(scene))
        """Planes that push solids back."""
        self.bound = any(e.binds for e in self.effects)
        """Whether the particles of a solid hold together."""

    @cached_property
    def acceleration(self) -> np.ndarray:
        """Acceleration of everything that is free to move, at the start [m/s^2], shape (3,)."""
        return sum((a for e in self.effects if (a := e.acceleration(self.scene)) is not None), np.zeros(3))

    @cached_property
    def accelerations(self) -> tuple[np.ndarray, np.ndarray]:
        """The least and the largest along each axis until the end [m/s^2], each of shape (3,)."""
        told = [a for e in self.effects if (a := e.accelerations(self.scene)) is not None]
        return sum((low for low, _ in told), np.zeros(3)), sum((high for _, high in told), np.zeros(3))

    @property
    def changes(self) -> bool:
        """Whether the acceleration changes with time."""
        low, high = self.accelerations
        return bool((low != high).any())

    @property
    def strongest(self) -> float:
        """No acceleration of everything is larger [m/s^2]."""
        low, high = self.accelerations
        return float(np.linalg.norm(np.maximum(np.abs(low), np.abs(high)) if self.changes else self.acceleration))

    @cached_property
    def strongest_of_any(self) -> float:
        """The same with what pushes single solids [m/s^2]."""
        return self.strongest + float(self.thrown_by.max(initial=0.0))

    @cached_property
    def swing(self) -> float:
        """Speed that changes of the acceleration give, besides that of a fall [m/s]."""
        return sum((e.swing(self.scene) for e in self.effects), 0.0)

    @property
    def g(self) -> float:
        """Acceleration downwards, the largest [m/s^2]."""
        return max(0.0, -float(self.accelerations[0][2]))

    @cached_property
    def limits(self) -> tuple[np.ndarray, np.ndarray]:
        """As `innermost`."""
        return innermost(self.planes)

    @cached_property
    def touched(self) -> tuple[np.ndarray, np.ndarray]:
        """As `closest`."""
        return closest(self.planes)

    @cached_property
    def stirred(self) -> float:
        """Speed that planes which move may give to solids in a blow [m/s]: twice their own."""
        return 2.0 * max((p.motion.speed for p in self.planes if p.motion), default=0.0)

    @cached_property
    def slowed(self) -> np.ndarray:
        """Solids that are slowed down wherever they are, bool, shape (M,)."""
        return self._any(e.slows(self.scene) for e in self.effects)

    @cached_property
    def rough(self) -> np.ndarray:
        """Solids that planes may push along themselves, bool, shape (M,)."""
        return self._any(e.rough(self.scene) for e in self.effects)

    @cached_property
    def joined(self) -> np.ndarray:
        """Solids that something holds, or pulls at which another solid moves, bool, shape (M,)."""
        found = np.zeros(len(self.scene.solids), bool)
        found[[m for e in self.effects for pair in e.joins(self.scene) for m in pair]] = True
        found[list(self.leashes)] = True
        return found

    @cached_property
    def leashes(self) -> dict[int, Leash | None]:
        """As `Motion.holds`, of all effects."""
        return {m: leash for e in self.effects for m, leash in e.holds(self.scene).items()}

    @cached_property
    def room(self) -> tuple[np.ndarray, np.ndarray]:
        """Box in which the centre of each solid stays by its leash [m], each of shape (M, 3); infinite without one."""
        low = np.full((len(self.scene.solids), 3), -np.inf)
        high = -low
        for m, leash in self.leashes.items():
            if leash is not None:
                low[m], high[m] = np.array(leash.point) - leash.length, np.array(leash.point) + leash.length
        return low, high

    @cached_property
    def given(self) -> np.ndarray:
        """Speed that what holds each solid, and planes that move, may give to it [m/s], shape (M,)."""
        found = np.full(len(self.scene.solids), self.stirred)
        for m, leash in self.leashes.items():
            found[m] += leash.speed if leash is not None else 0.0
        return found

    @cached_property
    def thrown_at(self) -> np.ndarray:
        """Speed that what pushes each solid wherever it is may give to it until the end [m/s], shape (M,)."""
        return _of_throws(self, lambda m, throw: throw.speed)

    @cached_property
    def thrown_by(self) -> np.ndarray:
        """Acceleration that what pushes single solids gives to each [m/s^2], shape (M,)."""
        return _of_throws(self, lambda m, throw: throw.acceleration)

    @cached_property
    def throws(self) -> tuple[tuple[int, Throw], ...]:
        """As `Motion.throws`, of all effects one after another."""
        return tuple(one for e in self.effects for one in e.throws(self.scene).items())

    @cached_property
    def acted_on(self) -> np.ndarray:
        """Solids that are `joined`, or that are pushed wherever they are, bool, shape (M,)."""
        found = self.joined.copy()
        found[[m for m, _ in self.throws]] = True
        return found

    @cached_property
    def passing(self) -> frozenset[tuple[int, int]]:
        """Pairs of solids i < j that may be in each other: no contact acts between them."""
        return frozenset(pair for e in self.effects for pair in e.passes(self.scene))

    @cached_property
    def drives(self) -> dict[int, Drive]:
        """Motions of held particles, by the numbers of their solids."""
        return {m: drive for e in self.effects for m, drive in e.drives(self.scene).items()}

    @cached_property
    def guided(self) -> dict[int, str]:
        """IDs of the fixes that tell where solids are that are driven, by their numbers."""
        return {m: e.guides for e in self.effects if e.guides for m in e.drives(self.scene)}

    @cached_property
    def driven_at(self) -> np.ndarray:
        """Speed at which the held particles of each solid may be moved [m/s], shape (M,)."""
        found = np.zeros(len(self.scene.solids))
        for m, drive in self.drives.items():
            found[m] = drive.speed
        return found

    def _any(self, told: Iterable[np.ndarray | None]) -> np.ndarray:
        found = np.zeros(len(self.scene.solids), bool)
        for solids in told:
            if solids is not None:
                found |= solids
        return found

    @cached_property
    def wet_below(self) -> float:
        """Height below which solids are pushed about in any direction [m]; minus infinity where nothing does so."""
        return max((e.pushes_below(self.scene) for e in self.effects), default=-np.inf)

    @cached_property
    def surface(self) -> float | None:
        """Height below which something carries solids [m]; None where nothing does."""
        return next((z for e in self.effects if (z := e.surface(self.scene)) is not None), None)

    def lift(self, system: System) -> np.ndarray:
        """Part of the mass of each immersed solid that is carried [kg], shape (M,)."""
        return sum((e.lift(self.scene, system) for e in self.effects), np.zeros(len(system.names)))

    def most_pull(self, bodies: Bodies) -> np.ndarray:
        """Largest force from outside on each solid over its mass [m/s^2], shape (M,)."""
        return np.full(len(bodies.mass), self.strongest) + sum(e.most_push(self.scene, bodies) for e in self.effects)


def _of_throws(acting: Acting, of: Callable[[int, Throw], float]) -> np.ndarray:
    found = np.zeros(len(acting.scene.solids))
    for m, throw in acting.throws:
        found[m] += of(m, throw)
    return found


def thrown_within(acting: Acting, way: np.ndarray) -> np.ndarray:
    """Speed that what pushes each solid may give to it within a way [m], shape (M,), however long the scene goes on [m/s],
    shape (M,)."""
    return _of_throws(acting, lambda m, throw: throw.within(float(way[m])))


def thrower_of(acting: Acting, m: int, speed: float, *, others: bool = False) -> Throw | None:
    """The throw that gives a solid, or with ``others`` one that it meets, most of a speed [m/s]; None where others do."""
    told = [one for k, one in acting.throws if one.cause and one.speed > 0.5 * speed and (others or k == m)]
    return max(told, key=lambda one: one.speed, default=None)
