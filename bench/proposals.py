# SPDX-License-Identifier: GPL-2.0-only
"""Objects that may as well be rigid: ``python bench/proposals.py [SCENE ...]`` prints the table of docs/physics-rigid.md, with
``study`` in place of names that of docs/accuracy.md.

Names of scenes without .txt; without one all scenes in which something elastic is free, ten minutes. Times are processor seconds.
``study`` studies some of the scenes of bench/advice.py, half a minute each, with both forms.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import advice
import one_thread  # noqa: F401
from mdanim_lammps.cost.forecast import forecast
from mdanim_lammps.effects.envelope import Envelope
from mdanim_lammps.errors import MdanimError
from mdanim_lammps.features.rigid import proposal
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.run.loop import simulate
from mdanim_lammps.run.prepare import Prepared, prepare
from mdanim_lammps.scene.formatting import number
from mdanim_lammps.scene.parse import load_scene, parse_scene
from mdanim_lammps.study.analysis import off
from mdanim_lammps.study.study import run_study

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
    """Names of the objects of a proposal, and their largest strain where it was measured."""
    strains = (why.split(",")[0].removeprefix("largest strain ") if "largest strain" in why else "" for _, why in found.groups)
    return ", ".join(f"{name} {strain}".rstrip() for (name, _), strain in zip(found.groups, strains))


STUDIED = ("a slide", "a bounce", "a ball that rolls", "two balls", "dominoes")
"""Scenes of bench/advice.py."""
BUDGET = 40.0
"""Seconds of a study."""


def studies() -> None:
    """Print a row for each scene: error and seconds of both forms, by a study."""
    print("| scene | elastic: error | seconds | rigid: error | seconds |")
    print("|---|---|---|---|---|")
    for name in STUDIED:
        scene = parse_scene(advice.SCENES[name], name.replace(" ", "-"))
        with tempfile.TemporaryDirectory() as folder:
            a = run_study(scene, Path(folder) / "study", budget=BUDGET, only=("resolution", "contact", "rigid")).analysis
        rigid, elastic = (a.rated[s.key] for s in a.measured["rigid"])
        cells = [cell for r in (elastic, rigid) for cell in (off(r.error.middle, a.doubt), number(r.seconds.middle, 2))]
        print(f"| {name} | {' | '.join(cells)} |", flush=True)


def main(names: list[str]) -> None:
    """Print a row for each scene: what `check` and the end of the run name, and the time of both forms, expected and timed."""
    print("| scene | named before the run | named after it | seconds, expected | timed | as rigid, expected | timed |")
    print("|---|---|---|---|---|---|---|")
    for name in names or sorted({p.stem for p in SCENES.glob("*.txt")} - FRAGMENTS):
        ready = prepare(load_scene(SCENES / f"{name}.txt"))
        if not proposal.groups(ready.scene):
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
        print(f"| {name} | {told(before) if before else ''} | {told(after) if after else ''} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    studies() if sys.argv[1:] == ["study"] else main(sys.argv[1:])
