# SPDX-License-Identifier: GPL-2.0-only
"""The words of the scene language: one table that parser, checks, messages, `explain` and docs read.

``python -m mdanim_lammps.scene.keywords`` prints docs/language.md.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from difflib import get_close_matches
from enum import Enum

from .limits import CONTACT_STIFFNESS, DAMPING, PIXELS, SWEEPS, Limit


class Rule(Enum):
    """What a number must be."""

    ANY = "any number"
    POSITIVE = "> 0"
    NOT_NEGATIVE = ">= 0"
    COUNT = "a whole number >= 1"
    WHOLE = "a whole number >= 0"

    def holds(self, x: float) -> bool:
        """Whether a finite number obeys the rule."""
        if self is Rule.ANY:
            return True
        if self is Rule.POSITIVE:
            return x > 0.0
        if self is Rule.NOT_NEGATIVE:
            return x >= 0.0
        return x == int(x) and (1 if self is Rule.COUNT else 0) <= x < 2**53


@dataclass(frozen=True, slots=True)
class Keyword:
    """One setting of the language."""

    block: str
    """Block it stands in; the empty string is the scene itself."""
    name: str
    form: str
    """What follows the word: literal words, ``<slot:unit>``, ``[optional]``, `` | `` between alternatives."""
    example: str
    """What could follow the word."""
    about: str
    rule: Rule = Rule.ANY
    """Holds for every number of the setting."""
    default: str = ""
    """As it would be written in a scene."""
    needed: bool = False
    many: bool = False
    """May be given several times."""
    one_of: tuple[str, ...] = ()
    """Exactly one of these is given."""
    limit: Limit | None = None
    """Holds for every number of the setting; None is the limit of its unit."""


@dataclass(frozen=True, slots=True)
class Block:
    """One kind of block in braces."""

    name: str
    head: str
    """What follows the word: nothing, ``NAME`` or ``NAME[index]``."""
    about: str
    many: bool = False


BLOCKS = {b.name: b for b in (
    Block("object", "NAME[index]",
          "An elastic solid. Names are free; in a `repeat` an index keeps them apart.", many=True),
    Block("liquid", "NAME", "The liquid of the scene; there is at most one, and it needs gravity along -z."),
    Block("effects", "", "Switches effects on or off by hand. `auto`, the default, runs only what the scene "
          "calls for; `off` on an effect that the scene needs is a warning."),
    Block("control", "", "How long, how finely, what is saved. Needed: `time`."),
    Block("render", "", "How the pictures look. Nothing here changes the motion."),
)}  # fmt: skip
"""Blocks by name."""

WORDS = (
    Keyword("", "title", '<"text">', '"Cube on a beam"',
            "Title of the scene, shown by `check` and in the movie.", default='""'),
    Keyword("", "gravity", "<(gx, gy, gz):m/s^2>", "(0, 0, -9.81) m/s^2",
            "Acceleration of free fall. Absent or zero: no gravity effect at all. With a liquid it must "
            "point along -z.", default="(0, 0, 0) m/s^2"),
    Keyword("", "ground", "z <h:m>", "z 0 m", "A floor plane at height h. Absent: no floor."),
    Keyword("", "walls", "from <(x0, y0, z0):m> to <(x1, y1, z1):m>", "from (-2, -2, 0) m to (2, 2, 3) m",
            "A box that objects never leave. Absent: no walls."),
    Keyword("", "expect", "<NAME.QUANTITY> [at <T:s>] = <value:?> [+- <tolerance:?>]",
            "ball.position.z at 1 s = 0.1 m +- 1 cm",
            "A self-check, evaluated after the run; a miss is exit code 6. Without `at`: the end of the "
            "run, and the whole run for residuals and maxima. Without `+-`: exactly.", many=True),

    Keyword("object", "shape", "box <(lx, ly, lz):m> | sphere <r:m> | ellipsoid <(rx, ry, rz):m> | "
            'cylinder <r:m> <h:m> | cone <r:m> <h:m> | torus <R:m> <r:m> | mesh <"file"> [scale <s>]',
            "sphere 10 cm",
            "Form of the object in its own frame: edge lengths, radii, heights along z. A mesh is a closed "
            "STL, OBJ or PLY file, beside the scene file; `scale` is metres per unit of the file, "
            "default 1.", Rule.POSITIVE, needed=True),
    Keyword("object", "position", "<(x, y, z):m>", "(0, 0, 1) m", "Centre of mass.", needed=True),
    Keyword("object", "orientation", "axis <(x, y, z)> angle <a:rad> | euler <(rx, ry, rz):rad> | "
            "matrix <(xx, xy, xz)> <(yx, yy, yz)> <(zx, zy, zz)>", "axis (1, 1, 0) angle 20 deg",
            "Turn about the centre of mass. `euler` turns about x, then y, then z, all fixed axes. "
            "`matrix` gives the rows of the rotation matrix (world = matrix * body); `scene.lock.txt` "
            "uses it.", default="axis (0, 0, 1) angle 0 rad"),
    Keyword("object", "mass", "<m:kg>", "2 kg",
            "Mass of the whole object.", Rule.POSITIVE, one_of=("mass", "density")),
    Keyword("object", "density", "<rho:kg/m^3>", "900 kg/m^3",
            "Mass per volume.", Rule.POSITIVE, one_of=("mass", "density")),
    Keyword("object", "elasticity", "<E:Pa> | spring <k:N/m>", "200 kPa",
            "Young's modulus; or the paper's one k for every spring, Wcislo 1999, eq. (3.6).",
            Rule.POSITIVE, needed=True),
    Keyword("object", "damping", "<zeta>", "0.05",
            "Internal damping, as a fraction of critical damping in each spring.", Rule.NOT_NEGATIVE, "0", limit=DAMPING),
    Keyword("object", "velocity", "<(vx, vy, vz):m/s>", "(0, 0, -1) m/s",
            "Velocity at the start.", default="(0, 0, 0) m/s"),
    Keyword("object", "spin", "<(wx, wy, wz):rad/s>", "(0, 0, 2) rad/s",
            "Angular velocity at the start, about the axes of the world.", default="(0, 0, 0) rad/s"),
    Keyword("object", "drag", "<lambda:N*s/m>", "0.5 N*s/m",
            "Air drag of the whole object, F = -lambda v, eq. (3.9).", Rule.NOT_NEGATIVE, "0 N*s/m"),
    Keyword("object", "hold", "faces <x|y|z> | face <-x|+x|-y|+y|-z|+z> | all | "
            "within box <(x0, y0, z0):m> to <(x1, y1, z1):m>", "faces x",
            "Particles that never move: both faces across an axis of the object, one face, all of them (a "
            "wedge, an obstacle), or those inside a box of the world at the start.", many=True),
    Keyword("object", "color", "<color>", "steelblue",
            'Colour in pictures: a CSS name or "#rrggbb". Absent: chosen automatically.'),

    Keyword("liquid", "basin", "from <(x0, y0, z0):m> to <(x1, y1, z1):m>",
            "from (-1, -1, 0) m to (1, 1, 1.2) m",
            "Solid floor and side walls; for objects the walls go on upward.", needed=True),
    Keyword("liquid", "density", "<rho:kg/m^3>", "1000 kg/m^3",
            "Mass per volume.", Rule.POSITIVE, needed=True),
    Keyword("liquid", "volume", "<V:m^3>", "2 m^3",
            "Volume, rounded to whole cells.", Rule.POSITIVE, one_of=("volume", "level")),
    Keyword("liquid", "level", "<z:m>", "0.5 m",
            "Height of the surface at the start.", one_of=("volume", "level")),
    Keyword("liquid", "fill", "from <(x0, y0, z0):m> to <(x1, y1, z1):m>",
            "from (-1, -1, 0) m to (0, 1, 1.2) m",
            "Part of the basin that the liquid starts in, behind a dam that is gone at once. Absent: all of it."),
    Keyword("liquid", "drag", "auto | <gamma:1/s>", "4 1/s",
            "Immersed solids feel F = -gamma rho V v with the immersed volume V; `auto` is sqrt(g/L) for a "
            "body of size L.", Rule.NOT_NEGATIVE, "auto"),
    Keyword("liquid", "model", "<surface|pressure|paper>", "surface",
            "`surface`: draft after Archimedes, occupancy by hexahedra, level rule. `pressure`: the same with the "
            "liquid's pressure on every outer face, so that an open hull floats by the air in it. `paper`: the literal "
            "rules of the paper, with a warning: not Archimedes, objects denser than about 0.4 of the liquid sink.",
            default="surface"),
    Keyword("liquid", "sweeps", "auto | <n>", "4", "Sweeps of the automaton per update.", Rule.COUNT, "auto",
            limit=SWEEPS),
    Keyword("liquid", "color", "<color>", "deepskyblue",
            'Colour in pictures: a CSS name or "#rrggbb". Absent: chosen automatically.'),

    Keyword("effects", "gravity", "<on|off|auto>", "off",
            "Called for by a gravity vector that is not zero.", default="auto"),
    Keyword("effects", "springs", "<on|off|auto>", "off",
            "Called for by an object that is not all held.", default="auto"),
    Keyword("effects", "contact", "<on|off|auto>", "off",
            "Called for by two objects that can meet.", default="auto"),
    Keyword("effects", "ground", "<on|off|auto>", "off", "Called for by `ground`.", default="auto"),
    Keyword("effects", "walls", "<on|off|auto>", "off", "Called for by `walls`.", default="auto"),
    Keyword("effects", "air-drag", "<on|off|auto>", "off",
            "Called for by an object's `drag`.", default="auto"),
    Keyword("effects", "damping", "<on|off|auto>", "off",
            "Called for by an object's `damping`.", default="auto"),
    Keyword("effects", "basin", "<on|off|auto>", "off",
            "Called for by the basin of a liquid and an object that can move.", default="auto"),
    Keyword("effects", "liquid", "<on|off|auto>", "off", "Called for by `liquid`.", default="auto"),
    Keyword("effects", "buoyancy", "<on|off|auto>", "off",
            "Called for by a liquid that an object can reach.", default="auto"),
    Keyword("effects", "liquid-drag", "<on|off|auto>", "off",
            "Called for by a liquid that an object can reach.", default="auto"),

    Keyword("control", "time", "<T:s>", "3 s", "Simulated duration.", Rule.POSITIVE, needed=True),
    Keyword("control", "frames", "<n:1/s>", "25 fps",
            "Frames per simulated second.", Rule.POSITIVE, "30 fps"),
    Keyword("control", "timestep", "auto | <dt:s>", "0.1 ms",
            "`auto` is certified before the run; a number above the bound is refused.",
            Rule.POSITIVE, "auto"),
    Keyword("control", "resolution", "auto | <h:m>", "2 cm", "Particle spacing.", Rule.POSITIVE, "auto"),
    Keyword("control", "accuracy", 'preview | balanced | reference | <"error p %">', '"error 2 %"',
            "How finely objects are resolved, or the error that is aimed at.", default="balanced"),
    Keyword("control", "contact-stiffness", "<factor>", "4",
            "What objects, ground and walls push back with, over E h, the stiffness of the material behind a surface; from "
            "0.1 to 100. Stiffer, objects sink less into each other, and time steps get shorter.", Rule.POSITIVE, "1",
            limit=CONTACT_STIFFNESS),
    Keyword("control", "seed", "<n>", "7", "Seed of `rand` and of the liquid.", Rule.WHOLE, "1"),
    Keyword("control", "save", "<all|boundary> [<single|double>]", "boundary single",
            "Which particles the trajectory holds, and its precision; the size is told before the run.",
            default="all double"),

    Keyword("render", "size", "<(w, h)>", "(1920, 1080)",
            "Width and height of the pictures in pixels.", Rule.COUNT, "(1280, 720)", limit=PIXELS),
    Keyword("render", "movie", '<"file.mp4">', '"ball.mp4"',
            "Name of the movie inside the output folder. Absent: `movie.mp4`."),
    Keyword("render", "background", "<color>", "white",
            'Background: a CSS name or "#rrggbb". Absent: chosen automatically.'),
    Keyword("render", "liquid", "<smooth|cells>", "cells",
            "`smooth`: the surface of the liquid as a smooth sheet. `cells`: the columns of the automaton as they "
            "are.", default="smooth"),
    Keyword("render", "camera", "[<T:s>] from <(x, y, z):m> look <(x, y, z):m or NAME> [up <(x, y, z)>]",
            "from (4, -4, 2) m look (0, 0, 0.5) m",
            "Where the camera stands and what it looks at; several lines with times T make a smooth path. "
            "`look NAME` follows an object. Absent: chosen so that everything is seen.", many=True),
)  # fmt: skip

KEYWORDS: dict[str, dict[str, Keyword]] = {block: {w.name: w for w in WORDS if w.block == block} for block in ("", *BLOCKS)}
"""Keywords by block and name."""

STATEMENTS = {
    "let": ("let name = expression", "Gives a number, a quantity or a vector a name. `--set name=value` overrides it."),
    "repeat": ("repeat i in a .. b { ... }", "Repeats what is in the braces for i = a, a + 1, ... b; nests."),
    "include": ('include "file"', "Reads another file in this place; its name is relative to the including file."),
}
"""Statements that are not settings: how they are written, what they do."""

NOT_SUPPORTED = {
    "friction": "objects slide freely, see docs/physics-contact.md",
    "restitution": "how high objects bounce follows from elasticity and damping: set damping",
    "rope": "a thin cylinder with hold comes near it",
    "cloth": "a thin box comes near it",
    "joint": "objects that touch are not tied to each other",
    "hinge": "objects that touch are not tied to each other",
    "glue": "objects that touch are not tied to each other",
    "motor": "give the object a spin at the start",
    "force": "give the object a velocity at the start, or set gravity",
    "torque": "give the object a spin at the start",
    "wind": "air is at rest; an object feels it by its drag",
    "plasticity": "solids are elastic",
    "fracture": "solids do not break",
    "temperature": "there is no heat in the model",
    "viscosity": "set drag in the liquid block",
    "rigid": "give the object a high elasticity, or write hold all",
    "static": "write hold all: no particle of the object moves",
    "fixed": "write hold all: no particle of the object moves",
}
"""Words that people look for, which the language does not have, and what to write instead."""

SYNONYMS = {
    word: shape
    for shape, words in (
        ("sphere", "ball globe"),
        ("box", "cube cuboid brick block plate"),
        ("cylinder", "rod disk disc tube"),
        ("torus", "ring donut"),
        ("cone", "pyramid"),
        ("mesh", "stl obj ply file"),
    )
    for word in words.split()
}
"""Other words for shapes."""

QUANTITIES = {
    **{
        ("NAME", f"{what}.{axis}"): (u, f"{about}, {axis}")
        for what, u, about in (("position", "m", "centre of mass"), ("velocity", "m/s", "velocity of the centre of mass"))
        for axis in "xyz"
    },
    ("NAME", "draft"): ("m", "immersed depth of an object, from the surface to its lowest point; needs a liquid"),
    ("NAME", "immersed"): ("1", "share of an object's volume below the surface; needs a liquid"),
    ("NAME", "strain.max"): ("1", "largest relative change of length of a spring"),
    ("liquid", "volume"): ("m^3", "volume of the liquid"),
    ("liquid", "residual"): ("1", "whole cells gained or lost"),
    ("liquid", "level"): ("m", "mean height of the surface"),
    ("energy", "residual"): ("1", "relative error of the energy ledger"),
    ("penetration", "max"): ("m", "deepest overlap of two objects"),
}
"""What ``expect`` can check: (subject, quantity) to (unit, meaning); NAME stands for any object."""

IMMERSION = ("draft", "immersed")
"""Quantities of an object that need a liquid."""

GLOBALS = ("liquid", "energy", "penetration")
"""Subjects of ``expect`` that are no objects."""


def example(keyword: Keyword) -> str:
    """``e.g. mass 2 kg``"""
    return f"e.g. {keyword.name} {keyword.example}"


def syntax(keyword: Keyword) -> str:
    """A form for people: ``box (lx, ly, lz) | sphere r``, units in brackets."""

    def shown(match: re.Match) -> str:
        text, _, u = match[1].partition(":")
        u, _, other = u.partition(" or ")
        return text + (f"|{other}" if other else "")

    return re.sub(r"<([^>]*)>", shown, keyword.form)


def units_shown(keyword: Keyword) -> str:
    """The SI units of a keyword's values, e.g. ``Pa, N/m``."""
    found = re.findall(r":([^>\s]+)", keyword.form)
    return ", ".join(dict.fromkeys(u for u in found if u not in ("?", "1")))


