# SPDX-License-Identifier: GPL-2.0-only
"""The scene as plain frozen records, in SI units: what the language says, not how it is computed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from pathlib import Path

from ..errors import Span

Vector = tuple[float, float, float]


# --- shapes: body frame, centre of mass at the origin, axes of revolution along z -------------------------


@dataclass(frozen=True, slots=True)
class Box:
    """A cuboid."""

    size: Vector
    """Edge lengths [m]."""


@dataclass(frozen=True, slots=True)
class Sphere:
    """A ball."""

    radius: float
    """[m]"""


@dataclass(frozen=True, slots=True)
class Ellipsoid:
    """An ellipsoid."""

    radii: Vector
    """Half axes [m]."""


@dataclass(frozen=True, slots=True)
class Cylinder:
    """A circular cylinder, axis along z."""

    radius: float
    """[m]"""
    height: float
    """[m]"""


@dataclass(frozen=True, slots=True)
class Cone:
    """A circular cone, apex up (+z); its centre of mass is height/4 above the base."""

    radius: float
    """Of the base [m]."""
    height: float
    """[m]"""


@dataclass(frozen=True, slots=True)
class Torus:
    """A ring around z."""

    major: float
    """Radius of the centre line [m]."""
    minor: float
    """Radius of the tube [m]."""


@dataclass(frozen=True, slots=True)
class Mesh:
    """A closed triangle mesh from an STL, OBJ or PLY file; axes as in the file."""

    path: Path
    """Absolute path."""
    scale: float = 1.0
    """Metres per unit of the file."""


Shape = Box | Sphere | Ellipsoid | Cylinder | Cone | Torus | Mesh


# --- objects ----------------------------------------------------------------------------------------------


class Side(Enum):
    """A face of the bounding box of an object in its own frame."""

    MINUS_X, PLUS_X, MINUS_Y, PLUS_Y, MINUS_Z, PLUS_Z = "-x", "+x", "-y", "+y", "-z", "+z"


@dataclass(frozen=True, slots=True)
class HoldFaces:
    """Particles on these faces (body frame) never move; ``faces x`` is both ``-x`` and ``+x``."""

    sides: tuple[Side, ...]


@dataclass(frozen=True, slots=True)
class HoldAll:
    """No particle of the object ever moves."""


@dataclass(frozen=True, slots=True)
class HoldWithin:
    """Particles inside this box (world frame, at the start) never move."""

    low: Vector
    """[m]"""
    high: Vector
    """[m]"""


Hold = HoldFaces | HoldAll | HoldWithin


@dataclass(frozen=True, slots=True)
class Young:
    """Elasticity as Young's modulus."""

    modulus: float
    """[Pa]"""


@dataclass(frozen=True, slots=True)
class SpringConstant:
    """Elasticity as the paper writes it: one k for every spring, Wcislo 1999, eq. (3.6)."""

    k: float
    """[N/m]"""


@dataclass(frozen=True, slots=True)
class Solid:
    """One elastic object."""

    name: str
    """``cube`` or ``ball[12]``."""
    shape: Shape
    position: Vector
    """Centre of mass [m]."""
    rotation: tuple[Vector, Vector, Vector]
    """Rotation matrix, rows; world = rotation @ body."""
    elasticity: Young | SpringConstant
    mass: float | None = None
    """[kg]; exactly one of mass and density is given."""
    density: float | None = None
    """[kg/m^3]"""
    damping: float = 0.0
    """Fraction of critical damping at the bond level [-]."""
    velocity: Vector = (0.0, 0.0, 0.0)
    """[m/s]"""
    spin: Vector = (0.0, 0.0, 0.0)
    """Angular velocity, world frame [rad/s]."""
    drag: float = 0.0
    """lambda of the whole object, eq. (3.9) [N*s/m]."""
    hold: tuple[Hold, ...] = ()
    color: str | None = None
    """``#rrggbb``; None lets the renderer choose."""
    spans: Mapping[str, Span] = field(default_factory=dict, compare=False, repr=False)
    """Where each keyword's value stands; ``spans["object"]`` is the object's name."""


class LiquidModel(Enum):
    SURFACE = "surface"
    """Lift by the part of each particle's volume below the surface."""
    PRESSURE = "pressure"
    """The same liquid, lift by its pressure on the outer faces: for open hulls."""
    PAPER = "paper"
    """The paper's rules, word by word."""


