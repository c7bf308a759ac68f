# SPDX-License-Identifier: GPL-2.0-only
"""Quantities of a run, as scenes ask for them: in ``expect``, ``record``, ``plot`` and ``arrows``."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field
from typing import Any

from ..errors import Span
from ..features import facets
from ..records import dataclass
from .formatting import number
from .schema import Codec, Keyword, Observable

_OF_FEATURES = {of: quantity for words in facets("words") for of, quantity in getattr(words, "QUANTITIES", {}).items()}
QUANTITIES: dict[tuple[str, str], Observable] = {
    **{of: quantity for of, quantity in _OF_FEATURES.items() if of[0] == "NAME"},
    ("energy", "residual"): Observable("1", "relative error of the energy ledger", bound=True),
    **{of: quantity for of, quantity in _OF_FEATURES.items() if of[0] != "NAME"},
}
"""The one catalogue of quantities, by subject and word; NAME stands for any object, NAMES for several of one name."""

GLOBALS = tuple(dict.fromkeys(subject for subject, _ in QUANTITIES if subject not in ("NAME", "NAMES")))
"""Subjects of quantities that are not objects."""

VECTORS = tuple(
    word.removesuffix(".x")
    for subject, word in QUANTITIES
    if subject == "NAME" and word.endswith(".x") and all(("NAME", f"{word[:-1]}{axis}") in QUANTITIES for axis in "yz")
)
"""Quantities of objects that are vectors: they have components x, y, z."""

RELATIONS = {"=": "=", "<": "<", ">": ">", "<=": "<=", ">=": ">=", "≤": "<=", "≥": ">="}
"""How what is found may stand to a value, by how it is written."""
OVER = ("min", "max", "mean")
"""Numbers of all frames in a time that an ``expect`` may ask for."""

Argument = str | tuple[float, float] | float | None
PLANES = tuple(word for words in facets("words") for word, block in getattr(words, "TOUCHED", {}).items() if not block)
"""Planes that objects touch, as arguments of quantities of contact."""


TAKEN = {
    "object": ("another object", "(cube)"),
    "joined": ("another object, or world,", "(world), or in place of world the name of the object that it is joined to"),
    "touched": ("another object, ground or walls", "(ground)"),
    "place": ("a place (x, y)", "(0.2 m, 0 m)"),
    "cut": ("the place of a plane", "(0.2 m)"),
}
"""Arguments of quantities in words, and an example."""


def meant(kind: str, word: str, near: Callable[[str, list[str]], str]) -> str:
    """Hint for a word that is not a quantity of a kind of subject: its parts, those of which it is a part, the subject that has
    it, or what ``near`` finds among those that there are."""
    known = [q for k, q in QUANTITIES if k == kind]
    before, _, last = word.rpartition(".")
    whole = f"{before}." if before and len(last) == 1 else f"{word}."  # one letter is a component
    if parts := [q for q in known if q.startswith(whole)]:
        return f"write {', '.join(parts[:-1])} or {parts[-1]}" if len(parts) > 1 else f"write {parts[0]}"
    if part := next((q for q in (f"position.{word}", *known) if q in known and q.endswith(f".{word}")), None):
        return f"did you mean '{part}'?"
    if other := next((k for k in GLOBALS if (k, word) in QUANTITIES), None):
        takes = QUANTITIES[other, word].takes
        return f"it belongs to {other}: write {other}.{word}{TAKEN[takes][1] if takes else ''}"
    if kind == "NAME" and word == "energy":
        return "write kinetic, potential or elastic"
    return near(word, known)


class _OfQuantity:
    """The words of something that has ``subject``, ``quantity`` and ``argument``."""

    __slots__ = ()
    subject: str
    quantity: str
    argument: Argument
    of: str

    @property
    def what(self) -> str:
        """The quantity, as it is written in scenes."""
        return self.written(lambda x: number(x, 6))

    def written(self, number: Callable[[float], str]) -> str:
        """The same with its numbers in this form."""
        taken = self.argument
        if isinstance(taken, tuple):
            taken = ", ".join(f"{number(x)} m" for x in taken)
        elif isinstance(taken, float):
            taken = f"{number(taken)} m"
        return f"{self.subject}.{self.quantity}" + ("" if taken is None else f"({taken})")

    @property
    def key(self) -> tuple[str, str]:
        """Its place among QUANTITIES."""
        return (self.subject if self.subject in GLOBALS else self.of, self.quantity)

    @property
    def kind(self) -> Observable:
        """The kind of the quantity."""
        return QUANTITIES[self.key]

    @property
    def unit(self) -> str:
        """Its SI unit; empty for plain numbers."""
        unit = self.kind.unit
        return "" if unit == "1" else unit


@dataclass(frozen=True, slots=True)
class Asked(_OfQuantity):
    """A quantity whose values at all frames are asked for."""

    subject: str
    """Object name, ``liquid``, ``energy`` or ``penetration``."""
    quantity: str
    """``position.z``, ``velocity.x``, ``draft``, ``strain.max``, ``residual``, ``max`` ..."""
    argument: Argument = None
    """The other object of a distance, the place of a height or of a plane [m]; None of quantities that take none."""
    optional: bool = field(default=False, compare=False)
    """Whether it may be missing where it is not known."""
    span: Span | None = field(default=None, compare=False, repr=False)
    of: str = field(default="NAME", compare=False, repr=False)
    """Kind of its subject as in QUANTITIES: NAME for an object, NAMES for several of one name, itself for others."""


@dataclass(frozen=True, slots=True)
class Expect(_OfQuantity):
    """A self-check, evaluated after the run."""

    subject: str
    """As of `Asked`."""
    quantity: str
    value: float
    """SI."""
    tolerance: float = 0.0
    """SI, >= 0."""
    time: float | None = None
    """[s]; None is the end of the run (``strain.max``, ``penetration.max``, ``crest``, residuals: the whole run)."""
    relation: str = "="
    """One of RELATIONS."""
    argument: Argument = None
    """As of `Asked`."""
    over: str = ""
    """One of OVER; empty for the value at a time, or at all times of a window."""
    begin: float | None = None
    """Begin of a window that ends at ``time`` [s]; None without one."""
    span: Span | None = field(default=None, compare=False, repr=False)
    of: str = field(default="NAME", compare=False, repr=False)

    @property
    def said(self) -> str:
        """``max ball.speed``: the quantity, with what is asked of it."""
        return f"{self.over} {self.what}".lstrip()


class Check(Codec):
    """A self-check; its values are read in asked.py, for their unit is that of the quantity."""

    def write(self, k: Keyword, value: Any) -> tuple[int, tuple]:
        numbers = [f"{x!r} {value.unit}".rstrip() for x in (value.value, value.tolerance)]
        tolerance = numbers[1] if value.relation == "=" else None
        at, end = (value.time, None) if value.begin is None else (None, value.time)
        return 0, (value.over or None, value.written(repr), at, value.begin, end, value.relation, numbers[0], tolerance)


class QuantityName(Codec):
    """A quantity alone, as `Asked`; its names are checked in asked.py."""

    def read(self, k: Keyword, choice: int, values: tuple) -> Asked:
        return Asked(*values[0])

    def write(self, k: Keyword, value: Asked) -> tuple[int, tuple]:
        return 0, (value.written(repr),)
