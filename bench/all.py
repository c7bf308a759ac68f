# SPDX-License-Identifier: GPL-2.0-only
"""Measures all that docs/performance.md tells, in one go: ``python bench/all.py [--quick] [--rounds N] [--write] [PART ...]``.

Parts: step, alone, pressed, automaton, around, memory, limits. ``--quick`` takes about a minute. ``--write`` puts tables and the
plot into docs/ in place of those that stand there, and figures into docs/performance.json, under the processor's name; without it
they are printed only. Every part runs in a process of its own, and its contenders take turns in every round. A part that fails is
told as such; the exit code is 1 then.
"""

import argparse
import json
import subprocess
import sys
import time
from importlib import import_module
from pathlib import Path

from processors import FIGURES
from processors import table as of_processors
from timing import Sample, machine, markdown, processor, replace_between

PAGE = Path(__file__).resolve().parent.parent / "docs" / "performance.md"
PLOT = PAGE.parent / "images" / "performance.png"
LIMIT = 1800
"""Seconds that a part may take."""


class Step:
    """bench/step.py: whole steps against stock LAMMPS, and against the limits of one core."""

    IN_CACHE = 100_000
    """Particles, of 100 bytes each, that caches hold."""

    @staticmethod
    def measure(rounds: int, quick: bool) -> list[dict]:
        import limits
        import step

        rows, (machines,) = [], limits.measure()
        for title, text in list(step.SCENES.items())[: 1 if quick else None]:
            found = step.measure(text, rounds)
            samples = {name: Sample(tuple(values)) for name, values in found["ns"].items()}
            base = samples[step.STOCK]
            rows += [
                {
                    "scene": title,
                    "particles": found["particles"],
                    "springs": found["springs"],
                    "contender": name,
                    "median": s.median,
                    "least": s.least,
                    "faster": {k: 1.0 / r for k, r in s.over(base).items()},
                    "limits": limits.of_scene(
                        machines, found["springs"] / found["particles"], found["particles"] < Step.IN_CACHE
                    ),
                }
                for name, s in samples.items()
            ]
        return rows

    @staticmethod
    def table(rows: list[dict]) -> str:
        return markdown(
            [
                "scene",
                "particles",
                "contender",
                "ns per particle-step, median",
                "minimum",
                "times as fast as stock, medians",
                "minima",
                "minimum over the limit of roots",
                "of loads and stores",
                "binds",
            ],
            [
                (
                    r["scene"],
                    r["particles"],
                    r["contender"],
                    r["median"],
                    r["least"],
                    r["faster"]["medians"],
                    r["faster"]["minima"],
                    r["least"] / r["limits"]["roots"],
                    r["least"] / r["limits"]["loads and stores"],
                    max(r["limits"], key=r["limits"].get),
                )
                for r in rows
            ],
        )


PARTS = {
    "step": ("The whole step, beside stock LAMMPS", Step),
    "alone": ("Each effect alone, where it acts", "alone"),
    "pressed": ("Contact: two pressed blocks, and the same apart", "pressed"),
    "automaton": ("A sweep of the liquid, beside a copy of its grid", "automaton"),
    "around": ("Around the steps: start, output, pictures", "around"),
    "memory": ("Memory", "memory"),
    "limits": ("What the machine can do", "limits"),
}


def part(name: str):
    """The module or class that measures a part."""
    where = PARTS[name][1]
    return import_module(where) if isinstance(where, str) else where


def measure(name: str, rounds: int, quick: bool) -> dict:
    """Rows of a part, measured by a process of its own, or why there are none."""
    words = [sys.executable, __file__, "--rows", name, "--rounds", str(rounds), *(["--quick"] if quick else [])]
    start = time.perf_counter()
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=LIMIT)
    except subprocess.TimeoutExpired:
        return {"failed": f"took longer than {LIMIT} s"}
    if done.returncode:
        return {"failed": (done.stderr.strip().splitlines() or ["ended without a word"])[-1]}
    return {"rows": json.loads(done.stdout.splitlines()[-1]), "seconds": time.perf_counter() - start}


def told(name: str, found: dict) -> str:
    """A part as it stands on the page."""
    body = f"**Not measured:** {found['failed']}" if "failed" in found else part(name).table(found["rows"])
    return f"### {PARTS[name][0]}\n\n{body}\n"


def draw(found: dict) -> bool:
    """The plot of whole steps and limits; whether there was anything to draw."""
    rows = found.get("step", {}).get("rows")
    if not rows:
        return False
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    scenes = list(dict.fromkeys(r["scene"] for r in rows))
    figure, axes = pyplot.subplots(
        1, len(scenes), figsize=(4.0 * len(scenes), 3.2), sharex=True, squeeze=False, layout="constrained"
    )
    for axis, scene in zip(axes[0], scenes):
        own = [r for r in rows if r["scene"] == scene][::-1]
        axis.barh([r["contender"] for r in own], [r["median"] for r in own], color="0.75", label="median")
        axis.barh([r["contender"] for r in own], [r["least"] for r in own], color="C0", height=0.5, label="minimum")
        if "rows" in found.get("limits", {}):
            axis.axvline(max(found["limits"]["rows"][0][k] for k in ("memory", "roots")), color="k", linestyle=":", label="limit")
        axis.set_title(scene, fontsize=9)
        axis.set_xlabel("ns per particle-step")
        axis.tick_params(labelsize=7)
    axes[0][0].legend(fontsize=7)
    PLOT.parent.mkdir(exist_ok=True)
    figure.savefig(PLOT, dpi=110)
    return True


def main() -> int:
    """Measure, print, and write if asked to; the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("parts", nargs="*")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--rounds", type=int)
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--rows", help=argparse.SUPPRESS)
    options = parser.parse_args()
    rounds = options.rounds or (3 if options.quick else 9)
    if options.rows:
        print(json.dumps(part(options.rows).measure(rounds, options.quick)))
        return 0
    if unknown := set(options.parts) - PARTS.keys():
        parser.error(f"unknown: {', '.join(sorted(unknown))}; parts are {', '.join(PARTS)}")
    text = f"`python bench/all.py{' --quick' if options.quick else ''}`, {rounds} rounds. {machine()}.\n"
    print(text, flush=True)
    found = {}
    for name in options.parts or PARTS:
        found[name] = measure(name, rounds, options.quick)
        text += "\n" + told(name, found[name])
        print(told(name, found[name]), flush=True)
    failed = [name for name, f in found.items() if "failed" in f]
    if options.write and failed:
        print(f"nothing is written: {', '.join(failed)} could not be measured", file=sys.stderr)
    elif options.write:
        if draw(found):
            text += "\n![nanoseconds per particle-step](images/performance.png)\n"
        replace_between(PAGE, "bench", text)
        measured = json.loads(FIGURES.read_text())
        measured[processor()] = measured.get(processor(), {}) | found
        FIGURES.write_text(json.dumps(measured, indent=1) + "\n")
        replace_between(PAGE, "processors", of_processors(measured))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
