# SPDX-License-Identifier: GPL-2.0-only
"""Shapes, what is held, elasticity: the parts of an object, each with the forms that it is written in."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import field, replace
from enum import Enum
from pathlib import Path
from typing import Any, ClassVar, get_args

from ..records import dataclass
from .curve import Curve, hanging
from .formatting import number
from .rollers import Roller, Taut, taut
from .schema import Keyword, OneOf, Vector

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
    """The inside of a closed mesh from an STL, OBJ or PLY file, or all that a surface with gaps encloses; axes as in the file."""

    FORMS: ClassVar = tuple(f'{word} <"file"> [part <"name"|k>] [scale <s>]' for word in ("mesh", "solid"))
    ALSO: ClassVar = ("stl", "obj", "ply", "file")

    path: Path
    """Absolute path."""
    scale: float = 1.0
    """Metres per unit of the file."""
    mended: bool = False
    """Whether it is all that a surface encloses which has gaps, is doubled or crosses itself."""
    part: str | int | None = None
    """Which part of the file, by name or by number from 1 on; None for all of it."""

    @classmethod
    def read(cls, form: int, values: tuple) -> Mesh:
        """A mesh or a solid. Raises ValueError(message, hint, number of the value)."""
        path, part, scale = values
        if isinstance(part, float):
            if part != int(part) or part < 1:
                cause = f"a part is a name in quotes or a whole number from 1 on, found {number(part, 6)}"
                raise ValueError(cause, 'e.g. part "wheel", or part 2', 1)
            part = int(part)
        return cls(path, 1.0 if scale is None else scale, form == 1, part)

    def write(self) -> tuple[int, tuple]:
        """Form and values that are read as this."""
        return int(self.mended), (self.path, self.part, self.scale)


@dataclass(frozen=True, slots=True)
class VoronoiCells:
    """Cut into the Voronoi cells of points at random."""

    FORMS: ClassVar = ("<n>",)

    number: int

    @classmethod
    def read(cls, form: int, values: tuple) -> VoronoiCells:
        """So many."""
        return cls(int(values[0]))


@dataclass(frozen=True, slots=True)
class Bricks:
    """Cut into bricks of about this size, in rows of which every other one is shifted by half a brick."""

    FORMS: ClassVar = ("bricks <@(lx, ly, lz):m>",)

    size: Vector
    """[m]"""

    @classmethod
    def read(cls, form: int, values: tuple) -> Bricks:
        """Raises ValueError(message, hint, number of the value)."""
        (size,) = values
        if min(size) <= 0.0:
            raise ValueError("the edges of a brick must be > 0", "e.g. pieces bricks (24, 11, 7) cm", 0)
        return cls(tuple(size))


@dataclass(frozen=True, slots=True)
class PieceShape(Mesh):
    """A piece of another shape, as a mesh that no file has (model/cut.py)."""

    path: Path = Path()
    of: Any = None
    """The whole shape."""
    how: VoronoiCells | Bricks | None = None
    seed: str = ""
    """Random numbers follow from it."""
    number: int = 0
    """Which piece, from 0: the first one of those that are alike."""
    whole: Any = field(default=None, compare=False, repr=False)
    """The object that it is a piece of, as the scene has it."""


@dataclass(frozen=True, slots=True)
class Rope:
    """A line of round section between two points of the world, which hangs through where it is longer than their distance."""

    FORMS: ClassVar = tuple(
        f"{word} from <@(x0, y0, z0):m> to <@(x1, y1, z1):m> thickness <d:m> [length <L:m>]" for word in ("rope", "chain")
    )
    ALSO: ClassVar = ("cable", "cord", "string", "wire", "thread", "line")
    BRINGS: ClassVar = ("position", "orientation")
    """Settings of an object that follow from it."""
    BENDS: ClassVar = True
    """Whether it is there to bend, so that no material makes it rigid."""

    start: Vector
    """[m]"""
    end: Vector
    """[m]"""
    thickness: float
    """Diameter of its section [m]."""
    length: float
    """Without load [m]; below the distance of its ends it is stretched to begin with."""
    bends: bool = True
    """Whether it resists bending as a rod of this section does; a chain does not."""
    rollers: tuple[Roller, ...] = ()
    """Runs around them; it is pulled straight then."""

    @classmethod
    def read(cls, form: int, values: tuple) -> Rope:
        """A rope or a chain. Raises ValueError(message, hint, number of the value)."""
        start, end, thickness, given = values
        apart = math.dist(start, end)
        what = ("rope", "chain")[form]
        if apart == 0.0:
            raise ValueError(f"both ends of the {what} are at one point", "put them apart", 1)
        length = apart if given is None else given
        at = 1 if given is None else 3
        if length < 2.0 * thickness:
            cause = f"the {what} is shorter than twice its thickness: {number(length, 6)} m long, {number(thickness, 6)} m thick"
            raise ValueError(cause, "write a smaller thickness, or shape cylinder r h for a body so short", at)
        if apart > MOST_STRETCHED * length:
            cause = (
                f"the {what} is stretched too far to begin with: {number(length, 6)} m over a distance of {number(apart, 6)} m"
            )
            raise ValueError(cause, f"write a length of {number(apart / MOST_STRETCHED, 3)} m or more", at)
        made = cls(start, end, thickness, length, form == 0)
        if steep := made.too_steep():
            raise ValueError(*steep, at)
        return made

    def write(self) -> tuple[int, tuple]:
        """Form and values that are read as this."""
        is_as_long = self.rollers and self.length == self.curve.length
        return 0 if self.bends else 1, (self.start, self.end, self.thickness, None if is_as_long else self.length)

    @property
    def curve(self) -> Curve | Taut:
        """The line that it lies along to begin with."""
        return taut(self.start, self.end, self.rollers) if self.rollers else hanging(self.start, self.end, self.length)

    def around(self, rollers: tuple[Roller, ...]) -> Rope:
        """The same around rollers; as long as its way where its length is not given. Raises ValueError(cause, way out)."""
        way = taut(self.start, self.end, rollers).length
        length = way if self.length == math.dist(self.start, self.end) else self.length
        what = f"{number(length, 6)} m long, its way is {number(way, 6)} m"
        if length > way:
            raise ValueError(f"it hangs through: it is {what}", "leave out its length, and move its ends further out")
        if way > MOST_STRETCHED * length:
            raise ValueError(f"it is stretched too far to begin with: it is {what}", "leave out its length")
        return replace(self, length=length, rollers=rollers)

    def brings(self) -> dict[str, Any]:
        """Fields of its object that follow from it."""
        return {"position": self.curve.middle()}

    def moved(self, place: Any) -> Rope:
        """The same with its group in a place (placement.Placement). Raises ValueError(message, hint, word)."""
        made = replace(self, start=place.point(self.start), end=place.point(self.end))
        if steep := made.too_steep():
            raise ValueError(*steep, "shape")
        return made

    def too_steep(self) -> tuple[str, str] | None:
        """Cause and way out where it hangs through with one end above the other."""
        if self.length <= math.dist(self.start, self.end) or math.dist(self.start[:2], self.end[:2]) >= LEAST_SPAN * self.length:
            return None
        what = "rope" if self.bends else "chain"
        return (
            f"the {what} hangs through, and one end is above the other: both halves would lie in each other",
            f"put the ends {number(LEAST_SPAN * self.length, 2)} m apart along x or y, or leave out length",
        )


@dataclass(frozen=True, slots=True)
class Sheet:
    """One layer in the xy plane, as cloth, a sail or a trampoline; bending scales its resistance to bending, 0 for none."""

    FORMS: ClassVar = ("sheet <(lx, ly):m> thickness <t:m> [bending <@f>]",)
    ALSO: ClassVar = ("cloth", "sail", "flag", "membrane", "foil", "fabric", "towel")
    BENDS: ClassVar = True

    size: tuple[float, float]
    """Edge lengths [m]."""
    thickness: float
    """[m]"""
    bending: float = 1.0
    """Flexural rigidity over that of a plate of this thickness."""

    @classmethod
    def read(cls, form: int, values: tuple) -> Sheet:
        """Raises ValueError(message, hint, number of the value)."""
        size, thickness, bending = values
        bending = bending_of(bending, 2)
        if min(size) < 2.0 * thickness:
            wide, thick = number(min(size), 6), number(thickness, 6)
            cause = f"the sheet is less than twice as wide as it is thick: {wide} m, {thick} m thick"
            raise ValueError(cause, "write a smaller thickness, or shape box (lx, ly, lz) for a body so thick", 0)
        return cls(tuple(size), thickness, bending)

    @property
    def plate(self) -> Box:
        """The cuboid that it is."""
        return Box((*self.size, self.thickness))

    def write(self) -> tuple[int, tuple]:
        """Form and values that are read as this."""
        return 0, (self.size, self.thickness, None if self.bending == 1.0 else self.bending)


@dataclass(frozen=True, slots=True)
class Shell:
    """The surface of a solid shape, or that of a mesh, which may be open, as a sheet; bending as that of a sheet."""

    FORMS: ClassVar = ("sheet",)
    """Its word; it is written as another shape with TAIL behind."""
    TAIL: ClassVar = "[sheet thickness <t:m> [bending <@f>]]"
    ALSO: ClassVar = ()
    BENDS: ClassVar = True

    shape: Box | Sphere | Ellipsoid | Cylinder | Cone | Torus | Mesh
    """A mesh is all that is in its file, closed or not."""
    thickness: float
    """[m]"""
    bending: float = 1.0
    """Flexural rigidity over that of a plate of this thickness."""


SOLID = (Box, Sphere, Ellipsoid, Cylinder, Cone, Torus, Mesh)
"""Shapes that fill a volume, whose surface may be a sheet."""
HOLLOW = (Box, Sphere, Ellipsoid, Cylinder, Torus)
"""Shapes whose sheet may break into pieces: it is all that lies between a larger one and a smaller one."""


class OneShape(OneOf):
    """A shape; behind each that fills a volume may stand that its surface is a sheet."""

    def __init__(self) -> None:
        super().__init__(*(kind for kind in get_args(Shape) if kind is not Shell))
        self.form = " | ".join(f"{form} {Shell.TAIL}" if kind in SOLID else form for kind in self.kinds for form in kind.FORMS)

    def kind(self, choice: int, values: tuple) -> type:
        """Its class."""
        return Shell if self.rows[choice] in SOLID and values[-2] is not None else self.rows[choice]

    def read(self, k: Keyword, choice: int, values: tuple) -> Any:
        """Raises ValueError(message, hint, number of the value)."""
        if self.rows[choice] not in SOLID:
            return super().read(k, choice, values)
        *own, thickness, bending = values
        shape = super().read(k, choice, tuple(own))
        if thickness is None:
            return shape
        return Shell(shape, thickness, bending_of(bending, len(values) - 1))

    def write(self, k: Keyword, value: Any) -> tuple[int, tuple] | None:
        """Form and values that are read as this."""
        shape, tail = value, ()
        if isinstance(value, Shell):
            shape, tail = value.shape, (value.thickness, None if value.bending == 1.0 else value.bending)
        elif isinstance(value, SOLID):
            tail = None, None
        if (found := super().write(k, shape)) is None:
            return None
        return found[0], (*found[1], *tail)


def bending_of(given: float | None, at: int) -> float:
    """Factor of a sheet's resistance to bending, the value of this number. Raises ValueError(message, hint, its number)."""
    if given is not None and given < 0.0:
        raise ValueError(f"bending must be 0 or more, found {number(given, 6)}", "write bending 0 for what bends freely", at)
    return 1.0 if given is None else given


