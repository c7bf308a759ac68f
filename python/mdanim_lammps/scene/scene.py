# SPDX-License-Identifier: GPL-2.0-only
"""The scene as plain frozen records, in SI units: what the language says, not how it is computed."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from ..errors import Span
from ..features import facets
from .formatting import number, vector
from .limits import CONTACT_DAMPING, CONTACT_STIFFNESS, DAMPING, DROPS, FRICTION, SWEEPS
from .render import COLOR, Camera, Render  # noqa: F401
from .rotation import IDENTITY, departure, rotation_about, rotation_euler
from .schema import BOX, Codec, Keyword, Observable, OneOf, Rule, Vector, Worded, Words, setting, with_words
from .shapes import (
    Box,
    Cone,
    Cylinder,
    Ellipsoid,
    Hold,
    HoldAll,
    HoldFaces,
    HoldWithin,
    Mesh,
    Shape,
    Side,  # noqa: F401
    Sphere,
    SpringConstant,
    Torus,
    Young,
)

# --- objects ----------------------------------------------------------------------------------------------


class Orientation(Codec):
    """An axis and an angle, three angles, or a matrix; the record holds the matrix."""

    def read(self, k: Keyword, choice: int, values: tuple) -> tuple[Vector, Vector, Vector]:
        if choice == 1:
            return rotation_euler(values[0])
        if choice == 0:
            axis, angle = values
            length = math.hypot(*axis)
            if not 1e-150 < length < 1e150:
                raise ValueError(f"the axis of a rotation needs a direction, found {vector(axis)}", "e.g. axis (0, 0, 1)", 0)
            return rotation_about(tuple(c / length for c in axis), angle)
        if departure(values) > 1e-9:
            cause = "this matrix is not a rotation: its rows are not orthonormal and right-handed"
            raise ValueError(cause, "write orientation axis (x, y, z) angle a", None)
        return values

    def write(self, k: Keyword, value: Any) -> tuple[int, tuple]:
        return (0, ((0, 0, 1), 0)) if value == IDENTITY else (2, value)


@dataclass(frozen=True, slots=True)
class Solid:
    """One elastic object."""

    name: str
    """``cube`` or ``ball[12]``."""
    shape: Shape = setting(
        None,
        "Form of the object in its own frame: edge lengths, radii, heights along z. A mesh is a closed STL, OBJ or PLY file, "
        "beside the scene file; `scale` is metres per unit of the file, default 1. Colours of the points of a PLY file are drawn "
        "where the object has no `color`.",
        "sphere 10 cm", Rule.POSITIVE, codec=OneOf(Box, Sphere, Ellipsoid, Cylinder, Cone, Torus, Mesh))  # fmt: skip
    position: Vector = setting("<(x, y, z):m>", "Centre of mass.", "(0, 0, 1) m")
    """[m]"""
    rotation: tuple[Vector, Vector, Vector] = setting(
        "axis <(x, y, z)> angle <a:rad> | euler <(rx, ry, rz):rad> | matrix <(xx, xy, xz)> <(yx, yy, yz)> <(zx, zy, zz)>",
        "Rotation about the centre of mass. `euler` rotates about x, then y, then z, all fixed axes. `matrix` gives the rows of "
        "the rotation matrix (world = matrix * body); `scene.lock.txt` uses it.",
        "axis (1, 1, 0) angle 20 deg", name="orientation", absent=IDENTITY, codec=Orientation())  # fmt: skip
    """Rotation matrix, rows; world = rotation @ body."""
    elasticity: Young | SpringConstant = setting(
        None, "Young's modulus; or the paper's one k for every spring, Wcislo 1999, eq. (3.6).",
        "200 kPa", Rule.POSITIVE, codec=OneOf(Young, SpringConstant))  # fmt: skip
    mass: float | None = setting(
        "<m:kg>", "Mass of the whole object.", "2 kg", Rule.POSITIVE, default=None, one_of=("mass", "density"))  # fmt: skip
    """[kg]; exactly one of mass and density is given."""
    density: float | None = setting(
        "<rho:kg/m^3>", "Mass per volume.", "900 kg/m^3", Rule.POSITIVE, default=None, one_of=("mass", "density"))  # fmt: skip
    """[kg/m^3]"""
    damping: float = setting(
        "<zeta>", "Internal damping, as a fraction of critical damping in each spring.",
        "0.05", Rule.NOT_NEGATIVE, default=0.0, limit=DAMPING)  # fmt: skip
    """Fraction of critical damping at the bond level [-]."""
    velocity: Vector = setting("<(vx, vy, vz):m/s>", "Velocity at the start.", "(0, 0, -1) m/s", default=(0.0, 0.0, 0.0))
    """[m/s]"""
    spin: Vector = setting(
        "<(wx, wy, wz):rad/s>", "Angular velocity at the start, about the axes of the world.",
        "(0, 0, 2) rad/s", default=(0.0, 0.0, 0.0))  # fmt: skip
    """Angular velocity, world frame [rad/s]."""
    drag: float = setting(
        "<lambda:N*s/m>", "Air drag of the whole object, F = -lambda v, eq. (3.9).",
        "0.5 N*s/m", Rule.NOT_NEGATIVE, default=0.0)  # fmt: skip
    """lambda of the whole object, eq. (3.9) [N*s/m]."""
    friction: float | None = setting(
        "<mu>",
        "Coefficient of friction; two objects in touch have sqrt(mu_A mu_B), an object has its own against ground, walls and "
        "basin. Not with `contact-model paper`. Absent: that of `control`.",
        "0.4", Rule.NOT_NEGATIVE, default=None, limit=FRICTION)  # fmt: skip
    """mu [-]; None is that of the scene."""
    hold: tuple[Hold, ...] = setting(
        None,
        "Particles that never move: both faces across an axis of the object, one face, all of them (a wedge, an obstacle), or "
        "those inside a box of the world at the start.", "faces x", default=(), many=True,
        codec=OneOf(HoldFaces, HoldAll, HoldWithin))  # fmt: skip
    color: str | None = setting("<color>", f"Colour in pictures: {COLOR}", "steelblue", default=None)
    """``#rrggbb``; None lets the renderer choose."""
    spans: Mapping[str, Span] = field(default_factory=dict, compare=False, repr=False)
    """Where each keyword's value stands; ``spans["object"]`` is the object's name."""


