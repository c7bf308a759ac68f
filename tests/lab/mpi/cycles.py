# SPDX-License-Identifier: GPL-2.0-only
"""Make and close instances one after the other, and print what each leaves behind: ``python cycles.py SCENE COUNT``.

A process of its own, for in one that has done other things memory comes and goes.
"""

import os
import sys
from pathlib import Path

from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.engine.state import State
from mdanim_lammps.engine.sub_plan import SubPlans
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import load_scene

WARM = 450
"""Instances after which LAMMPS and MPI have filled their own stores."""


def residue() -> tuple[int, int]:
    """Resident memory [bytes] and open files of this process."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE"), len(os.listdir("/proc/self/fd"))


def main(scene: str, count: int) -> None:
    """SubPlans of one and of two objects, in turn, are given a state and run."""
    parts = SubPlans(prepare(load_scene(Path(scene))).plan)
    with Instance(parts.whole) as instance:
        instance.setup()
        whole = instance.state()
    first = parts.whole.system.first

    def go(cycles: int) -> None:
        for k in range(cycles):
            a, b = ((1, 1), (2, 2), (1, 2))[k % 3]
            rows = slice(first[a], first[b + 1])
            with Instance(parts.part(range(a, b + 1), False)) as instance:
                instance.put(0, State(whole.x[rows], whole.v[rows], whole.f[rows]))
                instance.run(2)

    go(WARM)
    before = residue()
    go(count)
    after = residue()
    print((after[0] - before[0]) / count, after[1] - before[1])


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
