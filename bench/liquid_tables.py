# SPDX-License-Identifier: GPL-2.0-only
"""All measured tables of the liquid with waves in docs/physics-liquid.md: ``python bench/liquid_tables.py [PART ...]``.

Parts: forms, bodies, cost (bench/waves.py), drafts, bobbing (bench/drafts.py), momentum (bench/momentum.py), share
(bench/liquid.py). ``--write`` puts the
tables into the page in place of those that stand there; without it they are printed only. ``--rounds N`` is for the parts that
measure time, cost and share. Every part runs in a process of its own; a part that fails is told as such, its table on the page
stays, and the exit code is 1.
"""

import argparse
import subprocess
import sys
from pathlib import Path

from timing import machine, replace_between

PAGE = Path(__file__).resolve().parent.parent / "docs" / "physics-liquid.md"
TIMED = ("cost", "share")
PARTS = ("forms", "bodies", "cost", "drafts", "bobbing", "momentum", "share")
LIMIT = 3600
"""Seconds that a part may take."""


def table(part: str, rounds: int) -> str:
    """The table of a part, in Markdown, measured here."""
    if part == "share":
        import liquid

        return liquid.table(rounds)
    if part in ("drafts", "bobbing"):
        import drafts

        return drafts.drafts_in_waves() if part == "drafts" else drafts.bobbing_table()
    if part == "momentum":
        import momentum

        return momentum.table()
    import waves

    return waves.table(part, *([rounds] if part == "cost" else []))


def told(part: str, rounds: int) -> str | None:
    """A part as it stands on the page, measured by a process of its own; None if it fails."""
    head = f"`python bench/liquid_tables.py {part}`"
    if part in TIMED:
        head += f", {rounds} rounds of one thread. {machine()}"
    words = [sys.executable, __file__, "--table", part, "--rounds", str(rounds)]
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=LIMIT)
    except subprocess.TimeoutExpired:
        print(f"{part} took longer than {LIMIT} s", file=sys.stderr)
        return None
    if done.returncode:
        print(f"{part} failed: {(done.stderr.strip().splitlines() or ['ended without a word'])[-1]}", file=sys.stderr)
        return None
    return f"{head}:\n\n{done.stdout.rstrip()}\n"


def main() -> int:
    """Measure, print, and write if asked to; the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("parts", nargs="*", metavar="PART", help=", ".join(PARTS))
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--table", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.table:
        print(table(options.table, options.rounds))
        return 0
    if unknown := set(options.parts) - set(PARTS):
        parser.error(f"unknown: {', '.join(sorted(unknown))}; parts are {', '.join(PARTS)}")
    failed = False
    for part in options.parts or PARTS:
        text = told(part, options.rounds)
        failed = failed or text is None
        print(text or f"{part} could not be measured\n", flush=True)
        if text and options.write:
            replace_between(PAGE, part, text)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
