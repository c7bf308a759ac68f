# SPDX-License-Identifier: GPL-2.0-only
"""Shapes, what is held, elasticity: the parts of an object, each with the forms that it is written in."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import ClassVar

from .schema import Vector

# --- shapes: body frame, centre of mass at the origin, axes of revolution along z -------------------------


@dataclass(frozen=True, slots=True)
class Box:
    """A cuboid."""

    FORMS: ClassVar = ("box <(lx, ly, lz):m>",)
    ALSO: ClassVar = ("cube", "cuboid", "brick", "block", "plate")

    size: Vector
    """Edge lengths [m]."""


@dataclass(frozen=True, slots=True)
class Sphere:
    """A ball."""

    FORMS: ClassVar = ("sphere <r:m>",)
    ALSO: ClassVar = ("ball", "globe")

    radius: float
    """[m]"""


@dataclass(frozen=True, slots=True)
class Ellipsoid:
    """An ellipsoid."""

    FORMS: ClassVar = ("ellipsoid <(rx, ry, rz):m>",)
    ALSO: ClassVar = ()

    radii: Vector
    """Half axes [m]."""


@dataclass(frozen=True, slots=True)
class Cylinder:
    """A circular cylinder, axis along z."""

    FORMS: ClassVar = ("cylinder <r:m> <h:m>",)
    ALSO: ClassVar = ("rod", "disk", "disc", "tube")

    radius: float
    """[m]"""
    height: float
    """[m]"""


@dataclass(frozen=True, slots=True)
class Cone:
    """A circular cone, apex up (+z); its centre of mass is height/4 above the base."""

    FORMS: ClassVar = ("cone <r:m> <h:m>",)
    ALSO: ClassVar = ("pyramid",)

    radius: float
    """Radius of the base [m]."""
    height: float
    """[m]"""


@dataclass(frozen=True, slots=True)
class Torus:
    """A ring around z."""

    FORMS: ClassVar = ("torus <R:m> <r:m>",)
    ALSO: ClassVar = ("ring", "donut")

    major: float
    """Radius of the centre line [m]."""
    minor: float
    """Radius of the tube [m]."""


@dataclass(frozen=True, slots=True)
class Mesh:
    """A closed triangle mesh from an STL, OBJ or PLY file; axes as in the file."""

    FORMS: ClassVar = ('mesh <"file"> [scale <s>]',)
    ALSO: ClassVar = ("stl", "obj", "ply", "file")

    path: Path
    """Absolute path."""
    scale: float = 1.0
    """Metres per unit of the file."""


Shape = Box | Sphere | Ellipsoid | Cylinder | Cone | Torus | Mesh


# --- what is held, elasticity ---------------------------------------------------------------------------------


class Side(Enum):
    """A face of the bounding box of an object in its own frame."""

    MINUS_X, PLUS_X, MINUS_Y, PLUS_Y, MINUS_Z, PLUS_Z = "-x", "+x", "-y", "+y", "-z", "+z"


@dataclass(frozen=True, slots=True)
class HoldFaces:
    """Particles on these faces (body frame) never move; ``faces x`` is both ``-x`` and ``+x``."""

    FORMS: ClassVar = ("faces <x|y|z>", f"face <{'|'.join(s.value for s in Side)}>")
    sides: tuple[Side, ...]

    @classmethod
    def read(cls, form: int, values: tuple) -> HoldFaces:
        """The faces of one form."""
        return cls(tuple(map(Side, values if form else (f"-{values[0]}", f"+{values[0]}"))))

    def write(self) -> tuple[int, tuple]:
        """Form and values that are read as these faces."""
        return (0, (self.sides[0].value[1],)) if len(self.sides) == 2 else (1, (self.sides[0].value,))


@dataclass(frozen=True, slots=True)
class HoldAll:
    """No particle of the object ever moves."""

    FORMS: ClassVar = ("all",)


@dataclass(frozen=True, slots=True)
class HoldWithin:
    """Particles inside this box (world frame, at the start) never move."""

    FORMS: ClassVar = ("within box <(x0, y0, z0):m> to <(x1, y1, z1):m>",)

    low: Vector
    """[m]"""
    high: Vector
    """[m]"""


Hold = HoldFaces | HoldAll | HoldWithin


def holds_all(holds: Iterable[Hold]) -> bool:
    """Whether no particle of an object with these ever moves by forces."""
    return any(isinstance(hold, HoldAll) for hold in holds)


@dataclass(frozen=True, slots=True)
class Young:
    """Elasticity as Young's modulus."""

    FORMS: ClassVar = ("<E:Pa>",)

    modulus: float
    """[Pa]"""


@dataclass(frozen=True, slots=True)
class SpringConstant:
    """Elasticity as the paper writes it: one k for every spring, Wcislo 1999, eq. (3.6)."""

    FORMS: ClassVar = ("spring <k:N/m>",)

    k: float
    """[N/m]"""


Elasticity = Young | SpringConstant
"""Features may add forms of their own: ELASTICITIES of their words, with a ``modulus`` [Pa]."""
