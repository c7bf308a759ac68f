# SPDX-License-Identifier: GPL-2.0-only
"""The ``render`` block: how pictures look."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import field
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from ..errors import Span
from ..records import dataclass
from .formatting import number, vector
from .limits import PIXELS, SHADOWS, SPEED
from .quantities import Asked, QuantityName
from .schema import COLOR, Codec, Keyword, OneOf, Rule, Vector, Worded, Words, of_features, setting, with_words
from .shown import Arrows, Caption, ColorBy, NameTag, Trail

LOWEST_LAMP = math.sin(math.radians(5.0))
"""Height of a lamp over its distance; shadows of a lower one are longer than any picture."""
SMOOTH_RATE, LEAST_RATE = 30.0, 15.0
"""Pictures per second of a movie, and below how many it jerks."""


def few_pictures(frames: float, speed: float) -> str:
    """The fault of a movie in slow motion of a run with ``frames`` frames per second; the empty string without any."""
    if speed >= 1.0 or frames * speed >= LEAST_RATE:
        return ""
    return f"at speed {number(speed)} the movie shows {number(frames * speed, 3)} pictures a second"


@dataclass(frozen=True, slots=True)
class Camera:
    """One point of the camera's path."""

    FORMS: ClassVar = ("[<T:s>] from <(x, y, z):m> look <(x, y, z):m or NAME> [up <(x, y, z)>]",)
    ORDER: ClassVar = ("time", "eye", "look", "up")
    eye: Vector
    """[m]"""
    look: Vector | str
    """A point [m], or the name of an object that the camera follows."""
    time: float | None = None
    """[s]; None for a camera that stands still."""
    up: Vector = (0.0, 0.0, 1.0)


@dataclass(frozen=True, slots=True)
class Standpoint:
    """A camera that is placed by what happens, in a given direction or after an object."""

    FORMS: ClassVar = ("top", "side", "front", "follow <NAME>")
    place: str
    """``top``, ``side``, ``front`` or ``follow``."""
    name: str | None = None
    """The object that it follows."""

    @classmethod
    def read(cls, choice: int, values: tuple) -> Standpoint:
        """From one of FORMS and its values."""
        return cls(cls.FORMS[choice].split()[0], *values)

    def write(self) -> tuple[int, tuple]:
        """The number of one of FORMS, and its values."""
        return ("top", "side", "front", "follow").index(self.place), () if self.name is None else (self.name,)


class MovieName(Codec):
    """A file below the output folder, and none of the run's own."""

    def read(self, k: Keyword, choice: int, values: tuple) -> str:
        (name,), path, cause = values, Path(values[0]), ""
        if not name.isprintable():
            cause = "the name of a movie holds no characters that cannot be printed"
        elif path.is_absolute() or ".." in path.parts:
            cause = "the movie lies outside of the output folder"
        elif path.suffix.lower() != ".mp4" or max(len(os.fsencode(part)) for part in path.parts) > 255:
            cause = "a movie is written as .mp4"
        if cause:
            shown = "".join(c if c.isprintable() else "?" for c in name)
            raise ValueError(f"{cause}: '{shown}'", 'write a name inside it, e.g. movie "ball.mp4"', 0)
        return name


class Quality(Enum):
    DRAFT = "draft"
    FINAL = "final"


class Floor(Enum):
    GRID = "grid"
    PLAIN = "plain"
    CHECKER = "checker"
    WOOD = "wood"
    TILES = "tiles"
    GRASS = "grass"
    STUDIO = "studio"
    NONE = "none"


class LampDirection(Codec):
    """A direction that points upward."""

    def read(self, k: Keyword, choice: int, values: tuple) -> Vector:
        (toward,) = values
        length = math.hypot(*toward)
        if not length or toward[2] < LOWEST_LAMP * length:
            cause = f"the lamp must stand at least 5 degrees above the floor, found {vector(toward)}"
            raise ValueError(cause, "light from (x, y, z) is where the lamp is seen; z is up, e.g. light from (-1, -1, 2)", 0)
        return toward


