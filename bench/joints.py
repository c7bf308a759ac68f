# SPDX-License-Identifier: GPL-2.0-only
"""Joints of fix mdanim/joint: ``python bench/joints.py [TABLE ...]``, all of TABLES without a word.

The tables are those of docs/fix_mdanim_joint.md.
"""

import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from timing import print_tables

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "lab"))
import joint_lab
import plugin_lab as lab
import rigid_lab

SIDE = 100
"""Bodies along the side of a snake of SIDE² of them, each joined with the next."""
STEPS = 50
KINDS = {
    "ball": "ball {a} {b} at {x} {y} 0 frequency 1000",
    "spring": "spring {a} {b} from {x} {y} 0 to {x} {y} 0.1 stiffness 10 damping 0.1",
    "hinge": "hinge {a} {b} at {x} {y} 0 axis 0 1 0 frequency 1000",
    "hinge with a motor, friction, stops and dashpots": "hinge {a} {b} at {x} {y} 0 axis 0 1 0 frequency 1000 damping 1 "
    "motor 1 0.01 friction 0.01 limits -1 1",
    "slider with dashpots": "slider {a} {b} at {x} {y} 0 axis 0 1 0 frequency 1000 damping 1",
    "weld with dashpots": "weld {a} {b} at {x} {y} 0 frequency 1000 damping 1",
}


def snake() -> tuple[lab.Body, np.ndarray]:
    """Bodies of eight particles each, and their centres."""
    n = np.arange(SIDE * SIDE)
    along = n % SIDE
    centre = np.c_[np.where(n // SIDE % 2, SIDE - 1 - along, along), n // SIDE, 0 * n].astype(float)
    x = (centre[:, None] + 0.2 * rigid_lab.SIGNS).reshape(-1, 3)
    return lab.particles(x, np.repeat(n + 1, 8), mass=np.full(len(x), 0.125)), centre


def cost() -> tuple[list[str], list[list]]:
    """Processor time of a joint in a step: that of the process, by the share that the fix has of its wall time."""
    body, centre = snake()
    place, rows = 0.5 * (centre[1:] + centre[:-1]), []
    for kind, form in KINDS.items():
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "joints"
            file.write_text("".join(form.format(a=n + 1, b=n + 2, x=p[0], y=p[1]) + "\n" for n, p in enumerate(place)))
            commands = ["fix r all mdanim/rigid", f"fix j all mdanim/joint joints {file}", "timestep 1e-4", "run 0"]
            lmp = lab.load(body, Path(folder), commands, cutoff=2.0)
        best = np.inf
        for _ in range(5):
            told, wall, own = lmp.extract_fix("j", 0, 1, joint_lab.OUTPUTS.index("seconds")), time.time(), time.process_time()
            lmp.command(f"run {STEPS} pre no post no")
            told = lmp.extract_fix("j", 0, 1, joint_lab.OUTPUTS.index("seconds")) - told
            best = min(best, told / (time.time() - wall) * (time.process_time() - own))
        lmp.close()
        rows.append([kind, f"{best / STEPS / len(place) * 1e6:.2f}"])
    return ["", "processor time of a joint in a step [us]"], rows


TABLES = {"cost": cost}

if __name__ == "__main__":
    print_tables(TABLES, sys.argv[1:])
