# SPDX-License-Identifier: GPL-2.0-only
"""Walks the tokens of one file and reads one value at a time: where it ends, which of its names are units."""

from __future__ import annotations

from collections.abc import Iterator

from lark import Token
from lark.exceptions import UnexpectedInput

from . import units
from .expressions import Node, Rand, compile_value, language
from .forms import Slot
from .limits import DEEPEST_BRACKET
from .source import Fault, Source


def found(t: Token) -> str:
    """A token for messages."""
    return {"NEWLINE": "the end of the line", "END": "the end of the file"}.get(t.type, f"'{t}'")


ODD = {
    **dict.fromkeys("\u201c\u201d\u201e'", 'use straight double quotes "'),
    **dict.fromkeys("\u2212\u2013", "use the plain minus -"),
    **dict.fromkeys("\u00d7\u00b7", "multiply with *"),
    "\u00b2": "write ^2",
    "\u00b3": "write ^3",
    "\u00b0": "write deg",
    ":": "leave it out",
    ";": "one setting per line, without ;",
    "%": 'write a fraction, or accuracy "error 2 %"',
}
"""Signs that the language does not have, and what to write instead."""


class Reader:
    """The tokens of one file; ``at`` is the index of the next one."""

    def __init__(self, source: Source, names: set[str], sites: Iterator[int]):
        self.source, self.names, self.sites = source, names, sites
        tokens = list(language().lex(source.text))
        line, column = len(source.lines), len(source.lines[-1]) + 1
        size = len(source.text)
        tokens.append(Token("END", "", size, line, column, line, column + 1, size))
        self.tokens, self.at = tokens, 0

    @property
    def peek(self) -> Token:
        return self.tokens[self.at]

    def ahead(self, n: int) -> Token:
        return self.tokens[min(self.at + n, len(self.tokens) - 1)]

    def take(self) -> Token:
        t = self.tokens[self.at]
        if t.type != "END":
            self.at += 1
        return t

    def skip_newlines(self) -> None:
        while self.peek.type == "NEWLINE":
            self.at += 1

    def expression(self, slot: Slot, stops, more: bool = False) -> Node:
        """Read one value. ``stops``: words that may come next; ``more``: another value may follow."""
        tokens: list[Token] = []
        brackets: list[Token] = []
        wanted, after = "value", "nothing"

        def push(t: Token, kind: str | None = None) -> None:
            tokens.append(t if kind is None else Token.new_borrow_pos(kind, str(t), t))
            self.at += 1

        while True:
            t = self.peek
            kind = t.type
            inside = bool(brackets)
            if kind == "NEWLINE" and inside:
                n = self.ahead(1)
                if (n.type == "NAME" and wanted != "value" and after != "comma") or n.type in ("RBRACE", "END"):
                    break
                self.at += 1
                continue
            if wanted == "value":
                if kind == "NUMBER":
                    push(t)
                    wanted, after = "operator", "number"
                elif kind == "NAME":
                    if t == "rand":
                        t = Rand.new_borrow_pos("NAME", "rand", t)
                        t.site = next(self.sites)
                    push(t)
                    wanted, after = "operator", "name"
                elif kind == "LPAR":
                    brackets.append(t)
                    if len(brackets) > DEEPEST_BRACKET:
                        raise Fault(t, f"more than {DEEPEST_BRACKET} brackets are open here", "split this with let")
                    push(t)
                elif kind in ("PLUS", "MINUS"):
                    push(t)
                    after = "operator"
                else:
                    break
            elif kind == "NAME":
                if self._unit_follows(t, slot, stops, more, inside, after):
                    push(t, "UNIT")
                    after = "unit"
                else:
                    break
            elif kind == "NUMBER":
                fraction = t == "1" and self.ahead(1).type == "SLASH" and self.ahead(2).type == "NAME"
                if fraction and after != "unit" and not (more and not inside and str(self.ahead(2)) not in units.UNITS):
                    push(t, "ONE")
                    after = "unit"
                elif not inside and (more or after == "bracket" or ".." in stops):
                    break
                else:
                    hint = f"write {slot.text}, with commas" if "," in slot.text else "an operator or a comma is missing"
                    raise Fault(t, f"'{t}' follows another value", hint)
            elif kind == "LPAR":
                if after == "name":
                    brackets.append(t)
                    push(t)
                    wanted, after = "value", "operator"
                elif inside:
                    raise Fault(t, "an operator is missing before this (", "multiply with *")
                else:
                    break
            elif kind == "RPAR":
                if not inside:
                    break
                brackets.pop()
                push(t)
                after = "bracket"
            elif kind == "COMMA":
                if not inside:
                    break
                push(t)
                wanted, after = "value", "comma"
            elif kind in ("STAR", "SLASH") and after == "unit":
                push(t, "UNIT_" + kind)
                self._unit_part(t, push)
            elif kind == "CARET" and after == "unit":
                push(t)
                if self.peek.type == "MINUS":
                    push(self.peek)
                if self.peek.type != "NUMBER":
                    raise Fault(self.peek, f"the power of a unit is a number, found {found(self.peek)}")
                push(self.peek)
            elif kind == "PLUS_MINUS" and (inside or "+-" not in stops):
                push(t, "PLUS")
                tokens.append(Token.new_borrow_pos("MINUS", "-", t))
                wanted, after = "value", "operator"
            elif kind in ("PLUS", "MINUS", "STAR", "SLASH", "CARET", "MOD"):
                if after == "unit" and kind == "MOD":
                    raise Fault(t, "mod cannot follow a unit", "put the value before it in brackets")
                push(t)
                wanted, after = "value", "operator"
            else:
                break
        self._complete(tokens, brackets, wanted, slot)
        try:
            return compile_value(tokens)
        except UnexpectedInput as e:
            bad = getattr(e, "token", None) or tokens[-1]
            raise Fault(
                bad if bad.type != "$END" else tokens[-1],
                f"{found(bad)} makes no sense here",
                "put brackets around values with units",
            ) from None

    def _unit_follows(self, t: Token, slot: Slot, stops, more: bool, inside: bool, after: str) -> bool:
        """Whether a name after a value is its unit (else it is the next word of the setting)."""
        known = str(t) in units.UNITS
        if not inside and not known and (more or str(t) in stops):
            return False
        if after == "unit":
            if known:
                raise Fault(
                    t, f"the unit '{t}' follows another unit", f"write a product of units with *: {self.tokens[self.at - 1]}*{t}"
                )
            if not inside:
                return False
        if known:
            return True
        if t == "x" or t == "by":
            raise Fault(t, f"'{t}' is not an operator", "multiply with *; a vector is (x, y, z)")
        dim = slot.dim if slot.kind not in ("let", "check") and slot.unit not in ("?", "1") else None
        what = f" of {units.describe(dim).split(' ', 1)[1]}" if dim is not None else ""
        last = self.ahead(1)
        if t in self.names and last.type != "SLASH":
            raise Fault(t, f"an operator is missing before '{t}'", "multiply with *")
        raise Fault(t, f"'{t}' is not a unit{what}", units.suggest_unit(str(t), dim))

    def _unit_part(self, operator: Token, push) -> None:
        """The unit after * or / of a unit."""
        t = self.peek
        if t.type != "NAME" or (str(t) not in units.UNITS and not (t == "h" and operator.type == "SLASH")):
            if t.type == "NAME":
                raise Fault(t, f"'{t}' is not a unit", units.suggest_unit(str(t)))
            raise Fault(
                t,
                f"a unit is expected after '{operator}', found {found(t)}",
                "put the value with its unit in brackets to go on calculating: (2 m) * 3",
            )
        push(t, "UNIT")

    def _complete(self, tokens: list, brackets: list, wanted: str, slot: Slot) -> None:
        """Refuse a value that breaks off."""
        t = self.peek
        if wanted == "value" or not tokens:
            hint = ODD.get(str(t), "")
            if t.type == "RPAR" and not brackets:
                hint = "this ) closes nothing"
            what = "a vector (x, y, z)" if slot.kind in ("vector", "place") and not tokens else "a number"
            if tokens:
                what += f" is missing after '{tokens[-1]}'"
            else:
                what += " is expected here"
            if t.type == "STRING":
                hint = "leave out the quotes"
            raise Fault(t, f"{what}, found {found(t)}", hint)
        if brackets:
            hint = ODD.get(str(t), "") or "add a )"
            raise Fault(
                brackets[-1],
                f"this ( is not closed: found {found(t)}" + (f" at line {t.line}" if t.line != brackets[-1].line else ""),
                hint,
            )
