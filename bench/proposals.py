# SPDX-License-Identifier: GPL-2.0-only
"""Objects that may as well be rigid: ``python bench/proposals.py [SCENE ...]`` prints the tables of docs/physics-rigid.md.

Names of scenes without .txt; without one all scenes in which something elastic is free, ten minutes. Times are processor seconds.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import one_thread  # noqa: F401
from mdanim_lammps.cost.forecast import forecast
from mdanim_lammps.effects.envelope import Envelope
from mdanim_lammps.errors import MdanimError
from mdanim_lammps.features.rigid import proposal
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.run.loop import simulate
from mdanim_lammps.run.prepare import Prepared, prepare
from mdanim_lammps.scene.formatting import number
from mdanim_lammps.scene.parse import load_scene

SCENES = Path(__file__).resolve().parent.parent / "scenes"
FRAGMENTS = {"rubber"}
"""Files that scenes include, no scenes themselves."""


def timed(ready: Prepared, folder: Path) -> float:
    """Processor seconds of a run, without modelling."""
    folder.mkdir()
    began = time.process_time()
    simulate(ready, folder)
    return time.process_time() - began


def expected(ready: Prepared) -> float | None:
    """The same by the forecast of `check`."""
    cost = forecast(ready, movie=False)
    return cost.total - cost.other["setup"] if cost else None


def told(found) -> str:
    """Names of the objects of a proposal."""
    return ", ".join(f"{name}: {why.split(',')[0]}" for name, why in found.groups) if found else ""


def main(names: list[str]) -> None:
    """Print a row for each scene: what `check` and the end of the run name, and the time of both forms, expected and timed."""
    print("| scene | named before the run | named after it | seconds, expected | timed | as rigid, expected | timed |")
    print("|---|---|---|---|---|---|---|")
    for name in names or sorted({p.stem for p in SCENES.glob("*.txt")} - FRAGMENTS):
        ready = prepare(load_scene(SCENES / f"{name}.txt"))
        if not proposal.groups(ready.context):
            continue
        before = proposal.before(Envelope(ready.context, {}, ready.certificate.timestep))
        with tempfile.TemporaryDirectory() as temporary:
            folder = Path(temporary)
            seconds = [expected(ready), timed(ready, folder / "elastic")]
            with Trajectory(folder / "elastic") as trajectory:
                after = proposal.after(ready.context, trajectory)
            if after is not None:
                try:
                    rigid = prepare(after.scene)
                    seconds += [expected(rigid), timed(rigid, folder / "rigid")]
                except MdanimError:
                    pass
        cells = [number(s, 2) if s else "" for s in (*seconds, None, None)[:4]]
        print(f"| {name} | {told(before)} | {told(after)} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
