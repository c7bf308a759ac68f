# SPDX-License-Identifier: GPL-2.0-only
"""What an effect costs that is on and has nothing to do: ``python bench/sleeping.py [rounds]``.

Two free cubes of 20^3 cells, far from everything, with one effect at a time, against the same cubes without it, in interleaved
rounds. Printed are medians of the ratios within a round, and the ratio of minima; the first row, the bare cubes once more, is the noise.
"""

import statistics
import sys
import time

SCENE = """
gravity (0, 0, -0.001)
object a {{ shape box (20, 20, 20) cm position (0, 0, 0) m density 1000 elasticity 1 MPa }}
object b {{ shape box (20, 20, 20) cm position (0.5, 0, 0) m velocity ({speed}, 0, 0) density 1000 elasticity 1 MPa }}
{more}
control {{ time 1 s resolution 1 cm timestep 0.05 ms }}
"""
POOL = "liquid water { basin from (-0.5, -0.5, -1.2) m to (0.7, 0.5, -0.4) m density 1000 level -0.9 m }\n"
BARE = "effects { contact off }"
CASES = {
    "bare": (0, BARE),
    "bare again": (0, BARE),
    "ground": (0, "ground z -2 m\n" + BARE),
    "walls": (0, "walls from (-3, -3, -3) m to (3, 3, 3) m\n" + BARE),
    "basin": (0, POOL + "effects { contact off liquid off }"),
    "liquid": (0, POOL + BARE),
    "bare, flying": (-0.5, BARE),
    "contact, flying": (-0.5, ""),
}
AGAINST = {"contact, flying": "bare, flying"}
STEPS = 40


def main(rounds: int = 25) -> None:
    """Measure and print."""
    from mdanim_lammps.driver.prepare import prepare
    from mdanim_lammps.engine.instance import Instance
    from mdanim_lammps.scene.parse import parse_scene

    instances = {}
    for name, (speed, more) in CASES.items():
        instances[name] = Instance(prepare(parse_scene(SCENE.format(speed=speed, more=more))).plan)
        instances[name].setup()
        instances[name].run(STEPS)
    seconds = {name: [] for name in CASES}
    for n in range(rounds):
        for name in list(CASES) if n % 2 else reversed(CASES):
            start = time.perf_counter()
            instances[name].run(STEPS)
            seconds[name].append(time.perf_counter() - start)
    particles = instances["bare"].plan.system.particles
    for name, own in seconds.items():
        bare = seconds[AGAINST.get(name, "bare")]
        ratio = statistics.median(a / b for a, b in zip(own, bare))
        print(f"{name:<16} {1e9 * min(own) / STEPS / particles:6.1f} ns per particle-step   over bare: {ratio:.3f} by medians, "
              f"{min(own) / min(bare):.3f} by minima")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
