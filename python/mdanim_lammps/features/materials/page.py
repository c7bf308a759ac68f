# SPDX-License-Identifier: GPL-2.0-only
"""docs/materials.md (``python -m mdanim_lammps.features.materials.page``), and what ``explain`` says of a material."""

from __future__ import annotations

import math
from collections.abc import Mapping

from ...scene.formatting import number, say
from .resolve import STIFF
from .table import CHOSEN, MATERIALS, MEANT, PAIRS, SOURCES, Figure, Material

UNITS = {"density": "kg/m^3", "elasticity": "Pa", "strength": "Pa"}
"""SI units of figures that have one."""

_TOP = f"""\
# Materials

<!-- Written by `python -m mdanim_lammps.features.materials.page` from table.py beside it: change that, not this page. -->

`material oak` in an object stands for density, elasticity, friction, restitution or damping, and a colour. A setting of
the object itself counts in place of that of its material, wherever it stands: `material oak  density 900 kg/m^3`;
`mass` counts in place of the density. `explain oak` prints the figures of one material.

```
object floor  {{ material stone   shape box (60, 60, 4) cm  position (0, 0, -2) cm  hold all }}
object marble {{ material glass   shape sphere 8 mm         position (-8, 0, 40) cm }}
object ball   {{ material rubber  shape sphere 2 cm         position (8, 0, 40) cm }}
```

A material of one's own is a block. It may build on another one, and bear the name of a known one, of which it then is
another form:

```
material balsa {{ material pine  density 170 kg/m^3  elasticity 4 GPa }}
material oak   {{ material oak   friction 0.3  color "#5b3a1a" }}
```

It is like `let balsa = {{ ... }}` with `use balsa`, which take any settings of objects as they stand; a material gives
an object only what suits it, by the rules below.

## When an object is rigid

An object of a material is `elasticity rigid` where waves in the material take c = sqrt(E/rho) = {STIFF:g} m/s or more:
what is struck at 10 m/s, as after a fall from 5 m, is strained by about v/c, a twentieth, which is not seen, and steps
of its springs would be short. It has the elasticity of the material all the same where it cannot be rigid, or is there
to bend: a rope or a chain, and an object of which a part is held (`hold face -x`). A note of `check` says what is rigid
by its material. To see a plank bend, write the elasticity beside it: `material oak  elasticity 11 GPa`; long thin bars
bend under their weight also where c is high.

`restitution` goes to rigid objects and to those that are held, `damping` to those that deform. A share of critical
damping in each spring is not a property of a material alone: the values here were chosen by what a ball of 10 cm in
default cells keeps of its speed when it falls half a metre onto stone: rubber 0.75, silicone 0.70, foam 0.66. Clay
keeps 0.47, more than clay does: elastic as it is here, it comes back from where it was pressed, and more damping does
not make it less.

## Friction of two materials

Two objects have sqrt(mu_A mu_B), as [everywhere](language.md#object), and the lower one of two restitutions. Against
ground, walls and basin an object has its own. What tables say of pairs, and what the rule makes of it:

"""

_MIDDLE = """
The rule is too high on ice, by a factor of two to three: write `contact block ice { friction 0.05 }`.

## Cloth

Woven cloth stretches far more easily than its threads, because these are bent around each other and straighten first.
So `material cotton` gives a `shape sheet` the density and elasticity of cloth, and a rope those of its fibres.
It also bends more easily than a plate of its thickness: the denims of C resist with 14 to 23 uN m, where
E t^3/12 is 820 uN m at 1 mm. Write `shape sheet (60, 40) cm thickness 1 mm bending 0.02` for a cloth that hangs in
folds. Paper and leather stretch as little in a sheet as they do elsewhere, so their steps are short; what one sees
is how they bend. A sheet of a hundredth of the elasticity with `bending 100` bends alike, and takes a tenth of the steps:
`material paper  elasticity 30 MPa  shape sheet (21, 29.7) cm thickness 0.1 mm bending 100`.

## Figures

Behind each value stand the range in which it is found and the letters of its sources; a star marks a choice of this program,
which has no source.

"""


