# SPDX-License-Identifier: GPL-2.0-only
"""How hard a hand pulls, and how fast it goes (docs/physics-drives.md, "Hands").

A hand is a spring and a damper between a point of an object and a place. In the scale of the object, its mass M, its radius r and
the acceleration g that it has to be held against:

    w^2 = 4 g/r,   k = M w^2,   c = 2 M w,   F <= 3 M g,   u <= w r

so an object at rest hangs a quarter of its radius below the hand, without swinging. A hand has the speed u at most, that of a
fall by two radii, and a tenth of the speed of waves in what deforms. At a part that deforms such a hand would be too hard for the
time step: there k and c are as large as limits of the squared frequency and of the rate of the part permit, which are in the
certificate.
"""

from __future__ import annotations

import math

import numpy as np

from ...effects.context import Context
from ...model import shapes
from ...model.inertia import largest_mobility
from ...model.springs import equivalent_modulus
from ...reach import Throw
from ...reach.reach import wave_speed
from ...records import dataclass
from ...scene.holding import all_held
from ...scene.once import once_for
from ..joints.links import links_of
from ..joints.patches import patch_of
from ..joints.strength import RigidPart
from .words import Hand

SAG = 0.25
"""Distance of an object that hangs at a hand from the hand, over its radius."""
FREE = 10.0
"""Radii per squared second to which objects are accelerated without gravity [1/s^2]."""
STRONGEST = 3.0
"""Largest force, over the weight."""
OF_WAVES = 0.1
"""Largest speed of a hand, over that of waves in what deforms."""
SLOWER = 0.999
"""Speed of the hand of a page, over the largest: with its lines the certificate stays the same to the last bit."""
RESOLVED = 10.0
"""Steps in a time 1/w."""
GRASP = 0.5
"""Radius of the part that a hand holds on to, over half of the thinnest extent."""
HARDEST, STIFFEST = 0.3, 0.2
"""Frequency and rate of a part at a hand, over that of waves across a cell."""


@dataclass(frozen=True)
class Scale:
    """Strength of a hand at one object as a whole, with all that is welded to it as one rigid body."""

    mass: float
    """[kg]"""
    radius: float
    """[m]"""
    frequency: float
    """w [1/s]"""
    most: float
    """Largest force [N]."""
    speed: float
    """Largest speed of a hand [m/s]."""


@once_for(lambda scene: scene)
def scales(scene) -> dict[int, Scale]:
    """Scales of all objects that may be pulled at, by their numbers: with ``hands on`` of all that can move."""
    named = {hand.object for hand in scene.held_by}
    found: dict[int, Scale] = {}
    sizes: dict[int, tuple[float, float]] = {}
    for m, solid in enumerate(scene.solids):
        if all_held(solid) or not (scene.steerable or solid.name in named):
            continue
        body = _body(scene, m)
        if body[0] not in sizes:
            sizes[body[0]] = _size(scene, body)
        mass, radius = sizes[body[0]]
        pulled = max(_gravity(scene), FREE * radius)
        frequency = math.sqrt(pulled / (SAG * radius))
        waves = math.sqrt(equivalent_modulus(np.ones(3), solid.elasticity) * shapes.volume(solid.shape) / mass)
        found[m] = Scale(mass, radius, frequency, STRONGEST * mass * pulled, min(frequency * radius, OF_WAVES * waves))
    return found


def _body(scene, m: int) -> list[int]:
    """Objects that move with one as one rigid body, itself among them."""
    return links_of(scene).whole_of.get(m, [m]) if scene.joints else [m]


def _size(scene, members: list[int]) -> tuple[float, float]:
    """Mass [kg], and radius of the sphere around what moves as one body [m]."""
    solids = [scene.solids[m] for m in members]
    if len(solids) == 1:
        return shapes.mass(solids[0]), shapes.radius(solids[0].shape)
    masses, places = np.array([shapes.mass(s) for s in solids]), np.array([s.position for s in solids])
    away = np.linalg.norm(places - np.average(places, axis=0, weights=masses), axis=1)
    return float(masses.sum()), float(max(far + shapes.radius(s.shape) for far, s in zip(away.tolist(), solids)))


def _gravity(scene) -> float:
    """Largest acceleration of free fall [m/s^2]."""
    return max(math.hypot(*g) for g in (scene.gravity, *(g for _, g in scene.gravity_path)))


