# SPDX-License-Identifier: GPL-2.0-only
"""Cost of accuracy: prints the tables and findings of docs/accuracy.md, as they stand there.

``python bench/accuracy.py [--budget SECONDS] [--plots FOLDER] [PART ...]`` with parts out of beam, corner, row, float,
cantilever, crowd (a study of each scene under the budget), classes (energy drift and seconds of preview, balanced, reference)
and target (2 % on the cantilever, against Timoshenko).
"""

import argparse
import math
import shutil
import sys
import tempfile
import textwrap
from dataclasses import replace
from pathlib import Path

import one_thread  # noqa: F401
from timoshenko import mean_sag

ROOT = Path(__file__).resolve().parent.parent
STUDIES = {"beam": 1.0, "corner": 0.3, "row": 1.2, "float": 6.0, "cantilever": 0.5, "crowd": 2.0}
"""Scenes that are studied, and for how many simulated seconds: their own time, or what fits the budget."""
CORNER = """
gravity (0, 0, -9.81) m/s^2
object slab {
  shape box (60, 60, 20) cm  position (0, 0, -10) cm  density 1000  elasticity 1 MPa  hold face -z
}
object cube {
  shape box (20, 20, 20) cm  position (1, 0.5, 22) cm  density 1000  elasticity 1 MPa
  orientation axis (1, 1, 0) angle 50 deg
  velocity (0, 0, -1) m/s
}
control { time 0.3 s  frames 50 fps  friction 0.5 }
"""
ROW = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
repeat i in 1 .. 5 {
  object domino[i] {
    shape box (8, 20, 40) cm  position (i*20 cm, 0 m, 20 cm)  density 500  elasticity 1 MPa  damping 0.05
  }
}
object ball {
  shape sphere 7 cm  position (-16, 0, 32) cm  density 1000  elasticity 1 MPa  velocity (2, 0, 0) m/s
}
control { time 1.2 s  resolution 4 cm  friction 0.5 }
"""
TEXTS = {"corner": CORNER, "row": ROW}
"""Scenes that are not in scenes/: a cube on its corner on a slab as soft, five dominoes."""
TITLES = {"corner": "a cube that falls on its corner", "row": "a row of five dominoes"}
BLOCKS = """
object a {{ shape box (10, 10, 10) cm  position (-8, 0, 0) cm   density 1000  elasticity 1 MPa  velocity ({v}, 0, 0) }}
object b {{ shape box (10, 10, 10) cm  position (8, 1, 0.5) cm  density 1000  elasticity 1 MPa  velocity (-{v}, 0, 0) }}
control {{ time 0.04 s  frames 1000 fps }}
"""
"""Two blocks that meet off centre, at v and -v."""
WAVE = math.sqrt(1.2 * 1e6 / 1000.0)
"""Wave speed of the blocks [m/s]."""


def load(name: str, time: float | None = None, **overrides):
    """A scene of scenes/ or of TEXTS, cut short."""
    from mdanim_lammps.scene.parse import load_scene, parse_scene

    scene = parse_scene(TEXTS[name], name) if name in TEXTS else load_scene(ROOT / "scenes" / f"{name}.txt", overrides=overrides)
    if time is None or time >= scene.control.time:
        return scene
    return replace(
        scene,
        control=replace(scene.control, time=time),
        expects=tuple(e for e in scene.expects if e.time is None or e.time <= time),
    )


def cantilever(target: float):
    """The cantilever for one period of its swing, with ``expect`` lines from Timoshenko's beam at every eighth of it."""
    from mdanim_lammps.scene.scene import Expect

    scene = load("cantilever")
    young = scene.solids[0].elasticity.modulus
    period = next(e.time for e in scene.expects if e.quantity == "position.y")
    times = [round(period * k / 8 * 480) / 480 for k in range(1, 9)]
    sags = mean_sag(times, length=1.0, thickness=0.1, young=young, density=1000.0).tolist()
    expects = tuple(Expect("bar", "position.z", 1.0 - sag, target * max(sags), t) for t, sag in zip(times, sags))
    control = replace(scene.control, time=times[-1], frames=480.0)
    return replace(scene, expects=expects, control=control, path=None)


LADDER_OF = {"sweeps": "sweeps", "contact": "contact", "sunk in": "contact"}
"""Columns that say something only where a ladder was measured."""


def study(name: str, budget: float, plots: Path | None) -> None:
    """Print the study of a scene."""
    from mdanim_lammps.scene.formatting import say
    from mdanim_lammps.study.analysis import off
    from mdanim_lammps.study.error import ROUND_OFF
    from mdanim_lammps.study.report import order_lines
    from mdanim_lammps.study.study import run_study

    with tempfile.TemporaryDirectory() as folder:
        found = run_study(load(name, STUDIES[name]), Path(folder) / "study", budget=budget, on_progress=told)
        if plots:
            shutil.copy(found.folder / "study.png", plots / f"study-{name}.png")
    a = found.analysis
    print(f"\n### {TITLES.get(name, f'{name}.txt')}, {found.scene.control.time:g} s\n")
    if plots:
        print(f"![{name}: error over seconds]({plots.name}/study-{name}.png)\n")
    rows = []
    for r in a.rated.values():
        s, p = r.point.setting, r.point
        where = [n for n, settings in a.measured.items() if s in settings] + (["own"] if s == a.own else [])
        closed = "" if r.closed is None else f"{100 * r.closed:.2g} %" if r.closed > ROUND_OFF else "0"
        rows.append(
            {
                "": "*" if r.front else "",
                "cells": f"{s.cells:g}",
                "step / bound": f"{s.fraction:.2f}",
                "sweeps": "auto" if s.sweeps is None else f"{s.sweeps}",
                "contact": f"{s.contact:g}",
                "particles": f"{p.particles}",
                "seconds": f"{r.seconds.middle:.3g}" + (f" ± {r.seconds.spread / 2:.1g}" if len(p.seconds) > 1 else ""),
                "error": off(r.error.middle, a.doubt),
                "off expect": closed,
                "energy drift": f"{max(p.drift):.0e}",
                "sunk in": say(max(p.penetration), "m"),
                "ladder": ", ".join(where),
            }
        )
    columns = [c for c in rows[0] if LADDER_OF.get(c, "time step") in a.measured]
    print(f"| {' | '.join(columns)} |\n" + "|---" * len(columns) + "|")
    for row in rows:
        print(f"| {' | '.join(row[c] for c in columns)} |")
    print()
    for line in order_lines(found):
        print(wrapped(f"- {line}", "  "))
    print("\n" + wrapped(f"> {found.advice}", "> "), flush=True)