def page() -> str:
    """The whole page."""
    parts = [_TOP, "| materials | measured | rule | source |\n|---|---|---|---|\n"]
    parts += [f"| {a}, {b} | {_range(low, high)} | {number(rule(a, b), 2)} | {source} |\n" for a, b, low, high, source in PAIRS]
    words = ["density", "elasticity", "c", "friction", "restitution", "damping", "strength"]
    parts += [_MIDDLE, f"| material | {' | '.join(words)} |\n|{'---|' * (len(words) + 1)}\n"]
    parts += [f"| **{name}**: {of.about} | {' | '.join(_cell(of, word) for word in words)} |\n" for name, of in MATERIALS.items()]
    parts += [
        f"| {name}, as `shape sheet` | {' | '.join(_of_sheet(of, word) for word in words)} |\n"
        for name, of in MATERIALS.items()
        if of.sheet
    ]
    parts += [
        "\nc = sqrt(E/rho) is the speed of waves in a thin rod. Strength is that in tension, "
        "which `strength` takes for objects with `pieces`.\n"
    ]
    parts += ["\n## Sources\n\n", *(f"- {key}: {text}\n" for key, text in SOURCES.items() if key != CHOSEN)]
    return "".join(parts)


def rule(a: str, b: str) -> float:
    """Friction of two materials in a scene [-]."""
    return math.sqrt(MATERIALS[a].friction.value * MATERIALS[b].friction.value)


def explained() -> dict[str, str]:
    """Texts of ``explain`` by the names of materials."""
    others = {
        name: f"{name}   is not a material of object {{ }}\n  instead: material {' or material '.join(meant)}"
        for name, meant in MEANT.items()
    }
    return others | {name: _told(name, material) for name, material in MATERIALS.items()}


def speed(material: Material, instead: Mapping[str, Figure] | None = None) -> float:
    """Speed of waves in it [m/s], with other figures in place of its own."""
    figures = material.figures() | dict(instead or {})
    return math.sqrt(figures["elasticity"].value / figures["density"].value)


def _told(name: str, material: Material) -> str:
    lines = [f"material {name}   a material of object {{ }}: {material.about}"]
    for word, figure in material.figures().items():
        chosen = "a choice of this program" if figure.source == CHOSEN else f"found {_range(figure.low, figure.high, word)}"
        lines.append(f"{word} {_value(figure.value, word)}   {chosen}{', with pieces' if word == 'strength' else ''}")
    if material.sheet:
        found = (f"{word} {_value(figure.value, word)}, found {_range(figure.low, figure.high, word)}"
                 for word, figure in material.sheet.items())  # fmt: skip
        lines.append(f"in a sheet {'; '.join(found)}")
    kind = "rigid" if speed(material) >= STIFF else "elastic"
    lines.append(
        f"waves in it take {say(speed(material), 'm/s', 2)}, so its objects are {kind}, but ropes and what is held in a part"
    )
    figures = [*material.figures().values(), *material.sheet.values()]
    keys = dict.fromkeys(key for figure in figures for key in figure.sources() if key != CHOSEN)
    lines += [f"{SOURCES[key]}" for key in keys]
    return "\n  ".join(lines)


def _of_sheet(material: Material, word: str) -> str:
    if word == "c":
        return say(speed(material, material.sheet), "m/s", 2)
    figure = material.sheet.get(word)
    return f"{_value(figure.value, word)} ({_range(figure.low, figure.high, word)}; {figure.source})" if figure else "the same"


def _cell(material: Material, word: str) -> str:
    if word == "c":
        return say(speed(material), "m/s", 2)
    figure: Figure | None = material.figures().get(word)
    if figure is None:
        return "-"
    if figure.source == CHOSEN:
        return f"{_value(figure.value, word)} *"
    return f"{_value(figure.value, word)} ({_range(figure.low, figure.high, word)}; {figure.source})"


def _range(low: float, high: float, word: str = "friction") -> str:
    return _value(low, word) if low == high else f"{_value(low, word)} to {_value(high, word)}"


def _value(x: float, word: str) -> str:
    return say(x, UNITS.get(word, ""), 4 if word == "density" else 3)


if __name__ == "__main__":
    print(page(), end="")
