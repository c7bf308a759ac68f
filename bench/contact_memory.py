# SPDX-License-Identifier: GPL-2.0-only
"""Bytes that contact at the surfaces takes: ``python bench/contact_memory.py``.

Of a body, which all objects of one shape and size share in each fix, and of objects that touch: what is known of pairs, of planes
and of points near by, and places of particles and forces on them. ``fix mdanim/contact`` tells them.
"""

from dataclasses import replace
from pathlib import Path

import one_thread  # noqa: F401
from contact_world import STUFF
from timing import markdown

SCENES = Path(__file__).resolve().parent.parent / "scenes"
SHAPES = {
    "cube of 12³ cells": "box (12, 12, 12) cm",
    "ball, 8 cells across": "sphere 4 cm",
    "roller of 8 x 8 cells": "cylinder 4 cm 8 cm",
    "torus, 20 cells across": "torus 8 cm 2 cm",
}
"""Two of each, one on the other, with cells of 1 cm."""
TALL = {"box (12, 12, 12) cm": 12.0, "torus 8 cm 2 cm": 4.0}
"""Heights [cm], where they are not 8."""
STEPS = 400
LATER = {"crowd.txt": 1.0, "pile.txt": 0.75}
"""Times at which scenes are looked at [s]."""


def told(instance, fixes: tuple[str, ...]) -> list[float]:
    """Bytes of bodies, as each fix has them; of pairs and points; of particles."""
    return [sum(instance.fix_value(fix, n) for fix in fixes) for n in (11, 12, 13)]


def measure(rounds: int = 1, quick: bool = False) -> list[dict]:
    """One row for each shape and scene; memory does not vary, so there is one round."""
    from mdanim_lammps.engine.instance import Instance
    from mdanim_lammps.features.contact.words import ContactModel
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import load_scene, parse_scene

    rows = []

    def add(name: str, ready, steps: int) -> None:
        with Instance(ready.plan) as instance:
            instance.setup()
            instance.run(steps)
            bodies, pairs, particles = told(instance, ready.plan.body_fixes)
            rows.append(
                {
                    "name": name,
                    "objects": len(ready.system.first) - 1,
                    "points": sum(len(body.area) for body in ready.plan.contact_bodies.values()),
                    "touching": sum(instance.fix_value(fix, 5) for fix in ready.plan.body_fixes),
                    "bodies": bodies,
                    "pairs": pairs,
                    "particles": particles,
                }
            )

    for name, shape in SHAPES.items():
        tall = TALL.get(shape, 8.0)
        objects = (
            f"object {o} {{ shape {shape}  position (0, 0, {z}) cm  {STUFF} }}" for o, z in zip("ab", (tall / 2, tall * 1.5))
        )
        scene = "\n".join(["gravity (0, 0, -9.81)", "ground z 0", *objects])
        control = "control { time 100 s  resolution 1 cm  contact-model surface }"
        add(name, prepare(parse_scene(f"{scene}\n{control}\n")), STEPS)
    for name, time in {} if quick else LATER.items():
        scene = load_scene(SCENES / name)
        ready = prepare(replace(scene, control=replace(scene.control, contact_model=ContactModel.SURFACE)))
        add(name, ready, round(time / ready.plan.certificate.timestep))
    return rows


def table(rows: list[dict]) -> str:
    """In Markdown."""
    return markdown(
        [
            "objects",
            "how many",
            "points of all bodies",
            "in touch",
            "bodies of all fixes [kB]",
            "pairs and points [kB per object]",
            "particles [kB per object]",
        ],
        [
            (
                r["name"],
                r["objects"],
                r["points"],
                int(r["touching"]),
                1e-3 * r["bodies"],
                *(1e-3 * r[k] / r["objects"] for k in ("pairs", "particles")),
            )
            for r in rows
        ],
    )


if __name__ == "__main__":
    print(table(measure()))
