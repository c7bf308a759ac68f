# SPDX-License-Identifier: GPL-2.0-only
"""Extended XYZ: a line of names and values, then a line for each particle."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from ..engine.data_file import rows
from .cut import Cut

COLUMNS = "species:S:1:pos:R:3:velo:R:3:masses:R:1:molid:I:1:type:I:1"


def write(cut: Cut, folder: Path, stem: str, on_frame: Callable[[int], None]) -> list[str]:
    m = cut.metadata
    molecule = cut.objects[m.object_of] + 1
    species = np.full(len(m.id), "X")  # no chemical element
    with open(folder / f"{stem}.xyz", "w", encoding="utf-8") as file:
        for done, (frame, time) in enumerate(zip(cut.frames, cut.times), 1):
            x, v = cut.position(frame), cut.velocity(frame)
            low, size = x.min(axis=0), np.ptp(x, axis=0)
            box = " ".join(f"{number!r}" for number in np.diag(size).ravel().tolist())
            origin = " ".join(f"{number!r}" for number in low.tolist())
            file.write(
                f'{len(x)}\nLattice="{box}" Origin="{origin}" pbc="F F F" Properties={COLUMNS} Time={float(time)!r} '
                f"frame={frame} length_unit=m time_unit=s mass_unit=kg\n"
            )
            file.writelines(rows("%s" + " %.17g" * 7 + " %d %d\n", species, *x.T, *v.T, m.mass, molecule, cut.types))
            on_frame(done)
    return ["lengths are metres, velocities m/s, masses kg, times s; molid counts the objects from 1"]
