# SPDX-License-Identifier: GPL-2.0-only
"""Scenes against published figures: ``python bench/validation.py [--cost] [--quick] [--write] [--page] [--peers] [CASE ...]``.

Cases are in bench/published/, their scenes in scenes/validation/; with names only these. ``--cost`` measures each at preview and
reference beside balanced, ``--quick`` only those that take a few seconds. ``--write`` keeps what is found in
bench/published/found/, a file for each case, and draws docs/images/validation-CASE.png; with it, or by ``--page`` without
measuring, docs/validation.md is written from all that is kept. ``--peers`` measures what other programs give for the same scenes:
MuJoCo by .venv-peers (make .venv-peers/.installed), SPH by LAMMPS itself. The exit code is 1 where a row is off by more than it
may be.
"""

from __future__ import annotations

import json
import math
import re
import sys
from collections.abc import Iterable
from dataclasses import asdict
from importlib import import_module
from pathlib import Path

from published import mujoco_runs, sph_runs
from published.case import ROOT, Case, Curve, Found, Row, Runs
from timing import machine, markdown, replace_between

PARTS = (
    "friction",
    "standing",
    "arches",
    "dominoes",
    "blows",
    "tops",
    "motion",
    "beams",
    "contact",
    "ropes",
    "machines",
    "yielding",
    "dams",
    "waves",
    "wakes",
    "afloat",
)
"""Modules of bench/published, in the order of the page."""
PEERS = {way: runs for peer, runs in ((mujoco_runs, mujoco_runs.MujocoRuns), (sph_runs, sph_runs.SphRuns)) for way in peer.WAYS}
"""Runs by other programs, by the names under which their figures are kept."""
ACCURACIES = ("preview", "balanced", "reference")
PAGE = ROOT / "docs" / "validation.md"
KEPT = Path(__file__).parent / "published" / "found"
NOT_FOUND = "not found"
HEAD = ("figure", "published", "found", "off", "within")


def cases() -> list[Case]:
    """All cases, in the order of the page."""
    return [case for part in PARTS for case in import_module(f"published.{part}").CASES]


def measured(case: Case, way: str) -> tuple[Found, float]:
    """Findings of a case at an accuracy or by another program, and the processor time of its runs [s]."""
    with PEERS.get(way, Runs)(way) as runs:
        return case.measure(runs), runs.seconds


def _percent(share: float, sign: str = "") -> str:
    if math.isnan(share):
        return NOT_FOUND
    if 0.0 < abs(share) < 1e-5:
        return "< 0.001 %"
    return f"{100 * share:{sign}.0f} %" if abs(share) >= 1.0 else f"{100 * share:{sign}.2g} %"


def cells(row: Row) -> list[str]:
    """A row of the table: off in bold where it is more than it may be."""
    unit = f" {row.unit}" if row.unit else ""
    off = _percent(row.off, "+")
    return [
        row.figure,
        f"{row.published:.4g}{unit}",
        NOT_FOUND if math.isnan(row.found) else f"{row.found:.4g}{unit}",
        off if row.close else f"**{off}**",
        f"{100 * row.within:.3g} %",
    ]


def keep(case: Case, accuracy: str, found: Found, seconds: float) -> None:
    """Store the rows of a case at an accuracy beside those that are kept."""
    path = KEPT / f"{case.name}.json"
    stored = json.loads(path.read_text()) if path.exists() else {}
    rows = [asdict(row) for row in found.rows]
    stored[accuracy] = {"rows": rows, "seconds": float(f"{seconds:.3g}"), "machine": machine().partition(";")[0]}
    path.parent.mkdir(exist_ok=True)
    path.write_text(json.dumps({name: stored[name] for name in (*ACCURACIES, *PEERS) if name in stored}, indent=1) + "\n")


def picture_of(case: Case) -> Path:
    """The file of its figure."""
    return ROOT / "docs" / "images" / f"validation-{case.name}.png"


def draw(case: Case, curve: Curve) -> None:
    """The figure of a case."""
    from matplotlib.figure import Figure
    from mdanim_lammps.picture.plot import own_style

    with own_style():
        figure = Figure(figsize=(6.4, 3.6), layout="constrained")
        axes = figure.add_subplot(xlabel=curve.x, ylabel=curve.y)
        for name, (x, y) in curve.lines.items():
            axes.plot(x, y, label=name)
        for name, (x, y) in curve.points.items():
            axes.plot(x, y, "o", mfc="none", label=name)
        wide = max(map(len, (*curve.lines, *curve.points))) > 20
        figure.legend(loc="outside upper center", ncols=2 if wide else 3, frameon=False)
        figure.savefig(picture_of(case), dpi=120, metadata={"Software": None})


def _off(rows: Iterable[Row]) -> float:
    """The largest error of rows, NaN where one is."""
    offs = [abs(row.off) for row in rows]
    return math.nan if any(map(math.isnan, offs)) else max(offs)


