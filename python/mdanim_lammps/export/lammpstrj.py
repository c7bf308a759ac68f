# SPDX-License-Identifier: GPL-2.0-only
"""A LAMMPS dump as ``in.NAME`` asks ``lmp`` for: the same lines, digit for digit; the box is that of the particles."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from ..engine.data_file import rows
from ..results.dump import COLUMNS
from .cut import Cut


def write(cut: Cut, folder: Path, stem: str, on_frame: Callable[[int], None]) -> list[str]:
    m = cut.metadata
    molecule = cut.objects[m.object_of] + 1
    steps = cut.trajectory.steps[cut.frames]
    with open(folder / f"{stem}.lammpstrj", "w", encoding="ascii") as file:
        for done, (frame, step) in enumerate(zip(cut.frames, steps), 1):
            x, v = cut.position(frame), cut.velocity(frame)
            file.write(f"ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n{len(x)}\nITEM: BOX BOUNDS ss ss ss\n")
            file.writelines(f"{low:.16e} {high:.16e}\n" for low, high in zip(x.min(axis=0), x.max(axis=0)))
            file.write(f"ITEM: ATOMS {COLUMNS}\n")
            file.writelines(rows("%d %d %d" + " %.17g" * 6 + "\n", m.id, molecule, cut.types, *x.T, *v.T))
            on_frame(done)
    return [f"time is counted in steps of {cut.trajectory.dt!r} s"]
