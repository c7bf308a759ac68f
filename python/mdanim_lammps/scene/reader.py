# SPDX-License-Identifier: GPL-2.0-only
"""Reads one value at a time from the tokens of a file, by descent: where it ends, which of its names are units.

    value    = sum [unit {sign term {sign term} unit} [sign term {sign term}]]
    sum      = term {(+ | -) term}                 unit = factor {(* | /) factor},  factor = NAME [^ [-] NUMBER]
    term     = signed {(* | / | mod) signed}       signed = {+ | -} power,  power = atom [^ signed]
    atom     = NUMBER | NAME | NAME ( value {, value} ) | ( value {, value} )

A unit belongs to everything before it, up to a bracket, a comma or the sign after the last unit: ``rho*a*a kg``, ``1 m + 20 cm``.
"""

from __future__ import annotations

from collections.abc import Iterator

from . import expressions as build
from . import units
from .expressions import Node
from .forms import Slot, literals
from .functions import FUNCTIONS
from .keywords import BLOCKS, KEYWORDS, nearest
from .limits import DEEPEST_BRACKET, DEEPEST_EXPRESSION
from .source import Fault, SceneFile
from .tokens import Token, tokens

ODD = {
    **dict.fromkeys("\u201c\u201d\u201e'", 'use straight double quotes "'),
    **dict.fromkeys("\u2212\u2013", "use the plain minus -"),
    **dict.fromkeys("\u00d7\u00b7", "multiply with *"),
    "\u00b2": "write ^2",
    "\u00b3": "write ^3",
    "\u00b0": "write deg",
    ":": "leave it out",
    ";": "one setting per line, without ;",
    "%": "write a fraction",
    "mod": "mod stands between two numbers: k mod 2",
}
"""Signs that the language does not have or that cannot begin a value, and what to write instead."""
BY = ("x", "by")
"""Words between sizes, as in 2 x 3; neither is an operator."""
VALUE = ("NUMBER", "STRING")
"""Tokens that are values by themselves."""


