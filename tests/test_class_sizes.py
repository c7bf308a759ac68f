# SPDX-License-Identifier: GPL-2.0-only
"""Classes of the plugin are small: a class is read from its first line to the end of its last function."""

import re
from collections import Counter
from pathlib import Path

PLUGIN = Path(__file__).parents[1] / "plugin"
MOST_LINES, MOST_MEMBERS = 400, 30


def without_text(source: str) -> str:
    """The same lines with blanks for comments, strings, characters and directives."""
    blank = r"""//[^\n]*|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])+'|^[ \t]*#(?:[^\n]*\\\n)*[^\n]*"""
    return re.sub(blank, lambda found: re.sub(r"[^\n]", " ", found[0]), source, flags=re.MULTILINE)


def end_of(source: str, brace: int) -> int:
    """The place of the brace that closes the one at `brace`."""
    depth = 0
    for found in re.compile("[{}]").finditer(source, brace):
        depth += 1 if found[0] == "{" else -1
        if depth == 0:
            return found.start()
    return len(source)


def data_members(body: str) -> int:
    """How many values a class holds, by the declarations of its body that are neither functions nor types nor constants."""
    flat, place = "", 0
    while (brace := body.find("{", place)) >= 0:
        flat, place = flat + body[place:brace], brace
        head = flat[max(map(flat.rfind, ";}\0")) + 1 :]
        initial = not re.search(r"\)[^=]*$|\b(class|struct|enum|union)\b", head)
        flat, place = flat + ("" if initial else "}"), end_of(body, place) + 1
    flat += body[place:]
    count = 0
    for one in re.split(r"[;}]", re.sub(r"\b(public|private|protected):", ";", flat)):
        for _ in range(4):
            one = re.sub(r"<[^<>]*>", "", one)
        one = re.sub(r"=[^,]*", "", one).strip()
        if one and "(" not in one and not re.match(r"(static|using|friend|typedef|enum|struct|class|template|operator)\b", one):
            count += 1 + one.count(",")
    return count


def sizes() -> dict[str, tuple[int, int]]:
    """Lines and members of each class, those of its functions elsewhere among the lines."""
    lines, members = Counter(), Counter()
    for path in sorted(p for p in PLUGIN.rglob("*.[hc]*") if p.suffix in (".h", ".cpp")):
        text = path.read_text(encoding="utf-8")
        source, rows = without_text(text), text.split("\n")
        for found in re.finditer(r"\b(?:class|struct)\s+(?:alignas\([^)]*\)\s*)?(\w+)\s*(?::[^;{()]*)?\{", source):
            end = end_of(source, found.end() - 1)
            lines[found[1]] += source.count("\n", found.start(), end) + 1
            members[found[1]] = max(members[found[1]], data_members(source[found.end() : end]))
        functions = (
            re.finditer(r"^(?![ \t{}#])[^\n;{}=]*?\b(\w+)::~?\w+\s*\(", source, re.MULTILINE) if path.suffix == ".cpp" else ()
        )
        for found in functions:
            first = source.count("\n", 0, found.start())
            while first and rows[first - 1].startswith("//"):  # what is said of the function
                first -= 1
            lines[found[1]] += source.count("\n", 0, end_of(source, source.index("{", found.end()))) + 1 - first
    return {name: (lines[name], members[name]) for name in members}


def test_classes_are_small():
    """At most so many lines over all files, and so many values that it holds. One is over several files, one has values of many
    kinds."""
    found = sizes()
    assert found["WaveColumns"][0] > 250 and found["PairLaw"] == (3, 2) and found["ContactAccount"][1] == 9
    assert {name: size for name, size in found.items() if size[0] > MOST_LINES or size[1] > MOST_MEMBERS} == {}
