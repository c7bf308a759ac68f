# SPDX-License-Identifier: GPL-2.0-only
"""The meaning of a word: a setting, a block, a shape, an effect, a quantity, a unit, a limit."""

from __future__ import annotations

from collections.abc import Iterator

from ..features import facets
from . import shapes, units
from .formatting import say
from .forms import literals
from .keywords import BLOCKS, KEYWORDS, NOT_SUPPORTED, STATEMENTS, SYNONYMS, all_keywords, did_you_mean, example
from .limits import LIMITS
from .scene import QUANTITIES
from .schema import Keyword, Rule, meaning, syntax, units_shown

MARGINS = {
    "time step": "the bound of each object on the time step; above it motion blows up. 'timestep auto' is half of it",
    "drag": "phi = drag * dt / 2 m of a particle; where it is large the exponential form is used instead of the implicit one",
    **{name: about for words in facets("words") for name, about in getattr(words, "MARGINS", {}).items()},
}
"""Limits that `check` prints with their margins, and certificate.json holds."""

LEDGER: dict[str, str] = {}
"""Columns of the ledger with a meaning of their own; of one that several features share, what each of them says."""
for _words in facets("words"):
    for _name, _about in getattr(_words, "LEDGER", {}).items():
        LEDGER[_name] = f"{LEDGER[_name]}; {_about}" if _name in LEDGER else _about


def explain(word: str) -> str:
    """All meanings of a word, one after the other. Raises KeyError that suggests a near word."""
    wanted = word.strip().lower().replace("_", " ")
    found = [text for name, text in _entries() if wanted in (name.lower(), _spaced(name)) or text.startswith(f"{wanted}   ")]
    if not found:
        raise KeyError(
            f"'{word}' is not a word of a scene; {did_you_mean(wanted, words()) or 'explain without a word lists all of them'}"
        )
    return "\n\n".join(found)


def _spaced(name: str) -> str:
    return name.lower().replace("-", " ").replace("_", " ")


def words() -> list[str]:
    """All words that can be explained, in alphabetical order."""
    return sorted({name for name, _ in _entries()})


def _entries() -> Iterator[tuple[str, str]]:
    for block in BLOCKS.values():
        inside = ", ".join(KEYWORDS[block.name])
        yield block.name, f"{block.head} {{ ... }}   a block\n  {_plain(block.about)}\n  inside: {inside}"
        for kind, about in block.kinds.items():
            head = block.head.replace("|".join(block.kinds), kind)
            yield kind, f"{head} {{ ... }}   a kind of {block.name}\n  {_plain(about)}: mdanim-lammps explain {block.name}"
    for keyword in all_keywords():
        places = [b for b in (keyword.block, *(b.name for b in BLOCKS.values() if keyword.shared and b.of == keyword.block)) if b]
        yield (
            keyword.name,
            _keyword(keyword, f"in {' and '.join(f'{b} {{ }}' for b in places)}" if places else "outside of all blocks"),
        )
    for name, (form, about) in STATEMENTS.items():
        yield name, f"{form}   a statement\n  {_plain(about)}"
    for kind in vars(shapes).values():
        if isinstance(kind, type) and (forms := getattr(kind, "FORMS", ())) and forms[0].split()[0].isalpha():
            for name in dict.fromkeys(form.split()[0] for form in forms):
                yield name, f"{_slots(' | '.join(forms))}\n  {_plain((kind.__doc__ or '').splitlines()[0])}"
    for kind in (k for words in facets("words") for k in getattr(words, "ELASTICITIES", ())):
        for form in kind.FORMS:
            about = kind.ABOUT.replace(f"`{form}`: ", "", 1)
            yield form.split()[0], f"elasticity {_slots(form)}   a form of elasticity in object {{ }}\n  {_plain(about)}"
    for (subject, quantity), kind in QUANTITIES.items():
        unit = kind.unit if kind.unit != "1" else "plain numbers"
        subject = "NAME" if subject == "NAMES" else subject
        what = f"expect {subject}.{quantity} = ...   a quantity, in {unit}\n  {_plain(meaning(subject, kind))}"
        yield f"{subject}.{quantity}".removeprefix("NAME."), what
    for unit, about, others in units.LISTED:
        limit = f", at most {say(LIMITS[unit].most, unit, 6)}" if unit in LIMITS else ""
        for name in others.split():
            yield name, f"{name}   a unit of {about.split(' ', 1)[1]} (also {others}){limit}"
    for name, about in MARGINS.items():
        yield name, f"{name}   a limit that check prints with its margin\n  {about}"
    for name, about in (entry for facet in facets("follow") for entry in facet.explained().items()):
        yield name, about
    for name, about in LEDGER.items():
        yield name, f"{name}   a column of ledger.csv\n  {about}"
    for name, instead in NOT_SUPPORTED.items():
        within = ", ".join(sorted({k.name for k in all_keywords() if name in literals(k.form)}))
        alone = f"is a word of {within}, and nothing by itself" if within else "is not in the language"
        yield name, f"{name}   {alone}\n  instead: {_plain(instead)}"
    for name, shape in SYNONYMS.items():
        yield name, f"{name}   is written as the shape '{shape}': mdanim-lammps explain {shape}"


def _keyword(k: Keyword, where: str) -> str:
    lines = [f"{k.name} {_plain(syntax(k))}   a setting {where}", _plain(k.about)]
    default = "needed" if k.needed else f"one of {', '.join(k.one_of)} is needed" if k.one_of else ""
    default = default or (f"default {k.default}" if k.default else "")
    rule = "" if k.rule is Rule.ANY else f"must be {k.rule.value}"
    many = "may be given several times" if k.many else ""
    facts = [f"in {units_shown(k)}" if units_shown(k) else "", rule, default, many]
    return "\n  ".join(filter(None, [*lines, "; ".join(filter(None, facts)), example(k)]))


def _slots(form: str) -> str:
    return form.replace("<@", "<").replace("<", "").replace(">", "").replace(":m", "")


def _plain(text: str) -> str:
    """Without the marks of Markdown."""
    return text.replace("`", "")
