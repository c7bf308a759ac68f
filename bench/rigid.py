# SPDX-License-Identifier: GPL-2.0-only
"""Rigid bodies of fix mdanim/rigid beside those of LAMMPS: ``python bench/rigid.py [TABLE ...]``, all of TABLES without a word.

The tables are those of docs/fix_mdanim_rigid.md.
"""

import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from timing import print_tables

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "lab"))
import plugin_lab as lab

STYLES = ("mdanim/rigid", "rigid molecule", "rigid/nve molecule")
TURN = 600
"""Time steps of a turn."""
SIDE = 21
"""Particles along the side of the body that is timed."""


def instance(body: lab.Body, *commands: str):
    """A LAMMPS instance with a body."""
    with tempfile.TemporaryDirectory() as folder:
        return lab.load(body, Path(folder), [*commands, "run 0"])


def spinning() -> lab.Body:
    """Six particles with moments 1, 2, 3, which turn nearly about the middle axis at 1 rad per unit of time."""
    x = np.repeat(np.diag(np.sqrt([1.0, 0.5, 0.0])), 2, axis=0) * np.tile([[1.0], [-1.0]], (3, 1))
    return lab.particles(x, np.ones(6, int), v=np.cross((1e-3, 1.0, 1e-3), x))


def free() -> tuple[list[str], list[list]]:
    """A free body for 500 turns: the largest error of energy, the one at the end, that of angular momentum."""
    body, rows = spinning(), []

    def angular(x: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.cross(x, body.mass[:, None] * v).sum(0)

    for style in STYLES:
        lmp = instance(body, f"fix r all {style}", f"timestep {2.0 * np.pi / TURN!r}")
        energies, momenta = [], []
        for _ in range(100):
            lmp.command(f"run {5 * TURN} pre no post no")
            x, v = lab.by_tag(lmp, "x"), lab.by_tag(lmp, "v")
            energies.append(lab.kinetic(body, v) / lab.kinetic(body, body.v) - 1.0)
            momenta.append(np.abs(angular(x, v) - angular(body.x, body.v)).max())
        lmp.close()
        rows.append([f"fix {style}", f"{np.abs(energies).max():.1e}", f"{energies[-1]:.1e}", f"{max(momenta):.1e}"])
    return ["", "largest error of energy", "after 500 turns", "of angular momentum"], rows


def cost() -> tuple[list[str], list[list]]:
    """Processor time of a step of one body under gravity, a particle; the least of seven rounds, styles in turns."""
    n = np.arange(SIDE)
    body = lab.particles(np.stack(np.meshgrid(n, n, n), -1).reshape(-1, 3), np.ones(SIDE**3, int))
    running = [instance(body, f"fix r all {s}", "fix g all mdanim/gravity 0 0 -1e-3", "timestep 1e-3") for s in STYLES]
    least = np.full(len(STYLES), np.inf)
    for _ in range(7):
        for k, lmp in enumerate(running):
            start = time.process_time()
            lmp.command("run 100 pre no post no")
            least[k] = min(least[k], (time.process_time() - start) / 100 / len(body.x))
    for lmp in running:
        lmp.close()
    return ["", "ns a particle-step"], [[f"fix {s}", f"{1e9 * t:.1f}"] for s, t in zip(STYLES, least)]


TABLES = {"free": free, "cost": cost}

if __name__ == "__main__":
    print_tables(TABLES, sys.argv[1:])
