# SPDX-License-Identifier: GPL-2.0-only
"""Cost of the liquid in a run: ``python bench/liquid.py [deep|shallow] [steps] [model]``.

A cube of 10⁵ particles in a basin half full, of 2·10⁶ cells (deep) or of 10⁵ columns (shallow): while it plunges in, while it
rolls afloat and waves go on, afloat at rest (no update comes), and while it is still far above (the liquid sleeps). Printed are
microseconds per step and the liquid's share of the step, in all and by part. bench/liquid_tables.py puts a table of all of them
into docs/physics-liquid.md.
"""

import math
import statistics
import sys
import time

import one_thread  # noqa: F401
from scene_texts import in_basin, plunging
from timing import markdown

PARTS = {"flow": 7, "occupancy": 8, "coupling": 9, "liquid": 10}
UPDATES = 4
PLUNGING, AFLOAT, REST, ABOVE = "plunging in", "afloat, waves go on", "afloat, at rest", "nothing near"
CASES = (PLUNGING, AFLOAT, REST, ABOVE)
DENSITY = 900
"""Density of the cube at rest: it lies upright."""
HIGHER = 0.0004
"""So much higher, over its edge, lies its middle at rest than if it were rigid."""
QUIET, LONGEST = 0.5, 120.0
"""Time without an update that is rest, and time in which it must have come [s]."""


def text(what: str, edge: int, basin: int, top: float, level: float, model: str, settling: bool = False) -> str:
    """The scene of a case. One that is settling has drag and damping, which take no part in what is measured."""
    if what == PLUNGING:
        return plunging(edge, basin, top, level, model)
    if what == AFLOAT:
        return in_basin(edge, basin, top, level, level, model)
    if what == ABOVE:
        return in_basin(edge, basin, top, level, 3 * top, model)
    # About critical for a body that moves a third of its mass in the liquid up and down with it; with more it creeps.
    drag = 2 * (9.81 / (1.3 * edge * DENSITY / 1000)) ** 0.5
    # The same for the longest wave of the basin.
    calm = f"\n  calm {basin / (math.pi * (9.81 * level) ** 0.5)} s" if model == "waves" else ""
    upright = dict(angle=0, density=DENSITY, **(dict(more=f"drag {drag}{calm}", damping="damping 0.1") if settling else {}))
    return in_basin(edge, basin, top, level, level + edge * (0.5 - DENSITY / 1000 + HIGHER), model, **upright)


def settled(ready):
    """Step and state of a scene where no update of the liquid has come for a while, found by all cores. Raises RuntimeError."""
    from mdanim_lammps.engine.instance import Instance
    from mdanim_lammps.engine.threads import with_threads
    from mdanim_lammps.processes import cores

    dt = ready.certificate.timestep
    with with_threads(cores()), Instance(ready.plan) as instance:
        instance.setup()
        while instance.step * dt < LONGEST:
            before = instance.fix_value("liquid", UPDATES)
            instance.run(round(QUIET / dt))
            # At the start the liquid is at rest, too, until the body has moved.
            if instance.step * dt > 2 * QUIET and instance.fix_value("liquid", UPDATES) == before:
                return instance.step, instance.state()
    raise RuntimeError(f"the body has not come to rest within {LONGEST} s")


def measure(what: str, steps: int, rounds: int = 1, **scene) -> dict:
    """Microseconds of a step, the shares of the liquid and its parts, and updates per step: medians over rounds."""
    from mdanim_lammps.engine.instance import Instance
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import parse_scene

    start = settled(prepare(parse_scene(text(what, **scene, settling=True)))) if what == REST else None
    ready = prepare(parse_scene(text(what, **scene)))
    seen: list[dict] = []
    with Instance(ready.plan) as instance:
        instance.setup()
        if not start:
            instance.run(400 if what == AFLOAT else 20)
            start = instance.step, instance.state()
        for _ in range(rounds):
            instance.put(*start)
            instance.run(20)  # the first update after a start is none of the state
            before = {name: instance.fix_value("liquid", k) for name, k in PARTS.items()}
            updates = instance.fix_value("liquid", UPDATES)
            begin = time.perf_counter()
            instance.run(steps)
            wall = time.perf_counter() - begin
            seen.append({name: (instance.fix_value("liquid", k) - before[name]) / wall for name, k in PARTS.items()})
            seen[-1] |= {"us": 1e6 * wall / steps, "updates": (instance.fix_value("liquid", UPDATES) - updates) / steps}
    return {name: statistics.median(s[name] for s in seen) for name in seen[0]} | {"particles": ready.system.particles}


BASINS = {"deep": dict(edge=46, basin=128, top=128, level=64), "shallow": dict(edge=46, basin=317, top=96, level=48)}


def table(rounds: int, steps: int = 200) -> str:
    """Table of the page."""
    rows = []
    for basin, model in (("deep", "waves"), ("shallow", "waves"), ("deep", "surface")):
        scene = BASINS[basin]
        for what in CASES:
            found = measure(what, steps, rounds, model=model, **scene)
            where = f"`{model}`, {scene['basin']}² columns, {scene['level']} deep"
            shares = [f"{100 * found[name]:.2g} %" for name in ("liquid", "flow", "occupancy", "coupling")]
            rows.append((where, what, found["us"], *shares, f"{found['updates']:.2g}"))
            print(rows[-1], file=sys.stderr, flush=True)
    head = ["liquid", "cube of 47³ particles", "µs a step", "liquid's share", "waves or automaton", "solid parts"]
    return markdown([*head, "lift, push, drag", "updates or sweeps a step"], rows)


def main(basin: str = "deep", steps: int = 200, model: str = "waves") -> None:
    """Measure and print."""
    for what in CASES:
        found = measure(what, steps, model=model, **BASINS[basin])
        shares = "  ".join(f"{name} {100 * found[name]:5.2f} %" for name in PARTS)
        print(f"{what:22s} {found['us']:9.1f} us/step   {shares}   {found['updates']:.2f} updates/step", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:2], *map(int, sys.argv[2:3]), *sys.argv[3:])
