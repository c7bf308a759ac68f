# SPDX-License-Identifier: GPL-2.0-only
"""The words of the scene language: blocks and their keywords, as the fields of the records in scene.py give them.

``python -m mdanim_lammps.scene.keywords`` prints docs/language.md.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from typing import get_args

from ..features import facets
from .forms import Word, alternatives
from .placement import Placement
from .quantities import OVER
from .scene import Command, Control, Render, SceneRecord, Solid, Switch
from .schema import Block, Keyword, Words, keywords, syntax
from .shapes import Shape

BLOCKS = {b.name: b for b in (
    Block("object", Solid, "solids", "An elastic solid. Names are free; in a `repeat` an index keeps them apart.",
          names=("name",), indexed=True, many=True, in_group=True, enough=True),
    Block("group", None, "", "Objects that are placed together, once or several times, each time by a `place`. A group "
          "itself is not a part of the scene. Objects, repeats, `contact` blocks of these objects and other placed groups may "
          "stand in it; positions are those of its own frame. Its `let`s are settings that a `place` may change.",
          names=("name",)),
    Block("place", Placement, "", "Puts a group somewhere: its object `wheel[1]` becomes `cart.wheel[1]`. Each place of a group "
          "has a name of its own: `place cart as left`, or `place cart[i]` in a repeat. `set length = 3 cm` changes a `let` "
          "of the group.", names=("name",), indexed=True, many=True, in_group=True,
          form="GROUP[index] | place GROUP as NAME[index]"),
    *sorted((b for words in facets("words") for b in getattr(words, "BLOCKS", ())), key=lambda b: b.order),
    Block("lammps", Command, "lammps", "Commands for LAMMPS as they stand, a line each, up to a line with a } alone; run after "
          "those of the scene, and only with `--trust`: [what they can do](#lammps-commands).", many=True, raw=True),
    Block("effects", None, "effects", "Switches effects on or off by hand. `auto`, the default, runs only what the scene "
          "calls for; `off` on an effect that the scene needs is a warning."),
    Block("control", Control, "control", "How long, how finely, what is saved. Needed: `time`."),
    Block("render", Render, "render", "How the pictures look. Nothing here changes the motion."),
)}  # fmt: skip
"""Blocks by name."""
BLOCKS["group"] = replace(BLOCKS["group"], holds=tuple(b.name for b in BLOCKS.values() if b.in_group))

SCENE = SceneRecord
"""The record of a whole scene."""


def _switch(name: str, cause: str) -> Keyword:
    return Keyword(
        "<on|off|auto>",
        f"Called for by {cause}.",
        "off",
        codec=Words(Switch),
        default="auto",
        block="effects",
        name=name,
        field=name,
    )


KEYWORDS: dict[str, dict[str, Keyword]] = {
    "": keywords("", SCENE),
    **{name: keywords(name, block.record) for name, block in BLOCKS.items()},
    "effects": {name: _switch(name, cause) for words in facets("words") for name, cause in words.SWITCHES.items()},
}
"""Keywords by block and name; the empty string is the scene itself."""
KEYWORDS |= {
    b.name: {
        k.name: replace(k, block=b.name, one_of=(), needed=False, absent=None, default="")
        for k in KEYWORDS[b.of].values()
        if k.shared
    }
    for b in BLOCKS.values()
    if b.of
}

STATEMENTS = {
    "let": ("let name = expression", "Gives a number, a quantity or a vector a name. `--set name=value` overrides it."),
    "repeat": ("repeat i in a .. b { ... }", "Repeats what is in the braces for i = a, a + 1, ... b; nests."),
    "use": ("use name", "In an object: gives it the settings of `let name = { ... }`, unless it has its own."),
    "set": ("set name = expression", "In a `place`: gives a `let` of the group another value."),
    "include": ('include "file"', "Reads another file in this place; its name is relative to the including file."),
}
"""Statements that are not settings: how they are written, what they do."""

NOT_SUPPORTED = {
    "bounce": "set damping, 0.05 for a lively ball and 0.5 for clay; of rigid objects restitution",
    "motion": "give the object a velocity or a spin at the start; what is held moves by drive and key",
    "move": "give the object a velocity or a spin at the start; what is held moves by drive and key",
    "break": "write pieces 20  strength 10 MPa in an object with elasticity rigid",
    "tear": "write tear-strain 0.1 in a rope, a sheet or an elastic object",
    "balloon": "write inflate 5 kPa in an object with shape sphere 15 cm sheet thickness 1 mm",
    "glue": "write joint weld A B { }",
    "push": "write force (0.2, 0, 0) N from 1 s to 2 s in the object",
    "thrust": "write force (0.2, 0, 0) N from 1 s to 2 s in the object",
    "impulse": "write force (20, 0, 0) N from 1 s to 1.01 s in the object, or give it a velocity at the start",
    "addforce": "write force (0.2, 0, 0) N from 1 s to 2 s in the object",
    "plasticity": "write yield-strain 0.02 in an elastic solid: it keeps its dents",
    "plastic": "write yield-strain 0.02 in an elastic solid: it keeps its dents",
    "dent": "write yield-strain 0.02 in an elastic solid: it keeps its dents",
    "fracture": "write pieces 20  strength 10 MPa in an object with elasticity rigid",
    "temperature": "there is no heat in the model",
    "viscosity": "set drag in the liquid block",
    "wiggle": "drive oscillation moves what is held: hold all  drive oscillation (0, 0, 1) cm frequency 5 Hz",
    "conveyor": "hold all  drive surface (0.5, 0, 0) m/s carries what lies on it; drive velocity moves the plate itself",
    "belt": "hold all  drive surface (0.5, 0, 0) m/s carries what lies on it; drive velocity moves the plate itself",
    "shake": "drive oscillation moves what is held: hold all  drive oscillation (1, 0, 0) cm frequency 5 Hz",
    "vibrate": "drive oscillation moves what is held: hold all  drive oscillation (0, 0, 1) mm frequency 50 Hz",
    "wheel": "shape cylinder in an object, and joint hinge wheel cart { axis (0, 1, 0) } for its axle",
    "axle": "write joint hinge wheel cart { axis (0, 1, 0) }",
    "engine": "write motor speed 60 rpm in a joint hinge, or drive turn of what is held",
    "pendulum": "write joint hinge rod world { at (0, 0, 2) m axis (0, 1, 0) }, or hang it on a shape rope",
    "door": "write joint hinge door frame { at (1, 0, 1) m axis (0, 0, 1) }",
    "pulley": "shape cylinder with a joint hinge or hold all, and a shape rope that runs over it, with friction in both",
    "static": "write hold all: no particle of the object moves",
    "fixed": "write hold all: no particle of the object moves",
}
"""Words that people look for, which the language does not have, and what to write instead."""

MEANT = {
    "weight": "mass",
    "rotation": "orientation",
    "rotate": "orientation",
    "angle": "orientation",
    "tilt": "orientation",
    "pos": "position",
    "place": "position",
    "centre": "position",
    "center": "position",
    "speed": "velocity",
    "duration": "time",
    "stiffness": "elasticity",
}
"""Words of other programs for names that the language has."""

MISPLACED = {
    "expect within": "a tolerance is written as +-, e.g. = 2 m/s +- 2 %",
    **{f"expect {over}": f"it stands first, e.g. expect {over} ball.speed < 3 m/s" for over in OVER},
    "label from": 'a label has no times: leave them out, or write caption "..." from ...',
    "label to": 'a label has no times: leave them out, or write caption "..." to ...',
    "camera look": "write camera from (4, -4, 2) m look NAME, or camera follow NAME",
    **{f"{word} ,": f"one quantity in a line: write {word} again for the next" for word in ("record", "plot")},
    **{at: way_out for words in facets("words") for at, way_out in getattr(words, "MISPLACED", {}).items()},
}
"""A setting with a word that people write behind it, and what to write instead."""

SYNONYMS = {word: kind.FORMS[0].split()[0] for kind in get_args(Shape) for word in kind.ALSO}
"""Other words for shapes."""


def misplaced(keyword: Keyword, word: str, starts) -> str:
    """Hint for a word that does not follow a keyword, where people mean something by it; else empty."""
    if SYNONYMS.get(word) in starts:
        return f"did you mean '{SYNONYMS[word]}'?"
    return MISPLACED.get(f"{keyword.name} {word}", "")


def owner(settings: Mapping[str, Keyword], word: str) -> Keyword | None:
    """The one of some settings of which a form begins with a word; None where there are several, or it is one itself."""
    found = [k for k in settings.values() if word in beginnings(k)]
    return found[0] if len(found) == 1 and word not in settings else None


def beginnings(keyword: Keyword) -> list[str]:
    """Words with which forms of a setting begin."""
    return [parts[0].text for parts in alternatives(keyword.form) if parts and isinstance(parts[0], Word)]


def belongs(keyword: Keyword, word: str) -> str:
    """``it belongs to elasticity: write elasticity rigid``"""
    more = "" if (Word(word),) in alternatives(keyword.form) else " ..."
    return f"it belongs to {keyword.name}: write {keyword.name} {word}{more}"


def all_keywords() -> list[Keyword]:
    """The keywords of all blocks, in the order of the docs; one that blocks share counts where it is from."""
    return [k for name, block in KEYWORDS.items() if not (name and BLOCKS[name].of) for k in block.values()]


def example(keyword: Keyword) -> str:
    """``e.g. mass 2 kg``"""
    return f"e.g. {keyword.name} {keyword.example}"


def example_of(keyword: Keyword, words: Sequence[str]) -> str:
    """The form that begins with the first of some words, where the example is of another one: ``write shape cylinder r h``.
    Without words the example, and the forms that begin with a word."""
    if not words:
        others = [form for form in syntax(keyword).split(" | ") if form.split()[0] in beginnings(keyword)]
        return example(keyword) + (f", or {keyword.name} {'|'.join(others)}" if others else "")
    if words[0] in keyword.example.split():
        return example(keyword)
    forms = [form for form in syntax(keyword).split(" | ") if form.split()[0] == words[0]]
    return f"write {keyword.name} {forms[0]}" if forms else example(keyword)


def examples(keyword: Keyword) -> str:
    """``e.g. elasticity 200 kPa, or elasticity rigid``: with the forms that are words alone."""
    alone = (parts[0].text for parts in alternatives(keyword.form) if len(parts) == 1 and isinstance(parts[0], Word))
    return ", or ".join([example(keyword), *(f"{keyword.name} {word}" for word in alone)])


# --- help -------------------------------------------------------------------------------------------------


def did_you_mean(word: str, choices) -> str:
    """``did you mean 'mass'?``, or the choices where none is near: a third of the letters may be wrong, and one in any case."""
    choices = list(dict.fromkeys(choices))
    if (meant := MEANT.get(word.lower())) in choices:
        return f"did you mean '{meant}'?"
    close = [c for spelling in dict.fromkeys((word, word.lower())) for c in get_close_matches(spelling, choices, 8, 0.5)]
    far = {choice: edits(word.lower(), choice.lower()) for choice in close}
    near = [c for c in close if far[c] <= max(1, len(word) // 3) or (len(word) >= 3 and c.startswith(word))]
    if near:
        return f"did you mean '{min(near, key=far.get)}'?"
    return f"known here: {', '.join(choices)}" if 0 < len(choices) <= 20 else ""


def edits(a: str, b: str) -> int:
    """How many letters must be put in, taken out, replaced or swapped with the next one to make one word of the other."""
    before, row = [], [*range(len(b) + 1)]
    for i, letter in enumerate(a, 1):
        older, before, row = before, row, [i]
        for j, other in enumerate(b, 1):
            row.append(min(before[j] + 1, row[j - 1] + 1, before[j - 1] + (letter != other)))
            if i > 1 and j > 1 and (letter, a[i - 2]) == (b[j - 2], other):
                row[j] = min(row[j], older[j - 2] + 1)
    return row[-1]


class Named(dict):
    """Things by name; a KeyError suggests a name."""

    def __init__(self, kind: str, things):
        super().__init__(things)
        self._kind = kind

    def __missing__(self, name):
        raise KeyError(f"no {self._kind} is called {name!r}; {did_you_mean(str(name), self) or f'there are {len(self)}'}")


def foreign_line(text: str) -> int:
    """The first line of a text that says something, where it begins with no word of the language, nor with one that is nearly
    so; 0 for a text that may be a part of a scene. What else stands in such a text is nobody's to see."""
    for number, line in enumerate(text.splitlines(), 1):
        if said := line.partition("#")[0].strip():
            word = re.match(r"[a-z-]*", said)[0]
            known = {*BLOCKS, *STATEMENTS, *NOT_SUPPORTED, *(w for words in KEYWORDS.values() for w in words), "}"}
            return 0 if word in known or said[0] == "}" or (word and nearest(word, known)) else number
    return 0


def nearest(word: str, choices) -> str | None:
    """The choice that a mistyped word most likely stands for."""
    return next(iter(get_close_matches(word, list(choices), 1, 0.7)), None)


if __name__ == "__main__":
    from .page import language_page

    print(language_page(), end="")