def throws(scene) -> dict[int, Throw]:
    """The most speed and acceleration that hands give each object, which is as fast as its hand when it follows."""
    found = {}
    for m, scale in scales(scene).items():
        solid = scene.solids[m]
        own = [hand for hand in scene.held_by if hand.object == solid.name]
        speed = max([scale.speed, *map(speed_of, own)])
        place = own[0].spans.get("hand") if own else scene.spans.get("hands")
        found[m] = Throw(speed, scale.most / scale.mass, speed, scale.most / scale.mass, span=place)
    return found


def speed_of(hand: Hand) -> float:
    """Largest speed of a hand of a scene [m/s]."""
    return max((math.dist(b.at, a.at) / (b.time - a.time) for a, b in zip(hand.keys, hand.keys[1:])), default=0.0)


# --- by the particles -------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Grip:
    """A hand at a point of an object, before it goes anywhere."""

    rows: np.ndarray
    """Particles of the system that it holds on to, int64, shape (P,)."""
    weights: np.ndarray
    """Part of each in the place of the point and in the force, shape (P,)."""
    stiffness: float
    """[N/m]"""
    damping: float
    """[N*s/m]"""
    most: float
    """Largest force [N]."""

    @property
    def words(self) -> str:
        """In the words of the fix, without keys."""
        particles = " ".join(f"{row + 1} {weight!r}" for row, weight in zip(self.rows.tolist(), self.weights.tolist()))
        return f"stiffness {self.stiffness!r} damping {self.damping!r} most {self.most!r} particles {len(self.rows)} {particles}"


@once_for(lambda context: context)
def limits(context: Context) -> tuple[np.ndarray, np.ndarray]:
    """Squared frequency [1/s^2] and rate [1/s] that a hand gives to any part of each object at most, each of shape (M,); 0 of
    those that no hand may pull at."""
    system = context.system
    squared, rate = np.zeros(len(system.names)), np.zeros(len(system.names))
    for m, scale in _here(context).items():
        if system.rigid[m]:
            own = system.position[system.first[m] : system.first[m + 1]]
            easier = scale.mass * float(_mobilities(context, m, own).max())
            squared[m], rate[m] = easier * scale.frequency**2, 2.0 * easier * scale.frequency
        else:
            lattice = float(wave_speed(system)[m] / system.spacing[m])
            squared[m], rate[m] = (HARDEST * lattice) ** 2, STIFFEST * lattice
    return squared, rate


def grip(context: Context, m: int, point: np.ndarray) -> Grip:
    """A hand at a point [m], shape (3,), of an object of the system, by number, as that is at the start."""
    system, scale = context.system, _here(context)[m]
    low, high = shapes.extent(context.solids[m].shape)
    patch = patch_of(system, m, point, GRASP * 0.5 * float(np.min(np.subtract(high, low))))
    weights = patch.of_point(point)
    easier = float(_mobilities(context, m, point[None])[0]) if system.rigid[m] else float((weights**2 / patch.mass).sum())
    squared, rate = (of[m] for of in limits(context))
    stiffness = min(scale.mass * scale.frequency**2, float(squared) / easier)
    damping = min(2.0 * math.sqrt(scale.mass * stiffness), float(rate) / easier)
    return Grip(patch.rows, weights, stiffness, damping, scale.most)


@once_for(lambda context: context)
def _here(context: Context) -> dict[int, Scale]:
    """The scales of the objects of a context, by their numbers in its system."""
    of = scales(context.scene)
    return {m: of[k] for m, k in enumerate(_numbers(context)) if k in of}


@once_for(lambda context, first: context)
def _welded(context: Context, first: int) -> RigidPart:
    """All that is welded to the first object of a body of the scene."""
    return RigidPart.of(context, _body(context.scene, first))


@once_for(lambda context: context)
def _numbers(context: Context) -> list[int]:
    """The number of each object of the system in the scene."""
    number = {solid.name: k for k, solid in enumerate(context.scene.solids)}
    return [number[name] for name in context.system.names]


def _mobilities(context: Context, m: int, points: np.ndarray) -> np.ndarray:
    """The largest velocity of points of a rigid object [m], shape (P, 3), for an impulse of 1 on them [1/kg], shape (P,)."""
    system, body = context.system, _body(context.scene, _numbers(context)[m])
    if len(body) > 1:
        part = _welded(context, body[0])
        return largest_mobility(part.tensor, _here(context)[m].mass, points - part.centre)
    own = slice(system.first[m], system.first[m + 1])
    centre = system.mass[own] @ system.position[own] / system.mass[own].sum()
    return largest_mobility(system.inertia[m], float(system.mass_of[m]), points - centre)
