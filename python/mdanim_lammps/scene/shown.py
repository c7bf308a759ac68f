# SPDX-License-Identifier: GPL-2.0-only
"""Additions to pictures that tell what happens: arrows, trails, labels, captions; words of ``render``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import field
from enum import Enum
from typing import ClassVar

from ..errors import Span
from ..records import dataclass
from .naming import objects_by_name
from .quantities import QUANTITIES, VECTORS, Asked

ARROWS = tuple(word for word in VECTORS if QUANTITIES["NAME", f"{word}.x"].unit not in ("m", "rad", "Pa"))
"""Quantities that arrows show: all vectors but places, angles and stresses."""


class ColorBy(Enum):
    """Quantities of particles that colours show."""

    SPEED = "speed"
    STRAIN = "strain"
    STRESS = "stress"


@dataclass(frozen=True, slots=True)
class Texture:
    """A pattern on an object, which goes with its material."""

    FORMS: ClassVar = ("<wood|brick|stripes|checker> [size <width:m>]",)
    pattern: str
    """One of TEXTURES."""
    size: float | None = None
    """Length of a part of the pattern [m]; None for one that the object's size gives."""


TEXTURES = {"wood": "#c99a62", "brick": "#a9543c", "stripes": "", "checker": ""}
"""Patterns with their colour where an object has none; empty for the one that it would have anyway."""


@dataclass(frozen=True, slots=True)
class Arrows:
    """Arrows of a vector at the centres of objects."""

    FORMS: ClassVar = (f"<{'|'.join(ARROWS)}> [of <NAME>] [scale <s>]",)
    vector: str
    """One of ARROWS."""
    name: str | None = None
    """An object, or all objects of a repeat; None for all."""
    scale: float | None = None
    """Length of an arrow over the value, in SI units; None for one that is chosen."""
    span: Span | None = field(default=None, compare=False, repr=False)

    def objects(self, names: Sequence[str]) -> list[int]:
        """Numbers of the objects that have one."""
        return list(range(len(names))) if self.name is None else objects_by_name(names)[self.name]

    def asked(self, names: Sequence[str]) -> Iterator[Asked]:
        """The quantities that it shows: of what is not named, where they are known."""
        for m in self.objects(names):
            for axis in "xyz":
                yield Asked(names[m], f"{self.vector}.{axis}", optional=self.name is None, span=self.span)


@dataclass(frozen=True, slots=True)
class Trail:
    """The way of an object's centre."""

    FORMS: ClassVar = ("<NAME> [<T:s>]",)
    name: str
    """An object, or all objects of a repeat."""
    time: float | None = None
    """How far back it goes [s]; None is to the start."""


@dataclass(frozen=True, slots=True)
class NameTag:
    """Words above an object."""

    FORMS: ClassVar = ('<NAME> <"text">',)
    name: str
    """An object, or all objects of a repeat."""
    text: str


@dataclass(frozen=True, slots=True)
class Caption:
    """Words below a picture for a time."""

    FORMS: ClassVar = ('<"text"> [from <T0:s>] [to <T1:s>]',)
    text: str
    begin: float | None = None
    """[s]; None is the start."""
    end: float | None = None
    """[s]; None is the end."""
