# SPDX-License-Identifier: GPL-2.0-only
"""Scenes made of every word of the language at random: some are right, most have a value that cannot be, some are mutilated."""

from __future__ import annotations

import random
import re

from mdanim_lammps.scene.forms import OptionalPart, Slot, Word, alternatives
from mdanim_lammps.scene.keywords import KEYWORDS
from mdanim_lammps.scene.scene import QUANTITIES, RELATIONS
from mdanim_lammps.scene.schema import Keyword

NAMES = ("ball", "slab", "cup")
SANE = {
    "m": ("5 cm", "20 cm", "0.3 m", "1 m", "12 mm"), "s": ("50 ms", "0.2 s", "0.1 s"), "kg": ("1 kg", "200 g"),
    "kg/m^3": ("1000", "300 kg/m^3", "2 g/cm^3"), "Pa": ("100 kPa", "1 MPa", "2e5"), "m/s": ("1", "-2 m/s", "0.1 m/s"),
    "m/s^2": ("-9.81", "0", "-9.81 m/s^2"), "rad": ("20 deg", "1 rad"), "rad/s": ("1", "3 rad/s"), "1/s": ("0.5", "25 fps"),
    "m^3": ("1 l", "0.01"), "m^3/s": ("1e-3",), "1": ("0.1", "0.5", "1", "2", "3"), "?": ("0.1",),
}  # fmt: skip
"""By unit: numbers that a scene may well have."""
ODD = (
    *("0", "-1", "1e308", "1e-320", "9^99", "nan", "inf", "1e6", "1/0", "rand(-1, 1)"),
    *("2 kg m", "3 lb", "auto", "x", "(1, 2)", '"text"', ""),
)
MORE = '{}()[],=-^*/"# \n\t\0é\u2028'
RIGHT = {
    ".gravity": ("(0, 0, -9.81) m/s^2",),
    ".ground": ("z 0 m",),
    ".walls": ("from (-3, -3, -1) m to (3, 3, 3) m",),
    ".expect": ("energy.residual = 0 +- 1", "ball.position.z at 0.2 s = 0 +- 1 m", "penetration.max = 0 +- 1 m"),
    "object.shape": ("box (10, 10, 10) cm", "sphere 8 cm", "cylinder 8 cm 12 cm", "torus 12 cm 5 cm", "ellipsoid (8, 9, 10) cm"),
    "object.material": ("oak", "rubber", "glass"),
    "object.orientation": ("axis (1, 0, 0) angle 20 deg", "euler (0, 20, 10) deg"),
    "object.hold": ("all", "face -z", "faces x"),
    "liquid.basin": ("from (-1, -1, 0) m to (1, 1, 1) m",),
    "liquid.level": ("20 cm",),
    "liquid.volume": ("0.5 m^3",),
    "liquid.model": ("waves", "surface"),
    "control.time": ("0.2 s",),
    "control.frames": ("50 fps", "100 fps"),
    "control.timestep": ("auto",),
    "control.resolution": ("5 cm", "4 cm"),
    "control.contact-model": ("surface",),
    "control.contact-damping": ("0.3",),
    "control.seed": ("7",),
    "control.friction": ("0.5",),
    "contact.friction": ("0.3",),
    "render.camera": ("from (4, -4, 2) m look (0, 0, 0.5) m", "from (4, -4, 2) m look ball"),
    "render.movie": ('"a.mp4"',),
    "place.position": ("(0, 1, 0) m",),
    "place.orientation": ("axis (0, 0, 1) angle 20 deg",),
    "place.velocity": ("(0, 1, 0) m/s",),
    "place.spin": ("(0, 0, 1) rad/s",),
}
"""By word: values with which a scene can be right."""
GROUP = """let wood = { density 500 kg/m^3 elasticity 1 MPa }
group few { let r = 5 cm
  repeat i in 1 .. 2 { object egg[i] { use wood shape sphere r position (0.3*i, 1, 0.5) m } }
  contact egg egg { friction 0.2 }
}"""
MORE_LINES = ("let stone = { density 2000 color gray }", "gravity at 0.1 s (0, 0, -5) m/s^2", "lammps {\nfix a all nve\n}")
PLACES = {"ball": "(0, 0, 50) cm", "slab": "(0.6, 0, 0.5) m", "cup": "(-0.6, 0, 0.5) m"}
BASE = {
    "object": ("shape", "position", "density", "elasticity"),
    "liquid": ("basin", "density", "level"),
    "control": ("time", "friction"),
    "contact": ("friction",),
}
"""Settings without which a block is refused at once."""