@dataclass(frozen=True, slots=True)
class Render(Worded):
    """How the pictures look; every None is chosen automatically."""

    size: tuple[int, int] = setting(
        "<(w, h)>", "Width and height of the pictures in pixels.",
        "(1920, 1080)", Rule.COUNT, default=(1280, 720), limit=PIXELS)  # fmt: skip
    movie: str | None = setting(
        '<"file.mp4">', "Name of the movie inside the output folder. Absent: `movie.mp4`.",
        '"ball.mp4"', default=None, codec=MovieName())  # fmt: skip
    speed: float = setting(
        "<factor>",
        "Speed of the movie: `0.25` is slow motion, `10` a time lapse. Below 1, and without `frames` in control, there are 30 "
        "frames for each second of the movie.",
        "0.25", Rule.POSITIVE, default=1.0, limit=SPEED)  # fmt: skip
    quality: Quality = setting(
        None,
        "`draft` is fast. `final` has smooth edges, finer shadows, and corners that are darker because less of the sky is seen "
        "from there; a picture takes several times as long.",
        "final", default=Quality.DRAFT, codec=Words(Quality))  # fmt: skip
    light: Vector = setting(
        "from <(x, y, z)>", "Where the lamp is, seen from the scene: a direction, z is up. Shadows fall to the other side.",
        "from (1, -1, 2)", default=(-0.45, -0.55, 1.15), codec=LampDirection())  # fmt: skip
    shadows: float = setting(
        "<share>", "Share of the lamp's light that shadows are without: `0` for no shadows, `1` for the darkest.",
        "0.5", Rule.NOT_NEGATIVE, default=1.0, limit=SHADOWS)  # fmt: skip
    floor: Floor = setting(
        None,
        "What is drawn on the floor: lines that tell sizes, nothing, squares, planks, tiles, grass under a blue sky, a bright "
        "studio without a horizon, or no floor at all.",
        "checker", default=Floor.GRID, codec=Words(Floor))  # fmt: skip
    background: str | None = setting("<color>", f"Background: {COLOR}", "white", default=None)
    camera: tuple[Camera | Standpoint, ...] = setting(
        None,
        "Where the camera stands and what it looks at; several lines with times T make a smooth path. `look NAME` follows an "
        "object. `top`, `side` (from +x) and `front` (from -y) show the whole run from there; `follow NAME` goes along with an "
        "object. Absent: one view for all frames, chosen from the whole run so that what happens is seen large; what flies or "
        "falls far off, and what few objects do for a short time, may be left out.",
        "from (4, -4, 2) m look (0, 0, 0.5) m", default=(), many=True, codec=OneOf(Camera, Standpoint))  # fmt: skip
    arrows: tuple[Arrows, ...] = setting(
        None,
        "Arrows at the centres of objects, with a legend that tells their unit: of those of NAME, or of all objects of which the "
        "quantity is known. `scale` is their length in metres for one unit; absent: all arrows of one unit have one length that "
        "shows well.",
        "velocity of ball", Rule.POSITIVE, default=(), many=True, codec=OneOf(Arrows))  # fmt: skip
    trail: tuple[Trail, ...] = setting(
        None, "The way of an object's centre of mass, from the start or for the last T.", "ball 0.5 s", Rule.POSITIVE,
        default=(), many=True, codec=OneOf(Trail))  # fmt: skip
    label: tuple[NameTag, ...] = setting(
        None, "Words above an object, which go with it.", 'ball "falls freely"', default=(), many=True,
        codec=OneOf(NameTag))  # fmt: skip
    plot: tuple[Asked, ...] = setting(
        "<NAME.QUANTITY>",
        "A curve over time that grows with the film; curves of one unit share a panel.",
        "ball.speed", default=(), many=True, codec=QuantityName())  # fmt: skip
    caption: tuple[Caption, ...] = setting(
        None, "Words below the picture, from one time to another.", '"it lands" from 0.4 s to 1 s', Rule.NOT_NEGATIVE,
        default=(), many=True, codec=OneOf(Caption))  # fmt: skip
    freeze: float | None = setting(
        "<T:s>", "What moves leaves a pale copy of itself behind, every T.", "0.1 s", Rule.POSITIVE, default=None)  # fmt: skip
    """[s]"""
    color_by: ColorBy | None = setting(
        None,
        "Colours tell the `speed` of the material [m/s], its `strain`: the largest |r/r₀ - 1| of the springs of a particle, or "
        "its `stress` by von Mises [Pa].",
        "strain", default=None, codec=Words(ColorBy))  # fmt: skip
    spans: Mapping[str, Span] = field(default_factory=dict, compare=False, repr=False)

    def asked(self, names: Sequence[str]) -> tuple[Asked, ...]:
        """All quantities that pictures of objects with these names show."""
        return (*self.plot, *dict.fromkeys(of for one in self.arrows for of in one.asked(names)))

    @property
    def tells(self) -> bool:
        """Whether pictures have anything laid over them."""
        return bool(self.arrows or self.trail or self.label or self.plot or self.caption or self.color_by)

    if TYPE_CHECKING:
        __getattr__ = of_features


if not TYPE_CHECKING:
    Render = with_words(Render, "RENDER")