@dataclass(frozen=True, slots=True)
class Liquid:
    """The one liquid of a scene."""

    name: str
    low: Vector
    """Lower corner of the basin [m]."""
    high: Vector
    """Upper corner of the basin [m]."""
    density: float
    """[kg/m^3]"""
    volume: float | None = None
    """[m^3]; exactly one of volume and level is given."""
    level: float | None = None
    """Initial height of the surface [m]."""
    drag: float | None = None
    """gamma [1/s]; None is ``auto``."""
    model: LiquidModel = LiquidModel.SURFACE
    sweeps: int | None = None
    """Automaton sweeps per update; None is ``auto``."""
    fill: tuple[Vector, Vector] | None = None
    """Lower and upper corner of the part of the basin that the liquid starts in [m]; None is all of it."""
    color: str | None = None
    """``#rrggbb``; None lets the renderer choose."""
    spans: Mapping[str, Span] = field(default_factory=dict, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Walls:
    """A box that objects never leave."""

    low: Vector
    """[m]"""
    high: Vector
    """[m]"""


# --- control, pictures, self-checks -----------------------------------------------------------------------


class Accuracy(Enum):
    """Points on the curve of error over time that `study` finds; what they cost and give stands in docs/accuracy.md."""

    PREVIEW = "preview"
    BALANCED = "balanced"
    REFERENCE = "reference"

    @property
    def cells(self) -> int:
        """Cells across the thinnest part of the scene."""
        return {Accuracy.PREVIEW: 2, Accuracy.BALANCED: 4, Accuracy.REFERENCE: 8}[self]

    @property
    def fraction(self) -> float:
        """Time step over the certified bound: energy drifts by at most 1e-2, 1e-3, 1e-4 in scenes that lose none."""
        return {Accuracy.PREVIEW: 0.7, Accuracy.BALANCED: 0.5, Accuracy.REFERENCE: 0.25}[self]


class Save(Enum):
    ALL = "all"
    BOUNDARY = "boundary"


class Switch(Enum):
    ON = "on"
    OFF = "off"
    AUTO = "auto"


@dataclass(frozen=True, slots=True)
class Control:
    """Duration, frames, accuracy: everything that is neither an object nor a picture."""

    time: float
    """Simulated duration [s]."""
    frames: float = 30.0
    """Frames per simulated second [1/s]."""
    timestep: float | None = None
    """[s]; None is ``auto``."""
    resolution: float | None = None
    """Particle spacing [m]; None is ``auto``."""
    accuracy: Accuracy | float = Accuracy.BALANCED
    """A class, or a target error as a fraction (``error 2 %`` is 0.02)."""
    contact_stiffness: float = 1.0
    """What objects and walls push back with, over E h [-]."""
    seed: int = 1
    save: Save = Save.ALL
    single: bool = False
    """Trajectory in single precision."""
    spans: Mapping[str, Span] = field(default_factory=dict, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Camera:
    """One point of the camera's path."""

    eye: Vector
    """[m]"""
    look: Vector | str
    """A point [m], or the name of an object that the camera follows."""
    time: float | None = None
    """[s]; None for a camera that stands still."""
    up: Vector = (0.0, 0.0, 1.0)


@dataclass(frozen=True, slots=True)
class Render:
    """How the pictures look; every None is chosen automatically."""

    size: tuple[int, int] = (1280, 720)
    movie: str | None = None
    background: str | None = None
    camera: tuple[Camera, ...] = ()
    liquid: str = "smooth"
    """``smooth`` or ``cells``: how the surface of the liquid is drawn."""
    spans: Mapping[str, Span] = field(default_factory=dict, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Expect:
    """A self-check, evaluated after the run."""

    subject: str
    """Object name, ``liquid``, ``energy`` or ``penetration``."""
    quantity: str
    """``position.z``, ``velocity.x``, ``draft``, ``strain.max``, ``residual``, ``max`` ..."""
    value: float
    """SI."""
    tolerance: float = 0.0
    """SI, >= 0."""
    time: float | None = None
    """[s]; None is the end of the run (``strain.max``, ``penetration.max``, residuals: the whole run)."""
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Scene:
    """A whole scene, validated word by word; geometry is checked when models are made."""

    name: str
    """Stem of the file name: ``beam`` for ``beam.txt``."""
    control: Control
    title: str = ""
    gravity: Vector = (0.0, 0.0, 0.0)
    """[m/s^2]"""
    solids: tuple[Solid, ...] = ()
    liquid: Liquid | None = None
    ground: float | None = None
    """Height of the ground plane [m]."""
    walls: Walls | None = None
    effects: Mapping[str, Switch] = field(default_factory=dict)
    """Only what ``effects { }`` says; everything else is ``auto``."""
    render: Render = Render()
    expects: tuple[Expect, ...] = ()
    path: Path | None = field(default=None, compare=False)
    """The file that was read, absolute."""
    spans: Mapping[str, Span] = field(default_factory=dict, compare=False, repr=False)
    """Places of ``gravity``, ``ground``, ``walls``, ``effects.NAME`` ..."""
    warnings: tuple = field(default=(), compare=False)
    """Problems of severity ``warning`` that were found while reading."""