class Reader:
    """The tokens of one file, made as they are needed; ``at`` is the index of the next one in ``tokens``."""

    def __init__(self, source: SceneFile, names: set[str], sites: Iterator[int]):
        self.source, self.names, self.sites = source, names, sites
        self.coming = tokens(source.text)
        self.tokens: list[Token] = []
        self.at = 0

    @property
    def peek(self) -> Token:
        try:
            return self.tokens[self.at]
        except IndexError:
            return self.ahead(0)

    def ahead(self, n: int) -> Token:
        while len(self.tokens) <= self.at + n:
            self.tokens.append(next(self.coming))
        return self.tokens[self.at + n]

    def take(self) -> Token:
        t = self.peek
        if t.type != "END":
            self.at += 1
        return t

    def forget(self) -> None:
        """Drop the tokens that were read: nothing goes back behind the beginning of a statement."""
        del self.tokens[: self.at]
        self.at = 0

    def raw_lines(self) -> list[Token]:
        """Lines of text behind the { that was taken, up to a line that is a } alone; each as one token, without blanks around.

        One line may hold it all: ``{ fix push mobile addforce 1 0 0 }``.
        """
        opened, text = self.tokens[self.at - 1], self.source.text
        found, at, line = [], opened.end, opened.line
        while at < len(text):
            end = text.find("\n", at) if "\n" in text[at:] else len(text)
            said = text[at:end].strip()
            last = said == "}" or (not found and line == opened.line and said.endswith("}"))
            said = said.removesuffix("}").rstrip() if last else said
            if said:
                start = text.index(said, at)
                found.append(Token("RAW", said, start, line, start - text.rfind("\n", 0, start)))
            if last:
                self.tokens = self.tokens[: self.at]
                self.coming = tokens(text, text.rindex("}", at, end) + 1, line)
                return found
            at, line = end + 1, line + 1
        raise Fault(opened, "these lines are never closed", "write a } in a line of its own where they end")

    def skip_newlines(self) -> None:
        while self.peek.type == "NEWLINE":
            self.at += 1

    def expression(self, slot: Slot, stops, more: bool = False) -> Node:
        """Read one value. ``stops``: words that may come next; ``more``: another value may follow."""
        self.slot, self.stops, self.more = slot, stops, more
        self.brackets: list[Token] = []
        self.begin, self.depth = self.at, 0
        return self._value()

    # -- the grammar

    def _next(self, operand: bool = False) -> Token:
        """The next token; in brackets a value goes on over the end of a line, unless a new statement follows there."""
        while self.brackets and self.peek.type == "NEWLINE":
            n = self.ahead(1)
            if n.type in ("RBRACE", "END") or (n.type == "NAME" and not operand):
                break
            self.at += 1
        return self.peek

    def _value(self) -> Node:
        x = self._sum(self._term())
        after_unit = False
        while (u := self._unit(after_unit)) is not None:
            x, after_unit = build.with_unit(x, *u), True
            while (sign := self._sign()) is not None:
                tail = self._sum(self._signed_term(sign))
                u = self._unit(False)
                if u is None:
                    return build.joined(x, tail)
                x = build.joined(x, build.with_unit(tail, *u))
        return x

    def _sum(self, x: Node) -> Node:
        while (sign := self._sign()) is not None:
            if sign.type == "PLUS_MINUS":
                sign = Token("PLUS", "+", sign.start, sign.line, sign.column)
                x = build.binary(x, sign, self._term(build.negative(sign, self._signed())))
            else:
                x = build.binary(x, sign, self._term())
        return x

    def _sign(self) -> Token | None:
        """The sign before the next term of a sum."""
        t = self._next()
        if t.type in ("PLUS", "MINUS") or (t.type == "PLUS_MINUS" and (self.brackets or "+-" not in self.stops)):
            return self.take()
        return None

    def _signed_term(self, sign: Token) -> Node:
        """The first term behind a unit, with its sign."""
        x = self._term()
        if sign.type == "PLUS":
            x.first = sign
            return x
        return build.negative(sign, x)

    def _term(self, x: Node | None = None) -> Node:
        x = x or self._signed()
        while self._next().type in ("STAR", "SLASH", "MOD"):
            x = build.binary(x, self.take(), self._signed())
        return x

    def _signed(self) -> Node:
        signs = []
        while self._next(operand=True).type in ("PLUS", "MINUS"):
            signs.append(self.take())
        self.depth += 1
        if max(self.depth, len(signs)) > DEEPEST_EXPRESSION:
            raise Fault(self.peek, f"this expression has more than {DEEPEST_EXPRESSION} nested steps", "split it with let")
        x = self._atom()
        if self._next().type == "CARET":
            x = build.binary(x, self.take(), self._signed())
        self.depth -= 1
        for sign in reversed(signs):
            if sign.type == "MINUS":
                x = build.negative(sign, x)
            x.first = sign
        return x

    def _atom(self) -> Node:
        t = self._next(operand=True)
        if t.type == "NUMBER":
            return build.number(self.take())
        if t.type == "NAME":
            self.take()
            if self._next().type == "NUMBER" and t not in self.names and t not in build.RESERVED:
                way_out = "leave it out: values stand alone, in their order, as in cylinder 5 cm 12 cm"
                raise Fault(t, f"'{t}' is not written before its value", way_out)
            site = next(self.sites) if t == "rand" else 0
            if self._next().type != "LPAR" or self._next_value_in_brackets(t):
                return build.name(t)
            _, parts, right = self._in_brackets()
            return build.call(t, parts, right, site)
        if t.type != "LPAR":
            raise self._no_value(t)
        left, parts, right = self._in_brackets()
        if len(parts) > 1:
            return build.vector(left, parts, right)
        x = parts[0]
        x.first, x.last, x.terms = left, right, ()  # brackets make one term of a sum
        return x

    def _next_value_in_brackets(self, name: Token) -> bool:
        """Whether the bracket after a name and a blank is the next value, as in ``cylinder r (t)``."""
        apart = self.peek.start > name.start + len(name)
        return apart and self.more and not self.brackets and name not in build.RESERVED

    def _in_brackets(self) -> tuple[Token, list[Node], Token]:
        left = self.take()
        self.brackets.append(left)
        if len(self.brackets) > DEEPEST_BRACKET:
            raise Fault(left, f"more than {DEEPEST_BRACKET} brackets are open here", "split this with let")
        parts = [self._value()]
        while (t := self._next()).type == "COMMA":
            self.take()
            parts.append(self._value())
        if t.type != "RPAR":
            line = f" at line {t.line}" if t.line != left.line else ""
            raise Fault(left, f"this ( is not closed: found {t.found()}{line}", ODD.get(str(t), "") or "add a )")
        self.brackets.pop()
        return left, parts, self.take()

    # -- units

    def _unit(self, after_unit: bool) -> tuple[units.Unit, Token] | None:
        """The unit behind a value, and its last token; None where something else follows."""
        t, inside = self._next(), bool(self.brackets)
        if t.type == "NUMBER":
            fraction = t == "1" and self.ahead(1).type == "SLASH" and self.ahead(2).type == "NAME"
            if not fraction or after_unit or (self.more and not inside and str(self.ahead(2)) not in units.UNITS):
                closed = self.at > 0 and self.tokens[self.at - 1].type == "RPAR"
                if not inside and (self.more or closed or ".." in self.stops):
                    return None
                hint = f"write {self.slot.text}, with commas" if "," in self.slot.text else "an operator or a comma is missing"
                before = self.tokens[self.at - 1]
                raise Fault(t, f"'{t}' follows another value", self._turned(before, t) if before == "fps" else hint)
        elif t.type == "LPAR" and inside:
            raise Fault(t, "an operator is missing before this (", "multiply with *")
        elif t.type == "MOD" and after_unit:
            raise Fault(t, "mod cannot follow a unit", "put the value before it in brackets")
        elif t.type != "NAME" or not self._unit_follows(t, after_unit):
            return None
        unit, last = self._factor(units.ONE, 1)
        text = str(t)
        while self._next().type in ("STAR", "SLASH"):
            operator = self.take()
            t = self._unit_part(operator)
            text += f"{operator}{t}"
            unit, last = self._factor(unit, 1 if operator.type == "STAR" else -1)
        return units.Unit(text, unit.over, unit.under, unit.dim), last

    def _factor(self, unit: units.Unit, sign: int) -> tuple[units.Unit, Token]:
        """A unit multiplied by the next one, with its power."""
        token = last = self.take()
        known = units.ONE if token == "1" else units.UNITS.get(str(token), units.HOUR)
        if self._next().type == "CARET":
            self.take()
            if self.peek.type == "MINUS":
                self.take()
                sign = -sign
            last = self.take()
            if last.type != "NUMBER":
                raise Fault(last, f"the power of a unit is a number, found {last.found()}")
            if not (last.isascii() and last.isdigit() and 1 <= int(last[:3]) <= 9):
                raise Fault(last, f"the power of a unit is a whole number from 1 to 9, found {last}")
            sign *= int(last)
        return unit.times(known, sign), last

    def _unit_follows(self, t: Token, after_unit: bool) -> bool:
        """Whether a name after a value is its unit (else it is the next word of the setting)."""
        known, inside, slot = str(t) in units.UNITS, bool(self.brackets), self.slot
        if not inside and not known and (self.more or str(t) in self.stops):
            return False
        if after_unit:
            if known:
                cure = f"write a product of units with *: {self.tokens[self.at - 1]}*{t}"
                if (number := self.ahead(1)).type == "NUMBER":
                    cure = self._turned(t, number)
                raise Fault(t, f"the unit '{t}' follows another unit", cure)
            if not inside:
                return False
        if known:
            return True
        if t in BY:
            raise Fault(t, f"'{t}' is not an operator", "multiply with *; a vector is (x, y, z)")
        dim = slot.dim if slot.kind not in ("let", "check") and slot.unit not in ("?", "1") else None
        what = f" of {units.describe(dim).split(' ', 1)[1]}" if dim is not None else ""
        last = self.ahead(1)
        if t in self.names and last.type != "SLASH":
            raise Fault(t, f"an operator is missing before '{t}'", "multiply with *")
        raise Fault(t, f"'{t}' is not a unit{what}", units.suggest_unit(str(t), dim))

    @staticmethod
    def _turned(unit: Token, number: Token) -> str:
        """Hint where a unit stands before its number."""
        word = "frames" if unit == "fps" else "a word that says what it is"
        return f"a unit comes behind its number: write {word}, then {number} {unit}"

    def _unit_part(self, operator: Token) -> Token:
        """The unit after * or / of a unit."""
        t = self.peek
        if t.type == "NAME" and (str(t) in units.UNITS or (t == "h" and operator.type == "SLASH")):
            return t
        hint = "put the value with its unit in brackets to go on calculating: (2 m) * 3"
        if t.type == "NAME":
            goes_on = str(t) in self.names or str(t) in FUNCTIONS or str(t) in ("rand", "pi")
            raise Fault(t, f"'{t}' is not a unit", hint if goes_on else units.suggest_unit(str(t)))
        raise Fault(t, f"a unit is expected after '{operator}', found {t.found()}", hint)

    def _no_value(self, t: Token) -> Fault:
        """The fault where a value should begin."""
        read = [u for u in self.tokens[self.begin : self.at] if u.type != "NEWLINE"]
        what = "a vector (x, y, z)" if self.slot.kind in ("vector", "place") and not read else "a number"
        what += f" is missing after '{read[-1]}'" if read else " is expected here"
        hint = ODD.get(str(t), "")
        if t.type == "STRING":
            hint = "leave out the quotes"
        elif t.type == "RPAR" and not self.brackets:
            hint = "this ) closes nothing"
        return Fault(t, f"{what}, found {t.found()}", hint)

    def skip_statement(self, start: int, block: str, bad: Token | None = None) -> None:
        """Go on after a bad statement: behind its line, behind the block that it opens, or at the next setting after ``bad``."""
        self.at = start
        depth = braces = 0
        passed = False
        while True:
            t = self.peek
            between = block and passed and depth <= 0 and not braces and t not in self.names
            if between and (str(t) in KEYWORDS[block] or self._begins(block, bad)):
                break
            passed |= bad is not None and t.start >= bad.start
            t = self.take()
            if t.type == "END":
                break
            if t.type == "LBRACE":
                braces += 1
            elif t.type == "RBRACE":
                braces -= 1
                if braces < 0:
                    self.at -= 1
                    break
                if braces == 0:
                    break
            elif braces == 0:
                depth += (t.type == "LPAR") - (t.type == "RPAR")
                if t.type == "NEWLINE":
                    n = self.peek
                    if depth <= 0 or n.type in ("RBRACE", "NEWLINE", "END") or str(n) in KEYWORDS[block] or str(n) in BLOCKS:
                        break
        self.at = max(self.at, start + 1)

    def _begins(self, block: str, bad: Token | None) -> bool:
        """Whether the next word is behind a value and before one, and follows no setting of the block: it is meant to be one.

        A word right behind a bad choice belongs to it, as in ``shape ball radius 2``, unless it is like a setting; an x stands
        between sizes.
        """
        word, before, behind = self.peek, self.tokens[self.at - 1], self.ahead(1)
        within = any(str(word) in literals(k.form) for k in KEYWORDS[block].values())
        if word.type != "NAME" or word in BY:
            return False
        if bad is not None and before.start == bad.start and self.tokens[self.at - 2].type not in VALUE:
            return nearest(str(word), KEYWORDS[block]) is not None
        return before.type in (*VALUE, "RPAR", "NAME") and behind.type in (*VALUE, "LPAR") and not within