def mesh_of(shape: Any) -> Mesh | None:
    """The mesh that a shape is or whose surface it is; None of all else."""
    shape = shape.shape if isinstance(shape, Shell) else shape.of if isinstance(shape, PieceShape) else shape
    return shape if isinstance(shape, Mesh) else None


def with_path(shape: Any, path: Any) -> Any:
    """The shape with this file of its mesh."""
    return replace(shape, shape=replace(shape.shape, path=path)) if isinstance(shape, Shell) else replace(shape, path=path)


MOST_STRETCHED = 1.5
"""Distance of the ends of a rope over its length, at most."""
LEAST_SPAN = 0.01
"""Horizontal distance of the ends of a rope that hangs through, over its length, at least."""

Shape = Box | Sphere | Ellipsoid | Cylinder | Cone | Torus | Mesh | Rope | Sheet | Shell


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


@dataclass(frozen=True, slots=True)
class HoldEnds:
    """The first or the last particle of a rope never moves, or both."""

    FORMS: ClassVar = ("ends", "start", "end")

    start: bool
    end: bool

    @classmethod
    def read(cls, form: int, values: tuple) -> HoldEnds:
        """The ends of one form."""
        return cls(form != 2, form != 1)

    def write(self) -> tuple[int, tuple]:
        """Form and values that are read as these ends."""
        return (0 if self.start and self.end else 1 if self.start else 2), ()


Hold = HoldFaces | HoldAll | HoldWithin | HoldEnds


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
