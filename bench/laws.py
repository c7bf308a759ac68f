# SPDX-License-Identifier: GPL-2.0-only
"""A scene under both laws of contact: ``python bench/laws.py [scene] [pieces]``.

Both go on in turns, piece by piece, so that they see the same machine; processor time of all steps, without pictures.
"""

import sys
import time
from dataclasses import replace
from pathlib import Path

import one_thread  # noqa: F401
from timing import markdown

SCENES = Path(__file__).resolve().parent.parent / "scenes"


def measure(name: str = "crowd.txt", pieces: int = 40) -> list[dict]:
    """One row for each law."""
    from mdanim_lammps.engine.instance import Instance
    from mdanim_lammps.features.contact.words import ContactModel
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import load_scene

    scene = load_scene(SCENES / name)
    rows, instances = [], []
    for law in (ContactModel.PAPER, ContactModel.SURFACE):
        ready = prepare(replace(scene, control=replace(scene.control, contact_model=law)))
        instances.append(Instance(ready.plan))
        instances[-1].setup()
        steps = round(scene.control.time / ready.plan.certificate.timestep)
        rows.append({"law": law.value, "particles": ready.system.particles, "steps": steps, "seconds": 0.0})
    for piece in range(pieces):
        for row, instance in list(zip(rows, instances))[:: 1 if piece % 2 == 0 else -1]:
            start = time.thread_time()
            instance.run(row["steps"] * (piece + 1) // pieces - row["steps"] * piece // pieces)
            row["seconds"] += time.thread_time() - start
    for instance in instances:
        instance.close()
    return rows


def table(rows: list[dict]) -> str:
    """In Markdown."""
    first = rows[0]
    return markdown(
        ["law", "particles", "steps", "processor time [s]", "of a step [us]", "time over the first", "of a step"],
        [
            (
                *(r[k] for k in ("law", "particles", "steps", "seconds")),
                1e6 * r["seconds"] / r["steps"],
                r["seconds"] / first["seconds"],
                r["seconds"] / r["steps"] / (first["seconds"] / first["steps"]),
            )
            for r in rows
        ],
    )


def main(name: str = "crowd.txt", pieces: int = 40) -> None:
    """Measure and print."""
    print(table(measure(name, pieces)))


if __name__ == "__main__":
    main(*sys.argv[1:2], *map(int, sys.argv[2:3]))
