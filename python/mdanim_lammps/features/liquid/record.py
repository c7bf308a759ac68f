# SPDX-License-Identifier: GPL-2.0-only
"""The liquid of a scene: what its block says."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from enum import Enum
from typing import ClassVar

from ...errors import Span
from ...records import dataclass
from ...scene.limits import Limit
from ...scene.schema import BOX, COLOR, OneOf, Rule, Vector, Worded, Words, setting
from ..drives.words import DriveOscillation, DriveVelocity, ShiftKey

MANNING = Limit("manning", 1.0, 1e-4, "0.01 is glass, 0.013 concrete, 0.03 gravel, 0.05 a brook with stones, 0.1 dense reeds")
DROPS = Limit("drops", 1.0, way_out="1 lets all of it fly")
SWEEPS = Limit("sweeps", 4096, way_out="write sweeps auto, which takes 8 for each cell that the fastest solid travels")
"""The limit of fix mdanim/liquid."""


@dataclass(frozen=True, slots=True)
class Puddle:
    """A further part of the basin that liquid starts in."""

    FORMS: ClassVar = (BOX,)
    low: Vector
    """[m]"""
    high: Vector
    """[m]"""


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
    pool: tuple[Puddle, ...] = setting(
        None,
        "A further part of the basin that liquid starts in, full to its top, in whole cells: a wet floor before a dam, or a "
        "lock with another level. With `fill` and `level`, and not higher than this.",
        "from (0, -1, 0) m to (1, 1, 0.1) m", default=(), many=True, codec=OneOf(Puddle))  # fmt: skip
    drag: float | None = setting(
        "auto | <gamma:1/s>",
        "Immersed solids feel F = -gamma rho V v with the immersed volume V and the velocity v against the liquid; `auto` is "
        "gamma = sqrt(g/L) for a body of size L; with `model waves` 0.06 sqrt(g/L) + 0.25 v/L, so that what is slow glides on.",
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
        "auto | <T:s>",
        "With `model waves`: time in which waves, and the speed of floods, die to 1/e, besides by drag and depth; `auto` is "
        "50 times that of a long wave through the longer side of the basin, L/√(g depth), or through its depth.",
        "20 s", Rule.POSITIVE, default=None)  # fmt: skip
    """Time in which waves die to 1/e [s]; None is ``auto``."""
    manning: float | None = setting(
        "<n>",
        "With `model waves`: friction of the ground, that is the floor and all that the liquid flows over, by Manning's n as in "
        "tables, a plain number: glass 0.01, concrete 0.013, gravel 0.03, a brook with stones 0.05. The liquid loses the head "
        "n² u²/h^(4/3) in each metre. Absent: smooth. With `manning`, `calm auto` adds no decay.",
        "0.03", Rule.POSITIVE, default=None, limit=MANNING)  # fmt: skip
    """Manning's n [s/m^(1/3)]; None is smooth."""
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
    drive: tuple[DriveVelocity | DriveOscillation, ...] = setting(
        None,
        "With `model waves`: the basin moves as a whole along x and y, at a velocity or to and fro as of objects, and the liquid "
        "in it sloshes. At the start the liquid is at rest in its basin. Several add up.",
        "oscillation (2, 0, 0) cm frequency 0.8 Hz", default=(), many=True,
        codec=OneOf(DriveVelocity, DriveOscillation))  # fmt: skip
    keys: tuple[ShiftKey, ...] = setting(
        None, "The same through displacements from where it is at the start; `drive` adds to it.",
        "1 s by (0.5, 0, 0) m", default=(), name="key", many=True, codec=OneOf(ShiftKey))  # fmt: skip
    color: str | None = setting("<color>", f"Colour in pictures: {COLOR}", "deepskyblue", default=None)
    """``#rrggbb``; None lets the renderer choose."""
    spans: Mapping[str, Span] = field(default_factory=dict, compare=False, repr=False)

    @property
    def fed(self) -> bool:
        """Whether liquid comes from outside or goes there."""
        return bool(self.wave or self.current or self.inflow or self.drain)

    @property
    def moves(self) -> bool:
        """Whether the basin moves."""
        return bool(self.drive or self.keys)
