# SPDX-License-Identifier: GPL-2.0-only
"""Reads one setting by the form of its keyword: the words that stand as they are, and a value for each slot."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field
from functools import cache
from itertools import count

from ..records import dataclass
from .expressions import Node
from .forms import OptionalPart, Slot, Word, alternatives, literals, pieces
from .keywords import (
    KEYWORDS,
    MISPLACED,
    NOT_SUPPORTED,
    STATEMENTS,
    belongs,
    did_you_mean,
    example,
    example_of,
    misplaced,
    nearest,
    owner,
)
from .limits import DEEPEST_GROUP, DEEPEST_REPEAT
from .quantities import GLOBALS, QUANTITIES, RELATIONS, TAKEN, meant
from .reader import ODD, Reader
from .schema import Keyword
from .source import Fault, Problems, SceneFile
from .tokens import Token
from .tree import Name, SettingNode, Value
from .units import UNITS, unit


@dataclass(eq=False)
class Shared:
    """State shared by the files of one scene."""

    problems: Problems
    sites: Iterator[int] = field(default_factory=count)
    lets: dict[str, int] = field(default_factory=dict)
    """Names given by let so far, and the line."""
    names: set[str] = field(default_factory=set)
    """Names given by let or repeat so far."""
    files: int = 0
    bytes: int = 0
    """Bytes of all files that were included."""
    incomplete: bool = False
    """A file or a repeat could not be read, so that names may be missing without a mistake of theirs."""


@cache
def stops(keyword: Keyword) -> frozenset[str]:
    """Words that end a value of a keyword; of a word with a hyphen its beginning, which is a token of its own."""
    return literals(keyword.form) | {word.partition("-")[0] for word in KEYWORDS[keyword.block]} | STATEMENTS.keys()


def joined(parts: list[Name]) -> Name:
    """Parts of a name as one name."""
    whole = None
    for part in reversed(parts):
        whole = Name(part.token, whole.last if whole else part.last, part.indices, whole)
    return whole


def quantity_of(parts: list[Name]) -> int:
    """Where the quantity begins in NAME.QUANTITY: the longest tail that is one; else all behind the first name and indices."""
    least = next((n for n in range(len(parts), 1, -1) if parts[n - 1].indices), 1)
    known = {quantity for _, quantity in QUANTITIES}
    return next((n for n in range(least, len(parts)) if ".".join(p.token for p in parts[n:]) in known), least)


class SettingReader(Reader):
    """Reads words, names and settings of one file."""

    def __init__(self, source: SceneFile, shared: Shared):
        super().__init__(source, shared.names, shared.sites)
        self.shared = shared

    def word(self) -> Token:
        """A word, hyphens included (``air-drag``)."""
        first = last = self.take()
        while self.peek.type == "MINUS" and self.peek.start == last.end:
            if self.ahead(1).type != "NAME" or self.ahead(1).start != self.peek.end:
                break
            self.take()
            last = self.take()
        if last is first:
            return first
        return Token("NAME", self.source.text[first.start : last.end], first.start, first.line, first.column)

    def name(self) -> Name:
        """NAME or NAME[index], and behind a point what it has inside it: ``cart[2].wheel[1]``."""
        parts = [self.part_of_name()]
        while self.peek.type == "DOT":
            parts.append(self.inner_part(parts))
        return joined(parts)

    def inner_part(self, parts: list[Name]) -> Name:
        """One part of a name behind a point."""
        dot = self.take()
        if self.peek.type != "NAME":
            raise Fault(self.peek, f"a name is missing after {parts[-1].token}., found {self.peek.found()}")
        if len(parts) > DEEPEST_GROUP:
            raise Fault(dot, f"this name has more than {DEEPEST_GROUP + 1} parts", f"groups nest {DEEPEST_GROUP} deep")
        return self.part_of_name()

    def part_of_name(self) -> Name:
        """NAME, NAME[index], or one index for each of some nested repeats, NAME[index][index]."""
        token = last = self.take()
        indices: list[Node] = []
        while self.peek.type == "LSQB":
            opened = self.take()
            if len(indices) == DEEPEST_REPEAT:
                cause = f"{token} has more than {DEEPEST_REPEAT} indices"
                raise Fault(opened, cause, f"repeats nest {DEEPEST_REPEAT} deep; make one number of two, e.g. 100*i + j")
            indices.append(self.expression(Slot("number", "index"), frozenset()))
            last = self.peek
            if last.type == "COMMA":
                hint = f"write {token}[i][j], or make one number of them, e.g. {token}[100*i + j]"
                raise Fault(last, f"each bracket of {token} has one index, found {last.found()}", hint)
            if last.type != "RSQB":
                raise Fault(last, f"a ] is missing after the index of {token}, found {last.found()}", f"write {token}[1]")
            self.take()
        return Name(token, last, tuple(indices))

    def entry(self, word: Token, keyword: Keyword, repeats: int) -> SettingNode:
        if repeats and not keyword.many:
            raise Fault(word, f"{keyword.name} cannot stand in a repeat", "it is given once")
        if self.peek.type == "EQUAL" or self.peek == ":":
            raise Fault(self.peek, f"no '{self.peek}' is needed after {keyword.name}", example(keyword))
        choice = self.choose(word, keyword)
        words, values = [], []
        self.match(alternatives(keyword.form)[choice], keyword, words, values)
        node = SettingNode(self.source, word, keyword, choice, tuple(words), tuple(values))
        try:
            self.end_of_statement(keyword.name, KEYWORDS[keyword.block])
        except Fault as fault:
            if not any(value and value.node for value in values):  # else what follows may belong to a value
                fault.behind = node
            raise
        return node

    def choose(self, word: Token, keyword: Keyword) -> int:
        """The alternative of the form that the next word calls for, or the next two of alternatives that begin alike."""
        t = self.peek
        options = alternatives(keyword.form)
        called = [n for n, parts in enumerate(options) if isinstance(parts[0], Word) and parts[0].text == t]
        if len(called) > 1:
            seconds = {options[n][1].text: n for n in called}
            if (second := self.ahead(1)) not in seconds:
                hint = did_you_mean(str(second), list(seconds)) or example(keyword)
                raise Fault(second, f"{keyword.name} {t} cannot be followed by {second.found()}", hint)
            return seconds[str(second)]
        if called:
            return called[0]
        starts = [p[0].text for p in options if isinstance(p[0], Word)]
        free = [n for n, p in enumerate(options) if not isinstance(p[0], Word)]
        mistyped = t.type == "NAME" and t not in self.shared.names and (nearest(str(t), starts) or not free)
        if t.type in ("NEWLINE", "END", "RBRACE") and (not free or isinstance(options[free[0]][0], Slot)):
            self._missing(word, keyword)
        if not free or mistyped:
            hint = did_you_mean(str(t), starts) if len(starts) > 1 or mistyped else example(keyword)
            raise Fault(t, f"{keyword.name} cannot be followed by {t.found()}", misplaced(keyword, str(t), starts) or hint)
        return free[0]

    def _missing(self, word: Token, keyword: Keyword, words: Sequence[str] = ()) -> None:
        rest = self.source.lines[word.line - 1][word.column + len(word) - 1 :].strip()
        hint = example_of(keyword, words) if words else example(keyword)
        if rest.startswith("#") and "color" in keyword.form:
            hint = "'#' starts a comment: put the colour in quotes, \"#rrggbb\""
        cause = f"nothing follows {word}"
        if word in UNITS and word in self.shared.names:
            cause = f"nothing follows the unit {word}: a name right after a value is its unit"
            hint = f"for the value of let {word} write ({word})"
        raise Fault(word, cause, hint)

    def match(self, parts: tuple, keyword: Keyword, words: list, values: list, behind: Word | Slot | None = None) -> None:
        """Read the parts of one alternative; ``behind`` is the part that follows them."""
        for n, part in enumerate(parts):
            t = self.peek
            if isinstance(part, Word):
                if part.text != t and not (part.text == "+-" and t.type == "PLUS_MINUS"):
                    hint = MISPLACED.get(f"{keyword.name} {t}") or example_of(keyword, words)
                    raise Fault(t, f"'{part.text}' is missing in {keyword.name}, found {t.found()}", hint)
                words.append(str(self.take()))
            elif isinstance(part, OptionalPart):
                first = part.parts[0]
                if isinstance(first, Word):
                    present = first.text == t or (first.text == "+-" and t.type == "PLUS_MINUS")
                elif first.kind == "choice":
                    present = str(t) in first.choices and self.ahead(1).type not in ("DOT", "LSQB")
                else:
                    following = parts[n + 1].text if n + 1 < len(parts) else None
                    present = t.type not in ("NEWLINE", "END", "RBRACE") and t != following
                    others = KEYWORDS[keyword.block] if following is None else literals(keyword.form)
                    present = present and str(t) not in others
                if present:
                    self.match(part.parts, keyword, words, values, parts[n + 1] if n + 1 < len(parts) else behind)
                else:
                    values += [None] * sum(isinstance(p, Slot) for p in pieces(part.parts))
            else:
                if t.type in ("NEWLINE", "END", "RBRACE"):
                    self._missing(self.tokens[self.at - 1], keyword, words)
                more = isinstance(parts[n + 1] if n + 1 < len(parts) else behind, Slot)
                values.append(self.value(part, keyword, more))

    def value(self, slot: Slot, keyword: Keyword, more: bool) -> Value:
        t = self.peek
        if slot.kind == "text" or (slot.or_text and t.type in ("STRING", "BAD_STRING")):
            token = self.text(keyword.name, example(keyword))
            return Value(slot, token, token, text=str(token)[1:-1])
        if slot.kind == "choice":
            return self.choice(slot, keyword)
        if slot.kind == "color":
            if t.type == "STRING":
                self.take()
                return Value(slot, t, t, text=str(t)[1:-1])
            if t.type != "NAME":
                raise Fault(t, f"{keyword.name} needs a colour, found {t.found()}", 'write a name such as red, or "#rrggbb"')
            name = self.word()
            return Value(slot, t, self.tokens[self.at - 1], text=str(name))
        if slot.kind == "name":
            if str(t) in KEYWORDS[keyword.block]:
                self._missing(self.tokens[self.at - 1], keyword)
            if t.type != "NAME":
                hint = "leave out the quotes" if t.type == "STRING" else example(keyword)
                raise Fault(t, f"{keyword.name} needs a name, found {t.found()}", hint)
            self.take()
            return Value(slot, t, t, text=str(t))
        if slot.kind == "check":
            return self.check(slot, keyword)
        if slot.kind == "object":
            if t.type != "NAME":
                raise Fault(t, f"{keyword.name} needs the name of an object, found {t.found()}", example(keyword))
            name = self.name()
            return Value(slot, name.token, name.last, name=name)
        if slot.kind == "relation":
            if t not in RELATIONS:
                hint = MISPLACED.get(f"{keyword.name} {t}", f"{example(keyword)}; or <, >, <=, >=")
                raise Fault(t, f"'=' is missing in {keyword.name}, found {t.found()}", hint)
            self.take()
            return Value(slot, t, t, text=RELATIONS[str(t)])
        if slot.kind == "place" and t.type == "NAME":
            name = self.name()
            return Value(slot, name.token, name.last, name=name)
        node = self.expression(slot, stops(keyword), more)
        return Value(slot, node.first, node.last, node)

    def text(self, what: str, hint: str) -> Token:
        t = self.peek
        if t.type == "BAD_STRING":
            raise Fault(t, "this text is never closed", 'add a " at its end')
        if t.type != "STRING":
            raise Fault(t, f"{what} needs a text in quotes, found {t.found()}", ODD.get(str(t)) or hint)
        return self.take()

    def choice(self, slot: Slot, keyword: Keyword) -> Value:
        first = last = self.take()
        text = str(first)
        if first.type in ("PLUS", "MINUS") and self.peek.type == "NAME":
            last = self.take()
            text += str(last)
        if text not in slot.choices:
            gone = keyword.gone.get(text.strip('"').partition(" ")[0])
            cause = f"'{text.strip()}' is not one of the choices of {keyword.name}{' any more' * bool(gone)}"
            raise Fault(first, cause, gone or did_you_mean(text, slot.choices), last)
        return Value(slot, first, last, text=text)

    def check(self, slot: Slot, keyword: Keyword) -> Value:
        """NAME.QUANTITY."""
        if self.peek.type != "NAME":
            hint = f"NAME is an object, or one of {', '.join(GLOBALS)}"
            raise Fault(self.peek, f"{keyword.name} needs NAME.QUANTITY, found {self.peek.found()}", hint)
        parts = [self.part_of_name()]
        while self.peek.type == "DOT":
            if self.ahead(1).type != "NAME":
                raise Fault(self.ahead(1), f"the quantity is missing after {parts[-1].token}., found {self.ahead(1).found()}")
            parts.append(self.inner_part(parts))
        at = quantity_of(parts)
        name, last = joined(parts[:at]), parts[-1].last
        if at == len(parts) and keyword.name == "expect" and self.peek.type == "NAME":
            cause = f"expect {name.token} {self.peek}: '{name.token}' is none of the words before NAME.QUANTITY"
            raise Fault(name.token, cause, f"write expect max {self.peek}.position.z, or min, or mean", name.last)
        if at == len(parts):
            raise Fault(name.token, f"{keyword.name} {name.token} names no quantity", f"e.g. {name.token}.position.z", name.last)
        text = ".".join(part.token for part in parts[at:])
        argument = self.argument(name.token, text, last, stops(keyword))
        if argument is None and self.peek.type == "LPAR":
            kind = name.token if name.token in GLOBALS else "NAME"
            if (kind, text) in QUANTITIES:
                raise Fault(self.peek, f"{text} has nothing in brackets", f"write {name.token}.{text}")
            if at > 1 and any(q.startswith(f"{parts[at - 1].token}.") for _, q in QUANTITIES):  # joint.work: work alone is one
                text = f"{parts[at - 1].token}.{text}"
            raise Fault(name.token, f"{text} is not a quantity of {name.token}", meant(kind, text, did_you_mean), last)
        return Value(slot, name.token, argument.last if argument else last, text=text, name=name, argument=argument)

    def argument(self, subject: str, quantity: str, last: Token, stops: frozenset[str]) -> Value | None:
        """The value in brackets behind a quantity that has an argument."""
        of = next((q for (_, word), q in QUANTITIES.items() if word == quantity and q.takes), None)
        if of is None or (of.alone and self.peek.type != "LPAR"):
            return None
        takes = of.takes
        if self.peek.type != "LPAR":
            if subject not in GLOBALS and ("NAME", quantity) not in QUANTITIES:
                return None  # only an object, or the liquid by its name: asked.py knows
            raise Fault(last, f"{quantity} needs {TAKEN[takes][0]} in brackets", f"write {quantity}{TAKEN[takes][1]}")
        if takes == "place":
            node = self.expression(Slot("vector", "(x, y)", "m", 2, dim=unit("m").dim), stops)
            return Value(self.slot, node.first, node.last, node)
        if takes == "cut":
            node = self.expression(Slot("number", "x", "m", dim=unit("m").dim), stops)
            return Value(self.slot, node.first, node.last, node)
        self.take()
        if self.peek.type != "NAME":
            raise Fault(self.peek, f"{quantity} needs {TAKEN[takes][0]} in brackets, found {self.peek.found()}")
        name = self.name()
        if self.peek.type != "RPAR":
            raise Fault(self.peek, f"a ) is missing after {name.token}, found {self.peek.found()}")
        return Value(Slot("object", "NAME"), name.token, self.take(), name=name)

    def end_of_statement(self, what: str, settings) -> None:
        t, at = self.peek, self.at
        if t.type in ("NEWLINE", "RBRACE", "END"):
            return
        if t.type == "NAME":
            word, self.at = str(self.word()), at
            if word in settings or word in STATEMENTS:
                return
            if word in NOT_SUPPORTED:
                raise Fault(t, f"{word} is not supported yet", NOT_SUPPORTED[word])
        hint = ODD.get(str(t), "")
        if t.type == "COMMA":
            hint = "a decimal number is written with a point"
        elif t.type == "RPAR":
            hint = "this ) closes nothing"
        elif t.type == "NAME":
            home = owner(settings, str(t)) if isinstance(settings, Mapping) else None
            hint = belongs(home, str(t)) if home else did_you_mean(str(t), settings) or f"no setting here is called {t}"
        elif t.type == "LBRACE":
            hint = f"{what} is a setting, not a block"
        hint = MISPLACED.get(f"{what} {t}", hint)
        raise Fault(t, f"{t.found()} cannot follow here; {what} is complete", hint)
