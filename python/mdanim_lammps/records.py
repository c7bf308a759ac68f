# SPDX-License-Identifier: GPL-2.0-only
"""Records: `dataclasses.dataclass`, whose methods are not compiled before they are used.

The standard decorator writes five to six methods of each class as text and compiles them when the class is made: of 170 classes
that is a quarter of the time that a program takes to start. Here what compares, hashes, shows and protects a record is one
function for all classes, and ``__init__`` is compiled when the first record of a class is made.
"""

from __future__ import annotations

import dataclasses
import sys
from collections.abc import Callable, Sequence
from dataclasses import MISSING, Field, FrozenInstanceError, fields
from operator import attrgetter
from reprlib import recursive_repr
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dataclasses import dataclass
else:

    def dataclass(cls: type | None = None, /, *, frozen: bool = False, eq: bool = True, **options: Any) -> Any:
        """As `dataclasses.dataclass`, of whose options it has ``frozen``, ``eq``, ``slots``, ``kw_only`` and ``weakref_slot``."""

        def decorate(cls: type) -> type:
            own = {name for name, value in vars(cls).items() if value is not None}
            if "__init__" in own:
                raise TypeError(f"{cls.__name__} has an __init__ of its own; take dataclasses.dataclass for it")
            derived = frozen and any(
                dataclasses.is_dataclass(base) for base in cls.__mro__[1:]
            )  # of what is frozen, as it asks for
            made = dataclasses.dataclass(init=False, repr=False, eq=False, frozen=derived, **options)(cls)
            made.__dataclass_params__.frozen = frozen
            methods: dict[str, Any] = {"__init__": _Init(made, frozen)}
            if "__repr__" not in own:
                methods["__repr__"] = _repr
            if eq:
                methods |= _comparison(made, frozen, own)
            if frozen and not derived:
                methods |= _protection(made)
                if options.get("slots"):
                    methods |= {"__getstate__": _get_state, "__setstate__": _set_state}
            for name, method in methods.items():
                setattr(made, name, method)
            return made

        return decorate if cls is None else decorate(cls)


def extended(record: type, more: Sequence[tuple[str, Any, Any]]) -> type:
    """A frozen record with fields besides its own, each by its name, type and default."""
    body = {name: default for name, _, default in more}
    body |= {"__annotations__": {name: of for name, of, _ in more}, "__module__": record.__module__, "__doc__": record.__doc__}
    return dataclass(frozen=True, slots=True)(type(record.__name__, (record,), body))


class _Factory:
    """Stands in signatures for a default that is made for each record."""

    def __repr__(self) -> str:
        return "<factory>"


_MADE = _Factory()


class _Init:
    """``__init__`` of a class until it is first asked for."""

    def __init__(self, cls: type, frozen: bool) -> None:
        self.cls, self.frozen = cls, frozen

    def __get__(self, record: object | None, owner: type) -> Callable:
        method = _compiled(self.cls, self.frozen)
        self.cls.__init__ = method  # type: ignore[misc]
        return method.__get__(record, owner)


def _compiled(cls: type, frozen: bool) -> Callable:
    """``__init__`` of a class."""
    places: dict[str, Any] = {"_set": object.__setattr__, "_MADE": _MADE}
    by_place: list[str] = []
    by_name: list[str] = []
    body: list[str] = []
    for f in fields(cls):
        value = f.name
        if f.default_factory is not MISSING:
            places[f"_make_{f.name}"] = f.default_factory
            value = f"_make_{f.name}()" + (f" if {f.name} is _MADE else {f.name}" if f.init else "")
            default = "=_MADE"
        elif f.default is not MISSING:
            places[f"_default_{f.name}"] = f.default
            default = f"=_default_{f.name}"
            value = f.name if f.init else default[1:]
        else:
            default = ""
        if f.init:
            (by_name if f.kw_only else by_place).append(f.name + default)
        elif f.default is MISSING and f.default_factory is MISSING:
            continue
        body.append(f"_set(self, {f.name!r}, {value})" if frozen else f"self.{f.name} = {value}")
    if hasattr(cls, "__post_init__"):
        body.append("self.__post_init__()")
    head = ", ".join(["self", *by_place, *(["*", *by_name] if by_name else ())])
    lines = [f"def make({', '.join(places)}):", f" def __init__({head}):", *(f"  {line}" for line in body or ["pass"])]
    made: dict[str, Any] = {}
    names = vars(sys.modules[cls.__module__])  # among which types that are told as text are found
    exec("\n".join([*lines, " return __init__"]), names, made)
    method = made["make"](**places)
    method.__qualname__, method.__module__ = f"{cls.__qualname__}.__init__", cls.__module__
    method.__annotations__ = {f.name: f.type for f in fields(cls) if f.init} | {"return": None}
    return method


def _comparison(cls: type, frozen: bool, own: set[str]) -> dict[str, Any]:
    """Methods of a class whose records are equal where their fields are, but for those in ``own``."""

    def values(names: list[str]) -> Callable[[Any], tuple]:
        return attrgetter(*names) if len(names) > 1 else lambda record: tuple(getattr(record, name) for name in names)

    compared: list[Field] = [f for f in fields(cls) if f.compare]
    of_both = values([f.name for f in compared])
    of_hash = values([f.name for f in fields(cls) if (f.compare if f.hash is None else f.hash)])

    def __eq__(self: Any, other: object) -> bool:
        return of_both(self) == of_both(other) if other.__class__ is self.__class__ else NotImplemented

    def __hash__(self: Any) -> int:
        return hash(of_hash(self))

    methods: dict[str, Any] = {"__eq__": __eq__, "__hash__": __hash__ if frozen else None}
    return {name: method for name, method in methods.items() if name not in own}


def _protection(cls: type) -> dict[str, Any]:
    """Methods of a class whose records cannot be changed."""
    names = frozenset(f.name for f in fields(cls))

    def __setattr__(self: Any, name: str, value: Any) -> None:
        if type(self) is cls or name in names:
            raise FrozenInstanceError(f"cannot assign to field {name!r}")
        super(cls, self).__setattr__(name, value)

    def __delattr__(self: Any, name: str) -> None:
        if type(self) is cls or name in names:
            raise FrozenInstanceError(f"cannot delete field {name!r}")
        super(cls, self).__delattr__(name)

    return {"__setattr__": __setattr__, "__delattr__": __delattr__}


@recursive_repr()
def _repr(self: Any) -> str:
    """The class and the fields of a record."""
    told = ", ".join(f"{f.name}={getattr(self, f.name)!r}" for f in fields(self) if f.repr)
    return f"{self.__class__.__qualname__}({told})"


def _get_state(self: Any) -> list:
    """The fields of a record, for pickle."""
    return [getattr(self, f.name) for f in fields(self)]


def _set_state(self: Any, state: list) -> None:
    """Puts the fields of a record that pickle has read."""
    for f, value in zip(fields(self), state, strict=True):
        object.__setattr__(self, f.name, value)
