# SPDX-License-Identifier: GPL-2.0-only
"""The scene as plain frozen records, in SI units: what the language says, not how it is computed."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import field
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import Span
from ..features import facets
from ..records import dataclass
from .formatting import vector
from .quantities import GLOBALS, OVER, QUANTITIES, RELATIONS, VECTORS, Asked, Check, Expect, QuantityName  # noqa: F401
from .render import Camera, Render, Standpoint  # noqa: F401
from .rotation import IDENTITY, departure, rotation_about, rotation_euler
from .schema import COLOR, Codec, Keyword, OneOf, Rule, Vector, Worded, Words, of_features, setting, with_words
from .shapes import (  # noqa: F401
    Box,
    Bricks,
    Cone,
    Cylinder,
    Elasticity,
    Ellipsoid,
    Hold,
    HoldAll,
    HoldEnds,
    HoldFaces,
    HoldWithin,
    Mesh,
    OneShape,
    PieceShape,
    Rope,
    Shape,
    Sheet,
    Shell,
    Side,
    Sphere,
    SpringConstant,
    Torus,
    VoronoiCells,
    Young,
)
from .shown import Texture

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


_ELASTICITIES = tuple(kind for words in facets("words") for kind in getattr(words, "ELASTICITIES", ()))


@dataclass(frozen=True, slots=True)
class Solid:
    """One elastic object."""

    name: str
    """``cube`` or ``ball[12]``."""
    shape: Shape = setting(
        None,
        "Form of the object in its own frame: edge lengths, radii, heights along z. A mesh is a closed STL, OBJ or PLY file, "
        "beside the scene file; `scale` is metres per unit of the file, default 1; `part` takes one of its parts, by name "
        "(objects or groups of an OBJ file, solids of an STL file) or by number. A solid is all that the surface of such a file "
        "encloses, which may have gaps, doubled faces and parts that cross. Colours of the points of a PLY file are drawn where "
        "the object has no `color`. A rope lies between two points of the world, `thickness` is its diameter; with a "
        "`length` above their distance it hangs through along -z, with one below it is stretched. A chain is a rope that does "
        "not resist bending. With `sheet thickness` behind it the surface of a shape is a sheet, hollow inside; a mesh may then "
        "be open.",
        "sphere 10 cm", Rule.POSITIVE, codec=OneShape())  # fmt: skip
    position: Vector = setting("<(x, y, z):m>", "Centre of mass. Not of a rope, which has its ends.", "(0, 0, 1) m")
    """[m]"""
    rotation: tuple[Vector, Vector, Vector] = setting(
        "axis <(x, y, z)> angle <a:rad> | euler <(rx, ry, rz):rad> | matrix <(xx, xy, xz)> <(yx, yy, yz)> <(zx, zy, zz)>",
        "Rotation about the centre of mass. `euler` rotates about x, then y, then z, all fixed axes. `matrix` gives the rows of "
        "the rotation matrix (world = matrix * body); `scene.lock.txt` uses it.",
        "axis (1, 1, 0) angle 20 deg", name="orientation", absent=IDENTITY, codec=Orientation())  # fmt: skip
    """Rotation matrix, rows; world = rotation @ body."""
    elasticity: Elasticity = setting(
        None,
        " ".join((
            "Young's modulus; or the paper's one k for every spring, Wcislo 1999, eq. (3.6).",
            *(kind.ABOUT for kind in _ELASTICITIES),
        )),
        "200 kPa", Rule.POSITIVE, codec=OneOf(Young, SpringConstant, *_ELASTICITIES), shared=True)  # fmt: skip
    mass: float | None = setting(
        "<m:kg>", "Mass of the whole object.", "2 kg", Rule.POSITIVE, default=None, one_of=("mass", "density"))  # fmt: skip
    """[kg]; exactly one of mass and density is given."""
    density: float | None = setting(
        "<rho:kg/m^3>", "Mass per volume.", "900 kg/m^3", Rule.POSITIVE, default=None, one_of=("mass", "density"),
        shared=True)  # fmt: skip
    """[kg/m^3]"""
    velocity: Vector = setting("<(vx, vy, vz):m/s>", "Velocity at the start.", "(0, 0, -1) m/s", default=(0.0, 0.0, 0.0))
    """[m/s]"""
    spin: Vector = setting(
        "<(wx, wy, wz):rad/s>", "Angular velocity at the start, about the axes of the world.",
        "(0, 0, 2) rad/s", default=(0.0, 0.0, 0.0))  # fmt: skip
    """Angular velocity, world frame [rad/s]."""
    hold: tuple[Hold, ...] = setting(
        None,
        "Particles that never move: both faces across an axis of the object, one face, all of them (a wedge, an obstacle), "
        "those inside a box of the world at the start, or of a rope both ends, its first or its last. An object with `hold all` "
        "needs neither mass nor elasticity, unless it is a rope, a sheet, or let go later: without them it is rigid.",
        "faces x", default=(),
        many=True, codec=OneOf(HoldFaces, HoldAll, HoldWithin, HoldEnds))  # fmt: skip
    resolution: float | None = setting(
        "<h:m>",
        "Its own particle spacing, which the rest of the scene does not get. Not with `contact-model paper`. Absent: that of the "
        "scene.",
        "1 cm", Rule.POSITIVE, default=None)  # fmt: skip
    """[m]"""
    color: str | None = setting("<color>", f"Colour in pictures: {COLOR}", "steelblue", default=None, shared=True)
    """``#rrggbb``; None lets the renderer choose."""
    texture: Texture | None = setting(
        None,
        "Pattern in pictures and movies, which turns and bends with the material: grain of wood, bricks, stripes across its x "
        "axis, or cubes of two colours. `size` is the width of a ring, a stripe or a cube, or the length of a brick.",
        "checker size 5 cm", Rule.POSITIVE, default=None, codec=OneOf(Texture), shared=True)  # fmt: skip
    spans: Mapping[str, Span] = field(default_factory=dict, compare=False, repr=False)
    """Where each keyword's value stands; ``spans["object"]`` is the object's name."""

    if TYPE_CHECKING:
        __getattr__ = of_features