@dataclass(frozen=True, slots=True)
class ContactPair:
    """The rule of contact where some objects touch some others, or a plane."""

    first: str
    """An object, all objects of a repeat, ``ground``, ``walls`` or ``basin``."""
    second: str
    friction: float | None = setting(
        "<mu>", "Coefficient of friction of these two. Absent: sqrt(mu_A mu_B), or that of the object against a plane.",
        "0.1", Rule.NOT_NEGATIVE, default=None, limit=FRICTION)  # fmt: skip
    """mu [-]; None is that of the two objects."""
    contact_damping: float | None = setting(
        "<beta>", "Damping of their contact. Absent: that of `control`.",
        "0.1", Rule.NOT_NEGATIVE, default=None, limit=CONTACT_DAMPING)  # fmt: skip
    """Share of critical damping [-]; None is that of the scene."""
    spans: Mapping[str, Span] = field(default_factory=dict, compare=False, repr=False)
    """Where each keyword's value stands; ``spans["contact"]`` is that of the names."""


class LiquidModel(Enum):
    WAVES = "waves"
    """A liquid with momentum."""
    SURFACE = "surface"
    """An automaton without momentum; lift by the part of each particle's volume below the surface."""
    PAPER = "paper"
    """The paper's rules, word by word."""


@dataclass(frozen=True, slots=True)
class Wave:
    """A paddle along a side of the basin."""

    FORMS: ClassVar = ("<-x|+x|-y|+y> amplitude <a:m> period <T:s>",)
    side: str
    amplitude: float
    """Amplitude of the waves that run off [m]."""
    period: float
    """[s]"""


@dataclass(frozen=True, slots=True)
class Current:
    """A current: liquid that goes out at the opposite side comes in at this one."""

    FORMS: ClassVar = ("<-x|+x|-y|+y> speed <u:m/s>",)
    side: str
    speed: float
    """[m/s]"""


@dataclass(frozen=True, slots=True)
class Inflow:
    """Liquid from outside."""

    FORMS: ClassVar = (f"{BOX} rate <q:m^3/s> [velocity <(vx, vy, vz):m/s>]",)
    low: Vector
    """[m]"""
    high: Vector
    """[m]"""
    rate: float
    """[m^3/s]"""
    velocity: Vector = (0.0, 0.0, 0.0)
    """[m/s]"""


@dataclass(frozen=True, slots=True)
class Drain:
    """Liquid to outside."""

    FORMS: ClassVar = (f"{BOX} rate <q:m^3/s>",)
    low: Vector
    """[m]"""
    high: Vector
    """[m]"""
    rate: float
    """[m^3/s]"""


