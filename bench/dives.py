# SPDX-License-Identifier: GPL-2.0-only
"""Effect of the pace of the updates of waves: ``python bench/dives.py``.

Cubes of 6, 12 and 24 cells dive as fast as if fallen from their own height. Printed are the deepest place of their middle and the
highest thereafter, over their edge, and updates.
"""

import numpy as np
import one_thread  # noqa: F401
from scene_texts import plunging

UPDATES = 4
"""Entry of the fix's vector."""


def dive(edge: int, period: float, stride: float) -> str:
    """Deepest and then highest place of the middle of a cube, over its edge, and updates: with a pace of updates."""
    from mdanim_lammps.engine.instance import Instance
    from mdanim_lammps.features.liquid import effect as liquid
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import parse_scene

    side = 2 * round(64 * edge / 46)
    usual = liquid.WAVE_PERIOD, liquid.WAVE_STRIDE
    liquid.WAVE_PERIOD, liquid.WAVE_STRIDE = period, stride
    places = []
    try:
        ready = prepare(parse_scene(plunging(edge, side, side, side / 2, "waves")))
        with Instance(ready.plan) as instance:
            instance.setup()
            steps = max(1, int(0.02 * (2 * edge / 9.81) ** 0.5 / ready.certificate.timestep))
            for _ in range(200):
                instance.run(steps)
                places.append((instance.particles.here("x")[:, 2].mean() - side / 2) / edge)
            updates = instance.fix_value("liquid", UPDATES)
    finally:
        liquid.WAVE_PERIOD, liquid.WAVE_STRIDE = usual
    deepest = int(np.argmin(places))
    return f"{places[deepest]:.3f} {max(places[deepest:]):.3f} {updates:.0f}"


def main() -> None:
    """Print it."""
    from mdanim_lammps.features.liquid.effect import WAVE_PERIOD, WAVE_STRIDE

    print("period, stride: deepest place, highest place, updates of cubes of 6, 12 and 24 cells")
    for pace in ((0.05, 0.25), (0.1, 1.0), (WAVE_PERIOD, WAVE_STRIDE), (0.2, 2.0)):
        print(f"{pace[0]:<6}{pace[1]:<8}" + "   ".join(dive(edge, *pace) for edge in (6, 12, 24)), flush=True)


if __name__ == "__main__":
    main()
