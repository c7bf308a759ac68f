# SPDX-License-Identifier: GPL-2.0-only
"""What the liquid costs in a run: ``python bench/liquid.py [cells across the body] [cells across the basin] [steps] [model]``.

A cube in a basin half full: while it plunges in, while it bobs, at rest, and while it is still far above (the liquid sleeps).
Printed are microseconds per step and the liquid's share of the step, in all and by part.
"""

import sys
import time

import one_thread  # noqa: F401

SCENE = """
gravity (0, 0, -9.81)
liquid water {{
  basin from ({a}, {a}, 0) to ({b}, {b}, {n})
  density 1000
  level {half}
  model {model}
}}
object cube {{
  shape box ({m}, {m}, {m})
  position (0, 0, {z})
  orientation axis (1, 2, 3) angle 20 deg
  density 500
  elasticity {young} Pa
  velocity (0, 0, {v})
}}
control {{
  time 100 s
  resolution 1
}}
"""
PARTS = {"flow": 7, "occupancy": 8, "coupling": 9, "liquid": 10}


def measure(what: str, warm: int, steps: int, **scene) -> None:
    """Run one case and print it."""
    from mdanim_lammps.engine.instance import Instance
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import parse_scene

    ready = prepare(parse_scene(SCENE.format(**scene)))
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(warm)
        before = {name: instance.fix_value("liquid", k) for name, k in PARTS.items()}
        swept = instance.fix_value("liquid", 4)
        start = time.perf_counter()
        instance.run(steps)
        wall = time.perf_counter() - start
        own = {name: instance.fix_value("liquid", k) - before[name] for name, k in PARTS.items()}
        swept = instance.fix_value("liquid", 4) - swept
    shares = "  ".join(f"{name} {100 * s / wall:5.2f} %" for name, s in own.items())
    print(f"{what:22s} {1e6 * wall / steps:9.1f} us/step   {shares}   {swept / steps:.2f} sweeps/step", flush=True)


def main(body: int = 46, basin: int = 128, steps: int = 200, model: str = "waves") -> None:
    """Measure and print."""
    # A stiff body, so that the time step is small against what the liquid has to follow: the usual case.
    common = dict(a=-basin / 2, b=basin / 2, n=basin, half=basin / 2, m=body, model=model, young=1000.0 * 9.81 * body * 50)
    print(f"{(body + 1) ** 3:,} particles, {basin**3:,} cells; liquid = automaton or waves, occupancy and coupling")
    fast = -((2 * 9.81 * body) ** 0.5)
    measure("plunging in", 20, steps, z=basin / 2 + 0.3 * body, v=fast, **common)
    measure("half in, at rest", 400, steps, z=basin / 2, v=0.0, **common)
    measure("far above: asleep", 20, steps, z=3 * basin, v=0.0, **common)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:4]), *sys.argv[4:])