@dataclass(frozen=True, slots=True)
class Liquid(Worded):
    """The one liquid of a scene."""

    name: str
    low: Vector = setting(
        BOX, "Solid floor and side walls; for objects the walls go on upward.",
        "from (-1, -1, 0) m to (1, 1, 1.2) m", name="basin", also=("high",))  # fmt: skip
    """Lower corner of the basin [m]."""
    high: Vector
    """Upper corner of the basin [m]."""
    density: float = setting("<rho:kg/m^3>", "Mass per volume.", "1000 kg/m^3", Rule.POSITIVE)
    """[kg/m^3]"""
    volume: float | None = setting(
        "<V:m^3>", "Volume, rounded to whole cells.",
        "2 m^3", Rule.POSITIVE, default=None, one_of=("volume", "level"))  # fmt: skip
    """[m^3]; exactly one of volume and level is given."""
    level: float | None = setting(
        "<z:m>", "Height of the surface at the start; hulls that reach above it are dry.", "0.5 m", default=None,
        one_of=("volume", "level"))  # fmt: skip
    """Initial height of the surface [m]."""
    fill: tuple[Vector, Vector] | None = setting(
        BOX, "Part of the basin that the liquid starts in, behind a dam that is gone at once. Absent: all of it.",
        "from (-1, -1, 0) m to (0, 1, 1.2) m", default=None)  # fmt: skip
    """Lower and upper corner of the part of the basin that the liquid starts in [m]; None is all of it."""
    drag: float | None = setting(
        "auto | <gamma:1/s>",
        "Immersed solids feel F = -gamma rho V v with the immersed volume V and the velocity v against the liquid; `auto` is "
        "gamma = sqrt(g/L) for a body of size L; with `model waves` 0.15 sqrt(g/L) + 0.25 v/L, so that what is slow glides on.",
        "4 1/s", Rule.NOT_NEGATIVE, default=None)  # fmt: skip
    """gamma [1/s]; None is ``auto``."""
    model: LiquidModel = setting(
        None,
        "`waves`: a liquid with momentum that splashes, sloshes and pushes; open hulls float dry. `surface`: the paper's "
        "automaton, which makes room, levels and lifts, and nothing else: quicker, and at rest at once. `paper`: the "
        "literal rules of the paper, with a warning: not Archimedes, objects denser than about 0.4 of the liquid sink.",
        "surface", default=LiquidModel.WAVES, codec=Words(LiquidModel),
        gone={"pressure": "write model waves, in which open hulls float by the air in them, or model surface"})  # fmt: skip
    calm: float | None = setting(
        "auto | <T:s>", "With `model waves`: time in which waves die to 1/e, besides by drag and depth; `auto` is 50 √(depth/g).",
        "20 s", Rule.POSITIVE, default=None)  # fmt: skip
    """Time in which waves die to 1/e [s]; None is ``auto``."""
    drops: float = setting(
        "<share>", "With `model waves`: share of what shoots up from impacts and fronts that flies as drops, and comes back.",
        "0.5", Rule.NOT_NEGATIVE, default=0.0, limit=DROPS)  # fmt: skip
    wave: tuple[Wave, ...] = setting(
        None, "With `model waves`: waves of this amplitude and period run into the basin from a side.",
        "-x amplitude 2 cm period 1 s", Rule.POSITIVE, default=(), many=True, codec=OneOf(Wave))  # fmt: skip
    current: tuple[Current, ...] = setting(
        None, "With `model waves`: liquid comes in at this side, and as much goes out at the opposite one.",
        "-x speed 20 cm/s", Rule.POSITIVE, default=(), many=True, codec=OneOf(Current))  # fmt: skip
    inflow: tuple[Inflow, ...] = setting(
        None, "With `model waves`: liquid comes into the columns of this box, at the height of its middle.",
        "from (-1, -1, 1) m to (-0.8, 1, 1) m rate 0.002 m^3/s", default=(), many=True, codec=OneOf(Inflow))  # fmt: skip
    drain: tuple[Drain, ...] = setting(
        None, "With `model waves`: liquid goes out of the columns of this box, at the height of its middle.",
        "from (0.8, -1, 0) m to (1, 1, 0) m rate 0.002 m^3/s", default=(), many=True, codec=OneOf(Drain))  # fmt: skip
    sweeps: int | None = setting(
        "auto | <n>", "Sweeps of the automaton per update; not with `model waves`.",
        "4", Rule.COUNT, default=None, limit=SWEEPS)  # fmt: skip
    """Automaton sweeps per update; None is ``auto``."""
    color: str | None = setting("<color>", f"Colour in pictures: {COLOR}", "deepskyblue", default=None)
    """``#rrggbb``; None lets the renderer choose."""
    spans: Mapping[str, Span] = field(default_factory=dict, compare=False, repr=False)

    @property
    def fed(self) -> bool:
        """Whether liquid comes from outside or goes there."""
        return bool(self.wave or self.current or self.inflow or self.drain)


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


