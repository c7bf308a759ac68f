# SPDX-License-Identifier: GPL-2.0-only
"""Checks of the quantities that a scene asks for: in ``expect``, ``record``, ``plot`` and ``arrows``."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ..errors import Span
from . import units
from .evaluated import EvaluatedBlock, EvaluatedSetting
from .formatting import number, with_article
from .keywords import BLOCKS, did_you_mean
from .limits import MOST_COPIES, copies
from .quantities import GLOBALS, PLANES, QUANTITIES, TAKEN, Asked, Check, Expect, QuantityName, meant

if TYPE_CHECKING:
    from .scene import Control, Render
    from .validate import Validator

ASKED = (Check, QuantityName)
"""Codecs of settings that are read here."""
MOST_PANELS = 3
"""Panels of curves in a picture."""


def asked_for(v: Validator, control: Control | None) -> dict[str, tuple]:
    """Fields of the scene with what ``expect`` and ``record`` ask for."""
    expects = (_expect(v, s, control) for s in v.out.settings.get("expect", ()))
    records = (quantity(v, s.values[0], s.span(0)) for s in v.out.settings.get("record", ()))
    return {"expects": tuple(filter(None, expects)), "records": tuple(dict.fromkeys(filter(None, records)))}


def quantity(v: Validator, named: tuple, span: Span) -> Asked | None:
    """A quantity with names that there are; None after an error."""
    subject, word, argument = named
    if subject not in GLOBALS:
        subject = v.own_names.get(subject, subject)
    kind = subject if subject in GLOBALS else "NAME"
    if kind == "NAME" and subject in v.named and subject not in v.names and ("NAMES", word) in QUANTITIES:
        kind = "NAMES"
    if kind == "NAME" and not v.known_object(subject, span, (*v.own_names, *GLOBALS)):
        return None
    if (kind, word) not in QUANTITIES:
        v.problem(span, f"{word} is not a quantity of {subject}", meant(kind, word, did_you_mean))
        return None
    of = QUANTITIES[kind, word]
    if of.takes and not of.alone and argument is None:
        what, example = TAKEN[of.takes]
        v.problem(span, f"{word} needs {what} in brackets", f"write {subject}.{word}{example}")
        return None
    if isinstance(argument, str) and not _known_other(v, subject, word, argument, span, of.takes):
        return None
    if of.needs in BLOCKS and v.has_scene and not v.blocks(of.needs) and not v.out.excused(of.needs):
        cause = f"{subject}.{word} needs {with_article(of.needs)} block, and the scene has none"
        v.problem(span, cause, f"write one, as 'mdanim-lammps explain {of.needs}' shows, or take this out")
    return Asked(subject, word, argument, span=span, of=kind)


def check_render(v: Validator, block: EvaluatedBlock, render: Render) -> Render:
    """Names of what pictures show, quantities of their curves, times of captions."""
    if v.has_scene and not v.names and not v.out.excused("object"):
        for word in ("arrows", "freeze", "color-by"):
            for s in block.settings.get(word, ())[:1]:
                cause = f"{word} needs an object, and the scene has none"
                v.problem(s.span(), cause, "take it out; a curve is  plot liquid.height(0.2 m, 0 m)")
    plots = shown(v, block)
    for s in block.settings.get("caption", ()):
        _, begin, end = s.values
        if end is not None and end <= (begin or 0.0):
            cause = f"the caption ends at {number(end, 6)} s and begins at {number(begin or 0.0, 6)} s"
            v.problem(s.span(2), cause, "write the earlier time first")
    if len(units_of := dict.fromkeys(of.unit for of in plots)) > MOST_PANELS:
        cause = f"curves of {len(units_of)} units are asked for, and a picture has room for {MOST_PANELS} panels"
        v.problem(block.settings["plot"][-1].span(), cause, "leave some out; record takes any number")
    arrows = (replace(one, span=s.span()) for one, s in zip(render.arrows, block.settings.get("arrows", ())))
    return replace(render, plot=plots, arrows=tuple(arrows))


def shown(v: Validator, block: EvaluatedBlock) -> tuple[Asked, ...]:
    """The quantities of curves; names in a ``render`` block that there are not are problems, also where others make it none."""
    for word, at in (("arrows", 1), ("trail", 0), ("label", 0)):
        for s in block.settings.get(word, ()):
            if s.values[at] is not None and s.values[at] not in v.named:
                v.known_object(s.values[at], s.span(at), v.named)
    plots = (quantity(v, s.values[0], s.span(0)) for s in block.settings.get("plot", ()))
    return tuple(dict.fromkeys(filter(None, plots)))


def check_shown_in_time(v: Validator, control: Control | None, render: Render | None) -> None:
    """Captions that begin, and copies that would be left, when the run has ended; too many copies."""
    if control is None or render is None:
        return
    (block,), ends = v.blocks("render")[:1], f"and the run ends at {number(control.time, 6)} s"
    for s, one in zip(block.settings.get("caption", ()), render.caption):
        if one.begin is not None and one.begin > control.time:
            cause = f"the caption begins at {number(one.begin, 6)} s, {ends}"
            v.problem(s.span(1), cause, "write an earlier time behind from", "warning")
    if render.freeze is not None and render.freeze > control.time:
        cause = f"the first copy would be left at {number(render.freeze, 6)} s, {ends}"
        v.problem(render.spans["freeze"], cause, "write a shorter time", "warning")
    elif render.freeze is not None and (left := copies(control.time, render.freeze)) > MOST_COPIES:
        cause = f"{number(left, 3)} copies would cover the picture; {MOST_COPIES} are the most"
        v.problem(render.spans["freeze"], cause, f"e.g. freeze {number(control.time / 10.0, 2)} s")


def _known_other(v: Validator, subject: str, word: str, other: str, span: Span, takes: str) -> bool:
    """Another object, the world, or what objects touch besides each other."""
    if not takes:
        v.problem(span, f"{subject}.{word} has nothing in brackets", f"write {subject}.{word}")
        return False
    if takes == "touched" and other in PLANES and other not in v.names:
        if v.has_scene and not v.out.first(other) and not v.out.excused(other):
            v.problem(span, f"the scene has no {other}", "name what there is to touch, or leave the brackets out")
            return False
        return True
    if other != subject:
        more = {"joined": ("world",), "touched": PLANES}.get(takes, ())
        return other in more or v.known_object(other, span, more)
    v.problem(span, f"the {word} of {subject} and itself is 0", "name another object")
    return False


def _expect(v: Validator, s: EvaluatedSetting, control: Control | None) -> Expect | None:
    """One self-check, with the unit of its quantity."""
    over, named, at, begin, end, relation, value, tolerance = s.values
    of = quantity(v, named, s.span(1))
    if of is None or not _times(v, s, control):
        return None
    dim = units.unit(of.kind.unit).dim
    numbers, part = [], "%" in s.entry.words
    for n, (x, what) in enumerate(((value, "the value"), (tolerance, "the tolerance")), 6):
        if x is None:
            numbers.append(0.0)
            continue
        if n == 7 and (cause := _tolerance_unfit(relation, part, numbers[0], x)):
            v.problem(s.span(n), *cause)
            return None
        if units.dimension(x) not in (dim, units.NONE):
            v.problem(
                s.span(n),
                f"{of.subject}.{of.quantity} is {units.describe_unit(of.kind.unit)}, found {units.show(x)}, "
                f"{units.describe(units.dimension(x))}",
                f"units that fit: {' '.join(units.fitting(of.kind.unit))}" if dim != units.NONE else "leave out the unit",
            )
            return None
        if not math.isfinite(units.magnitude(x)):
            v.problem(s.span(n), f"{what} is not a finite number")
        numbers.append(units.magnitude(x))
    if numbers[1] < 0.0:
        v.problem(s.span(7), f"the tolerance must be >= 0, found {units.show(tolerance)}")
    if part:
        numbers[1] *= abs(numbers[0]) / 100.0
    time = at if end is None else end
    return Expect(of.subject, of.quantity, *numbers, time, relation, of.argument, over or "", begin, s.span(), of.of)


def _times(v: Validator, s: EvaluatedSetting, control: Control | None) -> bool:
    """Whether its times are one moment, or a window that ends after it begins; those outside of the run are problems, too."""
    over, at, begin, end = s.values[0], *s.values[2:5]
    if at is not None and begin is not None:
        v.problem(s.span(3), "an expect is at a time, or from one to another, not both", "leave one of them out")
        return False
    if at is not None and over:
        v.problem(s.span(2), f"{over} is of many moments, found one", "write from T0 to T1 in place of at T")
        return False
    if begin is not None and end <= begin:
        cause = f"the window ends at {number(end, 6)} s and begins at {number(begin, 6)} s"
        v.problem(s.span(4), cause, "write the earlier time first")
        return False
    for n, time in ((2, at), (3, begin), (4, end)):
        if time is not None and (time < 0.0 or (control is not None and time > control.time * (1.0 + 1e-9))):
            stop = f", which ends at {number(control.time, 6)} s" if control else ""
            v.problem(s.span(n), f"{number(time, 6)} s lies outside the run{stop}", "an earlier time, or a longer control time")
    return True


def _tolerance_unfit(relation: str, part: bool, value: float, tolerance: Any) -> tuple[str, str] | None:
    """Cause and way out where a tolerance says nothing."""
    if relation != "=":
        return f"a tolerance cannot follow '{relation}'", f"write the bound itself, or = {number(value, 6)} +- ..."
    if part and units.dimension(tolerance) != units.NONE:
        return f"per cent is of a plain number, found {units.show(tolerance)}", "leave out the unit, or the per cent"
    if part and value == 0.0:
        return "per cent of 0 is nothing", "write a tolerance with the unit of the value"
    return None
