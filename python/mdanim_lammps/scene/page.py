# SPDX-License-Identifier: GPL-2.0-only
"""docs/language.md, written from the fields of the records (``python -m mdanim_lammps.scene.keywords``)."""

from __future__ import annotations

from . import units
from .formatting import say, whole
from .keywords import BLOCKS, KEYWORDS, all_keywords
from .limits import LIMITS, MOST_FRAMES, MOST_OBJECTS, MOST_PLACES, MOST_ROUNDS, Limit
from .scene import QUANTITIES
from .schema import Keyword, Rule, meaning, syntax, units_shown

_TOP = """\
# The scene language

<!-- Written by `python -m mdanim_lammps.scene.keywords` from scene.py: change that file, not this page. -->

A scene is one UTF-8 text file. This is a complete scene:

```
# A rubber ball falls onto the floor
gravity (0, 0, -9.81) m/s^2
ground z 0 m
object ball {
  shape      sphere 10 cm
  position   (0, 0, 1) m
  mass       1.5 kg
  elasticity 150 kPa
  damping    0.1
}
control {
  time 2 s
  friction 0.5
}
```

## Rules

- `#` starts a comment, which ends with the line. A setting stands on a line, blocks are in braces; several
  settings may share a line (`control { time 2 s frames 25 fps }`). The order of blocks and settings is
  free, except that a `let` stands above its use.
- Texts are in straight quotes and contain no quote.
- All problems of a file are reported in one pass, each with its place, the cause, the value that was found
  and a way to fix it.
- What a scene may ask for is limited, see the [table](#limits).

### Numbers, vectors, units

- A number may be an expression: `+ - * / mod ^ ( )`, `sqrt sin cos tan asin acos atan atan2`,
  `exp log floor ceil round min max abs`, of vectors `norm dot cross`, `pi`, `rand(a, b)`. `^` binds strongest and goes from right
  to left; `-2^2` is -4; `mod` has the sign of the divisor.
- A vector is `(x, y, z)`. Vectors can be added, and multiplied by a number.
- A unit may follow any number, vector or bracket. It belongs to everything before it, up to a bracket, a
  comma, or the sign after the last unit: `rho*a*a kg` is (rho a a) kg, and `1 m + 20 cm` is 1.2 m. Terms
  of a sum that have a unit already keep theirs: `gap + 20 cm` with `let gap = 5 mm` is 20.5 cm. With `let gap = 5` it
  is refused: write `(gap + 20) cm` for 25 cm, `gap m + 20 cm` for 5.2 m.
- Bare numbers are SI: metres, kilograms, seconds, radians. `language strict` in the scene, or `check --strict`,
  refuses bare numbers where a unit belongs.
- Dimensions are checked: `mass 3 m` is an error, and so is the sum of a length and a time. An angle is
  not a plain number: write `spin (0, 0, 2) rad/s`, not `1/s`.
- A name at the place of an operand is a variable; right after a value it is a unit: with `let m = 3`, `m m` is 3
  metres.
- `rand(a, b)` is drawn from `control seed`, its place among the `rand`s of the scene, and the indices of
  the repeats around it. The same text is always the same scene, and one more round of a repeat does not change
  the others.

| kind | units |
|---|---|
"""

