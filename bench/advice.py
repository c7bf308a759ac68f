# SPDX-License-Identifier: GPL-2.0-only
"""Whether the advice of studies holds: each scene once more, finer in everything than any run of its study.

``python bench/advice.py [--budget SECONDS] [SCENE ...]`` prints, for ten small scenes, the errors that a study tells and those
against the finer run, and every piece of advice that this refutes.
"""

import argparse
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import one_thread  # noqa: F401

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


@dataclass(frozen=True)
class Checked:
    """A study beside a run that is finer in everything."""

    name: str
    advice: str
    doubt: float
    """How well the study says that it knows its errors, a fraction."""
    errors: dict[str, tuple[float, float]]
    """By setting: the error that the study tells, and that against the finer run, fractions."""
    refuted: list[str]
    """What the finer run contradicts by more than the study's doubt."""


def check(name: str, *, budget: float = 300.0, only: tuple[str, ...] = ()) -> Checked:
    """Study a scene, then run it finer in everything, and compare."""
    from mdanim_lammps.scene.parse import parse_scene
    from mdanim_lammps.study.analysis import as_good, better, worse
    from mdanim_lammps.study.error import distance
    from mdanim_lammps.study.measure import measure
    from mdanim_lammps.study.setting import finer
    from mdanim_lammps.study.study import run_study

    scene = parse_scene(SCENES[name], name.replace(" ", "-"))
    with tempfile.TemporaryDirectory() as folder:
        study = run_study(scene, Path(folder) / "study", budget=budget, only=only)
        a = study.analysis
        truth = measure(scene, finer(a.own, FINER * a.own.cells), Path(folder)).center
    found = {str(r.point.setting): (r.error.middle, distance(r.point.tracks[0], truth) / a.scale) for r in a.rated.values()}

    def off(setting) -> float:
        return found[str(setting)][1]

    def refuted() -> Iterator[str]:
        yield from (f"{s} is {real:.2%} off, not {told:.2%}" for s, (told, real) in found.items() if abs(real - told) > a.doubt)
        if (r := as_good(a)) and off(r.point.setting) > off(a.own) + a.doubt:
            yield f"{r.point.setting} is not as good"
        if (r := better(a)) and off(r.point.setting) > off(a.own):
            yield f"{r.point.setting} is not better"
        if (s := worse(a)) and off(s) < off(a.own):
            yield f"{s} is not worse"

    return Checked(name, study.advice, a.doubt, found, list(refuted()))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", default=list(SCENES))
    parser.add_argument("--budget", type=float, default=300.0)
    options = parser.parse_args()
    wrong = 0
    for scene in options.scenes:
        c = check(scene, budget=options.budget)
        print(f"\n{c.name}: errors are told to {c.doubt:.2%}\n  {c.advice}")
        for setting, (told, real) in c.errors.items():
            print(f"    {setting:60} {told:7.2%} told {real:7.2%} against the finer run")
        for line in c.refuted:
            print(f"  REFUTED: {line}")
        wrong += len(c.refuted)
        sys.stdout.flush()
    sys.exit(wrong > 0)