class ContactModel(Enum):
    SURFACE = "surface"
    """The drawn surface is where objects touch; friction."""
    PAPER = "paper"
    """A barrier between boundary and inner particles, without friction."""


class Save(Enum):
    ALL = "all"
    BOUNDARY = "boundary"


class Switch(Enum):
    ON = "on"
    OFF = "off"
    AUTO = "auto"


class SaveAndPrecision(Codec):
    """Which particles are saved, and whether in single precision."""

    def read(self, k: Keyword, choice: int, values: tuple) -> tuple[Save, bool]:
        return Save(values[0]), values[1] == "single"

    def write(self, k: Keyword, value: Any) -> tuple[int, tuple]:
        return 0, (value[0].value, "single" if value[1] else "double")


@dataclass(frozen=True, slots=True)
class Control(Worded):
    """Duration, frames, accuracy: everything that is neither an object nor a picture."""

    time: float = setting(
        "<T:s>", "Simulated duration; where no time step fits it and the frames, up to the last whole frame.",
        "3 s", Rule.POSITIVE)  # fmt: skip
    """[s]"""
    frames: float = setting("<n:fps>", "Frames per simulated second.", "25 fps", Rule.POSITIVE, default=30.0)
    """[1/s]"""
    timestep: float | None = setting(
        "auto | <dt:s>", "`auto` is certified before the run; a number above the bound is refused.",
        "0.1 ms", Rule.POSITIVE, default=None)  # fmt: skip
    """[s]; None is ``auto``."""
    resolution: float | None = setting("auto | <h:m>", "Particle spacing.", "2 cm", Rule.POSITIVE, default=None)
    """Particle spacing [m]; None is ``auto``."""
    accuracy: Accuracy = setting(
        None, "How finely objects and time are resolved; `study` tells what it costs and brings.", "preview",
        default=Accuracy.BALANCED, codec=Words(Accuracy), gone={
            "error": 'mdanim-lammps study SCENE --target "2 %" finds the setting for an error and prints what to write',
        })  # fmt: skip
    contact_stiffness: float = setting(
        "<factor>",
        "What objects, ground and walls push back with, over E h, the stiffness of the material behind a surface; from 0.1 to "
        "100. The stiffer it is, the less objects sink into each other, and the shorter time steps get.",
        "4", Rule.POSITIVE, default=1.0, limit=CONTACT_STIFFNESS)  # fmt: skip
    """Stiffness with which objects and walls push back, over E h [-]."""
    contact_model: ContactModel = setting(
        None,
        "`surface`: objects touch where their drawn surfaces are, and may have friction. `paper`: the barrier of Wcislo 1999 "
        "between particles, which keeps objects about half a spacing apart, without friction.",
        "paper", default=ContactModel.SURFACE, codec=Words(ContactModel))  # fmt: skip
    friction: float = setting(
        "<mu>", "Coefficient of friction of objects that have none of their own. Not with `contact-model paper`.",
        "0.5", Rule.NOT_NEGATIVE, default=0.0, limit=FRICTION)  # fmt: skip
    """mu [-]"""
    contact_damping: float | None = setting(
        "<beta>",
        "Damping of contacts that have friction, as a fraction of critical damping: it ends chatter. Not with `contact-model "
        "paper`. Absent: 0.3.",
        "0.3", Rule.NOT_NEGATIVE, default=None, limit=CONTACT_DAMPING)  # fmt: skip
    """Share of critical damping where there is friction [-]; None is 0.3."""
    seed: int = setting("<n>", "Seed of `rand` and of the liquid.", "7", Rule.WHOLE, default=1)
    save: Save = setting(
        "<all|boundary> [<single|double>]",
        "Which particles the trajectory holds, and its precision; the size is printed before the run.",
        "boundary single", default=Save.ALL, also=("single",), codec=SaveAndPrecision())  # fmt: skip
    single: bool = False
    """Trajectory in single precision."""
    spans: Mapping[str, Span] = field(default_factory=dict, compare=False, repr=False)