_AFTER_UNITS = """
Products, quotients and powers of these are units too: `kg*m/s^2`. `h` (hour) may only stand behind a `/`.

### let, repeat, include

```
let n = 8                       # a number, a quantity (150 kPa) or a vector
let wood = { density 500 kg/m^3  elasticity 2 MPa  color saddlebrown }
object beam { use wood  elasticity 3 MPa ... }
repeat i in 1 .. n {            # i = 1, 2, ... 8; nests
  object ball[i] { ... }
}
include "rubber.txt"            # relative to this file
```

- `let name = expression` gives a value a name. `--set name=value` on the command line takes its place. A
  `let` inside braces is known up to the closing brace.
- `let name = { ... }` gives settings of an object a name. `use name` in an object stands for them; what the object says itself
  counts instead. Such settings may use others, and are evaluated where the `let` stands.
- `material oak` gives an object the settings of a known material, or of a [`material` block](#material): those that suit it and
  that it has not itself. What these are stands in [materials](materials.md).
- `repeat i in a .. b { }` repeats its statements for the whole numbers i from a to b; objects, `expect` and
  `camera` lines, `hold` and other repeats may stand inside.
- An index is a number, which may be computed. Of two repeats write `object box[r][c]`; `box[r]` then stands for a row, and `box`
  for all. `box[r, c]` is refused.
- `include "file"` reads another file in its place, inside a block as well: a file with `density`, `elasticity` and
  `damping` is a material. A file that includes itself, and more than 16 levels,
  are errors that show the chain of files.
- There are no conditions and no other loops, so the evaluation of a scene always ends.

### group, place

```
group cart {                    # not in the scene yet: what it is made of, in a frame of its own
  let r = 8 cm
  object body { ... position (0, 0, 2*r + 6 cm) }
  repeat i in 1 .. 2 { object wheel[i] { ... position ((i - 1.5)*36 cm, 0, r) } }
  contact wheel ground { friction 0.8 }
}
place cart as left { position (-1, 0, 0) m  velocity (1, 0, 0) m/s }
repeat k in 1 .. 3 {
  place cart[k] { position (k, 0, 0) m  orientation axis (0, 0, 1) angle 30*k deg  set r = 6 cm }
}
expect cart[2].wheel[1].position.z = 6 cm +- 1 mm
```

- A `group` says what is placed together, a `place` puts it somewhere, turned, and with a velocity and a spin. All of
  it turns: positions, orientations, velocities and spins of its objects. A box in `hold within box` can be turned by
  right angles only.
- Objects are called by the place that they are in, `cart[2].wheel[1]`, in `expect`, `look` and everywhere else. In a
  `contact` block `cart[2]` stands for all objects of the place, `cart[2].wheel` for all of its wheels, `cart.wheel`
  for those of all carts.
- `set r = 6 cm` in a place takes the place of `let r` of the group, in the unit of the `let`. A group knows the names
  that stand above it, not those around its place. `rand` in it depends on the name of the place.
- Groups may be placed in groups, 8 levels deep. In a group stand objects, repeats, `contact` blocks, places and
  `include`s.
- Messages about a group name the line in it, and below that each place that it is used at.

### Gravity that changes

```
let T = 0.5 s
repeat i in 0 .. 100 {
  let t = i*20 ms
  gravity at t (2.5*sin(2*pi*t/T), 0, -9.81) m/s^2      # the ground shakes: this is what is felt on it
}
```

- Between its points gravity goes straight; before the first and behind the last it is as there. Twenty points in a
  period follow a sine to 1.2 per cent of its height, forty to 0.3.
- Steps are taken one by one, not in passes; it has no potential, and its work stands in the ledger as `gravity_work`.
- A liquid lies under one gravity: both together are refused. Forces of contact in `csv` are left out.

### LAMMPS commands

```
lammps {
  variable push equal 0.01*(step*dt<0.5)
  fix wind mobile addforce v_push 0 0
}
```

- For what the language does not have. Such a scene is run, checked, drawn at a time and built with `--trust` alone
  (from Python `Scene.load(path, trust=True)`): commands of LAMMPS can read and write files and start programs. Read
  them before, and write `--trust` for `resume` again.
- The lines are given to LAMMPS as they stand, in SI units, after all commands of the scene; names of `let` mean
  nothing in them. `group` `mobile` is all that can move, `type`, `mol` (objects, from 1), fixes and the rest are
  those of `in.NAME`, which `build` writes with the lines in it. Blanks at their beginning and empty lines are left
  out. A line with a `}` alone ends them.
- Particles, their number, the time step and the steps are those of the scene: a line that changes them is refused,
  and so is one that LAMMPS does not take, with its place.
- No promise is made for what they do. The bound on the time step does not know their forces, the ledger does not have
  their work: it stands in the residual, at which a run then does not stop. A resumed run runs them again, and what
  they have made (averages, thermostats) begins anew, so its bits may be others. Where particles are is kept and drawn
  as ever.
- They act on all objects together, so several executors are refused; threads, and ranks of `lmp`, are not.
"""

