# SPDX-License-Identifier: GPL-2.0-only
"""Common parts of benches: interleaved rounds, medians and minima, JSON, tables in Markdown.

A bench that ``bench/all.py`` prints is a module with ``measure(rounds, quick) -> rows`` and ``table(rows) -> str``; rows are
dicts of numbers and words that JSON holds.
"""

import os
import platform
import statistics
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Sample:
    """Figures of one variant over all rounds."""

    values: tuple[float, ...]

    @property
    def median(self) -> float:
        return statistics.median(self.values)

    @property
    def least(self) -> float:
        return min(self.values)

    def over(self, other: "Sample") -> dict[str, float]:
        """This over the other: by medians, by minima, and the median of the ratios of the same round."""
        pairs = statistics.median(a / b for a, b in zip(self.values, other.values))
        return {"medians": self.median / other.median, "minima": self.least / other.least, "rounds": pairs}


def seconds(work: Callable[[], object], clock: Callable[[], float] = time.perf_counter) -> float:
    """Time of a call [s]."""
    start = clock()
    work()
    return clock() - start


def interleaved(variants: dict[str, Callable[[], float]], rounds: int) -> dict[str, Sample]:
    """Call all variants in turns, every other round backwards, so that all of them see the same machine;
    each gives its own figure."""
    found: dict[str, list[float]] = {name: [] for name in variants}
    for n in range(rounds):
        for name in list(variants)[:: 1 if n % 2 == 0 else -1]:
            found[name].append(variants[name]())
    return {name: Sample(tuple(values)) for name, values in found.items()}


def markdown(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table; numbers with three digits that count."""

    def cell(value: object) -> str:
        if isinstance(value, float):
            return f"{value:.3g}" if abs(value) < 1000.0 else f"{value:,.0f}"
        return f"{value:,}" if isinstance(value, int) else str(value)

    lines = [head, ["---"] * len(head), *([cell(v) for v in row] for row in rows)]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def print_tables(tables: Mapping[str, Callable[[], tuple[Sequence[str], Iterable]]], words: Sequence[str]) -> None:
    """Print the tables of these words, all without one: each is made by a function whose docstring is its title."""
    for word in words or tables:
        print(f"\n{tables[word].__doc__}\n")
        print(markdown(*tables[word]()))


def processor() -> str:
    """Name of the processor."""
    told: dict[str, str] = {}
    for line in Path("/proc/cpuinfo").read_text().splitlines():
        name, _, value = line.partition(":")
        told.setdefault(name.strip(), value.strip())
    cpu = told.get("model name", platform.processor())
    if "model" in told:  # names of virtual machines do not say which generation
        cpu += f" (family {told['cpu family']}, model {told['model']})"
    return cpu


def machine() -> str:
    """Processor and load, in a line."""
    busy = os.getloadavg()[0] / os.cpu_count()
    return f"{processor()}, {os.cpu_count()} cores; load at the start {busy:.1f} per core" + (
        ": **a busy machine, so read ratios and minima**" if busy > 0.5 else ""
    )


def replace_between(page: Path, name: str, text: str) -> None:
    """Put text between the lines ``<!-- NAME: written by … -->`` and ``<!-- end of NAME -->`` of a page."""
    lines = page.read_text(encoding="utf-8").splitlines()
    begin = next(n for n, line in enumerate(lines) if line.startswith(f"<!-- {name}: written by "))
    end = lines.index(f"<!-- end of {name} -->")
    page.write_text("\n".join([*lines[: begin + 1], text.rstrip("\n"), *lines[end:]]) + "\n", encoding="utf-8")
