# SPDX-License-Identifier: GPL-2.0-only
"""XTC, whose lengths are whole numbers of a small unit within the size of molecules: the scene is scaled into it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from ..errors import OutputError
from ..scene.formatting import number
from .cut import Cut

DECIMALS = 5
"""Digits of the nanometres that XTC counts in: an ångström has 10 000 parts."""
FARTHEST = 0.99 * 10.0 * 2**31 / 10**DECIMALS
"""From the origin, and between two particles [Å]: XTC has 32 bits for these parts."""


def write(cut: Cut, folder: Path, stem: str, on_frame: Callable[[int], None]) -> list[str]:
    from ..results.universe import MDAnalysis  # which warns of nothing in notebooks

    XTCWriter = MDAnalysis.coordinates.XTC.XTCWriter

    m, start = cut.metadata, cut.position(cut.frames[0])
    # A power of ten with which neighbours are 1 to 10 angstrom apart, as atoms are.
    scale = float(10.0 ** np.ceil(-np.log10(cut.spacing)))
    note = f"1 m of the scene is {scale:g} angstrom, 1 s is 1 ps"
    universe = MDAnalysis.Universe.empty(len(m.id), n_residues=len(m.names), atom_resindex=m.object_of, trajectory=True)
    universe.add_TopologyAttr("names", np.array([f"L{kind}" for kind in range(9)], dtype=object)[cut.types])
    universe.add_TopologyAttr("resnames", np.array([name[:5] for name in m.names], dtype=object))
    universe.add_TopologyAttr("resids", cut.objects + 1)
    universe.atoms.positions = start * scale
    box = lambda x: [*np.maximum(np.ptp(x, axis=0), 1.0), 90.0, 90.0, 90.0]
    universe.dimensions = box(start * scale)
    with MDAnalysis.Writer(str(folder / f"{stem}.gro"), n_atoms=len(m.id), reindex=True) as file:
        file.write(universe.atoms)
    with XTCWriter(str(folder / f"{stem}.xtc"), n_atoms=len(m.id), precision=DECIMALS) as file:
        for done, (frame, time) in enumerate(zip(cut.frames, cut.times), 1):
            x = cut.position(frame) * scale
            if (reach := max(np.abs(x).max(initial=0.0), *np.ptp(x, axis=0))) > FARTHEST:
                # The library would leave a damaged frame, and say nothing.
                raise OutputError(
                    f"frame {frame}: a particle is {number(reach / scale, 3)} m from the origin or another one, and XTC holds no "
                    f"more than {number(FARTHEST / scale, 3)} m at this spacing; export fewer --frames, or --to xyz"
                )
            universe.atoms.positions = x
            universe.dimensions = box(x)
            universe.trajectory.ts.time, universe.trajectory.ts.frame = time, done - 1
            universe.trajectory.ts.data["step"] = int(cut.trajectory.steps[frame])
            file.write(universe.atoms)
            on_frame(done)
    _check_whole(folder / f"{stem}.xtc", len(cut.frames))
    return [note, "velocities are not in XTC; names of objects are cut after five letters, which is all that GRO has"]


def _check_whole(path: Path, frames: int) -> None:
    """Raise OSError where a file cannot be read to its end: the library takes no notice of errors when it closes a file."""
    from MDAnalysis.lib.formats.libmdaxdr import XTCFile

    with XTCFile(str(path)) as file:
        if (found := len(file)) == frames:
            file.seek(frames - 1)
            file.read()  # raises OSError where the last frame is cut short
            return
    raise OSError(f"{path.name} has {found} frames instead of {frames}")
