# SPDX-License-Identifier: GPL-2.0-only
"""The tables of docs/stability.md: ``python bench/stability.py [cases] [surfaces] [tunnelling] [random] [long] [write]``.

cases        every hard case of tests/stability: criterion, what was measured, margin
surfaces     those in which something touches, with contact-model surface
tunnelling   closing speed at which two cubes pass through each other, and a block through a plate, against thickness
             and sideways displacement, with both laws of contact
random       what 300 random scenes do at the certified time step, and at three times it

Without one of these, all. ``long`` takes the long form of the cases (ten minutes), ``write`` puts the tables into the page
in place of the ones that stand there. Exit code 1 when a case is beyond a limit.
"""

import sys
from itertools import groupby
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "stability.md"
sys.path.insert(0, str(ROOT / "tests" / "stability"))

OFFSETS = ((0.0, 0.0), (0.25, 0.25), (0.0, 0.5), (0.5, 0.5))


def number(value: float) -> str:
    """Few digits, none of them idle."""
    return f"{value:.3g}"


def margin(found: float, most: float) -> str:
    """How many times smaller the error is than allowed."""
    if not found <= most:
        return "**beyond**"
    if most == 0.0:
        return "exact" if found == 0.0 else number(-found) + " to spare"
    if found <= 0.0:
        return "none used"
    return f"× {most / found:.2g}" if most / found < 100.0 else f"> 10^{len(f'{most / found:.0f}') - 1}"


def cases(long: bool) -> tuple[str, bool]:
    """Table of all cases, then the reasons of their limits; and whether all hold."""
    from cases import CASES

    return table(CASES, long)


def surfaces(long: bool) -> tuple[str, bool]:
    """The same with contact at the surfaces; reasons are those of limits that differ."""
    from surfaces import CASES, CHANGED

    return table(CASES, long, set(CHANGED))


def table(those: list, long: bool, told: set[str] | None = None) -> tuple[str, bool]:
    """Rows of cases, and reasons: of all, or of those ``told``."""
    from case import broken

    lines = ["| case | criterion | measured | margin |", "|---|---|---|---|"]
    good = True
    for case in those:
        found = case.measure(long)
        good &= not broken(case, found)
        for n, (what, most) in enumerate(case.most.items()):
            lines.append(
                f"| {'' if n else case.name} | {what} ≤ {number(most)} | {number(found[what])} | {margin(found[what], most)} |"
            )
    lines += ["", "Why these limits:", ""]
    for why, group in groupby([c for c in those if told is None or c.name in told], key=lambda case: case.why):
        names = [case.name for case in group]
        lines.append(f"- *{names[0]}{f' … {names[-1]}' if names[1:] else ''}*: {why}.")
    return "\n".join(lines), good


def tunnelling(long: bool) -> tuple[str, bool]:
    """Table of the lowest closing speed over c at which cubes pass, and what the cases take it for."""
    from contacts import PASSES_AT, PLATE_PASSES_AT, plate_tunnelling_speed, tunnelling_speed

    lines = [
        "| two objects, or block on | "
        + " | ".join(f"displaced by ({x:g}, {y:g}) h" for x, y in OFFSETS)
        + " | least | taken as |",
        "|---" * (len(OFFSETS) + 3) + "|",
    ]
    good = True
    kinds = (("cube", PASSES_AT, tunnelling_speed), ("plate", PLATE_PASSES_AT, plate_tunnelling_speed))
    for kind, known, speed in kinds:
        for cells, taken in known.items():
            for model, words in (("paper", ""), ("surface", ", at surfaces")):
                speeds = [speed(cells, offset, model) for offset in OFFSETS]
                good &= min(speeds) >= taken - 1e-9
                lines.append(
                    f"| {kind}, {cells} cells{words} | "
                    + " | ".join(f"{s:.2f}" for s in speeds)
                    + f" | {min(speeds):.2f} | {taken:g} |"
                )
    return "\n".join(lines), good


def random(long: bool) -> tuple[str, bool]:
    """One sentence on 300 scenes, or 3000."""
    from random_scenes import MOST, try_scenes

    tally = try_scenes(3000 if long else 300, lambda trial: None)
    return f"{tally}.", max(tally.drift) <= MOST and not any(tally.lost)


def put(name: str, text: str) -> None:
    """Replace what stands between the marks of a table in the page."""
    begin, end = f"<!-- {name}: written by bench/stability.py -->\n", f"<!-- end of {name} -->"
    before, rest = PAGE.read_text(encoding="utf-8").split(begin)
    PAGE.write_text(before + begin + text + "\n" + end + rest.split(end, 1)[1], encoding="utf-8")


def main(*words: str) -> int:
    """Measure and print; the exit code."""
    parts = {"cases": cases, "surfaces": surfaces, "tunnelling": tunnelling, "random": random}
    if unknown := set(words) - parts.keys() - {"long", "write"}:
        print(__doc__, f"unknown: {' '.join(sorted(unknown))}", sep="\n", file=sys.stderr)
        return 2
    all_good = True
    for name in [n for n in parts if n in words] or list(parts):
        text, good = parts[name]("long" in words)
        print(text, end="\n\n")
        all_good &= good
        if "write" in words:
            put(name, text)
    return 0 if all_good else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