_OF_FEATURES = {of: quantity for words in facets("words") for of, quantity in getattr(words, "QUANTITIES", {}).items()}
QUANTITIES = {
    **{of: quantity for of, quantity in _OF_FEATURES.items() if of[0] == "NAME"},
    ("energy", "residual"): Observable("1", "relative error of the energy ledger", bound=True),
    **{of: quantity for of, quantity in _OF_FEATURES.items() if of[0] != "NAME"},
}
"""Quantities that ``expect`` can check, by subject and word; NAME stands for any object."""

GLOBALS = tuple(dict.fromkeys(subject for subject, _ in QUANTITIES if subject != "NAME"))
"""Subjects of ``expect`` that are not objects."""


RELATIONS = {"=": "=", "<": "<", ">": ">", "<=": "<=", ">=": ">=", "≤": "<=", "≥": ">="}
"""How what is found may stand to a value, by how it is written."""


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
    """[s]; None is the end of the run (``strain.max``, ``penetration.max``, ``crest``, residuals: the whole run)."""
    relation: str = "="
    """One of RELATIONS."""
    argument: str | tuple[float, float] | None = None
    """The other object of a distance, the place of a height [m]; None of quantities that take none."""
    span: Span | None = field(default=None, compare=False, repr=False)

    @property
    def what(self) -> str:
        """The checked quantity, as it is written in scenes."""
        return self.written(lambda x: number(x, 6))

    def written(self, number: Callable[[float], str]) -> str:
        """The same with its numbers in this form."""
        taken = self.argument
        if isinstance(taken, tuple):
            taken = ", ".join(f"{number(x)} m" for x in taken)
        return f"{self.subject}.{self.quantity}" + ("" if taken is None else f"({taken})")

    @property
    def unit(self) -> str:
        """SI unit of what is checked; empty for plain numbers."""
        unit = self.kind.unit
        return "" if unit == "1" else unit

    @property
    def kind(self) -> Observable:
        """The kind of the checked quantity."""
        return QUANTITIES[self.subject if self.subject in GLOBALS else "NAME", self.quantity]


class Check(Codec):
    """A self-check; its values are read in validate.py, for their unit is that of the quantity."""

    def write(self, k: Keyword, value: Any) -> tuple[int, tuple]:
        numbers = [f"{x!r} {value.unit}".rstrip() for x in (value.value, value.tolerance)]
        tolerance = numbers[1] if value.relation == "=" else None
        return 0, (value.written(repr), value.time, value.relation, numbers[0], tolerance)


@dataclass(frozen=True, slots=True)
class SceneRecord:
    """A whole scene, validated word by word; geometry is checked when models are made."""

    name: str
    """Stem of the file name: ``beam`` for ``beam.txt``."""
    control: Control
    title: str = setting('<"text">', "Title of the scene, shown by `check` and in the movie.", '"Cube on a beam"', default="")
    language: str = setting(
        "<free|strict>",
        "`strict` refuses bare numbers where a unit belongs, in the whole scene with all that it includes; `check --strict` does "
        "so for any scene.", "strict", default="free")  # fmt: skip
    solids: tuple[Solid, ...] = ()
    liquid: Liquid | None = None
    contacts: tuple[ContactPair, ...] = ()
    effects: Mapping[str, Switch] = field(default_factory=dict)
    """Only what ``effects { }`` says; everything else is ``auto``."""
    render: Render = field(default_factory=Render)
    expects: tuple[Expect, ...] = setting(
        "<NAME.QUANTITY> [at <T:s>] <RELATION> <value:?> [+- <tolerance:?> [%]]",
        "A self-check, evaluated after the run; a miss is exit code 6. Without `at`: the end of the run, and the whole run for "
        "residuals and maxima. RELATION is `=`, `<`, `>`, `<=` or `>=`; only `=` has a tolerance, in the unit of the value or in "
        "per cent of it: `= 12 cm +- 2 %`. Without `+-`: exactly.",
        "ball.position.z at 1 s = 0.1 m +- 1 cm", name="expect", default=(), many=True, codec=Check())  # fmt: skip
    path: Path | None = field(default=None, compare=False)
    """The file that was read, absolute."""
    spans: Mapping[str, Span] = field(default_factory=dict, compare=False, repr=False)
    """Places of ``gravity``, ``ground``, ``walls``, ``effects.NAME`` ..."""
    warnings: tuple = field(default=(), compare=False)
    """Problems of severity ``warning`` that were found while reading."""

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Settings that features add."""


if not TYPE_CHECKING:
    SceneRecord = with_words(SceneRecord, "SCENE")