# --- help -------------------------------------------------------------------------------------------------


def did_you_mean(word: str, choices) -> str:
    """``did you mean 'mass'?``, or the choices where none is near."""
    choices = list(dict.fromkeys(choices))
    close = get_close_matches(word, choices, 1, 0.6) or get_close_matches(word.lower(), choices, 1, 0.6)
    if close:
        return f"did you mean '{close[0]}'?"
    return f"known here: {', '.join(choices)}" if 0 < len(choices) <= 20 else ""


def nearest(word: str, choices) -> str | None:
    """The choice that a mistyped word most likely stands for."""
    return next(iter(get_close_matches(word, list(choices), 1, 0.7)), None)


def explain(word: str) -> str:
    """Explain one word of the language for people; raises KeyError with a way out for an unknown one."""
    parts = []
    if word in STATEMENTS:
        form, about = STATEMENTS[word]
        parts.append(f"{form}\n  {about}")
    if word in BLOCKS:
        block = BLOCKS[word]
        names = ", ".join(KEYWORDS[word])
        parts.append(f"{_head(block)} {{ ... }}\n  {block.about}\n  settings: {names}")
    for k in WORDS:
        if k.name == word:
            where = f"in {k.block} {{ }}" if k.block else "outside of all blocks"
            facts = [f"{k.name} {syntax(k)}   ({where})", k.about, *_facts(k), example(k)]
            parts.append("\n  ".join(facts))
    if not parts:
        known = [*STATEMENTS, *BLOCKS, *(k.name for k in WORDS)]
        raise KeyError(f"'{word}' is no word of the scene language; {did_you_mean(word, known)}")
    return "\n\n".join(parts)


def _head(block: Block) -> str:
    return f"{block.name} {block.head}".rstrip()


def _facts(k: Keyword) -> list[str]:
    """Unit, rule and default of a keyword, one line each."""
    facts = []
    if units_shown(k):
        facts.append(f"unit: {units_shown(k)}")
    if k.rule is not Rule.ANY:
        facts.append(f"must be {k.rule.value}")
    if k.needed:
        facts.append("must be given")
    elif k.one_of:
        facts.append(f"exactly one of {' and '.join(k.one_of)} is given")
    elif k.default:
        facts.append(f"default: {k.default}")
    if k.many:
        facts.append("may be given several times")
    return facts


if __name__ == "__main__":
    from .page import language_page

    print(language_page(), end="")
