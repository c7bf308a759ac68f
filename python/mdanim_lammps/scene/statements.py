# SPDX-License-Identifier: GPL-2.0-only
"""From text to statements: walks the blocks, reads settings by the forms of their keywords, goes on after a bad line."""

from __future__ import annotations

import os
from itertools import count
from pathlib import Path

from .expressions import RESERVED, Node
from .forms import Slot, literals
from .keywords import (
    BLOCKS,
    KEYWORDS,
    MEANT,
    NOT_SUPPORTED,
    STATEMENTS,
    Block,
    beginnings,
    belongs,
    did_you_mean,
    foreign_line,
    nearest,
    owner,
)
from .limits import DEEPEST_INCLUDE, DEEPEST_REPEAT, MOST_BYTES, MOST_FILES
from .reader import ODD
from .setting_reader import SettingReader, Shared
from .source import Fault, Problems, SceneFile, UnreadableFile, read_text
from .tokens import Token
from .tree import Group, Let, Repeat, Set, Template, UnreadableStatement, Use


def _homes(word: str | None) -> list[str]:
    """Blocks that have a setting of this name, "" for the outermost level."""
    return [b for b in KEYWORDS if word in KEYWORDS[b] and not (b and BLOCKS[b].of)]


def _belongs_in(homes: list[str]) -> str:
    place = " or ".join(f"{b} {{ }}" if b else "the outermost level" for b in homes)
    return f"it belongs {'in' if homes[0] else 'on'} {place}"


class Unclosed(Exception):
    """A word that can only stand further out: a closing brace is missing before it."""

    def __init__(self, token: Token):
        self.token = token


def parse(source: SceneFile, problems: Problems) -> tuple[list, Shared]:
    """All statements of a scene, includes spliced in; what is wrong goes into ``problems``."""
    shared = Shared(problems)
    return Parser(source, shared).body("", None, 0), shared


def parse_override(source: SceneFile, problems: Problems) -> Node | None:
    """The value of ``--set name=value``; None after a problem."""
    parser = Parser(source, Shared(problems, sites=count(2**32)))
    try:
        node = parser.expression(Slot("let", ""), frozenset())
        if parser.peek.type not in ("END", "NEWLINE"):
            raise Fault(parser.peek, f"{parser.peek.found()} cannot follow the value")
        return node
    except Fault as fault:
        problems.fault(source, fault)
        return None


