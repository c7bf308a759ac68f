# SPDX-License-Identifier: GPL-2.0-only
"""Whether the advice of studies holds: each scene once more, finer in everything than any run of its study.

``python bench/advice.py [--budget SECONDS] [--runs N] [SCENE ...]`` prints, for ten small scenes, a table (docs/accuracy.md):
errors that a study tells and those against the finer run, of the whole study and as if the budget had left out its finest runs.
Below are the advice and what the finer run refutes.
"""

import argparse
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import one_thread  # noqa: F401
from mdanim_lammps.scene.parse import parse_scene
from mdanim_lammps.study import bench
from mdanim_lammps.study.analysis import FIRST, Analysis, advice, analyse, as_good, better, off, worse
from mdanim_lammps.study.error import distance
from mdanim_lammps.study.measure import measure
from mdanim_lammps.study.setting import Setting, finer
from mdanim_lammps.study.study import run_study

FALL = "gravity (0, 0, -9.81) m/s^2\nground z 0 m\n"
SOFT = "density 1000 kg/m^3  elasticity 1 MPa"
SCENES = {
    "a bounce": FALL
    + f"""
object cube {{ shape box (10, 10, 10) cm  position (0, 0, 10) cm  {SOFT}  velocity (0.5, 0, -1) m/s  damping 0.1 }}
control {{ time 0.3 s  frames 50 fps  friction 0.3 }}
""",
    "thrown against a block": FALL
    + """
object block { shape box (10, 20, 30) cm  position (20, 0, 15) cm  density 1000 kg/m^3  elasticity 2 MPa  damping 0.1 }
object cube {
  shape box (10, 10, 10) cm  position (-10, 2, 18) cm  density 1000 kg/m^3  elasticity 2 MPa  damping 0.1
  velocity (2, 0, 0.5) m/s
}
control { time 0.4 s  frames 50 fps  friction 0.4 }
""",
    "on a corner": f"""
gravity (0, 0, -9.81) m/s^2
object slab {{ shape box (40, 40, 20) cm  position (0, 0, -10) cm  {SOFT}  hold face -z }}
object cube {{
  shape box (20, 20, 20) cm  position (1, 0.5, 20) cm  {SOFT}
  orientation axis (1, 1, 0) angle 50 deg  velocity (0, 0, -1) m/s
}}
control {{ time 0.3 s  frames 50 fps  friction 0.5 }}
""",
    "a ball that rolls": FALL
    + f"""
object ball {{ shape sphere 6 cm  position (0, 0, 10) cm  {SOFT}  velocity (1, 0, 0) m/s  damping 0.1 }}
control {{ time 0.5 s  frames 50 fps  friction 0.5 }}
""",
    "two blocks": f"""
object a {{ shape box (10, 10, 10) cm  position (-8, 0, 0) cm  {SOFT}  velocity (1, 0, 0) m/s }}
object b {{ shape box (10, 10, 10) cm  position (8, 1, 0.5) cm  {SOFT}  velocity (-1, 0, 0) m/s }}
control {{ time 0.15 s  frames 100 fps }}
""",
    "a bar that bends": f"""
gravity (0, 0, -9.81) m/s^2
object bar {{ shape box (80, 10, 10) cm  position (40, 0, 0) cm  {SOFT}  hold face -x }}
control {{ time 0.4 s  frames 50 fps }}
""",
    "dominoes": FALL
    + f"""
object one {{ shape box (8, 12, 30) cm  position (0, 0, 15) cm   density 500 kg/m^3  elasticity 1 MPa  damping 0.05 }}
object two {{ shape box (8, 12, 30) cm  position (18, 0, 15) cm  density 500 kg/m^3  elasticity 1 MPa  damping 0.05 }}
object ball {{ shape sphere 6 cm  position (-14, 0, 26) cm  {SOFT}  velocity (2, 0, 0) m/s }}
control {{ time 0.5 s  frames 50 fps  friction 0.5  accuracy preview }}
""",
    "a slide": FALL
    + f"""
object cube {{ shape box (12, 10, 8) cm  position (0, 0, 4) cm  {SOFT}  velocity (1.5, 0, 0) m/s  damping 0.1 }}
control {{ time 0.5 s  frames 50 fps  friction 0.4 }}
""",
    "two balls": f"""
object a {{ shape sphere 6 cm  position (-8, 0, 0) cm  {SOFT}  velocity (1.5, 0, 0) m/s }}
object b {{ shape sphere 6 cm  position (6, 4, 0) cm   {SOFT} }}
control {{ time 0.2 s  frames 100 fps  friction 0.3 }}
""",
    "into water": """
gravity (0, 0, -9.81) m/s^2
liquid water { basin from (0, 0, 0) to (60, 60, 40) cm  level 25 cm  density 1000 kg/m^3 }
object cube { shape box (16, 16, 16) cm  position (30, 30, 34) cm  density 500 kg/m^3  elasticity 1 MPa }
control { time 0.5 s  frames 50 fps }
""",
}
FINER = 3.0
"""Cells of the check over the scene's own; the finest of a study has twice as many."""


