# SPDX-License-Identifier: GPL-2.0-only
"""Output of a study for people and programs: table, CSV, study.json, and a plot of error over seconds."""

from __future__ import annotations

import csv
import math
from pathlib import Path
from typing import TYPE_CHECKING

from ..effects.varied import varied
from ..picture.plot import own_style
from ..results.files import write_whole
from ..scene.formatting import number, say
from .analysis import Analysis, Rated, lost, off
from .error import ROUND_OFF, distance
from .setting import ALL, Setting, values
from .store import Store

if TYPE_CHECKING:
    from rich.table import Table

    from .study import Study

COLORS = {"time step": "#1f77b4", "resolution": "#d62728", **{v.name: v.color for v in varied()}, ALL: "#444444"}


def write_report(study: Study, store: Store, budget: float) -> None:
    """Write study.json, study.csv and study.png. Raises OutputError."""
    a = study.analysis
    store.write(
        {
            "scene": study.scene.name,
            "budget": budget,
            "own": a.own.key,
            "extent": a.scale,
            "doubt": _finite(a.doubt),
            "finest": a.finest.key,
            "chaotic": a.chaotic,
            "advice": study.advice,
            "left_out": study.left_out,
            "growth": a.growth and {"folding": _finite(a.growth.folding), "parted": a.growth.parted},
            "ladders": {
                name: {
                    "points": [s.key for s in a.measured[name]],
                    "errors": [_finite(e) for e in c.errors],
                    "order": c.order,
                    "used": c.used,
                    "why": c.why,
                    "until": a.until.get(name),
                }
                for name, c in a.ladders.items()
            },
            "points": {key: _figures(r) for key, r in a.rated.items()},
        }
    )
    write_whole(store.folder / "study.csv", lambda part: _write_csv(study, part))
    write_whole(store.folder / "study.png", lambda part: draw(study, part))


def _finite(x: float) -> float | None:
    return x if math.isfinite(x) else None


def _figures(r: Rated) -> dict[str, float | bool | None]:
    """Figures of a point, for study.json and study.csv."""
    return {
        "seconds": r.seconds.middle,
        "seconds_spread": r.seconds.spread,
        "error": r.error.middle,
        "error_spread": r.error.spread,
        "expect_error": r.closed,
        "energy_drift": max(r.point.drift),
        "penetration": max(r.point.penetration),
        "pareto": r.front,
    }


def _write_csv(study: Study, path: Path) -> None:
    rows = []
    for key, r in study.analysis.rated.items():
        s, p = r.point.setting, r.point
        rows.append(
            {
                "setting": key,
                "ladders": " + ".join(_where(study, r)),
                "cells": s.cells,
                "fraction": s.fraction,
                **{v.name: "auto" if value is None else value for v, value in values(s)},
                "timestep": p.timestep,
                "particles": p.particles,
                "steps": p.steps,
                "runs": len(p.seconds),
                **_figures(r),
                "pareto": int(r.front),
            }
        )
    with open(path, "w", newline="", encoding="utf-8") as file:
        out = csv.DictWriter(file, rows[0])
        out.writeheader()
        out.writerows(rows)


def _where(study: Study, r: Rated) -> list[str]:
    """Names of the ladders that a point belongs to."""
    return [name for name, settings in study.analysis.measured.items() if r.point.setting in settings]


def table(study: Study) -> Table:
    """The points, cheapest first; those on the Pareto front are marked."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    a = study.analysis
    closed = any(r.closed is not None for r in a.rated.values())
    changed = [v for v in varied() if any(getattr(r.point.setting, v.name) != v.usual for r in a.rated.values())]
    out = Table(box=SIMPLE_HEAD, pad_edge=False)
    for r in a.rated.values():
        s = r.point.setting
        cells = {
            "": "*" if r.front else "",
            "cells": f"{s.cells:g}",
            "step/bound": f"{s.fraction:.2f}" if s.fraction else "auto",
            **{v.name: v.shown(value) for v, value in values(s) if v in changed},
            "particles": f"{r.point.particles}",
            "seconds": _spread(r.seconds.middle, r.seconds.spread, len(r.point.seconds)),
            "error": off(r.error.middle, a.doubt),
            "off expect": _off(r.closed) if closed else None,
            "energy drift": number(max(r.point.drift), 2),
            "sunk in": say(max(r.point.penetration), "m") if any(v.by_depth for v in changed) else None,
            "ladder": " + ".join(_where(study, r)) + (", own" if s == a.own else ""),
        }
        shown = {name: text for name, text in cells.items() if text is not None}
        if not out.columns:
            for name in shown:
                out.add_column(name, justify="left" if name in ("", "ladder") else "right")
        out.add_row(*shown.values())
    return out


def _off(x: float | None) -> str:
    return "" if x is None else f"{number(100 * x)} %" if x > ROUND_OFF else "0"


def _spread(middle: float, spread: float, runs: int) -> str:
    told = f" ± {number(spread / 2, 1)}" if runs > 1 and spread > 1e-12 * middle else ""
    return f"{number(middle)}{told}"


def _chosen(a: Analysis, setting: Setting, shown: str) -> str:
    """Error and time of a setting that is a choice, and how far from the scene's own it moves: better known than both errors."""
    r = a.rated[setting.key]
    told = f"{shown} is {off(r.error.middle, a.doubt)} off and takes {say(r.seconds.middle, 's', 2)}"
    if setting == a.own or not a.scale:
        return told
    apart = distance(r.point.tracks[0], a.rated[a.own.key].point.tracks[0]) / a.scale
    return f"{told}, {number(100 * apart, 2)} % from the scene's own"