def scene(chance: random.Random, used: set[str]) -> str:
    """The text of a scene; adds ``block.keyword`` of all words in it to ``used``."""
    odd = chance.choice((0.0, 0.0, 0.0, 0.05, 0.3))
    make = _Maker(chance, odd, used)
    lines = [make.setting(k) for k in KEYWORDS[""].values() if chance.random() < (0.8 if k.name == "gravity" else 0.3)]
    names = NAMES[: chance.randrange(1, 4)]
    blocks = [f"object {name}" for name in names]
    more = ("liquid w", "contact ball slab", "effects", "render", "place few", "material own")
    blocks += [b for b in more if chance.random() < 0.3]
    if odd == 0.0 and len(names) < 2:
        blocks = [b for b in blocks if not b.startswith("contact")]
    for head in (*blocks, "control"):
        kind, _, name = head.partition(" ")
        words = [k for k in KEYWORDS[kind].values() if k.name in BASE.get(kind, ()) or chance.random() < 0.25]
        chance.shuffle(words)
        if odd == 0.0:
            words = [k for n, k in enumerate(words) if not any(other.name in k.one_of for other in words[:n])]
        settings = [
            "position " + PLACES[name] if odd == 0.0 and f"{kind}.{k.name}" == "object.position" else make.setting(k)
            for k in words
        ]
        if kind == "place":
            lines.append(GROUP)
        lines.append(f"{head} {{\n" + "".join(f"  {s}\n" for s in settings) + "}")
    if chance.random() < 0.2:
        more = ("let a = 3 cm", "repeat i in 1 .. 3 { let b = i }", *MORE_LINES, *(['include "x"'] if odd else []))
        lines.insert(chance.randrange(len(lines)), chance.choice(more))
    text = "\n".join(lines) + "\n"
    return mutilated(text, chance) if chance.random() < (0.3 if odd else 0.1) else text


def mutilated(text: str, chance: random.Random) -> str:
    """Some words of a text deleted, doubled, swapped, replaced."""
    parts = re.findall(r"\s+|\w+|.", text)
    for _ in range(chance.randrange(1, 6)):
        i, j = chance.randrange(len(parts)), chance.randrange(len(parts))
        match chance.randrange(4):
            case 0:
                parts[i] = ""
            case 1:
                parts[i] *= 2
            case 2:
                parts[i], parts[j] = parts[j], parts[i]
            case 3:
                parts[i] = chance.choice((*ODD, *MORE))
    return "".join(parts)


class _Maker:
    """Writes settings by the forms of their keywords."""

    def __init__(self, chance: random.Random, odd: float, used: set[str]):
        self.chance, self.odd, self.used = chance, odd, used

    def setting(self, k: Keyword) -> str:
        self.used.add(word := f"{k.block}.{k.name}")
        if self.odd == 0.0 and word in RIGHT:
            return f"{k.name} {self.chance.choice(RIGHT[word])}"
        if self.chance.random() < 0.4:
            return f"{k.name} {k.example}"
        return f"{k.name} {self.parts(self.chance.choice(alternatives(k.form)))}"

    def parts(self, parts) -> str:
        out = []
        for part in parts:
            if isinstance(part, Word):
                out.append(part.text)
            elif isinstance(part, OptionalPart):
                if self.chance.random() < 0.5:
                    out.append(self.parts(part.parts))
            else:
                out.append(self.value(part))
        return " ".join(out)

    def value(self, slot: Slot) -> str:
        if self.chance.random() < self.odd:
            return self.chance.choice(ODD)
        match slot.kind:
            case "text":
                return self.chance.choice(('"ball.mp4"', '"nothing.stl"', '"a b"'))
            case "choice":
                return self.chance.choice(slot.choices)
            case "color":
                return self.chance.choice(("red", '"#aabbcc"', "steelblue"))
            case "check":
                subject, quantity = self.chance.choice(list(QUANTITIES))
                taken = {"object": "(slab)", "place": "(0.1 m, 0 m)"}.get(QUANTITIES[subject, quantity].takes, "")
                return f"{subject.replace('NAME', 'ball')}.{quantity}{taken}"
            case "relation":
                return self.chance.choice(sorted(RELATIONS))
            case "place" if self.chance.random() < 0.5:
                return self.chance.choice(NAMES)
        number = self.chance.choice(SANE.get(slot.unit, SANE["1"]))
        if slot.length == 1:
            return number
        bare = [number.split()[0] if self.chance.random() < 0.8 else "0" for _ in range(slot.length)]
        unit = number.partition(" ")[2]
        return f"({', '.join(bare)}) {unit}".rstrip()