def closed_scenes():
    """Scenes that lose no energy, for the classes: name and record."""
    from mdanim_lammps.scene.parse import parse_scene

    for speed in (0.2, 0.5):
        yield f"two blocks at {speed:g} c", parse_scene(BLOCKS.format(v=speed * WAVE / 2.0), "blocks")
    for name, time in (("spin", None), ("cantilever", None), ("beam", 1.0), ("crowd", 0.4)):
        yield f"{name}.txt", load(name, time)


def classes() -> None:
    """Print energy drift and seconds of the three classes."""
    from mdanim_lammps.errors import DivergedError
    from mdanim_lammps.scene.scene import Accuracy
    from mdanim_lammps.study.measure import measure
    from mdanim_lammps.study.setting import Setting

    print("\n| scene | " + " | ".join(f"{a.value}: drift | seconds" for a in Accuracy) + " |\n" + "|---" * 7 + "|")
    for name, scene in closed_scenes():
        cells = []
        for accuracy in Accuracy:
            told(f"{name}, {accuracy.value}")
            with tempfile.TemporaryDirectory() as folder:
                try:
                    s = measure(replace(scene, expects=()), Setting(accuracy.cells, accuracy.fraction), Path(folder))
                    cells += [f"{s.drift:.1e}", f"{s.seconds:.2g}"]
                except DivergedError as error:
                    cells += [f"stopped: {str(error).split(';')[0]}", ""]
        print(f"| {name} | {' | '.join(cells)} |", flush=True)


STEPS = (0.9, 0.7)
"""Time steps over the bound of the full ladder, the longest there are: shorter ones only cost more,
their error is that of the cells."""


def full_ladder(scene, store, choice) -> None:
    """Measure every whole number of cells from 2 on at the longest steps, all that takes less work than the chosen setting."""
    from mdanim_lammps.study.measure import measure
    from mdanim_lammps.study.setting import Setting

    most = store.points[Setting(choice.cells, choice.fraction).key].work
    for fraction in STEPS:
        for cells in range(2, 100):
            setting = Setting(cells, fraction)
            told(f"full ladder: {setting}")
            point = store.points.get(setting.key) or store.add(measure(scene, setting, store.folder))
            if point.work > most:
                break


def target(percent: float = 2.0, budget: float = 600.0):
    """Find the setting for a target error, and print it beside everything cheaper that could have been taken."""
    from mdanim_lammps.study.setting import scene_hash
    from mdanim_lammps.study.store import Store
    from mdanim_lammps.study.target import find_choice

    scene = cantilever(percent / 100.0)
    with tempfile.TemporaryDirectory() as folder:
        choice = find_choice(scene, percent / 100.0, budget=budget, folder=Path(folder), on_progress=told)
        store = Store(Path(folder), scene_hash(scene))
        found = set(store.points)
        full_ladder(scene, store, choice)
        points = list(store.points.values())
    swing = max(1.0 - e.value for e in scene.expects)
    rows = [(p, max(abs(f - e.value) for f, e in zip(p.found[0], scene.expects)) / swing) for p in points if p.tracks]
    best = min((p for p, off in rows if off <= percent / 100.0), key=lambda p: p.work)
    print("\n| cells | step / bound | particle-steps | seconds | against Timoshenko | |\n|---|---|---|---|---|---|")
    for p, off in sorted(rows, key=lambda row: row[0].work):
        chosen = (p.setting.cells, p.setting.fraction) == (choice.cells, choice.fraction)
        mark = ["chosen"] if chosen else ["looked at"] if p.setting.key in found else []
        print(
            f"| {p.setting.cells:g} | {p.setting.fraction:.2f} | {p.work:.2e} | {min(p.seconds):.3g} | {100 * off:.3g} % | "
            f"{', '.join(mark + (['best'] if p is best else []))} |"
        )
    print(f"\n> target {percent:g} %: {choice}; {choice.words}", flush=True)
    return choice, rows


def wrapped(text: str, indent: str) -> str:
    """In lines as they stand in docs/."""
    return textwrap.fill(text, 120, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False)


def told(line: str) -> None:
    """Progress, apart from the tables."""
    print(line, file=sys.stderr, flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("parts", nargs="*", default=[*STUDIES, "classes", "target"])
    parser.add_argument("--budget", type=float, default=120.0)
    parser.add_argument("--plots", type=Path)
    options = parser.parse_args()
    for part in options.parts:
        if part in STUDIES:
            study(part, options.budget, options.plots)
        else:
            {"classes": classes, "target": target}[part]()