def order_lines(study: Study) -> list[str]:
    """One line per ladder: its order, or why it has none, or why it was left out."""
    lines = []
    a = study.analysis
    if math.isfinite(a.doubt) and a.scale:
        lines.append(f"errors are against the limit of runs up to {a.finest}, which is known to {number(100 * a.doubt, 2)} %")
    for name, c in a.ladders.items():
        own = distance(study.analysis.rated[study.analysis.own.key].point.tracks[0], c.limit) / (study.analysis.scale or 1.0)
        what = (
            f"order {c.order:.2f} from {c.used} runs and their limit"
            if c.order is not None
            else f"no order: {c.why}{lost(study.analysis, name, '; it has')}"
        )
        told = f"; the scene's own setting is {number(100 * own, 2)} % off its limit" if own else ""
        if c.doubt and c.order is None:
            told += f"; the limit is the finest run, which may be off by {number(100 * c.doubt, 2)} %"
        lines.append(f"{name}: {what}{told}")
    for name in (n for n in a.measured if n not in a.ladders):
        (choice,) = (v for v in varied() if v.name == name)
        lines.append(f"{name}: {'; '.join(_chosen(a, s, choice.shown(getattr(s, name))) for s in a.measured[name])}")
    g = study.analysis.growth
    if study.analysis.chaotic and math.isfinite(g.folding):
        lines.append(
            f"runs diverge: differences grow e-fold every {number(g.folding, 2)} s, "
            f"beyond 1 % of the motion from t = {number(g.parted)} s on"
        )
    return lines + [f"{name}: left out, {why}" for name, why in study.left_out.items()]


@own_style()
def draw(study: Study, path: Path) -> None:
    """Error over seconds, both logarithmic, a line per ladder, the Pareto front marked."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    a = study.analysis
    figure = Figure(figsize=(7.0, 4.6), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot(
        xscale="log",
        yscale="log",
        xlabel="wall time of simulation [s]",
        ylabel="error relative to the motion, with its doubt [%]",
        title=f"{study.scene.name}: what accuracy costs",
    )
    errors = {key: a.off(r) if math.isfinite(a.doubt) else 0.0 for key, r in a.rated.items()}
    least = 0.5 * min((error for error in errors.values() if error > 0.0), default=1e-12)
    place = {key: (r.seconds.middle, 100 * max(errors[key], least)) for key, r in a.rated.items()}
    for name, settings in a.measured.items():
        order = a.ladders[name].order if name in a.ladders else None
        label = name + (f" (order {order:.1f})" if order is not None else "")
        axes.plot(*zip(*(place[s.key] for s in settings)), "o-", color=COLORS[name], label=label, markersize=5)
        for s in settings:
            text = {
                "time step": f"{s.fraction:.2g}",
                "resolution": f"{s.cells:g}",
                **{v.name: v.shown(value) for v, value in values(s)},
                ALL: f"{s.cells:g}",
            }[name]
            axes.annotate(
                text,
                place[s.key],
                xytext=(5, -11 if name == "resolution" else 5),
                textcoords="offset points",
                fontsize=8,
                color=COLORS[name],
            )
    for key, r in a.rated.items():
        axes.errorbar(*place[key], xerr=r.seconds.spread / 2, yerr=50 * r.error.spread, fmt="none", ecolor="gray", zorder=0)
    front = [place[key] for key, r in a.rated.items() if r.front]
    axes.plot(*zip(*front), "o", markersize=12, markerfacecolor="none", markeredgecolor="black", label="Pareto front")
    axes.plot(*place[a.own.key], "k+", markersize=14, label="the scene's own setting")
    for axis in (axes.xaxis, axes.yaxis):  # 30 and 0.5, not powers of ten
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter(lambda value, _: f"{value:g}" if f"{value:e}"[0] in "2346" else "")
    axes.grid(True, which="both", alpha=0.25)
    axes.legend(fontsize=8)
    figure.savefig(path, dpi=130, format="png", metadata={"Software": None})