@dataclass(frozen=True, slots=True)
class Command:
    """A command for LAMMPS as it stands; of several lines where they continue each other."""

    text: str
    span: Span | None = field(default=None, compare=False, repr=False)


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
    seed: int = setting("<n>", "Seed of `rand` and of the liquid.", "7", Rule.WHOLE, default=1)
    save: Save = setting(
        "<all|boundary> [<single|double>]",
        "Which particles the trajectory holds, and its precision; the size is printed before the run.",
        "boundary single", default=Save.ALL, also=("single",), codec=SaveAndPrecision())  # fmt: skip
    single: bool = False
    """Trajectory in single precision."""
    spans: Mapping[str, Span] = field(default_factory=dict, compare=False, repr=False)

    if TYPE_CHECKING:
        __getattr__ = of_features


@dataclass(frozen=True, slots=True, weakref_slot=True)
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
    lammps: tuple[Command, ...] = ()
    trusted: bool = field(default=False, compare=False)
    """Whether who reads the scene has said that its commands for LAMMPS may be run (``--trust``); no file says so."""
    effects: Mapping[str, Switch] = field(default_factory=dict)
    """Only what ``effects { }`` says; everything else is ``auto``."""
    render: Render = field(default_factory=Render)
    expects: tuple[Expect, ...] = setting(
        "[<min|max|mean>] <NAME.QUANTITY> [at <T:s>] [from <T0:s> to <T1:s>] <RELATION> <value:?> [+- <tolerance:?> [%]]",
        "A self-check, evaluated after the run; a miss is exit code 6. Without `at`: the end of the run, and the whole run for "
        "residuals and maxima. With `from` and `to` it holds at all frames of that time; the value found is the worst one. "
        "`min`, `max` and `mean` are those of that time, or of the whole run. RELATION is `=`, `<`, `>`, `<=` or `>=`; only `=` "
        "has a tolerance, in the unit of the value or in per cent of it: `= 12 cm +- 2 %`. Without `+-`: exactly.",
        "ball.position.z at 1 s = 0.1 m +- 1 cm", name="expect", default=(), many=True, codec=Check())  # fmt: skip
    records: tuple[Asked, ...] = setting(
        "<NAME.QUANTITY>",
        "A column of `records.csv`: the quantity at every frame, in SI units; `run.records` has them in Python.",
        "ball.speed", name="record", default=(), many=True, codec=QuantityName())  # fmt: skip
    path: Path | None = field(default=None, compare=False)
    """The file that was read, absolute."""
    spans: Mapping[str, Span] = field(default_factory=dict, compare=False, repr=False)
    """Places of ``gravity``, ``ground``, ``walls``, ``effects.NAME`` ..."""
    warnings: tuple = field(default=(), compare=False)
    """Problems of severity ``warning`` that were found while reading."""

    @property
    def asked(self) -> tuple[Asked | Expect, ...]:
        """All quantities that it asks for."""
        return (*self.expects, *self.records, *self.render.asked([solid.name for solid in self.solids]))

    if TYPE_CHECKING:
        __getattr__ = of_features


if not TYPE_CHECKING:
    Solid, Control = with_words(Solid, "OBJECT"), with_words(Control, "CONTROL")
    SceneRecord = with_words(SceneRecord, "SCENE")