_END = """
A liquid may be called `liquid` or by its name: `expect water.level`.

A line ends with `= value`, `= value +- tolerance`, `= value +- p %` (per cent of the value), or with a bound:
`< value`, `> value`, `<= value`, `>= value`. `position` and `velocity` are followed by `.x`, `.y` or `.z`. Time is
written `at 2 s`; without it the check is made at the end of the run, or over the whole run for residuals and maxima.
"""


_LIMITS = """
## Limits

A value beyond its limit is an error at its line. The smallest value holds where a value must be above 0;
[security](security.md) lists the limits of files and expressions.

| what | largest | smallest |
|---|---|---|
"""


def _limits() -> list[tuple[str, str, Limit]]:
    """Limits by unit, and those of single keywords: what, SI unit, limit."""
    by_unit = [(limit.what, "" if unit == "1" else unit, limit) for unit, limit in LIMITS.items()]
    return by_unit + [(f"`{k.block}` `{k.name}`", "", k.limit) for k in all_keywords() if k.limit]


def language_page() -> str:
    """The whole page."""
    parts = [_TOP]
    parts += [f"| {kind.split(' ', 1)[1]} | {' '.join(f'`{u}`' for u in names.split())} |\n" for _, kind, names in units.LISTED]
    parts += [_AFTER_UNITS, "\n## Outside of all blocks\n\n", _table(KEYWORDS[""].values())]
    for block in BLOCKS.values():
        forms = block.head.replace(" | ", " { ... }\n")
        parts += [f"\n## {block.name}\n\n", f"```\n{forms} {{ ... }}\n```\n\n{block.about}\n\n"]
        own = KEYWORDS[block.name]
        if block.of:
            parts.append(f"Settings, as in `{block.of}`: {', '.join(f'**{word}**' for word in own)}.\n")
        else:
            parts[-1] = parts[-1] if own else parts[-1].removesuffix("\n")
            parts.append(_table(own.values()) if own else "")
    parts += [
        "\n## Quantities\n\n`expect` checks them, `record` writes them at every frame to `records.csv`: [how](show.md).\n\n",
        "| quantity | unit | meaning |\n|---|---|---|\n",
    ]
    listed = (of for of in QUANTITIES.items() if not of[1].narrows)
    parts += [f"| `{k}.{q}` | {x.unit if x.unit != '1' else '-'} | {meaning(k, x)} |\n" for (k, q), x in listed]
    parts += [_END, _LIMITS]
    numbers = [
        ("objects", MOST_OBJECTS), ("rounds of all repeats together", MOST_ROUNDS),
        ("placed groups", MOST_PLACES), ("frames", MOST_FRAMES),
    ]  # fmt: skip
    parts += [f"| {what} | {whole(most)} | - |\n" for what, most in numbers]
    parts += [
        f"| {what} | {say(x.most, unit, 6)} | {say(x.least, unit, 6) if x.least else '-'} |\n" for what, unit, x in _limits()
    ]
    return "".join(parts)


def _table(keywords) -> str:
    rows = ["| setting | unit | must be | default | meaning |\n|---|---|---|---|---|\n"]
    rows += [
        f"| {_form(k)} | {units_shown(k) or '-'} | {_rule(k)} | {_default(k)} "
        f"| {k.about}{' May be given several times.' if k.many else ''} |\n"
        for k in keywords
    ]
    return "".join(rows)


def _form(k: Keyword) -> str:
    """The forms of a setting, one below the other; a bar would end the cell of the table."""
    choices = [c.replace("|", "\\|") for c in syntax(k).split(" | ")]
    return f"**{k.name}** " + "<br>or ".join(f"`{c}`" for c in choices)


def _rule(k: Keyword) -> str:
    return "-" if k.rule is Rule.ANY else k.rule.value


def _default(k: Keyword) -> str:
    if k.needed:
        return "needed"
    if k.one_of:
        return f"one of {', '.join(k.one_of)}"
    return f"`{k.default}`" if k.default else "-"
