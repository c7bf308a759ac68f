# SPDX-License-Identifier: GPL-2.0-only
"""Cost of an effect that is on and has nothing to do: ``python bench/sleeping.py [seconds]`` prints a
table in Markdown (docs/cost.md).

One live scene at a time, its particles at one place in memory: the effect's fixes are taken away and made again between short
blocks of steps, every block from the same state, in turns of with, without, without, with. A pair of neighbouring blocks gives
one ratio of processor time of this thread; printed is the median of all pairs with the 95 % interval of a bootstrap over them. It
goes on until that interval is within 0.25 % either way, ``seconds`` (60) at most for each row. The first row takes away nothing;
`*`: above 0 by more than the interval.
"""

import sys
import time

import numpy as np
import one_thread  # noqa: F401
from mdanim_lammps.engine.commands import physics
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

SCENE = """
gravity (0, 0, -9.81)
{more}
object cube {{
  shape box (18, 18, 18) cm
  position (0, 0, 50) m
  density 1000
  elasticity 1 MPa
  velocity (0, 0, -{v})
}}
{other}
control {{
  time 100 s
  resolution 1 cm
  timestep 0.05 ms
}}
effects {{ {off} }}
"""
STONE = (
    "object stone {{ shape box (18, 18, 18) cm position (0.68, 0, 50) m density 1000 elasticity 1 MPa "
    "velocity (-0.01, 0, -{v}) {drag} }}"
)
HEAP = (
    "repeat i in 0 .. 9 {{ repeat j in 0 .. 9 {{ object b[10*i + j] {{ shape box (3, 3, 3) cm "
    "position (1 + 0.3*i, 0.3*j, 50) m "
    "density 1000 elasticity 1 MPa velocity (-0.01, 0, -{v}) }} }} }}"
)
SEA = "liquid water {{ basin from (-20, -20, 0) cm to (20, 20, 40) cm density 1000 level 20 cm drag {drag} model {model} }}"
WET = "liquid off basin off"
CASES = {
    "nothing, at 3 m/s": dict(v=3),
    "contact, two boxes 0.5 m apart, at rest": dict(v=0, other=STONE.format(v=0, drag=""), off="contact off"),
    "the same at 3 m/s": dict(v=3, other=STONE.format(v=3, drag=""), off="contact off"),
    "contact, 100 boxes more, at 3 m/s": dict(v=3, other=HEAP.format(v=3), off="contact off"),
    "ground, 50 m away, at 3 m/s": dict(v=3, more="ground z 0", off="ground off"),
    "walls, 1 m away, at 3 m/s": dict(v=3, more="walls from (-1, -1, -1) to (1, 1, 100)", off="walls off"),
    "basin, 50 m away, at 3 m/s": dict(v=3, more=SEA.format(drag=0, model="surface"), off="basin off"),
    "liquid and buoyancy, 50 m away, at 3 m/s": dict(v=3, more=SEA.format(drag=0, model="surface"), off=WET),
    "the same with liquid drag": dict(v=3, more=SEA.format(drag=4, model="surface"), off=WET),
}
STEPS, WARM = 100, 5
"""Steps of a block, with two rebuilds of lists at 3 m/s; and those before its clock starts."""
HALF_WIDTH = 0.0025
"""Half the interval that is close enough."""
LEAST, DRAWS = 40, 1000
"""Pairs at least; draws of the bootstrap."""


class Toggled(Instance):
    """A scene whose effects come and go; its particles stay where they are in memory."""

    def __init__(self, with_: str, without: str):
        ready = {True: prepare(parse_scene(with_)), False: prepare(parse_scene(without))}
        super().__init__(ready[True].plan)
        self.fixes = {on: [c for c in physics(r.plan) if c.split()[0] in ("fix", "fix_modify")] for on, r in ready.items()}
        self.on = True
        self.start = [self.array(a).copy() for a in "xv"]

    def block(self, on: bool) -> float:
        """Processor seconds of a block of steps with or without the effect, from the state at the start."""
        for line in self.fixes[self.on]:
            if line.split()[0] == "fix":
                self._command(f"unfix {line.split()[1]}")
        for line in self.fixes[on]:
            self._command(line)
        self.on = on
        self.array("x")[:], self.array("v")[:] = self.start
        self.setup()
        self.run(WARM)
        start = time.thread_time()
        self.run(STEPS)
        return time.thread_time() - start


def interval(ratios: list[float], random: np.random.Generator) -> tuple[float, float, float]:
    """Median, and the ends of its 95 % interval."""
    medians = np.median(random.choice(ratios, (DRAWS, len(ratios))), axis=1)
    return float(np.median(ratios)), *np.quantile(medians, (0.025, 0.975)).tolist()


def measure(case: dict, seconds: float) -> tuple[float, float, float, float, int]:
    """Median ratio, its interval, processor seconds of a particle-step without the effect, and pairs."""
    case = {"more": "", "other": "", "off": ""} | case
    random, ratios, bare = np.random.default_rng(1), [], []
    with Toggled(SCENE.format(**case | {"off": ""}), SCENE.format(**case)) as scene:
        start = time.monotonic()
        while True:
            for first in (True, False):
                taken = {on: scene.block(on) for on in (first, not first)}
                ratios.append(taken[True] / taken[False])
                bare.append(taken[False])
            if len(ratios) >= LEAST:
                middle, low, high = interval(ratios, random)
                if max(high - middle, middle - low) < HALF_WIDTH or time.monotonic() - start > seconds:
                    return middle, low, high, float(np.median(bare)) / STEPS / scene.plan.system.particles, len(ratios)


def main(seconds: float = 60.0) -> None:
    """Measure and print."""
    print("| asleep | ns per particle-step without | adds | 95 % interval | pairs |\n|---|---|---|---|---|")
    for name, case in CASES.items():
        middle, low, high, bare, pairs = measure(case, seconds)
        sure = " *" if low > 1.0 else ""
        print(
            f"| {name} | {1e9 * bare:.1f} | {100 * (middle - 1):+.2f} %{sure} "
            f"| {100 * (low - 1):+.2f} to {100 * (high - 1):+.2f} % | {pairs} |",
            flush=True,
        )


if __name__ == "__main__":
    main(*map(float, sys.argv[1:]))