class Parser(SettingReader):
    """Reads one file into statements."""

    def __init__(self, source: SceneFile, shared: Shared, chain: tuple[Path, ...] = ()):
        super().__init__(source, shared)
        self.chain = (*chain, source.path) if source.path else chain
        self.start = 0
        """Where the current statement begins."""

    def problem(self, fault: Fault) -> None:
        self.shared.problems.fault(self.source, fault)

    # -- blocks

    def body(self, block: str, opened: Token | None, repeats: int, title: str = "") -> list:
        """Statements up to the closing brace of ``opened``, or up to the end of the file."""
        result = []
        while True:
            self.skip_newlines()
            t = self.peek
            if t.type == "END":
                if opened is not None:
                    cause = f"{title}, opened at line {opened.line}, is never closed"
                    self.problem(Fault(opened, cause, "add a } where it ends"))
                return result
            if t.type == "RBRACE":
                self.take()
                if opened is not None:
                    return result
                self.problem(Fault(t, "this } closes nothing", "remove it, or look for a missing { above"))
                continue
            if opened is None:
                self.forget()
            start = self.start = self.at
            try:
                result += self.statement(block, opened, repeats)
            except Fault as fault:
                self.problem(fault)
                self.shared.incomplete |= self.tokens[start] in ("include", "repeat")
                self.at = start
                word, name = self.peek, self.ahead(1)
                self.skip_statement(start, block, fault.token)
                known = [*KEYWORDS[block], *BLOCKS, *STATEMENTS]
                bad = UnreadableStatement(nearest(str(word), known) or str(word), str(name) if word == "let" else "")
                result.append(fault.behind or bad)
                if (home := owner(KEYWORDS[block], str(fault.token))) is not None:
                    result.append(UnreadableStatement(home.name))
            except Unclosed as trouble:
                self.at = start
                if opened is None:
                    raise
                word = trouble.token
                cause = f"{title}, opened at line {opened.line}, is not closed before '{word}' at line {word.line}"
                self.problem(Fault(opened, cause, "add a } between them"))
                return result

    def opens_block(self) -> bool:
        """Whether the next tokens look like the head of a block."""
        names = 0
        while self.ahead(names).type == "NAME":
            names += 1
        return self.ahead(names).type == "LBRACE" or (names > 0 and self.ahead(names).type in ("LSQB", "DOT"))

    def statement(self, block: str, opened: Token | None, repeats: int) -> list:
        t = self.peek
        if t.type == "LBRACE":
            raise Fault(t, "this { belongs to no block", "a block begins with a word, e.g. object NAME {")
        if t.type != "NAME":
            hint = ODD.get(str(t), "")
            raise Fault(t, f"a word of the language is expected here, found {t.found()}", hint)
        word = self.word()
        if word == "let":
            return [self.let(word)]
        if word == "repeat":
            return [self.repeat(word, block, repeats)]
        if word == "include":
            return self.include(word, block, repeats)
        if word == "set" and block == "place":
            return [self.set(word)]
        if word == "use" and self.peek.type != "EQUAL":
            return [self.use(word, block, repeats)]
        if word in BLOCKS and (not block or self.opens_block()):
            if block and word not in BLOCKS[block].holds:
                raise Unclosed(word)
            return [self.group(word, str(word), repeats)]
        if word in KEYWORDS[block]:
            return [self.entry(word, KEYWORDS[block][word], repeats)]
        return self.unknown(word, block, opened, repeats)

    def unknown(self, word: Token, block: str, opened: Token | None, repeats: int) -> list:
        """A word that has no meaning here: report it, and read on with what was most likely meant."""
        here = [*KEYWORDS[block], *((*BLOCKS[block].holds, *STATEMENTS) if block else (*BLOCKS, *STATEMENTS))]
        homes = _homes(word)
        if "" in homes and opened is not None and self._first_on_line(word) and word.column <= opened.column:
            raise Unclosed(word)
        home = owner(KEYWORDS[block], str(word))
        guess = "" if home else nearest(str(word), here)  # a word that a form begins with is not a misspelt one
        if homes and not guess and home is None:
            inside = f"inside {block} {{ }}" if block else "outside of all blocks"
            raise Fault(word, f"'{word}' cannot stand {inside}", _belongs_in(homes))
        if str(word) in NOT_SUPPORTED:
            raise Fault(word, f"{word} is not supported yet", NOT_SUPPORTED[str(word)])
        if (head := next((b for b in BLOCKS.values() if str(word) in b.kinds), None)) is not None:
            names = " ".join(("A", "B")[: len(head.names)])
            raise Fault(word, f"{word} is a kind of {head.name}", f"write {head.name} {word} {names} {{ ... }}")
        if not block and str(word) in beginnings(KEYWORDS["object"]["shape"]):
            raise Fault(word, f"{word} is a shape of an object", f"write object NAME {{ shape {word} ... }}")
        kind = f"a setting of {block}" if block else "a word of the scene language"
        home = home or next((k for k in KEYWORDS[block].values() if word in literals(k.form)), None)
        hint = did_you_mean(str(word), here)
        meant = MEANT.get(str(word).lower())
        if meant not in here and (others := _homes(meant)):
            hint = f"did you mean '{meant}'? {_belongs_in(others)}"
        if self.peek.type == "EQUAL":
            hint = f"write let {word} = ..."
        elif home is not None and not guess:
            hint = belongs(home, str(word))
        self.problem(Fault(word, f"'{word}' is not {kind}", hint))
        if guess in BLOCKS and self.opens_block() and (not block or guess in BLOCKS[block].holds):
            return [self.group(word, guess, repeats)]
        if guess in KEYWORDS[block] and not self.opens_block():
            return [self.entry(word, KEYWORDS[block][guess], repeats)]
        self.skip_statement(self.start, block, word)
        return [UnreadableStatement(guess or (home.name if home else str(word)))]

    def _first_on_line(self, t: Token) -> bool:
        return not self.source.lines[t.line - 1][: t.column - 1].strip()

    def brace(self, after: str, settings=()) -> None:
        """The { of a block; it may stand on the next line. Before a setting it may be missing."""
        at = self.at
        self.skip_newlines()
        if self.peek.type == "LBRACE":
            self.take()
            return
        missing = Fault(
            self.tokens[at], f"a {{ is missing after {after}, found {self.tokens[at].found()}", "a block stands in braces"
        )
        if str(self.peek) not in settings:
            self.at = at
            raise missing
        self.problem(missing)

    def group(self, word: Token, block: str, repeats: int) -> Group | Template:
        if repeats and (BLOCKS[block].raw or not BLOCKS[block].many):
            raise Fault(word, f"{block} cannot stand in a repeat", "only objects, expect lines and lets are repeated")
        if block == "place":
            return self.place(word)
        kind, names = BLOCKS[block], []
        which = self.kind_of(kind)
        head = f"{block} {which}".rstrip()
        for _ in kind.names:
            if self.peek.type != "NAME":
                hint = f"e.g. {head} {' '.join(('ball', 'floor')[: len(kind.names)])} {{"
                raise Fault(self.peek, f"a name is missing after {block}, found {self.peek.found()}", hint)
            names.append(name := self.name())
            if (name.indices or name.inner is not None) and not kind.indexed:
                cause = "have an index" if name.indices else "have a point in their name"
                raise Fault(name.token, f"only objects {cause}, found {block} {name.token}...", last=name.last)
        if not names and self.peek.type == "NAME":
            raise Fault(self.peek, f"{block} has no name, found {self.peek.found()}", f"write {block} {{ ... }}")
        title = " ".join((head, *(name.token for name in names)))
        self.brace(title, KEYWORDS[block])
        if kind.raw:
            return Group(self.source, word, block, (), [], raw=tuple(self.raw_lines()))
        body = self.body(block, word, 0, title)
        if block == "group":
            return Template(self.source, names[0].token, body)
        return Group(self.source, word, block, tuple(names), body, kind=which)

    def kind_of(self, block: Block) -> str:
        """The word of its kind, behind that of a block; empty of one without."""
        if not block.kinds:
            return ""
        if str(self.peek) not in block.kinds:
            cause = f"the kind of {block.name} is missing: it is one of {', '.join(block.kinds)}, found {self.peek.found()}"
            raise Fault(self.peek, cause, did_you_mean(str(self.peek), block.kinds) if self.peek.type == "NAME" else "")
        return str(self.take())

    def place(self, word: Token) -> Group:
        """``place GROUP[index] { ... }`` or ``place GROUP as NAME[index] { ... }``."""
        if self.peek.type != "NAME":
            raise Fault(self.peek, f"the name of a group is missing after place, found {self.peek.found()}", "e.g. place cart {")
        of, name = self.peek, self.part_of_name()
        if self.peek == "as":
            if name.indices:
                hint = f"write place {of} as {of}[1]"
                raise Fault(of, f"a group has no index, found place {of}[...] as", hint, name.last)
            self.take()
            if self.peek.type != "NAME":
                raise Fault(self.peek, f"a name is missing after as, found {self.peek.found()}", f"e.g. place {of} as left {{")
            name = self.part_of_name()
        title = f"place {of}"
        self.brace(title, KEYWORDS["place"])
        return Group(self.source, word, "place", (name,), self.body("place", word, 0, title), of)

    def set(self, word: Token) -> Set:
        """``set name = value``, in a place."""
        name = self.peek
        if name.type != "NAME":
            raise Fault(name, f"a name is missing after set, found {name.found()}", "e.g. set length = 3 cm")
        self.take()
        return Set(self.source, name, self.given("set", name))

    def given(self, word: str, name: Token) -> Node:
        """The value after the = of a let or a set."""
        if self.peek.type != "EQUAL":
            raise Fault(self.peek, f"an = is missing after {word} {name}, found {self.peek.found()}", f"write {word} {name} = 3")
        self.take()
        settings = {*KEYWORDS["place"], "set"} if word == "set" else ()
        node = self.expression(Slot("let", str(name)), frozenset(settings))
        self.end_of_statement(word, settings)
        return node

    # -- let, repeat, include

    def new_name(self, what: str) -> Token:
        t = self.peek
        if t.type not in ("NAME", "MOD"):
            raise Fault(t, f"a name is missing after {what}, found {t.found()}", f"e.g. {STATEMENTS[what][0]}")
        if t in RESERVED:
            raise Fault(t, f"'{t}' is a word of the language and cannot be a name", "take another name")
        self.shared.names.add(str(t))
        return self.take()

    def let(self, word: Token) -> Let:
        name = self.new_name("let")
        self.shared.lets.setdefault(str(name), name.line)
        if self.peek.type == "EQUAL" and self.ahead(1).type == "LBRACE":
            self.take()
            opened = self.take()
            return Let(self.source, name, None, self.body("object", opened, 0, f"let {name}"))
        return Let(self.source, name, self.given("let", name))

    def use(self, word: Token, block: str, repeats: int) -> Use:
        """``use name``, in an object."""
        if block != "object":
            raise Fault(word, "use can only stand in an object", "write object NAME { use wood ... }")
        if repeats:
            raise Fault(word, "use cannot stand in a repeat", "it is given once")
        name = self.peek
        if name.type != "NAME":
            raise Fault(
                name, f"a name is missing after use, found {name.found()}", "e.g. use wood, with let wood = { density ... }"
            )
        self.take()
        self.end_of_statement("use", KEYWORDS["object"])
        return Use(self.source, name)

    def repeat(self, word: Token, block: str, repeats: int) -> Repeat:
        if repeats == DEEPEST_REPEAT:
            raise Fault(word, f"more than {DEEPEST_REPEAT} repeats stand inside each other")
        variable = self.new_name("repeat")
        way_out = f"write repeat {variable} in 1 .. 10 {{"
        if self.peek != "in":
            raise Fault(self.peek, f"'in' is missing after repeat {variable}, found {self.peek.found()}", way_out)
        self.take()
        low = self.expression(Slot("number", "first"), frozenset([".."]))
        if self.peek.type != "DOTS":
            raise Fault(self.peek, f"'..' is missing in repeat {variable}, found {self.peek.found()}", way_out)
        self.take()
        high = self.expression(Slot("number", "last"), frozenset())
        title = f"repeat {variable}"
        self.brace(title)
        return Repeat(self.source, word, variable, low, high, self.body(block, word, repeats + 1, title))

    def include(self, word: Token, block: str, repeats: int) -> list:
        t = self.text("include", 'e.g. include "rubber.txt"')
        self.end_of_statement("include", ())
        file = str(t)[1:-1]
        path = Path(os.path.realpath(self.source.folder / file)) if "\0" not in file else Path()
        if path in self.chain:
            loop = [p.name for p in self.chain[self.chain.index(path) :]] + [path.name]
            raise Fault(t, f"this include goes round in a circle: {' -> '.join(loop)}", "remove one of them")
        self.shared.files += 1
        if len(self.chain) > DEEPEST_INCLUDE:
            names = " -> ".join(p.name for p in (*self.chain, path))
            raise Fault(t, f"includes go more than {DEEPEST_INCLUDE} levels deep: {names}")
        if self.shared.files > MOST_FILES:
            raise Fault(t, f"more than {MOST_FILES} files are included")
        try:
            text = read_text(path, MOST_BYTES - self.shared.bytes)
            self.shared.bytes += len(text.encode())
        except UnreadableFile as e:
            where = f" (at {e.span.line}:{e.span.column})" if e.span else ""
            raise Fault(t, f"cannot include {t}: {path} {e}{where}", "the name is relative to this file") from None
        except (ValueError, OSError) as e:
            reason = e.strerror if isinstance(e, OSError) else str(e)
            raise Fault(t, f"cannot include {t}: {path} {reason}", "the name is relative to this file") from None
        if line := foreign_line(text):
            raise Fault(
                t, f"cannot include {t}: {path} is not a part of a scene", f"its line {line} begins with no word of a scene"
            )
        shown = str(Path(self.source.name).parent / file)
        inner = SceneFile(shown, text, path, (*self.source.included_from, self.source.span(word, t)))
        parser = Parser(inner, self.shared, self.chain)
        try:
            return parser.body(block, None, repeats)
        except Unclosed as trouble:
            parser.problem(Fault(trouble.token, f"'{trouble.token}' cannot stand inside {block} {{ }}"))
            return []
