# SPDX-License-Identifier: GPL-2.0-only
"""How well the energies of all scenes of scenes/ add up: prints the table of docs/accuracy.md.

python bench/residuals.py [SCENE ...]    names without .txt; without one all scenes, ten minutes
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from mdanim_lammps import Scene
from mdanim_lammps.results.files import read_json

SCENES = Path(__file__).resolve().parent.parent / "scenes"
FRAGMENTS = {"rubber"}
"""Files that scenes include, no scenes themselves."""


def main(names: list[str]) -> None:
    """Print a row for each scene: its size, its steps, the largest residual of its ledger, its expectations that are met."""
    print("| scene | particles | steps | largest energy residual | expectations met |")
    print("|---|---|---|---|---|")
    for name in names or sorted({p.stem for p in SCENES.glob("*.txt")} - FRAGMENTS):
        with tempfile.TemporaryDirectory() as folder:
            result = Scene.load(SCENES / f"{name}.txt").run(Path(folder) / "out")
            run = read_json(result.folder / "summary.json")
            size, steps, drift = (run[name] for name in ("particles", "steps", "energy_residual"))
            met, wanted = sum(e["met"] for e in run["expect"]), len(run["expect"])
            print(f"| {name} | {size} | {steps} | {drift:.1e} | {met} of {wanted} |", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
