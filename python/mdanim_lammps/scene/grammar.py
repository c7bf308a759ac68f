# SPDX-License-Identifier: GPL-2.0-only
"""The language for editors, as a TextMate grammar (``python -m mdanim_lammps.scene.grammar`` prints it)."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator

from . import units
from .forms import OptionalPart, Slot, Word, alternatives
from .functions import FUNCTIONS
from .keywords import BLOCKS, KEYWORDS, STATEMENTS
from .scene import QUANTITIES


def grammar() -> dict:
    """Plain data of ``editors/vscode/syntaxes/mdanim.tmLanguage.json``: words by what they are."""
    settings = {name for block in KEYWORDS.values() for name in block}
    forms = [alternatives(k.form) for block in KEYWORDS.values() for k in block.values()]
    literals = {word for form in forms for parts in form for word in _literals(parts)}
    quantities = {f"{subject}.{quantity}" if subject != "NAME" else quantity for subject, quantity in QUANTITIES}
    unit = {name for _, _, names in units.LISTED for name in names.split()}
    match = lambda words, scope: {"match": rf"(?<![\w.-])(?:{_any(words)})(?![\w-])", "name": scope}
    return {
        "$schema": "https://raw.githubusercontent.com/martinring/tmlanguage/master/tmlanguage.json",
        "name": "mdanim scene",
        "scopeName": "source.mdanim",
        "patterns": [
            {"match": r"#.*$", "name": "comment.line.number-sign.mdanim"},
            {"match": r'"[^"\n]*"', "name": "string.quoted.double.mdanim"},
            {
                "match": rf"\b({_any(b.name for b in BLOCKS.values())})(?:\s+([^\W\d]\w*(?:\[[^\]]*\])?))?(?=[^{{}}\n]*\{{)",
                "captures": {"1": {"name": "keyword.control.mdanim"}, "2": {"name": "entity.name.type.mdanim"}},
            },
            {
                "match": r"\b(let)\s+([^\W\d]\w*)",
                "captures": {"1": {"name": "keyword.control.mdanim"}, "2": {"name": "variable.other.mdanim"}},
            },
            match(STATEMENTS, "keyword.control.mdanim"),
            {"match": r"(?<![\w.])(?:[0-9]+(?:\.(?!\.)[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?", "name": "constant.numeric.mdanim"},
            {"match": rf"\b(?:{_any(FUNCTIONS)}|rand)(?=\s*\()", "name": "support.function.mdanim"},
            match(settings, "keyword.other.mdanim"),
            match(literals - settings, "constant.language.mdanim"),
            {"match": rf"\.(?:{_any(quantities)})(?!\w)", "name": "support.variable.mdanim"},
            {"match": rf"(?<=[\d)\s/*])(?:{_any(unit)})(?![\w(])", "name": "storage.type.unit.mdanim"},
        ],
    }


def _literals(parts) -> Iterator[str]:
    """Words of a form that stand in scenes as they are."""
    for part in parts:
        if isinstance(part, OptionalPart):
            yield from _literals(part.parts)
        elif isinstance(part, Word):
            yield part.text
        elif isinstance(part, Slot):
            yield from part.choices


def _any(words) -> str:
    """An alternative of words, the longest first."""
    return "|".join(map(re.escape, sorted(words, key=lambda word: (-len(word), word))))


if __name__ == "__main__":
    print(json.dumps(grammar(), indent=1))