def kept(case: Case) -> dict[str, tuple[list[Row], float]]:
    """Rows of a case by accuracy as they are stored, and the processor time of its runs [s]. Raises FileNotFoundError."""
    stored = json.loads((KEPT / f"{case.name}.json").read_text())
    return {accuracy: ([Row(**row) for row in one["rows"]], one["seconds"]) for accuracy, one in stored.items()}


def section(case: Case) -> str:
    """The part of the page about a case."""
    of = kept(case)
    table = markdown(HEAD, [cells(row) for row in of["balanced"][0]])
    parts = [f"## {case.title}", f"*{case.source}*", table, case.tolerance, case.limit]
    if (picture := picture_of(case)).exists():
        parts.append(f"![{case.title}](images/{picture.name})")
    if len(of) > 1:
        cost = [[accuracy, _percent(_off(rows)), f"{seconds:.3g} s"] for accuracy, (rows, seconds) in of.items()]
        cost += [[accuracy, "not measured", "some minutes"] for accuracy in ACCURACIES if accuracy not in of]
        parts.append(markdown(("accuracy, or program", "largest error of a row", "processor time of all its runs"), cost))
    return "\n\n".join(part for part in parts if part) + "\n"


def anchor(title: str) -> str:
    """The link to a section of the page."""
    return re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-")


def overview(all_cases: Iterable[Case]) -> str:
    """How many figures are within, and a row for each case with the figure that is nearest to, or farthest beyond, what it may be
    off."""
    table, rows = [], []
    for case in all_cases:
        of = kept(case)["balanced"][0]
        rows += of
        worst = max(of, key=lambda row: math.inf if math.isnan(row.off) else abs(row.off) / row.within)
        within = f"{sum(row.close for row in of)} of {len(of)}"
        table.append([f"[{case.title}](#{anchor(case.title)})", *cells(worst), within, case.by])
    told = f"**{sum(row.close for row in rows)} of {len(rows)} figures of {len(table)} cases are within what they may be off.**"
    head = ("case", "its figure that is farthest off for what it may be", *HEAD[1:], "figures within", "source")
    return told + "\n\n" + markdown(head, table)


def beside_peers(all_cases: Iterable[Case]) -> str:
    """A row for each case that another program has run: the largest error of each, the least one in bold, and its processor
    time."""
    rows = []
    for case in all_cases:
        of = kept(case)
        offs = {way: _off(of[way][0]) for way in ("balanced", *PEERS) if way in of}
        least = min((off for off in offs.values() if not math.isnan(off)), default=math.nan)
        told = {
            way: f"**{_percent(off)}**; {of[way][1]:.2g} s" if off == least else f"{_percent(off)}; {of[way][1]:.2g} s"
            for way, off in offs.items()
        }
        if len(told) > 1:
            rows.append([case.title, *(told.get(way, "") for way in ("balanced", *PEERS))])
    return markdown(("largest error; processor time", "here, balanced", *PEERS), rows)


def write_page() -> None:
    """docs/validation.md from what is kept."""
    replace_between(PAGE, "overview", overview(cases()))
    replace_between(PAGE, "peers", beside_peers(cases()))
    replace_between(PAGE, "cases", "\n".join(section(case) for case in cases()))


def _ways(case: Case, flags: set[str]) -> tuple[str, ...]:
    """Accuracies and peers that are asked for."""
    if "--peers" in flags:
        return (*(mujoco_runs.WAYS if case.peers else ()), *(sph_runs.WAYS if case.sph else ()))
    return ACCURACIES if "--cost" in flags else ("balanced",)


def main(words: list[str]) -> int:
    """Measure, print, and write if asked to; the exit code."""
    flags, names = {word for word in words if word.startswith("--")}, [word for word in words if not word.startswith("--")]
    known = {case.name: case for case in cases()}
    unknown = [
        *sorted(flags - {"--cost", "--quick", "--write", "--page", "--peers"}),
        *(name for name in names if name not in known),
    ]
    if unknown:
        sys.exit(f"unknown: {', '.join(unknown)}; cases: {', '.join(known)}")
    if "--page" in flags:
        write_page()
        return 0
    close = True
    for case in (known[name] for name in names) if names else known.values():
        if "--quick" in flags and not case.quick:
            continue
        for accuracy in _ways(case, flags):
            try:
                found, seconds = measured(case, accuracy)
            except NotImplementedError as lacks:
                print(f"\n{case.title}, {accuracy}: {lacks}", flush=True)
                continue
            print(
                f"\n{case.title}, {accuracy}, {seconds:.3g} s\n\n{markdown(HEAD, [cells(row) for row in found.rows])}", flush=True
            )
            if accuracy == "balanced":
                close &= all(row.close for row in found.rows)
            if "--write" in flags:
                keep(case, accuracy, found, seconds)
                if accuracy == "balanced" and found.curve:
                    draw(case, found.curve)
    if "--write" in flags:
        write_page()
    return 0 if close else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
