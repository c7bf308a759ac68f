# SPDX-License-Identifier: GPL-2.0-only
"""Cost of one step against stock LAMMPS, side by side in one run: ``python bench/step.py [cells] [rounds]``.

One free cube of cells^3 cells under gravity: our styles (springs in gather form, leap-frog) and stock ones (``bond_style
harmonic``, ``fix nve``, ``newton on``) on the same particles, springs and time step, in interleaved rounds. Printed are
nanoseconds per particle-step, median and minimum, and their ratios.
"""

import statistics
import sys
import tempfile
import time
from pathlib import Path

SCENE = """
gravity (0, 0, -9.81)
object cube {{
  shape box ({n}, {n}, {n}) cm
  position (0, 0, 0)
  density 1000
  elasticity 1 MPa
}}
control {{
  time 1 s
  resolution 1 cm
}}
"""
STEPS = 100


def stock(plan, folder: Path):
    """A LAMMPS instance with stock styles on the plan's particles."""
    from mdanim_lammps.engine.commands import prelude
    from mdanim_lammps.engine.data_file import write_data
    from mdanim_lammps.engine.plugin import open_lammps

    path = folder / "data.cube"
    write_data(plan, path)
    text = path.read_text().replace("# mdanim/harmonic", "# harmonic")
    path.write_text(text)
    lmp, _ = open_lammps()
    lines = [c.replace("mdanim/harmonic", "harmonic").replace("newton off", "newton on") for c in prelude(plan)]
    lmp.commands_list([*lines, f"read_data {path} fix model NULL Model", "mass * 1.0",
                       "fix gravity all gravity 9.81 vector 0 0 -1", "fix nve all nve",
                       f"timestep {plan.certificate.timestep!r}", "run 0 post no"])
    return lmp


def main(cells: int = 29, rounds: int = 7) -> None:
    """Measure and print."""
    from mdanim_lammps.driver.prepare import prepare
    from mdanim_lammps.engine.instance import Instance
    from mdanim_lammps.scene.parse import parse_scene

    plan = prepare(parse_scene(SCENE.format(n=cells))).plan
    particles = plan.system.particles
    seconds = {"mdanim": [], "stock": []}
    with Instance(plan) as ours, tempfile.TemporaryDirectory() as folder:
        ours.setup()
        other = stock(plan, Path(folder))
        for _ in range(rounds):
            start = time.perf_counter()
            ours.run(STEPS)
            middle = time.perf_counter()
            other.command(f"run {STEPS} pre no post no")
            end = time.perf_counter()
            seconds["mdanim"].append(middle - start)
            seconds["stock"].append(end - middle)
        other.close()
    print(f"{particles} particles, {len(plan.bonds)} springs, {rounds} rounds of {STEPS} steps; ns per particle-step")
    table = {}
    for name, values in seconds.items():
        table[name] = [1e9 * f(values) / STEPS / particles for f in (statistics.median, min)]
        print(f"{name:<8} median {table[name][0]:6.1f}   minimum {table[name][1]:6.1f}")
    ratios = [s / m for s, m in zip(table["stock"], table["mdanim"])]
    print(f"stock over mdanim: {ratios[0]:.2f} by medians, {ratios[1]:.2f} by minima")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
