# SPDX-License-Identifier: GPL-2.0-only
"""Cost of each effect where it acts, alone beside the springs: ``python bench/alone.py [rounds]``.

One cube of 19^3 particles per variant, all at the same time step; contact stands in bench/pressed.py, effects that have nothing
to do in bench/sleeping.py, all of a scene one by one in bench/effects.py.
"""

import sys

from effects import Runner
from timing import Sample, interleaved, markdown

SCENE = """
{more}
object cube {{
  shape box (18, 18, 18) cm
  position (0, 0, {z}) cm
  density 500
  elasticity 1 MPa
  {own}
}}
control {{
  time 100 s
  resolution 1 cm
  timestep 0.05 ms
}}
"""
SEA = (
    "gravity (0, 0, -9.81)\nliquid water {{ basin from (-20, -20, 0) cm to (20, 20, 40) cm density 1000 level 20 cm "
    "drag {drag} model {model} }}"
)
VARIANTS = {
    "springs": {},
    "+ gravity": dict(more="gravity (0, 0, -9.81)"),
    "+ damping": dict(own="damping 0.1"),
    "+ air drag": dict(own="drag 1"),
    "+ gravity, ground": dict(more="gravity (0, 0, -9.81)\nground z 0", z=9),
    "+ gravity, walls": dict(more="gravity (0, 0, -9.81)\nwalls from (-9, -9, 0) cm to (9, 9, 100) cm", z=9),
    "+ gravity, liquid, buoyancy": dict(more=SEA.format(drag=0, model="surface"), z=20),
    "the same with liquid drag": dict(more=SEA.format(drag=4, model="surface"), z=20),
}


def measure(rounds: int = 15, quick: bool = False) -> list[dict]:
    """One row for each variant, in processor time."""
    runners = {name: Runner(SCENE.format(**{"more": "", "own": "", "z": 500} | v)) for name, v in VARIANTS.items()}
    try:
        found = interleaved({name: lambda r=r: r.round()["step"] / r.particles for name, r in runners.items()}, rounds)
    finally:
        for r in runners.values():
            r.instance.close()
    first: Sample = found["springs"]
    return [
        {"effect": name, "median": 1e9 * s.median, "least": 1e9 * s.least, "over": s.over(first)} for name, s in found.items()
    ]


def table(rows: list[dict]) -> str:
    """In Markdown."""
    return markdown(
        ["effect", "ns per particle-step, median", "minimum", "over springs alone, medians", "minima"],
        [(r["effect"], r["median"], r["least"], r["over"]["medians"], r["over"]["minima"]) for r in rows],
    )


if __name__ == "__main__":
    print(table(measure(*map(int, sys.argv[1:]))))