FEWEST = 3
"""Runs of a ladder that is cut short."""


@dataclass(frozen=True)
class Told:
    """The results of a study, or of one that was cut short, beside a run that is finer in everything."""

    finest: Setting
    """Setting of the runs that the study's limit comes from."""
    order: float | None
    doubt: float
    """How well the study says that it knows its errors, a fraction."""
    own: tuple[float, float]
    """Error of the scene's own setting that the study tells, and that against the finer run, fractions."""
    misses: float
    """Largest difference of these two, of all settings, a fraction."""
    advice: str
    refuted: tuple[str, ...]
    """Values that the finer run contradicts by more than the study's doubt."""


def check(name: str, *, budget: float = 300.0, only: tuple[str, ...] = ()) -> list[Told]:
    """Study a scene, then run it finer in everything, and compare; the whole study first, then with fewer and fewer fine runs."""
    scene = parse_scene(SCENES[name], name.replace(" ", "-"))
    with tempfile.TemporaryDirectory() as folder:
        study = run_study(scene, Path(folder) / "study", budget=budget, only=only)
        own = study.analysis.own
        truth = measure(scene, finer(own, FINER * own.cells), Path(folder))
    cells = [s.cells for s in next(study.analysis.measured[name] for name in FIRST if name in study.analysis.measured)]
    told = []
    for most in reversed(cells[FEWEST - 1 :]):
        points = {key: p for key, p in study.points.items() if p.setting.cells <= most}
        if own.key in points:
            names, touching = [s.name for s in scene.solids], study.analysis.touching
            a = analyse(points, study.ladders, own, truth.times, scene.expects, names, touching=touching)
            told.append(_compare(a, truth.center))
    return told


def _compare(a: Analysis, truth: np.ndarray) -> Told:
    found = {str(r.point.setting): (r.error.middle, distance(r.point.tracks[0], truth) / a.scale) for r in a.rated.values()}

    def real(setting) -> float:
        return found[str(setting)][1]

    def refuted() -> Iterator[str]:
        yield from (f"{s} is {r:.2%} off, not {told:.2%}" for s, (told, r) in found.items() if abs(r - told) > a.doubt)
        if (r := as_good(a)) and real(r.point.setting) > real(a.own) + a.doubt:
            yield f"{r.point.setting} is not as good"
        if (r := better(a)) and real(r.point.setting) > real(a.own):
            yield f"{r.point.setting} is not better"
        if (s := worse(a)) and real(s) < real(a.own):
            yield f"{s} is not worse"

    order = next(c.order for name in FIRST if (c := a.ladders.get(name)))
    misses = max(abs(r - told) for told, r in found.values())
    return Told(a.finest, order, a.doubt, found[str(a.own)], misses, advice(a), tuple(refuted()))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", default=list(SCENES))
    parser.add_argument("--budget", type=float, default=300.0)
    parser.add_argument("--runs", type=int, default=1, help="of each point: more of them tell the spread of seconds alone")
    options = parser.parse_args()
    bench.REPEATS = options.runs
    lines, wrong = [], 0
    print("| scene | study up to | order | own setting, estimated | against the finer run | all settings differ by up to | ± |")
    print("|---|---|---|---|---|---|---|")
    for scene in options.scenes:
        for k, t in enumerate(check(scene, budget=options.budget)):
            (error, real), order = t.own, f"{t.order:.1f}" if t.order else "none"
            print(
                f"| {'' if k else scene} | {t.finest.cells:g} cells | {order} | {off(error, t.doubt)} | "
                f"{100 * real:.2g} % | {100 * t.misses:.2g} % | {100 * t.doubt:.2g} %{', REFUTED' if t.refuted else ''} |"
            )
            lines += [] if k else [f"{scene}: {t.advice}"]
            lines += [f"REFUTED, with runs up to {t.finest.cells:g} cells: {line}" for line in t.refuted]
            wrong += len(t.refuted)
        sys.stdout.flush()
    print("\n" + "\n".join(f"- {line}" for line in lines))
    sys.exit(wrong > 0)
