# SPDX-License-Identifier: GPL-2.0-only
"""Forms of data of strangers, to which the values of a JSON file are held before anything uses them.

A form is a function of a value. It gives the value back, with only those names in it that it knows, or raises `Misfit`, a
ValueError that says where something else stands, and what.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Mapping
from typing import Any

Form = Callable[[Any], Any]

LARGEST = 2**53
"""Whole numbers are at most this: beyond it a page, whose numbers are all of double precision, would round them."""


class Misfit(ValueError):
    """A value that has not the form that it should have."""

    def __init__(self, what: str, place: str = ""):
        shown = "".join(c if c.isprintable() else "?" for c in place[:60])
        super().__init__(f"{shown.removeprefix('.')} {what}".strip())
        self.what, self.place = what, place


def strict_json(text: str | bytes) -> Any:
    """The value of a JSON text, without NaN, Infinity, and numbers too large to be held. Raises ValueError, RecursionError."""
    return json.loads(text, parse_constant=_refuse, parse_float=_finite)


def _refuse(name: str) -> None:
    raise ValueError(f"{name} is not a number of JSON")


def _finite(digits: str) -> float:
    value = float(digits)
    if not math.isfinite(value):
        raise ValueError(f"{digits[:40]} is too large for a number")
    return value


def number(value: Any) -> float:
    """A finite number."""
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not abs(value) <= sys.float_info.max:
        raise Misfit(f"must be a number, found {shown(value)}")
    return value


def positive(value: Any) -> float:
    """A finite number above 0."""
    if not number(value) > 0.0:
        raise Misfit(f"must be above 0, found {shown(value)}")
    return value


def whole(value: Any) -> int:
    """A whole number of at least 0."""
    if type(value) is not int or not 0 <= value <= LARGEST:
        raise Misfit(f"must be a whole number of at least 0, found {shown(value)}")
    return value


def text(value: Any) -> str:
    """A text that can be written as UTF-8."""
    if not isinstance(value, str) or not _is_text(value):
        raise Misfit(f"must be a text, found {shown(value)}")
    return value


def flag(value: Any) -> bool:
    """True or false."""
    if not isinstance(value, bool):
        raise Misfit(f"must be true or false, found {shown(value)}")
    return value


def maybe(form: Form) -> Form:
    """None, or a value of a form."""
    return lambda value: None if value is None else form(value)


def many(form: Form) -> Form:
    """A list whose entries have a form."""

    def check(value: Any) -> list:
        if not isinstance(value, list):
            raise Misfit(f"must be a list, found {shown(value)}")
        return [_within(f"[{index}]", form, entry) for index, entry in enumerate(value)]

    return check


def table(form: Form) -> Form:
    """A table of any names, with values of a form."""

    def check(value: Any) -> dict:
        if not isinstance(value, dict):
            raise Misfit(f"must be a table of names and values, found {shown(value)}")
        return {text(name): _within(f".{name}", form, entry) for name, entry in value.items()}

    return check


def record(needed: Mapping[str, Form], others: Mapping[str, Form] | None = None) -> Form:
    """A table with names that are needed, and others that may be there; names that it does not know are left out."""
    forms = {**needed, **(others or {})}

    def check(value: Any) -> dict:
        if not isinstance(value, dict):
            raise Misfit(f"must be a table of names and values, found {shown(value)}")
        if missing := [name for name in needed if name not in value]:
            raise Misfit(f"has no {missing[0]}")
        return {name: _within(f".{name}", form, value[name]) for name, form in forms.items() if name in value}

    return check


def shown(value: Any) -> str:
    """The begin of a value, for a message."""
    words = ascii(value) if isinstance(value, (str, int, float, bool, type(None))) else type(value).__name__
    return words if len(words) <= 40 else f"{words[:40]}..."


def _within(place: str, form: Form, value: Any) -> Any:
    try:
        return form(value)
    except Misfit as misfit:
        raise Misfit(misfit.what, place + misfit.place) from None


def _is_text(value: str) -> bool:
    try:
        value.encode()
    except UnicodeEncodeError:
        return False
    return True
